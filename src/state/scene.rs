//! The surroundings of the robot: ground, friction, restitution, braked joints, loops, impulses, gravity, torques.

use super::ground::Ground;
use crate::law::Friction;
use crate::planar::Vector;
use crate::robot::{LONGEST, Robot};
use crate::scalar::Real;
use std::collections::BTreeMap;

/// Everything about a state that is not position or velocity. Indices are those of the [`Robot`].
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Robot, Scene};
///
/// let robot = Robot::from_urdf(urdf)?;
/// let scene = Scene { stance: robot.link("left_leg"), ..Scene::default() };
/// assert!(scene.stance.is_some() && scene.contacts.is_none());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Scene {
    /// The ground that the robot strikes.
    pub ground: Ground,
    /// Friction of each contact's link; empty if neither the state nor its [`Defaults`](super::Defaults) give any.
    pub friction: ByLink<Friction>,
    /// Newton restitution of each contact's link, 0 to 1; 0 if none is given.
    pub restitution: ByLink<f64>,
    /// The link whose lowest point is placed on the ground at x = 0 and at rest.
    pub stance: Option<usize>,
    /// Whether the base is moved along z so that the lowest foot, or the lowest named contact, is on the ground. The
    /// velocity stays as given.
    pub place_lowest: bool,
    /// Joints that keep their velocity through one impact.
    pub braked: Vec<usize>,
    /// Rotor inertia of each joint and then of each mimic joint \[kg m^2\]; empty for none. It is added to the diagonal
    /// of the mass matrix, for a mimic joint times multiplier^2.
    pub rotor_inertia: Vec<f64>,
    /// The contacts that the state names; `None` if contacts are detected.
    pub contacts: Option<Vec<NamedContact>>,
    /// Pairs of points that stay together (closed loops).
    pub loops: Vec<NamedLoop>,
    /// Impulses applied at the instant of the impact.
    pub impulses: Vec<AppliedImpulse>,
    /// Gravity along -z of the world \[m/s^2\], used by forces only; `None` stands for [`Scene::GRAVITY`].
    pub gravity: Option<f64>,
    /// Torque (or force of a prismatic joint) of each joint, used by forces only \[N m, N\]; empty for none.
    pub torque: Vec<f64>,
    /// Virtual springs and dampers, which are imitated by additional joint torques; used by forces only.
    pub springs: Vec<VirtualSpring>,
}

impl Scene {
    /// Standard gravity, rounded \[m/s^2\].
    pub const GRAVITY: f64 = 9.81;

    /// Gravity along -z of the world \[m/s^2\].
    pub fn gravity(&self) -> f64 {
        self.gravity.unwrap_or(Self::GRAVITY)
    }

    /// Returns whether some link's friction is not the one that is `given` for all states.
    pub fn has_own_friction(&self, given: Option<Friction>) -> bool {
        let ByLink { default, links } = &self.friction;
        given.is_some() && (*default != given || links.values().any(|friction| Some(*friction) != given))
    }
}

/// A value per link, with a default for links that are not named.
#[derive(Debug, Clone, PartialEq)]
pub struct ByLink<T> {
    /// The value of every link that is not named.
    pub default: Option<T>,
    /// The values of named links, by index.
    pub links: BTreeMap<usize, T>,
}

/// A contact point that the user names on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedContact {
    /// The link, by index.
    pub link: usize,
    /// The point, or the center of the circle, in the link's 3-D frame \[m\].
    pub offset: [f64; 3],
    /// Radius of the circle \[m\]; 0 for a point.
    pub radius: f64,
}

impl NamedContact {
    /// Returns a note if the contact is farther from its link than any part of a legged robot.
    pub fn out_of_scale(&self, robot: &Robot) -> Option<String> {
        let link = robot.links.get(self.link).map_or("", |link| &link.name);
        let far = self.offset.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let found = match self.radius {
            _ if far > LONGEST => format!("is {far} m from its origin"),
            radius if radius > LONGEST => format!("has a radius of {radius} m"),
            _ => return None,
        };
        Some(format!("the contact of {link} {found}: lengths are in meters"))
    }
}

/// Two points of links that stay together, like a pin that URDF cannot describe because it is a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedLoop {
    /// The point on which the loop's impulse acts.
    pub a: LinkPoint,
    /// The point on which the opposite impulse acts.
    pub b: LinkPoint,
}

/// A point of a link in its 3-D frame \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkPoint {
    /// The link, by index.
    pub link: usize,
    /// The point in the link's frame \[m\].
    pub offset: [f64; 3],
}

/// A virtual spring and damper between two points. The joints supply its force as far as they can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VirtualSpring {
    /// The point on which the spring's force acts.
    pub a: LinkPoint,
    /// The point on which the opposite force acts.
    pub b: SpringEnd,
    /// Along x and along z of the world \[N, m\], and about the plane's normal, for the links' pitches \[N m, rad\].
    pub laws: [SpringLaw; 3],
}

/// The other end of a virtual spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpringEnd {
    /// A point of a link.
    Link(LinkPoint),
    /// A place in the world \[m\]; its pitch is 0.
    World(Vector<f64>),
}

/// The force of a virtual spring along one axis: constant + stiffness (target - distance) - damping rate.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SpringLaw {
    /// \[N/m\], or \[N m/rad\] about the normal.
    pub stiffness: f64,
    /// \[N s/m\], or \[N m s/rad\] about the normal.
    pub damping: f64,
    /// The distance of a from b at which the spring is slack \[m, rad\].
    pub target: f64,
    /// Additional force \[N\] or moment \[N m\].
    pub constant: f64,
}

impl SpringLaw {
    /// Returns the force on a; its `distance` from b changes at `rate`.
    pub fn force<T: Real>(&self, distance: T, rate: T) -> T {
        let [stiffness, damping, target, constant] =
            [self.stiffness, self.damping, self.target, self.constant].map(T::from_f64);
        constant + stiffness * (target - distance) - damping * rate
    }
}

/// An impulse on a point of a link during the impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedImpulse {
    /// The link, by index.
    pub link: usize,
    /// The point in the link's frame \[m\].
    pub offset: [f64; 3],
    /// The impulse `[x, z]` in the world's axes \[N s\].
    pub vector: Vector<f64>,
}

impl<T> Default for ByLink<T> {
    fn default() -> Self {
        Self { default: None, links: BTreeMap::new() }
    }
}

impl<T: Copy> ByLink<T> {
    /// Gives every link the same value.
    pub fn everywhere(value: T) -> Self {
        Self { default: Some(value), links: BTreeMap::new() }
    }

    /// Returns the value of a link; `None` if it has none and there is no default.
    pub fn of(&self, link: usize) -> Option<T> {
        self.links.get(&link).copied().or(self.default)
    }
}
