//! The Gaussian particle filter: means and covariances from weighted random points.
//!
//! ```text
//! χ_i = γ + S ξ_i        ln w_i ← ln w_i − ½ |z − H χ_i|²        γ = Σ w χ_i        P = Σ w (χ_i − γ)(χ_i − γ)ᵀ
//! drawn anew from N(γ, P + Q)  where  1/Σ w² < 0.9 N        a sample that would leave fewer is taken in parts of ln w
//! ```
//! A filter that resamples its points degenerates here: for dozens of constant parameters hardly one of thousands of points
//! is near. Points drawn anew from their own mean and covariance do not, as long as the posterior is nearly normal, which it is for a linear
//! measurement. The ξ_i come in pairs of opposite sign and have exactly the mean 0 and the covariance 1; each drawing exchanges their
//! coordinates and signs at random, by a fixed seed. From exact equations that leaves the mean where it is: at the truth.
//!
//! Assumes what `wls` does, and a posterior that is nearly normal. Fails by what random points miss: the mean lies within 0.1 (4
//! parameters) to 0.4 (58 parameters) standard deviations of that of the Kalman filter, standard deviations within 30 % of its own,
//! at many times its cost. It is here to be compared.
//!
//! Sources: J. H. Kotecha, P. M. Djurić, "Gaussian particle filtering", IEEE Trans. Signal Processing 51(10), 2003; C. Musso,
//! N. Oudjane, F. Le Gland, "Improving regularised particle filters", 2001, for samples taken in parts.

use nalgebra::{DMatrix, DVector};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::belief::Belief;
use super::walk;
use crate::estimation::error::EstimationError;
use crate::estimation::estimate::Estimate;
use crate::estimation::problem::EstimationProblem;
use crate::linalg::product;
use crate::seed::{Seed, Stream};

/// Points at least, and at least for each parameter: an even number of both.
const POINTS: usize = 1000;
const POINTS_PER_PARAMETER: usize = 20;

/// Effective number of points, as a part of all, at which they are drawn anew.
const EFFECTIVE: f64 = 0.9;

/// Halvings of the part of a sample that is taken at once.
const HALVINGS: usize = 30;

/// Parts of one sample at most.
const PARTS: usize = 1000;

/// Seed of the points: one estimator, one result.
const SEED: Seed = Seed::new(2003);

/// The Gaussian particle filter.
pub(crate) fn estimate(name: &str, problem: &EstimationProblem<'_>) -> Result<Estimate, EstimationError> {
    walk::estimate::<Particles>(name, problem)
}

/// Points with weights.
pub(super) struct Particles {
    /// ξ, b × N.
    shape: DMatrix<f64>,
    /// χ, b × N.
    points: DMatrix<f64>,
    /// ln w but for a constant, N.
    logarithms: Vec<f64>,
    /// γ, b.
    mean: DVector<f64>,
    /// What has walked since the points were drawn, on each parameter.
    walked: f64,
    rng: Stream,
}

impl Particles {
    /// Draws the points from a normal distribution; `false` where its covariance is not positive definite.
    fn draw(&mut self, mean: DVector<f64>, covariance: DMatrix<f64>) -> bool {
        let Some(root) = covariance.cholesky().map(|factor| factor.l()) else { return false };
        let b = mean.len();
        // Coordinates of ξ in another order and with other signs: S Π ξ.
        let mut order: Vec<usize> = (0..b).collect();
        for last in (1..b).rev() {
            order.swap(last, self.rng.random_range(0..=last));
        }
        let mut mixed = DMatrix::zeros(b, b);
        for (from, &to) in order.iter().enumerate() {
            let sign = if self.rng.random::<bool>() { 1.0 } else { -1.0 };
            mixed.set_column(to, &(root.column(from) * sign));
        }
        self.points = product(&mixed, &self.shape);
        for mut point in self.points.column_iter_mut() {
            point += &mean;
        }
        self.logarithms.fill(0.0);
        (self.mean, self.walked) = (mean, 0.0);
        true
    }

    /// What a sample adds to the logarithms of the weights, N.
    fn likelihoods(&self, h: &DMatrix<f64>, z: &DVector<f64>) -> Vec<f64> {
        let expected = product(h, &self.points);
        expected.column_iter().map(|expected| -0.5 * (z - expected).norm_squared()).collect()
    }
}

impl Belief for Particles {
    fn prior(mean: DVector<f64>, covariance: DMatrix<f64>) -> Option<Self> {
        let mut rng = SEED.stream("particles", 0);
        let shape = white_points(mean.len(), &mut rng)?;
        let count = shape.ncols();
        let (points, logarithms) = (shape.clone(), vec![0.0; count]);
        let mut all = Self { shape, points, logarithms, mean: mean.clone(), walked: 0.0, rng };
        all.draw(mean, covariance).then_some(all)
    }

    fn walk(&mut self, variance: f64) {
        self.walked += variance;
    }

