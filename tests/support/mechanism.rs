//! Planar mechanisms in two forms: as a URDF with any of their links as the root, and as velocities of their points.
//! From the latter, M = sum m J^T J + I w^T w is summed body by body, without recursion.
//!
//! All geometry is stored in world coordinates with every joint at zero. A link's frame is at the joint that leads to
//! the link, or at the link's own anchor if it is the root. Another root therefore moves frames and reverses joints,
//! but moves no mass. q and v are x, z and pitch of link 0's frame at its anchor, then one entry per joint.

use super::urdf::{self, Axis};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use serde_json::{Value, json};

/// A point of the plane: forward, up \[m\].
pub type Point = [f64; 2];

/// A body of the mechanism and the joint of the same name that connects it to an earlier link; link 0 has no joint.
#[derive(Debug, Clone)]
pub struct Link {
    pub name: String,
    pub parent: usize,
    /// Position of the joint.
    pub place: Point,
    pub kind: Axis,
    /// The mimicked joint, multiplier and offset.
    pub follows: Option<(String, f64, f64)>,
    /// Mass \[kg\]; 0 for a link without inertial.
    pub mass: f64,
    pub com: Point,
    /// Moment of inertia, about every axis \[kg m^2\].
    pub moment: f64,
    /// Origin of the link's frame if the link is the root.
    pub anchor: Point,
    /// Pitch of the axes of the link's frame \[rad\].
    pub turn: f64,
    /// Collision spheres: center, radius \[m\].
    pub spheres: Vec<(Point, f64)>,
}

#[derive(Debug, Clone)]
pub struct Mechanism {
    pub links: Vec<Link>,
}

/// The pitch and the position of every link, each with its rate.
struct Poses {
    pitch: Vec<[f64; 2]>,
    /// Of the link's point that is at the world's origin if all joints are at zero.
    origin: Vec<[Point; 2]>,
}

fn plus([a, b]: Point, [x, z]: Point) -> Point {
    [a + x, b + z]
}

fn minus([a, b]: Point, [x, z]: Point) -> Point {
    [a - x, b - z]
}

/// Rotates a vector by a pitch; a positive pitch turns forward to down.
pub fn turned([x, z]: Point, pitch: f64) -> Point {
    let (sin, cos) = pitch.sin_cos();
    [cos * x + sin * z, cos * z - sin * x]
}

/// The velocity of the end of an arm that turns at `rate`.
fn swept([x, z]: Point, rate: f64) -> Point {
    [rate * z, -rate * x]
}

/// A point of a link in the JSON of states.
pub fn point(link: &str, [x, z]: Point) -> Value {
    json!({"link": link, "offset": [x, 0.0, z]})
}

impl Link {
    fn new(name: &str, parent: usize, place: Point, mass: f64, com: Point, moment: f64) -> Self {
        let (kind, name) = (Axis::Revolute(1.0), name.to_owned());
        let (anchor, turn, spheres) = ([0.0; 2], 0.0, Vec::new());
        Self { name, parent, place, kind, follows: None, mass, com, moment, anchor, turn, spheres }
    }

    pub fn moves(&self) -> bool {
        matches!(self.kind, Axis::Revolute(_) | Axis::Prismatic(_))
    }
}

impl Mechanism {
    /// A single link, the root, with its frame at the world's origin.
    pub fn of(mass: f64, com: Point, moment: f64) -> Self {
        Self { links: vec![Link::new("root", 0, [0.0; 2], mass, com, moment)] }
    }

    /// Adds a link behind a hinge: its frame is at `origin` in the parent's frame, its CoG at `com` in its own, and its
    /// moment of inertia is 0.02 m^2 times its mass.
    pub fn with(mut self, name: &str, parent: &str, origin: Point, mass: f64, com: Point) -> Self {
        let parent = self.index(parent);
        let place = plus(self.links[parent].place, origin);
        self.links.push(Link::new(name, parent, place, mass, plus(place, com), 0.02 * mass));
        self
    }

    /// Changes the last link.
    pub fn but(mut self, change: impl FnOnce(&mut Link)) -> Self {
        change(self.links.last_mut().expect("a link"));
        self
    }

