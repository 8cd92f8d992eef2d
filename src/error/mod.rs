//! Errors: what was refused, where, and the remedy.
//!
//! Physical results such as "no outcome" and "on the border" are values. An [`Error`] always means that an input was
//! not accepted. It names the place and, if one is known, the remedy.

mod visible;
pub mod excerpt;

pub use visible::visible;

use std::borrow::Cow;
use std::fmt;

/// Shorthand for results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

/// Why an input was refused; `what` is the kind of thing or the quantity, as in `joint`.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Reason {
    /// The text is not well-formed XML, JSON or the like.
    #[error("{}", short(.0))]
    Syntax(String),
    /// A field that the format does not have.
    #[error("unknown field \"{}\"", short(.0))]
    UnknownField(String),
    /// A link, joint or other thing that the robot does not have.
    #[error("the robot has no {what} named \"{}\"", short(.name))]
    UnknownName { what: &'static str, name: String },
    /// A name or key that occurs twice.
    #[error("{what} \"{}\" is given twice", short(.name))]
    Duplicate { what: &'static str, name: String },
    /// A value of the wrong kind, such as `a string` where `a number` is expected.
    #[error("expected {expected}, found {found}")]
    WrongKind { expected: &'static str, found: &'static str },
    /// Something required that is absent.
    #[error("{} is missing", short(.0))]
    Missing(String),
    /// A number that is NaN or infinite.
    #[error("{} must be a finite number, not {value}", short(.what))]
    NotFinite { what: String, value: f64 },
    /// A number outside its range, which is `allowed`, as in `between 0 and 1`.
    #[error("{} must be {allowed}, not {}", short(.what), brief(*.value))]
    OutOfRange { what: String, allowed: &'static str, value: f64 },
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
    /// A shape of a URDF link that is deeper in the ground than the tolerance, both in m; if known, the velocity of its
    /// lowest point, `[tangential, normal]` in m/s.
    #[error(
        "link \"{}\" is {} m deep in the ground, more than the contact tolerance of {} m{}",
        short(.link),
        rounded(*.depth),
        rounded(*.tolerance),
        velocity.map_or(String::new(), |velocity| format!(", and {}", along_normal(velocity)))
    )]
    Penetration { link: String, depth: f64, tolerance: f64, velocity: Option<[f64; 2]> },
    /// More closed contacts than are accepted where all combinations of modes are enumerated.
    #[error("{contacts} contacts are closed, and every combination of modes is tried for {limit} at most")]
    TooManyContacts { contacts: usize, limit: usize },
    /// More closed contacts than are accepted where matrices are formed.
    #[error("{contacts} contacts are closed, and matrices are formed for {limit} at most")]
    MatricesTooLarge { contacts: usize, limit: usize },
    /// More things of a kind, such as `links`, than are accepted.
    #[error("more than {limit} {what} are not accepted")]
    TooMany { what: &'static str, limit: usize },
    /// Work that needs more memory than is allowed \[MB\].
    #[error("this needs {needed} MB of memory, and {limit} MB are the most")]
    TooLarge { needed: usize, limit: usize },
    /// Work that takes more time than its budget allows.
    #[error("the budget of work ended before the answer was known")]
    BeyondBudget,
    /// A file that could not be read or written.
    #[error("{}", visible(.0))]
    Io(String),
}

/// A line and a column of a text \[characters\], both counted from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Location {
    /// The line.
    pub line: usize,
    /// The column, in characters.
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
#[derive(Debug, Clone, thiserror::Error)]
#[error(transparent)]
pub struct Error(Box<Refusal>);

#[derive(Debug, Clone, thiserror::Error)]
struct Refusal {
    reason: Reason,
    file: Option<String>,
    location: Option<Location>,
    place: Option<String>,
    hint: Option<String>,
}

impl Error {
    /// Creates an error for `reason`, without a place.
    pub fn new(reason: Reason) -> Self {
        Self(Box::new(Refusal { reason, file: None, location: None, place: None, hint: None }))
    }

    /// Sets the place inside the input, as in `position.joints.left_hip` or `link "shank"`; empty for the whole input.
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.0.place = Some(short(&place.into()).into_owned()).filter(|place| !place.is_empty());
        self
    }

    /// Sets the line and column.
    pub fn on(mut self, line: usize, column: usize) -> Self {
        self.0.location = Some(Location { line, column });
        self
    }

    /// Changes line and column, if there are any.
    pub(crate) fn relocated(mut self, change: impl FnOnce(Location) -> Location) -> Self {
        self.0.location = self.0.location.map(change);
        self
    }

    /// Removes line and column, for an input that has none.
    pub fn nowhere(mut self) -> Self {
        self.0.location = None;
        self
    }

    /// Sets the file.
    pub fn in_file(mut self, file: impl Into<String>) -> Self {
        self.0.file = Some(visible(&file.into()).into_owned());
        self
    }

    /// Sets the remedy.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.0.hint = Some(short(&hint.into()).into_owned());
        self
    }

    /// Suggests the known name that is nearest to `name`. If none is near and there is no hint yet, lists all known
    /// names, if they are few.
    pub fn did_you_mean<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let known: Vec<&str> = known.into_iter().collect();
        let few = (2..=FEW_NAMES).contains(&known.len()) && known.iter().all(|name| name.len() <= LONGEST_NAME / 10);
        match nearest(name, known.iter().copied()) {
            Some(found) => self.hint(format!("did you mean {found}?")),
            None if few && self.0.hint.is_none() => self.hint(format!("known here: {}", known.join(", "))),
            None => self,
        }
    }

    /// Returns why the input was refused.
    pub fn reason(&self) -> &Reason {
        &self.0.reason
    }

    /// Returns the file, where known.
    pub fn file(&self) -> Option<&str> {
        self.0.file.as_deref()
    }

    /// Returns line and column, where the format has them.
    pub fn location(&self) -> Option<Location> {
        self.0.location
    }

    /// Returns the place inside the input.
    pub fn place(&self) -> Option<&str> {
        self.0.place.as_deref()
    }

    /// Returns the remedy.
    pub fn remedy(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }
}

