//! Computes the numbers of every combination of modes.
//!
//! ```text
//!     c = c_free + G L           xi_n = c_n + bounce
//!     separate  L = 0            stick  c_t = xi_n = 0            slide+-  xi_n = 0,  L = lambda ray
//! ```
//!
//! The modes of the contacts are decided one after the other. Each decision eliminates the contact's impulses from a
//! tableau that expresses everything by the impulses of the contacts not yet decided. Combinations that begin alike
//! share this work: a tree of Schur complements. The contact law says which impulses a mode allows. The product of the
//! pivots is det A (paper, section 2). This module compares no numbers.
//!
//! Cost: 4^n leaves of O(n) each; a frictionless contact counts 2 in place of 4: its closed modes share a leaf.

use super::problem::ContactProblem;
use crate::law::{Friction, Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Real, Rounded};
use std::convert::Infallible;

/// Memory of the enumeration. It is reused from problem to problem and then allocates nothing.
#[derive(Debug, Clone, Default)]
pub struct Tableau<T> {
    contacts: usize,
    laws: Vec<Law>,
    /// Whether every mode is visited by itself, even if other modes have the same impulses.
    pub separately: bool,
    /// Whether sliding modes are left out.
    pub without_slip: bool,
    /// The tableaus by depth. Each has 2n + 1 columns of 2n entries: the coefficients of all impulses, then the
    /// constants. The columns of decided contacts are stale. The two rows of contact i are c_t and xi_n while it is
    /// undecided or separates, c_t and lambda where it slides, and L_t and L_n where it sticks.
    entries: Vec<T>,
    modes: Vec<Mode>,
    pivots: Vec<T>,
}

/// [`Visitor::ends`] is called before each visit of all combinations of this many last contacts.
const AT_ONCE: usize = 6;

/// One combination of modes and its numbers.
#[derive(Debug)]
pub struct Leaf<'a, T> {
    /// One mode per contact. If modes with the same impulses are visited as one, the mode stands for all of them.
    pub modes: &'a [Mode],
    /// One pivot per contact, 1 for a separating contact. Their product is det A, whose sign is the index.
    pub pivots: &'a [T],
    constants: &'a [Pair<T>],
    laws: &'a [Law],
}

