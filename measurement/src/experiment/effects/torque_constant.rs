//! Torque constants other than those of the robot file.
//!
//! ```text
//! K_true = K (1 ± e)      the sign drawn by joint
//! ```
//! Everything that is estimated through that motor comes out wrong by the factor 1/(1 ± e).

use super::draw;
use crate::seed::Seed;

/// True torque constant over that of the robot file, for `count` motors.
pub(super) fn factors(error: f64, count: usize, seed: Seed) -> Vec<f64> {
    draw::signs(seed, "torque constants", count).into_iter().map(|sign| 1.0 + error * sign).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_every_constant_is_off_by_the_same_share_and_signs_differ() {
        let factors = factors(0.1, 40, Seed::new(3));
        assert!(factors.iter().all(|f| ((f - 1.0).abs() - 0.1).abs() < 1e-15));
        // 40 fair signs are all equal once in 5e11.
        assert!(factors.iter().any(|&f| f > 1.0) && factors.iter().any(|&f| f < 1.0));
        assert_eq!(super::factors(0.0, 2, Seed::new(3)), [1.0, 1.0]);
    }
}
