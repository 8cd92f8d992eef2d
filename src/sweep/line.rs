//! The regions of one parameter and the borders between them.
//!
//! ```text
//!     samples --regimes differ: narrowed; the same: searched--> brackets of width 1e-12 --> regions, borders
//! ```

use super::border_search::{decisive_zero, suspects};
use super::model::{Solver, Watched};
use super::regime::Regime;
use crate::budget::is_spent;
use std::sync::Arc;

/// The accuracy of borders, as a fraction of the parameter's range.
pub const RESOLUTION: f64 = 1e-12;

/// The number of times that a stretch is searched, each time between the borders found before.
const SEARCHES: usize = 3;

/// The distance from a zero at which regimes are computed, as a fraction of the resolution: less than half of it.
const BESIDE: f64 = 0.499;

/// What a search evaluates along a line in the space of parameters.
pub trait Landscape {
    /// Returns the regime of a place.
    fn regime(&mut self, at: f64) -> Arc<Regime>;
    /// Returns the quantities that are followed from place to place; `None` if the place is refused.
    fn watched(&mut self, at: f64) -> Option<Arc<Watched>>;
}

/// A line in the space of all parameters, evaluated by a solver.
pub(super) struct Along<'s, 'm, P> {
    pub solver: &'s mut Solver<'m>,
    /// The values of all parameters at a place.
    pub place: P,
}

impl<P: Fn(f64) -> Vec<f64>> Landscape for Along<'_, '_, P> {
    fn regime(&mut self, at: f64) -> Arc<Regime> {
        self.solver.regime(&(self.place)(at))
    }

    fn watched(&mut self, at: f64) -> Option<Arc<Watched>> {
        self.solver.watched(&(self.place)(at))
    }
}

/// A place and its regime.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// The place.
    pub at: f64,
    /// The regime of the place.
    pub regime: Arc<Regime>,
}

/// Two neighboring places with different regimes.
#[derive(Debug, Clone, PartialEq)]
pub struct Bracket {
    /// The last place before the border.
    pub below: Probe,
    /// The first place beyond it.
    pub above: Probe,
}

impl Bracket {
    /// Returns the place of the border.
    pub fn at(&self) -> f64 {
        0.5 * (self.below.at + self.above.at)
    }
}

/// The first and the last place of a stretch of positive width with one regime.
pub type Stretch = [Probe; 2];

/// Returns the brackets of all borders between two places, ascending, to the accuracy `resolution`.
///
/// If the regimes of two places differ, the border between them is narrowed down, and so are the borders of all other
/// regimes met on the way. If they are the same, the stretch between them is searched for hidden regimes (see
/// `border_search`). In the end every two neighboring evaluated places have the same regime or bracket a border.
/// Nothing is found once a budget is spent.
pub fn brackets(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64) -> Vec<Bracket> {
    let found = bisect(line, a, b, resolution);
    search_between(line, a, b, found, resolution, SEARCHES)
}

/// Returns the brackets `found` between two places, and those that are hidden in the stretches between them. A stretch
/// with hidden borders is searched again between these, because other contacts may be closed there.
fn search_between(
    line: &mut impl Landscape,
    a: &Probe,
    b: &Probe,
    found: Vec<Bracket>,
    resolution: f64,
    searches: usize,
) -> Vec<Bracket> {
    let (mut all, mut from) = (Vec::new(), a.clone());
    for border in found.into_iter().map(Some).chain([None]) {
        let to = border.as_ref().map_or(b, |border| &border.below);
        let inner = if searches == 0 || is_spent() { Vec::new() } else { hidden(line, &from, to, resolution) };
        if !inner.is_empty() {
            all.extend(search_between(line, &from, to, inner, resolution, searches - 1));
        }
        from = border.as_ref().map_or(from, |border| border.above.clone());
        all.extend(border);
    }
    all
}

