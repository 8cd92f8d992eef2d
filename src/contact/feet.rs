//! The robot's shapes that may touch, compiled once.

use crate::planar::Vector;
use crate::robot::{FootShape, Robot};
use crate::state::NamedContact;
use std::collections::HashSet;
use std::sync::Arc;

/// One shape that may touch the ground.
#[derive(Debug, Clone)]
pub struct Foot {
    /// The link that carries it (an index into [`Robot::links`]).
    pub link: usize,
    /// The body that it is rigid on.
    pub body: usize,
    /// Its outline in the body's frame.
    pub outline: FootShape,
    /// The center of a foot that was named, in the link's own 3-D frame \[m\].
    pub offset: Option<[f64; 3]>,
    /// Center and radius of a circle about its outline, in the body's frame \[m\].
    pub bounding_circle: (Vector<f64>, f64),
    /// How far above its lowest corner the rest of an almost level sole may be \[m\]; 0 for an outline that is exact.
    pub bumps: f64,
}

/// [`Foot::bumps`] of a mesh, as part of the robot's size.
const BUMPS: f64 = 1e-4;

/// All shapes that may touch, in the order of the robot's links, and the robot's size.
#[derive(Debug, Clone)]
pub struct Feet {
    feet: Vec<Foot>,
    /// Of the robot's links.
    names: Vec<Arc<str>>,
    /// What stands between the name of a link and the number of one of its contacts.
    slashes: String,
    size: f64,
}

impl Feet {
    /// The feet of a robot: its collision shapes, and `named` ones that are detected like them.
    pub fn new(robot: &Robot, named: &[NamedContact]) -> Self {
        let mut feet = Vec::new();
        for (index, link) in robot.links.iter().enumerate() {
            let own =
                named.iter().filter(|contact| contact.link == index).map(|&NamedContact { offset, radius, .. }| {
                    (FootShape::disc(link.point(offset), radius), Some(offset))
                });
            let outlines = link.shapes.iter().map(|shape| (shape.clone(), None)).chain(own);
            feet.extend(outlines.map(|(outline, offset)| {
                let bounding_circle = outline.bounding_circle();
                Foot { link: index, body: link.body, outline, offset, bounding_circle, bumps: 0.0 }
            }));
        }
        let size = robot.size(feet.iter().map(|foot| (foot.body, &foot.outline)));
        let names: HashSet<&str> = robot.links.iter().map(|link| link.name.as_str()).collect();
        let mut slashes = "/".to_owned();
        let is_number_of_other = |name: &str, slashes: &str| {
            let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
            stem.strip_suffix(slashes).is_some_and(|stem| names.contains(stem))
        };
        while names.iter().any(|name| is_number_of_other(name, &slashes)) {
            slashes.push('/');
        }
        let names = robot.links.iter().map(|link| link.name.as_str().into()).collect();
        Self { feet, names, slashes, size }
    }

    /// The name of contact `at` of a link that has several: `link/0`, or `link//0` if other links are called so.
    pub fn numbered(&self, link: &str, at: usize) -> String {
        format!("{link}{}{at}", self.slashes)
    }

    /// The name of a link.
    pub(super) fn name(&self, link: usize) -> Arc<str> {
        Arc::clone(&self.names[link])
    }

    /// The same feet with soles of meshes that may be a little uneven, because their vertices are rounded.
    pub fn uneven(mut self) -> Self {
        let bumps = BUMPS * self.size;
        self.feet.iter_mut().filter(|foot| foot.outline.mesh.is_some()).for_each(|foot| foot.bumps = bumps);
        self
    }

    /// The same feet, each of which reaches everywhere: none is passed over for its height.
    pub fn reaching_everywhere(mut self) -> Self {
        for foot in &mut self.feet {
            foot.bounding_circle.1 = f64::INFINITY;
        }
        self
    }

    /// The feet, link by link.
    pub fn iter(&self) -> impl Iterator<Item = &Foot> {
        self.feet.iter()
    }

    /// The greatest distance from the root's origin to a foot or CoG with all joints at zero \[m\]; of a
    /// robot that is one point 1 m.
    pub fn size(&self) -> f64 {
        self.size
    }
}
