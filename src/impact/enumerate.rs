//! Every combination of modes, as numbers.
//!
//! ```text
//!     c = c_free + G L           xi_n = c_n + bounce
//!     separate  L = 0            stick  c_t = xi_n = 0            slide+-  xi_n = 0,  L = lambda ray
//! ```
//!
//! Contacts are decided one after the other. Deciding one eliminates its impulses from a tableau that expresses
//! everything by the impulses of the contacts not yet decided, so that combinations share their beginnings: a tree of
//! Schur complements. The contact law says which impulses a mode has. The product of the pivots is det A (paper,
//! section 2); no number is compared with another here.
//!
//! Cost: 4^n leaves (2^k 4^(n-k) if k contacts are frictionless: their modes share one elimination), each O(n).

use super::problem::ContactProblem;
use crate::law::{Friction, Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Real, Rounded};
use std::convert::Infallible;

/// Scratch of the enumeration; it is reused from problem to problem and then allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Tableau<T> {
    contacts: usize,
    laws: Vec<Law>,
    /// Whether every mode is visited by itself, also if others have the same impulses.
    pub separately: bool,
    /// Whether modes that slide are left out.
    pub without_slip: bool,
    /// Tableaus by depth, each 2n rows of 2n + 1 entries: the coefficients of all impulses, then the constant. Columns
    /// of decided contacts are stale. Rows of contact i: c_t and xi_n while it is undecided or separates; c_t and
    /// lambda where it slides; L_t and L_n where it sticks.
    depths: Vec<Vec<T>>,
    modes: Vec<Mode>,
    pivots: Vec<T>,
}

/// The last contacts whose combinations are visited in any case.
const AT_ONCE: usize = 6;

/// One combination of modes and the numbers that it leads to.
#[derive(Debug)]
pub struct Leaf<'a, T> {
    /// One mode per contact; it stands for all with the same impulses if these are visited as one.
    pub modes: &'a [Mode],
    /// One pivot per contact; their product is det A, its sign the index. A separating contact's is one.
    pub pivots: &'a [T],
    tableau: &'a [T],
    laws: &'a [Law],
}

/// A visitor of all combinations.
pub trait Visitor<T> {
    fn leaf(&mut self, leaf: &Leaf<'_, T>);

    /// Whether the combinations that are left are not visited; asked before each few thousand.
    fn ends(&mut self) -> bool {
        false
    }
}

impl<T, F: FnMut(&Leaf<'_, T>)> Visitor<T> for F {
    fn leaf(&mut self, leaf: &Leaf<'_, T>) {
        self(leaf);
    }
}

impl<T: Real> Tableau<T> {
    pub fn load(&mut self, problem: &ContactProblem<T>) {
        self.load_entries(problem.laws(), |row, column| problem.delassus(row, column), |row| problem.free_row(row));
    }

    /// As [`Tableau::load`], with G by rows and columns and the velocities without impulses by rows.
    pub fn load_entries(&mut self, laws: &[Law], delassus: impl Fn(usize, usize) -> T, free: impl Fn(usize) -> T) {
        let n = laws.len();
        let width = 2 * n + 1;
        self.contacts = n;
        laws.clone_into(&mut self.laws);
        // Those of more contacts are kept.
        self.depths.resize_with(self.depths.len().max(n + 1), Vec::new);
        for depth in &mut self.depths[..=n] {
            depth.resize(2 * n * width, T::zero());
        }
        self.modes.clear();
        self.modes.resize(n, Mode::Separate);
        self.pivots.clear();
        self.pivots.resize(n, T::one());
        for (row, entries) in self.depths[0].chunks_exact_mut(width).enumerate() {
            for (column, entry) in entries[..2 * n].iter_mut().enumerate() {
                *entry = delassus(row, column);
            }
            entries[2 * n] = free(row);
        }
    }

