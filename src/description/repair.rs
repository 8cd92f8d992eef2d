//! Repairs common faults of URDF files so that their XML can be parsed. Places of errors are those in the original.
//!
//! Three faults are repaired. A declaration `<?xml ...?>` that is misspelt or not at the beginning is replaced by
//! blanks (the text is UTF-8 already, so it carries no information). So is the inside of a comment that holds `--`; as
//! other readers of URDF do, a comment is taken to end at the first `-->`. Undeclared namespace prefixes
//! (`<sensor:camera>` in a robot without `xmlns:sensor`) are declared at the end of the root's tag.

use super::xml::Cursor;
use crate::error::{Error, Location};
use memchr::{memchr, memchr2_iter};
use roxmltree::Document;
use std::borrow::Cow;

/// Largest number of prefixes that are declared; the text is parsed once more for each.
const MOST_PREFIXES: usize = 10;

/// A text with its repairs.
pub(super) struct Repaired<'a> {
    pub(super) text: Cow<'a, str>,
    prefixes: Vec<String>,
    /// Where declarations were inserted, and their number of characters.
    inserted: Option<(Location, usize)>,
}

impl<'a> Repaired<'a> {
    /// Replaces the faults in `text` by blanks.
    pub(super) fn new(text: &'a str) -> Self {
        let (mut repaired, mut at) = (Cow::Borrowed(""), 0);
        for range in faults(text) {
            let blank = |character| if character == '\n' { '\n' } else { ' ' };
            repaired += &text[at..range.start];
            repaired.to_mut().extend(text[range.clone()].chars().map(blank));
            at = range.end;
        }
        repaired += &text[at..];
        Self { text: repaired, prefixes: Vec::new(), inserted: None }
    }

    /// Declares one more prefix in the text; `None` if that cannot help.
    pub(super) fn declaring(self, prefix: &str) -> Option<Self> {
        let Self { text, mut prefixes, inserted } = self;
        if prefixes.len() == MOST_PREFIXES || prefixes.iter().any(|known| known == prefix) {
            return None;
        }
        let end = root_tag_end(&text)?;
        let declaration = format!(" xmlns:{prefix}=\"undeclared:{prefix}\"");
        let length = declaration.chars().count() + inserted.map_or(0, |(_, length)| length);
        // Each declaration is inserted after the earlier ones, so the place remains that of the first.
        let begin = inserted.map_or_else(|| Cursor::new(&text).locate(end), |(begin, _)| begin);
        let mut text = text.into_owned();
        text.insert_str(end, &declaration);
        prefixes.push(prefix.to_owned());
        Some(Self { text: Cow::Owned(text), prefixes, inserted: Some((begin, length)) })
    }

    /// Converts a place in the repaired text to the place in the file.
    pub(super) fn in_file(&self, place: Location) -> Location {
        match self.inserted {
            Some((begin, length)) if place.line == begin.line && place.column > begin.column => {
                Location { line: place.line, column: (place.column.saturating_sub(length)).max(begin.column) }
            }
            _ => place,
        }
    }

    /// Returns `error` with its place in the file.
    pub(super) fn refusal(&self, error: Error) -> Error {
        error.relocated(|place| self.in_file(place))
    }
}

/// Returns what is replaced by blanks: processing instructions before the root element, each taken to end at the first
/// `>`, unless it is a declaration that XML allows, and the insides of comments that XML does not allow.
fn faults(text: &str) -> Vec<std::ops::Range<usize>> {
    let (mut at, mut found, mut in_root) = (0, Vec::new(), false);
    for second in memchr2_iter(b'!', b'?', text.as_bytes()) {
        let Some(begin) = second.checked_sub(1).filter(|&begin| begin >= at) else { continue };
        let marks = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", ">")];
        let mut marks = marks.into_iter().filter(|(open, _)| text.as_bytes()[begin..].starts_with(open.as_bytes()));
        let Some((open, close)) = marks.next() else { continue };
        in_root |= memchr(b'<', &text.as_bytes()[at..begin]).is_some();
        let inside = begin + open.len();
        let Some(length) = text[inside..].find(close) else { break };
        let end = inside + length;
        at = end + close.len();
        match open {
            // The hyphen before `-->` may not be another one.
            "<!--" if text[inside..=end].contains("--") => found.push(inside..end),
            "<?" if !(in_root || begin == 0 && is_declaration(&text[..at], &text[at..])) => found.push(begin..at),
            _ => {}
        }
    }
    found
}

