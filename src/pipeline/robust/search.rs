//! Halves a box until every combination is decided or a state with other outcomes is found.

use super::super::{Answer, Pipeline};
use super::combination::BoxCombination;
use super::kept::{KeptContacts, proven_modes, with_named_contacts};
use super::state_box::StateBox;
use super::{CONTACT_LIMIT, Counterexample, Robustness};
use crate::budget::is_spent_after;
use crate::law::Mode;
use crate::scalar::{Affine, Ordered, Sign};
use crate::state::{State, Uncertainty};

/// The greatest number of boxes times combinations to try, with up to [`USUAL`] uncertain quantities.
const EFFORT: usize = 2048;

/// With more uncertain quantities than this, each box costs more, so fewer are tried.
const USUAL: usize = 16;

/// The number of random corners of the whole box that are tried in addition to those that open combinations suggest.
const RANDOM_CORNERS: usize = 8;

impl Pipeline<'_> {
    /// Finds out whether the answer to `state` holds on the box of its uncertainty.
    pub(in crate::pipeline) fn robustness(
        &mut self,
        state: &State,
        uncertainty: &Uncertainty,
        answer: &Answer,
    ) -> Robustness {
        let Some(expected) = answer.impact.analysis.as_ref().and_then(proven_modes) else {
            return Robustness::Unknown;
        };
        let links: Vec<usize> = answer.impact.contacts.iter().map(|contact| contact.link).collect();
        if links.is_empty() {
            return Robustness::Everywhere;
        }
        if links.len() > CONTACT_LIMIT {
            return Robustness::Unknown;
        }
        let state_box = StateBox::new(self.robot, state, uncertainty, &links);
        let quantities = state_box.quantities.len();
        let mut kept = KeptContacts {
            friction: links.iter().filter_map(|&link| state.scene.friction.of(link)).collect(),
            links,
            named: with_named_contacts(self.robot, state, answer),
            quantities: state_box.quantities.clone(),
            state,
            answer,
            pipeline: self,
        };
        // Sizes of the affine numbers. Quantities beyond the last size count as unrelated errors.
        match quantities {
            0 => Robustness::Everywhere,
            1..=16 => search::<16>(&mut kept, state_box, &expected),
            17..=32 => search::<32>(&mut kept, state_box, &expected),
            _ => search::<64>(&mut kept, state_box, &expected),
        }
    }
}

/// Looks for a state whose outcomes are not `expected` (lists of modes, sorted), until all boxes are decided.
fn search<const N: usize>(kept: &mut KeptContacts<'_, '_>, state_box: StateBox, expected: &[Vec<Mode>]) -> Robustness {
    let mut boxes = vec![(state_box, kept.combinations())];
    let mut search: BoxSearch<'_, '_, '_, N> =
        BoxSearch { kept, expected, tried: Vec::new(), combination: BoxCombination::default(), ways: Vec::new() };
    let mut effort = EFFORT * USUAL / N.max(USUAL);
    let mut first = true;
    while let Some((state_box, open)) = boxes.pop() {
        if is_spent_after(open.len() as u32) {
            return Robustness::Unknown;
        }
        if !first {
            // The whole box is examined whatever it costs.
            let Some(rest) = effort.checked_sub(open.len()) else { return Robustness::Unknown };
            effort = rest;
        }
        let (open, split) = search.examine(&state_box, open);
        if open.is_empty() {
            continue;
        }
        if let Some(found) = search.counterexample(&state_box, if first { RANDOM_CORNERS } else { 0 }) {
            return Robustness::Not(Box::new(found));
        }
        first = false;
        let Some(halves) = split.and_then(|index| state_box.halves(index)) else { return Robustness::Unknown };
        boxes.extend(halves.map(|half| (half, open.clone())));
    }
    Robustness::Everywhere
}

struct BoxSearch<'a, 'k, 'r, const N: usize> {
    kept: &'a mut KeptContacts<'k, 'r>,
    expected: &'a [Vec<Mode>],
    /// Points that were tried without finding other outcomes.
    tried: Vec<Vec<f64>>,
    combination: BoxCombination<Affine<N>>,
    /// Directions in which open combinations of the last box change first.
    ways: Vec<Vec<f64>>,
}

