//! Evaluates numbers that are written as expressions of names (the only user of nanoexpr).
//!
//! ```text
//!     "-(alpha + off)^2 / 2"  --names, pi, e, sin, cos, tan, atan2, sqrt, ...-->  f64
//! ```
//!
//! `^` and `**` are powers and bind stronger than a sign: -a^2 = -(a^2). The functions are libm's, so that an
//! expression has the same value on every machine.

use nanoexpr::{Context, ErrorKind, Math, Variables};

/// Names and their values. They hide pi and e; a function of the same name can still be called.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Names(Vec<(String, f64)>);

/// Why an expression has no value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub what: String,
    /// The number of characters of the expression before the fault.
    pub before: usize,
    /// The unknown name, if there is one.
    pub unknown: Option<String>,
}

impl Names {
    /// Adds a name, or changes its value.
    pub fn set(&mut self, name: &str, value: f64) {
        match self.0.iter_mut().find(|(known, _)| known == name) {
            Some((_, old)) => *old = value,
            None => self.0.push((name.to_owned(), value)),
        }
    }

    /// Returns the names, in the order in which they were set.
    pub fn iter(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }

    fn value(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }

    /// Returns the value of an expression, which is finite.
    pub(crate) fn evaluate(&self, text: &str) -> Result<f64, Fault> {
        let variables = Variables(|name: &str| self.value(name));
        nanoexpr::evaluate_with(text, &(variables, Offered)).map_err(|error| {
            let piece = text.get(error.span.start..error.span.end).unwrap_or_default();
            let unknown = matches!(error.kind, ErrorKind::UnknownVariable | ErrorKind::UnknownFunction);
            Fault {
                what: match piece.trim() {
                    "" => error.kind.to_string(),
                    piece => format!("{}: {piece}", error.kind),
                },
                before: text.get(..error.span.start).map_or(0, |before| before.chars().count()),
                unknown: unknown.then(|| piece.to_owned()),
            }
        })
    }
}

/// The functions that an expression can call. `log` is left out, because its base may be e or 10.
pub(crate) const FUNCTIONS: [&str; 31] = [
    "sqrt", "cbrt", "abs", "sign", "exp", "ln", "log2", "log10", "sin", "cos", "tan", "asin", "acos", "atan", "atan2",
    "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "floor", "ceil", "round", "trunc", "pow", "hypot", "min", "max",
    "clamp", "fact",
];

/// The constants that an expression can use. nanoexpr's tau is left out: it is 2 pi there, and a torque to roboticists.
pub(crate) const CONSTANTS: [&str; 2] = ["pi", "e"];

/// The functions and constants of nanoexpr that expressions can use.
struct Offered;

impl Context<f64> for Offered {
    fn variable(&self, name: &str) -> Option<f64> {
        CONSTANTS.contains(&name).then(|| Math.variable(name)).flatten()
    }

    fn call(&self, name: &str, arguments: &[f64]) -> Option<Result<f64, ErrorKind>> {
        FUNCTIONS.contains(&name).then(|| Math.call(name, arguments)).flatten()
    }
}

/// Returns whether an expression can use the name: ASCII letters, digits and underscores, no digit first.
pub(crate) fn is_name(text: &str) -> bool {
    let letter = |c: char| c.is_ascii_alphabetic() || c == '_';
    text.starts_with(letter) && text.chars().all(|c| letter(c) || c.is_ascii_digit())
}

/// Returns the names in an expression, without those of the functions that it calls.
pub(crate) fn names_in(text: &str) -> impl Iterator<Item = &str> {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut rest = text;
    let pieces = std::iter::from_fn(move || {
        let piece = &rest[rest.find(is_part)?..];
        let (piece, behind) = piece.split_at(piece.find(|c| !is_part(c)).unwrap_or(piece.len()));
        rest = behind;
        Some((piece, behind))
    });
    pieces.filter(|(piece, behind)| is_name(piece) && !behind.trim_start().starts_with('(')).map(|(piece, _)| piece)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names() -> Names {
        let mut names = Names::default();
        for (name, value) in [("a", 1.0), ("a", 0.5), ("off", 0.25)] {
            names.set(name, value);
        }
        names
    }

    #[test]
    fn expressions_mean_what_they_look_like() {
        let value = |text: &str| names().evaluate(text).unwrap_or_else(|fault| panic!("{text}: {fault:?}"));
        for (text, expected) in [
            ("-a^2", -0.25),
            ("(-a)^2", 0.25),
            ("2**3**2", 512.0),
            ("2^-1", 0.5),
            ("1e-3*a", 0.0005),
            ("1.5E2", 150.0),
            (".5 - a", 0.0),
            ("a/2/2", 0.125),
            ("8 - 4 - 2", 2.0),
            ("--a", 0.5),
            ("pi", std::f64::consts::PI),
            ("atan2(1, -1)", 0.75 * std::f64::consts::PI),
            ("sqrt(a*a + 2*off) ", libm::sqrt(0.75)),
            ("sin(a)^2 + cos(a)^2", 1.0),
            ("max(a, off)", 0.5),
            ("ln(exp(2)) + log10(1000) + log2(8)", 8.0),
        ] {
            assert_eq!(value(text), expected, "{text}");
        }
        let mut names = names();
        names.set("e", 0.5);
        assert_eq!(names.evaluate("2*e"), Ok(1.0), "before the constant");
    }

    #[test]
    fn a_fault_has_its_place_and_the_unknown_name() {
        let fault = |text: &str| names().evaluate(text).expect_err(text);
        for (text, before, unknown) in
            [("2 * alpa", 4, Some("alpa")), ("sin(a) * (off + lenght)", 16, Some("lenght")), ("a - \u{3b1}", 4, None)]
        {
            let fault = fault(text);
            assert_eq!((fault.before, fault.unknown.as_deref()), (before, unknown), "{text}");
        }
        // The last but one, tau, is a torque to roboticists, and 2 pi to others.
        for text in ["a +", "inf", "1e999", "10^400", "a; b", "tau", "PI"] {
            fault(text);
        }
        let unknown = |name: &str| {
            let error = names().evaluate(&format!("{name}()"));
            error.is_err_and(|fault| fault.unknown.is_some())
        };
        assert!(!FUNCTIONS.into_iter().any(unknown) && unknown("sine") && unknown("log"));
    }

    #[test]
    fn names_have_letters_digits_and_underscores() {
        assert_eq!(names_in("2*a_1 + sin(b)/1e3-1e-c - sin * cos (1)").collect::<Vec<_>>(), ["a_1", "b", "c", "sin"]);
        assert!(["a", "_x1", "leftHip"].into_iter().all(is_name));
        assert!(!["", "1a", "left hip", "\u{3b1}", "a-b"].into_iter().any(is_name));
    }
}
