//! Searches for borders between two points of the same regime.
//!
//! ```text
//!     a set of outcomes changes only where a numerator N of some combination passes zero (see `impact::inequalities`):
//!     N at five points --quartic--> sign changes, least |N| --bisected on N itself--> candidates
//! ```
//!
//! Both sides of each change of contacts are candidates, too, because a foot that rolls from one corner to another
//! stands on both for a moment. The numbers are followed only between two changes.
//!
//! A combination is not followed where one clearly violated inequality excludes it, on the whole interval or near a
//! zero. This search only proposes candidates, at which the caller then computes the regime. It is not guaranteed to
//! find all: it misses changes of N between the five points that its fourth differences do not show.
//!
//! If the regimes of two points differ, [`decisive_zero`] returns the likely place of the border between them.

use super::contact_changes::{Seen, are_alike, contact_changes};
use super::model::Watched;
use crate::budget::is_spent;
use std::sync::Arc;

/// The number of points in an interval at which quantities are computed: its ends and three between them.
const NODES: usize = 5;

/// The distance from a zero or turn of the quartic at which the quantity itself is computed, in steps between points.
const STEP: f64 = 0.125;

/// The accuracy of zeros and turns of the quartic, in the same steps.
const NODE_RESOLUTION: f64 = 1e-9;

/// An interval is halved up to `HALVINGS` times while fourth differences exceed this fraction of the numbers.
const SMOOTH: f64 = 0.05;
const HALVINGS: usize = 5;

/// The number of times that an interval is divided where contacts change; then the nodes become candidates.
const DIVISIONS: usize = 3;

/// A minimum of |N| is searched for if the quartic comes as near to zero as this fraction of the numbers.
const NEAR: f64 = 0.05;

/// The rounding of a zero in f64, as a fraction of the numbers.
const ROUNDING: f64 = 1e-9;

/// The greatest number of candidates in one interval.
const MOST: usize = 200;

/// A quantity that is followed, by its index in [`Watched`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tracked {
    Determinant(usize),
    Numerator(usize),
    /// The least of the inequalities of a combination: positive where it is an outcome.
    Combination(usize),
    Clearance(usize),
}

impl Tracked {
    /// Returns whether `watched` holds the same quantity as `node`: inequalities depend on the set of contacts, but
    /// heights of feet do not.
    fn is_in(self, watched: &Watched, node: &Watched) -> bool {
        match self {
            Self::Clearance(at) => at < watched.clearance.len(),
            Self::Determinant(_) | Self::Numerator(_) | Self::Combination(_) => same_combinations(watched, node),
        }
    }

    fn is_negligible(self, watched: &Watched) -> bool {
        matches!(self, Self::Numerator(at) if watched.inequalities.negligible.get(at) == Some(&true))
    }

    fn values(self, nodes: &[Arc<Watched>]) -> [f64; NODES] {
        std::array::from_fn(|k| self.value(&nodes[k]))
    }

    fn value(self, watched: &Watched) -> f64 {
        let inequalities = &watched.inequalities;
        match self {
            Self::Determinant(at) => inequalities.determinants[at],
            Self::Numerator(at) => inequalities.numerators[at],
            Self::Combination(at) => {
                let numerators = &inequalities.numerators[inequalities.of_combination(at)];
                numerators.iter().map(|number| number * inequalities.determinants[at]).fold(f64::INFINITY, f64::min)
            }
            Self::Clearance(at) => watched.clearance[at],
        }
    }

    /// Returns whether other inequalities clearly exclude its combination at both of two places, given from 0 to 4.
    fn is_excluded(self, nodes: &[Arc<Watched>], places: [f64; 2]) -> bool {
        let inequalities = &nodes[0].inequalities;
        let combination = match self {
            Self::Determinant(at) | Self::Combination(at) => at,
            Self::Numerator(at) => inequalities.ends.partition_point(|&end| end <= at),
            Self::Clearance(_) => return false,
        };
        // The sign that a quantity clearly has at both places, or 0.
        let sign = |quantity: Self| {
            let values = quantity.values(nodes);
            let room = 2.0 * fourth_difference(&values).abs() + ROUNDING * largest(&values);
            let curve = Quartic::through(&values);
            let [a, b] = places.map(|place| curve.at(place));
            i32::from(a > room && b > room) - i32::from(a < -room && b < -room)
        };
        let determinant = sign(Self::Determinant(combination));
        let numerators = inequalities.of_combination(combination).map(Self::Numerator);
        let signs: Vec<i32> = numerators.filter(|&quantity| quantity != self).map(sign).collect();
        match determinant {
            0 => signs.contains(&1) && signs.contains(&-1),
            determinant => signs.contains(&-determinant),
        }
    }
}

