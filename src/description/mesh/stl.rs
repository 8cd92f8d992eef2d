//! STL, binary and ASCII -> vertices (the only user of mesh-loader).

/// The corners of all triangles \[m\], each as often as it is written. Or why there are none.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let scene = mesh_loader::stl::from_slice(bytes).map_err(|error| error.to_string())?;
    Ok(scene.meshes.iter().flat_map(|mesh| &mesh.vertices).map(|vertex| vertex.map(f64::from)).collect())
}
