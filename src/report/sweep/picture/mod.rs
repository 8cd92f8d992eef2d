//! Studies as pictures.
//!
//! ```text
//!     Survey --> Courses --[along]--> velocities after and impulses of each contact against the parameter, regions shaded
//!                        --[angles]-> beta and gamma against the parameter, and what they cut
//!     Map    --[map, place]---------> areas with letters in the plane of two parameters
//! ```

mod along;
mod angles;
mod map;
mod place;

use super::{Happening, letter};
use crate::Error;
use crate::report::ErrorObject;
use crate::report::picture::{Axis, Colour, Picture};
use crate::sweep::{Course, Findings, Model, Regime, Workers};

/// What the findings of `model` look like; tells `workers` of [`work`] pieces of work.
pub fn of(model: &Model, findings: &Findings, workers: Workers) -> Picture {
    match findings {
        Findings::Along(survey) => along::picture(axis(model, 0), survey, &Course::of(model, survey, workers)),
        Findings::Map(map) => map::picture([axis(model, 0), axis(model, 1)], map),
    }
}

/// How many pieces of work a picture of the findings takes.
pub fn work(model: &Model, findings: &Findings) -> usize {
    match findings {
        Findings::Along(survey) => Course::work(model, survey),
        Findings::Map(_) => 0,
    }
}

/// The axis of a parameter.
fn axis(model: &Model, parameter: usize) -> Axis {
    let Some(known) = model.study.parameters().get(parameter) else { return Axis::default() };
    let name = with_greek_letters(&known.name);
    let label = match model.unit(parameter) {
        Some(unit) => format!("{name} [{unit}]"),
        None => name,
    };
    Axis { label, range: Some((known.from, known.to)), ..Axis::default() }
}

/// A name whose parts are letters of the Greek alphabet where they are called so: `delta_alpha` is δ_α.
fn with_greek_letters(name: &str) -> String {
    const LETTERS: [(&str, &str); 24] = [
        ("alpha", "α"),
        ("beta", "β"),
        ("gamma", "γ"),
        ("delta", "δ"),
        ("epsilon", "ε"),
        ("zeta", "ζ"),
        ("eta", "η"),
        ("theta", "θ"),
        ("iota", "ι"),
        ("kappa", "κ"),
        ("lambda", "λ"),
        ("mu", "μ"),
        ("nu", "ν"),
        ("xi", "ξ"),
        ("omicron", "ο"),
        ("pi", "π"),
        ("rho", "ρ"),
        ("sigma", "σ"),
        ("tau", "τ"),
        ("upsilon", "υ"),
        ("phi", "φ"),
        ("chi", "χ"),
        ("psi", "ψ"),
        ("omega", "ω"),
    ];
    let part =
        |part: &str| LETTERS.iter().find(|(called, _)| *called == part).map_or(part.to_owned(), |(_, is)| (*is).into());
    name.split('_').map(part).collect::<Vec<_>>().join("_")
}

/// What happens where a regime holds, by the letter of its kind.
struct Kind<'a> {
    letter: String,
    colour: Colour,
    happening: Happening<'a>,
}

impl<'a> Kind<'a> {
    fn new(kind: usize, regime: &'a Regime, refused: Option<&'a Error>) -> Self {
        let colour = match regime {
            Regime::Answered { .. } => Colour::Tint(kind),
            Regime::Refused { .. } => Colour::Pale,
        };
        Self { letter: letter(kind), colour, happening: Happening::of(regime, refused.map(ErrorObject::new)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_greek_letters_become_letters_where_they_stand_alone() {
        let names = ["alpha", "delta_alpha", "left_hip_angle", "alphabet", "mu", "l_1"].map(with_greek_letters);
        assert_eq!(names, ["α", "δ_α", "left_hip_angle", "alphabet", "μ", "l_1"]);
    }
}