    /// Visits every combination, in the order of [`Mode::ALL`] with the last contact changing fastest.
    pub fn visit(&mut self, visitor: &mut impl Visitor<T>) {
        self.descend(0, 0, visitor);
    }

    /// Visits one combination.
    pub fn visit_one(&mut self, modes: &[Mode], visitor: &mut impl Visitor<T>) {
        let mut source = 0;
        for (contact, &mode) in modes.iter().enumerate() {
            self.modes[contact] = mode;
            source = self.decide(contact, mode, source);
        }
        visitor.leaf(&self.at(source));
    }

    /// The combination in which all contacts stick, as if each had friction. The laws that it was loaded with are lost.
    pub fn stick_all(&mut self) -> Leaf<'_, T> {
        self.laws.fill(Friction::Infinite.into());
        for contact in 0..self.contacts {
            self.modes[contact] = Mode::Stick;
            self.decide(contact, Mode::Stick, contact);
        }
        self.at(self.contacts)
    }

    pub fn leaf(&mut self, modes: &[Mode]) -> Leaf<'_, T> {
        let Ok(leaf) = self.leaf_unless(modes, |_| None::<Infallible>);
        leaf
    }

    /// The combination with these modes, unless a pivot on the way `ends` it.
    pub fn leaf_unless<E>(&mut self, modes: &[Mode], mut ends: impl FnMut(T) -> Option<E>) -> Result<Leaf<'_, T>, E> {
        let mut source = 0;
        for (contact, &mode) in modes.iter().enumerate() {
            let mode = self.laws[contact].representative(mode);
            self.modes[contact] = mode;
            source = self.decide(contact, mode, source);
            if let Some(end) = ends(self.pivots[contact]) {
                return Err(end);
            }
        }
        Ok(self.at(source))
    }

    fn at(&self, depth: usize) -> Leaf<'_, T> {
        let tableau = &self.depths[depth];
        Leaf { modes: &self.modes, pivots: &self.pivots, tableau, laws: &self.laws }
    }

    fn descend(&mut self, contact: usize, source: usize, visitor: &mut impl Visitor<T>) {
        if contact == self.contacts {
            visitor.leaf(&self.at(source));
            return;
        }
        if self.contacts - contact == AT_ONCE && visitor.ends() {
            return;
        }
        for group in self.laws[contact].modes() {
            for &mode in if self.separately { group } else { &group[..1] } {
                if self.without_slip && mode.slides() {
                    continue;
                }
                self.modes[contact] = mode;
                let depth = self.decide(contact, mode, source);
                self.descend(contact + 1, depth, visitor);
            }
        }
    }

    /// Eliminates the contact's impulses and returns the depth that holds the tableau then.
    fn decide(&mut self, contact: usize, mode: Mode, source: usize) -> usize {
        let n = self.contacts;
        let width = 2 * n + 1;
        let (tangential, normal) = (2 * contact, 2 * contact + 1);
        let impulse = self.laws[contact].impulse(mode);
        if impulse == Impulse::Zero {
            // Its columns are simply not read any more.
            self.pivots[contact] = T::one();
            return source;
        }
        let (before, after) = self.depths.split_at_mut(contact + 1);
        let (old, new) = (&before[source][..], &mut after[0][..]);
        let columns = normal + 1..width;
        // The rows before the contact's own two, and those after them.
        let (above, rest) = old.split_at(tangential * width);
        let (own, below) = rest.split_at(2 * width);
        let (new_above, rest) = new.split_at_mut(tangential * width);
        let (new_own, new_below) = rest.split_at_mut(2 * width);
        let (own_t, own_n) = own.split_at(width);
        let (new_t, new_n) = new_own.split_at_mut(width);
        if let Impulse::Along(ray) = impulse {
            let ray = ray.map(T::from_f64);
            let along = |row: &[T]| ray[0] * row[tangential] + ray[1] * row[normal];
            let pivot = along(own_n);
            self.pivots[contact] = pivot;
            for column in columns.clone() {
                new_n[column] = -own_n[column] / pivot;
            }
            for (old, new) in [(above, new_above), (own_t, new_t), (below, new_below)] {
                for (old, new) in old.chunks_exact(width).zip(new.chunks_exact_mut(width)) {
                    let factor = along(old);
                    for column in columns.clone() {
                        new[column] = old[column] + factor * new_n[column];
                    }
                }
            }
        } else {
            let [g_tt, g_tn] = [own_t[tangential], own_t[normal]];
            let [g_nt, g_nn] = [own_n[tangential], own_n[normal]];
            let determinant = g_tt * g_nn - g_tn * g_nt;
            self.pivots[contact] = determinant;
            for column in columns.clone() {
                let (c_t, c_n) = (own_t[column], own_n[column]);
                new_t[column] = (g_tn * c_n - g_nn * c_t) / determinant;
                new_n[column] = (g_nt * c_t - g_tt * c_n) / determinant;
            }
            for (old, new) in [(above, new_above), (below, new_below)] {
                for (old, new) in old.chunks_exact(width).zip(new.chunks_exact_mut(width)) {
                    let (by_t, by_n) = (old[tangential], old[normal]);
                    for column in columns.clone() {
                        new[column] = old[column] + by_t * new_t[column] + by_n * new_n[column];
                    }
                }
            }
        }
        contact + 1
    }
}

