//! The contact problem of one state in numbers of any kind: the exact data behind its rounded f64 numbers.

use super::Impact;
use super::assembly::{Assembly, Elimination, Loads};
use super::still::Still;
use crate::contact::{Contact, Level};
use crate::dynamics::plan::Plan;
use crate::dynamics::{Closed, Constraints, ContactPoint};
use crate::impact::{ContactProblem, Errors, Source};
use crate::law::Law;
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::scalar::{Ball, DoubleDouble, Ordered, Real, Trigonometry};
use crate::state::{Scene, State};
use std::cmp::Ordering;
use std::ops::Add;

/// The question about a state.
#[derive(Debug, Clone, Copy)]
pub enum Asked<'a> {
    Impact,
    /// An impact at contacts that neither approach nor leave, with these signs of c_t: all c_n are exactly zero, and so
    /// is c_t of contacts that do not slide.
    Shock(&'a [Ordering]),
    /// Accelerations in place of velocities.
    Forces(Loads<'a>),
}

/// A state with its contacts. Every f64 in it is taken as exact.
pub struct ExactState<'a> {
    pub robot: &'a Robot,
    pub scene: &'a Scene,
    /// q. With a `foot` its x and z are not read.
    pub position: &'a [f64],
    /// dq/dt. With a `foot` its x and z are those with which the foot rests.
    pub velocity: &'a [f64],
    /// The foot of the stance.
    pub foot: Option<&'a Contact>,
    /// The index of this foot's contact.
    pub stance: Option<usize>,
    pub contacts: &'a [Contact],
    /// For each contact, the other contact with which it is exactly level, if any.
    pub levels: &'a [Option<Level>],
    /// Contacts that are taken as exactly at rest.
    pub still: &'a Still,
    /// The braked joints that nevertheless have columns, and the independent rows of the loops.
    pub constraints: Constraints<'a>,
    /// Whether these rows follow from the mechanism, and not from the rounding of its pose.
    pub is_rank_certain: bool,
    pub laws: &'a [Law],
    pub restitution: &'a [f64],
    pub errors: Errors<'a>,
    pub asked: Asked<'a>,
}

/// G, c- and c_free.
pub struct Contacts<T> {
    pub delassus: Vec<T>,
    pub before: Vec<Pair<T>>,
    pub free: Vec<Pair<T>>,
}

impl<'a> ExactState<'a> {
    /// The exact data of a `state` with the contacts of an `impact`, none level with another, and the stance's `foot`.
    pub fn of(
        robot: &'a Robot,
        state: &'a State,
        (impact, foot): (&'a Impact, Option<&'a Contact>),
        still: &'a Still,
        constraints: Constraints<'a>,
    ) -> Self {
        Self {
            robot,
            scene: &state.scene,
            position: &state.position,
            velocity: &state.velocity,
            foot,
            stance: impact.stance,
            contacts: &impact.contacts,
            levels: &[],
            still,
            constraints,
            is_rank_certain: true,
            laws: impact.problem.laws(),
            restitution: impact.problem.restitution(),
            errors: Errors::UNKNOWN,
            asked: Asked::Impact,
        }
    }

    pub fn plan<T: Real>(&self) -> Plan<T> {
        let braked = if self.constraints.kept.is_empty() { &self.scene.braked[..] } else { &[] };
        Plan::new(self.robot, braked, &self.scene.rotor_inertia)
    }

    /// The robot with its constraints, ready for the steps of the assembly.
    pub fn assembly<T: Real>(&self, plan: Plan<T>) -> Assembly<T> {
        let mut assembly = Assembly::new(plan);
        assembly.kept.extend(self.constraints.kept);
        assembly.loops.extend(self.scene.loops.iter().map(|named| named.points(self.robot)));
        assembly.rows.extend(self.constraints.rows);
        assembly
    }

    fn point<T: Trigonometry>(&self, contact: &Contact) -> ContactPoint<T> {
        contact.exact_point(self.robot, self.scene.ground.axes(contact.ground))
    }

