//! The distance from a guess that grows without bound towards what is physically inconsistent.

use nalgebra::{DMatrix, DVector, Matrix4};

use crate::base::BaseReduction;
use crate::model::term::Sign;
use crate::model::{ParameterId, ParameterKind, StandardParameters};
use crate::spatial::{Inertia, PseudoInertia};

/// Part of a link's pseudo-inertia that stands for what a guess does not say: where P₀ is not positive definite.
const INFLATION: f64 = 1e-3;

/// A drive's rotor inertia or friction where nobody guesses it, SI.
const UNKNOWN_DRIVE: f64 = 1e-3;

/// The distance from the guess and its derivatives.
pub(super) struct Distance {
    parameters: Vec<ParameterId>,
    /// Position of the ten of each link among the parameters, and P₀ with its inverse.
    links: Vec<(usize, Matrix4<f64>, Matrix4<f64>)>,
    /// Position and x₀ of each quantity that is never negative.
    drives: Vec<(usize, f64)>,
    /// Position, guess and size of each offset.
    offsets: Vec<(usize, f64, f64)>,
    /// Pseudo-inertia of each of the ten parameters.
    units: [Matrix4<f64>; 10],
}

impl Distance {
    pub(super) fn of(base: &BaseReduction, guess: &StandardParameters) -> Self {
        let parameters = base.parameters.clone();
        let units = std::array::from_fn(|k| {
            let mut ten = [0.0; 10];
            ten[k] = 1.0;
            Inertia::from_array(&ten).pseudo().0
        });
        let (mut links, mut drives, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
        for (c, &id) in parameters.iter().enumerate() {
            let value = guess.get(id);
            match id.kind {
                ParameterKind::M => {
                    let p0 = within_the_cone(guess.links[id.index].pseudo());
                    let inverse = p0.try_inverse().unwrap_or_else(Matrix4::identity);
                    links.push((c, p0, inverse));
                }
                ParameterKind::Term(term) => match term.entry().sign {
                    Sign::Any => offsets.push((c, value, value.abs().max(1.0))),
                    Sign::NotNegative => drives.push((c, if value > 0.0 { value } else { UNKNOWN_DRIVE })),
                },
                // The other nine stand beside their mass.
                ParameterKind::Mcx
                | ParameterKind::Mcy
                | ParameterKind::Mcz
                | ParameterKind::Ixx
                | ParameterKind::Ixy
                | ParameterKind::Ixz
                | ParameterKind::Iyy
                | ParameterKind::Iyz
                | ParameterKind::Izz => {}
            }
        }
        Self { parameters, links, drives, offsets, units }
    }

    /// The guess, or what stands for it where it is not consistent.
    pub(super) fn centre(&self) -> DVector<f64> {
        let mut phi = DVector::zeros(self.parameters.len());
        for (at, p0, _) in &self.links {
            phi.rows_mut(*at, 10).copy_from_slice(&PseudoInertia(*p0).inertia().to_array());
        }
        for &(at, x0) in &self.drives {
            phi[at] = x0;
        }
        for &(at, value, _) in &self.offsets {
            phi[at] = value;
        }
        phi
    }

    fn pseudo(&self, phi: &DVector<f64>, at: usize) -> Matrix4<f64> {
        let mut p = Matrix4::zeros();
        for (k, unit) in self.units.iter().enumerate() {
            p += unit * phi[at + k];
        }
        p
    }

    /// Infinite where the set is not consistent.
    pub(super) fn value(&self, phi: &DVector<f64>) -> f64 {
        let mut sum = 0.0;
        for (at, _, inverse) in &self.links {
            let p = self.pseudo(phi, *at);
            let Some(factor) = p.cholesky() else { return f64::INFINITY };
            let log_det: f64 = factor.l_dirty().diagonal().iter().map(|&d| 2.0 * libm::log(d)).sum();
            sum += (inverse * p).trace() - log_det;
        }
        for &(at, x0) in &self.drives {
            if phi[at] <= 0.0 {
                return f64::INFINITY;
            }
            sum += phi[at] / x0 - libm::log(phi[at]);
        }
        sum + self.offsets.iter().map(|&(at, x0, size)| 0.5 * ((phi[at] - x0) / size).powi(2)).sum::<f64>()
    }

    /// Gradient and Hessian at a consistent set.
    pub(super) fn derivatives(&self, phi: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let p = phi.len();
        let (mut gradient, mut hessian) = (DVector::zeros(p), DMatrix::zeros(p, p));
        for (at, _, inverse) in &self.links {
            let now = self.pseudo(phi, *at).try_inverse().unwrap_or_else(Matrix4::identity);
            let turned: Vec<Matrix4<f64>> = self.units.iter().map(|unit| now * unit).collect();
            for k in 0..10 {
                gradient[at + k] += (inverse * self.units[k]).trace() - turned[k].trace();
                for l in 0..10 {
                    hessian[(at + k, at + l)] += (turned[k] * turned[l]).trace();
                }
            }
        }
        for &(at, x0) in &self.drives {
            gradient[at] += 1.0 / x0 - 1.0 / phi[at];
            hessian[(at, at)] += 1.0 / (phi[at] * phi[at]);
        }
        for &(at, x0, size) in &self.offsets {
            gradient[at] += (phi[at] - x0) / (size * size);
            hessian[(at, at)] += 1.0 / (size * size);
        }
        (gradient, hessian)
    }
}

/// The pseudo-inertia itself where a body can have it, else one with small bodies added.
fn within_the_cone(pseudo: PseudoInertia) -> Matrix4<f64> {
    let lacking = (-pseudo.smallest_eigenvalue()).max(0.0);
    let size = pseudo.0.trace().abs().max(INFLATION);
    if lacking == 0.0 && pseudo.smallest_eigenvalue() > 0.0 {
        return pseudo.0;
    }
    pseudo.0 + Matrix4::identity() * (lacking + INFLATION * size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::excitation::fixtures::{crs_a460, crs_a460_nominal};
    use crate::model::Columns;
    use crate::seed::Seed;
    use rand::RngExt;

    #[test]
    fn analytic_derivatives_of_the_distance_are_its_differences() {
        let guess = crs_a460_nominal();
        let base = reduce(&crs_a460(), Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let distance = Distance::of(&base, &guess);
        let mut rng = Seed::new(51).stream("consistent set", 0);
        let phi = distance.centre().map(|x| x * (1.0 + 0.01 * rng.random_range(-1.0..1.0)));
        let (gradient, hessian) = distance.derivatives(&phi);
        for i in (0..phi.len()).step_by(7) {
            let h = 1e-5 / hessian[(i, i)].sqrt();
            let at = |side: f64| {
                let mut moved = phi.clone();
                moved[i] += side * h;
                moved
            };
            let slope = (distance.value(&at(1.0)) - distance.value(&at(-1.0))) / (2.0 * h);
            let size = hessian[(i, i)].sqrt();
            assert!((slope - gradient[i]).abs() < 1e-6 * (size + gradient[i].abs()), "{i}: {slope} {}", gradient[i]);
            let curvature = (distance.derivatives(&at(1.0)).0 - distance.derivatives(&at(-1.0)).0) / (2.0 * h);
            for j in 0..phi.len() {
                let size = size * hessian[(j, j)].sqrt();
                assert!((curvature[j] - hessian[(i, j)]).abs() < 1e-6 * size, "{i} {j}");
            }
        }
    }
}
