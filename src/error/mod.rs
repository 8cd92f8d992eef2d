//! Errors: what was refused, where, and the remedy.
//!
//! Physics is a value, refusal is an error: "no outcome" or "on the border" are data, and an [`Error`] always means
//! that an input was not accepted. Every error names its place and, where one is known, the remedy.

pub mod excerpt;

use std::borrow::Cow;
use std::fmt;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why an input was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The text is not well-formed XML, JSON or the like.
    #[error("{}", short(.0))]
    Syntax(String),
    /// A field that the format does not have.
    #[error("unknown field \"{}\"", short(.0))]
    UnknownField(String),
    /// A link, joint or other thing that the robot does not have.
    #[error("the robot has no {what} named \"{}\"", short(.name))]
    UnknownName {
        /// The kind of thing, such as `link`.
        what: &'static str,
        /// The name as given.
        name: String,
    },
    /// A name or key that stands twice.
    #[error("{what} \"{}\" is given twice", short(.name))]
    Duplicate {
        /// The kind of thing, such as `joint`.
        what: &'static str,
        /// The name that is given twice.
        name: String,
    },
    /// A value of the wrong kind, such as a string for a number.
    #[error("expected {expected}, found {found}")]
    WrongKind {
        /// What would be accepted, as in `a number`.
        expected: &'static str,
        /// What stands there, as in `a string`.
        found: &'static str,
    },
    /// Something required is not there.
    #[error("{} is missing", short(.0))]
    Missing(String),
    /// A number that is NaN or infinite.
    #[error("{what} must be a finite number, not {value}")]
    NotFinite {
        /// The quantity.
        what: String,
        /// The value as given.
        value: f64,
    },
    /// A number outside its range.
    #[error("{what} must be {allowed}, not {}", brief(*.value))]
    OutOfRange {
        /// The quantity.
        what: String,
        /// What would be accepted, as in `between 0 and 1`.
        allowed: &'static str,
        /// The value as given.
        value: f64,
    },
    /// Two inputs that contradict each other, or an array of the wrong shape.
    #[error("{}", short(.0))]
    Inconsistent(String),
    /// Joints that form no tree: two roots, two parents, a cycle, an unknown link.
    #[error("{}", short(.0))]
    NotATree(String),
    /// A well-formed input that this version does not handle.
    #[error("{}", short(.0))]
    Unsupported(String),
    /// A coordinate without inertia, so that the mass matrix is singular.
    #[error("the mass matrix is singular: nothing resists a motion of {}", short(.0))]
    Singular(String),
    /// A shape that is deeper in the ground than the tolerance.
    #[error(
        "link \"{}\" is {depth:.3e} m deep in the ground, more than the contact tolerance of {tolerance:.3e} m",
        short(.link)
    )]
    Penetration {
        /// The URDF link.
        link: String,
        /// The depth \[m\].
        depth: f64,
        /// The tolerance \[m\].
        tolerance: f64,
    },
    /// More contacts than the enumeration of all modes serves.
    #[error("{contacts} contacts are closed, and every combination of modes is tried for {limit} at most")]
    TooManyContacts {
        /// The number of closed contacts.
        contacts: usize,
        /// The most that is accepted.
        limit: usize,
    },
    /// More contacts than matrices are formed for.
    #[error("{contacts} contacts are closed, and matrices are formed for {limit} at most")]
    MatricesTooLarge {
        /// The number of closed contacts.
        contacts: usize,
        /// The most that is accepted.
        limit: usize,
    },
    /// More of a thing than a robot may have.
    #[error("more than {limit} {what} are not accepted")]
    TooMany {
        /// The kind of thing, such as `links`.
        what: &'static str,
        /// The most that is accepted.
        limit: usize,
    },
    /// A file that could not be read or written.
    #[error("{0}")]
    Io(String),
}

/// A line and column of a text, both counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Location {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// A refused input: the reason, its place, and the remedy.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// let error = heelstrike::Robot::from_urdf("<robot/>").expect_err("no link");
/// println!("{error}; remedy: {:?}", error.remedy());
/// assert_eq!(error.reason().to_string(), "a <link> is missing");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Error(Box<Refusal>);

#[derive(Debug, Clone)]
struct Refusal {
    reason: Reason,
    file: Option<String>,
    location: Option<Location>,
    place: Option<String>,
    hint: Option<String>,
}

impl Error {
    /// A refusal for `reason`, its place still unknown.
    pub fn new(reason: Reason) -> Self {
        Self(Box::new(Refusal { reason, file: None, location: None, place: None, hint: None }))
    }

