//! Numbers that may be infinite: TOML has `inf`, JSON writes `null`, and the place says which infinity that was.

use serde::{Deserialize, Deserializer};

/// +∞ for `null`: a limit that is not stated, a condition number of a singular matrix.
pub fn positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

/// +∞ for `null`, of a number that older files lack, which is then `None`: where the key is, there is a number.
pub fn present_positive<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    positive(deserializer).map(Some)
}

/// −∞ for `null`: the logarithm of the determinant of a singular matrix.
pub fn negative<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NEG_INFINITY))
}

/// Not a number for `null`, where the sign of the infinity follows from the owner of the value, which restores it.
pub fn undecided<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

/// A range, whose lower end may be −∞ and whose upper end +∞.
pub fn range<'de, D: Deserializer<'de>>(deserializer: D) -> Result<(f64, f64), D::Error> {
    let (low, high) = <(Option<f64>, Option<f64>)>::deserialize(deserializer)?;
    Ok((low.unwrap_or(f64::NEG_INFINITY), high.unwrap_or(f64::INFINITY)))
}

/// A range as an array.
pub fn interval<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    range(deserializer).map(|(low, high)| [low, high])
}

/// A list, in which `null` is +∞.
pub fn list<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    Ok(Vec::<Option<f64>>::deserialize(deserializer)?.into_iter().map(|x| x.unwrap_or(f64::INFINITY)).collect())
}

/// Lists of such numbers.
pub fn lists<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Vec<f64>>, D::Error> {
    let lists = Vec::<Vec<Option<f64>>>::deserialize(deserializer)?;
    Ok(lists.into_iter().map(|list| list.into_iter().map(|x| x.unwrap_or(f64::INFINITY)).collect()).collect())
}