/// Bisects between two places of different regimes. It begins next to the zero of the deciding quantity.
pub(super) fn bisect(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64) -> Vec<Bracket> {
    let (mut below, mut above) = (a.clone(), b.clone());
    if below.regime == above.regime || is_spent() {
        return Vec::new();
    }
    let zero = decisive_zero(&mut |x| line.watched(x), a.at, b.at, resolution).unwrap_or(f64::NAN);
    // Numbers far from zero may be farther apart than the resolution.
    let mut reach = (BESIDE * resolution).max(f64::EPSILON * zero.abs());
    while above.at - below.at > resolution {
        let beside = [zero - reach, zero + reach].into_iter().find(|&at| below.at < at && at < above.at);
        let at = beside.unwrap_or(0.5 * (below.at + above.at));
        if at <= below.at || at >= above.at {
            break;
        }
        let middle = Probe { at, regime: line.regime(at) };
        // The zero of a small slope may be far from the border because of rounding in f64.
        if middle.regime == if at < zero { &above } else { &below }.regime {
            reach *= 16.0;
        }
        if middle.regime == below.regime {
            below = middle;
        } else if middle.regime == above.regime {
            above = middle;
        } else {
            let mut found = bisect(line, &below, &middle, resolution);
            found.extend(bisect(line, &middle, &above, resolution));
            return found;
        }
    }
    vec![Bracket { below, above }]
}

/// Returns the borders between two places of the same regime.
fn hidden(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64) -> Vec<Bracket> {
    let mut found = Vec::new();
    if b.at - a.at <= resolution || is_spent() {
        return found;
    }
    let mut before = a.clone();
    for at in suspects(&mut |x| line.watched(x), a.at, b.at, resolution) {
        let point = Probe { at, regime: line.regime(at) };
        found.extend(bisect(line, &before, &point, resolution));
        before = point;
    }
    found.extend(bisect(line, &before, b, resolution));
    found
}

