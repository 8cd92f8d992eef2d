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
use crate::scalar::Real;
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
    /// The depth of the tableau that the leaf is read from: the last closed contact's number, from 1.
    pub depth: usize,
}

/// A visitor of all combinations.
pub trait Visitor<T> {
    fn leaf(&mut self, leaf: &Leaf<'_, T>);

    /// The impulses of `contact` were eliminated from the tableau of depth `source` to that of depth `contact` + 1.
    fn eliminated(&mut self, _tableau: &Tableau<T>, _contact: usize, _source: usize) {}

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
        let n = problem.contacts();
        let width = 2 * n + 1;
        self.contacts = n;
        problem.laws().clone_into(&mut self.laws);
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
            entries[..2 * n].copy_from_slice(problem.delassus_row(row));
            entries[2 * n] = problem.free_row(row);
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
            let depth = self.decide(contact, mode, source);
            if depth != source {
                visitor.eliminated(self, contact, source);
            }
            source = depth;
        }
        visitor.leaf(&self.at(source));
    }

    /// Eliminates all impulses of one contact after the other, as if each stuck and had friction, and calls `visit`
    /// after each. The laws that it was loaded with are lost.
    pub fn stick_all(&mut self, mut visit: impl FnMut(&Self, usize)) {
        self.laws.fill(Friction::Infinite.into());
        for contact in 0..self.contacts {
            self.modes[contact] = Mode::Stick;
            self.decide(contact, Mode::Stick, contact);
            visit(self, contact);
        }
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
        Leaf { modes: &self.modes, pivots: &self.pivots, tableau, laws: &self.laws, depth }
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
                if depth != source {
                    visitor.eliminated(self, contact, source);
                }
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

impl<T: Copy> Tableau<T> {
    /// The impulses and the pivot of a decided contact.
    pub fn decided(&self, contact: usize) -> (Impulse, T) {
        (self.laws[contact].impulse(self.modes[contact]), self.pivots[contact])
    }

    /// A row of the tableau of this depth: the coefficients of all impulses, then the constant.
    pub fn row(&self, depth: usize, row: usize) -> &[T] {
        let width = 2 * self.contacts + 1;
        &self.depths[depth][row * width..(row + 1) * width]
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
