//! The regions of one parameter and the borders between them.
//!
//! ```text
//!     samples --regimes differ: bisect; the same: search--> brackets of width 1e-12 --> regions, borders
//! ```

use super::border_search::suspects;
use super::model::{Solver, Watched};
use super::regime::Regime;
use std::sync::Arc;

/// Borders are bisected to this part of the parameter's range.
pub const RESOLUTION: f64 = 1e-12;

/// How often a stretch is searched, each time between the borders that were found the time before.
const SEARCHES: usize = 3;

/// What is asked along a line of parameters.
pub trait Landscape {
    /// What happens at a place.
    fn regime(&mut self, at: f64) -> Arc<Regime>;
    /// The quantities that are followed from place to place; `None` if the place is refused.
    fn watched(&mut self, at: f64) -> Option<Watched>;
}

/// Places of a line in the space of all parameters, answered by a solver.
pub(super) struct Along<'s, 'm, P> {
    pub solver: &'s mut Solver<'m>,
    /// The values of all parameters at a place.
    pub place: P,
}

impl<P: Fn(f64) -> Vec<f64>> Landscape for Along<'_, '_, P> {
    fn regime(&mut self, at: f64) -> Arc<Regime> {
        self.solver.regime(&(self.place)(at))
    }

    fn watched(&mut self, at: f64) -> Option<Watched> {
        self.solver.watched(&(self.place)(at))
    }
}

/// A place and what happens there.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// The place.
    pub at: f64,
    /// What happens.
    pub regime: Arc<Regime>,
}

/// Two neighboring places of different regimes.
#[derive(Debug, Clone, PartialEq)]
pub struct Bracket {
    /// The lower one.
    pub below: Probe,
    /// The upper one.
    pub above: Probe,
}

impl Bracket {
    /// Where the border is.
    pub fn at(&self) -> f64 {
        0.5 * (self.below.at + self.above.at)
    }
}

/// A stretch of one regime; of positive width.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// What happens in it.
    pub regime: Arc<Regime>,
}

/// The brackets of all borders between two places, ascending, to the `resolution`.
///
/// If the regimes of two places differ, the border between them is bisected, and so is that of every other regime on
/// the way. If they are the same, the stretch between them is searched for hidden ones (see `border_search`). So in the
/// end every neighboring pair of places that were asked agrees, or brackets a border.
pub fn brackets(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64) -> Vec<Bracket> {
    let mut found = Vec::new();
    bisect(line, a, b, resolution, &mut found);
    search_between(line, a, b, found, resolution, SEARCHES)
}

/// The brackets `found` between two places, and those that the stretches between them hide. A stretch that hid some is
/// searched again between these, since other contacts may be closed there.
fn search_between(
    line: &mut impl Landscape,
    a: &Probe,
    b: &Probe,
    found: Vec<Bracket>,
    resolution: f64,
    searches: usize,
) -> Vec<Bracket> {
    if searches == 0 {
        return found;
    }
    let begins: Vec<Probe> = std::iter::once(a).chain(found.iter().map(|bracket| &bracket.above)).cloned().collect();
    let ends: Vec<Probe> = found.iter().map(|bracket| &bracket.below).chain([b]).cloned().collect();
    let mut all = Vec::new();
    let mut borders = found.into_iter();
    for (from, to) in begins.iter().zip(&ends) {
        let inner = hidden(line, from, to, resolution);
        all.extend(match inner.is_empty() {
            true => inner,
            false => search_between(line, from, to, inner, resolution, searches - 1),
        });
        all.extend(borders.next());
    }
    all
}

/// Bisects where the regimes of two places differ.
fn bisect(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64, found: &mut Vec<Bracket>) {
    let (mut below, mut above) = (a.clone(), b.clone());
    if below.regime == above.regime {
        return;
    }
    while above.at - below.at > resolution {
        let at = 0.5 * (below.at + above.at);
        if at <= below.at || at >= above.at {
            break;
        }
        let middle = Probe { at, regime: line.regime(at) };
        if middle.regime == below.regime {
            below = middle;
        } else if middle.regime == above.regime {
            above = middle;
        } else {
            bisect(line, &below, &middle, resolution, found);
            bisect(line, &middle, &above, resolution, found);
            return;
        }
    }
    found.push(Bracket { below, above });
}

/// Borders between two places of the same regime.
fn hidden(line: &mut impl Landscape, a: &Probe, b: &Probe, resolution: f64) -> Vec<Bracket> {
    let mut found = Vec::new();
    if b.at - a.at <= resolution {
        return found;
    }
    let mut before = a.clone();
    for at in suspects(&mut |x| line.watched(x), a.at, b.at, resolution) {
        let point = Probe { at, regime: line.regime(at) };
        bisect(line, &before, &point, resolution, &mut found);
        before = point;
    }
    bisect(line, &before, b, resolution, &mut found);
    found
}

