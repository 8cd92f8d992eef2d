//! STL, binary and ASCII -> vertices (the only user of mesh-loader).

use std::borrow::Cow;

/// Size of the header of a binary file: 80 arbitrary bytes and the number of triangles \[bytes\].
const HEADER: usize = 84;
/// Size of a triangle in a binary file \[bytes\].
const TRIANGLE: usize = 50;

/// Returns the corners of all triangles with repetitions \[m\]. The error is the reason for a failure.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let scene = mesh_loader::stl::from_slice(&tidied(bytes)?).map_err(|error| error.to_string())?;
    Ok(scene.meshes.iter().flat_map(|mesh| &mesh.vertices).map(|vertex| vertex.map(f64::from)).collect())
}

/// Changes a file so that mesh-loader reads it correctly. ASCII text becomes lower case, because some programs write
/// capitals, and gets a name if it has none, which mesh-loader requires. A binary file loses the bytes after its last
/// triangle, and "solid" at its beginning: mesh-loader would take it for ASCII if a byte of the number of triangles is
/// a line break (as in the feet of Solo and Bolt). A truncated binary file is an error; mesh-loader would read a part.
fn tidied(bytes: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    let begin = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    let begins_as_text = begin.len() >= 5 && begin[..5].eq_ignore_ascii_case(b"solid");
    if begins_as_text && !begin.contains(&0) {
        // Names may be in any encoding.
        let plain = |byte: &u8| if byte.is_ascii() { byte.to_ascii_lowercase() } else { b'?' };
        let mut text: Vec<u8> = begin.iter().map(plain).collect();
        let name = text[5..].split(|byte| matches!(byte, b'\n' | b'\r')).next().unwrap_or_default().trim_ascii();
        let is_facet = name.strip_prefix(b"facet").is_some_and(|rest| rest.trim_ascii_start().starts_with(b"normal"));
        if name.is_empty() || is_facet {
            text.splice(5..5, *b" unnamed\n");
        }
        return Ok(text.into());
    }
    let Some(&[a, b, c, d]) = bytes.get(HEADER - 4..HEADER).and_then(|count| count.first_chunk()) else {
        return Err("it is neither ASCII STL nor long enough for binary STL".into());
    };
    let announced = u32::from_le_bytes([a, b, c, d]);
    let present = (bytes.len() - HEADER) / TRIANGLE;
    match usize::try_from(announced) {
        Ok(count) if count <= present => {
            let mut whole = Cow::from(&bytes[..HEADER + count * TRIANGLE]);
            if begins_as_text {
                whole.to_mut()[..HEADER - 4].fill(b' ');
            }
            Ok(whole)
        }
        _ => Err(format!("{announced} triangles are announced, {present} are there")),
    }
}
