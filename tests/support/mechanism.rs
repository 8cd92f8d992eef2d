//! Random mechanisms in the plane, written as a URDF from any of their links as the root.
//!
//! All geometry is kept in the world where every joint is at zero; a frame stands at the joint that leads to its link
//! (at the link's own anchor for the root), so that another root moves frames, turns joints round, and moves no matter.

use std::fmt::Write;

use proptest::prelude::*;
use serde_json::{Value, json};

/// A point of the plane: forward, up \[m\].
pub type Point = [f64; 2];

/// A body of the mechanism; link 0 is the root that it was drawn from.
#[derive(Debug, Clone)]
pub struct Link {
    /// Mass \[kg\]; 0 for a link without inertial.
    pub mass: f64,
    pub com: Point,
    /// Moment of inertia, about every axis \[kg m^2\].
    pub moment: f64,
    /// Where the frame stands while the link is the root.
    pub anchor: Point,
    /// Pitch of the frame's axes \[rad\].
    pub turn: f64,
    /// Collision spheres: centre, radius \[m\].
    pub spheres: Vec<(Point, f64)>,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// About the plane's normal: +1 or -1.
    Turn(f64),
    /// Along this direction, of length one.
    Slide(Point),
    /// Not at all.
    Fixed,
    /// About the vertical axis, out of the plane: held at zero.
    OffPlane,
}

/// Joint `k` ties link `k` + 1 to an earlier one.
#[derive(Debug, Clone)]
pub struct Joint {
    pub parent: usize,
    pub place: Point,
    pub kind: Kind,
}

#[derive(Debug, Clone)]
pub struct Mechanism {
    pub links: Vec<Link>,
    pub joints: Vec<Joint>,
}

/// Coordinates, or their rates: the root's x, z and pitch for the frame at its anchor, then an entry per joint.
#[derive(Debug, Clone)]
pub struct Motion {
    pub base: [f64; 3],
    pub joints: Vec<f64>,
}

/// The pitch and the place of every link, each with its rate.
struct Poses {
    pitch: Vec<[f64; 2]>,
    /// Of the point that is at the world's origin where all joints are at zero.
    origin: Vec<[Point; 2]>,
}

fn plus([a, b]: Point, [x, z]: Point) -> Point {
    [a + x, b + z]
}

fn minus([a, b]: Point, [x, z]: Point) -> Point {
    [a - x, b - z]
}

/// Turned by a pitch, which tips forward down.
fn turned([x, z]: Point, pitch: f64) -> Point {
    let (sin, cos) = pitch.sin_cos();
    [cos * x + sin * z, cos * z - sin * x]
}

/// The velocity of an arm that turns.
fn swept([x, z]: Point, rate: f64) -> Point {
    [rate * z, -rate * x]
}

impl Mechanism {
    /// Whether a joint has a coordinate.
    pub fn moves(&self, joint: usize) -> bool {
        matches!(self.joints[joint].kind, Kind::Turn(_) | Kind::Slide(_))
    }

    /// Joints in the order of a walk from `root`, each with whether it is passed from its child to its parent.
    fn outward(&self, root: usize) -> Vec<(usize, bool)> {
        let mut order = Vec::new();
        let mut reached = vec![root];
        let mut next = 0;
        while let Some(&link) = reached.get(next) {
            next += 1;
            for (index, joint) in self.joints.iter().enumerate() {
                let far = if joint.parent == link { index + 1 } else { joint.parent };
                let touches = joint.parent == link || index + 1 == link;
                if touches && !reached.contains(&far) {
                    order.push((index, joint.parent != link));
                    reached.push(far);
                }
            }
        }
        order
    }

    /// Where each link's frame stands in the world of zero.
    fn frames(&self, root: usize) -> Vec<Point> {
        let mut frames: Vec<Point> = self.links.iter().map(|link| link.anchor).collect();
        for (joint, back) in self.outward(root) {
            let child = if back { self.joints[joint].parent } else { joint + 1 };
            frames[child] = self.joints[joint].place;
        }
        frames
    }

    /// A point of the world of zero in a link's frame.
    fn local(&self, frames: &[Point], link: usize, point: Point) -> [f64; 3] {
        let [x, z] = turned(minus(point, frames[link]), -self.links[link].turn);
        [x, 0.0, z]
    }

