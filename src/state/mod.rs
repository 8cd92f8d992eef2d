//! One pre-impact state: coordinates, velocities and scene, resolved against a robot.

mod ground;
mod named;
mod scene;
mod oddities;

pub use ground::{Ground, Profile};
pub(crate) use named::Entries;
pub use named::Named;
pub use oddities::OutsideLimits;
pub use scene::{
    AppliedImpulse, ByLink, LinkPoint, NamedContact, NamedLoop, Scene, SpringEnd, SpringLaw, VirtualSpring,
};

use crate::error::{Error, Reason, Result};
use crate::law::Friction;
use crate::robot::Robot;

/// A state just before the impact; every name in it is resolved to an index of its robot.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Robot, State};
///
/// let robot = Robot::from_urdf(urdf)?;
/// let mut state = State::zero(&robot);
/// state.set_position(&robot, "hip", -0.6)?;
/// state.set_velocity(&robot, "pitch", -1.0)?;
/// assert!(state.set_position(&robot, "knee", 0.1).is_err());
/// state.velocity.truncate(2);
/// assert!(state.set_velocity(&robot, "hip", 0.1).is_err());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct State {
    /// What the user calls it: a JSON string or number.
    pub id: Option<serde_json::Value>,
    /// q = [x, z, pitch, joints...] \[m, rad\]; with a stance x and z are placeholders until the base is placed.
    pub position: Vec<f64>,
    /// v = dq/dt \[m/s, rad/s\]; with a stance its x and z are placeholders, too.
    pub velocity: Vec<f64>,
    /// Everything else.
    pub scene: Scene,
    /// How far the numbers may be off; `None` if they are exact.
    pub uncertainty: Option<Uncertainty>,
}

impl State {
    /// The robot at rest, every coordinate zero, on level ground without friction of its own.
    pub fn zero(robot: &Robot) -> Self {
        Self { position: vec![0.0; robot.dofs()], velocity: vec![0.0; robot.dofs()], ..Self::default() }
    }

    /// Sets a coordinate by its name: x, z or pitch of the base \[m, rad\], or a joint \[rad, m\].
    ///
    /// # Errors
    /// [`Reason::UnknownName`] for a name that is none of [`Robot::coordinates`], [`Reason::Inconsistent`] for a list
    /// that is neither empty nor as long as the robot has coordinates.
    pub fn set_position(&mut self, robot: &Robot, name: &str, value: f64) -> Result<()> {
        set(&mut self.position, "position", robot, name, value)
    }

    /// Sets the rate of a coordinate by its name \[m/s, rad/s\], as [`State::set_position`].
    pub fn set_velocity(&mut self, robot: &Robot, name: &str, value: f64) -> Result<()> {
        set(&mut self.velocity, "velocity", robot, name, value)
    }
}

fn set(list: &mut Vec<f64>, what: &'static str, robot: &Robot, name: &str, value: f64) -> Result<()> {
    let place = robot.coordinates().position(|known| known == name).ok_or_else(|| {
        let unknown = Reason::UnknownName { what: "coordinate", name: name.to_owned() };
        Error::new(unknown).did_you_mean(name, robot.coordinates())
    })?;
    if list.is_empty() {
        list.resize(robot.dofs(), 0.0);
    }
    check_length(what, list.len(), robot.dofs())?;
    list[place] = value;
    Ok(())
}

/// Refuses a list that is too short or too long for the robot.
pub(crate) fn check_length(place: &'static str, found: usize, wanted: usize) -> Result<()> {
    if found == wanted {
        return Ok(());
    }
    let reason = Reason::Inconsistent(format!("the robot needs {wanted} entries here, but {found} are given"));
    Err(Error::new(reason).at(place).hint("begin with State::zero, which has an entry per coordinate"))
}

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

impl Uncertainty {
    /// That its box is the state alone, in words.
    pub(crate) fn without_width(&self) -> Option<String> {
        let friction = self.friction.default.iter().chain(self.friction.links.values());
        let mut widths = self.position.iter().chain(&self.velocity).chain(&self.rotor_inertia).chain(friction);
        widths
            .all(|&width| width == 0.0)
            .then(|| "every half-width of the uncertainty is 0: its box is the state alone".to_owned())
    }
}

/// What a state takes from elsewhere if it does not give it itself.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Defaults, Friction, Robot, State};
///
/// let robot = Robot::from_urdf(urdf)?;
/// let defaults = Defaults { friction: Some(Friction::from(0.8)), ..Defaults::default() };
/// assert!(State::from_json("{}", &robot, &defaults).is_ok());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default)]
pub struct Defaults {
    /// Friction of every link to which the state gives none.
    pub friction: Option<Friction>,
    /// Whether states without a stance put their lowest foot on the ground ([`Scene::place_lowest`]).
    pub place_lowest: bool,
    /// Loops of every state that gives none of its own.
    pub loops: Vec<NamedLoop>,
}
