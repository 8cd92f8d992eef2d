//! XML elements with their locations in the text. Malicious texts are refused in bounded time and memory.

use crate::error::{Error, Location, Reason, Result};
use memchr::{memchr_iter, memmem, memrchr};
use roxmltree::{Document, Node, ParsingOptions};

/// Largest accepted nesting depth of elements; URDF itself needs six.
const DEEPEST: usize = 200;
/// Largest accepted number of links, of joints and of collision shapes.
pub(super) const MOST_LINKS: usize = 10_000;
/// Largest accepted number of attributes of one element: roxmltree compares all pairs.
const MOST_ATTRIBUTES: usize = 100;
/// Largest accepted number of nodes (elements, texts, comments), and of attributes in total: 100 per link.
const MOST_NODES: u32 = 1_000_000;
/// Largest accepted number of namespace declarations: roxmltree copies all in scope into each element that adds one.
const MOST_NAMESPACES: usize = 1000;

/// The hint for a text that is not XML at all.
const NO_URDF: &str = "give the text of a URDF file, which begins with <robot";
/// The hints for files given in the wrong order.
const JSON: &str = "this is JSON, as states are: the robot's URDF file comes first";
const TABLE: &str = "this is a table, as of states: the robot's URDF file comes first";

/// Parses `text` into an XML tree. Document type definitions, and too many or too deeply nested elements are refused.
/// An error comes with the undeclared namespace prefix, if declaring it may help.
pub(super) fn parse(text: &str) -> std::result::Result<Document<'_>, (Error, Option<String>)> {
    refuse_many(text).map_err(|error| (error, None))?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| match error {
        roxmltree::Error::UnknownNamespace(ref prefix, _) => (refusal(text, &error), Some(prefix.clone())),
        _ => (refusal(text, &error), None),
    })?;
    refuse_deep_nesting(&document).map_err(|error| (error, None))?;
    Ok(document)
}

/// Translates an error of roxmltree.
fn refusal(text: &str, error: &roxmltree::Error) -> Error {
    use roxmltree::Error as Xml;
    let (place, message) = (error.pos(), error.to_string());
    let refused = |reason: Reason| Error::new(reason).on(place.row as usize, place.col as usize);
    // The message ends with the position, which is stored separately.
    let message = message.rsplit_once(" at ").map_or(message.as_str(), |(message, _)| message);
    let syntax = || refused(Reason::Syntax(format!("not well-formed XML: {message}")));
    match error {
        Xml::DtdDetected => {
            let place = Cursor::new(text).locate(text.find("<!DOCTYPE").unwrap_or(0));
            let reason = Reason::Unsupported("a document type definition is not accepted".into());
            let hint = "remove the <!DOCTYPE ...> declaration; URDF needs none";
            Error::new(reason).on(place.line, place.column).hint(hint)
        }
        Xml::NodesLimitReached => Reason::TooMany { what: "XML nodes", limit: MOST_NODES as usize }.into(),
        Xml::NoRootNode => Error::new(Reason::Syntax("the text holds no XML element".into())).hint(NO_URDF),
        Xml::DuplicatedAttribute(name, _) => refused(Reason::Duplicate { what: "attribute", name: name.clone() }),
        Xml::UnknownNamespace(prefix, _) => {
            syntax().hint(format!("declare the prefix: <robot xmlns:{prefix}=\"...\">"))
        }
        Xml::UnclosedRootNode | Xml::UnexpectedEndOfStream => syntax().hint("the text ends too early: is it whole?"),
        _ if text.trim_start().starts_with(['{', '[']) => syntax().hint(JSON),
        Xml::UnknownToken(_) if text.trim_start().starts_with('<') && !begins_at(text, place, "<!") => {
            syntax().hint("the element <robot> is the whole file: delete what follows its end")
        }
        _ if text.trim_start().starts_with('<') => syntax(),
        _ if text.lines().next().is_some_and(|head| head.contains([',', '\t'])) => syntax().hint(TABLE),
        _ => syntax().hint(NO_URDF),
    }
}

fn begins_at(text: &str, place: roxmltree::TextPos, part: &str) -> bool {
    let line = text.lines().nth(place.row as usize - 1).unwrap_or_default();
    line.char_indices().nth(place.col as usize - 1).is_some_and(|(at, _)| line[at..].starts_with(part))
}

