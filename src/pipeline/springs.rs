//! The forces of virtual springs on the joints and the base, as results list them.

use super::Pipeline;
use super::assembly::Loads;
use crate::error::{Result, finite};
use crate::planar::Pair;
use crate::state::Named;
use serde::Serialize;

/// The load that a virtual spring requires.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpringForce {
    /// The force on a along [x, z] of the world, the opposite of that on b \[N\].
    pub force: Pair<f64>,
    /// The moment on the link of a, the opposite of that on the link of b \[N m\].
    pub moment: f64,
    /// Its part of the torque of each joint \[N m, N\].
    pub torque: Named,
}

/// The load that virtual springs require on a floating base, which no joint can supply.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unrealized {
    /// The force along x of the world \[N\].
    pub fx: f64,
    /// The force along z of the world \[N\].
    pub fz: f64,
    /// The moment about the base's origin \[N m\].
    pub moment: f64,
}

/// The torques at the joints.
#[derive(Debug, Clone)]
pub struct Driven {
    /// Torque or force at each joint, virtual springs included \[N m, N\].
    pub torque: Named,
    /// The force of each virtual spring of the state.
    pub springs: Vec<SpringForce>,
    /// The sum of the springs' forces on a floating base, which is not applied. `None` without springs or such a base.
    pub unrealized: Option<Unrealized>,
}

impl Pipeline<'_> {
    /// Returns the torques at the joints; the bodies must be placed. Refuses a spring's force beyond the range of f64.
    pub(super) fn driven(&self, velocity: &[f64], loads: Loads<'_>) -> Result<Driven> {
        let [_, joints] = &self.names;
        let mut torque = loads.scene.torque.clone();
        torque.resize(joints.len(), 0.0);
        let (mut springs, mut unrealized) = (Vec::new(), None);
        for spring in self.assembly.springs(velocity, loads) {
            for &entry in spring.force.iter().chain(&spring.generalized) {
                finite(entry, || "the force of a virtual spring".into()).map_err(|error| {
                    error.at("virtual").hint("its numbers are too large for f64: are they in SI units?")
                })?;
            }
            let [x, z, moment] = spring.force;
            let (base, torques) = spring.generalized.split_at(self.robot.base_dofs());
            torque.iter_mut().zip(torques).for_each(|(sum, entry)| *sum += entry);
            if let &[x, z, about] = base {
                let Unrealized { fx, fz, moment } = unrealized.unwrap_or_default();
                unrealized = Some(Unrealized { fx: fx + x, fz: fz + z, moment: moment + about });
            }
            springs.push(SpringForce { force: [x, z], moment, torque: Named::new(joints.clone(), torques.to_vec()) });
        }
        Ok(Driven { torque: Named::new(joints.clone(), torque), springs, unrealized })
    }
}