    /// The URDF with this root; joints and links are named by their numbers.
    pub fn urdf(&self, root: usize) -> String {
        let frames = self.frames(root);
        let mut out = "<robot name=\"mechanism\">\n".to_owned();
        let triple = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
        for (index, link) in self.links.iter().enumerate() {
            let local = |point| triple(self.local(&frames, index, point));
            write!(out, "<link name=\"link{index}\">").unwrap();
            let Link { mass, com, moment, .. } = link;
            if *mass > 0.0 {
                write!(
                    out,
                    "<inertial><origin xyz=\"{}\"/><mass value=\"{mass}\"/><inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" \
                     iyy=\"{moment}\" iyz=\"0\" izz=\"{moment}\"/></inertial>",
                    local(*com)
                )
                .unwrap();
            }
            for &(centre, radius) in &link.spheres {
                let sphere = format!("<geometry><sphere radius=\"{radius}\"/></geometry>");
                write!(out, "<collision><origin xyz=\"{}\"/>{sphere}</collision>", local(centre)).unwrap();
            }
            out.push_str("</link>\n");
        }
        for (index, back) in self.outward(root) {
            let joint = &self.joints[index];
            let (parent, child) = if back { (index + 1, joint.parent) } else { (joint.parent, index + 1) };
            let turn = self.links[child].turn;
            let sign = if back { -1.0 } else { 1.0 };
            let (kind, axis) = match joint.kind {
                Kind::Turn(about) => ("continuous", [0.0, sign * about, 0.0]),
                Kind::Slide(along) => {
                    let [x, z] = turned(along, -turn);
                    ("prismatic", [sign * x, 0.0, sign * z])
                }
                Kind::Fixed => ("fixed", [1.0, 0.0, 0.0]),
                Kind::OffPlane => {
                    let [x, z] = turned([0.0, sign], -turn);
                    ("continuous", [x, 0.0, z])
                }
            };
            let limit =
                if kind == "prismatic" { "<limit lower=\"-9\" upper=\"9\" effort=\"1\" velocity=\"1\"/>" } else { "" };
            writeln!(
                out,
                "<joint name=\"joint{index}\" type=\"{kind}\"><parent link=\"link{parent}\"/><child link=\"link{child}\"/>\
                 <origin xyz=\"{}\" rpy=\"0 {} 0\"/><axis xyz=\"{}\"/>{limit}</joint>",
                triple(self.local(&frames, parent, joint.place)),
                turn - self.links[parent].turn,
                triple(axis)
            )
            .unwrap();
        }
        out.push_str("</robot>\n");
        out
    }

    /// Where all links are, from the root that the mechanism was drawn from.
    fn poses(&self, position: &Motion, velocity: &Motion) -> Poses {
        let root = &self.links[0];
        let [x, z, pitch] = position.base;
        let [dx, dz, rate] = velocity.base;
        // The frame's pitch counts, so that the matter has turned by less.
        let pitch = pitch - root.turn;
        let arm = turned(root.anchor, pitch);
        let mut poses =
            Poses { pitch: vec![[pitch, rate]], origin: vec![[minus([x, z], arm), minus([dx, dz], swept(arm, rate))]] };
        for (index, joint) in self.joints.iter().enumerate() {
            let [pitch, rate] = poses.pitch[joint.parent];
            let [place, speed] = poses.point(joint.parent, joint.place);
            let (q, v) = (position.joints[index], velocity.joints[index]);
            let (pitch, rate, place, speed) = match joint.kind {
                Kind::Turn(about) => (pitch + about * q, rate + about * v, place, speed),
                Kind::Slide(along) => {
                    let along = turned(along, pitch);
                    let shift = along.map(|entry| q * entry);
                    let shifts = plus(along.map(|entry| v * entry), swept(shift, rate));
                    (pitch, rate, plus(place, shift), plus(speed, shifts))
                }
                Kind::Fixed | Kind::OffPlane => (pitch, rate, place, speed),
            };
            let arm = turned(joint.place, pitch);
            poses.pitch.push([pitch, rate]);
            poses.origin.push([minus(place, arm), minus(speed, swept(arm, rate))]);
        }
        poses
    }

    /// The place and velocity of a link's point.
    pub fn point(&self, position: &Motion, velocity: &Motion, link: usize, point: Point) -> [Point; 2] {
        self.poses(position, velocity).point(link, point)
    }

