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
use super::response::Unstruck;
use super::resting::Standing;
use super::{Impact, Pipeline, Prepared};
use crate::budget::within;
use crate::contact::{Contact, Surface, level};
use crate::dynamics::{Closed, ContactPoint};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::{Analysis, AnalysisOptions, ContactProblem, Errors, ListedRejections, Next, Outcome, Verdict};
use crate::law::{Law, Mode};
use crate::planar::Vector;
use crate::scalar::dot;
use crate::state::{Named, Scene, State};
use std::cmp::Ordering;

/// What an [`Impact`] is of a state in sustained contact: its numbers are forces \[N\] for impulses, accelerations
/// \[m/s^2, rad/s^2\] for velocities after it, and in the problem accelerations without contact forces for velocities.
/// Its contacts are those that take part, and `velocity_before` is how they move.
#[derive(Debug, Clone)]
pub struct Sustained {
    /// How each contact slides: the sign of its velocity along t.
    pub slips: Vec<Ordering>,
    /// With [`Verdict::None`], every outcome of the impact without approach that has an impulse; `None` if it is not
    /// decided.
    pub shock: Option<Vec<Outcome>>,
    /// Gravity along -z of the world \[m/s^2\].
    pub gravity: f64,
    /// What acts at each joint \[N m, N\].
    pub torque: Named,
}

/// A state in sustained contact without contact forces.
struct Unforced {
    /// Which contacts are on a body that does not turn.
    still: Vec<bool>,
    /// Acceleration by coordinate, without and with what the loops answer \[m/s^2, rad/s^2\].
    unclosed: Vec<f64>,
    free: Vec<f64>,
    /// kappa of each loop.
    drifts: Vec<Vector>,
    /// The problem of an impact there.
    struck: ContactProblem,
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
    pub fn forces(&mut self, state: &State) -> Result<Impact> {
        within(self.options.budget, || self.sustained(state, None))
    }

    /// As [`Pipeline::forces`]; if modes are `chosen`, of all rejected combinations those are listed.
    pub(super) fn sustained(&mut self, state: &State, chosen: Option<&[Vec<Mode>]>) -> Result<Impact> {
        let scene = &state.scene;
        let (mut prepared, slips) = self.prepare_sustained(state)?;
        if state.uncertainty.is_some() {
            prepared.notes.push("the uncertainty is not asked about: forces are those of the given numbers".to_owned());
        }
        for &joint in scene.braked.iter().filter(|&&joint| scene.torque.get(joint).is_some_and(|&own| own != 0.0)) {
            let name = &self.robot.joints[joint].name;
            prepared.notes.push(format!("{name} is held: its torque is carried by what holds it, and has no effect"));
        }

        let Unforced { still, unclosed, free, drifts, struck } = self.pose(state, &mut prepared, &slips)?;
        let asked = self.asked_of_forces(prepared.contacts.len(), chosen);
        let mut analysis = self.analyze_forces(state, &prepared, &still, asked);
        let is_none = analysis.as_ref().is_some_and(|own| own.verdict == Verdict::None);
        let mut shock = match is_none {
            true => self.shock(state, &prepared, (&struck, &slips), asked),
            false => None,
        };

        let rest = vec![0.0; free.len()];
        let velocity = self.assembly.workspace.contact_velocity.as_flattened();
        for outcome in analysis.iter_mut().flat_map(|own| &mut own.outcomes) {
            outcome.energy_loss = 0.0 - dot(outcome.impulse.as_flattened(), velocity);
        }
        if let Some(analysis) = analysis.as_mut().filter(|_| !self.options.brief) {
            let unstruck =
                Unstruck { before: &rest, applied: &unclosed, free: &free, closed: Closed::Acceleration(&drifts) };
            let asked = Asked::Forces(Loads::of(scene, &still));
            self.respond(&mut analysis.outcomes, (state, &prepared, asked), unstruck);
            analysis.proven &= analysis.outcomes.iter().all(|outcome| outcome.proven);
        }
        if let Some(shock) = &mut shock {
            let before = &prepared.velocity;
            let unstruck = Unstruck { before, applied: &rest, free: before, closed: Closed::Change };
            self.respond(shock, (state, &prepared, Asked::Shock(&slips)), unstruck);
        }
        let left_out = if self.options.brief { Vec::new() } else { self.left_out(scene, &prepared) };
        let torque = |joint: usize| scene.torque.get(joint).copied().unwrap_or(0.0);
        let sustained = Sustained {
            slips,
            shock,
            gravity: scene.gravity.unwrap_or(Scene::GRAVITY),
            torque: self.robot.joints.iter().enumerate().map(|(at, own)| (own.name.clone(), torque(at))).collect(),
        };
        Ok(Impact {
            velocity_before: self.assembly.workspace.contact_velocity.clone(),
            matrices: self.options.matrices.then(|| self.matrices()),
            left_out,
            analysis,
            notes: std::mem::take(&mut prepared.notes),
            sustained: Some(sustained),
            ..Impact::of(prepared)
        })
    }