    /// Makes the last joint follow another one.
    pub fn following(self, mimicked: &str, multiplier: f64, offset: f64) -> Self {
        self.but(|link| link.follows = Some((mimicked.to_owned(), multiplier, offset)))
    }

    fn index(&self, name: &str) -> usize {
        self.links.iter().position(|link| link.name == name).expect("a link of this name")
    }

    /// Changes all points of all links.
    fn map_points(&mut self, change: impl Fn(Point) -> Point) {
        for link in &mut self.links {
            let spheres = link.spheres.iter_mut().map(|(center, _)| center);
            for point in spheres.chain([&mut link.place, &mut link.com, &mut link.anchor]) {
                *point = change(*point);
            }
        }
    }

    /// The same mechanism in other units; `mass` and `length` are the sizes of the old units in the new ones.
    pub fn in_units(&self, mass: f64, length: f64) -> Self {
        let mut other = self.clone();
        other.map_points(|point| point.map(|entry| entry * length));
        for link in &mut other.links {
            link.mass *= mass;
            link.moment *= mass * length * length;
            link.spheres.iter_mut().for_each(|(_, radius)| *radius *= length);
        }
        other
    }

    /// Per coordinate the number of new length units in an old one, or 1 for an angle.
    pub fn units_of_coordinates(&self, length: f64) -> Vec<f64> {
        let joints = self.links[1..].iter().map(|link| matches!(link.kind, Axis::Prismatic(_)));
        [true, true, false].into_iter().chain(joints).map(|slides| if slides { length } else { 1.0 }).collect()
    }

    /// Parent and child of a link's joint in the tree with this root.
    fn ends(&self, link: usize, root: usize) -> [usize; 2] {
        let mut way = std::iter::successors(Some(root), |&at| (at > 0).then(|| self.links[at].parent));
        let parent = self.links[link].parent;
        if way.any(|at| at == link) { [link, parent] } else { [parent, link] }
    }

    /// Origins of the links' frames with all joints at zero.
    fn frames(&self, root: usize) -> Vec<Point> {
        let mut frames: Vec<Point> = self.links.iter().map(|link| link.anchor).collect();
        for (index, link) in self.links.iter().enumerate().skip(1) {
            frames[self.ends(index, root)[1]] = link.place;
        }
        frames
    }

    /// Converts a point, given with all joints at zero, from the world to a link's frame.
    fn local(&self, frames: &[Point], link: usize, point: Point) -> Point {
        turned(minus(point, frames[link]), -self.links[link].turn)
    }

    /// The URDF with this link as the root.
    pub fn urdf(&self, root: usize) -> String {
        let frames = self.frames(root);
        let along = |[x, z]: Point| format!("{x} 0 {z}");
        let link = |(index, Link { name, mass, com, moment, spheres, .. }): (usize, &Link)| {
            let sphere = |&(center, radius): &(Point, f64)| {
                urdf::collision(self.local(&frames, index, center), &format!("sphere radius=\"{radius}\""))
            };
            let spheres: String = spheres.iter().map(sphere).collect();
            if *mass == 0.0 {
                return format!("<link name=\"{name}\">{spheres}</link>\n");
            }
            urdf::link(name, *mass, self.local(&frames, index, *com), *moment, &spheres)
        };
        let joint = |(index, link): (usize, &Link)| {
            let [parent, child] = self.ends(index, root);
            let (turn, sign) = (self.links[child].turn, if child == index { 1.0 } else { -1.0 });
            let (kind, axis) = match link.kind {
                Axis::Revolute(about) => ("continuous", format!("0 {} 0", sign * about)),
                Axis::Prismatic(direction) => ("prismatic", along(turned(direction, -turn).map(|entry| sign * entry))),
                Axis::Fixed => ("fixed", along([1.0, 0.0])),
                Axis::OffPlane => ("continuous", along(turned([0.0, sign], -turn))),
            };
            let limit = "<limit lower=\"-9\" upper=\"9\" effort=\"1\" velocity=\"1\"/>";
            let mimic = link.follows.as_ref().map_or(String::new(), |(mimicked, multiplier, offset)| {
                format!("<mimic joint=\"{mimicked}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>")
            });
            format!(
                "<joint name=\"{}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/>\
                 <origin xyz=\"{}\" rpy=\"0 {} 0\"/><axis xyz=\"{axis}\"/>{}{mimic}</joint>\n",
                link.name,
                self.links[parent].name,
                self.links[child].name,
                along(self.local(&frames, parent, link.place)),
                turn - self.links[parent].turn,
                if kind == "prismatic" { limit } else { "" }
            )
        };
        let links = self.links.iter().enumerate();
        urdf::robot(&links.clone().map(link).chain(links.skip(1).map(joint)).collect::<Vec<_>>())
    }

