//! A family of trajectories on equidistant samples, ready for many evaluations.

use std::f64::consts::TAU;

use pulp::{Arch, Simd, WithSimd};

use super::basis::MotionBasis;
use crate::dynamics::States;
use crate::optimiser::dot;
use crate::trajectory::ShapeFunctions;

/// The shape functions of one joint and their first two derivatives at `θ_k = 2π k / N`.
#[derive(Clone, Debug)]
pub(super) struct ShapeTable {
    samples: usize,
    /// Of position, velocity and acceleration: every shape at all samples, one shape after the other.
    shapes: [Vec<f64>; 3],
}

impl ShapeTable {
    pub(super) fn new(shape: &dyn ShapeFunctions, samples: usize) -> Self {
        let count = shape.count();
        let mut row = vec![0.0; count];
        let shapes = std::array::from_fn(|order| {
            let mut table = vec![0.0; count * samples];
            for k in 0..samples {
                shape.fill(TAU * k as f64 / samples as f64, order, &mut row);
                for (c, value) in row.iter().enumerate() {
                    table[c * samples + k] = *value;
                }
            }
            table
        });
        Self { samples, shapes }
    }

    /// The derivative of this order (0 to 2) of these coefficients at every sample.
    pub(super) fn motion(&self, order: usize, coefficients: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.samples, 0.0);
        Arch::new().dispatch(Combination { shapes: &self.shapes[order], coefficients, sum: out });
    }

    /// Adds to each coefficient's entry the sum of its shape's samples times these weights.
    fn pull_back(&self, order: usize, weights: &[f64], sums: &mut [f64]) {
        for (sum, shape) in sums.iter_mut().zip(self.shapes[order].chunks_exact(self.samples)) {
            *sum += dot(weights, shape);
        }
    }
}

/// Adds `Σ c_i s_i` for shapes as long as the sum, compiled for the vectors of the processor by their width alone.
struct Combination<'a> {
    shapes: &'a [f64],
    coefficients: &'a [f64],
    sum: &'a mut [f64],
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (shape, c) in self.shapes.chunks_exact(self.sum.len()).zip(self.coefficients) {
            for (sum, value) in self.sum.iter_mut().zip(shape) {
                *sum += c * value;
            }
        }
    }
}

/// The motions of all joints at the samples `θ_k = 2π k / N`.
#[derive(Clone, Debug)]
pub struct SampledBasis {
    pub(super) basis: MotionBasis,
    /// One for each shape of the basis.
    tables: Vec<ShapeTable>,
}

impl SampledBasis {
    /// `samples` samples of a family.
    pub fn new(basis: MotionBasis, samples: usize) -> Self {
        let tables = basis.shapes.iter().map(|shape| ShapeTable::new(&**shape, samples)).collect();
        Self { basis, tables }
    }

    /// Fills `states` (N samples of n joints) with the motion of the variables `x`.
    pub fn states(&self, x: &[f64], states: &mut States) {
        let n = self.basis.dof();
        let mut values = Vec::new();
        for j in 0..n {
            let coefficients = self.basis.unscaled(j, x);
            let table = &self.tables[self.basis.joints[j].shape];
            for (order, states) in [&mut states.q, &mut states.qd, &mut states.qdd].into_iter().enumerate() {
                table.motion(order, &coefficients, &mut values);
                for (state, value) in states.iter_mut().skip(j).step_by(n).zip(&values) {
                    *state = *value;
                }
            }
        }
    }

