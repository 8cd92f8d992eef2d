//! A state whose numbers vary in a box while its contacts stay the same.

use super::super::exact::{Contacts, ExactState};
use super::super::{Answer, Impact, Pipeline, Prepared};
use super::Counterexample;
use super::combination::UncertainProblem;
use super::state_box::{Quantity, StateBox};
use crate::contact::Contact;
use crate::dynamics::Constraints;
use crate::impact::Analysis;
use crate::law::{Friction, Law, Mode};
use crate::robot::Robot;
use crate::scalar::{Affine, Real};
use crate::state::{NamedContact, State};

/// A state whose contacts, stance and resting contacts stay the same while its numbers vary.
pub(super) struct KeptContacts<'a, 'r> {
    pub pipeline: &'a mut Pipeline<'r>,
    pub state: &'a State,
    pub answer: &'a Answer,
    /// The state with all its contacts named.
    pub named: State,
    /// The link of each contact.
    pub links: Vec<usize>,
    pub friction: Vec<Friction>,
    pub quantities: Vec<Quantity>,
}

impl KeptContacts<'_, '_> {
    /// Returns the state at a point of the box.
    fn at(&self, point: &[f64]) -> State {
        let mut state = self.named.clone();
        for (&quantity, &value) in self.quantities.iter().zip(point) {
            match quantity {
                Quantity::Position(coordinate) => state.position[coordinate] = value,
                Quantity::Velocity(coordinate) => state.velocity[coordinate] = value,
                Quantity::Friction(link) => {
                    state.scene.friction.links.insert(link, Friction::Finite(value));
                }
                Quantity::RotorInertia(joint) => {
                    let robot = self.pipeline.robot;
                    state.scene.rotor_inertia.resize(robot.joints.len() + robot.mimic_joints.len(), 0.0);
                    state.scene.rotor_inertia[joint] = value;
                }
            }
        }
        state
    }

    /// Returns the state at a point and its analysis; `None` if its contacts differ.
    fn analysis(&mut self, point: &[f64]) -> Option<(State, Analysis)> {
        let state = self.at(point);
        let answer = self.pipeline.analyze_impact(&state, Some(&[])).ok()?;
        let [found, given] = [&answer, self.answer];
        let same_foot = match (&found.prepared.foot, &given.prepared.foot) {
            (Some(one), Some(other)) => {
                // Naming a foot moves it by rounding.
                let (far, rounding) = (one.center - other.center, 1e-12 * self.pipeline.feet.size());
                (one.body, one.radius) == (other.body, other.radius) && far.dot(far) <= rounding.powi(2)
            }
            (one, other) => one.is_none() == other.is_none(),
        };
        // Elsewhere on a profile, a named contact may have another normal.
        let mut contacts = found.impact.contacts.iter().zip(&given.impact.contacts);
        let same_axes = contacts.all(|(one, other)| one.ground == other.ground);
        let same_rests = found.impact.stance == given.impact.stance && found.prepared.still == given.prepared.still;
        let same = same_foot && same_axes && same_rests && found.rows == given.rows;
        let impact = self.pipeline.finished(answer);
        same.then_some((state, impact.analysis?))
    }

    /// Returns the state at a point if its proven outcomes are not the `expected` ones (lists of modes, sorted).
    pub fn counterexample(&mut self, point: &[f64], expected: &[Vec<Mode>]) -> Option<Counterexample> {
        let (state, analysis) = self.analysis(point)?;
        (proven_modes(&analysis)? != expected).then(|| Counterexample {
            state,
            verdict: analysis.verdict,
            outcomes: analysis.modes(),
        })
    }

    /// Returns every combination of the modes that the contacts may take; the first contact changes fastest.
    pub fn combinations(&self) -> Vec<Vec<Mode>> {
        let mut all = vec![Vec::new()];
        for &friction in self.friction.iter().rev() {
            let modes: Vec<Mode> = Law::from(friction).modes().concat();
            let with = |rest: &Vec<Mode>| modes.iter().map(|&mode| [&[mode], &rest[..]].concat()).collect::<Vec<_>>();
            all = all.iter().flat_map(with).collect();
        }
        all
    }

    /// Returns the contact problem on the whole box.
    pub fn problem<const N: usize>(&self, state_box: &StateBox) -> UncertainProblem<Affine<N>> {
        let Answer { impact, prepared, rows } = self.answer;
        let Prepared { foot, still, .. } = &**prepared;
        let (robot, scene) = (self.pipeline.robot, &self.state.scene);
        // No sole is taken as exactly level, because angles vary.
        let exact = ExactState::of(robot, self.state, (impact, foot.as_ref()), still, Constraints { kept: &[], rows });
        let mut assembly = exact.assembly(state_box.plan::<N>(robot, &scene.braked, &scene.rotor_inertia));
        assembly.configuration = state_box.configuration(&assembly.plan, &self.state.position);
        let Contacts { delassus, before, free } = exact.contacts(assembly, state_box.velocity(&self.state.velocity));
        let row = |(contact, link): (usize, &usize)| {
            let restitution = Affine::from_f64(scene.restitution.of(*link).unwrap_or(0.0));
            let bounce = restitution * before[contact][1].min_zero();
            [free[contact][0], free[contact][1] + bounce]
        };
        let law = |(friction, &link): (&Friction, &usize)| {
            friction.map(|mu| state_box.number::<N>(Quantity::Friction(link), mu)).into()
        };
        UncertainProblem {
            delassus,
            free: self.links.iter().enumerate().flat_map(row).collect(),
            laws: self.friction.iter().zip(&self.links).map(law).collect(),
        }
    }
}

/// Returns the lists of modes of an analysis, sorted; `None` if it is not proven.
pub(super) fn proven_modes(analysis: &Analysis) -> Option<Vec<Vec<Mode>>> {
    analysis.proven.then(|| analysis.modes())
}

/// Names every contact of the state, so that it stays a contact at any height.
pub(super) fn with_named_contacts(robot: &Robot, state: &State, answer: &Answer) -> State {
    let Impact { contacts, .. } = &*answer.impact;
    let mut named = State { id: None, uncertainty: None, ..state.clone() };
    let name = |contact: &Contact| NamedContact {
        link: contact.link,
        offset: robot.links[contact.link].offset(contact.center),
        radius: contact.radius,
    };
    named.scene.contacts.get_or_insert_with(|| contacts.iter().map(name).collect());
    named
}