    /// Computes the poses of the bodies and the contact points from the configuration.
    pub fn place<T: Trigonometry>(&self, assembly: &mut Assembly<T>) {
        assembly.place();
        assembly.points.clear();
        assembly.points.extend(self.contacts.iter().map(|contact| self.point(contact)));
        for (index, level) in self.levels.iter().enumerate() {
            let &Some(Level { with, along: Some(along), .. }) = level else { continue };
            let Assembly { plan, workspace, points, .. } = &mut *assembly;
            let (other, point) = (points[with], &mut points[index]);
            let [tangent, normal] = point.axes();
            let arm = tangent * T::from_f64(along) + normal * (point.radius - other.radius);
            let back = workspace.rotation[point.body].back();
            point.center = if point.body == other.body {
                other.center + back.apply(arm)
            } else {
                let arms = |body: usize, other: usize| plan.way_beyond(body, other).map(|(at, _)| workspace.arm[at]);
                let [to_other, to_point] = [(other.body, point.body), (point.body, other.body)]
                    .map(|(body, other)| arms(body, other).fold(Vector::zero(), Vector::add));
                let between = to_other - to_point;
                let center = workspace.rotation[other.body].apply(other.center);
                back.apply(between + center + arm)
            };
        }
    }

    /// Computes J and c, and changes `velocity` to fit the stance and the loops. Requires M^-1.
    pub fn contact_velocities<T: Trigonometry>(&self, assembly: &mut Assembly<T>, velocity: &mut [T]) {
        let foot: Option<ContactPoint<T>> = self.foot.map(|foot| self.point(foot));
        if let Some(foot) = &foot {
            assembly.rest(foot, velocity);
        }
        assembly.constrain(foot);
        assembly.close(velocity);
        assembly.contact_jacobian(velocity, self.stance);
    }

    /// Returns the change of v by the applied impulses, by coordinate. Requires M^-1.
    pub fn change<T: Real>(&self, assembly: &mut Assembly<T>) -> Vec<T> {
        let mut change = vec![T::zero(); self.position.len()];
        assembly.apply(self.robot, self.scene, &mut change);
        assembly.add_constraint_response(Closed::Change, &mut change);
        change
    }

    /// Returns c-, with zeros for what rests.
    fn before<T: Real>(&self, assembly: &mut Assembly<T>) -> Vec<Pair<T>> {
        assembly.settle(self.still, |_, _, _| {});
        let speeds = assembly.workspace.contact_velocity.iter().enumerate();
        let before = speeds.map(|(at, &[tangential, normal])| match self.asked {
            Asked::Shock(slips) if slips[at].is_eq() => [T::zero(); 2],
            Asked::Shock(_) => [tangential, T::zero()],
            Asked::Impact | Asked::Forces(_) => [tangential, normal],
        });
        before.collect()
    }

    /// Returns G, which is taken out of the assembly, c- and c_free, after all steps of the assembly.
    pub fn collect<T: Real>(&self, assembly: &mut Assembly<T>) -> Contacts<T> {
        let before = self.before(assembly);
        let free = match self.scene.impulses.is_empty() {
            true => before.clone(),
            false => {
                let change = self.change(assembly);
                assembly.free(&before, &change)
            }
        };
        Contacts { delassus: std::mem::take(&mut assembly.workspace.delassus), before, free }
    }

    /// Returns the robot in its configuration, and dq/dt.
    fn given<T: Trigonometry>(&self) -> (Assembly<T>, Vec<T>) {
        let mut assembly = self.assembly(self.plan());
        assembly.configuration.set(&assembly.plan, self.position);
        (assembly, self.velocity.iter().map(|&entry| T::from_f64(entry)).collect())
    }