/// Returns whether both have the inequalities of the same combinations of the same contacts.
fn same_combinations(one: &Watched, other: &Watched) -> bool {
    one.inequalities.ends == other.inequalities.ends && one.contacts == other.contacts
}

/// Returns the places between `a` and `b`, in ascending order, at which the regime may differ from the one at both
/// ends. Zeros with a distance of less than `resolution` count as one.
pub fn suspects(watch: &mut impl FnMut(f64) -> Seen, a: f64, b: f64, resolution: f64) -> Vec<f64> {
    let mut search = Search { watch, resolution, found: Vec::new() };
    search.interval(a, b, HALVINGS, DIVISIONS);
    let mut found = search.found;
    found.sort_by(f64::total_cmp);
    found.dedup();
    found.retain(|&x| a < x && x < b);
    found
}

/// Returns the zero of the quantity that decides between `a` and `b`: whether a foot is down, or whether a combination
/// is an outcome. `None` if no quantity of this kind differs in sign.
pub fn decisive_zero(watch: &mut impl FnMut(f64) -> Seen, a: f64, b: f64, resolution: f64) -> Option<f64> {
    let ends = [watch(a)?, watch(b)?];
    let [first, last] = &ends;
    let feet = (0..first.clearance.len()).map(Tracked::Clearance);
    let combinations = (0..first.inequalities.ends.len()).map(Tracked::Combination);
    let mut turning = feet.chain(combinations).filter(|quantity| quantity.is_in(last, first));
    let decisive = turning.find(|quantity| (quantity.value(first) > 0.0) != (quantity.value(last) > 0.0))?;
    let mut real = |x: f64| {
        let watched = watch(x).filter(|watched| decisive.is_in(watched, first));
        watched.map_or(f64::NAN, |watched| decisive.value(&watched))
    };
    Some(zero(&mut real, a, b, resolution))
}

struct Search<'w, W> {
    watch: &'w mut W,
    resolution: f64,
    found: Vec<f64>,
}

/// Places in an interval where a quantity is zero, and places where it comes near zero.
#[derive(Default)]
struct Zeros {
    crossed: Vec<f64>,
    touched: Vec<f64>,
}