impl<T: Real> Leaf<'_, T> {
    fn constant(&self, row: usize) -> T {
        let columns = 2 * self.modes.len();
        self.tableau[row * (columns + 1) + columns]
    }

    fn impulses(&self, contact: usize) -> Impulse {
        self.laws[contact].impulse(self.modes[contact])
    }

    /// The two numbers of a contact: `[c_t, xi_n]` if L = 0, `[c_t, lambda]` if L is lambda times a ray, `[L_t, L_n]`
    /// if L is free.
    pub fn numbers(&self, contact: usize) -> Pair<T> {
        [self.constant(2 * contact), self.constant(2 * contact + 1)]
    }

    /// Impulse of a contact, [tangential, normal] \[N s\].
    pub fn impulse(&self, contact: usize) -> Pair<T> {
        let [first, second] = self.numbers(contact);
        match self.impulses(contact) {
            Impulse::Zero => [T::zero(); 2],
            Impulse::Along(ray) => ray.map(|entry| T::from_f64(entry) * second),
            Impulse::Free => [first, second],
        }
    }

    /// Velocity of a contact as `[c_t, xi_n]` \[m/s\]; c_n = xi_n - bounce.
    pub fn velocity(&self, contact: usize) -> Pair<T> {
        let [first, second] = self.numbers(contact);
        match self.impulses(contact) {
            Impulse::Zero => [first, second],
            Impulse::Along(_) => [first, T::zero()],
            Impulse::Free => [T::zero(); 2],
        }
    }
}

impl Leaf<'_, Rounded> {
    /// Whether an error is known of every number, so that no pivot is zero.
    pub fn is_known(&self) -> bool {
        (0..2 * self.modes.len()).all(|row| self.constant(row).error.is_finite())
    }
}

/// The lists of modes that one leaf stands for: all whose impulses are the same. Memory that is reused.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    modes: Vec<Mode>,
    /// Contacts whose mode varies, and the modes.
    open: Vec<(usize, &'static [Mode])>,
}