    /// Everything up to the contact problem of forces.
    pub(super) fn prepare_forces(&mut self, state: &State) -> Result<Prepared> {
        let (mut prepared, slips) = self.prepare_sustained(state)?;
        self.pose(state, &mut prepared, &slips)?;
        Ok(prepared)
    }

    /// Everything up to the contacts that take part, and how these slide.
    fn prepare_sustained(&mut self, state: &State) -> Result<(Prepared, Vec<Ordering>)> {
        if !state.scene.impulses.is_empty() {
            let reason = Reason::Inconsistent("an applied impulse acts in an impact, not in sustained contact".into());
            return Err(Error::new(reason).at("impulse").hint("leave it out, or ask `impact`"));
        }
        let mut prepared = self.prepare(state)?;
        Self::refuse_uneven(&prepared)?;
        let Prepared { velocity, foot, contacts, levels, stance, notes, .. } = &mut prepared;
        let standing = Standing { foot: foot.as_ref(), place: *stance };
        self.bound_velocities(contacts, levels, velocity, standing);
        let slips = self.slips(state, velocity, contacts, foot.as_ref(), notes)?;
        for (contact, _) in contacts.iter().zip(&slips).filter(|(_, slip)| slip.is_none()) {
            notes.push(format!("{} leaves the ground, and takes no part", contact.name));
        }
        self.take_part(state, &mut prepared, &slips)?;
        Ok((prepared, slips.into_iter().flatten().collect()))
    }

    /// What happens just after an impact, of its decided outcomes: the forces at the velocities that they print, in
    /// which contacts take part as their modes say. Notes what is not known.
    pub(super) fn follow(&mut self, state: &State, impact: &Prepared, analysis: &mut Analysis) -> Vec<String> {
        let scene = Scene { impulses: Vec::new(), ..state.scene.clone() };
        let after = State { scene, ..state.clone() };
        let mut notes = Vec::new();
        for (at, outcome) in analysis.outcomes.iter_mut().enumerate().filter(|(_, outcome)| outcome.decided) {
            match self.next(&after, impact, outcome) {
                Ok(next) => outcome.next = next,
                Err(error) => notes.push(format!("what follows outcome {} is not known: {}", at + 1, error.reason())),
            }
        }
        notes
    }

    /// The forces just after an `outcome`; `None` of more contacts than are enumerated.
    fn next(&mut self, after: &State, impact: &Prepared, outcome: &Outcome) -> Result<Option<Next>> {
        let slip = |(contact, mode): (usize, &Mode)| match mode {
            Mode::Separate => None,
            _ if impact.problem.bounce(contact) != 0.0 => None,
            mode => mode.direction().partial_cmp(&0.0),
        };
        let slips: Vec<Option<Ordering>> = outcome.modes.iter().enumerate().map(slip).collect();
        // The foot of a stance may move after the impact.
        let velocity = outcome.velocity().collect();
        let mut prepared = Prepared { velocity, foot: None, stance: None, ..impact.clone() };
        Self::refuse_uneven(&prepared)?;
        self.assembly.points = prepared.contacts.iter().map(Contact::point_of).collect();
        self.assembly.contact_jacobian(&prepared.velocity, None);
        self.assembly.workspace.contact_velocity.clone_from(&outcome.velocity_after);
        self.assembly.delassus();
        self.take_part(after, &mut prepared, &slips)?;
        let taking: Vec<Ordering> = slips.iter().copied().flatten().collect();
        let Unforced { still, .. } = self.pose(after, &mut prepared, &taking)?;
        let asked = self.asked_of_forces(taking.len(), Some(&[]));
        let of_impact = |modes: &Vec<Mode>| {
            let mut taking = modes.iter().copied();
            slips.iter().map(|slip| slip.and_then(|_| taking.next())).collect()
        };
        Ok(self.analyze_forces(after, &prepared, &still, asked).map(|analysis| Next {
            verdict: analysis.verdict,
            proven: analysis.proven && outcome.proven,
            modes: analysis.modes().iter().map(of_impact).collect(),
        }))
    }

