//! Whether a state's verdict holds on its box: the state's contacts kept, its numbers varied.

use super::super::strike::{Contacts, Inputs, Strike};
use super::super::{Answer, Impact, Pipeline};
use super::{CONTACT_LIMIT, Cell, Counterexample, Found, Holds, Model, Numbers, Quantity, search};
use crate::contact::Contact;
use crate::dynamics::Constraints;
use crate::impact::Analysis;
use crate::law::{Coulomb, Friction, Frictionless, Law, Mode, Unbounded};
use crate::planar::{difference, dot};
use crate::robot::Robot;
use crate::scalar::{Affine, Real};
use crate::state::{ByLink, NamedContact};
use crate::state::{State, Uncertainty};

impl Pipeline<'_> {
    /// Whether the answer to `state` holds on the box of its uncertainty.
    pub(in crate::pipeline) fn holds(&mut self, state: &State, uncertainty: &Uncertainty, answer: &Answer) -> Holds {
        let Some(expected) = answer.impact.analysis.as_ref().ok().and_then(proven_modes) else {
            return Holds::Unknown;
        };
        let links: Vec<usize> = answer.impact.contacts.iter().map(|contact| contact.link).collect();
        if links.is_empty() {
            return Holds::Everywhere;
        }
        let tied = !self.robot.followers.is_empty() || !state.scene.loops.is_empty();
        if links.len() > CONTACT_LIMIT || tied {
            return Holds::Unknown;
        }
        let whole = Cell::new(self.robot, state, uncertainty, &links);
        let quantities = whole.quantities.len();
        let mut model = Kept {
            friction: links.iter().filter_map(|&link| state.scene.friction.of(link)).collect(),
            links,
            named: with_named_contacts(self.robot, state, answer),
            quantities: whole.quantities.clone(),
            state,
            answer,
            pipeline: self,
        };
        // Sizes of the affine numbers; what goes beyond the last counts as unrelated errors.
        let found = match quantities {
            0 => Found::Same,
            1..=8 => search::<8>(&mut model, whole, &expected),
            9..=16 => search::<16>(&mut model, whole, &expected),
            17..=32 => search::<32>(&mut model, whole, &expected),
            _ => search::<64>(&mut model, whole, &expected),
        };
        match found {
            Found::Same => Holds::Everywhere,
            Found::Nothing => Holds::Unknown,
            Found::Differing(point) => model.counterexample(&point),
        }
    }
}

/// A state whose contacts, stance and resting contacts are kept while its numbers vary.
struct Kept<'a, 'r> {
    pipeline: &'a mut Pipeline<'r>,
    state: &'a State,
    answer: &'a Answer,
    /// The state with its contacts by name.
    named: State,
    /// Of each contact.
    links: Vec<usize>,
    friction: Vec<Friction>,
    quantities: Vec<Quantity>,
}

impl Kept<'_, '_> {
    /// The state at a point of the box.
    fn at(&self, point: &[f64]) -> State {
        let mut state = self.named.clone();
        for (&quantity, &value) in self.quantities.iter().zip(point) {
            match quantity {
                Quantity::Position(coordinate) => state.position[coordinate] = value,
                Quantity::Velocity(coordinate) => state.velocity[coordinate] = value,
                Quantity::Friction(link) => set(&mut state.scene.friction, link, Friction::Finite(value)),
                Quantity::RotorInertia(joint) => {
                    state.scene.rotor_inertia.resize(self.pipeline.robot.joints.len(), 0.0);
                    state.scene.rotor_inertia[joint] = value;
                }
            }
        }
        state
    }

    /// The proven answer at a point, if its contacts are the same.
    fn analysis(&mut self, point: &[f64]) -> Option<(State, Analysis)> {
        let state = self.at(point);
        let Answer { impact, foot, stance, resting } = self.pipeline.answer(&state, None).ok()?;
        let same_foot = match (&foot, &self.answer.foot) {
            (Some(one), Some(other)) => {
                let far = difference(one.centre, other.centre);
                (one.body, one.radius) == (other.body, other.radius) && dot(far, far) <= self.place_rounding()
            }
            (one, other) => one.is_none() == other.is_none(),
        };
        // Elsewhere on a profile a named contact may have another normal.
        let mut contacts = impact.contacts.iter().zip(&self.answer.impact.contacts);
        let same_axes = contacts.all(|(one, other)| one.ground == other.ground);
        (same_foot && same_axes && stance == self.answer.stance && resting == self.answer.resting)
            .then_some((state, impact.analysis.ok()?))
    }

