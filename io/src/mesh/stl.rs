//! STL: triangles in binary or as text.
//!
//! ```text
//! binary   80 bytes, number of triangles (u32), for each: normal, three corners (f32, little endian), 2 bytes
//! text     solid … facet normal … outer loop  vertex x y z  vertex …  endloop endfacet … endsolid
//! ```

use nalgebra::Vector3;

/// Bytes before the first triangle, and of each.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// The corners of all triangles.
pub(super) fn points(bytes: &[u8]) -> Result<Vec<Vector3<f64>>, String> {
    match triangles(bytes) {
        // Some files in binary begin with the word, too.
        Some(count) if bytes.len() >= HEADER + TRIANGLE * count => Ok(binary(bytes, count)),
        _ if bytes.trim_ascii_start().starts_with(b"solid") && !bytes.contains(&0) => {
            text(&String::from_utf8_lossy(bytes))
        }
        Some(count) => {
            let expected = HEADER.saturating_add(TRIANGLE.saturating_mul(count));
            Err(format!("{} bytes, expected {expected} of an STL with {count} triangles", bytes.len()))
        }
        None => Err(format!(
            "{} bytes, expected an STL: at least {HEADER} in binary, or a text that begins with solid",
            bytes.len()
        )),
    }
}

/// The number of triangles that a file in binary states.
fn triangles(bytes: &[u8]) -> Option<usize> {
    let count: [u8; 4] = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    usize::try_from(u32::from_le_bytes(count)).ok()
}

fn binary(bytes: &[u8], count: usize) -> Vec<Vector3<f64>> {
    let number = |bytes: &[u8]| f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let corners = |triangle: &[u8]| -> Vec<Vector3<f64>> {
        // Past the normal.
        let corner = |k: usize| Vector3::from_fn(|axis, _| number(&triangle[12 * (k + 1) + 4 * axis..]));
        (0..3).map(corner).collect()
    };
    bytes[HEADER..].chunks_exact(TRIANGLE).take(count).flat_map(corners).collect()
}

fn text(text: &str) -> Result<Vec<Vector3<f64>>, String> {
    let mut points = Vec::new();
    for (line, content) in text.lines().enumerate() {
        let Some(rest) = content.trim_start().strip_prefix("vertex") else { continue };
        let numbers: Option<Vec<f64>> = rest.split_ascii_whitespace().map(|word| word.parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x, y, z]) => points.push(Vector3::new(x, y, z)),
            _ => return Err(format!("line {}: \"vertex{rest}\", expected vertex and three numbers", line + 1)),
        }
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_binary_of_one_triangle_are_the_same_points() {
        let corners = [[0.0_f32, 0.5, 1.0], [1.25, 0.0, -2.0], [0.0, 3.0, 0.0]];
        let mut binary = b"solid that is binary all the same".to_vec();
        binary.resize(80, b' ');
        binary.extend(1_u32.to_le_bytes());
        binary.extend([0; 12]);
        let mut text = "solid part\n facet normal 0 0 1\n  outer loop\n".to_owned();
        for corner in corners {
            corner.iter().for_each(|x| binary.extend(x.to_le_bytes()));
            text += &format!("   vertex {} {:e} {}\n", corner[0], corner[1], corner[2]);
        }
        binary.extend([0; 2]);
        text += "  endloop\n endfacet\nendsolid part\n";
        let expected: Vec<Vector3<f64>> = corners.map(|corner| Vector3::from(corner.map(f64::from))).to_vec();
        assert_eq!(points(&binary).unwrap(), expected);
        assert_eq!(points(text.as_bytes()).unwrap(), expected);
        let fault = points(&binary[..100]).unwrap_err();
        assert!(fault.contains("expected 134 of an STL with 1 triangles"), "{fault}");
        binary[..5].fill(b'x');
        assert!(points(&binary[..130]).unwrap_err().contains("expected 134 of an STL with 1 triangles"));
        assert!(points(b"").is_err());
        assert!(points(b"solid x\nvertex 1 2\n").unwrap_err().starts_with("line 2"));
    }
}
