//! The reduced planar robot that was read from a file: as JSON with every digit, or as text.

mod text;

use super::result::LeftOutRecord;
use crate::Robot;
use crate::planar::Vector;
use crate::robot::{Axis, Base, Body, FootShape, FreezeReason, FrozenJoint, Joint, Link, MimicJoint, ParentJoint, Rim};
use crate::state::NamedContact;
use serde::Serialize;

/// The reduced planar robot as it is written; proofs refer to these numbers. [`Report`](super::Report) has an example.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection<'a> {
    /// The robot's name in its file.
    pub name: &'a str,
    /// Axes of the file's root frame that point forward and up, as in `xz`.
    pub plane: &'static str,
    /// Axis of that frame along the plane's normal, with its sign, as in `+y`.
    #[serde(skip)]
    normal: &'static str,
    /// Why this plane was taken, in words.
    pub plane_because: String,
    /// `floating` or `fixed`.
    pub base: &'static str,
    /// Why the base is floating or fixed, in words.
    pub base_because: &'a str,
    /// Warnings to read before trusting the rest, each with its remedy.
    pub cautions: &'a [String],
    /// Total mass \[kg\].
    pub mass: f64,
    /// Names of the coordinates in the order of q.
    pub coordinates: Vec<&'a str>,
    /// Rigid bodies; a parent comes before its children.
    pub bodies: Vec<BodyRecord<'a>>,
    /// Moving joints in the file's order.
    pub joints: Vec<JointRecord<'a>>,
    /// Mimic joints, in the file's order; they have no coordinate of their own.
    pub followers: Vec<MimicRecord<'a>>,
    /// Fixed and frozen joints, in the file's order.
    pub held: Vec<FrozenRecord<'a>>,
    /// Links in the file's order.
    pub links: Vec<LinkRecord<'a>>,
    /// Shapes that can touch the ground, in the links' order.
    pub feet: Vec<FootRecord<'a>>,
    /// What the analysis leaves out, and why.
    pub left_out: Vec<LeftOutRecord<'a>>,
}

/// A body: links that no moving joint separates, in the file's order. It is named after the link that carries its
/// frame.
#[derive(Debug, Clone, Serialize)]
pub struct BodyRecord<'a> {
    /// The link that carries the body's frame.
    pub name: &'a str,
    /// All links of the body.
    pub links: Vec<&'a str>,
    /// Mass \[kg\].
    pub mass: f64,
    /// CoG in the body's frame \[m\].
    pub com: Vector<f64>,
    /// Moment of inertia about the plane's normal through the CoG \[kg m^2\].
    pub moment: f64,
    /// The body to which this one is rigidly fixed, if it is kept as a body of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fixed_to: Option<&'a str>,
    /// Origin of this body in the frame of that body \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub origin: Option<Vector<f64>>,
}

/// A joint that moves in the plane, from its parent body to the body it moves.
#[derive(Debug, Clone, Serialize)]
pub struct JointRecord<'a> {
    /// The joint's name in the file.
    pub name: &'a str,
    /// `turn` or `slide`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// The parent body.
    pub parent: &'a str,
    /// The child body, which the joint moves.
    pub child: &'a str,
    /// The joint's origin in the parent body's frame at coordinate zero \[m\].
    pub origin: Vector<f64>,
    /// Revolute joint: +1 if it turns about the plane's normal, -1 if against it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sign: Option<f64>,
    /// Prismatic joint: unit vector of its motion in the parent body's frame.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<Vector<f64>>,
}

/// A mimic joint: its coordinate is multiplier times that of the mimicked joint plus offset \[rad, m\].
#[derive(Debug, Clone, Serialize)]
pub struct MimicRecord<'a> {
    /// The joint itself.
    #[serde(flatten)]
    pub joint: JointRecord<'a>,
    /// The mimicked joint.
    #[serde(rename = "leader")]
    pub mimicked: &'a str,
    /// Change of its coordinate per unit of the mimicked joint's \[1, m/rad, rad/m\].
    pub multiplier: f64,
    /// Its coordinate where the mimicked joint's is zero \[rad, m\].
    pub offset: f64,
}

/// A joint without a coordinate, with the reason and the body that its child link belongs to.
#[derive(Debug, Clone, Serialize)]
pub struct FrozenRecord<'a> {
    /// The joint's name in the file.
    pub name: &'a str,
    /// The body that its child link belongs to.
    pub body: &'a str,
    /// Why it has no coordinate, in words.
    pub why: String,
    #[serde(skip)]
    reason: &'a FreezeReason,
}

/// A link of the file, and the body that it belongs to.
#[derive(Debug, Clone, Serialize)]
pub struct LinkRecord<'a> {
    /// The link's name in the file.
    pub name: &'a str,
    /// The body that it belongs to.
    pub body: &'a str,
    /// Whether the file gives it an inertial; without one it is massless.
    pub has_inertial: bool,
}

