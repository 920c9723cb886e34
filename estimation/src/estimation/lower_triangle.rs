//! A symmetric matrix in a file: its rows up to the diagonal.

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serializer};

pub(super) fn serialize<S: Serializer>(rows: &[Vec<f64>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(rows.iter().enumerate().map(|(i, row)| &row[..row.len().min(i + 1)]))
}

/// Reads rows up to the diagonal, or whole ones.
pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<f64>>, D::Error> {
    let rows: Vec<Vec<f64>> = Vec::deserialize(deserializer)?;
    let b = rows.len();
    if let Some((i, row)) = rows.iter().enumerate().find(|(i, row)| ![i + 1, b].contains(&row.len())) {
        let (found, expected) = (row.len(), i + 1);
        return Err(D::Error::custom(format!(
            "row {expected} of a symmetric matrix has {found} entries, expected {expected}"
        )));
    }
    Ok((0..b).map(|i| (0..b).map(|j| rows[i.max(j)][i.min(j)]).collect()).collect())
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serialize};

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Symmetric(#[serde(with = "super")] Vec<Vec<f64>>);

    #[test]
    fn identity_a_symmetric_matrix_reads_back_from_half_of_it() {
        let matrix = Symmetric(vec![vec![0.1, 1e-17, 3.0], vec![1e-17, 2.0, -1.0], vec![3.0, -1.0, 5.0]]);
        let text = serde_json::to_string(&matrix).unwrap();
        assert_eq!(text, "[[0.1],[1e-17,2.0],[3.0,-1.0,5.0]]");
        let whole = "[[0.1,1e-17,3.0],[1e-17,2.0,-1.0],[3.0,-1.0,5.0]]";
        for text in [&text[..], whole] {
            assert_eq!(serde_json::from_str::<Symmetric>(text).unwrap(), matrix);
        }
        let fault = serde_json::from_str::<Symmetric>("[[0.1],[1e-17,2.0],[3.0]]").unwrap_err().to_string();
        assert!(fault.starts_with("row 3 of a symmetric matrix has 1 entries, expected 3"), "{fault}");
    }
}