impl<const N: usize> BoxSearch<'_, '_, '_, N> {
    /// Returns the undecided combinations of a box, and the quantity to halve, if one is known to matter.
    fn examine(&mut self, state_box: &StateBox, mut open: Vec<Vec<Mode>>) -> (Vec<Vec<Mode>>, Option<usize>) {
        let problem = self.kept.problem::<N>(state_box);
        let mut influence = vec![0.0; state_box.ends.len()];
        self.ways.clear();
        open.retain(|modes| {
            // Combinations for which no time is left stay open.
            if is_spent_after(9_u32.pow(modes.len() as u32)) {
                return true;
            }
            problem.combine(modes, &mut self.combination);
            let valid = self.expected.binary_search(modes).is_ok();
            let is_open = self.combination.is_valid() != Some(valid);
            if is_open {
                weigh_open(&self.combination, valid, &mut influence, &mut self.ways);
            }
            is_open
        });
        if influence.iter().all(|&entry| entry == 0.0) {
            // The box is too wide to show any influence.
            influence = state_box.spreads();
        }
        let most = influence.iter().copied().fold(0.0, f64::max);
        (open, influence.iter().position(|&entry| entry == most && most > 0.0))
    }

    /// Returns a state of the box with other than the expected outcomes. Tries the center, the corners that the open
    /// combinations suggest, and `random` more corners.
    fn counterexample(&mut self, state_box: &StateBox, random: usize) -> Option<Counterexample> {
        let mut points = vec![state_box.center()];
        points.extend(self.ways.iter().map(|way| state_box.corner(way)));
        let mut seed = 0x9e37_79b9_7f4a_7c15;
        points.extend((0..random).map(|_| state_box.corner(&signs(&mut seed, state_box.ends.len()))));
        for point in points {
            if self.tried.contains(&point) {
                continue;
            }
            let found = self.kept.counterexample(&point, self.expected);
            if found.is_some() {
                return found;
            }
            self.tried.push(point);
        }
        None
    }
}

/// Adds the sensitivities of an open combination to `influence`, and the directions in which it changes to `ways`.
fn weigh_open<const N: usize>(
    combination: &BoxCombination<Affine<N>>,
    valid: bool,
    influence: &mut [f64],
    ways: &mut Vec<Vec<f64>>,
) {
    let determinant = &combination.determinant;
    let sign = if determinant.to_f64() < 0.0 { -1.0 } else { 1.0 };
    // The center of each numerator divided by its radius: 0 if it is most undecided, 1 or -1 if it is just decided.
    let slacks = combination.numerators.iter().filter(|(inequality, _)| inequality.is_some());
    let slacks = slacks.map(|(_, number)| (number, sign * number.to_f64() / number.error()));
    let undecided = |number: &Affine<N>| number.sign() == Sign::Undecided;
    // The nonlinear parts depend mainly on the quantities that move det A.
    let moved = determinant.slopes().iter().map(|slope| slope.abs()).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut weigh = |number: &Affine<N>| {
        let radius = number.error();
        for ((sum, slope), bent) in influence.iter_mut().zip(number.slopes()).zip(determinant.slopes()) {
            *sum += (slope.abs() + number.rest() * (bent.abs() / moved)) / radius;
        }
    };
    let way = |number: &Affine<N>, sign: f64| number.slopes().iter().map(|slope| sign * slope).collect::<Vec<f64>>();
    if undecided(determinant) {
        weigh(determinant);
        ways.extend([1.0, -1.0].map(|sign| way(determinant, sign)));
    }
    if valid {
        // A valid combination ends when any of its slacks becomes negative.
        for (number, _) in slacks.filter(|(number, _)| undecided(number)) {
            weigh(number);
            ways.push(way(number, -sign));
        }
        return;
    }
    // A rejected combination begins when the last of its slacks is no longer violated.
    let mut all = vec![0.0; N];
    let mut worst: Option<(&Affine<N>, f64)> = None;
    for (number, place) in slacks {
        if place < 0.0 {
            let radius = number.error();
            all.iter_mut().zip(number.slopes()).for_each(|(sum, slope)| *sum += sign * slope / radius);
        }
        if undecided(number) && worst.is_none_or(|(_, least)| place < least) {
            worst = Some((number, place));
        }
    }
    if let Some((number, _)) = worst {
        weigh(number);
        ways.push(way(number, sign));
        ways.push(all);
    }
}

/// Returns random signs (SplitMix64: Steele, Lea and Flood 2014).
fn signs(state: &mut u64, count: usize) -> Vec<f64> {
    let mut bits = || {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (0..count).map(|_| if bits() & 1 == 1 { 1.0 } else { -1.0 }).collect()
}
