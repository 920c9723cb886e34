//! The scalar product.

/// `Σ aᵢ bᵢ` in the order of the entries.
///
/// ```
/// # use armid_mechanics as armid;
/// assert_eq!(armid::linalg::dot(&[1.0, 2.0], &[3.0, 4.0]), 11.0);
/// ```
#[inline]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (x, y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}
