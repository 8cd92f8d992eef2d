//! From a state to its contact problem in f64: the work between the steps of the [`Assembly`].
//!
//! ```text
//!     State --plan, place, factorize--> stance, loops: v --contact--> points --> J, c, G --> bounds of their rounding
//!                                                              applied impulses --> c_free     --> ContactProblem
//! ```

use super::assembly::{Assembly, Elimination};
use super::exact::ExactState;
use super::resting::Standing;
use super::still::Still;
use super::{CONTACT_TOLERANCE, Impact, Pipeline};
use crate::contact::{Contact, Footing, Level, Merged, Placement, RigidParts, Surface, level};
use crate::dynamics::plan::Plan;
use crate::dynamics::{
    Arm, Closed, Constraints, RoundingBounds, Workspace, has_balance, kinetic_energy, mass_diagonal,
};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::{ContactProblem, Errors, check_matrix_size};
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::scalar::Residue;
use crate::state::{NamedLoop, Scene, State, Uncertainty, coordinate_place};
use std::mem::take;

/// A foot that does not touch.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct NearestFoot {
    /// The URDF link of the foot (an index into [`Robot::links`]).
    pub link: usize,
    /// Height of its lowest point above the ground along the normal \[m\].
    pub height: f64,
    /// Velocity of its lowest point before the impact, [tangential, normal] \[m/s\].
    pub velocity: Pair<f64>,
}

/// A state that is ready to be analyzed.
#[derive(Debug, Clone, Default)]
pub struct Prepared {
    /// v just before the impact, made consistent with the stance and the loops \[m/s, rad/s\].
    pub velocity: Vec<f64>,
    /// The foot of the stance.
    pub foot: Option<Contact>,
    /// Contacts that were merged into others.
    pub merged: Vec<Merged>,
    /// The number of shapes that were too far from the ground to be checked.
    pub out_of_reach: usize,
    /// For each contact, the other contact with which it is taken to be exactly level, if any.
    pub levels: Vec<Option<Level>>,
    pub still: Still,
    /// The change of v by the applied impulses: without the response of the loops (`applied`) and with it (`change`).
    pub applied: Vec<f64>,
    pub change: Vec<f64>,
    /// v plus `change`.
    pub free: Vec<f64>,
    /// The part of the answer that is known so far.
    pub impact: Box<Impact>,
}

/// An inertia that is less than this fraction of the whole may be rounding alone.
const DOUBTFUL_INERTIA: f64 = 1e-10;

impl Prepared {
    /// The contact problem's exact data, for numbers of any kind; the `state` was prepared in this `assembly`.
    pub fn exact<'a>(
        &'a self,
        robot: &'a Robot,
        state: &'a State,
        assembly: &'a Assembly,
        errors: Errors<'a>,
    ) -> ExactState<'a> {
        let constraints = Constraints { kept: &assembly.kept, rows: &assembly.rows };
        ExactState {
            velocity: &self.velocity,
            levels: &self.levels,
            is_rank_certain: assembly.is_rank_certain,
            errors,
            ..ExactState::of(robot, state, (&self.impact, self.foot.as_ref()), &self.still, constraints)
        }
    }
}

