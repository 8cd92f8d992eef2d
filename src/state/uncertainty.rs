//! How far the numbers of a state may be off.

use super::scene::ByLink;

/// Half-widths: each number of the state may be anything within its half-width of what is given. All are finite and not
/// negative.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Of q, by coordinate \[m, rad\]. Those of the base's x and z have no effect: an impact depends on neither.
    pub position: Vec<f64>,
    /// Of v, by coordinate \[m/s, rad/s\]; with a stance those of the base's x and z have no effect.
    pub velocity: Vec<f64>,
    /// Of the friction of each contact's link; it is cut off at zero, and infinite friction is certain.
    pub friction: ByLink<f64>,
    /// Of the rotor inertia, by joint \[kg m^2\]; it is cut off at zero.
    pub rotor_inertia: Vec<f64>,
}
