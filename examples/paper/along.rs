//! Checks claims against the regions of a figure along one parameter.

use super::exhibit::Found;
use super::figures::Finding;
use heelstrike::sweep::Regime;

/// The modes of an outcome, trailing/leading, as "slide-/stick".
pub type Modes = &'static str;

/// The modes of every outcome of a regime, as "slide-/stick".
pub fn modes(regime: &Regime) -> Vec<String> {
    let outcome = |modes: &Vec<_>| modes.iter().map(ToString::to_string).collect::<Vec<String>>().join("/");
    regime.outcomes().unwrap_or_default().iter().map(outcome).collect()
}

/// Checks that the regions have these outcomes in this order.
pub fn order(found: &Found, expected: &[&[Modes]]) -> Result<Finding, String> {
    ordered(found, expected, |_| true)
}

/// Checks that the regions have these outcomes in this order, without slides.
pub fn order_without_slides(found: &Found, expected: &[&[Modes]]) -> Result<Finding, String> {
    ordered(found, expected, |modes| !modes.contains("slide"))
}

fn ordered(found: &Found, expected: &[&[Modes]], counts: impl Fn(&str) -> bool) -> Result<Finding, String> {
    let regions = &found.survey()?.regions;
    let all: Vec<Vec<String>> = regions
        .iter()
        .map(|region| modes(&region.regime).into_iter().filter(|modes| counts(modes)).collect())
        .collect();
    let word = |modes: &Vec<String>| if modes.is_empty() { "nothing".to_owned() } else { modes.join(" or ") };
    let said = regions.iter().zip(&all).map(|(region, all)| format!("{} from {:.6}", word(all), region.from));
    Ok(Finding { words: said.collect::<Vec<_>>().join(", "), agrees: Some(all == expected) })
}

/// The outcomes of a region, and its start and end in the paper.
pub type Band<'a> = (&'a [Modes], f64, f64);

/// Checks that the regions with a slide among their outcomes are these, to `within`.
pub fn bands(found: &Found, expected: &[Band], within: f64) -> Result<Finding, String> {
    let regions = found.survey()?.regions.iter().map(|region| (modes(&region.regime), region.from, region.to));
    let bands: Vec<_> = regions.filter(|(modes, ..)| modes.iter().any(|modes| modes.contains("slide"))).collect();
    let agrees = bands.len() == expected.len()
        && bands.iter().zip(expected).all(|((modes, from, to), (should, printed_from, printed_to))| {
            modes == should && (from - printed_from).abs() <= within && (to - printed_to).abs() <= within
        });
    let said = bands.iter().map(|(modes, from, to)| format!("{} {from:.4}..{to:.4}", modes.join(" or ")));
    Ok(Finding { words: said.collect::<Vec<_>>().join(", "), agrees: Some(agrees) })
}
