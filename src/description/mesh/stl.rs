//! STL, binary and ASCII -> vertices (the only user of mesh-loader).

use std::borrow::Cow;

/// What stands before the triangles of a binary file: 80 bytes for anybody, and their number \[byte\].
const HEADER: usize = 84;
/// A triangle of a binary file \[byte\].
const TRIANGLE: usize = 50;

/// The corners of all triangles \[m\], each as often as it is written. Or why there are none.
pub(super) fn vertices(bytes: &[u8]) -> Result<Vec<[f64; 3]>, String> {
    let scene = mesh_loader::stl::from_slice(&tidied(bytes)?).map_err(|error| error.to_string())?;
    Ok(scene.meshes.iter().flat_map(|mesh| &mesh.vertices).map(|vertex| vertex.map(f64::from)).collect())
}

/// ASCII in small letters, as some programs write it in capitals, and with a name, which mesh-loader wants; binary
/// without what follows its last triangle, and not beginning with "solid", by which mesh-loader takes it for ASCII if
/// a byte of its number of triangles is a line break (the feet of Solo and Bolt). A binary file that is cut short is
/// refused: mesh-loader would read what is there.
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
