//! The robot's file and the options that change the robot.

use super::Failure;
use super::diagnostic::note_all;
use super::input::InputFile;
use super::meshes::Meshes;
use super::options::{Choices, ReductionOptions, choice, from_zero};
use crate::description::Description;
use crate::robot::{Base, Plane, Reduction};
use crate::state::NamedContact;
use crate::{Error, Reason, Robot};
use std::path::PathBuf;

/// The robot's file and what is added to it.
#[derive(Debug, Default, clap::Args)]
pub(super) struct RobotOptions {
    /// The robot's URDF file
    #[arg(value_name = "ROBOT.urdf")]
    pub robot: PathBuf,
    /// The plane that the robot moves in, forward before up in its root link's axes
    #[arg(long, value_parser = choice(PLANES), default_value = "auto", help_heading = "Robot")]
    pub plane: ChosenPlane,
    /// Fix a joint at this value (rad or m); the plane is judged in this configuration (repeatable)
    #[arg(long, value_name = "JOINT=VALUE", value_parser = hold, allow_hyphen_values = true, help_heading = "Robot")]
    pub hold: Vec<Hold>,
    /// Whether the root link moves freely or is fixed to the world [default: as masses and joints suggest]
    #[arg(long, value_parser = choice(BASES), help_heading = "Robot")]
    pub base: Option<Base>,
    /// How far the axis of a joint may be off the plane's normal, in rad, and count as normal to it [default: 0.001]
    #[arg(long, value_name = "ANGLE", value_parser = tolerance, allow_hyphen_values = true, help_heading = "Robot")]
    pub axis_tolerance: Option<f64>,
    /// A folder that holds packages, or is one, for meshes named by package:// (repeatable)
    #[arg(long, value_name = "DIR", help_heading = "Robot")]
    pub package_path: Vec<PathBuf>,
    /// Add a foot: a point of a link, or a circle about it (repeatable)
    #[arg(long, value_name = "LINK:X,Y,Z[:RADIUS]", value_parser = added_foot, allow_hyphen_values = true)]
    #[arg(help_heading = "Robot")]
    pub contact: Vec<AddedFoot>,
    #[command(flatten)]
    pub reductions: ReductionOptions,
}

/// A plane, or `None` to choose it by the robot.
type ChosenPlane = Option<Plane>;

/// The values of `--plane`: the planes in which a robot may move.
pub const PLANES: Choices<ChosenPlane> = &[
    ("auto", "The one in which all revolute joints turn, else the one in which most of the legs turn", None),
    ("xz", "x forward, z up", Some(Plane::XZ)),
    ("yz", "y forward, z up", Some(Plane::YZ)),
    ("xy", "x forward, y up", Some(Plane::XY)),
    ("zy", "z forward, y up", Some(Plane::ZY)),
    ("zx", "z forward, x up", Some(Plane::ZX)),
    ("yx", "y forward, x up", Some(Plane::YX)),
];

/// The values of `--base`: whether the root link is fixed.
pub const BASES: Choices<Base> =
    &[("fixed", "It is fixed to the world", Base::Fixed), ("floating", "It moves freely", Base::Floating)];

/// A joint that is frozen at a value \[rad or m\].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hold {
    joint: String,
    value: f64,
}

/// Parses an angle from 0 to [`Reduction::WIDEST_TOLERANCE`] \[rad\].
fn tolerance(text: &str) -> Result<f64, String> {
    match from_zero(text)? {
        angle if angle <= Reduction::WIDEST_TOLERANCE => Ok(angle),
        _ => Err(format!("expected at most {} rad", Reduction::WIDEST_TOLERANCE)),
    }
}

/// Parses JOINT=VALUE.
fn hold(text: &str) -> Result<Hold, String> {
    // From the right, because a joint's name may contain equals signs.
    let (joint, value) = text.rsplit_once('=').ok_or("expected JOINT=VALUE, as in left_hip_roll=0.1")?;
    Ok(Hold { joint: joint.to_owned(), value: finite(value)? })
}

/// A foot given by `--contact`. Like a shape of the URDF, it is a contact only if it is close enough to the ground.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AddedFoot {
    link: String,
    offset: [f64; 3],
    radius: f64,
}

/// Parses LINK:X,Y,Z or LINK:X,Y,Z:RADIUS.
fn added_foot(text: &str) -> Result<AddedFoot, String> {
    let shape = "expected LINK:X,Y,Z or LINK:X,Y,Z:RADIUS, as in left_foot:0,0,-0.5:0.03";
    // From the right, because a link's name may contain colons.
    let (mut link, mut offset) = text.rsplit_once(':').ok_or(shape)?;
    let mut radius = 0.0;
    if !offset.contains(',') {
        radius = finite(offset)?;
        (link, offset) = link.rsplit_once(':').ok_or(shape)?;
    }
    if radius < 0.0 {
        return Err(format!("the radius must be 0 or more, not {radius}"));
    }
    let offset: Vec<f64> = offset.split(',').map(finite).collect::<Result<_, _>>()?;
    Ok(AddedFoot { link: link.to_owned(), offset: offset.try_into().map_err(|_| shape)?, radius })
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("\"{text}\" is not a finite number"))
}