/// Returns the stretches from `first` to `last` between the brackets, and the borders between neighboring stretches. A
/// stretch that is not wider than `resolution` is part of a border; two stretches of one regime around it are one
/// stretch.
pub fn stretches(first: Probe, last: Probe, brackets: &[Bracket], resolution: f64) -> (Vec<Stretch>, Vec<Bracket>) {
    let begins = std::iter::once(first).chain(brackets.iter().map(|bracket| bracket.above.clone()));
    let ends = brackets.iter().map(|bracket| bracket.below.clone()).chain([last]);
    let mut stretches: Vec<Stretch> = Vec::new();
    for (from, to) in begins.zip(ends) {
        match stretches.last_mut() {
            _ if to.at - from.at <= resolution => {}
            Some([_, end]) if end.regime == from.regime => *end = to,
            _ => stretches.push([from, to]),
        }
    }
    let border = |pair: &[Stretch]| Bracket { below: pair[0][1].clone(), above: pair[1][0].clone() };
    let borders = stretches.windows(2).map(border).collect();
    (stretches, borders)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Inequalities;
    use crate::law::Mode;

    /// A landscape of one contact: its regime, then whether it is closed, its inequalities and its clearance.
    struct Made<R, W>(R, W);

    impl<R: Fn(f64) -> Option<Mode>, W: Fn(f64) -> (bool, Vec<f64>, Vec<f64>)> Landscape for Made<R, W> {
        fn regime(&mut self, at: f64) -> Arc<Regime> {
            let modes: Vec<Mode> = (self.0)(at).into_iter().collect();
            let contacts = modes.iter().map(|_| "foot".to_owned()).collect();
            Arc::new(Regime::Answered { contacts, outcomes: vec![modes], undecided: Vec::new() })
        }

        /// Watches one combination with det A = 1.
        fn watched(&mut self, at: f64) -> Option<Arc<Watched>> {
            let (closed, numerators, clearance) = (self.1)(at);
            let (determinants, ends) = (vec![1.0], vec![numerators.len()]);
            let inequalities = Inequalities { determinants, ends, numerators, ..Inequalities::default() };
            let contacts = if closed { vec!["foot".to_owned()] } else { Vec::new() };
            Some(Arc::new(Watched { contacts, inequalities, clearance, touching: Vec::new() }))
        }
    }

    /// Checks the borders from 0 to 1, sampled at 11 places, of a contact that sticks where all numbers are positive.
    fn check(numbers: impl Fn(f64) -> Vec<f64>, expected: &[f64]) {
        let sticks = |at: f64| numbers(at).iter().all(|&number| number > 0.0);
        let regime = |at: f64| Some(if sticks(at) { Mode::Stick } else { Mode::SlidePlus });
        let mut line = Made(regime, |at: f64| (false, numbers(at), Vec::new()));
        let points: Vec<Probe> =
            (0..=10).map(|k| f64::from(k) / 10.0).map(|at| Probe { at, regime: line.regime(at) }).collect();
        let mut all = Vec::new();
        for pair in points.windows(2) {
            all.extend(brackets(&mut line, &pair[0], &pair[1], RESOLUTION));
        }
        let (list, borders) = stretches(points[0].clone(), points[10].clone(), &all, RESOLUTION);
        assert!(list[0][0].at <= RESOLUTION && list[list.len() - 1][1].at == 1.0);
        assert!(list.windows(2).all(|pair| pair[0][1].regime != pair[1][0].regime));
        assert_eq!(list.len(), borders.len() + 1);
        near(&borders, expected);
    }

    fn near(found: &[Bracket], expected: &[f64]) {
        let found: Vec<f64> = found.iter().map(Bracket::at).collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-12), "{found:?} {expected:?}");
    }

    #[test]
    fn borders_lie_where_a_number_passes_zero() {
        check(|x| vec![x - 0.123_456_789], &[0.123_456_789]);
        check(|x| vec![(x - 0.31) * (0.32 - x)], &[0.31, 0.32]);
        // Borders between two samples of different regimes: between 0.4 and 0.5 the sign is -, +, -, +.
        check(|x| vec![(x - 0.41) * (x - 0.410_01) * (x - 0.48)], &[0.41, 0.410_01, 0.48]);
        // A single place is no region.
        check(|x| vec![(x - 0.3).abs()], &[]);
        check(|x| vec![x], &[]);
    }

    #[test]
    fn borders_far_from_zero_are_found() {
        for offset in [1e4, 1e7, -1e10] {
            let regime = |at: f64| Some(if at < offset + 0.45 { Mode::Stick } else { Mode::SlidePlus });
            let mut line = Made(regime, |at: f64| (false, vec![offset + 0.45 - at], Vec::new()));
            let ends = [0.4, 0.5].map(|at| Probe { at: offset + at, regime: line.regime(offset + at) });
            let found = brackets(&mut line, &ends[0], &ends[1], 1e-13);
            let [border] = &found[..] else { panic!("{found:?}") };
            assert!((border.at() - offset - 0.45).abs() < 4.0 * f64::EPSILON * f64::abs(offset), "{found:?}");
        }
    }

    #[test]
    fn zeros_near_the_end_of_a_wide_interval_are_found() {
        let cubic = |x: f64| (x - 0.55) * (x - 0.556) * (x - 0.561);
        let sticks = |at: f64| if cubic(at) > 0.0 { Mode::Stick } else { Mode::SlidePlus };
        let mut line = Made(|at: f64| Some(sticks(at)), |at: f64| (false, vec![cubic(at)], Vec::new()));
        let ends = [0.5, 1.0].map(|at| Probe { at, regime: line.regime(at) });
        near(&brackets(&mut line, &ends[0], &ends[1], RESOLUTION), &[0.55, 0.556, 0.561]);
    }

    #[test]
    fn thin_region_of_unseen_contacts_is_found() {
        // The foot is down between two samples. It then sticks, except on a thin stretch.
        const THIN: [f64; 2] = [0.4512, 0.451_201];
        let down = |at: f64| (0.41..0.49).contains(&at);
        let mode = |at: f64| if THIN[0] < at && at < THIN[1] { Mode::SlidePlus } else { Mode::Stick };
        let watched = |at: f64| {
            let numerators = if down(at) { vec![at - THIN[0], THIN[1] - at] } else { Vec::new() };
            (down(at), numerators, vec![(at - 0.41) * (at - 0.49)])
        };
        let mut stepping = Made(|at| down(at).then(|| mode(at)), watched);
        let ends = [0.4, 0.5].map(|at| Probe { at, regime: stepping.regime(at) });
        let found = brackets(&mut stepping, &ends[0], &ends[1], RESOLUTION);
        near(&found, &[0.41, THIN[0], THIN[1], 0.49]);
    }
}
