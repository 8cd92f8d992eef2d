//! Errors on standard error, coloured where a person looks.

use anstyle::{AnsiColor, Style};
use heelstrike::Error;
use std::io::Write;

const ERROR: Style = AnsiColor::Red.on_default().bold();
const HINT: Style = AnsiColor::Cyan.on_default().bold();

/// Writes `error: file:line:column: place: reason` and, where there is a remedy, `hint: remedy`.
pub(super) fn complain(error: &Error) {
    let mut stderr = anstream::stderr().lock();
    // Where nobody reads standard error there is nobody to tell that it cannot be written.
    let _ = writeln!(stderr, "{ERROR}error{ERROR:#}: {error}");
    if let Some(hint) = error.remedy() {
        let _ = writeln!(stderr, "{HINT}hint{HINT:#}: {hint}");
    }
}
