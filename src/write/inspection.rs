//! What was read of a robot: the reduced planar robot with every digit as JSON, or as text.

mod text;

use super::Palette;
use super::result::LeftOutRecord;
use crate::Robot;
use crate::planar::Vector;
use crate::robot::{self, Axis, Base, FootShape, FreezeReason, ParentJoint, Rim};
use crate::state::NamedContact;
use serde::Serialize;

/// The reduced robot as it is written; what is proven refers to these numbers.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// use heelstrike::{Inspection, Robot};
///
/// let robot = Robot::from_urdf(urdf)?;
/// assert!(serde_json::to_string(&Inspection::new(&robot, &[])).is_ok());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Serialize)]
pub struct Inspection<'a> {
    /// The robot's name in the file.
    pub name: &'a str,
    /// Forward and up in the file's root frame.
    pub plane: &'static str,
    /// Why this plane.
    pub plane_because: String,
    /// `floating` or `fixed`.
    pub base: &'static str,
    /// Why it is.
    pub base_because: &'a str,
    /// What a user must know before trusting the rest, with the remedy.
    pub cautions: &'a [String],
    /// Total mass \[kg\].
    pub mass: f64,
    /// Names of the coordinates in the order of q.
    pub coordinates: Vec<&'a str>,
    /// Rigid bodies; a parent comes before its children.
    pub bodies: Vec<Body<'a>>,
    /// Moving joints in the file's order.
    pub joints: Vec<Joint<'a>>,
    /// Joints that follow these, in the file's order; they have no coordinate of their own.
    pub followers: Vec<Follower<'a>>,
    /// Joints of the file that have no coordinate, in its order.
    pub held: Vec<Held<'a>>,
    /// Links in the file's order.
    pub links: Vec<Link<'a>>,
    /// Shapes that can touch the ground, in the links' order.
    pub feet: Vec<Foot<'a>>,
    /// What of the file does not enter the analysis, and why.
    pub left_out: Vec<LeftOutRecord<'a>>,
}

/// Links that no moving joint separates.
#[derive(Debug, Clone, Serialize)]
pub struct Body<'a> {
    /// The link that carries its frame.
    pub name: &'a str,
    /// Its links in the file's order.
    pub links: Vec<&'a str>,
    /// Mass \[kg\].
    pub mass: f64,
    /// CoG in the body's frame \[m\].
    pub com: Vector<f64>,
    /// Moment of inertia about the plane's normal through the CoG \[kg m^2\].
    pub moment: f64,
    /// The body that it is rigid on, where links are not welded.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed_to: Option<&'a str>,
    /// Its origin in that body's frame \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Vector<f64>>,
}

/// A joint that moves in the plane.
#[derive(Debug, Clone, Serialize)]
pub struct Joint<'a> {
    /// Its name.
    pub name: &'a str,
    /// `turn` or `slide`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Its parent body.
    pub parent: &'a str,
    /// The body it moves.
    pub child: &'a str,
    /// Its origin in the parent body's frame at coordinate zero \[m\].
    pub origin: Vector<f64>,
    /// Of a turn: +1 about the plane's normal, -1 against it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sign: Option<f64>,
    /// Of a slide: the unit vector of its motion in the parent body's frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Vector<f64>>,
}

/// A joint that follows another (mimic): q = multiplier q_leader + offset.
#[derive(Debug, Clone, Serialize)]
pub struct Follower<'a> {
    /// What it is as a joint.
    #[serde(flatten)]
    pub joint: Joint<'a>,
    /// The joint that it follows.
    pub leader: &'a str,
    /// How much it moves for a unit of its leader.
    pub multiplier: f64,
    /// Its coordinate where the leader's is zero \[rad, m\].
    pub offset: f64,
}

/// A joint of the file that has no coordinate.
#[derive(Debug, Clone, Serialize)]
pub struct Held<'a> {
    /// Its name.
    pub name: &'a str,
    /// The body that its child is welded into.
    pub body: &'a str,
    /// Why it has none.
    pub why: String,
    #[serde(skip)]
    still: &'a FreezeReason,
}

/// A link of the file.
#[derive(Debug, Clone, Serialize)]
pub struct Link<'a> {
    /// Its name.
    pub name: &'a str,
    /// The body it belongs to.
    pub body: &'a str,
    /// Whether the file gives it an inertial; without one it is massless.
    pub has_inertial: bool,
}

/// A shape that can touch the ground.
#[derive(Debug, Clone, Serialize)]
pub struct Foot<'a> {
    /// Its link.
    pub link: &'a str,
    /// The body whose frame it is given in.
    pub body: &'a str,
    /// `disc` or `polygon`.
    pub shape: &'static str,
    /// Of a disc \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre: Option<Vector<f64>>,
    /// Of a disc, 0 for a point, and of the circle that sweeps a polygon \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Of a polygon \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<&'a [Vector<f64>]>,
    /// Of a polygon swept by an ellipse (a cylinder oblique to the plane): two of its conjugate half diameters \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_diameters: Option<[Vector<f64>; 2]>,
    /// The file of the mesh whose hull it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<&'a str>,
}

