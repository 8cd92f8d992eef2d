//! Boxes of states: an interval for each uncertain number.

use crate::dynamics::plan::{Configuration, JointMotion, Plan};
use crate::law::Friction;
use crate::planar::Rotation;
use crate::robot::{Base, ParentJoint, Robot};
use crate::scalar::{Affine, Real, two_sum};
use crate::state::{State, Uncertainty};

/// An uncertain number of a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// An entry of q, by coordinate.
    Position(usize),
    /// An entry of v, by coordinate.
    Velocity(usize),
    /// The friction of a link.
    Friction(usize),
    /// The rotor inertia of a joint.
    RotorInertia(usize),
}

/// A box: a closed interval with f64 ends for each uncertain number.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StateBox {
    pub quantities: Vec<Quantity>,
    /// The least and greatest value of each quantity.
    pub ends: Vec<[f64; 2]>,
    /// The outermost f64 within the whole box. Half-widths are exact, and `ends` are rounded outward to cover them.
    inner: Vec<[f64; 2]>,
}

impl StateBox {
    /// Creates the whole box of a state whose contacts are on `links`.
    pub fn new(robot: &Robot, state: &State, uncertainty: &Uncertainty, links: &[usize]) -> Self {
        let mut state_box = Self { quantities: Vec::new(), ends: Vec::new(), inner: Vec::new() };
        let base = robot.base_dofs();
        // The position of a floating base has no effect, and with a stance its velocity follows from the other numbers.
        let placed = robot.base == Base::Floating;
        let follows = placed && state.scene.stance.is_some();
        for coordinate in 0..robot.dofs() {
            let bound = coordinate < base.min(2);
            if !(placed && bound) {
                let (value, width) = (state.position[coordinate], uncertainty.position[coordinate]);
                state_box.add(Quantity::Position(coordinate), value, width, f64::NEG_INFINITY);
            }
            if !(follows && bound) {
                let (value, width) = (state.velocity[coordinate], uncertainty.velocity[coordinate]);
                state_box.add(Quantity::Velocity(coordinate), value, width, f64::NEG_INFINITY);
            }
        }
        for (at, &link) in links.iter().enumerate().filter(|&(at, link)| !links[..at].contains(link)) {
            if let Some(Friction::Finite(mu)) = state.scene.friction.of(links[at]) {
                state_box.add(Quantity::Friction(link), mu, uncertainty.friction.of(link).unwrap_or(0.0), 0.0);
            }
        }
        for (joint, &width) in uncertainty.rotor_inertia.iter().enumerate() {
            // A braked joint has no equation of its own that its rotor could enter.
            if !state.scene.braked.contains(&joint) {
                let value = state.scene.rotor_inertia.get(joint).copied().unwrap_or(0.0);
                state_box.add(Quantity::RotorInertia(joint), value, width, 0.0);
            }
        }
        state_box
    }

    fn add(&mut self, quantity: Quantity, value: f64, width: f64, least: f64) {
        let [(low, above), (high, below)] = [around(value, -width), around(value, width)];
        let ends = [low.max(least), high];
        if ends[0] < ends[1] {
            self.quantities.push(quantity);
            self.ends.push(ends);
            self.inner.push([above.max(least), below]);
        }
    }

    /// Returns the middle of a quantity's interval, rounded into the interval.
    pub fn middle(&self, index: usize) -> f64 {
        let [low, high] = self.ends[index];
        let [least, greatest] = self.inner[index];
        (low + (high - low) / 2.0).clamp(low, high).max(least).min(greatest)
    }

    /// Returns the middle of every interval.
    pub fn center(&self) -> Vec<f64> {
        (0..self.ends.len()).map(|index| self.middle(index)).collect()
    }

    /// Returns the corner in `direction`: the greatest value where the direction is positive, the least where it is
    /// negative, the middle where it is zero or missing.
    pub fn corner(&self, direction: &[f64]) -> Vec<f64> {
        let towards = |(index, &[low, high]): (usize, &[f64; 2])| match direction.get(index) {
            Some(&along) if along > 0.0 => high.min(self.inner[index][1]),
            Some(&along) if along < 0.0 => low.max(self.inner[index][0]),
            _ => self.middle(index),
        };
        self.ends.iter().enumerate().map(towards).collect()
    }

    /// Returns both halves along a quantity; `None` if no f64 lies between its ends.
    pub fn halves(&self, index: usize) -> Option<[Self; 2]> {
        let (middle, [low, high]) = (self.middle(index), self.ends[index]);
        let half = |ends: [f64; 2]| {
            let mut half = self.clone();
            half.ends[index] = ends;
            half
        };
        (low < middle && middle < high).then(|| [half([low, middle]), half([middle, high])])
    }

    /// The widths of the positions; zero for all other quantities, which enter linearly.
    pub fn spreads(&self) -> Vec<f64> {
        let spread = |(quantity, [low, high]): (&Quantity, &[f64; 2])| match quantity {
            Quantity::Position(_) => high - low,
            _ => 0.0,
        };
        self.quantities.iter().zip(&self.ends).map(spread).collect()
    }

    /// Returns the index, the middle and the radius of a quantity's interval; `None` if it is certain.
    fn find(&self, quantity: Quantity) -> Option<(usize, f64, f64)> {
        let index = self.quantities.iter().position(|other| *other == quantity)?;
        let (middle, [low, high]) = (self.middle(index), self.ends[index]);
        // The factor covers the rounding of each difference.
        Some((index, middle, (high - middle).max(middle - low) * (1.0 + f64::EPSILON)))
    }