/// Refuses texts with more than [`MOST_LINKS`] tags `<link` before a tree is built from them, and texts on which
/// roxmltree would take quadratic time: more than [`MOST_ATTRIBUTES`] of one element or [`MOST_NAMESPACES`]. The
/// error's place is that of the first item beyond the limit.
///
/// Attribute values cannot contain `<`, so a tag with its attributes lies between one `<` and the next.
fn refuse_many(text: &str) -> Result<()> {
    let refused = |what, limit, offset: usize| {
        let place = Cursor::new(text).locate(offset.max(1) - 1);
        Err(Error::new(Reason::TooMany { what, limit }).on(place.line, place.column))
    };
    if let Some(offset) = memmem::find_iter(text.as_bytes(), "xmlns").nth(MOST_NAMESPACES) {
        return refused("namespaces", MOST_NAMESPACES, offset + 1);
    }
    // These numbers bound those of links and attributes. A closer look is needed only if there are many.
    let [links, prefixed] = ["<link", ":link"].map(|tag| memmem::find_iter(text.as_bytes(), tag).count());
    let equals = memchr_iter(b'=', text.as_bytes()).count();
    let has_many = links + prefixed > MOST_LINKS || equals > MOST_NODES as usize;
    let (mut offset, mut links, mut all_attributes, mut in_comment) = (0, 0, 0, false);
    for end in memchr_iter(b'<', text.as_bytes()).chain([text.len()]) {
        // An attribute has at least four bytes, as in x="".
        if !has_many && (end - offset) / 4 <= MOST_ATTRIBUTES {
            offset = end + 1;
            continue;
        }
        let part = &text[offset..end];
        let commented = in_comment || part.starts_with("!--");
        in_comment = commented && !part.contains("-->");
        links += usize::from(!commented && is_link(part));
        let is_attribute = |&at: &usize| part[at + 1..].trim_start().starts_with(['"', '\'']);
        let attributes = memchr_iter(b'=', part.as_bytes()).filter(is_attribute).count();
        all_attributes += attributes;
        for (what, count, limit) in [
            ("links", links, MOST_LINKS),
            ("attributes of one element", attributes, MOST_ATTRIBUTES),
            ("attributes", all_attributes, MOST_NODES as usize),
        ] {
            if count > limit {
                return refused(what, limit, offset);
            }
        }
        offset = end + 1;
    }
    Ok(())
}

/// Returns whether the text after a `<` begins an element `link` of any namespace.
fn is_link(part: &str) -> bool {
    let ends = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'/' | b'>');
    let name = part.as_bytes().split(ends).next().unwrap_or_default();
    name.strip_suffix(b"link").is_some_and(|prefix| prefix.last().is_none_or(|&last| last == b':'))
}

fn refuse_deep_nesting(document: &Document<'_>) -> Result<()> {
    // Where the elements around the next one end.
    let mut ends = Vec::new();
    for element in document.descendants().filter(Node::is_element) {
        let range = element.range();
        ends.truncate(ends.iter().rposition(|&end| end > range.start).map_or(0, |last| last + 1));
        if ends.len() == DEEPEST {
            let reason = format!("elements nested more than {DEEPEST} deep are not accepted");
            return Err(refuse(element, Reason::Unsupported(reason)));
        }
        ends.push(range.end);
    }
    Ok(())
}

/// Returns an error with `reason` at the place of `node`.
pub(super) fn refuse(node: Node<'_, '_>, reason: Reason) -> Error {
    let place = node.document().text_pos_at(node.range().start);
    Error::new(reason).on(place.row as usize, place.col as usize)
}

/// Returns the child elements of `node` that share its namespace.
pub(super) fn children<'a, 'input: 'a>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    let namespace = node.tag_name().namespace();
    node.children().filter(move |child| child.is_element() && child.tag_name().namespace() == namespace)
}

pub(super) type Child<'a, 'input> = Option<Node<'a, 'input>>;

/// Finds the child elements with these tags in one pass. A second element with the same tag is an error, unless it is
/// written exactly as the first.
#[inline(always)]
pub(super) fn named<'a, 'input: 'a, const N: usize>(
    node: Node<'a, 'input>,
    tags: [&str; N],
) -> [Result<Child<'a, 'input>>; N] {
    let mut found = tags.map(|_| Ok(None));
    let text = |element: Node<'_, 'input>| &node.document().input_text()[element.range()];
    for child in children(node) {
        let tag = child.tag_name().name();
        match tags.iter().position(|known| *known == tag).map(|at| &mut found[at]) {
            Some(first @ Ok(None)) => *first = Ok(Some(child)),
            Some(Ok(Some(first))) if text(*first) == text(child) => {}
            Some(known @ Ok(_)) => {
                let twice = Reason::Duplicate { what: "element", name: tag.into() };
                *known = Err(refuse(child, twice).hint("delete one of them"));
            }
            Some(Err(_)) | None => {}
        }
    }
    found
}

/// Returns `child`, the child element `tag` of `node`, or an error if it is missing.
pub(super) fn required_child<'a, 'input: 'a>(
    node: Node<'_, '_>,
    child: Result<Child<'a, 'input>>,
    tag: &str,
) -> Result<Node<'a, 'input>> {
    child?.ok_or_else(|| refuse(node, Reason::Missing(format!("<{tag}>"))))
}

/// Returns the attribute `name`, or an error if it is missing or empty.
#[inline(always)]
pub(super) fn required_attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str> {
    let missing = || refuse(node, Reason::Missing(format!("the attribute {name} of <{}>", node.tag_name().name())));
    node.attribute(name).filter(|value| !value.is_empty()).ok_or_else(missing)
}

/// Converts ascending byte offsets to lines and columns in one pass over a text.
pub(super) struct Cursor<'a> {
    text: &'a str,
    offset: usize,
    location: Location,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, offset: 0, location: Location { line: 1, column: 1 } }
    }

    /// Returns line and column of the byte `offset`, which must not precede the offset of the last call.
    pub(super) fn locate(&mut self, offset: usize) -> Location {
        let passed = self.text.get(self.offset..offset).unwrap_or_default();
        let lines = memchr_iter(b'\n', passed.as_bytes()).count();
        if lines > 0 {
            self.location = Location { line: self.location.line + lines, column: 1 };
        }
        let line = memrchr(b'\n', passed.as_bytes()).map_or(passed, |end| &passed[end + 1..]);
        self.location.column += line.chars().count();
        self.offset = self.offset.max(offset);
        self.location
    }
}