    /// Puts the problem of accelerations in place of that of velocities, which it gives back.
    fn pose(&mut self, state: &State, prepared: &mut Prepared, slips: &[Ordering]) -> Result<Unforced> {
        let still = self.still(state, prepared, slips)?;
        let loads = Loads::of(&state.scene, &still);
        let (unclosed, drifts) = self.assembly.acceleration(&prepared.velocity, loads);
        let mut free = unclosed.clone();
        self.assembly.answer_to(Closed::Acceleration(&drifts), &mut free);
        for &entry in &free {
            finite(entry, || "an acceleration".into())?;
        }
        let own = self.assembly.contact_accelerations(&free, loads);
        let laws = prepared.problem.laws().iter().zip(slips).map(|(law, slip)| match slip {
            Ordering::Equal => *law,
            slip => Law::Sliding(law.friction(), Mode::closed(*slip)),
        });
        let (laws, delassus) = (laws.collect(), self.assembly.workspace.delassus.clone());
        let posed = ContactProblem::checked(delassus, own.clone(), own, laws, vec![0.0; slips.len()])?;
        let struck = std::mem::replace(&mut prepared.problem, posed);
        Ok(Unforced { still, unclosed, free, drifts, struck })
    }

    /// What is computed of forces at so many contacts.
    fn asked_of_forces<'a>(&self, contacts: usize, chosen: Option<&'a [Vec<Mode>]>) -> AnalysisOptions<'a> {
        let explain = contacts > 0 && contacts <= self.options.explain_up_to;
        AnalysisOptions {
            rejections: chosen.map_or(explain.into(), ListedRejections::Only),
            prove: !self.options.no_proof,
            brief: self.options.brief,
            reductions: self.options.reductions,
        }
    }

    /// Every set of forces of a problem that is posed; `None` of more contacts than are enumerated.
    fn analyze_forces(
        &mut self,
        state: &State,
        prepared: &Prepared,
        still: &[bool],
        asked: AnalysisOptions<'_>,
    ) -> Option<Analysis> {
        let exact = prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN);
        let source = ExactState { asked: Asked::Forces(Loads::of(&state.scene, still)), ..exact };
        self.scratch.analyze(&prepared.problem, &source, asked).ok().map(Analysis::of_forces)
    }

    /// Leaves the contacts that have a slip and so take part, with what is known of them, and poses an impact there.
    fn take_part(&mut self, state: &State, prepared: &mut Prepared, slips: &[Option<Ordering>]) -> Result<()> {
        let Prepared { velocity, contacts, levels, stance, resting, merged, placement, .. } = &mut *prepared;
        let stays: Vec<usize> = (0..slips.len()).filter(|&at| slips[at].is_some()).collect();
        if stays.len() < slips.len() {
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
        prepared.problem = self.problem(&state.scene, &prepared.contacts, &prepared.change)?;
        Ok(())
    }

    /// Refuses circles of different radii that act as one contact.
    fn refuse_uneven(prepared: &Prepared) -> Result<()> {
        let Some(merged) = prepared.merged.iter().find(|merged| merged.is_uneven) else { return Ok(()) };
        let name = merged.outer.first().map_or("", |&at| &prepared.contacts[at].name);
        let reason = format!("circles of different radii touch the ground at one place, {name}, and roll differently");
        let hint = "name the one that carries in contacts, or switch off the reduction merge";
        Err(Error::new(Reason::Inconsistent(reason)).hint(hint))
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
            let rolls = || {
                !still
                    && contact.radius != 0.0
                    && self.assembly.velocity_of(&center, &prepared.velocity) != Vector::zero()
            };
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
