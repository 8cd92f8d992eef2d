//! What was read of a robot: the reduced planar robot with every digit as JSON, or as text.

use super::result::LeftOut;
use super::table::{Table, number, scale};
use super::text::Palette;
use crate::Robot;
use crate::planar::Vector;
use crate::robot::{self, Axis, Base, FootShape, Rim};
use crate::scene::NamedContact;
use serde::Serialize;
use std::fmt::Write;

/// The reduced robot as it is written; what is proven refers to these numbers.
#[derive(Debug, Clone, Serialize)]
pub struct Inspection<'a> {
    /// The robot's name in the file.
    pub name: &'a str,
    /// Forward and up in the file's root frame.
    pub plane: &'static str,
    /// `floating` or `fixed`.
    pub base: &'static str,
    /// Total mass \[kg\].
    pub mass: f64,
    /// Names of the coordinates in the order of q.
    pub coordinates: Vec<&'a str>,
    /// Rigid bodies; a parent comes before its children.
    pub bodies: Vec<Body<'a>>,
    /// Moving joints in the file's order.
    pub joints: Vec<Joint<'a>>,
    /// Links in the file's order.
    pub links: Vec<Link<'a>>,
    /// Shapes that can touch the ground, in the links' order.
    pub feet: Vec<Foot<'a>>,
    /// What of the file does not enter the analysis, and why.
    pub left_out: Vec<LeftOut<'a>>,
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
}

/// A joint that moves in the plane.
#[derive(Debug, Clone, Serialize)]
pub struct Joint<'a> {
    /// Its name.
    pub name: &'a str,
    /// `turn` or `slide`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// The body it hangs on.
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
        let bodies = robot.bodies.iter().enumerate().map(|(at, body)| Body {
            name: &body.name,
            links: robot.links.iter().filter(|link| link.body == at).map(|link| link.name.as_str()).collect(),
            mass: body.mass,
            com: body.com,
            moment: body.moment,
        });
        let joints = robot.joints.iter().map(|joint| {
            let (kind, sign, direction) = match joint.axis {
                Axis::Turn { sign } => ("turn", Some(sign), None),
                Axis::Slide { direction } => ("slide", None, Some(direction)),
            };
            let (parent, child) = (body_name(joint.parent), body_name(joint.child));
            Joint { name: &joint.name, kind, parent, child, origin: joint.origin, sign, direction }
        });
        let feet = robot.links.iter().enumerate().flat_map(|(at, link)| {
            let given = feet.iter().filter(move |foot| foot.link == at);
            let given = given.map(|foot| Foot::disc(robot, link, link.point(foot.offset), foot.radius));
            link.shapes.iter().map(|shape| Foot::new(robot, link, shape)).chain(given)
        });
        let links = robot.links.iter();
        Self {
            name: &robot.name,
            plane: robot.reading.plane.name(),
            base: match robot.base {
                Base::Floating => "floating",
                Base::Fixed => "fixed",
            },
            mass: robot.mass(),
            coordinates: robot.coordinates().collect(),
            bodies: bodies.collect(),
            joints: joints.collect(),
            links: links
                .map(|link| Link { name: &link.name, body: body_name(link.body), has_inertial: link.has_inertial })
                .collect(),
            feet: feet.collect(),
            left_out: LeftOut::all(robot),
        }
    }

    /// The same as text, with a line break at its end.
    pub fn text(&self, palette: &Palette) -> String {
        let mut out = String::new();
        // Writing into a string cannot fail.
        let _ = self.write_text(palette, &mut out);
        out
    }

    fn write_text(&self, palette: &Palette, out: &mut String) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *palette;
        writeln!(out, "{strong}{}{plain}", self.name)?;
        writeln!(out, "  plane        x-z: x forward, z up, pitch about +y (nose down)")?;
        writeln!(out, "  mass         {} kg", number(self.mass))?;
        let base = match self.base {
            "floating" => "floating: x, z, pitch of the root link",
            _ => "fixed: bolted to the world",
        };
        writeln!(out, "  base         {base} {}", self.bodies.first().map_or("", |body| body.name))?;
        writeln!(out, "  coordinates  {}: {}", self.coordinates.len(), self.coordinates.join(", "))?;
        writeln!(out, "  feet         {}", self.feet_in_words())?;

        writeln!(out, "\n{strong}bodies{plain}")?;
        let (bodies, joints) = (&self.bodies, &self.joints);
        let points = bodies.iter().map(|body| body.com).chain(joints.iter().map(|joint| joint.origin));
        let lengths = scale(points.flatten());
        let moments = scale(bodies.iter().map(|body| body.moment));
        Table::default()
            .text("body", bodies.iter().map(|body| body.name))
            .numbers("mass [kg]", self.mass, bodies.iter().map(|body| body.mass))
            .numbers("CoG x [m]", lengths, bodies.iter().map(|body| body.com[0]))
            .numbers("z [m]", lengths, bodies.iter().map(|body| body.com[1]))
            .numbers("moment [kg m^2]", moments, bodies.iter().map(|body| body.moment))
            .text("links", bodies.iter().map(|body| body.links.join(", ")))
            .write(out);

        if !joints.is_empty() {
            writeln!(out, "\n{strong}joints{plain}")?;
            Table::default()
                .text("joint", joints.iter().map(|joint| joint.name))
                .text("motion", joints.iter().map(Joint::in_words))
                .text("from", joints.iter().map(|joint| joint.parent))
                .text("to", joints.iter().map(|joint| joint.child))
                .numbers("origin x [m]", lengths, joints.iter().map(|joint| joint.origin[0]))
                .numbers("z [m]", lengths, joints.iter().map(|joint| joint.origin[1]))
                .write(out);
        }

        let massless: Vec<&str> = self.links.iter().filter(|link| !link.has_inertial).map(|link| link.name).collect();
        if !massless.is_empty() {
            writeln!(out, "\nWithout inertial, so massless: {}", massless.join(", "))?;
        }
        if !self.left_out.is_empty() {
            writeln!(out, "\n{strong}left out{plain}")?;
            Table::default()
                .text("what", self.left_out.iter().map(|left| &*left.what))
                .text("why", self.left_out.iter().map(|left| left.why))
                .write_body(out);
        }
        Ok(())
    }

    fn feet_in_words(&self) -> String {
        if self.feet.is_empty() {
            return "none: name them by --contact, or in each state by \"contacts\"".to_owned();
        }
        let foot = |foot: &Foot| format!("{} ({})", foot.link, foot.in_words());
        self.feet.iter().map(foot).collect::<Vec<_>>().join(", ")
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
        let (radius, half_diameters) = match shape.rim() {
            Rim::Circle { radius } => (radius, None),
            Rim::Ellipse { half_diameters } => (0.0, Some(half_diameters)),
        };
        match shape.corners() {
            &[centre] if half_diameters.is_none() => {
                Self { mesh: shape.mesh(), ..Self::disc(robot, link, centre, radius) }
            }
            corners => Self {
                link: &link.name,
                body: &robot.bodies[link.body].name,
                shape: "polygon",
                centre: None,
                radius: (radius > 0.0).then_some(radius),
                corners: Some(corners),
                half_diameters,
                mesh: shape.mesh(),
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

impl Joint<'_> {
    fn in_words(&self) -> String {
        match (self.sign, self.direction) {
            (Some(sign), _) if sign < 0.0 => "turns about -y".to_owned(),
            (Some(_), _) => "turns about +y".to_owned(),
            (_, direction) => {
                let [x, z] = direction.unwrap_or_default();
                format!("slides along ({}, {})", number(x), number(z))
            }
        }
    }
}