/// A shape that can touch the ground, given in the frame of a body.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FootRecord<'a> {
    /// The link that has the shape.
    pub link: &'a str,
    /// The body in whose frame the shape is given.
    pub body: &'a str,
    /// `disc` or `polygon`.
    pub shape: &'static str,
    /// Center of a disc \[m\].
    #[serde(rename = "centre", skip_serializing_if = "Option::is_none")]
    pub center: Option<Vector<f64>>,
    /// Radius of a disc, 0 for a point, or of the circle that sweeps a polygon \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<f64>,
    /// Corners of a polygon \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corners: Option<&'a [Vector<f64>]>,
    /// For a polygon swept by an ellipse (a cylinder oblique to the plane): two conjugate half diameters of it \[m\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub half_diameters: Option<[Vector<f64>; 2]>,
    /// The mesh file, if the shape is the hull of a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<&'a str>,
}

impl<'a> Inspection<'a> {
    /// Describes `robot`; `feet` are contacts in addition to its own shapes.
    pub fn new(robot: &'a Robot, feet: &[NamedContact]) -> Self {
        let body_name = |body: usize| robot.bodies[body].name.as_str();
        let mut links = vec![Vec::new(); robot.bodies.len()];
        robot.links.iter().for_each(|link| links[link.body].push(link.name.as_str()));
        let body = |(body, links): (&'a Body, Vec<&'a str>)| {
            let (fixed_to, origin) = match body.joint {
                Some(ParentJoint::Fixed { parent, origin }) => (Some(body_name(parent)), Some(origin)),
                _ => (None, None),
            };
            let &Body { ref name, mass, com, moment, .. } = body;
            BodyRecord { name, links, mass, com, moment, fixed_to, origin }
        };
        let joint = |&Joint { ref name, parent, child, origin, axis, .. }: &'a Joint| {
            let (kind, sign, direction) = match axis {
                Axis::Revolute { sign } => ("turn", Some(sign), None),
                Axis::Prismatic { direction } => ("slide", None, Some(direction)),
            };
            JointRecord { name, kind, parent: body_name(parent), child: body_name(child), origin, sign, direction }
        };
        let mimic = |mimic: &'a MimicJoint| {
            let mimicked = &robot.joints[mimic.mimicked].name;
            MimicRecord { joint: joint(&mimic.joint), mimicked, multiplier: mimic.multiplier, offset: mimic.offset }
        };
        let frozen = |FrozenJoint { name, reason, body, .. }: &'a FrozenJoint| FrozenRecord {
            name,
            body,
            why: reason.to_string(),
            reason,
        };
        let feet = robot.links.iter().enumerate().flat_map(|(at, link)| {
            let foot = |shape: FootRecord<'a>| FootRecord { link: &link.name, body: body_name(link.body), ..shape };
            let given = feet.iter().filter(move |foot| foot.link == at);
            let given = given.map(|foot| FootRecord::disc(link.point(foot.offset), foot.radius));
            link.shapes.iter().map(FootRecord::new).chain(given).map(foot)
        });
        let link = |link: &'a Link| {
            let &Link { ref name, body, has_inertial, .. } = link;
            LinkRecord { name, body: body_name(body), has_inertial }
        };
        Self {
            name: &robot.name,
            plane: robot.reading.plane.name(),
            normal: robot.reading.plane.normal(),
            plane_because: robot.reading.plane_in_words(),
            base: match robot.base {
                Base::Floating => "floating",
                Base::Fixed => "fixed",
            },
            base_because: &robot.reading.base_because,
            cautions: &robot.reading.cautions,
            mass: robot.mass(),
            coordinates: robot.coordinates().collect(),
            bodies: robot.bodies.iter().zip(links).map(body).collect(),
            joints: robot.joints.iter().map(joint).collect(),
            followers: robot.mimic_joints.iter().map(mimic).collect(),
            held: robot.reading.frozen.iter().map(frozen).collect(),
            links: robot.links.iter().map(link).collect(),
            feet: feet.collect(),
            left_out: LeftOutRecord::all(robot),
        }
    }
}

impl<'a> FootRecord<'a> {
    fn new(shape: &'a FootShape) -> Self {
        let polygon = |corners| Self { shape: "polygon", corners: Some(corners), ..Self::default() };
        let outline = match (shape.corners(), shape.rim) {
            (&[center], Rim::Circle { radius }) => Self::disc(center, radius),
            (corners, Rim::Circle { radius: 0.0 }) => polygon(corners),
            (corners, Rim::Circle { radius }) => Self { radius: Some(radius), ..polygon(corners) },
            (corners, Rim::Ellipse { half_diameters }) => {
                Self { half_diameters: Some(half_diameters), ..polygon(corners) }
            }
        };
        Self { mesh: shape.mesh.as_deref(), ..outline }
    }

    fn disc(center: Vector<f64>, radius: f64) -> Self {
        Self { shape: "disc", center: Some(center), radius: Some(radius), ..Self::default() }
    }

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
}
