//! The core of the live page in WebAssembly: one function from JSON questions to JSON answers.
//!
//! ```text
//!     page.html --room(bytes)--> place of the question        answer() --> start of the answer, which ends with NUL
//!     {"examples": null}                          robots and states that come with the page
//!     {"robot": URDF}                             what was read; the robot of all further questions
//!     {"impact": {of: STATE, tolerance}}          result, text, drawing
//!     {"sweep": {of: STUDY, tolerance}}           regions along a parameter, picture, text
//! ```

mod question;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The question, later replaced by its answer.
static TEXT: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn text() -> MutexGuard<'static, Vec<u8>> {
    TEXT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the place where a question of this many bytes must be written.
#[expect(unsafe_code, reason = "a name that is unique among all that is exported")]
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    let mut text = text();
    text.clear();
    text.resize(bytes, 0);
    text.as_mut_ptr()
}

/// Answers the question and returns where the answer begins.
#[expect(unsafe_code, reason = "a name that is unique among all that is exported")]
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    let mut text = text();
    *text = question::answer(&text);
    text.push(0);
    text.as_ptr()
}