    /// Positions of all links and their rates.
    fn poses(&self, q: &[f64], v: &[f64]) -> Poses {
        // q[2] is the pitch of the frame, which exceeds that of the stored geometry by `turn`.
        let (pitch, arm) = (q[2] - self.links[0].turn, self.links[0].anchor);
        let arm = turned(arm, pitch);
        let origin = [minus([q[0], q[1]], arm), minus([v[0], v[1]], swept(arm, v[2]))];
        let mut poses = Poses { pitch: vec![[pitch, v[2]]], origin: vec![origin] };
        for (link, (&q, &v)) in self.links.iter().skip(1).zip(q[3..].iter().zip(&v[3..])) {
            let [pitch, rate] = poses.pitch[link.parent];
            let [place, speed] = poses.point(link.parent, link.place);
            let (pitch, rate, place, speed) = match link.kind {
                Axis::Revolute(about) => (pitch + about * q, rate + about * v, place, speed),
                Axis::Prismatic(along) => {
                    let along = turned(along, pitch);
                    let shift = along.map(|entry| q * entry);
                    let shifts = plus(along.map(|entry| v * entry), swept(shift, rate));
                    (pitch, rate, plus(place, shift), plus(speed, shifts))
                }
                Axis::Fixed | Axis::OffPlane => (pitch, rate, place, speed),
            };
            let arm = turned(link.place, pitch);
            poses.pitch.push([pitch, rate]);
            poses.origin.push([minus(place, arm), minus(speed, swept(arm, rate))]);
        }
        poses
    }

    /// Position of a link's point, which is given by its position with all joints at zero.
    pub fn point(&self, q: &[f64], link: usize, point: Point) -> Point {
        self.poses(q, q).point(link, point)[0]
    }

