//! The motion of the whole robot after an outcome: velocities of base and joints and the impulses of loops, or the
//! accelerations under forces.
//!
//! ```text
//!     v+ = v- + M^-1 (applied + J^T L + K^T l)      f64 --likely error too large--> balls ... intervals
//! ```
//!
//! L is the printed impulse, taken exactly. Each entry is right to 1e-10 of the velocity before or, if that is larger,
//! of the greatest effect of the impulses, sqrt((M^-1)_jj) sum |L_r| sqrt(G_rr).

use super::assembly::Elimination;
use super::exact::{Asked, ExactState};
use super::{Pipeline, Prepared};
use crate::dynamics::{Closed, articulated_inertias};
use crate::impact::{Attempt, DIGITS, Errors, Outcome, Precision, Rung, climb, is_known};
use crate::planar::{Pair, Vector};
use crate::state::{Named, State};

/// The robot's motion without contact impulses.
#[derive(Debug, Clone, Copy)]
pub(super) struct FreeMotion<'a> {
    /// The velocity before the impact, by coordinate; zero for forces.
    pub before: &'a [f64],
    /// Its change by the applied impulses alone; for forces the acceleration from the loads alone.
    pub applied: &'a [f64],
    /// The sum of both and of the loops' response.
    pub free: &'a [f64],
    /// Likely errors of `free` by coordinate that do not come from errors of G; empty if there are none.
    pub errors: &'a [f64],
    /// The quantity in which the loops are closed.
    pub closed: Closed<'a, f64>,
}

impl Pipeline<'_> {
    /// Adds to `outcomes` the robot's velocity after each and the impulses of the loops, computed by articulated
    /// inertias if there are no mimic joints. An outcome whose digits cannot be shown becomes unproven.
    pub(super) fn respond(
        &mut self,
        outcomes: &mut [Outcome],
        (state, prepared, asked): (&State, &Prepared, Asked<'_>),
        unstruck: FreeMotion<'_>,
    ) {
        if !self.assembly.plan.has_mimics && outcomes.iter().any(|outcome| !outcome.impulse.is_empty()) {
            articulated_inertias(&self.assembly.plan, &mut self.assembly.workspace);
        }
        for outcome in &mut *outcomes {
            self.set_velocity(outcome, unstruck);
        }
        if self.options.no_proof {
            return;
        }
        let has_digits = self.has_digits(prepared);
        let serves = |outcome: &Outcome| has_digits && self.loads_have_digits(outcome, unstruck);
        let source = ExactState { asked, ..prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN) };
        for outcome in outcomes.iter_mut().filter(|outcome| outcome.proven && !serves(outcome)) {
            let mut sought = Response { source: &source, impulse: &outcome.impulse, found: None };
            climb(Precision::Plain, &mut sought);
            match sought.found {
                Some(mut rates) => {
                    let loops = rates.split_off(state.position.len());
                    let loops = loops.chunks_exact(2).map(|pair| Vector::new(pair[0], pair[1]));
                    self.name(outcome, rates, loops.collect());
                }
                None => outcome.proven = false,
            }
        }
    }

    /// Returns whether f64 likely gives the digits of all velocities, judged by the errors of G and of a stance's base.
    fn has_digits(&self, prepared: &Prepared) -> bool {
        let [of_delassus, of_velocity] = self.bounds.likely;
        let base = prepared.velocity.iter().take(2).fold(0.0, |most: f64, entry| most.max(entry.abs()));
        of_velocity * self.bounds.base <= DIGITS * base && of_delassus * self.bounds.delassus <= DIGITS
    }

    /// Returns whether f64 likely gives the digits of the motion without contact impulses.
    fn loads_have_digits(&self, outcome: &Outcome, FreeMotion { free, errors, .. }: FreeMotion<'_>) -> bool {
        let sizes = || free.iter().zip(outcome.velocity()).map(|(free, after)| free.abs().max(after.abs()));
        let base = sizes().take(self.robot.base_dofs().min(2)).fold(0.0, f64::max);
        let scale = |(coordinate, size)| if coordinate < 2 { f64::max(base, size) } else { size };
        errors.iter().zip(sizes().enumerate().map(scale)).all(|(error, scale)| *error <= DIGITS * scale)
    }

    fn set_velocity(&mut self, outcome: &mut Outcome, unstruck: FreeMotion<'_>) {
        let FreeMotion { before, applied, free, closed, .. } = unstruck;
        let constrained = self.assembly.is_constrained();
        // Articulated bodies keep thirteen digits and more in chains where M = L^T D L leaves eight.
        let by = if self.assembly.plan.has_mimics { Elimination::Ltl } else { Elimination::ArticulatedBodies };
        let mut after = if constrained { applied } else { free }.to_vec();
        for (contact, &impulse) in outcome.impulse.iter().enumerate() {
            self.assembly.add_contact_impulse(by, contact, impulse, &mut after);
        }
        let mut loops = Vec::new();
        if constrained {
            loops = self.assembly.add_constraint_response(closed, &mut after);
            after.iter_mut().zip(before).for_each(|(after, before)| *after += before);
        }
        self.name(outcome, after, loops);
    }

    fn name(&self, outcome: &mut Outcome, mut rates: Vec<f64>, loops: Vec<Vector>) {
        let [base, joints] = &self.names;
        // Turns -0 into 0.
        rates.iter_mut().for_each(|rate| *rate += 0.0);
        let of_joints = rates.split_off(base.len());
        outcome.loop_impulse = (!loops.is_empty()).then_some(loops);
        outcome.base_velocity_after = (!base.is_empty()).then(|| Named::new(base.clone(), rates));
        outcome.joint_velocity_after = Some(Named::new(joints.clone(), of_joints));
    }
}

/// A search for the velocities and loop impulses that follow from these contact impulses.
struct Response<'a> {
    source: &'a ExactState<'a>,
    impulse: &'a [Pair<f64>],
    /// Velocities by coordinate, then x and z of each loop's impulse.
    found: Option<Vec<f64>>,
}

impl Attempt for Response<'_> {
    fn attempt<T: Rung>(&mut self, _: Precision) -> bool {
        let parts = self.source.response::<T>(self.impulse);
        let entries = parts.first().map_or(0, Vec::len);
        let sum = |entry: usize| parts.iter().fold(T::zero(), |sum, part| sum + part[entry]);
        let size = |entry: usize| parts.iter().map(|part| part[entry].to_f64().abs()).sum::<f64>();
        let (rates, is_floating) = (self.source.position.len(), self.source.robot.base_dofs() > 0);
        // Both components of a vector have the same scale.
        let scale = |entry: usize| match entry.checked_sub(rates) {
            None if entry < 2 && is_floating => size(0).max(size(1)),
            None => size(entry),
            Some(row) => size(rates + (row & !1)).max(size(rates + (row | 1))),
        };
        if (0..entries).all(|entry| is_known(sum(entry), scale(entry), DIGITS)) {
            self.found = Some((0..entries).map(|entry| sum(entry).to_f64()).collect());
        }
        self.found.is_some()
    }
}
