//! Reads the vertices of collision meshes.
//!
//! ```text
//!     file name --fetch, the caller's--> bytes --by the name's ending--> stl | obj | collada --> vertices
//! ```
//!
//! The caller resolves each file name once and supplies the bytes, whose number is limited. A mesh that is missing or
//! unreadable is left out of its link with a reason, because robots often come without some of their meshes.

mod collada;
mod obj;
mod stl;

use super::{Description, Geometry};
use std::collections::HashMap;
use std::sync::Arc;

/// Largest total number of bytes of all meshes of a robot.
const MOST_BYTES: usize = 256 << 20;
/// The beginning of a Git LFS pointer file.
const LFS_POINTER: &[u8] = b"version https://git-lfs";

/// The vertices of a mesh, or the reason why there are none, for example `no such file`.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// [`Description::read_meshes`] was not called.
    Unread,
    /// The mesh has no usable vertices.
    LeftOut {
        /// The reason.
        why: String,
    },
    /// Vertices in the mesh's own frame, before the URDF's scale factors \[m\]. All are finite, and there is at least
    /// one.
    Vertices(Arc<[[f64; 3]]>),
}

/// The bytes of the file that a mesh name refers to, or the reason why there are none, for example `no such file`.
pub type Fetched = std::result::Result<Vec<u8>, String>;

impl Description {
    /// Reads the collision meshes. `fetch` returns the bytes for a file name. The ending of the name selects the
    /// format: STL (with vertices in f32), OBJ or COLLADA (DAE). A mesh that cannot be read becomes [`Mesh::LeftOut`];
    /// a caution and [`Robot::left_out`](crate::Robot::left_out) give the reason.
    pub fn read_meshes(&mut self, mut fetch: impl FnMut(&str) -> Fetched) {
        let mut known: HashMap<String, Mesh> = HashMap::new();
        let mut bytes = 0;
        for link in &mut self.links {
            for collision in &mut link.collisions {
                let Geometry::Mesh { file, mesh, .. } = &mut collision.geometry else { continue };
                if let Some(known) = known.get(file) {
                    mesh.clone_from(known);
                    continue;
                }
                let vertices = fetch(file).and_then(|fetched| read(file, &fetched, &mut bytes));
                *mesh = vertices.map_or_else(|why| Mesh::LeftOut { why }, |vertices| Mesh::Vertices(vertices.into()));
                known.insert(file.clone(), mesh.clone());
            }
        }
    }
}

/// Reads the vertices from the bytes of a file and adds their number to `all`. The error is the reason for a failure.
fn read(file: &str, bytes: &[u8], all: &mut usize) -> std::result::Result<Vec<[f64; 3]>, String> {
    *all = all.saturating_add(bytes.len());
    if *all > MOST_BYTES {
        return Err(format!("the meshes together have more than {} MiB", MOST_BYTES >> 20));
    }
    if bytes.starts_with(LFS_POINTER) {
        return Err("only a pointer to the file is there: fetch it by git lfs pull".into());
    }
    let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let vertices = match ending.as_deref() {
        Some("stl") => stl::vertices(bytes),
        Some("obj") => obj::vertices(bytes),
        Some("dae") => collada::vertices(bytes),
        _ => return Err("not a mesh of a kind that is read: STL, OBJ or DAE".into()),
    }
    .map_err(|why| format!("cannot be read: {why}"))?;
    match vertices.iter().flatten().find(|coordinate| !coordinate.is_finite()) {
        Some(coordinate) => Err(format!("one of its vertices has the coordinate {coordinate}")),
        None if vertices.is_empty() => Err("it has no vertices".into()),
        None => Ok(vertices),
    }
}

#[cfg(test)]
mod tests;