    /// Names the place inside the input, as in `position.joints.left_hip` or `link "shank"`.
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.0.place = Some(short(&place.into()).into_owned());
        self
    }

    /// Gives the line and column.
    pub fn on(mut self, line: usize, column: usize) -> Self {
        self.0.location = Some(Location { line, column });
        self
    }

    /// Names the file.
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.0.file = Some(file.into());
        self
    }

    /// Adds the remedy.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.0.hint = Some(short(&hint.into()).into_owned());
        self
    }

    /// Hints at the known name nearest to `name`, if one is near.
    pub fn did_you_mean<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        match nearest(name, known) {
            Some(found) => self.hint(format!("did you mean {found}?")),
            None => self,
        }
    }

    /// Why the input was refused.
    pub fn reason(&self) -> &Reason {
        &self.0.reason
    }

    /// The file, where known.
    pub fn file(&self) -> Option<&str> {
        self.0.file.as_deref()
    }

    /// Line and column, where the format has them.
    pub fn location(&self) -> Option<Location> {
        self.0.location
    }

    /// The place inside the input.
    pub fn place(&self) -> Option<&str> {
        self.0.place.as_deref()
    }

    /// The remedy.
    pub fn remedy(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }
}

impl fmt::Display for Error {
    /// `file:line:column: place: reason`, as far as known, without the remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Refusal { reason, file, location, place, .. } = &*self.0;
        if let Some(file) = file {
            write!(f, "{file}:")?;
        }
        if let Some(Location { line, column }) = location {
            write!(f, "{line}:{column}:")?;
        }
        if file.is_some() || location.is_some() {
            f.write_str(" ")?;
        }
        if let Some(place) = place {
            write!(f, "{place}: ")?;
        }
        write!(f, "{reason}")
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.0.reason)
    }
}

impl From<Reason> for Error {
    fn from(reason: Reason) -> Self {
        Self::new(reason)
    }
}

/// The most characters of a name that is compared with others: the comparison takes the product of their lengths.
const LONGEST_NAME: usize = 200;

/// The known name most like `name`, if any is like it at all.
fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let comparable = |name: &str| name.len() <= LONGEST_NAME;
    known
        .into_iter()
        .filter(|candidate| comparable(name) && comparable(candidate))
        .map(|candidate| (strsim::jaro_winkler(name, candidate), candidate))
        .filter(|(likeness, _)| *likeness > 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// The text, without its middle if a hostile name makes it long: a refusal of a line of 1 MB stays short.
fn short(text: &str) -> Cow<'_, str> {
    const LONGEST: usize = 400;
    const HEAD: usize = 80;
    const TAIL: usize = 40;
    if text.len() <= LONGEST {
        return Cow::Borrowed(text);
    }
    let head: String = text.chars().take(HEAD).collect();
    let tail = text.char_indices().nth_back(TAIL - 1).map_or(text, |(start, _)| &text[start..]);
    Cow::Owned(format!("{head}...{tail}"))
}

/// The number in the shorter of its two forms: 0.5 and 1e-300.
fn brief(value: f64) -> String {
    let (plain, scientific) = (value.to_string(), format!("{value:e}"));
    if plain.len() <= scientific.len().max(18) { plain } else { scientific }
}

/// `value`, unless it is NaN or infinite.
///
/// # Errors
/// [`Reason::NotFinite`], naming `what`.
pub(crate) fn finite(value: f64, what: impl FnOnce() -> String) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Reason::NotFinite { what: what(), value }.into()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_names_the_place_from_the_outside_in() {
        let error = Error::new(Reason::Missing("friction".into())).at("state").on(3, 7).in_file("a.json");
        assert_eq!(error.to_string(), "a.json:3:7: state: friction is missing");
    }

    #[test]
    fn a_refusal_of_a_long_name_stays_short() {
        let name = "é".repeat(1_000_000);
        let reason = Reason::UnknownName { what: "joint", name: name.clone() };
        let error = Error::new(reason).at(format!("position.joints.{name}")).did_you_mean(&name, [name.as_str()]);
        assert!(error.to_string().len() < 700, "{error}");
        assert_eq!(error.remedy(), None);
    }

    #[test]
    fn nearest_name_is_offered_only_when_it_is_near() {
        assert_eq!(nearest("left_hipp", ["left_knee", "left_hip"]), Some("left_hip"));
        assert_eq!(nearest("zzz", ["left_knee", "left_hip"]), None);
    }
}
