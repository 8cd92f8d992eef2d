//! Every outcome of a contact problem, and the verdict.
//!
//! ```text
//!     problem --enumerate--> numbers of each combination --sign--> valid | rejected | undecided --> Analysis
//! ```
//!
//! Each combination is first read in f64 with an estimate of its rounding; what lies within it is read again in
//! [`Ball`] arithmetic, which knows exact zeros; what is still open (vanishing pivots, contacts that depend on each other)
//! goes to the redundant stage, and, where the matrices were given and so are exact, to exact rationals. What none of them
//! tells is undecided, and nothing is guessed.

use super::enumerate::{Leaf, Tableau};
use super::labels::Labels;
use super::mode::Mode;
use super::outcome::{Analysis, Because, Motion, Outcome, Rejection, Verdict};
use super::problem::{ContactProblem, Entry};
use super::reading::{Reading, read_f64, read_signed};
use super::redundant::{Judged, Rows};
use super::region::explanation;
use super::sign::Scale;
use crate::error::{Error, Reason, Result};
use crate::planar::Vector;
use crate::scalar::{Ball, Exact, Ordered, Real, Sign};
use nalgebra::DMatrix;

/// All combinations are tried up to this many contacts (4^10 is a million).
pub const CONTACT_LIMIT: usize = 10;

/// Memory that is reused from problem to problem.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    tableau: Tableau<f64>,
    balls: Tableau<Ball>,
    scale: Scale,
    labels: Labels,
}

/// Every outcome of `problem`; with `explain` also every rejected combination and the paper's section 4 for each contact.
///
/// # Errors
/// [`Reason::TooManyContacts`] beyond [`CONTACT_LIMIT`].
pub fn analyse(problem: &ContactProblem, explain: bool) -> Result<Analysis> {
    Scratch::default().analyse(problem, explain)
}

impl Scratch {
    /// As [`analyse`], with memory that is kept.
    ///
    /// # Errors
    /// [`Reason::TooManyContacts`] beyond [`CONTACT_LIMIT`].
    pub fn analyse(&mut self, problem: &ContactProblem, explain: bool) -> Result<Analysis> {
        let contacts = problem.contacts();
        if contacts > CONTACT_LIMIT {
            return Err(Error::new(Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT })
                .hint("name the contacts that matter by hand, or lower the contact tolerance"));
        }
        self.scale.measure(problem);
        self.tableau.load(problem);
        let (scale, labels) = (&self.scale, &mut self.labels);
        let mut second =
            SecondLook { problem, scale, rows: None, regular: None, balls: &mut self.balls, loaded: false };
        let mut found = Found { explain, ..Found::default() };
        let mut regular = contacts == 0;
        self.tableau.visit(|leaf| {
            let rounding = scale.rounding(&leaf, problem);
            // Where all contacts stick, the pivots are those of the whole matrix.
            regular |= rounding < 1.0 && leaf.modes.iter().all(|&mode| mode == Mode::Stick) && !frictionless(problem);
            labels.start(leaf.modes, problem.friction());
            while let Some(modes) = labels.next() {
                let reading = read_f64(&leaf, modes, problem, scale, rounding, explain);
                if reading.sign == Sign::Undecided {
                    second.look(&leaf, modes, &mut found);
                } else {
                    let motion = || best_motion(&leaf, modes, problem, rounding);
                    found.take_leaf(modes, problem, &reading, index(leaf.pivots), motion);
                }
            }
        });
        found.settle(problem, scale);
        let rank = if regular { 2 * contacts } else { second.rows().rank() };
        let regular = rank == 2 * contacts;
        let Found { outcomes, rejected, .. } = found;
        Ok(Analysis {
            verdict: verdict(contacts, &outcomes),
            proven: false,
            index_sum: outcomes.iter().map(|outcome| outcome.index.map(i32::from)).sum(),
            rank,
            condition: if regular { condition(problem, scale) } else { None },
            no_slip_consistent: no_slip_consistent(&outcomes),
            explanation: if explain && regular { explanation(problem, scale) } else { None },
            outcomes,
            rejected,
        })
    }
}

fn frictionless(problem: &ContactProblem) -> bool {
    problem.friction().iter().any(|friction| friction.is_zero())
}