    /// Returns the quantity as a number; `certain` is its value if it is certain.
    pub fn number<const N: usize>(&self, quantity: Quantity, certain: f64) -> Affine<N> {
        let uncertain = self.find(quantity).map(|(index, middle, radius)| Affine::varying(middle, radius, index));
        uncertain.unwrap_or_else(|| Affine::from_f64(certain))
    }

    /// Returns the rotations and displacements of all positions in the box, as motions from its middle.
    pub fn configuration<const N: usize>(&self, plan: &Plan<Affine<N>>, position: &[f64]) -> Configuration<Affine<N>> {
        let mut middle = position.to_vec();
        for (index, quantity) in self.quantities.iter().enumerate() {
            if let Quantity::Position(coordinate) = *quantity {
                middle[coordinate] = self.middle(index);
            }
        }
        let mut configuration = Configuration::default();
        configuration.set(plan, &middle);
        for body in &plan.bodies {
            let Some((index, _, radius)) = self.find(Quantity::Position(body.coordinate)) else { continue };
            let unit = Affine::varying(0.0, radius, index);
            let by = body.mimic.map_or(unit, |mimic| unit * Affine::from_f64(mimic.multiplier));
            match body.motion {
                JointMotion::Root if !plan.floating => {}
                JointMotion::Root | JointMotion::Revolute { .. } => {
                    let [cos, sin] = by.cos_sin_near_zero();
                    let turn = &mut configuration.turns[body.place];
                    *turn = turn.then(Rotation { cos, sin });
                }
                JointMotion::Prismatic { .. } => {
                    let displacement = &mut configuration.displacement[body.place];
                    *displacement = *displacement + by;
                }
                JointMotion::Fixed => {}
            }
        }
        configuration
    }

    /// Returns all velocities in the box.
    pub fn velocity<const N: usize>(&self, velocity: &[f64]) -> Vec<Affine<N>> {
        let entries = velocity.iter().enumerate();
        entries.map(|(coordinate, &entry)| self.number(Quantity::Velocity(coordinate), entry)).collect()
    }

    /// Returns the robot with all rotor inertias in the box.
    pub fn plan<const N: usize>(&self, robot: &Robot, braked: &[usize], rotor_inertia: &[f64]) -> Plan<Affine<N>> {
        let mut plan = Plan::new(robot, braked, rotor_inertia);
        for (body, robot_body) in plan.bodies.iter_mut().zip(&robot.bodies) {
            let joint = match robot_body.joint {
                Some(ParentJoint::Joint(joint)) => joint,
                Some(ParentJoint::Mimic(joint)) => robot.joints.len() + joint,
                Some(ParentJoint::Fixed { .. }) | None => continue,
            };
            if let Some((index, middle, radius)) = self.find(Quantity::RotorInertia(joint)) {
                let ratio = Affine::from_f64(body.mimic.map_or(1.0, |mimic| mimic.multiplier));
                body.rotor = ratio * ratio * Affine::varying(middle, radius, index);
            }
        }
        plan
    }
}

/// Returns the two f64 around `value` + `shift`, the one farther from `value` first; equal if the sum is an f64.
fn around(value: f64, shift: f64) -> (f64, f64) {
    let (sum, missing) = two_sum(value, shift);
    let onward = |number: f64| if shift > 0.0 { number.next_up() } else { number.next_down() };
    let back = |number: f64| if shift > 0.0 { number.next_down() } else { number.next_up() };
    match missing * shift.signum() {
        missing if missing > 0.0 => (onward(sum), sum),
        missing if missing < 0.0 => (sum, back(sum)),
        _ => (sum, sum),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> StateBox {
        let ends = vec![[1.0, 3.0], [0.0, 0.5]];
        StateBox { quantities: vec![Quantity::Position(2), Quantity::Friction(0)], inner: ends.clone(), ends }
    }

    #[test]
    fn a_corner_lies_in_its_direction() {
        assert_eq!(example().corner(&[-0.1, 2.0]), [1.0, 0.5]);
        assert_eq!(example().corner(&[0.0, f64::NAN]), example().center());
    }

    #[test]
    fn the_box_is_covered_and_its_corners_lie_in_it() {
        // 1.3229729102424725 + 0.05 is not an f64: the nearest f64 lies above it.
        let (value, width) = (1.322_972_910_242_472_5, 0.05);
        let (beyond, short) = around(value, width);
        assert_eq!(beyond, short.next_up());
        assert!(beyond - value > width || short - value <= width);
        assert_eq!(around(1.0, -0.5), (0.5, 0.5));
    }

    #[test]
    fn halves_cover_the_whole_and_end_where_f64_ends() {
        let [left, right] = example().halves(0).expect("a wide interval");
        assert_eq!((left.ends[0], right.ends[0]), ([1.0, 2.0], [2.0, 3.0]));
        let ends = vec![[1.0, 1.0f64.next_up()]];
        let thin = StateBox { quantities: vec![Quantity::Position(2)], inner: ends.clone(), ends };
        assert_eq!(thin.halves(0), None);
    }

    #[test]
    fn a_number_covers_its_interval() {
        let number: Affine<2> = example().number(Quantity::Friction(0), 9.0);
        assert_eq!((crate::scalar::Ordered::to_f64(number), number.slopes()[1] >= 0.25), (0.25, true));
        let certain: Affine<2> = example().number(Quantity::Velocity(0), 9.0);
        assert_eq!(certain, Affine::from_f64(9.0));
    }
}
