//! OBJ: `v x y z`, a line for each point; everything else is passed over.

use nalgebra::Vector3;

/// The points of all objects of a file.
pub(super) fn points(text: &str) -> Result<Vec<Vector3<f64>>, String> {
    let mut points = Vec::new();
    for (line, content) in text.lines().enumerate() {
        let mut words = content.split_ascii_whitespace();
        if words.next() != Some("v") {
            continue;
        }
        // A weight or a colour may follow.
        let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).take(3).collect();
        let [x, y, z] = numbers[..] else {
            return Err(format!("line {}: \"{content}\", expected v and three numbers", line + 1));
        };
        points.push(Vector3::new(x, y, z));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_and_all_else_is_not() {
        let text = "# cube\no a\nv 0 0.5 1\nvn 0 0 1\nvt 0 1\nv -1e-3 2 3 0.5 0.5 0.5\nf 1 2 1\n";
        assert_eq!(points(text).unwrap(), [Vector3::new(0.0, 0.5, 1.0), Vector3::new(-1e-3, 2.0, 3.0)]);
        assert!(points("v 1 2\n").unwrap_err().contains("line 1"));
    }
}
