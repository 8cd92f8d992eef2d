//! Lines of states, most of which differ from the line before in a few values only.
//!
//! ```text
//!     {"id": "k17", "position": {"base": {"z": 0.41}}, "friction": 0.8}
//! -----                             ----                 ---      values of a line: id, q, v, friction
//! ```
//!
//! If all bytes but the values equal those of the line that was last read as a whole, only the values are read. Every
//! other line is read as a whole, and so is a line with a value in an unusual form.

use super::documents::utf8;
use super::json::{Node, Value, value_of};
use super::state::{BASE, read};
use crate::law::Friction;
use crate::state::{Defaults, State};
use crate::{Result, Robot};
use std::ops::Range;

/// Reads states line by line, and reuses memory.
#[derive(Debug, Clone)]
pub struct StateLines<'r> {
    robot: &'r Robot,
    defaults: &'r Defaults,
    /// The line that was last read as a whole.
    text: Option<String>,
    /// Where its values are, in order; empty if a value is unusual, so that only an identical line repeats it.
    values: Vec<(Range<usize>, Entry)>,
    /// The state of the last line.
    state: State,
}

/// The meaning of a value in a state.
#[derive(Debug, Clone, Copy)]
enum Entry {
    Id,
    Position(usize),
    Velocity(usize),
    /// The friction of all links, given as a number.
    Friction,
}

impl<'r> StateLines<'r> {
    /// Creates a reader of states of `robot`; `defaults` supply what lines omit.
    pub fn new(robot: &'r Robot, defaults: &'r Defaults) -> Self {
        Self { robot, defaults, text: None, values: Vec::new(), state: State::default() }
    }

    /// Reads the state of a line.
    ///
    /// # Errors
    /// Returns the errors of [`State::from_json`], and an error for bytes that are not UTF-8.
    pub fn read(&mut self, line: &[u8]) -> Result<&State> {
        if self.repeat(line).is_none() {
            let line = utf8(line)?;
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

    /// Reads the values of a line that otherwise equals the last one; `None` if it does not, or if a value is unusual.
    ///
    /// The values that were read before a failure remain, and those of the next line replace them.
    fn repeat(&mut self, line: &[u8]) -> Option<()> {
        let Self { text, values, state, .. } = self;
        let text = text.as_deref()?.as_bytes();
        let (mut rest, mut behind) = (line, 0);
        for (range, entry) in &*values {
            rest = rest.strip_prefix(text.get(behind..range.start)?)?;
            behind = range.end;
            if let Entry::Id = entry {
                let (id, more) = rest.split_at(id_length(rest)?);
                take_id(str::from_utf8(id).ok()?, &mut state.id)?;
                rest = more;
                continue;
            }
            let (value, length) = number(rest)?;
            rest = &rest[length..];
            match *entry {
                Entry::Id => {}
                Entry::Position(coordinate) => state.position[coordinate] = value,
                Entry::Velocity(coordinate) => state.velocity[coordinate] = value,
                Entry::Friction if value < 0.0 => return None,
                Entry::Friction => state.scene.friction.default = Some(Friction::Finite(value)),
            }
        }
        (rest == text.get(behind..)?).then_some(())
    }

    /// Lists the values of a `line` that was read; `None` if a key or a value is unusual.
    fn list(&mut self, tree: &Value, line: &str) -> Option<()> {
        let number_length = |text: &[u8]| Some(number(text)?.1);
        for (key, value) in tree.fields() {
            let entry: fn(usize) -> Entry = match key.as_ref() {
                "position" => Entry::Position,
                "velocity" => Entry::Velocity,
                "id" => {
                    self.values.push((place_of(line, key, id_length)?, Entry::Id));
                    continue;
                }
                "friction" if matches!(value, Value::Number(_)) => {
                    self.values.push((place_of(line, key, number_length)?, Entry::Friction));
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
                    self.values.push((place_of(line, name, number_length)?, entry(coordinate)));
                }
            }
        }
        Some(())
    }
}

/// Returns the range of a key's value; `length` measures the value at the beginning of a text.
fn place_of(line: &str, key: &str, length: impl Fn(&[u8]) -> Option<usize>) -> Option<Range<usize>> {
    let value = value_of(line, key)?;
    let start = line.len() - value.len();
    Some(start..start + length(value.as_bytes())?)
}

/// Returns the length of an id of plain characters or digits; `None` for any other id.
fn id_length(text: &[u8]) -> Option<usize> {
    if let Some(inner) = text.strip_prefix(b"\"") {
        let end = inner.iter().position(|byte| matches!(byte, b'"' | b'\\' | ..b' '))?;
        return (inner[end] == b'"').then_some(end + 2);
    }
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    // Nothing may follow that would continue the number, and no zero may precede other digits.
    let is_plain = !matches!(text.get(digits), Some(b'.' | b'e' | b'E'));
    (is_plain && digits > 0 && (digits == 1 || text[0] != b'0')).then_some(digits)
}

/// Stores an id in the memory of the one before; `None` if it is an integer of more than 64 bits.
fn take_id(id: &str, into: &mut Option<serde_json::Value>) -> Option<()> {
    match (id.strip_prefix('"').and_then(|text| text.strip_suffix('"')), into) {
        (Some(text), Some(serde_json::Value::String(known))) => text.clone_into(known),
        (Some(text), into) => *into = Some(text.into()),
        (None, into) => *into = Some(id.parse::<u64>().ok()?.into()),
    }
    Some(())
}

/// Returns the nearest f64 of the number at the beginning of a text, and its length; `None` if it is beyond the range
/// of f64, or no JSON number (RFC 8259, section 6) although other formats allow it: `.5`, `5.`, `05`, `+5`, `inf`.
fn number(text: &[u8]) -> Option<(f64, usize)> {
    let (value, length): (f64, usize) = fast_float2::parse_partial(text).ok()?;
    let digits = text[..length].strip_prefix(b"-").unwrap_or(&text[..length]);
    let is_digit = |at: usize| digits.get(at).is_some_and(u8::is_ascii_digit);
    let fraction = digits.iter().position(|&byte| byte == b'.');
    let is_json =
        is_digit(0) && (digits[0] != b'0' || !is_digit(1)) && fraction.is_none_or(|point| is_digit(point + 1));
    (is_json && value.is_finite()).then_some((value, length))
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
            assert_eq!(format!("{:?}", lines.read(text.as_bytes())), format!("{:?}", whole.as_ref()), "{text}");
        }
    }
}
