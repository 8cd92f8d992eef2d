//! A state in sustained contact: every consistent set of contact forces and accelerations.
//!
//! ```text
//!     M a = h + J^T f + K^T l,   K a + kappa = 0      c' = J a + sigma = c'_free + G f      h = tau - b (gravity, v v)
//! ```
//!
//! With forces for impulses and accelerations for velocities it is the contact problem of an impact, with the same G
//! and the same law, for contacts that neither approach nor leave; those that slide already keep their direction
//! ([`Law::Sliding`]). No theorem forces an outcome upon those: none and two are Painleve's paradoxes. Without one the
//! velocities jump, by an impact without approach.

use super::assembly::Loads;
use super::exact::{Asked, ExactState};
use super::resting::Standing;
use super::{Impact, Pipeline, Prepared};
use crate::budget::within;
use crate::contact::{Contact, Surface, level};
use crate::dynamics::{Closed, ContactPoint, articulated_inertias};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::{AnalysisOptions, ContactProblem, Errors, ListedRejections, Outcome, Verdict};
use crate::law::{Law, Mode};
use crate::planar::Vector;
use crate::scalar::dot;
use crate::state::{Scene, State};
use std::cmp::Ordering;

/// The answer for one state in sustained contact.
#[derive(Debug, Clone)]
pub struct Forces {
    /// As of an impact, with forces \[N\] for impulses, accelerations \[m/s^2, rad/s^2\] for velocities after it, and
    /// in the problem accelerations without contact forces for velocities. Its contacts are those that take part, and
    /// `velocity_before` is how they move.
    pub answer: Impact,
    /// How each contact slides: the sign of its velocity along t.
    pub slips: Vec<Ordering>,
    /// With [`Verdict::None`], every outcome of the impact without approach that has an impulse; `None` if it is not
    /// decided.
    pub shock: Option<Vec<Outcome>>,
}

impl Forces {
    /// Power of the contact forces of an outcome \[W\].
    pub fn power(&self, outcome: &Outcome) -> f64 {
        let [force, velocity] = [&outcome.impulse, &self.answer.velocity_before].map(|list| list.as_flattened());
        dot(force, velocity) + 0.0
    }
}