    /// Evaluates `of` for a unit rate of each coordinate; one column per coordinate.
    fn rates<const ROWS: usize>(&self, q: &[f64], of: impl Fn(&Poses) -> [f64; ROWS]) -> DMatrix<f64> {
        let unit = |column: usize| -> Vec<f64> { (0..q.len()).map(|k| f64::from(k == column)).collect() };
        let columns = (0..q.len()).map(|column| DVector::from_row_slice(&of(&self.poses(q, &unit(column)))));
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    /// Jacobian (2 rows) of a point that is given in a link's frame.
    pub fn point_rates(&self, q: &[f64], name: &str, offset: Point) -> DMatrix<f64> {
        let link = self.index(name);
        self.rates(q, |poses| poses.point(link, plus(self.links[link].place, offset))[1])
    }

    /// The mass matrix in the coordinates of all joints, as if none followed another.
    pub fn mass_matrix(&self, q: &[f64]) -> DMatrix<f64> {
        let bodies = self.links.iter().enumerate().map(|(index, link)| {
            let rates = self.rates(q, |poses| {
                let [x, z] = poses.point(index, link.com)[1];
                [x, z, poses.pitch[index][1]]
            });
            let inertia = DVector::from_vec(vec![link.mass, link.mass, link.moment]);
            rates.transpose() * DMatrix::from_diagonal(&inertia) * rates
        });
        bodies.reduce(|sum, body| sum + body).expect("a body")
    }

    /// Computes the coordinates of all joints from those of the independent ones, and the map T of v_all = T v.
    pub fn tied(&self, q: &[f64]) -> (Vec<f64>, DMatrix<f64>) {
        let independent = |link: &&Link| link.follows.is_none();
        let columns: Vec<&str> = self.links[1..].iter().filter(independent).map(|link| link.name.as_str()).collect();
        let mut all = q[..3].to_vec();
        let mut map = DMatrix::identity(2 + self.links.len(), 3 + columns.len());
        for (row, link) in (3..).zip(&self.links[1..]) {
            let own = (link.name.clone(), 1.0, 0.0);
            let (mimicked, multiplier, offset) = link.follows.as_ref().unwrap_or(&own);
            let column = 3 + columns.iter().position(|name| name == mimicked).expect("an independent joint");
            all.push(multiplier * q[column] + offset);
            map.row_mut(row).fill(0.0);
            map[(row, column)] = *multiplier;
        }
        (all, map)
    }

    /// The ends of a loop, as JSON for the URDF with this root: a point of one link, and the point of `other` that
    /// coincides with it at q.
    pub fn meeting(&self, root: usize, q: &[f64], (link, at): (usize, Point), other: usize) -> Value {
        let frames = self.frames(root);
        let poses = self.poses(q, q);
        let there = poses.point(link, at)[0];
        let there = turned(minus(there, poses.origin[other][0]), -poses.pitch[other][0]);
        let end = |link: usize, at| point(&self.links[link].name, self.local(&frames, link, at));
        json!({"a": end(link, at), "b": end(other, there)})
    }

    /// The state as JSON for the URDF with this root, with contacts (link, point, radius).
    pub fn state(&self, root: usize, q: &[f64], v: &[f64], contacts: &[(usize, Point, f64)]) -> Value {
        let (frames, poses) = (self.frames(root), self.poses(q, v));
        let [place, speed] = poses.point(root, self.links[root].anchor);
        let [pitch, rate] = poses.pitch[root];
        let part = |[x, z]: Point, pitch: f64, values: &[f64]| {
            let moving = self.links.iter().skip(1).zip(&values[3..]);
            let moving = moving.filter(|(link, _)| link.moves() && link.follows.is_none());
            let joints: Value = moving.map(|(link, value)| (link.name.clone(), json!(value))).collect();
            json!({"base": {"x": x, "z": z, "pitch": pitch}, "joints": joints})
        };
        let contact = |&(link, at, radius): &(usize, Point, f64)| {
            let mut contact = point(&self.links[link].name, self.local(&frames, link, at));
            contact["radius"] = json!(radius);
            contact
        };
        json!({
            "position": part(place, pitch + self.links[root].turn, q),
            "velocity": part(speed, rate, v),
            "contacts": contacts.iter().map(contact).collect::<Vec<_>>(),
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
        Link { anchor, turn, spheres, ..Link::new("link0", 0, [0.0; 2], mass, com, moment) }
    }
}

prop_compose! {
    fn jointed()(
        parent in any::<prop::sample::Index>(),
        place in prop::array::uniform2(-0.6..0.6f64),
        what in 0..10u8,
        sign in prop::bool::ANY,
        angle in -3.0..3.0f64,
        link in link(),
    ) -> (prop::sample::Index, Link) {
        let kind = match what {
            0 | 1 => Axis::Fixed,
            2 => Axis::OffPlane,
            3 => Axis::Prismatic(turned([1.0, 0.0], angle)),
            _ => Axis::Revolute(if sign { 1.0 } else { -1.0 }),
        };
        (parent, Link { place, kind, ..link })
    }
}

prop_compose! {
    /// A random tree of 3 to 8 links; only links on joints that do not move may be massless.
    pub fn mechanism()(root in link(), parts in prop::collection::vec(jointed(), 2..8)) -> Mechanism {
        let mut links = vec![Link { mass: root.mass + 1.0, ..root }];
        for (parent, link) in parts {
            let mass = if link.moves() { link.mass.max(0.3) } else { link.mass };
            let (name, parent) = (format!("link{}", links.len()), parent.index(links.len()));
            links.push(Link { name, parent, mass, ..link });
        }
        Mechanism { links }
    }
}

/// Random coordinates or rates: base entries below `base` and entries of `joints` joints below `range` in magnitude.
pub fn motion(joints: usize, base: f64, range: f64) -> impl Strategy<Value = Vec<f64>> {
    let joints = prop::collection::vec(-range..range, joints);
    (prop::array::uniform3(-base..base), joints).prop_map(|(base, joints)| [&base[..], &joints].concat())
}
