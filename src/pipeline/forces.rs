//! A state in sustained contact: every consistent set of contact forces and accelerations.
//!
//! ```text
//!     M a = h + J^T f + K^T l,   K a + kappa = 0      c' = J a + sigma = c'_free + G f      h = tau - b (gravity, v v)
//! ```
//!
//! This is the contact problem of an impact with the same G and law, but with forces for impulses and accelerations for
//! velocities. Its contacts neither approach nor leave the ground; those that already slide keep their direction
//! ([`Law::Sliding`]). Then no theorem guarantees exactly one outcome: Painleve's paradoxes have none or two. If there
//! is none, the velocities jump in an impact without approach.

use super::assembly::{Assembly, Loads};
use super::exact::{Asked, ExactState};
use super::response::FreeMotion;
use super::resting::Standing;
use super::springs::Driven;
use super::still::Still;
use super::{CONTACT_TOLERANCE, Impact, Pipeline, Prepared};
use crate::budget::within;
use crate::contact::{Contact, Surface};
use crate::dynamics::plan::JointMotion;
use crate::dynamics::{Closed, ContactPoint};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::{Analysis, AnalysisOptions, ContactProblem, Errors, ListedRejections, Next, Outcome, Verdict};
use crate::law::{Law, Mode};
use crate::planar::{Pair, Vector};
use crate::robot::{FootShape, Rim, Robot};
use crate::scalar::{Magnitude, Real, dot};
use crate::state::{Scene, SpringEnd, SpringLaw, State};
use std::cmp::Ordering;

/// The ratio of likely error to error bound of the accelerations, as a multiple of this ratio for G. Over 1,000 states
/// of fifteen robots (also chains of ten links with masses of 1e-4 to 1e4 kg) it was at most 1.1.
const LIKELY: f64 = 4.0;

/// The part of an [`Impact`] that describes sustained contact. Its impulses are then forces \[N\], and its velocities
/// after the impact are accelerations \[m/s^2, rad/s^2\]. The velocities of its problem are accelerations without
/// contact forces. Its contacts are those that take part, and `velocity_before` is their velocity.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Sustained {
    /// The sliding direction of each contact: the sign of its velocity along t.
    pub slips: Vec<Ordering>,
    /// With [`Verdict::None`], every outcome with an impulse of the impact without approach; `None` if it is undecided.
    pub shock: Option<Vec<Outcome>>,
    /// Gravity along -z of the world \[m/s^2\].
    pub gravity: f64,
    /// Torques at the joints, and virtual springs.
    pub driven: Driven,
    /// Error bounds of the problem's accelerations \[m/s^2\]; infinite if nothing is known.
    pub rounding: Vec<Pair<f64>>,
}

/// A state in sustained contact before contact forces are added.
struct Unforced {
    /// See [`Loads::steady`].
    steady: Vec<bool>,
    /// q, with the placed base.
    position: Vec<f64>,
    driven: Driven,
    /// Accelerations by coordinate, without the loops' response (`unclosed`) and with it \[m/s^2, rad/s^2\].
    unclosed: Vec<f64>,
    free: Vec<f64>,
    /// kappa of each loop.
    drifts: Vec<Vector>,
    /// Likely errors of the accelerations by coordinate \[m/s^2, rad/s^2\].
    likely: Vec<f64>,
    /// Bounds of the rounding in the contacts' accelerations \[m/s^2\].
    rounding: Vec<Pair<f64>>,
}

impl Unforced {
    fn loads<'a>(&'a self, robot: &'a Robot, scene: &'a Scene) -> Loads<'a> {
        Loads { robot, scene, position: &self.position, steady: &self.steady }
    }
}

/// Relative accuracy of velocities after an impact, as a fraction of those before it. Smaller rates count as zero.
const STOPPED: f64 = 1e-10;
/// A greater gravity gets a note, because it may be in cm/s^2 \[m/s^2\].
const STRONGEST: f64 = 100.0;