    /// The square of how far a foot that is named may lie from the same foot as it was found \[m^2\].
    fn place_rounding(&self) -> f64 {
        (1e-12 * self.pipeline.feet.size()).powi(2)
    }

    fn counterexample(&mut self, point: &[f64]) -> Holds {
        match self.analysis(point) {
            Some((state, analysis)) => Holds::Not(Box::new(Counterexample {
                state,
                verdict: analysis.verdict,
                outcomes: analysis.outcomes.into_iter().map(|outcome| outcome.modes).collect(),
            })),
            None => Holds::Unknown,
        }
    }
}

impl Model for Kept<'_, '_> {
    fn contacts(&self) -> usize {
        self.links.len()
    }

    fn numbers<const N: usize>(&self, cell: &Cell) -> Numbers<Affine<N>> {
        let Answer { impact, foot, stance, resting } = self.answer;
        let (robot, scene) = (self.pipeline.robot, &self.state.scene);
        let strike = Strike {
            robot,
            scene,
            position: &self.state.position,
            velocity: &self.state.velocity,
            foot: foot.as_ref(),
            stance: *stance,
            contacts: &impact.contacts,
            resting,
            constraints: Constraints::default(),
            laws: &[],
            restitution: &[],
            errors: crate::impact::Errors::UNKNOWN,
        };
        let Contacts { delassus, before, free } = strike.contacts(Inputs {
            posture: cell.posture::<N>(robot, &self.state.position),
            velocity: cell.velocity(&self.state.velocity),
            plan: cell.plan(robot, &scene.held, &scene.rotor_inertia),
        });
        let row = |(contact, link): (usize, &usize)| {
            let restitution = Affine::from_f64(scene.restitution.of(*link).unwrap_or(0.0));
            let bounce = restitution * before[contact][1].min_zero();
            [free[contact][0], free[contact][1] + bounce]
        };
        let law = |(&friction, &link): (&Friction, &usize)| match friction {
            Friction::Infinite => Law::Unbounded(Unbounded),
            Friction::Finite(mu) if mu == 0.0 && !cell.quantities.contains(&Quantity::Friction(link)) => {
                Law::Frictionless(Frictionless)
            }
            Friction::Finite(mu) => Law::Coulomb(Coulomb { mu: cell.number(Quantity::Friction(link), mu) }),
        };
        Numbers {
            delassus,
            free: self.links.iter().enumerate().flat_map(row).collect(),
            laws: self.friction.iter().zip(&self.links).map(law).collect(),
        }
    }

    fn outcomes(&mut self, point: &[f64]) -> Option<Vec<Vec<Mode>>> {
        self.analysis(point).and_then(|(_, analysis)| proven_modes(&analysis))
    }
}

/// The lists of modes of a proven analysis, sorted.
fn proven_modes(analysis: &Analysis) -> Option<Vec<Vec<Mode>>> {
    let mut modes: Vec<Vec<Mode>> = analysis.outcomes.iter().map(|outcome| outcome.modes.clone()).collect();
    modes.sort();
    // Both ends of a family may have the same modes.
    modes.dedup();
    analysis.proven.then_some(modes)
}

/// The state with every contact named, so that it stays one whatever its height.
fn with_named_contacts(robot: &Robot, state: &State, answer: &Answer) -> State {
    let Impact { contacts, .. } = &answer.impact;
    let mut named = State { id: None, uncertainty: None, ..state.clone() };
    let name = |contact: &Contact| NamedContact {
        link: contact.link,
        offset: robot.links[contact.link].offset(contact.centre),
        radius: contact.radius,
    };
    named.scene.contacts.get_or_insert_with(|| contacts.iter().map(name).collect());
    named
}

fn set<T>(values: &mut ByLink<T>, link: usize, value: T) {
    match values.links.iter_mut().find(|(named, _)| *named == link) {
        Some((_, own)) => *own = value,
        None => values.links.push((link, value)),
    }
}
