//! What the live page asks the core, as one function from JSON to JSON in WebAssembly.
//!
//! ```text
//!     page.html --room(bytes)--> where the question goes      answer() --> where the answer begins, which ends with NUL
//!     {"examples": null}                          robots and states that the page has of its own
//!     {"robot": URDF}                             what was read; the robot of all further questions
//!     {"impact": {state, tolerance}}              result, text, drawing
//!     {"sweep": {study, tolerance}}               regions along a parameter, picture, text
//! ```

mod question;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// A question, and then its answer.
static TEXT: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn text() -> MutexGuard<'static, Vec<u8>> {
    TEXT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Where a question of so many bytes is to be written.
#[expect(unsafe_code, reason = "a name that is unique among all that is exported")]
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    let mut text = text();
    text.clear();
    text.resize(bytes, 0);
    text.as_mut_ptr()
}

/// Answers the question; where the answer begins.
#[expect(unsafe_code, reason = "a name that is unique among all that is exported")]
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let mut text = text();
    *text = question::answer(&text);
    text.push(0);
    text.as_ptr()
}