/// Returns whether `mark`, at the beginning of a file, is a declaration that XML allows, and tags follow in the `rest`.
fn is_declaration(mark: &str, rest: &str) -> bool {
    let is_allowed = || Document::parse(&format!("{mark}<robot/>")).is_ok();
    let is_tag = |rest: &str| rest.starts_with('<') && !rest.starts_with("<?");
    mark.starts_with("<?xml ") && is_tag(rest.trim_start()) && is_allowed()
}

/// Returns where the name and the attributes of the root's tag end.
fn root_tag_end(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        let begin = at + text[at..].find('<')?;
        let marks = [("<!--", "-->"), ("<?", ">")];
        if let Some((open, close)) = marks.into_iter().find(|(open, _)| text[begin..].starts_with(open)) {
            let inside = begin + open.len();
            at = inside + text[inside..].find(close)? + close.len();
            continue;
        }
        let mut quote = None;
        for (offset, character) in text[begin..].char_indices() {
            match (quote, character) {
                (None, '"' | '\'') => quote = Some(character),
                (Some(open), _) if open == character => quote = None,
                (None, '>') => {
                    let end = begin + offset;
                    return Some(if text[..end].ends_with('/') { end - 1 } else { end });
                }
                _ => {}
            }
        }
        return None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declarations_and_hyphens_in_comments_become_blanks() {
        for (text, repaired) in [
            ("<?xml verison=\"1.0\"?>\n<robot/>", "                     \n<robot/>"),
            ("<?xml version=\"1.0\">\n<robot/>", "                    \n<robot/>"),
            ("\n <? xml\n?><robot/>", "\n       \n  <robot/>"),
            ("<!-- <?xml?> -->\n<?xml?>\n<robot/>", "<!-- <?xml?> -->\n       \n<robot/>"),
            ("<robot><!-- ä --\n - --><a/></robot>", "<robot><!--     \n   --><a/></robot>"),
            ("<!-- <!-- --><robot/><!---a---><?b?><!-- --", "<!--      --><robot/><!--   --><?b?><!-- --"),
            ("<?xml version='1.0'?>\n<robot/>", "<?xml version='1.0'?>\n<robot/>"),
            ("<?xml version='1.0'?>\n<!<?b?><robot/>", "<?xml version='1.0'?>\n<!<?b?><robot/>"),
            ("<?xml version='1.0'?>\nrobot", "                     \nrobot"),
            ("<robot><![CDATA[<!-- -- ]]><a/><!-- --></robot>", "<robot><![CDATA[<!-- -- ]]><a/><!-- --></robot>"),
        ] {
            assert_eq!(Repaired::new(text).text, repaired);
        }
        assert!(matches!(Repaired::new("<robot/>").text, Cow::Borrowed(_)));
    }

    #[test]
    fn declared_prefixes_move_no_place() {
        let text = "<!-- <a> -->\n<robot name=\"a > b\"><x:y/><z:y/></robot>";
        let repaired = Repaired::new(text).declaring("x").and_then(|repaired| repaired.declaring("z")).expect("a root");
        let tag = "<robot name=\"a > b\" xmlns:x=\"undeclared:x\" xmlns:z=\"undeclared:z\">";
        assert_eq!(repaired.text, format!("<!-- <a> -->\n{tag}<x:y/><z:y/></robot>"));
        let place = |column| repaired.in_file(Location { line: 2, column }).column;
        assert_eq!(place(3), 3);
        // The places after the tag's `>` and after the element x:y.
        assert_eq!((place(tag.len() + 1), place(tag.len() + 7)), (21, 27));
        assert!(repaired.declaring("x").is_none());
        let alone = Repaired::new("<robot/>").declaring("x").expect("a root");
        assert_eq!(alone.text, "<robot xmlns:x=\"undeclared:x\"/>");
        let declared = Repaired::new("<?xml version='1.0'?><robot/>").declaring("x").expect("a root");
        assert_eq!(declared.text, "<?xml version='1.0'?><robot xmlns:x=\"undeclared:x\"/>");
    }
}
