//! One pre-impact state: coordinates, velocities and scene, with all names resolved to indices of a robot.

mod ground;
mod named;
mod scene;
mod oddities;
mod checks;

pub(crate) use checks::{
    LOOP_LIMIT, PLACED_BY_JOINTS, bolted, check_contacts, check_restitution, check_slope, coordinate_place,
    placed_twice,
};
pub use ground::{Ground, Profile};
pub(crate) use named::Entries;
pub use named::Named;
pub use oddities::OutsideLimits;
pub(crate) use oddities::rough_friction;
pub use scene::{
    AppliedImpulse, ByLink, LinkPoint, NamedContact, NamedLoop, Scene, SpringEnd, SpringLaw, VirtualSpring,
};

use crate::error::{Error, Reason, Result};
use crate::law::Friction;
use crate::robot::Robot;

/// A state just before the impact. Every name in it is resolved to an index of its robot.
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
    /// The user's name for the state: a JSON string or number.
    pub id: Option<serde_json::Value>,
    /// q = [x, z, pitch, joints...] \[m, rad\]. With a stance, x and z are placeholders until the base is placed.
    pub position: Vec<f64>,
    /// v = dq/dt \[m/s, rad/s\]. With a stance, those of x and z are placeholders, too.
    pub velocity: Vec<f64>,
    /// Everything that is not position or velocity.
    pub scene: Scene,
    /// Half-widths of the uncertain numbers; `None` if all are exact.
    pub uncertainty: Option<Uncertainty>,
}

impl State {
    /// Creates the state of a robot at rest, with every coordinate zero, on level ground without a friction value.
    pub fn zero(robot: &Robot) -> Self {
        Self { position: vec![0.0; robot.dofs()], velocity: vec![0.0; robot.dofs()], ..Self::default() }
    }

    /// Sets a coordinate by its name: x, z or pitch of the base \[m, rad\], or a joint \[rad, m\].
    ///
    /// # Errors
    /// Returns [`Reason::UnknownName`] if the name is none of [`Robot::coordinates`], and [`Reason::Inconsistent`] if
    /// the list is neither empty nor as long as the robot has coordinates.
    pub fn set_position(&mut self, robot: &Robot, name: &str, value: f64) -> Result<()> {
        set(&mut self.position, "position", robot, name, value)
    }

    /// Sets the rate of a coordinate by its name \[m/s, rad/s\], with the errors of [`State::set_position`].
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

/// Half-widths: each number of the state may be anything within its half-width of the given value. All half-widths are
/// finite and not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// For q, by coordinate \[m, rad\]. Those of the base's x and z have no effect: an impact depends on neither.
    pub position: Vec<f64>,
    /// For v, by coordinate \[m/s, rad/s\]. With a stance, those of the base's x and z have no effect.
    pub velocity: Vec<f64>,
    /// For the friction of each contact's link. Friction does not go below zero, and infinite friction is certain.
    pub friction: ByLink<f64>,
    /// For the rotor inertia, by joint and then, if given, by mimic joint \[kg m^2\]; empty for none. It does not go
    /// below zero.
    pub rotor_inertia: Vec<f64>,
}

impl Uncertainty {
    /// Returns a note if all half-widths are zero.
    pub(crate) fn without_width(&self) -> Option<String> {
        let friction = self.friction.default.iter().chain(self.friction.links.values());
        let mut widths = self.position.iter().chain(&self.velocity).chain(&self.rotor_inertia).chain(friction);
        widths
            .all(|&width| width == 0.0)
            .then(|| "every half-width of the uncertainty is 0: its box is the state alone".to_owned())
    }
}

/// Values for states that do not give their own.
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
    /// Friction of every link for which the state gives none.
    pub friction: Option<Friction>,
    /// Whether states without a stance put their lowest foot on the ground ([`Scene::place_lowest`]).
    pub place_lowest: bool,
    /// Loops of every state without loops of its own.
    pub loops: Vec<NamedLoop>,
}
