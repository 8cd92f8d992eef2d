//! One state's contact problem in numbers of any kind: what its f64 numbers were rounded from.

use crate::contact::Contact;
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{
    Closed, Constraints, ContactPoint, Loop, Workspace, add_articulated_impulse, add_impulse, articulated_delassus,
    articulated_inertias, close, contact_jacobian, delassus, eliminate_loops, factorize, kinematics, mass_matrix,
    orthogonalize, point_velocity,
};
use crate::impact::{ContactProblem, Errors, Source};
use crate::law::Law;
use crate::planar::Pair;
use crate::robot::Robot;
use crate::scalar::{Ordered, Trigonometry};
use crate::state::Scene;

/// A state with its contacts, every f64 of which is meant as the number that it is.
pub struct Strike<'a> {
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
    pub posture: Configuration<T>,
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

impl Strike<'_> {
    /// The state's own numbers, exactly.
    fn inputs<T: Trigonometry>(&self) -> Inputs<T> {
        let held = if self.constraints.kept.is_empty() { &self.scene.held[..] } else { &[] };
        let plan = Plan::new(self.robot, held, &self.scene.rotor_inertia);
        let mut posture = Configuration::default();
        posture.set(&plan, self.position);
        Inputs { posture, velocity: self.velocity.iter().map(|&entry| T::from_f64(entry)).collect(), plan }
    }

    /// G and c for these `inputs`, with the contacts as they are.
    pub fn contacts<T: Trigonometry>(&self, inputs: Inputs<T>) -> Contacts<T> {
        let Self { robot, scene, .. } = *self;
        let Inputs { posture, mut velocity, plan } = inputs;
        let mut workspace = Workspace::default();
        kinematics(&plan, &posture, &mut workspace);
        let constrained = !(scene.loops.is_empty() && self.constraints.kept.is_empty());
        // Articulated bodies hold neither ties nor constraints.
        let by_mass = plan.has_mimics || constrained;
        if by_mass {
            mass_matrix(&plan, &mut workspace);
            factorize(&plan, &mut workspace);
        } else {
            // Not by the mass matrix: its factor costs the cube of a chain's length, and its enclosures widen faster.
            articulated_inertias(&plan, &mut workspace);
        }

        let point = |contact: &Contact| contact.exact_point(robot, scene.ground.axes(contact.ground));
        let contacts: Vec<ContactPoint<T>> = self.contacts.iter().map(point).collect();
        if let Some(foot) = self.foot.map(point) {
            velocity[..2].fill(T::zero());
            let moving = point_velocity(&plan, foot.body, foot.arm(&workspace), &velocity, &workspace);
            velocity[..2].copy_from_slice(&(-moving).components());
        }
        let loops: Vec<Loop<T>> = scene.loops.iter().map(|own| own.points(robot)).collect();
        if constrained {
            let foot = self.foot.filter(|_| !loops.is_empty()).map(point);
            orthogonalize(&plan, &loops, (self.constraints, foot), &mut workspace);
            if !loops.is_empty() {
                close(&plan, &loops, Closed::Velocity, &mut velocity, &workspace);
            }
        }
        contact_jacobian(&plan, &contacts, &velocity, self.stance, &mut workspace);
        if by_mass {
            delassus(&plan, &mut workspace);
        } else {
            articulated_delassus(&plan, &contacts, &mut workspace);
        }
        if constrained {
            eliminate_loops(&plan, &mut workspace);
        }
        for (speed, _) in workspace.contact_velocity.iter_mut().zip(self.resting).filter(|(_, rests)| **rests) {
            *speed = [T::zero(); 2];
        }
        let before = workspace.contact_velocity.clone();
        let mut free = before.clone();
        if !scene.impulses.is_empty() {
            let mut change = vec![T::zero(); velocity.len()];
            for applied in &scene.impulses {
                let link = &robot.links[applied.link];
                let arm = workspace.rotation[link.body].apply(link.point(applied.offset));
                let vector = applied.vector.map(T::from_f64);
                let (point, column) = ((link.body, arm), &mut Vec::new());
                if by_mass {
                    add_impulse(&plan, &workspace, point, vector, column, &mut change);
                } else {
                    let scratch = (column, &mut Vec::new());
                    add_articulated_impulse(&plan, &workspace, point, vector, scratch, &mut change);
                }
            }
            if constrained {
                close(&plan, &loops, Closed::Change, &mut change, &workspace);
            }
            for (point, speed) in contacts.iter().zip(&mut free) {
                let more = point_velocity(&plan, point.body, point.arm(&workspace), &change, &workspace);
                for (entry, axis) in speed.iter_mut().zip(point.axes()) {
                    *entry = *entry + axis.dot(more);
                }
            }
        }
        Contacts { delassus: workspace.delassus, before, free }
    }
}

impl Source for Strike<'_> {
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
        let Contacts { delassus, before, free } = self.contacts(self.inputs());
        ContactProblem::of_parts(delassus, before, free, self.laws.to_vec(), self.restitution.to_vec())
    }

    fn errors(&self) -> Errors<'_> {
        self.errors
    }
}
