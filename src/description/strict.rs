//! Copies checked attributes into the strict copy.

use super::JointKind;
use super::xml;
use crate::error::{Reason, Result, finite};
use roxmltree::Node;

/// Which numbers an attribute may hold.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Range {
    Any,
    NotNegative,
}

/// Copies an `<axis>`, which must not be zero where the joint has an axis.
pub(super) fn copy_axis(axis: Node<'_, '_>, kind: JointKind, strict: &mut String) -> Result<()> {
    let begin = strict.len();
    strict.push_str("<axis");
    if !copy(axis, "xyz", 3, Range::Any, strict)? {
        // <axis/> means what no <axis> means.
        strict.truncate(begin);
        return Ok(());
    }
    strict.push_str("/>");
    let components = axis.attribute("xyz").unwrap_or_default().split_whitespace();
    if kind.has_axis() && components.flat_map(str::parse::<f64>).all(|component| component == 0.0) {
        let reason = "xyz of <axis> is zero, so the joint has no direction".into();
        return Err(xml::refuse(axis, Reason::Inconsistent(reason)));
    }
    Ok(())
}

/// Copies the `<origin>` of `parent`, if it has one.
pub(super) fn copy_origin(parent: Node<'_, '_>, strict: &mut String) -> Result<()> {
    let Some(origin) = xml::child(parent, "origin")? else { return Ok(()) };
    if origin.has_attribute("quat_xyzw") {
        let reason = "quat_xyzw of <origin> is not handled".into();
        return Err(xml::refuse(origin, Reason::Unsupported(reason)).hint("give the turn as rpy"));
    }
    strict.push_str("<origin");
    copy(origin, "xyz", 3, Range::Any, strict)?;
    copy(origin, "rpy", 3, Range::Any, strict)?;
    strict.push_str("/>");
    Ok(())
}

/// Copies an attribute that must be there and hold `count` numbers of `range`.
pub(super) fn copy_required(
    element: Node<'_, '_>,
    name: &str,
    count: usize,
    range: Range,
    strict: &mut String,
) -> Result<()> {
    xml::required_attribute(element, name)?;
    copy(element, name, count, range, strict).map(|_| ())
}

/// Copies an attribute that must hold `count` numbers of `range`; returns whether it is present.
pub(super) fn copy(element: Node<'_, '_>, name: &str, count: usize, range: Range, strict: &mut String) -> Result<bool> {
    let Some(value) = element.attribute(name) else { return Ok(false) };
    let what = || format!("{name} of <{}>", element.tag_name().name());
    let numbers: Vec<&str> = value.split_whitespace().collect();
    let parsed: Vec<f64> = numbers.iter().flat_map(|number| number.parse()).collect();
    if numbers.len() != count || parsed.len() != count {
        let expected = if count == 1 { "a number".into() } else { format!("{count} numbers") };
        let reason = Reason::Syntax(format!("{} must be {expected}, not \"{value}\"", what()));
        return Err(xml::refuse(element, reason));
    }
    for number in parsed {
        finite(number, what).map_err(|error| xml::refuse(element, error.reason().clone()))?;
        if range == Range::NotNegative && number < 0.0 {
            let reason = Reason::OutOfRange { what: what(), allowed: "at least 0", value: number };
            return Err(xml::refuse(element, reason));
        }
    }
    write_attribute(name, &numbers.join(" "), strict);
    Ok(true)
}

/// Writes an attribute into the strict copy.
pub(super) fn write_attribute(name: &str, value: &str, strict: &mut String) {
    strict.push_str(&format!(" {name}=\"{value}\""));
}