impl fmt::Display for Refusal {
    /// Writes `file:line:column: place: reason`, as far as known, without the remedy.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reason, file, location, place, .. } = self;
        match (file, location) {
            (Some(file), Some(Location { line, column })) => write!(f, "{file}:{line}:{column}: ")?,
            (Some(file), None) => write!(f, "{file}: ")?,
            (None, Some(Location { line, column })) => write!(f, "{line}:{column}: ")?,
            (None, None) => {}
        }
        if let Some(place) = place {
            write!(f, "{place}: ")?;
        }
        write!(f, "{reason}")
    }
}

impl From<Reason> for Error {
    fn from(reason: Reason) -> Self {
        Self::new(reason)
    }
}

/// The greatest length of names that are compared \[bytes\], because the cost is the product of their lengths.
const LONGEST_NAME: usize = 200;

/// The greatest number of known names that are listed where none is near.
const FEW_NAMES: usize = 12;

/// Returns the known name that is most similar to `name`; `None` if none is similar.
fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let comparable = |candidate: &&str| name.len().max(candidate.len()) <= LONGEST_NAME;
    let name = name.to_lowercase();
    let likeness = |candidate: &'a str| (strsim::jaro_winkler(&name, &candidate.to_lowercase()), candidate);
    let near = known.into_iter().filter(comparable).map(likeness).filter(|(likeness, _)| *likeness > 0.8);
    near.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, candidate)| candidate)
}

/// Returns the text with control characters made visible. If a hostile name makes it long, its middle is left out: the
/// refusal of a line of 1 MB stays short.
fn short(text: &str) -> Cow<'_, str> {
    const LONGEST: usize = 400;
    const HEAD: usize = 80;
    const TAIL: usize = 40;
    if text.chars().nth(LONGEST).is_none() {
        return visible(text);
    }
    let head: String = text.chars().take(HEAD).collect();
    let tail = text.char_indices().nth_back(TAIL - 1).map_or(text, |(start, _)| &text[start..]);
    Cow::Owned(visible(&format!("{head}...{tail}")).into_owned())
}

/// Describes how a point with velocity `[tangential, normal]` \[m/s\] moves toward the ground or away from it.
pub(crate) fn along_normal([_, normal]: [f64; 2]) -> String {
    if normal == 0.0 {
        return "does not move toward it".to_owned();
    }
    format!("moves {} it at {} m/s", if normal < 0.0 { "toward" } else { "away from" }, rounded(normal.abs()))
}

/// Formats a number with four digits, as 0.87 and 9.6e-5: with an exponent below 1e-3 and from 1e4 on.
pub(crate) fn rounded(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e4).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Returns the number with the fewest digits that is within `tolerance` of `value`.
pub(crate) fn shortest_within(value: f64, tolerance: f64) -> f64 {
    let with_digits = |digits| format!("{value:.digits$e}").parse().ok();
    (0..17).filter_map(with_digits).find(|short: &f64| (short - value).abs() <= tolerance).unwrap_or(value)
}

/// Formats a number without an exponent if that is shorter or has at most 18 characters, else as 1e-300.
fn brief(value: f64) -> String {
    let (plain, scientific) = (value.to_string(), format!("{value:e}"));
    if plain.len() <= scientific.len().max(18) { plain } else { scientific }
}

/// Returns `value`, or an error that names it `what` if it is NaN or infinite.
#[inline]
pub(crate) fn finite(value: f64, what: impl FnOnce() -> String) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Reason::NotFinite { what: what(), value }.into()) }
}

/// Returns `value`, or an error that names it `what` if it is not a finite number from 0 on.
#[inline]
pub(crate) fn from_zero(value: f64, what: &str) -> Result<f64> {
    let value = finite(value, || what.into())?;
    if value >= 0.0 {
        return Ok(value);
    }
    Err(Reason::OutOfRange { what: what.into(), allowed: "0 or more", value }.into())
}

/// Refuses an index of something, such as `links`, of which the robot has `count`.
#[inline]
pub(crate) fn check_index(index: usize, (what, count): (&str, usize)) -> Result<()> {
    if index < count {
        return Ok(());
    }
    let reason = format!("no index {index}: the robot has {count} {what}, counted from 0");
    Err(Error::new(Reason::Inconsistent(reason)).hint("take indices from this robot"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_of_errors_says_each_reason_once() {
        let error = Error::new(Reason::Missing("friction".into()));
        assert!(std::error::Error::source(&error).is_none());
    }

    #[test]
    fn ordinary_numbers_have_no_exponent() {
        let written = [0.0, 0.87, 1.0, 9999.0, 9999.9, -1e-3, 9.600292e-5, f64::INFINITY].map(rounded);
        assert_eq!(written, ["0", "0.87", "1", "9999", "1e4", "-0.001", "9.6e-5", "inf"]);
    }

    #[test]
    fn advice_has_the_digits_that_it_needs() {
        let short = [1.0, 1e-6, 0.0].map(|tolerance| shortest_within(0.870_000_000_000_000_1, tolerance));
        assert_eq!(short, [0.9, 0.87, 0.870_000_000_000_000_1]);
    }
}