impl Pipeline<'_> {
    /// Every consistent set of contact forces and accelerations of one state.
    ///
    /// Closed contacts take part if their normal velocity is zero, to rounding or below
    /// [`Options::resting_speed`](super::Options::resting_speed); those that leave are open.
    ///
    /// # Errors
    /// As [`Pipeline::impact`], and `Inconsistent` for a contact that approaches the ground, for applied impulses and
    /// for a contact that rolls or slides over a corner of the ground.
    pub fn forces(&mut self, state: &State) -> Result<Forces> {
        within(self.options.budget, || self.sustained(state))
    }

    fn sustained(&mut self, state: &State) -> Result<Forces> {
        let scene = &state.scene;
        if !scene.impulses.is_empty() {
            let reason = Reason::Inconsistent("an applied impulse acts in an impact, not in sustained contact".into());
            return Err(Error::new(reason).at("impulse").hint("leave it out, or ask `impact`"));
        }
        let mut prepared = self.prepare(state)?;
        if let Some(merged) = prepared.merged.iter().find(|merged| merged.is_uneven) {
            let name = merged.outer.first().map_or("", |&at| &prepared.contacts[at].name);
            let reason =
                format!("circles of different radii touch the ground at one place, {name}, and roll differently");
            let hint = "name the one that carries in contacts, or switch off the reduction merge";
            return Err(Error::new(Reason::Inconsistent(reason)).hint(hint));
        }
        let slips = self.take_part(state, &mut prepared)?;
        if state.uncertainty.is_some() {
            prepared.notes.push("the uncertainty is not asked about: forces are those of the given numbers".to_owned());
        }
        let still = self.still(state, &prepared, &slips)?;
        let loads = Loads { gravity: scene.gravity.unwrap_or(Scene::GRAVITY), torque: &scene.torque, still: &still };
        for &joint in scene.braked.iter().filter(|&&joint| scene.torque.get(joint).is_some_and(|&own| own != 0.0)) {
            let name = &self.robot.joints[joint].name;
            prepared.notes.push(format!("{name} is held: its torque is carried by what holds it, and has no effect"));
        }

        let (unclosed, drifts) = self.assembly.acceleration(&prepared.velocity, loads);
        let mut free = unclosed.clone();
        self.assembly.answer_to(Closed::Acceleration(&drifts), &mut free);
        for &entry in &free {
            finite(entry, || "an acceleration".into())?;
        }
        let own = self.assembly.contact_accelerations(&free, loads);
        let contacts = prepared.contacts.len();
        let laws = prepared.problem.laws().iter().zip(&slips).map(|(law, slip)| match slip {
            Ordering::Equal => *law,
            slip => Law::Sliding(law.friction(), Mode::closed(*slip)),
        });
        let delassus = self.assembly.workspace.delassus.clone();
        let posed = ContactProblem::checked(delassus, own.clone(), own, laws.collect(), vec![0.0; contacts])?;
        let struck = std::mem::replace(&mut prepared.problem, posed);
        let asked = AnalysisOptions {
            rejections: (contacts > 0 && contacts <= self.options.explain_up_to).into(),
            prove: !self.options.no_proof,
            brief: self.options.brief,
            reductions: self.options.reductions,
        };
        let exact = prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN);
        let source = ExactState { asked: Asked::Forces(loads), ..exact };
        let mut analysis = self.scratch.analyze(&prepared.problem, &source, asked).ok();
        if let Some(analysis) = analysis.as_mut().filter(|own| own.verdict == Verdict::NoImpact) {
            analysis.verdict = Verdict::Unique;
        }
        let is_none = analysis.as_ref().is_some_and(|own| own.verdict == Verdict::None);
        let mut shock = match is_none {
            true => self.shock(state, &prepared, (&struck, &slips), asked),
            false => None,
        };

        if !self.assembly.plan.has_mimics && contacts > 0 {
            articulated_inertias(&self.assembly.plan, &mut self.assembly.workspace);
        }
        let rest = vec![0.0; free.len()];
        let brief = self.options.brief;
        for outcome in analysis.iter_mut().flat_map(|own| &mut own.outcomes).filter(|_| !brief) {
            self.set_velocity(outcome, &rest, &unclosed, &free, Closed::Acceleration(&drifts));
        }
        for outcome in shock.iter_mut().flatten() {
            self.set_velocity(outcome, &prepared.velocity, &rest, &prepared.velocity, Closed::Change);
        }
        let left_out = if self.options.brief { Vec::new() } else { self.left_out(scene, &prepared) };
        let answer = Impact {
            velocity_before: self.assembly.workspace.contact_velocity.clone(),
            matrices: self.options.matrices.then(|| self.matrices()),
            left_out,
            friction_needed: None,
            holds: None,
            analysis,
            notes: std::mem::take(&mut prepared.notes),
            ..Impact::of(prepared)
        };
        Ok(Forces { answer, slips, shock })
    }

    /// Leaves the contacts that take part, with what is known of them; gives how they slide.
    fn take_part(&mut self, state: &State, prepared: &mut Prepared) -> Result<Vec<Ordering>> {
        let Prepared { velocity, foot, contacts, levels, stance, resting, merged, placement, notes, .. } =
            &mut *prepared;
        let standing = Standing { foot: foot.as_ref(), place: *stance };
        self.bound_velocities(contacts, levels, velocity, standing);
        let slips = self.slips(state, velocity, contacts, foot.as_ref(), notes)?;
        let stays: Vec<usize> = (0..slips.len()).filter(|&at| slips[at].is_some()).collect();
        if stays.len() < slips.len() {
            for (contact, _) in contacts.iter().zip(&slips).filter(|(_, slip)| slip.is_none()) {
                notes.push(format!("{} leaves the ground, and takes no part", contact.name));
            }
            let place = |at: usize| stays.iter().position(|&own| own == at);
            let known = stays.iter().map(|&at| self.assembly.workspace.contact_velocity[at]).collect();
            *contacts = stays.iter().map(|&at| contacts[at].clone()).collect();
            *stance = stance.and_then(place);
            *resting = stays.iter().map(|&at| resting[at]).collect();
            merged.retain_mut(|merged| {
                merged.outer = merged.outer.iter().filter_map(|&at| place(at)).collect();
                !merged.outer.is_empty()
            });
            if state.scene.contacts.is_none() {
                *levels = level(contacts, placement, *stance);
            }
            self.assembly.points = contacts.iter().map(Contact::point_of).collect();
            self.assembly.contact_jacobian(velocity, *stance);
            self.assembly.workspace.contact_velocity = known;
            self.assembly.delassus();
        }
        // That of an impact without approach.
        prepared.problem = self.problem(&state.scene, &prepared.contacts, &prepared.change)?;
        Ok(slips.into_iter().flatten().collect())
    }

    /// Which contacts are on a body that does not turn, because another of its contacts on the same straight ground
    /// takes part, too. Contacts that move over a corner of the ground, where the normal turns, are refused.
    fn still(&self, state: &State, prepared: &Prepared, slips: &[Ordering]) -> Result<Vec<bool>> {
        let contacts = &prepared.contacts;
        let still: Vec<bool> = contacts
            .iter()
            .map(|own| {
                let is_apart = |other: &Contact| own.tangent().dot(other.point - own.point) != 0.0;
                contacts.iter().any(|other| (other.body, other.ground) == (own.body, own.ground) && is_apart(other))
            })
            .collect();
        let surface = Surface::new(&state.scene.ground);
        for ((contact, slip), still) in contacts.iter().zip(slips).zip(&still) {
            let center = ContactPoint { radius: 0.0, ..contact.point_of() };
            let rolls = || !still && self.assembly.velocity_of(&center, &prepared.velocity) != Vector::zero();
            if surface.is_corner(contact) && (slip.is_ne() || rolls()) {
                let reason =
                    format!("{} moves over a corner of the ground, where the normal turns with it", contact.name);
                let hint = "ask before or after the corner, or replace the corner by a short segment";
                return Err(Error::new(Reason::Inconsistent(reason)).at("ground.profile").hint(hint));
            }
        }
        Ok(still)
    }

    /// Every outcome with an impulse of an impact at contacts that neither approach nor leave; `None` if it is
    /// undecided.
    fn shock(
        &mut self,
        state: &State,
        prepared: &Prepared,
        (struck, slips): (&ContactProblem, &[Ordering]),
        asked: AnalysisOptions<'_>,
    ) -> Option<Vec<Outcome>> {
        let exact = prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN);
        let (laws, restitution) = (struck.laws(), struck.restitution());
        let source = ExactState { asked: Asked::Shock(slips), laws, restitution, ..exact };
        let asked = AnalysisOptions { rejections: ListedRejections::Nothing, ..asked };
        let analysis = self.scratch.analyze(struck, &source, asked).ok().filter(|own| own.open.is_none())?;
        let pushes = |outcome: &Outcome| outcome.impulse.as_flattened().iter().any(|&entry| entry != 0.0);
        Some(analysis.outcomes.into_iter().filter(pushes).collect())
    }
}