impl<'a> Inspection<'a> {
    /// All that is known about `robot`, with `feet` beside its own.
    pub fn new(robot: &'a Robot, feet: &[NamedContact]) -> Self {
        let body_name = |body: usize| robot.bodies[body].name.as_str();
        let bodies = robot.bodies.iter().enumerate().map(|(at, body)| {
            let weld = match body.joint {
                Some(ParentJoint::Fixed { parent, origin }) => Some((body_name(parent), origin)),
                _ => None,
            };
            Body {
                name: &body.name,
                links: robot.links.iter().filter(|link| link.body == at).map(|link| link.name.as_str()).collect(),
                mass: body.mass,
                com: body.com,
                moment: body.moment,
                fixed_to: weld.map(|(parent, _)| parent),
                origin: weld.map(|(_, origin)| origin),
            }
        });
        let joint = |&robot::Joint { ref name, parent, child, origin, axis }: &'a robot::Joint| {
            let (kind, sign, direction) = match axis {
                Axis::Revolute { sign } => ("turn", Some(sign), None),
                Axis::Prismatic { direction } => ("slide", None, Some(direction)),
            };
            Joint { name, kind, parent: body_name(parent), child: body_name(child), origin, sign, direction }
        };
        let joints = robot.joints.iter().map(joint);
        let followers = robot.mimic_joints.iter().map(|mimic| {
            let leader = &robot.joints[mimic.mimicked].name;
            Follower { joint: joint(&mimic.joint), leader, multiplier: mimic.multiplier, offset: mimic.offset }
        });
        let reading = &robot.reading;
        let held = reading.frozen.iter();
        let feet = robot.links.iter().enumerate().flat_map(|(at, link)| {
            let given = feet.iter().filter(move |foot| foot.link == at);
            let given = given.map(|foot| Foot::disc(robot, link, link.point(foot.offset), foot.radius));
            link.shapes.iter().map(|shape| Foot::new(robot, link, shape)).chain(given)
        });
        let links = robot.links.iter();
        Self {
            name: &robot.name,
            plane: reading.plane.name(),
            plane_because: reading.plane_in_words(),
            base: match robot.base {
                Base::Floating => "floating",
                Base::Fixed => "fixed",
            },
            base_because: &reading.base_because,
            cautions: &reading.cautions,
            mass: robot.mass(),
            coordinates: robot.coordinates().collect(),
            bodies: bodies.collect(),
            joints: joints.collect(),
            followers: followers.collect(),
            held: held
                .map(|held| Held {
                    name: &held.name,
                    body: &held.body,
                    why: held.reason.to_string(),
                    still: &held.reason,
                })
                .collect(),
            links: links
                .map(|link| Link { name: &link.name, body: body_name(link.body), has_inertial: link.has_inertial })
                .collect(),
            feet: feet.collect(),
            left_out: LeftOutRecord::all(robot),
        }
    }

    /// The same as text, with a line break at its end.
    pub fn text(&self, palette: &Palette) -> String {
        text::text(self, palette)
    }
}

impl<'a> Foot<'a> {
    fn in_words(&self) -> String {
        let corners = self.corners.map_or(1, <[_]>::len);
        let shape = match (corners, self.radius, self.half_diameters) {
            (_, _, Some(_)) => "oblique cylinder".to_owned(),
            (1, Some(radius), _) if radius > 0.0 => format!("circle of radius {radius} m"),
            (1, ..) => "point".to_owned(),
            (2, Some(radius), _) => format!("capsule of radius {radius} m"),
            (2, ..) => "line".to_owned(),
            (_, Some(radius), _) => format!("polygon of {corners} corners rounded by {radius} m"),
            _ => format!("polygon of {corners} corners"),
        };
        self.mesh.map_or(shape.clone(), |mesh| format!("{shape} from {mesh}"))
    }

    fn new(robot: &'a Robot, link: &'a robot::Link, shape: &'a FootShape) -> Self {
        let (radius, half_diameters) = match shape.rim {
            Rim::Circle { radius } => (radius, None),
            Rim::Ellipse { half_diameters } => (0.0, Some(half_diameters)),
        };
        match shape.corners() {
            &[centre] if half_diameters.is_none() => {
                Self { mesh: shape.mesh.as_deref(), ..Self::disc(robot, link, centre, radius) }
            }
            corners => Self {
                link: &link.name,
                body: &robot.bodies[link.body].name,
                shape: "polygon",
                centre: None,
                radius: (radius > 0.0).then_some(radius),
                corners: Some(corners),
                half_diameters,
                mesh: shape.mesh.as_deref(),
            },
        }
    }

    fn disc(robot: &'a Robot, link: &'a robot::Link, centre: Vector<f64>, radius: f64) -> Self {
        let body = &robot.bodies[link.body].name;
        Self {
            link: &link.name,
            body,
            shape: "disc",
            centre: Some(centre),
            radius: Some(radius),
            corners: None,
            half_diameters: None,
            mesh: None,
        }
    }
}