impl Pipeline<'_> {
    /// Computes every consistent set of contact forces and accelerations of one state.
    ///
    /// A closed contact takes part if its normal velocity is zero, up to rounding or
    /// [`Options::resting_speed`](super::Options::resting_speed). A contact that leaves the ground does not.
    ///
    /// # Errors
    /// Returns the errors of [`Pipeline::impact`], and `Inconsistent` for a contact that approaches the ground, for
    /// applied impulses and for a contact that rolls or slides over a corner of the ground.
    pub fn forces(&mut self, state: &State) -> Result<Box<Impact>> {
        within(self.options.budget, || self.sustained(state, None))
    }

    /// As [`Pipeline::forces`]. If modes are `chosen`, only the rejected combinations with these modes are listed.
    pub(super) fn sustained(&mut self, state: &State, chosen: Option<&[Vec<Mode>]>) -> Result<Box<Impact>> {
        let scene = &state.scene;
        let (mut prepared, slips) = self.prepare_sustained(state)?;
        if state.uncertainty.is_some() {
            let notes = &mut prepared.impact.notes;
            notes.push("the uncertainty is ignored: forces are those of the given numbers".to_owned());
        }
        let unforced = self.pose(state, &mut prepared, &slips, self.rounding_of_rates())?;
        let notes = &mut prepared.impact.notes;
        for &joint in scene.braked.iter().filter(|&&joint| unforced.driven.torque.values()[joint] != 0.0) {
            let name = &self.robot.joints[joint].name;
            notes.push(format!("{name} is held: its torque is carried by what holds it, and has no effect"));
        }
        let options = self.analysis_options(prepared.impact.contacts.len(), chosen);
        let mut analysis = self.analyze_forces(state, &prepared, &unforced, options);
        let Impact { notes, problem, .. } = &mut *prepared.impact;
        notes.extend(analysis.as_ref().and_then(|analysis| analysis.balance_note(problem, || self.robot.mass())));
        notes.extend(analysis.as_ref().and_then(Analysis::unlisted_note));
        let is_none = analysis.as_ref().is_some_and(|analysis| analysis.verdict == Verdict::None);
        let mut shock = if is_none { self.shock(state, &prepared, &slips, options) } else { None };

        let rest = vec![0.0; unforced.free.len()];
        let velocity = self.assembly.workspace.contact_velocity.as_flattened();
        for outcome in analysis.iter_mut().flat_map(|analysis| &mut analysis.outcomes) {
            outcome.energy_loss = 0.0 - dot(outcome.impulse.as_flattened(), velocity);
        }
        if let Some(analysis) = analysis.as_mut().filter(|_| !self.options.brief) {
            let Unforced { unclosed, free, drifts, likely: errors, .. } = &unforced;
            let closed = Closed::Acceleration(drifts);
            let unstruck = FreeMotion { before: &rest, applied: unclosed, free, errors, closed };
            let asked = Asked::Forces(unforced.loads(self.robot, scene));
            self.respond(&mut analysis.outcomes, (state, &prepared, asked), unstruck);
            analysis.proven &= analysis.outcomes.iter().all(|outcome| outcome.proven);
        }
        if let Some(shock) = &mut shock {
            let before = &prepared.velocity;
            let unstruck = FreeMotion { before, applied: &rest, free: before, errors: &[], closed: Closed::Change };
            self.respond(shock, (state, &prepared, Asked::Shock(&slips)), unstruck);
        }
        let left_out = if self.options.brief { Vec::new() } else { self.left_out(scene, &prepared) };
        let Unforced { driven, rounding, .. } = unforced;
        let sustained = Sustained { slips, shock, gravity: scene.gravity(), driven, rounding };
        let mut impact = self.unanswered(&mut prepared);
        self.spare = Some(prepared);
        impact.velocity_before.clone_from(&self.assembly.workspace.contact_velocity);
        impact.matrices = self.options.matrices.then(|| self.matrices());
        (impact.left_out, impact.analysis) = (left_out, analysis);
        impact.sustained = Some(sustained);
        Ok(impact)
    }

    /// Computes everything up to the contact problem of forces.
    pub(super) fn prepare_forces(&mut self, state: &State) -> Result<Box<Prepared>> {
        let (mut prepared, slips) = self.prepare_sustained(state)?;
        self.pose(state, &mut prepared, &slips, self.rounding_of_rates())?;
        Ok(prepared)
    }

    /// Computes everything up to the contacts that take part and their sliding directions.
    fn prepare_sustained(&mut self, state: &State) -> Result<(Box<Prepared>, Vec<Ordering>)> {
        if !state.scene.impulses.is_empty() {
            let reason = Reason::Inconsistent("an applied impulse acts in an impact, not in sustained contact".into());
            return Err(Error::new(reason).at("impulse").hint("leave it out, or ask `impact`"));
        }
        // Forces check the uncertainty but ignore it, so contacts rest as if there were none.
        let checked = |_| state.check(self.robot).map(|()| State { uncertainty: None, ..state.clone() });
        let given = state.uncertainty.as_ref().map(checked).transpose()?;
        let mut prepared = self.prepare(given.as_ref().unwrap_or(state))?;
        self.refuse_uneven(&prepared)?;
        let Prepared { velocity, foot, levels, still, impact, .. } = &mut *prepared;
        let Impact { contacts, stance, notes, velocity_before, .. } = &mut **impact;
        let body = |link: usize| self.robot.rigid_body(self.robot.links[link].body);
        for (at, spring) in state.scene.springs.iter().enumerate() {
            // No joint lies between the base and the world, so the base's rigid body counts as the world.
            let other = match spring.b {
                SpringEnd::Link(point) => body(point.link),
                SpringEnd::World(_) => 0,
            };
            if body(spring.a.link) == other {
                notes.push(format!("virtual[{at}] gives no torque, as no joint lies between its ends"));
            }
            let mut odd = |is_odd: fn(&SpringLaw) -> bool, what| {
                notes.extend(spring.laws.iter().any(is_odd).then(|| format!("virtual[{at}] has a negative {what}")));
            };
            odd(|law| law.stiffness < 0.0, "stiffness, which pushes away from the target");
            odd(|law| law.damping < 0.0, "damping, which speeds up what moves");
        }
        if self.assembly.is_constrained() || !still.rows.is_empty() {
            // After constraints or resting contacts, the bounds are infinite or belong to other velocities.
            self.bound_velocities(contacts, levels, velocity, Standing { foot: foot.as_ref(), place: *stance });
        }
        match state.scene.gravity() {
            g if g < 0.0 => notes.push("gravity is negative, so it acts upward: 9.81 is that of the earth".into()),
            g if g > STRONGEST => notes.push(format!("gravity is {g} m/s^2: 9.81 is that of the earth")),
            _ => {}
        }
        let slips = self.slips(state, velocity, contacts, foot.as_ref(), notes)?;
        let contacts = contacts.iter().zip(&*velocity_before).zip(&slips);
        notes.extend(contacts.filter(|(_, slip)| slip.is_none()).map(|((contact, [_, normal]), _)| {
            format!("{} leaves the ground at {normal:.1e} m/s, and takes no part", contact.name)
        }));
        self.take_part(state, &mut prepared, &slips)?;
        if let Some(speed) = self.options.resting_speed
            && prepared.impact.resting.contains(&true)
            && self.fastest(&prepared.velocity) <= speed
            && prepared.velocity.iter().any(|&rate| rate != 0.0)
        {
            // All rates are cleared: clearing only some of them would open loops and move the foot of a stance.
            prepared.velocity.fill(0.0);
            prepared.impact.notes.push(format!("all rates are taken as zero (resting speed {speed} m/s)"));
        }
        Ok((prepared, slips.into_iter().flatten().collect()))
    }

    /// Computes the forces just after each decided outcome of an impact. The velocities are those of the outcome as
    /// printed, and its modes select the contacts that take part. Returns notes on outcomes for which this fails.
    pub(super) fn follow(&mut self, state: &State, struck: &Prepared, analysis: &mut Analysis) -> Vec<String> {
        let scene = Scene { impulses: Vec::new(), ..state.scene.clone() };
        let after = State { scene, ..state.clone() };
        let mut notes = Vec::new();
        for (at, outcome) in analysis.outcomes.iter_mut().enumerate().filter(|(_, outcome)| outcome.decided) {
            match self.next(&after, struck, outcome) {
                Ok(next) => outcome.next = next,
                Err(error) => notes.push(format!("what follows outcome {} is not known: {}", at + 1, error.reason())),
            }
        }
        notes
    }

    /// Computes the forces just after an `outcome`; `None` if there are more contacts than are enumerated.
    fn next(&mut self, after: &State, struck: &Prepared, outcome: &Outcome) -> Result<Option<Next>> {
        let mut velocity: Vec<f64> = outcome.velocity().collect();
        let fastest = f64::max(self.fastest(&struck.velocity), self.fastest(&velocity));
        // A bounce within the rounding of the velocity before the impact does not count.
        let slip = |(contact, mode): (usize, &Mode)| match mode {
            Mode::Separate => None,
            _ if struck.impact.problem.bounce(contact).abs() > STOPPED * fastest => None,
            mode => mode.direction().partial_cmp(&0.0),
        };
        let slips: Vec<Option<Ordering>> = outcome.modes.iter().enumerate().map(slip).collect();
        // Resting bodies have rates of rounding size, whose squares would decide the modes of dependent contacts.
        self.stop(&mut velocity, STOPPED * fastest);
        // The foot of a stance may move after the impact.
        let mut prepared = Prepared { velocity, foot: None, still: Still::default(), ..struck.clone() };
        prepared.impact.stance = None;
        self.refuse_uneven(&prepared)?;
        let (contacts, levels) = (&prepared.impact.contacts, &prepared.levels);
        self.bound_velocities(contacts, levels, &prepared.velocity, Standing { foot: None, place: None });
        self.assembly.points = contacts.iter().map(Contact::point_of).collect();
        self.assembly.contact_jacobian(&prepared.velocity, None);
        self.assembly.workspace.contact_velocity.clone_from(&outcome.velocity_after);
        self.assembly.rounded_delassus();
        self.take_part(after, &mut prepared, &slips)?;
        let taking: Vec<Ordering> = slips.iter().copied().flatten().collect();
        let unforced = self.pose(after, &mut prepared, &taking, STOPPED)?;
        let options = self.analysis_options(taking.len(), Some(&[]));
        let of_impact = |modes: &Vec<Mode>| {
            let mut taking = modes.iter().copied();
            slips.iter().map(|slip| slip.and_then(|_| taking.next())).collect()
        };
        Ok(self.analyze_forces(after, &prepared, &unforced, options).map(|analysis| Next {
            verdict: analysis.verdict,
            proven: analysis.proven && outcome.proven,
            modes: analysis.modes().iter().map(of_impact).collect(),
        }))
    }

    /// The speed of each rate \[m/s\]; a rotation's at the robot's size ([`Feet::size`](crate::contact::Feet::size)).
    fn speeds<'a>(&'a self, velocity: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let rates = velocity.iter().zip(self.robot.units());
        rates.map(|(rate, (unit, _))| rate.abs() * if unit == "rad" { self.feet.size() } else { 1.0 })
    }

    fn fastest(&self, velocity: &[f64]) -> f64 {
        self.speeds(velocity).fold(0.0, f64::max)
    }

    /// Sets rates to zero that are no faster than `speed` \[m/s\].
    fn stop(&self, velocity: &mut [f64], speed: f64) {
        let stops: Vec<bool> = self.speeds(velocity).map(|entry| entry <= speed).collect();
        velocity.iter_mut().zip(stops).filter(|(_, stops)| *stops).for_each(|(rate, _)| *rate = 0.0);
    }

    /// Replaces the contact problem of velocities by that of accelerations. `rounding` is the relative rounding of a
    /// sum of joint rates.
    fn pose(&mut self, state: &State, prepared: &mut Prepared, slips: &[Ordering], rounding: f64) -> Result<Unforced> {
        let steady = self.steady(prepared, slips, rounding);
        self.refuse_turning_normals(state, prepared, slips, &steady)?;
        let mut position = state.position.clone();
        let base = position.iter_mut().take(self.robot.base_dofs());
        base.zip(prepared.impact.placement.base().components()).for_each(|(entry, placed)| *entry = placed);
        let loads = Loads { robot: self.robot, scene: &state.scene, position: &position, steady: &steady };
        let driven = self.driven(&prepared.velocity, loads)?;
        let (unclosed, drifts) = self.assembly.acceleration(&prepared.velocity, loads);
        let mut free = unclosed.clone();
        self.assembly.add_constraint_response(Closed::Acceleration(&drifts), &mut free);
        self.refuse_parting(&state.scene.loops, [&prepared.velocity, &unclosed, &free], &drifts, loads)?;
        for &entry in &free {
            finite(entry, || "an acceleration".into()).map_err(|error| {
                error.hint("gravity, torques or velocities are too large for the masses: are they in SI units?")
            })?;
        }
        let accelerations = self.assembly.contact_accelerations(&free);
        let (mut likely, rounding) = self.bound_accelerations(prepared, &free, loads);
        likely.iter_mut().for_each(|error| *error *= LIKELY * self.bounds.likely[0]);
        let laws = prepared.impact.problem.laws().iter().zip(slips).map(|(law, slip)| match slip {
            Ordering::Equal => *law,
            slip => Law::Sliding(law.friction(), Mode::closed(*slip)),
        });
        let (laws, delassus) = (laws.collect(), self.assembly.workspace.delassus.clone());
        prepared.impact.problem =
            ContactProblem::checked(delassus, accelerations.clone(), accelerations, laws, vec![0.0; slips.len()])?;
        Ok(Unforced { steady, position, driven, unclosed, free, drifts, likely, rounding })
    }

    /// Bounds the rounding of accelerations without contact forces: those given by coordinate, and the contacts'.
    fn bound_accelerations(
        &mut self,
        prepared: &Prepared,
        acceleration: &[f64],
        loads: Loads<'_>,
    ) -> (Vec<f64>, Vec<Pair<f64>>) {
        if self.assembly.is_constrained() {
            // The accelerations pass through the constraints' response, whose rounding no bound covers.
            return (vec![f64::INFINITY; acceleration.len()], vec![[f64::INFINITY; 2]; prepared.impact.contacts.len()]);
        }
        let Self { robot, assembly, stretched, bounds, .. } = self;
        bounds.stretched_poses(&stretched.plan, &mut stretched.workspace);
        stretched.points.clear();
        stretched.points.extend(bounds.stretched_points());
        let magnitudes = |list: &[f64]| list.iter().map(|&entry| Magnitude::from_f64(entry)).collect::<Vec<_>>();
        let mut velocity = magnitudes(&prepared.velocity);
        if let Some(foot) = &prepared.foot {
            // The velocity of the base makes this foot rest, so it inherits the rounding of the foot's velocity.
            let rests = Magnitude(2.0 * bounds.speed(&assembly.plan, foot.arm(robot), &prepared.velocity));
            velocity[..2].iter_mut().for_each(|entry| *entry = *entry + rests);
        }
        let terms = stretched.load(&velocity, loads).to_vec();
        let of_contacts = stretched.contact_accelerations(&magnitudes(acceleration));
        let Assembly { plan, workspace, .. } = assembly;
        bounds.accelerations(plan, acceleration, workspace, (&terms, loads.scene.springs.len()), &of_contacts)
    }

    /// Finds every set of forces of the posed problem; `None` if there are more contacts than are enumerated.
    fn analyze_forces(
        &mut self,
        state: &State,
        prepared: &Prepared,
        unforced: &Unforced,
        options: AnalysisOptions<'_>,
    ) -> Option<Analysis> {
        let [likely, _] = self.bounds.likely;
        let (delassus, velocity) = (self.bounds.delassus, Some(&*unforced.rounding));
        let errors = Errors { delassus, velocity, likely: [likely, LIKELY * likely] };
        let exact = prepared.exact(self.robot, state, &self.assembly, errors);
        let source = ExactState { asked: Asked::Forces(unforced.loads(self.robot, &state.scene)), ..exact };
        self.scratch.analyze(&prepared.impact.problem, &source, options).ok().map(Analysis::of_forces)
    }

    /// Keeps only the contacts that take part (they have a slip), with their data, and poses their impact problem.
    fn take_part(&mut self, state: &State, prepared: &mut Prepared, slips: &[Option<Ordering>]) -> Result<()> {
        let Prepared { velocity, foot, levels, merged, still, change, impact, .. } = prepared;
        let Impact { contacts, stance, resting, problem, .. } = &mut **impact;
        let stays: Vec<usize> = (0..slips.len()).filter(|&at| slips[at].is_some()).collect();
        if stays.len() < slips.len() {
            let place = |at: usize| stays.iter().position(|&stay| stay == at);
            let known = stays.iter().map(|&at| self.assembly.workspace.contact_velocity[at]).collect();
            *contacts = stays.iter().map(|&at| contacts[at].clone()).collect();
            *stance = stance.and_then(place);
            *resting = stays.iter().map(|&at| resting[at]).collect();
            still.keep(place);
            merged.retain_mut(|merged| {
                merged.outer = merged.outer.iter().filter_map(|&at| place(at)).collect();
                !merged.outer.is_empty()
            });
            *levels = self.levels(state, contacts, velocity, *stance);
            self.assembly.points = contacts.iter().map(Contact::point_of).collect();
            self.bound_velocities(contacts, levels, velocity, Standing { foot: foot.as_ref(), place: *stance });
            self.assembly.contact_jacobian(velocity, *stance);
            self.assembly.workspace.contact_velocity = known;
            self.assembly.rounded_delassus();
            self.problem(&state.scene, contacts, change, problem)?;
        }
        Ok(())
    }

    /// Refuses merged circles of different radii on a body that turns.
    fn refuse_uneven(&self, prepared: &Prepared) -> Result<()> {
        let uneven = prepared.merged.iter().filter(|merged| merged.is_uneven).flat_map(|merged| &merged.outer);
        let mut uneven = uneven.map(|&at| &prepared.impact.contacts[at]);
        let turning = uneven.find(|contact| self.turns(contact.body, &prepared.velocity, self.rounding_of_rates()));
        let Some(Contact { name, .. }) = turning else { return Ok(()) };
        let reason = format!("circles of different radii touch the ground at one place, {name}, and roll differently");
        let hint = "name the one that bears the load in `contacts`, or switch off the reduction merge";
        Err(Error::new(Reason::Inconsistent(reason)).hint(hint))
    }

    /// Relative rounding of the sum of a body's given rates: one unit for each body.
    fn rounding_of_rates(&self) -> f64 {
        self.assembly.plan.bodies.len() as f64 * f64::EPSILON
    }

    /// Returns whether a body turns faster than the `rounding` of its rate.
    fn turns(&self, body: usize, velocity: &[f64], rounding: f64) -> bool {
        let Assembly { plan, .. } = &self.assembly;
        let rates = plan.way_to_root(body).map(|(_, body)| match body.motion {
            JointMotion::Root if plan.floating => velocity[2],
            JointMotion::Revolute { rate, .. } => rate * velocity[body.coordinate],
            _ => 0.0,
        });
        let (sum, size) = rates.fold((0.0, 0.0), |(sum, size), rate| (sum + rate, size + rate.abs()));
        sum.abs() > rounding * size
    }

    /// Finds the bodies that do not turn. Either the body's rates add up to no more than their `rounding`, or two
    /// contacts of its rigid part hold it: both stand, or both are on the same straight ground.
    fn steady(&self, prepared: &Prepared, slips: &[Ordering], rounding: f64) -> Vec<bool> {
        let (contacts, velocity) = (&prepared.impact.contacts, &prepared.velocity);
        let parts = self.rigid_parts(velocity);
        let holds = |&(at, a): &(usize, &Contact)| {
            let stops = |(other, b): (usize, &Contact)| {
                let apart = b.point - a.point;
                // Contacts at one place, up to rounding, do not keep a body from turning.
                let least = CONTACT_TOLERANCE * (a.arm(self.robot).length + b.arm(self.robot).length);
                let is_apart = |distance: f64| {
                    distance > least || (distance > 0.0 && !self.turns(a.body, velocity, self.rounding_of_rates()))
                };
                let on_line = b.ground == a.ground && is_apart(a.tangent().dot(apart).abs());
                let stand = slips[at].is_eq() && slips[other].is_eq() && is_apart(apart.length());
                parts.are_one(a.body, b.body) && (on_line || stand)
            };
            contacts.iter().enumerate().any(stops)
        };
        // For each body, the first body that has the same rate of rotation.
        let mut first: Vec<usize> = Vec::new();
        for (index, body) in self.assembly.plan.bodies.iter().enumerate() {
            let turns = matches!(body.motion, JointMotion::Revolute { .. }) && velocity[body.coordinate] != 0.0;
            first.push(body.parent.filter(|_| !turns).map_or(index, |parent| first[parent]));
        }
        let held: Vec<_> = contacts.iter().enumerate().filter(holds).map(|(_, contact)| first[contact.body]).collect();
        let is_steady = |&first: &usize| held.contains(&first) || !self.turns(first, velocity, rounding);
        first.iter().map(is_steady).collect()
    }

    /// Refuses contacts that move over a corner of the ground, where the normal changes direction.
    fn refuse_turning_normals(
        &self,
        state: &State,
        prepared: &Prepared,
        slips: &[Ordering],
        steady: &[bool],
    ) -> Result<()> {
        let surface = Surface::new(&state.scene.ground);
        for (contact, slip) in prepared.impact.contacts.iter().zip(slips) {
            let center = ContactPoint { radius: 0.0, ..contact.point_of() };
            let rolls = || {
                !steady[contact.body]
                    && contact.radius != 0.0
                    && self.assembly.velocity_of(&center, &prepared.velocity) != Vector::zero()
            };
            // A side that lies flat on a segment has its normal at a ground corner, too, but that turns with the side.
            let turns = slip.is_ne() && !steady[contact.body] && self.is_on_side(contact);
            if turns || surface.is_corner(contact) && (slip.is_ne() || rolls()) {
                let reason =
                    format!("{} moves over a corner of the ground, where the normal turns with it", contact.name);
                let hint = "ask before or after the corner, or replace the corner by a short segment";
                return Err(Error::new(Reason::Inconsistent(reason)).at("ground.profile").hint(hint));
            }
        }
        Ok(())
    }

    /// Returns whether a detected contact is on a side of a foot, between its corners.
    fn is_on_side(&self, contact: &Contact) -> bool {
        let mut shapes = self.feet.iter().filter(|foot| foot.link == contact.link).map(|foot| &foot.outline);
        let is_elsewhere =
            |shape: &FootShape| matches!(shape.rim, Rim::Circle { .. }) && !shape.corners().contains(&contact.center);
        contact.offset.is_none() && shapes.all(is_elsewhere)
    }

    /// Finds every outcome with an impulse at contacts that neither approach nor leave; `None` if it is undecided.
    fn shock(
        &mut self,
        state: &State,
        prepared: &Prepared,
        slips: &[Ordering],
        options: AnalysisOptions<'_>,
    ) -> Option<Vec<Outcome>> {
        let mut struck = ContactProblem::default();
        self.problem(&state.scene, &prepared.impact.contacts, &prepared.change, &mut struck).ok()?;
        let exact = prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN);
        let (laws, restitution) = (struck.laws(), struck.restitution());
        let source = ExactState { asked: Asked::Shock(slips), laws, restitution, ..exact };
        let options = AnalysisOptions { rejections: ListedRejections::Nothing, ..options };
        let analysis = self.scratch.analyze(&struck, &source, options).ok().filter(|found| found.open.is_none())?;
        let pushes = |outcome: &Outcome| outcome.impulse.as_flattened().iter().any(|&entry| entry != 0.0);
        Some(analysis.outcomes.into_iter().filter(pushes).collect())
    }
}
