//! Wavefront OBJ -> vertices (the only user of tobj).

use tobj::LoadOptions;

/// Largest accepted size \[bytes\]: a face of three bytes takes a hundred bytes in memory.
const LARGEST: usize = 16 << 20;

/// Returns the vertices that faces and lines use \[m\] with all digits. The error is the reason for a failure.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    if bytes.len() > LARGEST {
        return Err(format!("more than {} MiB of OBJ text", LARGEST >> 20));
    }
    // Names and comments may be in any encoding.
    let text = String::from_utf8_lossy(bytes);
    let no_material = |_: &std::path::Path| Ok(Default::default());
    let options = LoadOptions::default();
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &options, no_material).map_err(|error| error.to_string())?;
    let positions = models.iter().flat_map(|model| model.mesh.positions.chunks_exact(3));
    Ok(positions.filter_map(|position| position.try_into().ok()).collect())
}
