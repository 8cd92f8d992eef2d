//! The robot and the options that shape it.

use super::Failure;
use super::diagnostic::note;
use super::input::InputFile;
use super::meshes::Meshes;
use super::options::ReductionOptions;
use clap::ValueEnum;
use heelstrike::description::Description;
use heelstrike::robot::{self, Reduction};
use heelstrike::state::NamedContact;
use heelstrike::{Error, Reason, Robot};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// The largest URDF file that is read \[bytes\].
const LARGEST: u64 = 64 << 20;

/// The robot's file and what is added to it.
#[derive(Debug, clap::Args)]
pub(super) struct RobotOptions {
    /// The robot's URDF file
    #[arg(value_name = "ROBOT.urdf")]
    pub robot: PathBuf,
    /// The plane that the robot moves in, forward before up in its root link's axes
    #[arg(long, value_enum, default_value_t = Plane::Auto, help_heading = "Robot")]
    pub plane: Plane,
    /// Fix a joint at this value (rad or m); the plane is judged in this configuration [repeatable]
    #[arg(long, value_name = "JOINT=VALUE", allow_hyphen_values = true, help_heading = "Robot")]
    pub hold: Vec<Hold>,
    /// Whether the root link moves freely or is fixed to the world [default: as masses and joints suggest]
    #[arg(long, value_enum, help_heading = "Robot")]
    pub base: Option<Base>,
    /// A folder that holds packages, or is one, for meshes named by package:// [repeatable]
    #[arg(long, value_name = "DIR", help_heading = "Robot")]
    pub package_path: Vec<PathBuf>,
    /// Add a foot: a point of a link, or a circle about it [repeatable]
    #[arg(long, value_name = "LINK:X,Y,Z[:RADIUS]", allow_hyphen_values = true, help_heading = "Robot")]
    pub contact: Vec<Foot>,
    #[command(flatten)]
    pub reductions: ReductionOptions,
}

/// The plane that the robot moves in.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Plane {
    /// The one in which all revolute joints turn, else x-z
    Auto,
    /// x forward, z up
    Xz,
    /// y forward, z up
    Yz,
    /// x forward, y up
    Xy,
}

impl From<Plane> for Option<robot::Plane> {
    fn from(plane: Plane) -> Self {
        match plane {
            Plane::Auto => None,
            Plane::Xz => Some(robot::Plane::XZ),
            Plane::Yz => Some(robot::Plane::YZ),
            Plane::Xy => Some(robot::Plane::XY),
        }
    }
}

/// A joint that is fixed at a value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hold {
    joint: String,
    value: f64,
}

impl FromStr for Hold {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // From the right, because a joint's name may hold equals signs.
        let (joint, value) =
            text.rsplit_once('=').ok_or_else(|| "expected JOINT=VALUE, as in left_hip_roll=0.1".to_owned())?;
        Ok(Self { joint: joint.to_owned(), value: finite(value)? })
    }
}

/// How the root link is held.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Base {
    /// It is fixed to the world
    Fixed,
    /// It moves freely
    Floating,
}

impl From<Base> for robot::Base {
    fn from(base: Base) -> Self {
        match base {
            Base::Fixed => Self::Fixed,
            Base::Floating => Self::Floating,
        }
    }
}

/// A foot given by `--contact`; its height decides whether it touches, as for a shape of the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Foot {
    link: String,
    offset: [f64; 3],
    radius: f64,
}

impl FromStr for Foot {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let shape = || "expected LINK:X,Y,Z or LINK:X,Y,Z:RADIUS, as in left_foot:0,0,-0.5:0.03".to_owned();
        // From the right, because a link's name may hold colons.
        let (head, tail) = text.rsplit_once(':').ok_or_else(shape)?;
        let (link, offset, radius) = if tail.contains(',') {
            (head, tail, 0.0)
        } else {
            let (link, offset) = head.rsplit_once(':').ok_or_else(shape)?;
            (link, offset, finite(tail)?)
        };
        if radius < 0.0 {
            return Err(format!("the radius must be 0 or more, not {radius}"));
        }
        let offset: Vec<f64> = offset.split(',').map(finite).collect::<Result<_, _>>()?;
        let offset = offset.try_into().map_err(|_| shape())?;
        Ok(Self { link: link.to_owned(), offset, radius })
    }
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("\"{text}\" is not a finite number"))
}