impl<W: FnMut(f64) -> Seen> Search<'_, W> {
    fn interval(&mut self, a: f64, b: f64, halvings: usize, divisions: usize) {
        if is_spent() {
            return;
        }
        let place = |k: f64| a + (b - a) * (k / (NODES - 1) as f64);
        // The same numbers as the places of the interval's halves.
        let middle = 0.5 * (a + b);
        let places: [f64; NODES] = [a, 0.5 * (a + middle), middle, 0.5 * (middle + b), b];
        let seen = places.map(|at| (self.watch)(at));
        if seen.iter().any(|watched| !are_alike(watched, &seen[0])) && divisions > 0 {
            return self.divided(&places, &seen, halvings, divisions - 1);
        }
        let nodes: Option<Vec<Arc<Watched>>> = seen.iter().cloned().collect();
        let Some(nodes) = nodes.filter(|_| seen.iter().all(|watched| are_alike(watched, &seen[0]))) else {
            self.found.extend(&places[1..NODES - 1]);
            return;
        };
        let mut followed = followed(&nodes);
        followed.retain(|(quantity, values)| {
            let known = values.iter().all(|value| value.is_finite());
            known && !is_clear(values) && !nodes.iter().all(|node| quantity.is_negligible(node))
        });
        let rough = followed.iter().any(|(_, values)| fourth_difference(values).abs() > SMOOTH * largest(values));
        if rough && halvings > 0 && b - a > self.resolution {
            self.interval(a, middle, halvings - 1, divisions);
            self.found.push(middle);
            self.interval(middle, b, halvings - 1, divisions);
            return;
        }
        let mut zeros = Zeros::default();
        for (quantity, values) in &followed {
            self.zeros(*quantity, values, &nodes, place, &mut zeros);
            if zeros.crossed.len() + zeros.touched.len() > MOST || is_spent() {
                break;
            }
        }
        let Zeros { mut crossed, touched } = zeros;
        crossed.sort_by(f64::total_cmp);
        if !crossed.is_empty() {
            // An end of the interval may be a zero up to rounding.
            crossed.insert(0, a);
            crossed.push(b);
        }
        let apart = crossed.windows(2).filter(|pair| pair[1] - pair[0] > self.resolution);
        self.found.extend(apart.map(|pair| 0.5 * (pair[0] + pair[1])));
        self.found.extend(touched.into_iter().chain(crossed));
    }

    /// Adds both sides of every change of contacts between the nodes, and searches the intervals between the changes.
    fn divided(&mut self, places: &[f64; NODES], seen: &[Seen; NODES], halvings: usize, divisions: usize) {
        let mut changes = Vec::new();
        for (at, ends) in places.windows(2).zip(seen.windows(2)) {
            let ends = [(at[0], &ends[0]), (at[1], &ends[1])];
            contact_changes(self.watch, ends, self.resolution, &mut changes);
        }
        let mut from = places[0];
        for [before, beyond] in changes.into_iter().chain([[places[NODES - 1]; 2]]) {
            if before - from > self.resolution {
                self.interval(from, before, halvings, divisions);
            }
            self.found.extend([before, beyond]);
            from = beyond;
        }
    }

    /// Adds the places at which a quantity with these `values` at the nodes is zero or comes near zero.
    fn zeros(
        &mut self,
        quantity: Tracked,
        values: &[f64; NODES],
        nodes: &[Arc<Watched>],
        place: impl Fn(f64) -> f64,
        Zeros { crossed, touched }: &mut Zeros,
    ) {
        let resolution = self.resolution;
        let watch = &mut *self.watch;
        let real = |watch: &mut W, x: f64| {
            let watched = watch(x).filter(|watched| quantity.is_in(watched, &nodes[0]));
            watched.map_or(f64::NAN, |watched| quantity.value(&watched))
        };
        // Between two places where the quantity is only rounding, its sign has no meaning.
        let is_skipped = |watch: &mut W, window: [f64; 2]| {
            let mut is_rounding = |at: usize, x: f64| {
                let watched = watch(place(x)).filter(|watched| quantity.is_in(watched, &nodes[0]));
                watched.is_some_and(|watched| watched.inequalities.rounding.get(at) == Some(&true))
            };
            quantity.is_excluded(nodes, window)
                || matches!(quantity, Tracked::Numerator(at) if window.into_iter().all(|x| is_rounding(at, x)))
        };
        let curve = Quartic::through(values);
        let turns = curve.turns();
        let near_zero = NEAR * largest(values) + 2.0 * fourth_difference(values).abs();
        let ends = [(0.0, values[0]), ((NODES - 1) as f64, values[NODES - 1])];
        let mut breaks = vec![ends[0]];
        breaks.extend(turns.iter().map(|&turn| (turn, curve.at(turn))));
        breaks.push(ends[1]);
        // The places one step to either side, within a piece of the curve.
        let beside = |x: f64, [from, to]: [f64; 2]| [(x - STEP).max(from), (x + STEP).min(to)];
        for pair in breaks.windows(2) {
            let [(from, first), (to, last)] = [pair[0], pair[1]];
            if (first < 0.0) != (last < 0.0) {
                let window = beside(zero(&mut |x| curve.at(x), from, to, NODE_RESOLUTION), [from, to]);
                if !is_skipped(watch, window) {
                    crossed.push(zero(&mut |x| real(watch, x), place(window[0]), place(window[1]), resolution));
                }
            }
        }
        for three in breaks.windows(3) {
            let [before, (turn, here), after] = [three[0], three[1], three[2]];
            let sign = if here < 0.0 { -1.0 } else { 1.0 };
            let least = sign * before.1 > sign * here && sign * after.1 > sign * here;
            let window = beside(turn, [before.0, after.0]);
            if !least || here.abs() > near_zero || is_skipped(watch, window) {
                continue;
            }
            let ends = window.map(|x| (place(x), sign * curve.at(x)));
            let Some(bottom) = least_place(&mut |x| sign * real(watch, x), ends, resolution) else { continue };
            touched.push(bottom);
            if sign * real(watch, bottom) < 0.0 {
                let sides = window.map(|x| [bottom.min(place(x)), bottom.max(place(x))]);
                crossed.extend(sides.map(|[from, to]| zero(&mut |x| real(watch, x), from, to, resolution)));
            }
        }
    }
}

