//! Halving a box until every combination is decided, or a state is found whose outcomes differ.

use super::cell::Cell;
use super::combination::{Combination, Numbers};
use crate::law::Mode;
use crate::scalar::{Affine, Ordered, Sign};

/// What the boxes are boxes of.
pub(crate) trait Model {
    /// Number of contacts.
    fn contacts(&self) -> usize;

    /// The contact problems of all states of the box.
    fn numbers<const N: usize>(&self, cell: &Cell) -> Numbers<Affine<N>>;

    /// The proven lists of modes of the state whose uncertain numbers are `point`, sorted; none where they are not proven
    /// or belong to other contacts.
    fn outcomes(&mut self, point: &[f64]) -> Option<Vec<Vec<Mode>>>;
}

/// What a search found.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Found {
    /// The outcomes are the same on the whole box.
    Same,
    /// They differ at this point.
    Differing(Vec<f64>),
    /// Neither was shown.
    Nothing,
}

/// Boxes times combinations that are tried at most, with up to [`USUAL`] uncertain quantities.
const EFFORT: usize = 2048;

/// With more uncertain quantities a box costs more, and fewer are tried.
const USUAL: usize = 16;

/// Corners of the whole box that are tried beside those in which the numbers point.
const RANDOM_CORNERS: usize = 8;

/// Looks for a point of the box whose outcomes are not `expected` (lists of modes, sorted), until none is left.
pub(crate) fn search<const N: usize>(model: &mut impl Model, whole: Cell, expected: &[Vec<Mode>]) -> Found {
    let lists = 1usize << (2 * model.contacts());
    let mut search: Search<'_, _, N> =
        Search { model, expected, tried: Vec::new(), combination: Combination::default(), ways: Vec::new() };
    let mut effort = EFFORT * USUAL / N.max(USUAL);
    let mut cells = vec![(whole, (0..lists).collect::<Vec<usize>>())];
    let mut first = true;
    while let Some((cell, open)) = cells.pop() {
        if !first {
            // The whole box is looked at in any case.
            let Some(rest) = effort.checked_sub(open.len()) else { return Found::Nothing };
            effort = rest;
        }
        let Examined { open, split } = search.examine(&cell, &open);
        if open.is_empty() {
            continue;
        }
        if let Some(point) = search.differing(&cell, first) {
            return Found::Differing(point);
        }
        first = false;
        let Some(halves) = split.and_then(|index| cell.halves(index)) else { return Found::Nothing };
        cells.extend(halves.map(|half| (half, open.clone())));
    }
    Found::Same
}

/// What is left of a box.
struct Examined {
    /// The combinations that are not decided.
    open: Vec<usize>,
    /// The quantity to halve; none where nothing is known to matter.
    split: Option<usize>,
}

struct Search<'a, M, const N: usize> {
    model: &'a mut M,
    expected: &'a [Vec<Mode>],
    /// Points whose outcomes are as expected.
    tried: Vec<Vec<f64>>,
    combination: Combination<Affine<N>>,
    /// Directions in which open combinations of the last box change first.
    ways: Vec<Vec<f64>>,
}

impl<M: Model, const N: usize> Search<'_, M, N> {
    fn examine(&mut self, cell: &Cell, lists: &[usize]) -> Examined {
        let numbers = self.model.numbers::<N>(cell);
        let contacts = self.model.contacts();
        let mut influence = vec![0.0; cell.ends.len()];
        let mut open = Vec::new();
        self.ways.clear();
        for &list in lists {
            let modes = modes_of(list, contacts);
            numbers.combine(&modes, &mut self.combination);
            let valid = self.expected.binary_search(&modes).is_ok();
            if self.combination.is_valid() != Some(valid) {
                open.push(list);
                point_out(&self.combination, valid, &mut influence, &mut self.ways);
            }
        }
        if influence.iter().all(|&own| own == 0.0) {
            // The box is too wide to tell anything.
            influence = cell.spreads();
        }
        let most = influence.iter().copied().fold(0.0, f64::max);
        Examined { open, split: influence.iter().position(|&own| own == most && most > 0.0) }
    }

    /// A point of the box whose outcomes are not the expected ones.
    fn differing(&mut self, cell: &Cell, whole: bool) -> Option<Vec<f64>> {
        let mut points = vec![cell.centre()];
        points.extend(self.ways.iter().map(|way| cell.corner(way)));
        if whole {
            let mut random = 0x9e37_79b9_7f4a_7c15;
            points.extend((0..RANDOM_CORNERS).map(|_| cell.corner(&signs(&mut random, cell.ends.len()))));
        }
        for point in points {
            if self.tried.contains(&point) {
                continue;
            }
            if self.model.outcomes(&point).is_some_and(|outcomes| outcomes != self.expected) {
                return Some(point);
            }
            self.tried.push(point);
        }
        None
    }
}

/// Adds what the open combination hangs on to `influence`, and where it changes to `ways`.
fn point_out<const N: usize>(
    combination: &Combination<Affine<N>>,
    valid: bool,
    influence: &mut [f64],
    ways: &mut Vec<Vec<f64>>,
) {
    let Some(determinant) = combination.determinant else { return };
    let sign = if determinant.centre() < 0.0 { -1.0 } else { 1.0 };
    // How far each inequality is from being decided: 1 on its border, 0 in its middle.
    let slacks = combination.numerators.iter().filter(|(inequality, _)| inequality.is_some());
    let slacks = slacks.map(|(_, number)| (number, sign * number.centre() / number.radius()));
    let undecided = |number: &Affine<N>| number.sign() == Sign::Undecided;
    // What is not linear hangs above all on what moves det A.
    let moved = determinant.slopes().iter().map(|slope| slope.abs()).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut weigh = |number: &Affine<N>| {
        let radius = number.radius();
        for ((own, slope), bent) in influence.iter_mut().zip(number.slopes()).zip(determinant.slopes()) {
            *own += (slope.abs() + number.rest() * (bent.abs() / moved)) / radius;
        }
    };
    let way = |number: &Affine<N>, sign: f64| number.slopes().iter().map(|slope| sign * slope).collect::<Vec<f64>>();
    if undecided(&determinant) {
        weigh(&determinant);
        ways.extend([1.0, -1.0].map(|sign| way(&determinant, sign)));
    }
    if valid {
        // It ends where any of its slacks does.
        for (number, _) in slacks.filter(|(number, _)| undecided(number)) {
            weigh(number);
            ways.push(way(number, -sign));
        }
        return;
    }
    // It begins where the last of its slacks is no longer violated.
    let mut all = vec![0.0; N];
    let mut worst: Option<(&Affine<N>, f64)> = None;
    for (number, place) in slacks {
        if place < 0.0 {
            let radius = number.radius();
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

/// The list of modes of that number.
fn modes_of(list: usize, contacts: usize) -> Vec<Mode> {
    (0..contacts).map(|contact| Mode::ALL[list >> (2 * contact) & 3]).collect()
}

/// Random signs (SplitMix64: Steele, Lea and Flood 2014).
fn signs(state: &mut u64, count: usize) -> Vec<f64> {
    let mut bits = || {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    (0..count).map(|_| if bits() & 1 == 1 { 1.0 } else { -1.0 }).collect()
}