impl RobotOptions {
    /// The robot of this file, with all options at their defaults.
    pub fn of_file(robot: &Path) -> Self {
        Self {
            robot: robot.to_owned(),
            plane: Plane::Auto,
            hold: Vec::new(),
            base: None,
            package_path: Vec::new(),
            contact: Vec::new(),
            reductions: ReductionOptions::default(),
        }
    }

    /// Reads the robot and notes its cautions.
    pub fn load(&self) -> Result<Robot, Failure> {
        let robot = self.read()?;
        caution(&robot);
        Ok(robot)
    }

    /// Reads the robot.
    pub fn read(&self) -> Result<Robot, Failure> {
        self.described().map(|(_, _, robot)| robot)
    }

    /// Reads the robot, with the description that it was reduced from.
    pub fn described(&self) -> Result<(Description, Reduction, Robot), Failure> {
        let input = InputFile::read(&self.robot, LARGEST)?;
        let text = input.text().map_err(|error| error.in_file(&input.name))?;
        let refuse = |error: Error| input.refuse(error);
        let mut description = Description::from_urdf(text).map_err(refuse)?;
        let meshes = Meshes::of(&self.robot, &self.package_path);
        description.read_meshes(|name| meshes.fetch(name)).map_err(refuse)?;
        let reduction = Reduction {
            plane: self.plane.into(),
            hold: self.held(&description)?,
            base: self.base.map(Into::into),
            reductions: self.reductions.reductions(),
        };
        let robot = Robot::reduce(&description, &reduction).map_err(refuse)?;
        Ok((description, reduction, robot))
    }

    /// The joints given by `--hold`.
    fn held(&self, description: &Description) -> Result<Vec<(usize, f64)>, Failure> {
        let held = |hold: &Hold| {
            let joint = description.joint(&hold.joint).ok_or_else(|| {
                let reason = Reason::UnknownName { what: "joint", name: hold.joint.clone() };
                let known = description.joints.iter().map(|joint| joint.name.as_str());
                Failure::Usage(Error::new(reason).at("--hold").did_you_mean(&hold.joint, known))
            })?;
            Ok((joint, hold.value))
        };
        self.hold.iter().map(held).collect()
    }

    /// The feet given by `--contact`.
    pub fn feet(&self, robot: &Robot) -> Result<Vec<NamedContact>, Failure> {
        let foot = |foot: &Foot| {
            let link = robot.link(&foot.link).ok_or_else(|| {
                let reason = robot.no_link(&foot.link);
                let known = robot.links.iter().map(|link| link.name.as_str());
                Failure::Usage(Error::new(reason).at("--contact").did_you_mean(&foot.link, known))
            })?;
            Ok(NamedContact { link, offset: foot.offset, radius: foot.radius })
        };
        self.contact.iter().map(foot).collect()
    }
}

/// Notes what a user must know before trusting the model.
pub(super) fn caution(robot: &Robot) {
    robot.reading.cautions.iter().for_each(|caution| note(caution));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_are_read_from_the_right() {
        let foot = |link: &str, offset, radius| Ok(Foot { link: link.to_owned(), offset, radius });
        assert_eq!("foot:0,-1,2".parse(), foot("foot", [0.0, -1.0, 2.0], 0.0));
        assert_eq!("ns:foot:0,0,-0.5:0.03".parse(), foot("ns:foot", [0.0, 0.0, -0.5], 0.03));
    }

    #[test]
    fn held_joints_are_read_from_the_right() {
        assert_eq!("a=b=-0.5".parse(), Ok(Hold { joint: "a=b".to_owned(), value: -0.5 }));
        for text in ["hip", "hip=", "hip=x", "hip=nan", "hip=inf"] {
            assert!(text.parse::<Hold>().is_err(), "{text}");
        }
    }

    #[test]
    fn malformed_feet_are_refused() {
        for text in ["foot", "foot:1", "foot:1,2", "foot:1,2,3,4", "foot:1,2,nan", "foot:1,2,3:-1", "foot:1,2,3:inf"] {
            assert!(text.parse::<Foot>().is_err(), "{text}");
        }
    }
}