/// A visitor of all combinations.
pub trait Visitor<T> {
    fn leaf(&mut self, leaf: &Leaf<'_, T>);

    /// Whether to skip a combination of which only the numbers of the last contact are known yet. A visitor that skips
    /// combinations counts them itself. [`Tableau::visit_one`] does not call this.
    fn drops(&mut self, _modes: &[Mode], _last: &Pair<T>) -> bool {
        false
    }

    /// Whether to stop the visit; called once before each few thousand combinations.
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

    /// Loads a problem given as functions: G by row and column, and the velocities without impulses by row.
    pub fn load_entries(&mut self, laws: &[Law], delassus: impl Fn(usize, usize) -> T, free: impl Fn(usize) -> T) {
        let contacts = laws.len();
        let rows = 2 * contacts;
        self.contacts = contacts;
        laws.clone_into(&mut self.laws);
        self.entries.resize((contacts + 1) * size(contacts), T::zero());
        self.modes.clear();
        self.modes.resize(contacts, Mode::Separate);
        self.pivots.clear();
        self.pivots.resize(contacts, T::one());
        for column in 0..rows {
            for row in 0..rows {
                self.entries[column * rows + row] = delassus(row, column);
            }
        }
        for row in 0..rows {
            self.entries[rows * rows + row] = free(row);
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

    /// The combination in which all contacts stick, as if each had friction. The loaded laws are overwritten.
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

    /// The combination with these modes. Returns an error if `ends` returns one for a pivot on the way.
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
        let constants = self.constants(depth).as_chunks().0;
        Leaf { modes: &self.modes, pivots: &self.pivots, constants, laws: &self.laws }
    }

    fn constants(&self, depth: usize) -> &[T] {
        let rows = 2 * self.contacts;
        &self.entries[depth * size(self.contacts) + rows * rows..][..rows]
    }

    fn descend(&mut self, contact: usize, source: usize, visitor: &mut impl Visitor<T>) {
        if contact == self.contacts {
            visitor.leaf(&self.at(source));
            return;
        }
        if self.contacts - contact == AT_ONCE && visitor.ends() {
            return;
        }
        let is_last = contact + 1 == self.contacts;
        let law = self.laws[contact];
        for group in law.modes() {
            for &mode in if self.separately { group } else { &group[..1] } {
                if self.without_slip && mode.slides() {
                    continue;
                }
                self.modes[contact] = mode;
                let impulse = law.impulse(mode);
                let depth = self.decide_own(contact, impulse, source);
                if is_last && visitor.drops(&self.modes, &self.constants(depth).as_chunks().0[contact]) {
                    continue;
                }
                self.decide_others(contact, impulse, source);
                self.descend(contact + 1, depth, visitor);
            }
        }
    }

    /// Eliminates the contact's impulses and returns the depth that then holds the tableau.
    fn decide(&mut self, contact: usize, mode: Mode, source: usize) -> usize {
        let impulse = self.laws[contact].impulse(mode);
        let depth = self.decide_own(contact, impulse, source);
        self.decide_others(contact, impulse, source);
        depth
    }

    /// Computes the contact's own rows after its impulses are eliminated; returns the depth that holds them.
    fn decide_own(&mut self, contact: usize, impulse: Impulse, source: usize) -> usize {
        if impulse == Impulse::Zero {
            // The contact's columns are not read any more.
            self.pivots[contact] = T::one();
            return source;
        }
        let Step { rows, tangential, normal, old, new } = Step::of(self.contacts, contact, &mut self.entries, source);
        let [g_tt, g_nt] = [old[tangential * rows + tangential], old[tangential * rows + normal]];
        let [g_tn, g_nn] = [old[normal * rows + tangential], old[normal * rows + normal]];
        if let Impulse::Along(ray) = impulse {
            let (factor, pivot) = (along(ray, g_tt, g_tn), along(ray, g_nt, g_nn));
            self.pivots[contact] = pivot;
            for column in normal + 1..=rows {
                let lambda = -old[column * rows + normal] / pivot;
                new[column * rows + tangential] = old[column * rows + tangential] + factor * lambda;
                new[column * rows + normal] = lambda;
            }
        } else {
            let determinant = g_tt * g_nn - g_tn * g_nt;
            self.pivots[contact] = determinant;
            for column in normal + 1..=rows {
                let (c_t, c_n) = (old[column * rows + tangential], old[column * rows + normal]);
                new[column * rows + tangential] = (g_tn * c_n - g_nn * c_t) / determinant;
                new[column * rows + normal] = (g_nt * c_t - g_tt * c_n) / determinant;
            }
        }
        contact + 1
    }

    /// Computes the rows of the other contacts; requires the contact's own rows.
    fn decide_others(&mut self, contact: usize, impulse: Impulse, source: usize) {
        if impulse == Impulse::Zero {
            return;
        }
        let Step { rows, tangential, normal, old, new } = Step::of(self.contacts, contact, &mut self.entries, source);
        for row in (0..rows).filter(|row| row / 2 != contact) {
            let (by_t, by_n) = (old[tangential * rows + row], old[normal * rows + row]);
            if let Impulse::Along(ray) = impulse {
                let factor = along(ray, by_t, by_n);
                for column in normal + 1..=rows {
                    new[column * rows + row] = old[column * rows + row] + factor * new[column * rows + normal];
                }
            } else {
                for column in normal + 1..=rows {
                    let (l_t, l_n) = (new[column * rows + tangential], new[column * rows + normal]);
                    new[column * rows + row] = old[column * rows + row] + by_t * l_t + by_n * l_n;
                }
            }
        }
    }
}

/// The tableaus before and after a contact is decided, and the contact's rows in them.
struct Step<'a, T> {
    rows: usize,
    tangential: usize,
    normal: usize,
    old: &'a [T],
    new: &'a mut [T],
}

impl<'a, T> Step<'a, T> {
    #[inline]
    fn of(contacts: usize, contact: usize, entries: &'a mut [T], source: usize) -> Self {
        let (rows, size) = (2 * contacts, size(contacts));
        let (before, after) = entries.split_at_mut((contact + 1) * size);
        let (old, new) = (&before[source * size..][..size], &mut after[..size]);
        Self { rows, tangential: 2 * contact, normal: 2 * contact + 1, old, new }
    }
}

/// The effect of an impulse along a ray, from the effects of its two parts. The normal part of most rays is 1.
#[inline]
fn along<T: Real>([ray_t, ray_n]: [f64; 2], by_t: T, by_n: T) -> T {
    by_t.scaled(ray_t) + if ray_n == 1.0 { by_n } else { by_n.scaled(ray_n) }
}

/// The number of entries of a tableau.
fn size(contacts: usize) -> usize {
    2 * contacts * (2 * contacts + 1)
}

impl<T: Real> Leaf<'_, T> {
    fn impulses(&self, contact: usize) -> Impulse {
        self.laws[contact].impulse(self.modes[contact])
    }