fn verdict(contacts: usize, outcomes: &[Outcome]) -> Verdict {
    if contacts == 0 {
        return Verdict::NoContact;
    }
    if outcomes.iter().any(|outcome| !outcome.decided) {
        return Verdict::Undecided;
    }
    match outcomes {
        [] => Verdict::None,
        [only] if only.impulse.iter().flatten().all(|&entry| entry == 0.0) => Verdict::NoImpact,
        [_] => Verdict::Unique,
        _ => Verdict::Ambiguous,
    }
}

/// Whether some outcome has no sliding contact; none where that hangs on an undecided combination.
fn no_slip_consistent(outcomes: &[Outcome]) -> Option<bool> {
    let without_slip = || outcomes.iter().filter(|outcome| !outcome.modes.iter().any(|mode| mode.slides()));
    match without_slip().any(|outcome| outcome.decided) {
        false if without_slip().next().is_some() => None,
        found => Some(found),
    }
}

/// Condition number of a regular G scaled to a unit diagonal; by the rows of its factor where G itself is too ill
/// conditioned to tell and they are known.
fn condition(problem: &ContactProblem, scale: &Scale) -> Option<f64> {
    let rows = 2 * problem.contacts();
    if rows == 0 {
        return None;
    }
    let mobility = &scale.mobility;
    let scaled = DMatrix::from_fn(rows, rows, |i, j| problem.delassus(i, j) / (mobility[i] * mobility[j]));
    let values = scaled.symmetric_eigenvalues();
    let condition = values.max() / values.min();
    if (0.0..SQUARED_CONDITION_LIMIT).contains(&condition) {
        return Some(condition);
    }
    let factor = problem.factor()?;
    let entry = |i: usize, j: usize| factor.rows[i * factor.columns + j] / mobility[i];
    let lengths = DMatrix::from_fn(rows, factor.columns, entry).singular_values();
    let ratio = lengths.max() / lengths.min();
    (ratio * ratio).is_finite().then_some(ratio * ratio)
}

/// Beyond this the least eigenvalue of G has lost half of its digits.
const SQUARED_CONDITION_LIMIT: f64 = 1e8;

/// The sign of the product of the pivots.
fn index(pivots: &[f64]) -> i8 {
    pivots.iter().fold(1, |sign, &pivot| if pivot < 0.0 { -sign } else { sign })
}

/// What the first reading left open.
struct SecondLook<'a> {
    problem: &'a ContactProblem,
    scale: &'a Scale,
    rows: Option<Rows>,
    regular: Option<bool>,
    balls: &'a mut Tableau<Ball>,
    loaded: bool,
}

impl SecondLook<'_> {
    fn rows(&mut self) -> &Rows {
        self.rows.get_or_insert_with(|| Rows::of(self.problem, self.scale))
    }

    fn regular(&mut self) -> bool {
        if let Some(regular) = self.regular {
            return regular;
        }
        let regular = self.rows().rank() == 2 * self.problem.contacts();
        *self.regular.insert(regular)
    }

    fn look(&mut self, leaf: &Leaf<'_, f64>, modes: &[Mode], found: &mut Found) {
        if !self.loaded {
            self.balls.load(&enclosed(self.problem, self.scale));
            self.loaded = true;
        }
        let leaf_of_balls = self.balls.leaf(modes);
        let reading = read_signed(&leaf_of_balls, modes, self.problem, self.scale);
        let pivots: Vec<f64> = leaf_of_balls.pivots.iter().map(|pivot| pivot.mid).collect();
        let (problem, scale) = (self.problem, self.scale);
        if reading.sign != Sign::Undecided {
            let rounding = scale.rounding(leaf, problem);
            let motion = || best_motion(leaf, modes, problem, rounding);
            found.take_leaf(modes, problem, &reading, index(&pivots), motion);
            return;
        }
        // Exact elimination decides all but vanishing pivots, which a singular matrix is full of.
        let given = problem.factor().is_none();
        let judged = if given && self.regular() { None } else { Some(self.rows().judge(problem, scale, modes)) };
        // An outcome with a single impulse gains digits by it, too.
        let exact_serves = |judged: &Judged| match judged.sign {
            Sign::Undecided => true,
            sign => sign == Sign::Positive && judged.impulse_unique,
        };
        let open = judged.as_ref().is_none_or(exact_serves);
        if open
            && given
            && let Some((reading, index, motion)) = read_exactly(problem, scale, modes)
        {
            found.take_leaf(modes, problem, &reading, index, || motion);
            return;
        }
        let judged = judged.unwrap_or_else(|| self.rows().judge(problem, scale, modes));
        let index = self.rows().index(problem, scale, modes);
        found.take_judged(modes, self.problem, judged, index);
    }
}

