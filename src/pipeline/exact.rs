//! One state's contact problem in numbers of any kind: what its f64 numbers were rounded from.

use super::assembly::{Assembly, Elimination};
use crate::contact::Contact;
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{Constraints, ContactPoint};
use crate::impact::{ContactProblem, Errors, Source};
use crate::law::Law;
use crate::planar::Pair;
use crate::robot::Robot;
use crate::scalar::{Ordered, Trigonometry};
use crate::state::Scene;

/// A state with its contacts, every f64 of which is meant as the number that it is.
pub struct ExactState<'a> {
    pub robot: &'a Robot,
    pub scene: &'a Scene,
    /// q; with a foot x and z are not read.
    pub position: &'a [f64],
    /// dq/dt; with a foot x and z are such that it rests.
    pub velocity: &'a [f64],
    /// The foot of the stance.
    pub foot: Option<&'a Contact>,
    /// Its place among the contacts.
    pub stance: Option<usize>,
    pub contacts: &'a [Contact],
    /// Contacts that are taken as exactly at rest.
    pub resting: &'a [bool],
    /// The joints that keep their rates although they have columns, and the rows of the loops that count.
    pub constraints: Constraints<'a>,
    pub laws: &'a [Law],
    pub restitution: &'a [f64],
    pub errors: Errors<'a>,
}

/// What of a state is a number that may be known inexactly.
pub struct Inputs<T> {
    /// Of q.
    pub configuration: Configuration<T>,
    /// dq/dt; with a foot x and z are not read.
    pub velocity: Vec<T>,
    /// The robot, its rotors' inertia included.
    pub plan: Plan<T>,
}

/// G, c- and c_free.
pub struct Contacts<T> {
    pub delassus: Vec<T>,
    pub before: Vec<Pair<T>>,
    pub free: Vec<Pair<T>>,
}

impl ExactState<'_> {
    /// The state's own numbers, exactly.
    fn inputs<T: Trigonometry>(&self) -> Inputs<T> {
        let held = if self.constraints.kept.is_empty() { &self.scene.held[..] } else { &[] };
        let plan = Plan::new(self.robot, held, &self.scene.rotor_inertia);
        let mut configuration = Configuration::default();
        configuration.set(&plan, self.position);
        Inputs { configuration, velocity: self.velocity.iter().map(|&entry| T::from_f64(entry)).collect(), plan }
    }

    /// G and c for these `inputs`, with the contacts as they are.
    pub fn contacts<T: Trigonometry>(&self, inputs: Inputs<T>) -> Contacts<T> {
        let Self { robot, scene, .. } = *self;
        let Inputs { configuration, mut velocity, plan } = inputs;
        let point = |contact: &Contact| contact.exact_point(robot, scene.ground.axes(contact.ground));
        let foot: Option<ContactPoint<T>> = self.foot.map(point);
        let mut assembly = Assembly::new(plan);
        assembly.configuration = configuration;
        assembly.points.extend(self.contacts.iter().map(point));
        assembly.kept.extend(self.constraints.kept);
        assembly.loops.extend(scene.loops.iter().map(|own| own.points(robot)));
        assembly.rows.extend(self.constraints.rows);
        if !assembly.plan.has_mimics && !assembly.is_constrained() {
            assembly.elimination = Elimination::ArticulatedBodies;
        }
        assembly.place();
        assembly.factorize();
        if let Some(foot) = &foot {
            assembly.rest(foot, &mut velocity);
        }
        assembly.constrain(foot);
        assembly.close(&mut velocity);
        assembly.contact_jacobian(&velocity, self.stance);
        assembly.delassus();
        let speeds = assembly.workspace.contact_velocity.iter().zip(self.resting);
        let before = speeds.map(|(&speed, &rests)| if rests { [T::zero(); 2] } else { speed }).collect::<Vec<_>>();
        let mut free = before.clone();
        if !scene.impulses.is_empty() {
            let mut change = assembly.applied(robot, scene, velocity.len());
            assembly.answer(&mut change);
            free = assembly.free(&before, &change);
        }
        Contacts { delassus: assembly.workspace.delassus, before, free }
    }
}

impl Source for ExactState<'_> {
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
        let Contacts { delassus, before, free } = self.contacts(self.inputs());
        ContactProblem::of_parts(delassus, before, free, self.laws.to_vec(), self.restitution.to_vec())
    }

    fn errors(&self) -> Errors<'_> {
        self.errors
    }

    fn contact_name(&self, contact: usize) -> String {
        self.contacts[contact].name.clone()
    }
}
