//! Springs, dampers and friction between a contact and the ground.
//!
//! ```text
//!     lambda_n = max(0, k_n delta - d_n c_n) where delta >= 0, else 0         Kelvin-Voigt without tension
//! lambda_t = -k_t s - d_t c_t, clamped to -+mu lambda_n                   spring and damper in series with friction
//!     delta' = -c_n     s' = -(lambda_t + k_t s) / d_t
//! ```
//!
//! delta is the depth of a contact below the ground and s the stretch of its tangential spring; both start at zero.
//! Source: Brogliato, *Nonsmooth Mechanics* (2016), section 2.1.

use crate::error::{Reason, Result, finite, from_zero};
use crate::law::Friction;
use crate::planar::Pair;
use std::cmp::Ordering;

/// The ground's parameters that matter while the configuration is frozen; all contacts have the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoftGround {
    /// d_n / (2 sqrt(k_n m)), m the inverse of the contacts' mean mobility; above 0, and infinite for dampers without
    /// springs.
    pub damping_ratio: f64,
    /// k_t / k_n, from 0 on.
    pub stiffness_ratio: f64,
    /// d_t / d_n, above 0: without a damper, the spring has no rate while the contact slips.
    pub tangential_damping: f64,
}

impl SoftGround {
    /// Refuses numbers out of their range.
    pub(super) fn check(&self) -> Result<()> {
        let Self { damping_ratio, stiffness_ratio, tangential_damping } = *self;
        from_zero(stiffness_ratio, "stiffness_ratio")?;
        finite(tangential_damping, || "tangential_damping".into())?;
        for (what, value) in [("damping_ratio", damping_ratio), ("tangential_damping", tangential_damping)] {
            // NaN is not greater either.
            if !matches!(value.partial_cmp(&0.0), Some(Ordering::Greater)) {
                return Err(Reason::OutOfRange { what: what.into(), allowed: "greater than 0", value }.into());
            }
        }
        Ok(())
    }
}

/// The friction coefficient that stands for infinite friction: without a normal force nothing holds spring and damper.
pub const GREATEST_FRICTION: f64 = 1e6;

/// The coefficients of springs, dampers and friction.
#[derive(Debug)]
pub(super) struct Suspension {
    /// k, tangential and normal.
    stiffness: Pair<f64>,
    /// d, tangential and normal.
    pub damping: Pair<f64>,
    /// mu of each contact.
    friction: Vec<f64>,
}

impl Suspension {
    /// Creates normal springs of `stiffness` and dampers of `damping`, and tangential ones by the ratios of `ground`.
    pub fn new(ground: SoftGround, stiffness: f64, damping: f64, friction: impl Iterator<Item = Friction>) -> Self {
        let bounded = |friction: Friction| match friction {
            Friction::Finite(mu) => mu.min(GREATEST_FRICTION),
            Friction::Infinite => GREATEST_FRICTION,
        };
        Self {
            stiffness: [ground.stiffness_ratio * stiffness, stiffness],
            damping: [ground.tangential_damping * damping, damping],
            friction: friction.map(bounded).collect(),
        }
    }

    /// Returns the force on `contact` and the rate of its stretch, from its depth, stretch and velocity.
    pub fn force(&self, contact: usize, depth: f64, stretch: f64, velocity: Pair<f64>) -> (Pair<f64>, f64) {
        let push = self.stiffness[1] * depth - self.damping[1] * velocity[1];
        let normal = if depth < 0.0 { 0.0 } else { push.max(0.0) };
        let bound = self.friction[contact] * normal;
        let tangential = (-self.stiffness[0] * stretch - self.damping[0] * velocity[0]).clamp(-bound, bound);
        ([tangential, normal], self.stretch_rate(tangential, stretch))
    }

    /// Returns the derivatives of the tangential and the normal force of [`Self::force`] by depth, stretch, and
    /// tangential and normal velocity.
    pub fn force_derivatives(&self, contact: usize, depth: f64, stretch: f64, velocity: Pair<f64>) -> [[f64; 4]; 2] {
        let ([tangential, normal], _) = self.force(contact, depth, stretch, velocity);
        if normal <= 0.0 {
            return [[0.0; 4]; 2];
        }
        let push = [self.stiffness[1], 0.0, 0.0, -self.damping[1]];
        let mu = self.friction[contact];
        let slips = tangential.abs() >= mu * normal;
        let along = match slips {
            true => push.map(|part| mu * part * tangential.signum()),
            false => [0.0, -self.stiffness[0], -self.damping[0], 0.0],
        };
        [along, push]
    }

    /// Returns the rate of a stretch, or its derivative from those of the tangential force and of the stretch. Spring
    /// and damper carry the force that friction allows; the rest is slip.
    pub fn stretch_rate(&self, tangential: f64, stretch: f64) -> f64 {
        -(tangential + self.stiffness[0] * stretch) / self.damping[0]
    }
}

/// Returns the geometric mean of the contacts' G_nn \[1/kg\], computed from their logarithms.
pub(super) fn mean_mobility(delassus: impl Fn(usize, usize) -> f64, contacts: usize) -> f64 {
    let logarithms = (0..contacts).map(|contact| libm::log(delassus(2 * contact + 1, 2 * contact + 1)));
    libm::exp(logarithms.sum::<f64>() / contacts.max(1) as f64)
}