/// What `read` sees in a combination's exact numbers, of matrices that were given and so are exact.
fn exactly<R>(problem: &ContactProblem, modes: &[Mode], read: impl FnOnce(&Leaf<'_, Exact>) -> R) -> R {
    Exact::scope(|| {
        let mut tableau = Tableau::<Exact>::new();
        tableau.load(&problem.map(Exact::from_f64));
        read(&tableau.leaf(modes))
    })
}

/// Reads a combination exactly, with its index; none where a pivot vanishes.
fn read_exactly(problem: &ContactProblem, scale: &Scale, modes: &[Mode]) -> Option<(Reading, i8, Motion)> {
    exactly(problem, modes, |leaf| {
        let reading = read_signed(leaf, modes, problem, scale);
        let pivots: Vec<f64> = leaf.pivots.iter().map(|pivot| pivot.to_f64()).collect();
        let decided = reading.sign != Sign::Undecided;
        decided.then(|| (reading, index(&pivots), motion(leaf, modes, problem, Exact::to_f64)))
    })
}

/// Impulses and velocities of a combination: those of its leaf, or exact but for one rounding where the leaf is ill
/// conditioned and the matrices were given.
fn best_motion(leaf: &Leaf<'_, f64>, modes: &[Mode], problem: &ContactProblem, rounding: f64) -> Motion {
    let regular = |leaf: &Leaf<'_, Exact>| {
        leaf.pivots.iter().all(|pivot| matches!(pivot.sign(), Sign::Negative | Sign::Positive))
    };
    let given = problem.factor().is_none();
    let better = (given && rounding > F64_SERVES)
        .then(|| exactly(problem, modes, |leaf| regular(leaf).then(|| motion(leaf, modes, problem, Exact::to_f64))));
    better.flatten().unwrap_or_else(|| motion(leaf, modes, problem, |number| number))
}

/// Scaled numbers whose rounding is below this are told as f64 has them.
const F64_SERVES: f64 = 1e-12;

/// Impulses and velocities of a leaf.
fn motion<T: Real>(leaf: &Leaf<'_, T>, modes: &[Mode], problem: &ContactProblem, nearest: impl Fn(T) -> f64) -> Motion {
    let contacts = 0..problem.contacts();
    let velocity = |contact: usize| {
        let [c_t, xi_n] = leaf.velocity(contact).map(&nearest);
        let c_t = if modes[contact] == Mode::Stick { 0.0 } else { c_t };
        [c_t, xi_n - problem.bounce(contact)]
    };
    Motion {
        impulse: contacts.clone().map(|contact| leaf.impulse(contact).map(&nearest)).collect(),
        velocity_after: contacts.map(velocity).collect(),
    }
}

/// A problem as balls. Matrices that were given are exact; what the dynamics computed is known to its rounding, except for
/// zeros, which are those of the tree's structure or of a stance.
fn enclosed(problem: &ContactProblem, scale: &Scale) -> ContactProblem<Ball> {
    let rounding = if problem.factor().is_some() { DYNAMICS_ROUNDING } else { 0.0 };
    problem.map_entries(|place, value| {
        let size = match place {
            Entry::Delassus { row, column } => scale.mobility[row] * scale.mobility[column],
            Entry::Velocity { row } => value.abs() + scale.speed * scale.mobility[row],
        };
        let noise = match (place, problem.noise()) {
            (Entry::Velocity { row }, Some(noise)) => noise[row / 2][row % 2],
            _ => 0.0,
        };
        Ball { mid: value, radius: if value == 0.0 && noise == 0.0 { 0.0 } else { rounding * size + noise } }
    })
}

/// What G and c of a robot lose to rounding, relative to their rows' own scale: measured below 3e-15 against 640 bits on
/// chains, straight legs and extreme mass ratios. An estimate; a proof needs the dynamics in balls, too.
const DYNAMICS_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// What has been found so far.
#[derive(Default)]
struct Found {
    explain: bool,
    outcomes: Vec<Outcome>,
    rejected: Vec<Rejection>,
    /// Combinations with a velocity that vanishes to rounding although the modes exclude zero.
    twins: Vec<(Vec<Mode>, Judged, Option<i8>)>,
}