/// The stretches from `first` to `last` between the brackets, and the border between each two of them. What is not
/// wider than the `resolution` is part of a border; stretches of one regime with only such a point between them are
/// one.
pub fn stretches(first: Probe, last: Probe, brackets: &[Bracket], resolution: f64) -> (Vec<Stretch>, Vec<Bracket>) {
    let (from, to) = (first.at, last.at);
    let begins = std::iter::once(first).chain(brackets.iter().map(|bracket| bracket.above.clone()));
    let ends = brackets.iter().map(|bracket| bracket.below.clone()).chain([last]);
    let mut pieces: Vec<Bracket> = Vec::new();
    for (below, above) in begins.zip(ends) {
        match pieces.last_mut() {
            _ if above.at - below.at <= resolution => {}
            Some(piece) if piece.above.regime == below.regime => piece.above = above,
            _ => pieces.push(Bracket { below, above }),
        }
    }
    let border = |pair: &[Bracket]| Bracket { below: pair[0].above.clone(), above: pair[1].below.clone() };
    let borders: Vec<Bracket> = pieces.windows(2).map(border).collect();
    let begins = std::iter::once(from).chain(borders.iter().map(Bracket::at));
    let ends = borders.iter().map(Bracket::at).chain([to]);
    let stretch =
        |(piece, (from, to)): (&Bracket, (f64, f64))| Stretch { from, to, regime: piece.below.regime.clone() };
    (pieces.iter().zip(begins.zip(ends)).map(stretch).collect(), borders)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Inequalities;
    use crate::law::Mode;

    /// A landscape of one contact, which sticks where all its numbers are positive, and slides where they are not.
    struct Made<F>(F);

    fn regime(mode: Mode) -> Arc<Regime> {
        let outcomes = vec![vec![mode]];
        Arc::new(Regime::Answered { contacts: vec!["foot".into()], outcomes, undecided: Vec::new() })
    }

    /// One combination with these inequalities, det A = 1.
    fn watched(contacts: Vec<String>, numerators: Vec<f64>, clearance: Vec<f64>) -> Watched {
        let ends = vec![numerators.len()];
        let inequalities = Inequalities { determinants: vec![1.0], ends, numerators, ..Inequalities::default() };
        Watched { contacts, inequalities, clearance }
    }

    impl<F: Fn(f64) -> Vec<f64>> Landscape for Made<F> {
        fn regime(&mut self, at: f64) -> Arc<Regime> {
            regime(if (self.0)(at).iter().all(|&number| number > 0.0) { Mode::Stick } else { Mode::SlidePlus })
        }

        fn watched(&mut self, at: f64) -> Option<Watched> {
            Some(watched(Vec::new(), (self.0)(at), Vec::new()))
        }
    }

    /// The borders of a landscape from 0 to 1, sampled at 11 places.
    fn borders(numbers: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
        let mut line = Made(numbers);
        let points: Vec<Probe> =
            (0..=10).map(|k| f64::from(k) / 10.0).map(|at| Probe { at, regime: line.regime(at) }).collect();
        let mut all = Vec::new();
        for pair in points.windows(2) {
            all.extend(brackets(&mut line, &pair[0], &pair[1], RESOLUTION));
        }
        let (list, borders) = stretches(points[0].clone(), points[10].clone(), &all, RESOLUTION);
        assert_eq!((list[0].from, list[list.len() - 1].to), (0.0, 1.0));
        assert!(list.windows(2).all(|pair| pair[0].to == pair[1].from && pair[0].regime != pair[1].regime));
        assert_eq!(list.len(), borders.len() + 1);
        borders.iter().map(Bracket::at).collect()
    }

    fn near(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-12), "{found:?} {expected:?}");
    }

    #[test]
    fn borders_lie_where_a_number_passes_zero() {
        near(&borders(|x| vec![x - 0.123_456_789]), &[0.123_456_789]);
        near(&borders(|x| vec![(x - 0.31) * (0.32 - x)]), &[0.31, 0.32]);
        near(&borders(|_| vec![1.0]), &[]);
    }

    #[test]
    fn thin_regions_between_two_samples_are_found() {
        for width in [1e-3, 5e-6, 1e-9] {
            near(&borders(|x| vec![x - 0.55, 0.55 + width - x]), &[0.55, 0.55 + width]);
            near(&borders(|x| vec![-1.0, x - 0.55, 0.55 + width - x]), &[]);
        }
        for half in [1e-3, 2.5e-6] {
            near(&borders(|x| vec![half * half - (x - 0.444) * (x - 0.444)]), &[0.444 - half, 0.444 + half]);
        }
    }

    #[test]
    fn a_region_at_a_sample_s_side_is_found_behind_the_border_that_hides_it() {
        // Between 0.4 and 0.5 the number is negative, positive, negative, positive.
        let numbers = |x: f64| vec![(x - 0.41) * (x - 0.410_01) * (x - 0.48)];
        near(&borders(numbers), &[0.41, 0.410_01, 0.48]);
    }

    /// The foot is down between two samples; while it is, it sticks, except on a thin stretch.
    struct Stepping;

    const THIN: [f64; 2] = [0.4512, 0.451_201];

    impl Landscape for Stepping {
        fn regime(&mut self, at: f64) -> Arc<Regime> {
            match (0.41..0.49).contains(&at) {
                true if THIN[0] < at && at < THIN[1] => regime(Mode::SlidePlus),
                true => regime(Mode::Stick),
                false => Arc::new(Regime::Answered { contacts: vec![], outcomes: vec![vec![]], undecided: Vec::new() }),
            }
        }

        fn watched(&mut self, at: f64) -> Option<Watched> {
            let down = (0.41..0.49).contains(&at);
            let (contacts, numerators) = match down {
                true => (vec!["foot".to_owned()], vec![at - THIN[0], THIN[1] - at]),
                false => (Vec::new(), Vec::new()),
            };
            Some(watched(contacts, numerators, vec![(at - 0.41) * (at - 0.49)]))
        }
    }

    #[test]
    fn a_thin_region_among_contacts_that_no_sample_has_is_found() {
        let ends = [0.4, 0.5].map(|at| Probe { at, regime: Stepping.regime(at) });
        let found = brackets(&mut Stepping, &ends[0], &ends[1], RESOLUTION);
        near(&found.iter().map(Bracket::at).collect::<Vec<_>>(), &[0.41, THIN[0], THIN[1], 0.49]);
    }

    #[test]
    fn a_single_place_is_no_region() {
        near(&borders(|x| vec![(x - 0.3).abs()]), &[]);
        near(&borders(|x| vec![x]), &[]);
    }
}