impl Pipeline<'_> {
    /// The exact data of the `state` that was just `prepared`, for numbers of any kind.
    #[cfg(feature = "accuracy")]
    pub(crate) fn exact<'a>(&'a self, state: &'a State, prepared: &'a Prepared) -> ExactState<'a> {
        prepared.exact(self.robot, state, &self.assembly, Errors::UNKNOWN)
    }

    /// Computes everything up to the contact problem.
    pub(crate) fn prepare(&mut self, state: &State) -> Result<Box<Prepared>> {
        let scene = &state.scene;
        if let Some(error) = &self.refused {
            return Err(error.clone());
        }
        if !self.is_checked {
            state.check(self.robot)?;
        }
        self.compile(scene);
        self.assembly.configuration.set(&self.assembly.plan, &state.position);
        self.assembly.place();
        self.assembly.factorize();
        self.check_inertia(&scene.loops, &state.position)?;

        self.check_limits(state)?;
        let surface = Surface::new(&scene.ground);
        let mut prepared = self.spare.take().unwrap_or_default();
        // No field is skipped by `..`: a new field does not compile until it is reset here.
        let Prepared { velocity, foot, merged, out_of_reach, levels, still, applied, change, free, impact } =
            &mut *prepared;
        let Impact {
            placement,
            contacts,
            nearest,
            velocity_before,
            kinetic_energy,
            problem,
            resting,
            stance,
            analysis,
            friction_needed,
            slides_regardless,
            sustained,
            holds,
            matrices,
            left_out,
            notes,
        } = &mut **impact;
        (*analysis, *friction_needed, *slides_regardless) = (None, None, false);
        (*sustained, *holds, *matrices) = (None, None, None);
        left_out.clear();
        notes.clear();
        notes.append(&mut state.oddities(self.robot));
        self.note_unused_laws(state, notes);
        state.velocity.clone_into(velocity);
        (*placement, *foot) = self.stand(state, &surface, velocity, take(placement))?;
        let opened = if scene.loops.is_empty() { Vec::new() } else { velocity.clone() };
        let is_rounding = self.close_loops(&scene.loops, &state.position, foot.as_ref(), velocity, notes)?;
        let footing = self.footing(scene, placement, &surface);
        (*contacts, *merged, *out_of_reach) = self
            .contacts(&footing, foot.as_ref(), take(contacts), notes)
            .map_err(|error| self.sunk(error, state, self.open_foot(&footing, &[], velocity)))?;
        check_matrix_size(contacts.len())?;
        *nearest = if self.options.brief { None } else { self.open_foot(&footing, contacts, velocity) };
        if !self.options.brief {
            // No other foot can be near if the nearest one is not.
            let is_near = nearest.is_some_and(|foot| foot.height <= self.near_miss());
            let near = if is_near { footing.near(contacts, self.near_miss()) } else { Vec::new() };
            let near: Vec<NearestFoot> = near.iter().filter_map(|foot| self.moving(foot, velocity)).collect();
            self.note_contacts(scene, (contacts, *nearest, &near), (placement, &footing), notes);
            notes.extend(state.uncertainty.as_ref().and_then(Uncertainty::without_width));
        }
        *stance = foot.as_ref().and_then(|foot| place_of(foot, contacts));
        self.assembly.points.clear();
        self.assembly.points.extend(contacts.iter().map(Contact::point_of));
        self.assembly.contact_jacobian(velocity, *stance);
        let standing = Standing { foot: foot.as_ref(), place: *stance };
        *levels = self.levels(state, contacts, velocity, *stance);
        self.bound_velocities(contacts, levels, velocity, standing);
        if is_rounding {
            self.widen(
                contacts,
                *stance,
                opened.iter().zip(&*velocity).map(|(given, closed)| closed - given).collect(),
            );
        }
        self.find_resting(state, velocity, contacts, standing, (resting, notes));
        self.assembly.rounded_delassus();
        *kinetic_energy = self.energy_in_range(&state.velocity, velocity)?;
        self.bound_delassus();
        self.settle(contacts, (velocity, *stance), still, (resting, notes));
        if !scene.impulses.is_empty() || (self.assembly.is_constrained() && !self.options.no_proof) {
            // Both pass through M^-1, whose rounding the bounds do not cover.
            self.bounds.delassus = f64::INFINITY;
            self.bounds.velocity.fill([f64::INFINITY; 2]);
        }

        applied.clear();
        applied.resize(self.robot.dofs(), 0.0);
        self.assembly.apply(self.robot, scene, applied);
        change.clone_from(applied);
        self.assembly.add_constraint_response(Closed::Change, change);
        free.clear();
        free.extend(velocity.iter().zip(&*change).map(|(before, change)| before + change));
        self.problem(scene, contacts, change, problem)?;
        problem.velocity_before().clone_into(velocity_before);
        Ok(prepared)
    }

    /// Refuses a joint outside its limits, if the options are strict.
    fn check_limits(&self, state: &State) -> Result<()> {
        let outside = state.outside_limits(self.robot).next().filter(|_| self.options.strict_limits);
        outside.map_or(Ok(()), |outside| {
            Err(Error::new(Reason::Inconsistent(outside.to_string()))
                .at(format!("position.joints.{}", outside.joint.name))
                .hint("correct the state or the limits of the robot's file, or do without `strict_limits`"))
        })
    }

    /// Compiles the plan, unless the last one was for the same braked joints and rotor inertias.
    pub(super) fn compile(&mut self, scene: &Scene) {
        // Compares entry by entry: comparing the memory of empty lists takes 200 cycles (docs/speed.md).
        if self.braked.iter().ne(&scene.braked) || self.rotor_inertia != scene.rotor_inertia {
            let (without, kept) = match self.options.reductions.held {
                true => (&scene.braked[..], &[][..]),
                false => (&[][..], &scene.braked[..]),
            };
            self.assembly.plan = Plan::new(self.robot, without, &scene.rotor_inertia);
            self.stretched.plan = Plan::new(self.robot, without, &scene.rotor_inertia);
            self.bounds = RoundingBounds::default();
            self.assembly.kept.clear();
            self.assembly.kept.extend(kept.iter().map(|joint| self.robot.base_dofs() + joint));
            self.braked.clone_from(&scene.braked);
            self.rotor_inertia.clone_from(&scene.rotor_inertia);
        }
        let Assembly { plan, kept, elimination, .. } = &mut self.assembly;
        let by_bodies = plan.is_long && kept.is_empty() && scene.loops.is_empty() && has_balance(plan);
        *elimination = if by_bodies { Elimination::ArticulatedBodies } else { Elimination::Ltl };
    }

    /// Refuses a coordinate whose inertia is zero, exactly or up to rounding, when all joints beyond it may move.
    pub(super) fn check_inertia(&mut self, loops: &[NamedLoop], position: &[f64]) -> Result<()> {
        let nv = self.assembly.plan.columns();
        let by_bodies = self.assembly.elimination == Elimination::ArticulatedBodies;
        if by_bodies {
            mass_diagonal(&self.assembly.plan, &mut self.assembly.workspace);
        }
        for column in (0..nv).rev() {
            let Workspace { mass_matrix, factor, diagonal, pivots, .. } = &self.assembly.workspace;
            let (whole, rest) = match by_bodies {
                true => (diagonal[column], pivots[column]),
                false => (mass_matrix[column * nv + column], factor.pivot(column)),
            };
            // Each of up to nv eliminations loses at most a few units in the last place of the whole.
            finite(whole, || "the mass matrix".into())?;
            let is_exactly_zero =
                || !by_bodies && rest < DOUBTFUL_INERTIA * whole && self.is_massless(column, position);
            if rest.is_nan() || rest <= 4.0 * nv as f64 * f64::EPSILON * whole || is_exactly_zero() {
                let coordinate = self.assembly.plan.coordinates[column];
                let name = self.robot.coordinates().nth(coordinate).unwrap_or_default().to_owned();
                let is_joint = coordinate >= self.robot.base_dofs();
                let what = if is_joint { format!("joint \"{name}\"") } else { format!("the base along {name}") };
                let remedy = match (is_joint, !loops.is_empty()) {
                    (true, false) => "name the joint in `held`, or give it a `rotor_inertia`",
                    (true, true) => {
                        "it needs inertia of its own, whatever the loops hold: give its links a mass or it a \
                         `rotor_inertia`, however small, or name it in `held`"
                    }
                    (false, _) if self.robot.joints.is_empty() => "give its links a mass and moments of inertia",
                    (false, _) => {
                        "in this pose the joints can follow it without moving any mass: bend or hold (`held`) one of \
                         them, or give it a `rotor_inertia`"
                    }
                };
                let without =
                    coordinate.checked_sub(self.robot.base_dofs()).and_then(|joint| self.without_inertial(joint));
                let hint = without.map_or(remedy.to_owned(), |link| format!("{link} has no <inertial>: {remedy}"));
                return Err(Error::new(Reason::Singular(what)).hint(hint));
            }
        }
        Ok(())
    }

    /// Whether the inertia of a column is exactly zero when all joints beyond it may move.
    fn is_massless(&self, column: usize, position: &[f64]) -> bool {
        let without = if self.options.reductions.held { &self.braked[..] } else { &[] };
        let mut exact = Assembly::<Residue>::new(Plan::new(self.robot, without, &self.rotor_inertia));
        exact.configuration.set(&exact.plan, position);
        exact.place();
        exact.factorize();
        exact.workspace.factor.pivot(column).is_zero() == Some(true)
    }

    /// Finds the first link that `joint` moves and to which the file gives no `<inertial>`.
    fn without_inertial(&self, joint: usize) -> Option<String> {
        let child = self.robot.joints.get(joint)?.child;
        let link = self.robot.links.iter().find(|link| link.body == child && !link.has_inertial)?;
        let line = link.line.map_or(String::new(), |line| format!(" on line {line} of the robot's file"));
        Some(format!("link \"{}\"{line}", link.name))
    }

    /// Returns the kinetic energy \[J\]. The energy and the Delassus matrix must be finite, or no sign means anything.
    /// The error names the greatest of the `given` velocities.
    fn energy_in_range(&mut self, given: &[f64], velocity: &[f64]) -> Result<f64> {
        let too_large =
            |error: Error| error.hint("positions and velocities are too large for f64: are they in SI units?");
        for &entry in &self.assembly.workspace.delassus {
            finite(entry, || "an entry of the Delassus matrix".into()).map_err(too_large)?;
        }
        let Assembly { plan, workspace, motions, .. } = &mut self.assembly;
        let energy = kinetic_energy(plan, velocity, workspace, motions);
        finite(energy, || "the kinetic energy".into()).map_err(|error| {
            let greatest = (0..given.len()).max_by(|&a, &b| given[a].abs().total_cmp(&given[b].abs()));
            let place = greatest.map(|at| coordinate_place(self.robot, "velocity", at));
            place.into_iter().fold(too_large(error), Error::at)
        })
    }

    /// Returns the greatest height above the ground at which a foot still touches \[m\].
    pub fn tolerance(&self) -> f64 {
        self.options.contact_tolerance.unwrap_or(CONTACT_TOLERANCE * self.feet.size())
    }

    /// Returns the placement of the bodies, in reused `memory`, and the foot of a stance. Changes the `velocity` by
    /// coordinate so that this foot is at rest.
    fn stand(
        &self,
        state: &State,
        surface: &Surface,
        velocity: &mut [f64],
        memory: Placement,
    ) -> Result<(Placement, Option<Contact>)> {
        let at = |base, memory: Placement| memory.moved(&self.assembly.plan, &self.assembly.workspace, base);
        if !self.assembly.plan.floating {
            return Ok((at(Vector::zero(), memory), None));
        }
        let Some(link) = state.scene.stance else {
            let base = Vector::new(state.position[0], state.position[1]);
            let placement = at(base, memory);
            if !state.scene.place_lowest {
                return Ok((placement, None));
            }
            let rise = self.footing(&state.scene, &placement, surface).rise()?;
            return Ok((at(base + Vector::new(0.0, rise), placement), None));
        };
        let placement = at(Vector::zero(), memory);
        let footing = self.footing(&state.scene, &placement, surface);
        // Within a given tolerance a recorded foot may be tilted; it then stands on its lower end.
        let flat = self.options.contact_tolerance.map_or(f64::INFINITY, |_| CONTACT_TOLERANCE * self.feet.size());
        let stance = footing.stance(link, self.tolerance(), flat)?;
        self.assembly.rest(&stance.foot.point_of(), velocity);
        Ok((at(stance.base, placement), Some(stance.foot)))
    }

    fn footing<'a>(&'a self, scene: &'a Scene, placement: &'a Placement, surface: &'a Surface) -> Footing<'a> {
        Footing { robot: self.robot, feet: &self.feet, scene, placement, surface }
    }

    /// Returns the closed contacts, those merged into others, and the number of shapes out of reach; reuses `memory`.
    fn contacts(
        &self,
        footing: &Footing,
        standing: Option<&Contact>,
        memory: Vec<Contact>,
        notes: &mut Vec<String>,
    ) -> Result<(Vec<Contact>, Vec<Merged>, usize)> {
        let tolerance = self.tolerance();
        let (contacts, merged) = footing.contacts(tolerance, self.options.reductions.merge, standing, memory)?;
        let is_named = footing.scene.contacts.is_some();
        for contact in &contacts {
            finite(contact.gap, || format!("the height of {}", contact.name))?;
        }
        let mut out_of_reach = 0;
        if !is_named {
            out_of_reach = if self.options.brief { 0 } else { footing.out_of_reach(tolerance) };
            notes.extend(footing.left_behind(tolerance).into_iter().map(|(link, end)| {
                format!("{link} reaches beyond the end of the ground's profile at x = {end:?} m: there is no ground")
            }));
        }
        Ok((contacts, merged, out_of_reach))
    }

    /// Returns the lowest foot that does not touch, with its velocity.
    fn open_foot(&self, footing: &Footing, contacts: &[Contact], velocity: &[f64]) -> Option<NearestFoot> {
        footing.nearest(contacts).and_then(|foot| self.moving(&foot, velocity))
    }

    /// Returns a foot that does not touch, with its velocity; `None` if a number is not finite.
    fn moving(&self, foot: &Contact, velocity: &[f64]) -> Option<NearestFoot> {
        let point = foot.point_of();
        let (moving, [tangent, normal]) = (self.assembly.velocity_of(&point, velocity), point.axes());
        let velocity = [tangent.dot(moving), normal.dot(moving)];
        let is_finite = [foot.gap, velocity[0], velocity[1]].into_iter().all(f64::is_finite);
        is_finite.then_some(NearestFoot { link: foot.link, height: foot.gap, velocity })
    }

    /// Completes the error for a foot that is too deep in the ground: with the velocity of the `lowest` foot, with a
    /// remedy that suits a stance, and with the first oddity of the state, which may be the cause.
    fn sunk(&self, error: Error, state: &State, lowest: Option<NearestFoot>) -> Error {
        let Reason::Penetration { link, depth, tolerance, .. } = error.reason() else { return error };
        let velocity = lowest.filter(|foot| self.robot.links[foot.link].name == *link).map(|foot| foot.velocity);
        let hint = match (state.scene.stance, error.remedy()) {
            _ if !self.assembly.plan.floating => {
                "the robot is bolted to the world: correct its joints, lower the ground by a profile, or give `base: floating`"
                    .to_owned()
            }
            (Some(stance), _) if self.robot.links[stance].name == *link => {
                "the standing foot is in the ground next to x = 0: correct the pitch or the joints, shift the profile \
                 along x, or give `place: lowest` instead of the stance"
                    .to_owned()
            }
            (Some(_), _) | (_, None) => format!(
                "a stance leaves the other feet where the pose puts them: correct the pitch or the joints, stand on \
                 {link}, or give `place: lowest` instead of the stance"
            ),
            (None, Some(remedy)) => format!("{remedy}; `place: lowest` puts the lowest foot on the ground"),
        };
        let odd = state.oddities_of_motion(self.robot).into_iter().take(1);
        let hint = odd.fold(hint, |hint, odd| format!("{hint}; {odd}"));
        Error::new(Reason::Penetration { link: link.clone(), depth: *depth, tolerance: *tolerance, velocity })
            .hint(hint)
    }

    /// Finds the contacts that are level with others: up to rounding or, if they are named, exactly.
    pub(super) fn levels(
        &self,
        state: &State,
        contacts: &[Contact],
        velocity: &[f64],
        stance: Option<usize>,
    ) -> Vec<Option<Level>> {
        let is_named = state.scene.contacts.is_some();
        let mut levels = level(contacts, self.rigid_parts(velocity), stance, is_named);
        if is_named {
            for (index, level) in levels.iter_mut().enumerate() {
                let is_level = |level: &Level| self.is_exactly_level(state, &contacts[index], &contacts[level.with]);
                *level = level.filter(is_level).map(|level| Level { along: None, ..level });
            }
        }
        levels
    }

    /// The bodies that move as one at this `velocity`, in the assembly's pose.
    pub(super) fn rigid_parts<'a>(&'a self, velocity: &'a [f64]) -> RigidParts<'a> {
        let Assembly { plan, workspace, kept, .. } = &self.assembly;
        RigidParts { plan, workspace, kept, velocity }
    }

    /// Returns whether two points of one body have exactly the same height above the ground for the pose as given.
    fn is_exactly_level(&self, state: &State, a: &Contact, b: &Contact) -> bool {
        let ground = |contact: &Contact| state.scene.ground.axes(contact.ground);
        let [a, b] = [a, b].map(|contact| contact.exact_point::<Residue>(self.robot, ground(contact)));
        let turn = self.assembly.plan.rotation::<Residue>(a.body, &state.position);
        let [_, normal] = a.axes();
        // The normal of a profile is a unit vector only up to rounding.
        let [a, b] = [a, b].map(|point| turn.apply(point.center) - normal * point.radius);
        normal.dot(a - b).is_zero() == Some(true)
    }

    /// Bounds the rounding of c. The foot of the stance is at rest.
    pub(super) fn bound_velocities(
        &mut self,
        contacts: &[Contact],
        levels: &[Option<Level>],
        velocity: &[f64],
        standing: Standing,
    ) {
        let Self { robot, assembly: Assembly { plan, configuration, .. }, bounds, .. } = self;
        let arms = contacts.iter().enumerate().map(|(index, contact)| {
            // The position of a level contact is computed from that of the other one.
            let other = levels.get(index).copied().flatten().filter(|level| level.along.is_some());
            let other = other.map(|level| contacts[level.with].arm(robot).length + level.way);
            let arm = contact.arm(robot);
            Arm { length: arm.length + other.unwrap_or(0.0), ..arm }
        });
        bounds.stretch(plan, configuration, arms);
        let foot = standing.foot.map(|foot| foot.arm(robot));
        bounds.velocities(plan, velocity, foot, |contact| standing.place == Some(contact));
    }

    /// Adds the contact speeds of a `change` of velocity to the error bounds of c. The change closed the loops.
    fn widen(&mut self, contacts: &[Contact], stance: Option<usize>, change: Vec<f64>) {
        let moving = contacts.iter().enumerate().filter(|(index, _)| stance != Some(*index));
        for (index, contact) in moving.filter(|_| !change.is_empty()) {
            let speed = self.bounds.speed(&self.assembly.plan, contact.arm(self.robot), &change);
            self.bounds.velocity[index].iter_mut().for_each(|bound| *bound += speed);
        }
    }

    /// Bounds the rounding of G; without proofs it is estimated from measurements.
    pub(super) fn bound_delassus(&mut self) {
        if self.options.no_proof {
            self.bounds.delassus = DYNAMICS_ROUNDING;
            return;
        }
        let Assembly { plan, points, workspace, elimination, .. } = &self.assembly;
        match elimination {
            Elimination::Ltl => self.bounds.delassus(plan, workspace),
            Elimination::ArticulatedBodies => self.bounds.articulated_delassus(plan, points, workspace),
        }
    }

    /// Fills in the contact problem, in the memory of another one.
    pub(super) fn problem(
        &self,
        scene: &Scene,
        contacts: &[Contact],
        change: &[f64],
        problem: &mut ContactProblem,
    ) -> Result<()> {
        let laws = contacts.iter().map(|contact| {
            let restitution = scene.restitution.of(contact.link).unwrap_or(0.0);
            scene.friction.of(contact.link).map(|friction| (friction, restitution)).ok_or_else(|| {
                let name = &self.robot.links[contact.link].name;
                let reason = format!("the friction of link \"{name}\", which touches the ground,");
                let error = Error::new(Reason::Missing(reason)).at("friction");
                match scene.friction.links.keys().next() {
                    Some(&other) => error.hint(format!(
                        "the state gives that of {}; add \"{name}\" or \"default\" to it",
                        self.robot.links[other].name
                    )),
                    None => error.hint(
                        "add \"friction\": 0.8 (or \"infinite\") to the state, or set `friction: 0.8` for all states",
                    ),
                }
            })
        });
        let Workspace { contact_velocity: before, delassus, .. } = &self.assembly.workspace;
        let pushed = (!scene.impulses.is_empty()).then(|| self.assembly.free(before, change));
        problem.renew(delassus, before, pushed.as_ref().unwrap_or(before), laws)
    }
}

/// Rounding of G, relative to the scale of its rows: measured below 3e-15 against 640 bits on chains, straight legs and
/// extreme mass ratios. It is not a bound, and is used only without proofs.
const DYNAMICS_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Finds the contact of the standing foot: the same circle with the same normal or, for a point, with any normal.
fn place_of(foot: &Contact, contacts: &[Contact]) -> Option<usize> {
    let same_point = || contacts.iter().position(|other| foot.radius == 0.0 && foot.has_circle_of(other));
    contacts.iter().position(|other| foot.is_the_same_as(other)).or_else(same_point)
}