impl Found {
    fn take_leaf(
        &mut self,
        modes: &[Mode],
        problem: &ContactProblem,
        reading: &Reading,
        index: i8,
        motion: impl FnOnce() -> Motion,
    ) {
        if reading.sign != Sign::Negative {
            let mut outcome = outcome(modes, problem, motion());
            outcome.index = (!reading.border).then_some(index);
            outcome.margin = reading.margin.map(|margin| margin + 0.0);
            self.outcomes.push(outcome);
        } else if self.explain {
            let solved = !matches!(reading.because, Because::NothingHolds { .. });
            self.reject(modes, reading.because, reading.margin, solved.then(motion));
        }
    }

    fn take_judged(&mut self, modes: &[Mode], problem: &ContactProblem, judged: Judged, index: Option<i8>) {
        if judged.sign == Sign::Negative {
            if self.explain {
                self.reject(modes, judged.because, judged.margin, judged.motion);
            }
            return;
        }
        if judged.sign == Sign::Zero {
            self.twins.push((modes.to_vec(), judged, index));
            return;
        }
        let decided = judged.sign == Sign::Positive;
        let Some(motion) = judged.motion else { return };
        self.outcomes.push(Outcome {
            impulse_unique: judged.impulse_unique,
            index: index.filter(|_| decided && !judged.border),
            margin: judged.margin,
            decided,
            ..outcome(modes, problem, motion)
        });
    }

    /// A twin is dropped where its velocity is that of a decided outcome; otherwise it stays undecided.
    fn settle(&mut self, problem: &ContactProblem, scale: &Scale) {
        for (modes, mut judged, index) in std::mem::take(&mut self.twins) {
            let velocity = judged.motion.as_ref().map(|motion| motion.velocity_after.as_slice());
            let told = |outcome: &Outcome| {
                outcome.decided && velocity.is_some_and(|own| scale.same_velocity(own, &outcome.velocity_after))
            };
            judged.sign = if self.outcomes.iter().any(told) { Sign::Negative } else { Sign::Undecided };
            judged.because = Because::RedundantTwin;
            self.take_judged(&modes, problem, judged, index);
        }
    }

    fn reject(&mut self, modes: &[Mode], because: Because, margin: Option<f64>, motion: Option<Motion>) {
        self.rejected.push(Rejection { modes: modes.to_vec(), because, margin, motion });
    }
}

/// A decided outcome with a unique impulse; index and margin are the caller's.
fn outcome(modes: &[Mode], problem: &ContactProblem, motion: Motion) -> Outcome {
    // Adding zero turns a negative zero into the one that people expect to read.
    let unsigned = |list: Vec<Vector<f64>>| list.into_iter().map(|pair| pair.map(|entry| entry + 0.0)).collect();
    let (impulse, velocity_after): (Vec<Vector<f64>>, Vec<Vector<f64>>) =
        (unsigned(motion.impulse), unsigned(motion.velocity_after));
    let before = problem.velocity_before();
    let work: f64 = impulse
        .iter()
        .zip(before.iter().zip(&velocity_after))
        .map(|(l, (c, after))| l[0] * (c[0] + after[0]) + l[1] * (c[1] + after[1]))
        .sum();
    let needed = |(&mode, l): (&Mode, &Vector<f64>)| (mode == Mode::Stick && l[1] > 0.0).then(|| l[0].abs() / l[1]);
    Outcome {
        modes: modes.to_vec(),
        energy_loss: 0.0 - 0.5 * work,
        impulse_unique: true,
        friction_needed: modes.iter().zip(&impulse).map(needed).collect(),
        index: None,
        margin: None,
        proven: false,
        decided: true,
        impulse,
        velocity_after,
    }
}

#[cfg(test)]
mod tests {
    use super::super::mode::Friction;
    use super::*;

    #[test]
    fn more_contacts_than_are_tried_are_refused() {
        let contacts = CONTACT_LIMIT + 1;
        let rows = 2 * contacts;
        let identity = (0..rows * rows).map(|k| f64::from(u8::from(k % (rows + 1) == 0))).collect();
        let problem = ContactProblem::new(
            identity,
            vec![[0.0, -1.0]; contacts],
            vec![Friction::Infinite; contacts],
            vec![0.0; contacts],
        )
        .unwrap();
        let refused = analyse(&problem, false).unwrap_err();
        assert_eq!(refused.reason(), &Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT });
    }
}