    /// The two numbers of a contact: `[c_t, xi_n]` if L = 0, `[c_t, lambda]` if it has a ray, `[L_t, L_n]` if free.
    #[inline]
    pub fn numbers(&self, contact: usize) -> &Pair<T> {
        &self.constants[contact]
    }

    /// The impulse of a contact, [tangential, normal] \[N s\].
    pub fn impulse(&self, contact: usize) -> Pair<T> {
        let [first, second] = *self.numbers(contact);
        match self.impulses(contact) {
            Impulse::Zero => [T::zero(); 2],
            Impulse::Along(ray) => ray.map(|entry| T::from_f64(entry) * second),
            Impulse::Free => [first, second],
        }
    }

    /// The velocity of a contact as `[c_t, xi_n]` \[m/s\]; c_n = xi_n - bounce.
    pub fn velocity(&self, contact: usize) -> Pair<T> {
        let [first, second] = *self.numbers(contact);
        match self.impulses(contact) {
            Impulse::Zero => [first, second],
            Impulse::Along(_) => [first, T::zero()],
            Impulse::Free => [T::zero(); 2],
        }
    }
}

impl Leaf<'_, Rounded> {
    /// Whether the errors of all numbers are finite, which shows that no pivot is zero.
    pub fn is_known(&self) -> bool {
        self.constants.as_flattened().iter().all(|number| number.error.is_finite())
    }
}

/// The combinations that one leaf stands for, all with the same impulses. Its memory is reused.
#[derive(Debug, Clone, Default)]
pub struct Labels {
    modes: Vec<Mode>,
    /// The contacts whose mode varies, and their modes.
    open: Vec<(usize, &'static [Mode])>,
}

impl Labels {
    /// Visits every combination that a leaf's `modes` stand for; `shares` if modes with the same impulses are one leaf.
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
            // The errors of the f64 problem; only contacts that move have an error in c.
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
                let free = sum((problem.velocity_free()[row / 2][row % 2], off[36 + row] * noise(row / 2, row % 2)));
                let approaches = row % 2 == 1 && free.sign() == Sign::Negative;
                let bounce = if approaches { problem.restitution()[row / 2] } else { 0.0 };
                free + Interval::from_f64(bounce) * free
            };
            tableau.visit(&mut |leaf: &Leaf<'_, Rounded>| Interval::scope(512, || {
                let mut tableau = Tableau::<Interval>::default();
                tableau.load_entries(problem.laws(), |row, column| sum(true_entry(row, column)), true_free);
                let exact = tableau.leaf(leaf.modes);
                for contact in 0..3 {
                    for (number, exact) in leaf.numbers(contact).iter().zip(*exact.numbers(contact)) {
                        let error = (exact - Interval::from_f64(number.value)).to_f64().abs();
                        let is_beyond = error > number.error();
                        assert!(!is_beyond, "{:?}: {error:e} > {:e}", leaf.modes, number.error());
                        // After an elimination, a number without an error is exactly zero.
                        assert!(number.error != 0.0 || number.value == 0.0 || leaf.modes == [Mode::Separate; 3]);
                    }
                }
            }));
        }
    }
}
