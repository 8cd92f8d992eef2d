//! Bodies that are rigid on each other although they are kept apart (see
//! [`Reductions::weld`](crate::reductions::Reductions)).

use super::composite::{Part, composite};
use super::{Base, ParentJoint, Robot};
use crate::planar::Vector;

impl Robot {
    /// Whether a body can move: not the root of a bolted robot, nor what is welded to it.
    pub(super) fn moves(&self, body: usize) -> bool {
        if self.base == Base::Floating {
            return true;
        }
        let mut at = body;
        while let Some(ParentJoint::Fixed { parent, .. }) = self.bodies[at].joint {
            at = parent;
        }
        self.bodies[at].joint.is_some()
    }

    /// The CoG of each body together with all that is welded to it, in its frame \[m\]; `None` for a body that is fixed
    /// to another.
    pub(crate) fn centres(&self) -> Vec<Option<Vector<f64>>> {
        let mut parts: Vec<Vec<Part>> = vec![Vec::new(); self.bodies.len()];
        // The body that each is rigid on in the end, and its own origin there.
        let mut grounds: Vec<(usize, Vector<f64>)> = Vec::with_capacity(self.bodies.len());
        for (index, body) in self.bodies.iter().enumerate() {
            let (ground, place) = match body.joint {
                Some(ParentJoint::Fixed { parent, origin }) => (grounds[parent].0, grounds[parent].1 + origin),
                _ => (index, Vector::zero()),
            };
            grounds.push((ground, place));
            parts[ground].push(Part::point(body.mass, place + body.com));
        }
        let centre = |(index, parts): (usize, &Vec<Part>)| (grounds[index].0 == index).then(|| composite(parts).1);
        parts.iter().enumerate().map(centre).collect()
    }
}