    /// The ends of a loop, as JSON for the URDF with this root: a point of one link, and the point of another that is
    /// there in this position.
    pub fn meeting(&self, root: usize, position: &Motion, (link, point): (usize, Point), other: usize) -> Value {
        let frames = self.frames(root);
        let poses = self.poses(position, position);
        let there = poses.point(link, point)[0];
        let there = turned(minus(there, poses.origin[other][0]), -poses.pitch[other][0]);
        let end = |link, point| json!({"link": format!("link{link}"), "offset": self.local(&frames, link, point)});
        json!({"a": end(link, point), "b": end(other, there)})
    }

    /// The state, as JSON for the URDF with this root, with contacts at points of links.
    pub fn state(&self, root: usize, position: &Motion, velocity: &Motion, contacts: &[(usize, Point, f64)]) -> Value {
        let frames = self.frames(root);
        let poses = self.poses(position, velocity);
        let [place, speed] = poses.point(root, self.links[root].anchor);
        let [pitch, rate] = poses.pitch[root];
        let joints = |values: &[f64]| {
            let moving = (0..values.len()).filter(|&joint| self.moves(joint));
            Value::Object(moving.map(|joint| (format!("joint{joint}"), json!(values[joint]))).collect())
        };
        let base = |[x, z]: Point, pitch: f64| json!({"x": x, "z": z, "pitch": pitch});
        let contacts: Vec<Value> = contacts
            .iter()
            .map(|&(link, point, radius)| {
                json!({"link": format!("link{link}"), "offset": self.local(&frames, link, point), "radius": radius})
            })
            .collect();
        json!({
            "position": {"base": base(place, pitch + self.links[root].turn), "joints": joints(&position.joints)},
            "velocity": {"base": base(speed, rate), "joints": joints(&velocity.joints)},
            "contacts": contacts,
        })
    }
}

impl Poses {
    fn point(&self, link: usize, point: Point) -> [Point; 2] {
        let [pitch, rate] = self.pitch[link];
        let [place, speed] = self.origin[link];
        let arm = turned(point, pitch);
        [plus(place, arm), plus(speed, swept(arm, rate))]
    }
}

prop_compose! {
    fn link()(
        mass in prop_oneof![1 => Just(0.0), 4 => 0.2..2.0f64],
        com in prop::array::uniform2(-0.5..0.5f64),
        moment in 0.01..0.1f64,
        anchor in prop::array::uniform2(-0.3..0.3f64),
        turn in prop_oneof![Just(0.0), -3.0..3.0f64],
        low in prop::option::weighted(0.5, (prop::array::uniform2(-0.4..0.4f64), 0.01..0.1f64)),
        high in prop::option::weighted(0.3, (-0.4..0.4f64, 0.01..0.1f64)),
    ) -> Link {
        let spheres = low.into_iter().chain(high.map(|(x, radius)| ([x, 1.5], radius))).collect();
        Link { mass, com, moment, anchor, turn, spheres }
    }
}

prop_compose! {
    fn joint_and_link()(
        parent in any::<prop::sample::Index>(),
        place in prop::array::uniform2(-0.6..0.6f64),
        what in 0..10u8,
        sign in prop::bool::ANY,
        angle in -3.0..3.0f64,
        link in link(),
    ) -> (prop::sample::Index, Joint, Link) {
        let kind = match what {
            0 | 1 => Kind::Fixed,
            2 => Kind::OffPlane,
            3 => Kind::Slide(turned([1.0, 0.0], angle)),
            _ => Kind::Turn(if sign { 1.0 } else { -1.0 }),
        };
        (parent, Joint { parent: 0, place, kind }, link)
    }
}

prop_compose! {
    /// A tree of 3 to 8 links; massless ones are on joints that do not move.
    pub fn mechanism()(root in link(), parts in prop::collection::vec(joint_and_link(), 2..8)) -> Mechanism {
        let mut mechanism = Mechanism { links: vec![root], joints: Vec::new() };
        mechanism.links[0].mass += 1.0;
        for (parent, joint, mut link) in parts {
            let moves = matches!(joint.kind, Kind::Turn(_) | Kind::Slide(_));
            if moves {
                link.mass = link.mass.max(0.3);
            }
            mechanism.joints.push(Joint { parent: parent.index(mechanism.links.len()), ..joint });
            mechanism.links.push(link);
        }
        mechanism
    }
}

/// Coordinates or rates of a mechanism with `joints` joints.
pub fn motion(joints: usize, base: f64, range: f64) -> impl Strategy<Value = Motion> {
    let joints = prop::collection::vec(-range..range, joints);
    (prop::array::uniform3(-base..base), joints).prop_map(|(base, joints)| Motion { base, joints })
}