    /// Derivatives of a scalar with respect to the samples (N × n row-major each) pulled back to the variables.
    ///
    /// ```text
    /// ∂f/∂x_j = S_jᵀ Σ_k B_q(θ_k)ᵀ ∂f/∂q_kj + B_v(θ_k)ᵀ ∂f/∂q̇_kj + B_a(θ_k)ᵀ ∂f/∂q̈_kj
    /// ```
    pub fn pull_back(&self, sensitivity: &States, gradient: &mut [f64]) {
        let n = self.basis.dof();
        let mut weights = Vec::new();
        for j in 0..n {
            let block = &mut gradient[self.basis.range(j)];
            if block.is_empty() {
                continue;
            }
            block.fill(0.0);
            let table = &self.tables[self.basis.joints[j].shape];
            for (order, slopes) in [&sensitivity.q, &sensitivity.qd, &sensitivity.qdd].into_iter().enumerate() {
                weights.clear();
                weights.extend(slopes.iter().skip(j).step_by(n));
                table.pull_back(order, &weights, block);
            }
            for (g, scale) in block.iter_mut().zip(&self.basis.joints[j].scales) {
                *g *= scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::DesignSpace;
    use crate::seed::Seed;
    use crate::trajectory::{Family, Quantity, Trajectory};
    use rand::RngExt;

    /// Four joints of 3, 4 and 3 harmonics, of which the third stands still.
    fn families() -> Vec<(MotionBasis, Vec<f64>)> {
        let mut rng = Seed::new(3).stream("basis", 0);
        let (robot, _) = chains::random_robot(&mut rng, 4);
        let basis = |family: Family| {
            let mut space = DesignSpace::new(family, 7.0, vec![3, 4, 3, 3]);
            space.frozen[2] = Some(0.3);
            let basis = MotionBasis::new(&robot, &space).unwrap();
            let mut rng = Seed::new(3).stream("variables", 0);
            let x = (0..basis.variables()).map(|_| rng.random_range(-1.0..1.0)).collect();
            (basis, x)
        };
        Family::ALL.map(basis).into()
    }

    #[test]
    fn identity_sampled_states_equal_the_trajectory() {
        for (basis, x) in families() {
            let trajectory = basis.trajectory(&x);
            let sampled = SampledBasis::new(basis.clone(), 23);
            let mut states = States::with_len(4, 23);
            sampled.states(&x, &mut states);
            let expected = trajectory.sample(23);
            for (found, expected) in
                [(&states.q, &expected.q), (&states.qd, &expected.qd), (&states.qdd, &expected.qdd)]
            {
                for (x, y) in found.iter().zip(expected) {
                    assert!((x - y).abs() < 1e-11, "{}: {x} {y}", basis.family.name());
                }
            }
            assert!(states.q.iter().skip(2).step_by(4).all(|q| (q - 0.3).abs() < 1e-15));
            let back = basis.coefficients(&trajectory).unwrap();
            assert!(back.iter().zip(&x).all(|(x, y)| (x - y).abs() < 1e-15));
        }
    }

    #[test]
    fn identity_rows_equal_the_evaluation() {
        for (basis, x) in families() {
            let trajectory = basis.trajectory(&x);
            let (mut q, mut qd, mut qdd) = ([0.0; 4], [0.0; 4], [0.0; 4]);
            trajectory.evaluate(1.3, &mut q, &mut qd, &mut qdd);
            for j in [0, 1, 3] {
                let x = &x[basis.range(j)];
                for (quantity, expected) in Quantity::ALL.into_iter().zip([q[j], qd[j], qdd[j]]) {
                    let row = basis.row(j, quantity, basis.omega() * 1.3, -1.0);
                    let found: f64 = row.iter().zip(x).map(|(a, x)| a * x).sum();
                    assert!((found + expected).abs() < 1e-11);
                }
            }
            assert!(basis.row(2, Quantity::Position, 1.0, 1.0).is_empty());
        }
    }

    #[test]
    fn identity_pull_back_is_the_transpose_of_the_states() {
        // ⟨s, states(x) − states(0)⟩ = ⟨pull_back(s), x⟩ for every s and x.
        for (basis, x) in families() {
            let sampled = SampledBasis::new(basis, 23);
            let (mut states, mut still) = (States::with_len(4, 23), States::with_len(4, 23));
            sampled.states(&x, &mut states);
            sampled.states(&vec![0.0; x.len()], &mut still);
            let mut rng = Seed::new(3).stream("sensitivity", 0);
            let mut weights = States::with_len(4, 23);
            for w in weights.q.iter_mut().chain(&mut weights.qd).chain(&mut weights.qdd) {
                *w = rng.random_range(-1.0..1.0);
            }
            let dot = |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| x * y).sum() };
            let all = |s: &States| dot(&weights.q, &s.q) + dot(&weights.qd, &s.qd) + dot(&weights.qdd, &s.qdd);
            let left = all(&states) - all(&still);
            let mut gradient = vec![0.0; x.len()];
            sampled.pull_back(&weights, &mut gradient);
            assert!((left - dot(&gradient, &x)).abs() < 1e-11 * (1.0 + left.abs()));
        }
    }

    #[test]
    fn analytic_nearest_of_a_slow_series_is_that_series() {
        for (basis, _) in families() {
            let joint = |j: usize| crate::trajectory::FourierJoint {
                name: basis.trajectory(&vec![0.0; basis.variables()]).names()[j].to_owned(),
                a: vec![0.3, 0.0],
                b: vec![0.1, 0.0],
                q0: 0.2 * j as f64,
            };
            let series = crate::trajectory::FourierTrajectory { period_s: 7.0, joints: (0..4).map(joint).collect() };
            let near = basis.trajectory(&basis.nearest(&series).unwrap()).sample(50);
            let far = series.sample(50);
            let error = (0..50).map(|k| (near.q(k)[1] - far.q(k)[1]).abs()).fold(0.0, f64::max);
            match Family::parse(basis.family.name()).expect("a family of the list") {
                Family::Fourier => assert!(error < 1e-15),
                // The polynomial takes the velocity of the ends away: another motion.
                Family::FourierQuintic => assert!(error > 0.01),
                // A cubic on 9 knots follows one turn of 0.35 rad to (2π/9)⁴/384 of it.
                Family::CubicBSpline | Family::QuinticBSpline => assert!(error < 1e-3, "{error}"),
            }
        }
    }
}
