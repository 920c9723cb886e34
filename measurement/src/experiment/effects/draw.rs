//! What is drawn once for an arm: signs and phases, from the seed of its effects.

use rand::RngExt;

use crate::seed::Seed;

/// `count` signs, +1 or −1.
pub(super) fn signs(seed: Seed, purpose: &str, count: usize) -> Vec<f64> {
    let mut stream = seed.stream(purpose, 0);
    (0..count).map(|_| if stream.random::<f64>() < 0.5 { -1.0 } else { 1.0 }).collect()
}

/// `count` phases, 0 to 2π rad.
pub(super) fn phases(seed: Seed, purpose: &str, count: usize) -> Vec<f64> {
    let mut stream = seed.stream(purpose, 0);
    (0..count).map(|_| std::f64::consts::TAU * stream.random::<f64>()).collect()
}
