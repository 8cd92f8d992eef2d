//! Reads the vertices of collision meshes.
//!
//! ```text
//!     file name --fetch, the caller's--> bytes --by the name's ending--> stl | obj | collada --> vertices
//! ```
//!
//! The caller resolves a name, once for each file, and supplies the bytes, which are limited. A mesh that is missing or
//! cannot be read is left out of its link with a reason, because robots often come without some of their meshes.

mod collada;
mod obj;
mod stl;

use super::{Description, Geometry};
use std::collections::HashMap;
use std::sync::Arc;

/// The most bytes of all meshes of a robot that are read.
const MOST_BYTES: usize = 256 << 20;
/// The beginning of a Git LFS pointer.
const LFS_POINTER: &[u8] = b"version https://git-lfs";

/// The vertices of a mesh, or why there are none, as in `no such file`.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// [`Description::read_meshes`] was not called.
    Unread,
    /// It has none that serve.
    LeftOut {
        /// Why, in words.
        why: String,
    },
    /// In the mesh's own frame, before any factor of the URDF \[m\]; all are finite, there is at least one.
    Vertices(Arc<[[f64; 3]]>),
}

/// The bytes of the file that a mesh name refers to, or why there are none, as in `no such file`.
pub type Fetched = std::result::Result<Vec<u8>, String>;

impl Description {
    /// Reads the collision meshes from what `fetch` finds under their names: STL (whose vertices are f32), OBJ and
    /// COLLADA (DAE), by the ending of the name. A mesh that cannot be read is kept as [`Mesh::LeftOut`], and
    /// [`Robot::left_out`](crate::Robot::left_out) and a caution give the reason.
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

/// The vertices in the bytes of a file, which are added to the sum of `all`. Or why it cannot be read.
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