impl RobotOptions {
    /// Reads the robot and notes its cautions.
    pub fn load(&self) -> Result<Robot, Failure> {
        let (_, _, robot) = self.described()?;
        note_all(robot.reading.cautions.clone());
        Ok(robot)
    }

    /// Reads the robot, and returns it with the description and the reduction that it comes from.
    pub fn described(&self) -> Result<(Description, Reduction, Robot), Failure> {
        let input = InputFile::read(&self.robot, InputFile::LARGE)?;
        let text = input.text().map_err(|error| error.in_file(&input.name))?;
        let refuse = |error: Error| input.refuse(error);
        let mut description = Description::from_urdf(text).map_err(refuse)?;
        if let Some(folder) = self.package_path.iter().find(|folder| !folder.is_dir()) {
            let reason = format!("there is no folder {}", folder.display());
            return Err(Failure::Usage(Error::new(Reason::Io(reason)).at("--package-path")));
        }
        Meshes::of(&self.robot, &self.package_path).read(&mut description);
        let reduction = Reduction {
            plane: self.plane,
            hold: self.held(&description)?,
            base: self.base,
            axis_tolerance: self.axis_tolerance,
            reductions: self.reductions.reductions(),
        };
        let robot = Robot::reduce(&description, &reduction).map_err(refuse)?;
        Ok((description, reduction, robot))
    }

    /// Returns the joints given by `--hold`, as indices into the description, with their values.
    fn held(&self, description: &Description) -> Result<Vec<(usize, f64)>, Failure> {
        let refuse = |reason| Error::new(reason).at("--hold");
        let held = |(at, Hold { joint, value }): (usize, &Hold)| {
            if self.hold[..at].iter().any(|before| before.joint == *joint) {
                return Err(refuse(Reason::Duplicate { what: "joint", name: joint.clone() }));
            }
            let known = description.joints.iter().map(|joint| joint.name.as_str());
            let unknown = || refuse(Reason::UnknownName { what: "joint", name: joint.clone() });
            Ok((description.joint(joint).ok_or_else(|| unknown().did_you_mean(joint, known))?, *value))
        };
        self.hold.iter().enumerate().map(held).collect::<crate::Result<_>>().map_err(Failure::Usage)
    }

    /// Returns the feet given by `--contact`.
    pub fn feet(&self, robot: &Robot) -> Result<Vec<NamedContact>, Failure> {
        let refuse = |reason| Error::new(reason).at("--contact");
        if let Some((_, twice)) = self.contact.iter().enumerate().find(|(at, foot)| self.contact[..*at].contains(foot))
        {
            let name = twice.link.clone();
            return Err(Failure::Usage(refuse(Reason::Duplicate { what: "foot on link", name })));
        }
        let foot = |&AddedFoot { ref link, offset, radius }: &AddedFoot| {
            let known = robot.links.iter().map(|link| link.name.as_str());
            let unknown = || Failure::Usage(refuse(robot.no_link(link)).did_you_mean(link, known));
            let link = robot.link(link).ok_or_else(unknown)?;
            let foot = NamedContact { link, offset, radius };
            note_all(foot.out_of_scale(robot));
            Ok(foot)
        };
        self.contact.iter().map(foot).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_and_held_joints_are_read_from_the_right() {
        let foot = |link: &str, offset, radius| Ok(AddedFoot { link: link.to_owned(), offset, radius });
        assert_eq!(added_foot("foot:0,-1,2"), foot("foot", [0.0, -1.0, 2.0], 0.0));
        assert_eq!(added_foot("ns:foot:0,0,-0.5:0.03"), foot("ns:foot", [0.0, 0.0, -0.5], 0.03));
        assert_eq!(hold("a=b=-0.5"), Ok(Hold { joint: "a=b".to_owned(), value: -0.5 }));
        for text in ["hip", "hip=", "hip=x", "hip=nan", "hip=inf"] {
            assert!(hold(text).is_err(), "{text}");
        }
        for text in ["foot", "foot:1", "foot:1,2", "foot:1,2,3,4", "foot:1,2,nan", "foot:1,2,3:-1", "foot:1,2,3:inf"] {
            assert!(added_foot(text).is_err(), "{text}");
        }
    }
}
