//! Lines of states, most of which differ from the line before in a few values alone.
//!
//! ```text
//!     {"id": "k17", "position": {"base": {"z": 0.41}}, "friction": 0.8}
//!            -----                             ----                 ---      the values of a line: id, q, v, friction
//! ```
//!
//! A line whose other bytes are those of the line that was last read as a whole means the same but for its values: only
//! these are read. Every other line is read as a whole, and so is one with a value in an unusual form.

use super::json::{Node, Value, offset_in};
use super::state::{BASE, read};
use crate::law::Friction;
use crate::state::{Defaults, State};
use crate::{Result, Robot};
use std::ops::Range;

/// Reads states line by line, in memory that it reuses.
#[derive(Debug, Clone)]
pub struct StateLines<'r> {
    robot: &'r Robot,
    defaults: &'r Defaults,
    /// The line that was last read as a whole.
    text: Option<String>,
    /// Where its values are, in their order; if one is unusual none, so that only the same line repeats it.
    values: Vec<(Range<usize>, Entry)>,
    /// The state of the last line.
    state: State,
}

/// What a value is in a state.
#[derive(Debug, Clone, Copy)]
enum Entry {
    Id,
    Position(usize),
    Velocity(usize),
    /// That of all links, if it is a number.
    Friction,
}

impl<'r> StateLines<'r> {
    /// Lines of states of `robot`; what they omit is as `defaults` have it.
    pub fn new(robot: &'r Robot, defaults: &'r Defaults) -> Self {
        Self { robot, defaults, text: None, values: Vec::new(), state: State::default() }
    }

    /// The state of a line.
    ///
    /// # Errors
    /// As [`State::from_json`].
    pub fn read(&mut self, line: &str) -> Result<&State> {
        if self.repeat(line).is_none() {
            let tree = Value::parse(line)?;
            self.state = read(Node::root(&tree, line, None), self.robot, self.defaults)?;
            line.clone_into(self.text.get_or_insert_default());
            self.values.clear();
            if self.list(&tree, line).is_none() {
                self.values.clear();
            }
        }
        Ok(&self.state)
    }

    /// Reads the values of a line that is otherwise the last one; `None` if it is not, or if a value is unusual.
    ///
    /// Values that were read until then remain, and those of the next line replace them.
    fn repeat(&mut self, line: &str) -> Option<()> {
        let Self { text, values, state, .. } = self;
        let text = text.as_deref()?;
        let (mut rest, mut behind) = (line, 0);
        for (range, entry) in &*values {
            rest = rest.strip_prefix(text.get(behind..range.start)?)?;
            let (value, more) = match entry {
                Entry::Id => split_id(rest)?,
                Entry::Position(_) | Entry::Velocity(_) | Entry::Friction => {
                    rest.split_at(number_length(rest.as_bytes())?)
                }
            };
            match *entry {
                Entry::Id => {
                    state.id = Some(match value.strip_prefix('"') {
                        Some(text) => text.strip_suffix('"')?.into(),
                        None => value.parse::<u64>().ok()?.into(),
                    });
                }
                Entry::Position(coordinate) => state.position[coordinate] = finite(value)?,
                Entry::Velocity(coordinate) => state.velocity[coordinate] = finite(value)?,
                Entry::Friction => {
                    let friction = finite(value).filter(|&friction| friction >= 0.0)?;
                    state.scene.friction.default = Some(Friction::Finite(friction));
                }
            }
            (rest, behind) = (more, range.end);
        }
        (rest == text.get(behind..)?).then_some(())
    }

    /// Lists the values of a `line` that was read; `None` if a key or a value is unusual.
    fn list(&mut self, tree: &Value, line: &str) -> Option<()> {
        for (key, value) in tree.fields() {
            let entry: fn(usize) -> Entry = match key.as_ref() {
                "position" => Entry::Position,
                "velocity" => Entry::Velocity,
                "id" => {
                    let start = value_of(line, key)?;
                    let (id, _) = split_id(&line[start..])?;
                    self.values.push((start..start + id.len(), Entry::Id));
                    continue;
                }
                "friction" if matches!(value, Value::Number(_)) => {
                    self.values.push((number_at(line, value_of(line, key)?)?, Entry::Friction));
                    continue;
                }
                _ => continue,
            };
            for (part, values) in value.fields() {
                for (name, _) in values.fields() {
                    let coordinate = match part.as_ref() {
                        "base" => BASE.iter().position(|known| known == name)?,
                        _ => self.robot.base_dofs() + self.robot.joint(name)?,
                    };
                    self.values.push((number_at(line, value_of(line, name)?)?, entry(coordinate)));
                }
            }
        }
        Some(())
    }
}

