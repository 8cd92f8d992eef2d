//! Makes texts from files safe to print: characters that a terminal would interpret or hide become visible.

use std::borrow::Cow;

/// Returns the text with every control character (C0, DEL, C1), line break and control of the writing direction as an
/// escape, as in `\n` and `\u{1b}`. Every message, note and text for people passes text from files through it.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.chars().any(controls_terminal) {
        return Cow::Borrowed(text);
    }
    let escaped = |letter: char| match letter {
        '\n' | '\r' | '\t' => letter.escape_default().collect::<String>(),
        letter if controls_terminal(letter) => letter.escape_unicode().collect(),
        letter => letter.to_string(),
    };
    Cow::Owned(text.chars().map(escaped).collect())
}

/// Returns whether a terminal interprets the character instead of showing it.
pub(super) fn controls_terminal(letter: char) -> bool {
    let turns_direction = matches!(
        letter,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}') || turns_direction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_escaped() {
        let hostile = "a\n\r\t\0\u{1b}[2J\u{7f}\u{85}\u{9b}31m\u{200f}\u{202e}\u{2066}\u{2029}z";
        let shown = "a\\n\\r\\t\\u{0}\\u{1b}[2J\\u{7f}\\u{85}\\u{9b}31m\\u{200f}\\u{202e}\\u{2066}\\u{2029}z";
        assert_eq!(visible(hostile), shown);
        assert_eq!(visible(shown), shown);
        assert!(matches!(visible("größe \\ 腿 \"left\" \u{200d}"), Cow::Borrowed(_)));
    }
}