impl Labels {
    /// Visits every list of a leaf's `modes`; `shares` is whether modes with the same impulses are visited as one.
    pub fn visit(&mut self, modes: &[Mode], laws: &[Law], shares: bool, mut visit: impl FnMut(&[Mode])) {
        if !shares {
            return visit(modes);
        }
        modes.clone_into(&mut self.modes);
        self.open.clear();
        let group = |(contact, (mode, law)): (usize, (&Mode, &Law))| {
            let group = law.modes().iter().find(|group| group[0] == *mode)?;
            (group.len() > 1).then_some((contact, *group))
        };
        self.open.extend(modes.iter().zip(laws).enumerate().filter_map(group));
        loop {
            visit(&self.modes);
            let advances = self.open.iter().any(|&(contact, group)| {
                let next = group.iter().position(|&mode| mode == self.modes[contact]).map_or(0, |place| place + 1);
                self.modes[contact] = group[next % group.len()];
                next < group.len()
            });
            if !advances {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::problem::Errors;
    use crate::impact::slack::Scale;
    use crate::scalar::{Interval, Ordered, Sign};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_keep_within_their_errors(
            mut rows in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 7), 6),
            before in prop::collection::vec(
                prop_oneof![2 => prop::array::uniform2(-1.0..1.0f64), 1 => Just([0.0; 2])],
                3,
            ),
            off in prop::collection::vec(-1.0..1.0f64, 42),
            errors in prop::option::of((-50.0..-20.0f64, -50.0..-20.0f64)),
            friction in prop::collection::vec(
                prop_oneof![Just(Friction::ZERO), Just(Friction::Infinite), (0.01..10.0f64).prop_map(Friction::Finite)],
                3,
            ),
            light in -8..8i32,
        ) {
            rows[2].iter_mut().for_each(|entry| *entry *= 10f64.powi(light));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b))).collect();
            let problem = ContactProblem::new(delassus, before, friction, vec![0.5, 0.0, 0.0]).unwrap();
            // What the f64 problem is off by, of contacts that move.
            let [of_delassus, of_velocity] = errors.map_or([0.0; 2], |(a, b)| [a.exp2(), b.exp2()]);
            let moving = |contact: usize, axis: usize| problem.velocity_before()[contact][axis] != 0.0;
            let noise = |contact: usize, axis: usize| if moving(contact, axis) { of_velocity } else { 0.0 };
            let velocity: Vec<Pair<f64>> = (0..3).map(|contact| [noise(contact, 0), noise(contact, 1)]).collect();
            let errors = Errors { delassus: of_delassus, velocity: Some(&velocity), likely: [1.0; 2] };
            let mut scale = Scale::default();
            scale.measure(&problem, errors);
            let mut tableau = Tableau::default();
            tableau.load_entries(problem.laws(), scale.delassus(&problem, errors), scale.free(&problem, errors));
            let true_entry = |row: usize, column: usize| {
                let size = of_delassus * scale.mobility[row] * scale.mobility[column];
                (problem.delassus(row, column), off[row * 6 + column] * size)
            };
            let sum = |(value, off): (f64, f64)| Interval::from_f64(value) + Interval::from_f64(off);
            let true_free = |row: usize| {
                let own = sum((problem.velocity_free()[row / 2][row % 2], off[36 + row] * noise(row / 2, row % 2)));
                let approaches = row % 2 == 1 && own.sign() == Sign::Negative;
                let bounce = if approaches { problem.restitution()[row / 2] } else { 0.0 };
                own + Interval::from_f64(bounce) * own
            };
            tableau.visit(&mut |leaf: &Leaf<'_, Rounded>| Interval::scope(512, || {
                let mut tableau = Tableau::<Interval>::default();
                tableau.load_entries(problem.laws(), |row, column| sum(true_entry(row, column)), true_free);
                let exact = tableau.leaf(leaf.modes);
                for contact in 0..3 {
                    for (own, exact) in leaf.numbers(contact).into_iter().zip(exact.numbers(contact)) {
                        let error = (exact - Interval::from_f64(own.value)).to_f64().abs();
                        let is_beyond = error > own.error();
                        assert!(!is_beyond, "{:?}: {error:e} > {:e}", leaf.modes, own.error());
                        // What an elimination leaves without an error is exactly zero.
                        assert!(own.error != 0.0 || own.value == 0.0 || leaf.modes == [Mode::Separate; 3]);
                    }
                }
            }));
        }
    }
}