/// Where the value of a key begins; `None` if the key is a copy, because it has escapes.
fn value_of(line: &str, key: &str) -> Option<usize> {
    // The offset is that of the quotation mark before the key.
    let behind = line.get(offset_in(line, key)? + key.len() + 2..)?;
    let value = behind.trim_ascii_start().strip_prefix(':')?.trim_ascii_start();
    Some(line.len() - value.len())
}

/// An id of plain characters or digits, and what follows it.
fn split_id(text: &str) -> Option<(&str, &str)> {
    let length = match text.strip_prefix('"') {
        Some(inner) => {
            let end = inner.bytes().position(|byte| matches!(byte, b'"' | b'\\' | ..b' '))?;
            (inner.as_bytes()[end] == b'"').then_some(end + 2)?
        }
        None => {
            let digits = text.bytes().take_while(u8::is_ascii_digit).count();
            // Nothing that the digits may go on with as a number, and no zero before others.
            let is_plain = !matches!(text.as_bytes().get(digits), Some(b'.' | b'e' | b'E'));
            (is_plain && digits > 0 && (digits == 1 || !text.starts_with('0'))).then_some(digits)?
        }
    };
    Some(text.split_at(length))
}

/// Where the number that begins at `start` is.
fn number_at(line: &str, start: usize) -> Option<Range<usize>> {
    Some(start..start + number_length(&line.as_bytes()[start..])?)
}

/// How long the number at the beginning of a text is, by the grammar of JSON (RFC 8259, section 6).
fn number_length(text: &[u8]) -> Option<usize> {
    let digits = |from: usize| text[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = usize::from(text.first() == Some(&b'-'));
    let whole = digits(end);
    if whole == 0 || whole > 1 && text[end] == b'0' {
        return None;
    }
    end += whole;
    if text.get(end) == Some(&b'.') {
        let parts = digits(end + 1);
        end += 1 + (parts > 0).then_some(parts)?;
    }
    if matches!(text.get(end), Some(b'e' | b'E')) {
        end += 1 + usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end.min(text.len()));
        end += (exponent > 0).then_some(exponent)?;
    }
    Some(end)
}

/// The nearest f64 of a number; `None` beyond the range of f64.
fn finite(number: &str) -> Option<f64> {
    number.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_lines_read_as_whole_ones_do() {
        let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).expect("a good robot");
        let defaults = Defaults::default();
        let mut lines = StateLines::new(&robot, &defaults);
        let friction = |value: &str| format!("{{\"velocity\": {{\"base\": {{\"z\": -1}}}}, \"friction\" :{value}}}");
        let line = |id: &str, pitch: &str, knee: &str, rest: &str| {
            format!(
                "{{\"id\": {id}, \"position\": {{\"base\": {{\"pitch\" : {pitch}}}}}, \
                 \"velocity\": {{\"joints\": {{\"left_knee\":{knee}}}}}, \"friction\": 0.8{rest}}}"
            )
        };
        let ids = ["\"k1\"", "\"k2\"", "\"é\"", "\"\"", "7", "0", "\"a\\nb\"", "7.5", "-7", "00", "null", "1e3"];
        let ids = ids.into_iter().chain(["12345678901234567890123", "\"open", "\"tab\t\"", "18446744073709551615"]);
        let numbers = ["0.1", "-0", "1e-3", "2E+2", "-1.5e2", "123456789012345678901", "1e999", "01", "+1", "1.", ".5"];
        let numbers = numbers.into_iter().chain(["1e", "-", "inf", "NaN", "\"1\"", "4.9e-324", "0.30000000000000004"]);
        let usual = [("\"k1\"", "0.5", "-1", "")].into_iter();
        let all = usual
            .chain(ids.map(|id| (id, "0.5", "-1", "")))
            .chain(numbers.clone().map(|number| ("1", number, "2", "")))
            .chain(numbers.map(|number| ("1", "3", number, "")))
            .chain(["5", " ", ", \"stance\": \"left_foot\"", "} x", ""].map(|rest| ("1", "3", "4", rest)));
        let mut pairs: Vec<_> =
            all.map(|(id, pitch, knee, rest)| [line("\"k0\"", "1", "2", ""), line(id, pitch, knee, rest)]).collect();
        for value in ["0.5", "0", "-0", "-1", "1e999", "\"infinite\"", "{\"left_foot\": 1}"] {
            pairs.push([friction("0.8"), friction(value)]);
        }
        for text in pairs.as_flattened() {
            let whole = State::from_json(text, &robot, &defaults);
            assert_eq!(format!("{:?}", lines.read(text)), format!("{:?}", whole.as_ref()), "{text}");
        }
    }
}
