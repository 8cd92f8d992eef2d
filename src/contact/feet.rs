//! The robot's shapes that may touch the ground, prepared once.

use crate::planar::Vector;
use crate::robot::{FootShape, Robot};
use crate::state::NamedContact;
use std::collections::HashSet;
use std::sync::Arc;

/// One shape that may touch the ground.
#[derive(Debug, Clone)]
pub struct Foot {
    /// Index into [`Robot::links`] of the link that carries the shape.
    pub link: usize,
    /// Index of the body to which the shape is fixed.
    pub body: usize,
    /// The outline in the body's frame.
    pub outline: FootShape,
    /// The center in the link's own 3-D frame \[m\], if the foot was named there; `None` for a shape of the robot.
    pub offset: Option<[f64; 3]>,
    /// Center and radius of a circle about the outline, in the body's frame \[m\].
    pub bounding_circle: (Vector<f64>, f64),
    /// Largest height above the lowest corner for the rest of an almost level sole \[m\]; 0 for an exact outline.
    pub bumps: f64,
}

/// [`Foot::bumps`] of a mesh, as a fraction of the robot's size.
const BUMPS: f64 = 1e-4;

/// All shapes that may touch, in the order of the robot's links, and the robot's size.
#[derive(Debug, Clone)]
pub struct Feet {
    feet: Vec<Foot>,
    /// Names of the robot's links.
    names: Vec<Arc<str>>,
    /// Separator between the name of a link and the number of one of its contacts: one slash, or more if other links
    /// have names that end like this.
    slashes: String,
    size: f64,
}

impl Feet {
    /// Creates the feet of a robot from its collision shapes and from `named` points, which are detected like shapes.
    pub fn new(robot: &Robot, named: &[NamedContact]) -> Self {
        let mut feet = Vec::new();
        for (index, link) in robot.links.iter().enumerate() {
            let points =
                named.iter().filter(|contact| contact.link == index).map(|&NamedContact { offset, radius, .. }| {
                    (FootShape::disc(link.point(offset), radius), Some(offset))
                });
            let outlines = link.shapes.iter().map(|shape| (shape.clone(), None)).chain(points);
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

    /// Returns the name of contact `at` of a link with several contacts: `link/0`, or `link//0` if another link is
    /// called `link/0`.
    pub fn numbered(&self, link: &str, at: usize) -> String {
        format!("{link}{}{at}", self.slashes)
    }

    /// Returns the name of a link.
    pub(super) fn name(&self, link: usize) -> Arc<str> {
        Arc::clone(&self.names[link])
    }

    /// Returns the same feet, except that soles of meshes may be a little uneven, because vertices are rounded.
    pub fn uneven(mut self) -> Self {
        let bumps = BUMPS * self.size;
        self.feet.iter_mut().filter(|foot| foot.outline.mesh.is_some()).for_each(|foot| foot.bumps = bumps);
        self
    }

    /// Returns the same feet with infinite bounding circles, so that none is skipped for its height.
    pub fn reaching_everywhere(mut self) -> Self {
        for foot in &mut self.feet {
            foot.bounding_circle.1 = f64::INFINITY;
        }
        self
    }

    /// Returns the feet, link by link.
    pub fn iter(&self) -> impl Iterator<Item = &Foot> {
        self.feet.iter()
    }

    /// Returns the greatest distance from the root's origin to a foot or center of gravity with all joints at zero
    /// \[m\]; 1 m if the robot is a single point.
    pub fn size(&self) -> f64 {
        self.size
    }
}
