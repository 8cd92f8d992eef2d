//! XML elements with their places in the text; hostile texts are refused here, in bounded time and memory.

use crate::error::{Error, Location, Reason, Result};
use roxmltree::{Document, Node, ParsingOptions};

/// The deepest nesting of elements that is accepted; URDF itself needs six.
const DEEPEST: usize = 200;
/// The most attributes of one element that are accepted: roxmltree compares each with each.
const MOST_ATTRIBUTES: usize = 100;
/// The most nodes (elements, texts, comments) that are accepted.
const MOST_NODES: u32 = 20_000_000;

/// The XML tree of `text`.
///
/// # Errors
/// Text that is no XML, a document type definition, too deep nesting, too many attributes or nodes.
pub(super) fn parse(text: &str) -> Result<Document<'_>> {
    refuse_many_attributes(text)?;
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| refusal(text, &error))?;
    refuse_deep_nesting(&document)?;
    Ok(document)
}

/// What roxmltree refused, in our words.
fn refusal(text: &str, error: &roxmltree::Error) -> Error {
    use roxmltree::Error as Xml;
    let at = |error: Error, place: Location| error.on(place.line, place.column);
    match error {
        Xml::DtdDetected => {
            let error = Error::new(Reason::Unsupported("a document type definition is not accepted".into()))
                .hint("remove the <!DOCTYPE ...> declaration; URDF needs none");
            at(error, Cursor::new(text).locate(text.find("<!DOCTYPE").unwrap_or(0)))
        }
        Xml::NodesLimitReached => {
            Reason::Unsupported(format!("the file has more than {MOST_NODES} XML nodes, which is not accepted")).into()
        }
        Xml::NoRootNode => Error::new(Reason::Syntax("the text holds no XML element".into()))
            .hint("give the text of a URDF file, which begins with <robot"),
        _ => {
            // The message ends with the position, which is told apart from it.
            let message = error.to_string();
            let message = message.rsplit_once(" at ").map_or(message.as_str(), |(message, _)| message);
            let place = error.pos();
            let refused = Error::new(Reason::Syntax(format!("not well-formed XML: {message}")))
                .on(place.row as usize, place.col as usize);
            match error {
                Xml::UnknownNamespace(prefix, _) => {
                    refused.hint(format!("declare the prefix: <robot xmlns:{prefix}=\"...\">"))
                }
                _ => refused,
            }
        }
    }
}

/// Refuses an element with more than [`MOST_ATTRIBUTES`] before roxmltree spends its square on them.
///
/// An attribute value holds no `<`, so the attributes of an element stand between one `<` and the next.
fn refuse_many_attributes(text: &str) -> Result<()> {
    let mut offset = 0;
    for part in text.split('<') {
        let attributes = part.split('=').skip(1).filter(|value| value.trim_start().starts_with(['"', '\'']));
        if attributes.count() > MOST_ATTRIBUTES {
            let place = Cursor::new(text).locate(offset.max(1) - 1);
            let reason = format!("an element with more than {MOST_ATTRIBUTES} attributes is not accepted");
            return Err(Error::new(Reason::Unsupported(reason)).on(place.line, place.column));
        }
        offset += part.len() + 1;
    }
    Ok(())
}

fn refuse_deep_nesting(document: &Document<'_>) -> Result<()> {
    // Nodes are numbered in the text's order, so a parent's depth is known before its children's.
    let mut depths: Vec<usize> = Vec::new();
    for node in document.root().descendants() {
        let depth = node.parent().and_then(|parent| depths.get(parent.id().get_usize())).map_or(0, |depth| depth + 1);
        if node.is_element() && depth > DEEPEST {
            let reason = format!("elements nested more than {DEEPEST} deep are not accepted");
            return Err(refuse(node, Reason::Unsupported(reason)));
        }
        depths.push(depth);
    }
    Ok(())
}

/// `reason` at the place of `node`.
pub(super) fn refuse(node: Node<'_, '_>, reason: Reason) -> Error {
    let place = node.document().text_pos_at(node.range().start);
    Error::new(reason).on(place.row as usize, place.col as usize)
}

/// The child elements of `node` that share its namespace.
pub(super) fn children<'a, 'input: 'a>(node: Node<'a, 'input>) -> impl Iterator<Item = Node<'a, 'input>> {
    let namespace = node.tag_name().namespace();
    node.children().filter(move |child| child.is_element() && child.tag_name().namespace() == namespace)
}

/// The child element `tag`, if there is one.
///
/// # Errors
/// A second one.
pub(super) fn child<'a, 'input: 'a>(node: Node<'a, 'input>, tag: &str) -> Result<Option<Node<'a, 'input>>> {
    let mut found = children(node).filter(|child| child.tag_name().name() == tag);
    let first = found.next();
    match found.next() {
        Some(second) => Err(refuse(second, Reason::Duplicate { what: "element", name: tag.into() })),
        None => Ok(first),
    }
}

/// The child element `tag`.
///
/// # Errors
/// None, or a second one.
pub(super) fn required_child<'a, 'input: 'a>(node: Node<'a, 'input>, tag: &str) -> Result<Node<'a, 'input>> {
    child(node, tag)?.ok_or_else(|| refuse(node, Reason::Missing(format!("<{tag}>"))))
}

/// The attribute `name`, which must be there and not be empty.
pub(super) fn required_attribute<'a>(node: Node<'a, '_>, name: &str) -> Result<&'a str> {
    match node.attribute(name) {
        Some(value) if !value.is_empty() => Ok(value),
        _ => Err(refuse(node, Reason::Missing(format!("the attribute {name} of <{}>", node.tag_name().name())))),
    }
}

/// Walks forward through a text and tells lines and columns, each character looked at once.
pub(super) struct Cursor<'a> {
    text: &'a str,
    offset: usize,
    location: Location,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, offset: 0, location: Location { line: 1, column: 1 } }
    }

    /// Line and column of the byte `offset`, which must not lie before the last one.
    pub(super) fn locate(&mut self, offset: usize) -> Location {
        for character in self.text.get(self.offset..offset).unwrap_or_default().chars() {
            if character == '\n' {
                self.location.line += 1;
                self.location.column = 1;
            } else {
                self.location.column += 1;
            }
        }
        self.offset = self.offset.max(offset);
        self.location
    }
}