/// Returns the quantities of all combinations that no inequality clearly excludes, with their values at the nodes.
fn followed(nodes: &[Arc<Watched>]) -> Vec<(Tracked, [f64; NODES])> {
    let inequalities = &nodes[0].inequalities;
    let mut all: Vec<Tracked> = (0..nodes[0].clearance.len()).map(Tracked::Clearance).collect();
    for combination in 0..inequalities.ends.len() {
        let determinant = Tracked::Determinant(combination).values(nodes);
        let numerators = inequalities.of_combination(combination).map(Tracked::Numerator);
        let violated = |quantity: Tracked| {
            let values = quantity.values(nodes);
            is_clear(&values) && (values[0] < 0.0) != (determinant[0] < 0.0)
        };
        if !is_clear(&determinant) || !numerators.clone().any(violated) {
            all.push(Tracked::Determinant(combination));
            all.extend(numerators);
        }
    }
    all.into_iter().map(|quantity| (quantity, quantity.values(nodes))).collect()
}

/// Returns whether the curve through these values clearly keeps its sign. A constant curve does, even if it is zero.
fn is_clear(values: &[f64; NODES]) -> bool {
    let least = values.iter().fold(f64::INFINITY, |least, value| least.min(value.abs()));
    let same = values.iter().all(|&value| (value < 0.0) == (values[0] < 0.0));
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &v| (low.min(v), high.max(v)));
    high == low || same && least > 0.25 * (high - low)
}

fn largest(values: &[f64; NODES]) -> f64 {
    values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()))
}

fn fourth_difference([a, b, c, d, e]: &[f64; NODES]) -> f64 {
    a - 4.0 * b + 6.0 * c - 4.0 * d + e
}

/// A polynomial of degree four, by ascending powers.
struct Quartic([f64; NODES]);

impl Quartic {
    /// The quartic through the values at 0, 1, 2, 3, 4, by Newton's forward differences.
    fn through(values: &[f64; NODES]) -> Self {
        let mut differences = *values;
        for order in 1..NODES {
            for k in (order..NODES).rev() {
                differences[k] -= differences[k - 1];
            }
        }
        let [value, first, second, third, fourth] = differences;
        Self([
            value,
            first - second / 2.0 + third / 3.0 - fourth / 4.0,
            (second - third) / 2.0 + 11.0 * fourth / 24.0,
            third / 6.0 - fourth / 4.0,
            fourth / 24.0,
        ])
    }

    fn at(&self, x: f64) -> f64 {
        horner(&self.0, x)
    }

    /// Returns its turning points between 0 and 4.
    fn turns(&self) -> Vec<f64> {
        sign_changes(&slope(&self.0))
    }
}

fn horner(polynomial: &[f64], x: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

fn slope(polynomial: &[f64]) -> Vec<f64> {
    polynomial.iter().enumerate().skip(1).map(|(power, coefficient)| power as f64 * coefficient).collect()
}

/// Returns the sign changes of a polynomial between 0 and 4, ascending: at most one between two turning points.
fn sign_changes(polynomial: &[f64]) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let mut breaks = vec![0.0];
    breaks.extend(sign_changes(&slope(polynomial)));
    breaks.push((NODES - 1) as f64);
    let value = |x: f64| horner(polynomial, x);
    let differ = |pair: &&[f64]| (value(pair[0]) < 0.0) != (value(pair[1]) < 0.0);
    breaks.windows(2).filter(differ).map(|pair| zero(&mut |x| value(x), pair[0], pair[1], NODE_RESOLUTION)).collect()
}