    fn update(&mut self, h: &DMatrix<f64>, z: &DVector<f64>) -> bool {
        let mut left = 1.0;
        for _ in 0..PARTS {
            let likelihoods = self.likelihoods(h, z);
            let after = |part: f64| -> Vec<f64> {
                self.logarithms.iter().zip(&likelihoods).map(|(own, more)| own + part * more).collect()
            };
            let enough = EFFECTIVE * likelihoods.len() as f64;
            let is_enough = |part: f64| effective(&normalised(&after(part))) >= enough;
            if is_enough(left) {
                self.logarithms = after(left);
                let weights = normalised(&self.logarithms);
                self.mean = weighted_mean(&self.points, &weights);
                return self.mean.iter().all(|value| value.is_finite());
            }
            let (mut part, mut high) = (0.0, left);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (part + high);
                if is_enough(middle) { part = middle } else { high = middle }
            }
            self.logarithms = after(part);
            left -= part;
            let covariance = self.covariance();
            let mean = weighted_mean(&self.points, &normalised(&self.logarithms));
            if !self.draw(mean, covariance) {
                return false;
            }
        }
        false
    }

    fn mean(&self) -> &DVector<f64> {
        &self.mean
    }

    fn covariance(&self) -> DMatrix<f64> {
        let weights = normalised(&self.logarithms);
        let mean = weighted_mean(&self.points, &weights);
        let mut covariance = weighted_covariance(&self.points, &mean, &weights);
        for j in 0..covariance.nrows() {
            covariance[(j, j)] += self.walked;
        }
        covariance
    }
}

/// Points with mean 0 and covariance 1 in pairs of opposite sign, b × N; `None` where they have no definite covariance.
fn white_points(b: usize, rng: &mut Stream) -> Option<DMatrix<f64>> {
    let pairs = POINTS.max(POINTS_PER_PARAMETER * b).div_ceil(2);
    let half = DMatrix::from_fn(b, pairs, |_, _| -> f64 { StandardNormal.sample(rng) });
    let square = product(&half, &half.transpose()) / pairs as f64;
    let white = square.cholesky()?.l().solve_lower_triangular(&half)?;
    Some(DMatrix::from_fn(b, 2 * pairs, |i, j| if j < pairs { white[(i, j)] } else { -white[(i, j - pairs)] }))
}

/// Weights with these logarithms, whose sum is one.
fn normalised(logarithms: &[f64]) -> Vec<f64> {
    let largest = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut weights: Vec<f64> = logarithms.iter().map(|own| libm::exp(own - largest)).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    weights
}

/// `1/Σ w²`: how many points of equal weight are worth as much.
fn effective(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>()
}

fn weighted_mean(points: &DMatrix<f64>, weights: &[f64]) -> DVector<f64> {
    let weights = DMatrix::from_column_slice(weights.len(), 1, weights);
    product(points, &weights).column(0).into_owned()
}

fn weighted_covariance(points: &DMatrix<f64>, mean: &DVector<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut apart = points.clone();
    for (mut point, weight) in apart.column_iter_mut().zip(weights) {
        point -= mean;
        point *= weight.sqrt();
    }
    let covariance = product(&apart, &apart.transpose());
    (&covariance + covariance.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_weights_and_moments_are_those_of_particles() {
        // particles 0.4 (N. Chopin): resampling.Weights(lw).W, .ESS, resampling.wmean_and_cov(W, x).
        let weights = normalised(&[-1.2, 0.3, -4.0, 1.1, -0.5]);
        let expected = [
            0.057_043_652_379_510_31,
            0.255_651_913_401_415_24,
            0.003_468_828_073_569_186_5,
            0.568_963_796_722_261_7,
            0.114_871_809_423_243_56,
        ];
        assert!(weights.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-15));
        assert!((effective(&weights) - 2.465_852_587_018_075_4).abs() < 1e-13);
        let points = DMatrix::from_column_slice(2, 5, &[1.0, 2.0, -0.5, 0.25, 3.0, -1.0, 0.75, 1.5, 2.5, -2.0]);
        let mean = weighted_mean(&points, &weights);
        assert!((mean[0] - 0.653_526_550_999_315_4).abs() < 1e-14 && (mean[1] - 0.798_233_531_272_710_8).abs() < 1e-14);
        let covariance = weighted_covariance(&points, &mean, &weights);
        let expected =
            [0.763_070_075_082_470_4, -0.384_217_251_025_196_1, -0.384_217_251_025_196_1, 1.350_100_692_049_160_5];
        assert!(covariance.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-14));
    }

    #[test]
    fn identity_white_points_have_the_mean_zero_and_the_covariance_one() {
        let points = white_points(7, &mut SEED.stream("particles", 0)).unwrap();
        let weights = vec![1.0 / points.ncols() as f64; points.ncols()];
        let mean = weighted_mean(&points, &weights);
        let covariance = weighted_covariance(&points, &mean, &weights);
        assert!(mean.amax() < 1e-13 && (covariance - DMatrix::identity(7, 7)).amax() < 1e-12);
    }
}