    /// Returns the summands of the velocity by coordinate after these contact impulses, or of the acceleration under
    /// these contact forces: the part without them, for an impact the part of the applied impulses, then one part per
    /// contact. Each summand continues with its part of the loop impulses, [x, z] for each loop.
    pub fn response<T: Trigonometry>(&self, impulse: &[Pair<f64>]) -> Vec<Vec<T>> {
        let (mut assembly, mut velocity) = self.given();
        self.assemble(&mut assembly, &mut velocity);
        let rest = vec![T::zero(); velocity.len()];
        let with = |mut rates: Vec<T>, loops: Vec<Vector<T>>| {
            rates.extend(loops.into_iter().flat_map(Vector::components));
            rates
        };
        let mut parts = match self.asked {
            Asked::Forces(loads) => {
                let (mut acceleration, drifts) = assembly.acceleration(&velocity, loads);
                let loops = assembly.add_constraint_response(Closed::Acceleration(&drifts), &mut acceleration);
                vec![with(acceleration, loops)]
            }
            Asked::Impact | Asked::Shock(_) => {
                let mut change = rest.clone();
                assembly.apply(self.robot, self.scene, &mut change);
                let loops = assembly.add_constraint_response(Closed::Change, &mut change);
                let still = vec![Vector::zero(); loops.len()];
                vec![with(velocity, still), with(change, loops)]
            }
        };
        for (contact, pair) in impulse.iter().enumerate() {
            let mut change = rest.clone();
            assembly.add_contact_impulse(assembly.elimination, contact, pair.map(T::from_f64), &mut change);
            let loops = assembly.add_constraint_response(Closed::Change, &mut change);
            parts.push(with(change, loops));
        }
        parts
    }

    /// Prepares M^-1, J and c in a configuration with these contacts; `velocity` is fitted to the stance and the loops.
    fn assemble<T: Trigonometry>(&self, assembly: &mut Assembly<T>, velocity: &mut [T]) {
        if assembly.has_articulated_bodies() {
            assembly.elimination = Elimination::ArticulatedBodies;
        }
        self.place(assembly);
        assembly.factorize();
        self.contact_velocities(assembly, velocity);
    }

    /// Returns G, c- and c_free in a configuration with these contacts. For forces, the contacts' accelerations without
    /// contact forces replace both c. With a foot, x and z of the `velocity` are not read.
    pub fn contacts<T: Trigonometry>(&self, mut assembly: Assembly<T>, mut velocity: Vec<T>) -> Contacts<T> {
        self.assemble(&mut assembly, &mut velocity);
        assembly.delassus();
        match self.asked {
            Asked::Forces(loads) => {
                let (mut acceleration, drifts) = assembly.acceleration(&velocity, loads);
                assembly.add_constraint_response(Closed::Acceleration(&drifts), &mut acceleration);
                let free = assembly.contact_accelerations(&acceleration);
                Contacts { delassus: assembly.workspace.delassus, before: free.clone(), free }
            }
            Asked::Impact | Asked::Shock(_) => self.collect(&mut assembly),
        }
    }
}