/// Returns a zero of `f` between `a` and `b` if the signs there differ, else the middle; or a place where `f` is NaN.
fn zero(f: &mut impl FnMut(f64) -> f64, mut a: f64, mut b: f64, resolution: f64) -> f64 {
    let (mut at_a, mut at_b) = (f(a), f(b));
    if (at_a < 0.0) == (at_b < 0.0) {
        return 0.5 * (a + b);
    }
    // False position with the Illinois rule, and bisection when that does not shrink the bracket fast.
    let mut kept = 0_i32;
    for step in 0..100 {
        if b - a <= 0.1 * resolution {
            break;
        }
        let secant = (a * at_b - b * at_a) / (at_b - at_a);
        let x = if step % 3 == 2 || !(a < secant && secant < b) { 0.5 * (a + b) } else { secant };
        if x <= a || x >= b {
            break;
        }
        let at_x = f(x);
        if at_x == 0.0 || at_x.is_nan() {
            return x;
        }
        if (at_x < 0.0) == (at_a < 0.0) {
            (a, at_a) = (x, at_x);
            at_b *= if kept == 1 { 0.5 } else { 1.0 };
            kept = 1;
        } else {
            (b, at_b) = (x, at_x);
            at_a *= if kept == -1 { 0.5 } else { 1.0 };
            kept = -1;
        }
    }
    0.5 * (a + b)
}

/// Returns the place of the minimum of `f` between two places with given values (golden section), or any place where
/// `f` is negative or NaN (there the scene is another one). `None` once `f` clearly stays above zero: if it is more
/// than half of its values at the ends, its curvature does not bring it to zero.
fn least_place(
    f: &mut impl FnMut(f64) -> f64,
    [(mut a, mut at_a), (mut b, mut at_b)]: [(f64, f64); 2],
    resolution: f64,
) -> Option<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (mut left, mut right) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..60 {
        if at_left < 0.0 || at_left.is_nan() {
            return Some(left);
        }
        if at_right < 0.0 || at_right.is_nan() {
            return Some(right);
        }
        if 2.0 * at_left.min(at_right) > at_a.max(at_b) {
            return None;
        }
        if b - a <= resolution {
            break;
        }
        if at_left < at_right {
            (b, at_b, right, at_right) = (right, at_right, left, at_left);
            left = b - GOLDEN * (b - a);
            at_left = f(left);
        } else {
            (a, at_a, left, at_left) = (left, at_left, right, at_right);
            right = a + GOLDEN * (b - a);
            at_right = f(right);
        }
    }
    Some(0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Inequalities;
    use crate::pipeline::Touching;

    #[test]
    fn a_quartic_is_what_it_interpolates() {
        let polynomial = |x: f64| 2.0 - x + 0.5 * x * x * x - 0.25 * x * x * x * x;
        let values = std::array::from_fn(|k| polynomial(k as f64));
        for x in [0.3, 1.0, 2.7, 3.9] {
            assert!((Quartic::through(&values).at(x) - polynomial(x)).abs() < 1e-12);
        }
    }

    #[test]
    fn every_turn_of_a_quartic_is_found() {
        // The slope is (x - 0.001) (x - 0.003) (x - 3.999).
        let [a, b, c] = [0.001, 0.003, 3.999];
        let powers = [0.5, -a * b * c, (a * b + b * c + c * a) / 2.0, -(a + b + c) / 3.0, 0.25];
        let turns = Quartic(powers).turns();
        assert!(turns.len() == 3 && turns.iter().zip([a, b, c]).all(|(x, y)| (x - y).abs() < 1e-8), "{turns:?}");
    }

    #[test]
    fn a_roll_far_from_zero_is_bisected_to_its_end() {
        let start = 1.7e9;
        let mut watch = |x: f64| {
            let touching = vec![Touching { corner: Some(usize::from(x > start + 0.3)), ground: 0 }];
            let inequalities = Inequalities::default();
            Some(Arc::new(Watched { contacts: vec!["foot".into()], inequalities, clearance: Vec::new(), touching }))
        };
        let found = suspects(&mut watch, start, start + 1.0, 1e-12);
        assert!(matches!(found[..], [before, beyond] if before <= start + 0.3 && beyond > start + 0.3), "{found:?}");
    }

    #[test]
    fn a_clearly_violated_combination_is_not_followed() {
        let mut asked = 0;
        let mut watch = |x: f64| {
            asked += 1;
            let numerators = vec![-1.0 - 0.1 * x, libm::sin(40.0 * x)];
            let inequalities =
                Inequalities { determinants: vec![1.0], ends: vec![2], numerators, ..Inequalities::default() };
            Some(Arc::new(Watched { contacts: Vec::new(), inequalities, clearance: Vec::new(), touching: Vec::new() }))
        };
        let places = suspects(&mut watch, 0.0, 1.0, 1e-12);
        assert_eq!((places, asked), (Vec::new(), NODES));
    }
}