impl Source for ExactState<'_> {
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
        let (assembly, velocity) = self.given();
        let Contacts { delassus, before, free } = self.contacts(assembly, velocity);
        ContactProblem::of_parts(delassus, before, free, self.laws.to_vec(), self.restitution.to_vec())
    }

    fn errors(&self) -> Errors<'_> {
        self.errors
    }

    fn velocity(&self) -> Option<Vec<Pair<Ball<DoubleDouble>>>> {
        let is_free = self.constraints.kept.is_empty()
            && self.scene.loops.is_empty()
            && self.scene.impulses.is_empty()
            && self.still.rows.is_empty();
        if !(is_free && matches!(self.asked, Asked::Impact)) {
            return None;
        }
        let (mut assembly, mut velocity) = self.given();
        self.place(&mut assembly);
        self.contact_velocities(&mut assembly, &mut velocity);
        Some(self.before(&mut assembly))
    }

    fn is_exact(&self) -> bool {
        self.is_rank_certain
    }

    fn contact_name(&self, contact: usize) -> String {
        self.contacts[contact].name.to_string()
    }

    fn shared_tangent(&self, contact: usize) -> Option<usize> {
        let &Level { with, .. } = self.levels.get(contact)?.as_ref()?;
        let still = |contact: usize| self.still.contacts.get(contact);
        let is_alike = still(contact) == still(with) || !self.still.rows.is_empty();
        // Accelerations of the two contacts differ by a term from the rotation of the body.
        (matches!(self.asked, Asked::Impact) && is_alike).then_some(with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::RoundingBounds;
    use crate::impact::{Analysis, AnalysisOptions, Scratch};
    use crate::pipeline::{Options, Pipeline};
    use crate::state::Defaults;

    /// A state whose c is known only as closely as in f64.
    struct Blurred<'a>(&'a ExactState<'a>);

    impl Source for Blurred<'_> {
        fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
            self.0.problem()
        }

        fn errors(&self) -> Errors<'_> {
            self.0.errors()
        }
    }

    #[test]
    fn slow_contacts_are_decided_in_f64_as_by_balls() {
        let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).unwrap();
        let mut pipeline = Pipeline::new(&robot, Options::default());
        let beyond_f64 = |analysis: &Analysis| analysis.effort.ball + analysis.effort.double_double;
        let (mut slow, mut decided) = (0, 0);
        let lines = include_str!("../../examples/gait/ramone_walk.ndjson").lines();
        for (line, noise) in lines.zip([1e-4, 1e-6, 1e-8, 1e-10].into_iter().cycle()) {
            let mut state = State::from_json(line, &robot, &Defaults::default()).unwrap();
            for (k, rate) in state.velocity.iter_mut().enumerate() {
                *rate *= 1.0 + noise * f64::from(k as u32).cos();
            }
            state.scene.restitution.default = (noise < 1e-7).then_some(0.3);
            let prepared = pipeline.prepare(&state).unwrap();
            let RoundingBounds { delassus, velocity, likely, .. } = &pipeline.bounds;
            let errors = Errors { delassus: *delassus, velocity: Some(velocity), likely: *likely };
            let source = prepared.exact(&robot, &state, &pipeline.assembly, errors);
            let problem = &prepared.impact.problem;
            let analyze = |blurred: bool| match blurred {
                true => Scratch::default().analyze(problem, &Blurred(&source), AnalysisOptions::default()).unwrap(),
                false => Scratch::default().analyze(problem, &source, AnalysisOptions::default()).unwrap(),
            };
            let [sharp, blurred] = [false, true].map(analyze);
            assert_eq!((sharp.verdict, sharp.proven), (blurred.verdict, blurred.proven), "{line}");
            assert_eq!(sharp.outcomes.len(), blurred.outcomes.len(), "{line}");
            for (one, other) in sharp.outcomes.iter().zip(&blurred.outcomes) {
                assert_eq!((&one.modes, one.index), (&other.modes, other.index), "{line}");
                let losses = [one, other].map(|outcome| outcome.energy_loss);
                assert!((losses[0] - losses[1]).abs() <= 1e-10 * losses[1].abs(), "{losses:?} of {line}");
                let margins = [one, other].map(|outcome| outcome.margin.unwrap_or_default());
                assert!((margins[0] - margins[1]).abs() <= 1e-10 * margins[1].abs().max(1.0), "{margins:?} of {line}");
                let [one, other] = [one, other]
                    .map(|outcome| [&outcome.impulse, &outcome.velocity_after].map(|list| list.as_flattened()));
                for (one, other) in one.into_iter().zip(other) {
                    let scale = other.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
                    let near = one.iter().zip(other).all(|(one, other)| (one - other).abs() <= 1e-10 * scale);
                    assert!(near, "{one:?} is not {other:?} of {line}");
                }
            }
            if beyond_f64(&blurred) > 0 {
                slow += 1;
                decided += usize::from(beyond_f64(&sharp) == 0);
            }
        }
        assert!(decided > 50 && decided * 10 > slow * 9, "{decided} of {slow} in f64");
    }
}
