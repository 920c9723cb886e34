//! The distance from a guess that grows without bound towards what is physically inconsistent.

use nalgebra::{DVector, Matrix4};

use crate::base::BaseReduction;
use crate::model::term::Sign;
use crate::model::{ParameterId, ParameterKind, StandardParameters};
use crate::spatial::{Inertia, PseudoInertia};

/// Part of a link's pseudo-inertia that stands for what a guess does not say: where P₀ is not positive definite.
const INFLATION: f64 = 1e-3;

/// The scale of a rotor inertia or a friction that neither guess nor estimate determines, SI.
const UNKNOWN_DRIVE: f64 = 1e-3;

/// The distance from the guess, as a barrier: `D = Σ ( tr(P₀⁻¹ P) − ln det P ) + Σ ( x/x₀ − ln x ) + ½ Σ ((o − o₀)/s)²`.
///
/// Its Hessian maps a change S of P to P⁻¹ S P⁻¹, so the inverse is P G P: nothing is factored, and a link on the edge of what
/// is possible costs no digits.
pub(super) struct Distance {
    parameters: Vec<ParameterId>,
    /// Position of the ten of each link among the parameters, and P₀ with its inverse.
    links: Vec<(usize, Matrix4<f64>, Matrix4<f64>)>,
    /// Position and x₀ of each quantity that is never negative.
    drives: Vec<(usize, f64)>,
    /// Position, guess and size of each offset.
    offsets: Vec<(usize, f64, f64)>,
}

impl Distance {
    /// The distance from a guess. Where it says nothing of a drive, x₀ is the estimate `beta`, with the standard deviations
    /// `std`, of the base parameter that the drive stands for, but not less than its standard deviation.
    pub(super) fn of(
        base: &BaseReduction,
        guess: &StandardParameters,
        beta: &DVector<f64>,
        std: &DVector<f64>,
    ) -> Self {
        let parameters = base.parameters.clone();
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
                    Sign::NotNegative => {
                        let estimated = base.kept.iter().position(|&kept| kept == c);
                        let unknown = estimated.map_or(UNKNOWN_DRIVE, |row| beta[row].max(std[row]));
                        drives.push((c, if value > 0.0 { value } else { unknown }));
                    }
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
        Self { parameters, links, drives, offsets }
    }

    /// The guess, or what stands for it where it is not consistent: the minimum of the distance.
    pub(super) fn centre(&self) -> DVector<f64> {
        let mut phi = DVector::zeros(self.parameters.len());
        for (at, p0, _) in &self.links {
            put(&mut phi, *at, p0);
        }
        for &(at, x0) in &self.drives {
            phi[at] = x0;
        }
        for &(at, value, _) in &self.offsets {
            phi[at] = value;
        }
        phi
    }

    /// Barrier parameter ν of the logarithms.
    pub(super) fn barrier(&self) -> f64 {
        (4 * self.links.len() + self.drives.len()) as f64
    }

    /// Infinite where the set is not consistent.
    pub(super) fn value(&self, phi: &DVector<f64>) -> f64 {
        let mut sum = 0.0;
        for (at, _, inverse) in &self.links {
            let p = pseudo(phi, *at);
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

    /// The part of D without its logarithms: what holds a set near the guess.
    pub(super) fn growth(&self, phi: &DVector<f64>) -> f64 {
        let links: f64 = self.links.iter().map(|(at, _, inverse)| (inverse * pseudo(phi, *at)).trace()).sum();
        let drives: f64 = self.drives.iter().map(|&(at, x0)| phi[at] / x0).sum();
        links + drives + self.offsets.iter().map(|&(at, x0, size)| 0.5 * ((phi[at] - x0) / size).powi(2)).sum::<f64>()
    }

    /// Newton's step of the distance alone, `−∇²D⁻¹ ∇D`: P − P P₀⁻¹ P for a link.
    pub(super) fn pull(&self, phi: &DVector<f64>) -> DVector<f64> {
        let mut step = DVector::zeros(phi.len());
        for (at, _, inverse) in &self.links {
            let p = pseudo(phi, *at);
            put(&mut step, *at, &(p - p * inverse * p));
        }
        for &(at, x0) in &self.drives {
            step[at] = phi[at] - phi[at] * phi[at] / x0;
        }
        for &(at, x0, _) in &self.offsets {
            step[at] = x0 - phi[at];
        }
        step
    }

    /// `∇²D⁻¹ g`.
    pub(super) fn inverse_hessian(&self, phi: &DVector<f64>, g: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(phi.len());
        for (at, _, _) in &self.links {
            let p = pseudo(phi, *at);
            put(&mut out, *at, &(p * dual(g, *at) * p));
        }
        for &(at, _) in &self.drives {
            out[at] = phi[at] * phi[at] * g[at];
        }
        for &(at, _, size) in &self.offsets {
            out[at] = size * size * g[at];
        }
        out
    }

    /// `dᵀ ∇²D d`; infinite where the set is not consistent.
    pub(super) fn curvature(&self, phi: &DVector<f64>, d: &DVector<f64>) -> f64 {
        let mut sum = 0.0;
        for (at, _, _) in &self.links {
            let Some(factor) = pseudo(phi, *at).cholesky() else { return f64::INFINITY };
            let l = factor.l();
            let half = l.solve_lower_triangular(&pseudo(d, *at)).unwrap_or_else(Matrix4::zeros);
            let whole = l.solve_lower_triangular(&half.transpose()).unwrap_or_else(Matrix4::zeros);
            sum += whole.norm_squared();
        }
        sum += self.drives.iter().map(|&(at, _)| (d[at] / phi[at]).powi(2)).sum::<f64>();
        sum + self.offsets.iter().map(|&(at, _, size)| (d[at] / size).powi(2)).sum::<f64>()
    }
}

/// The pseudo-inertia of the ten that begin at `at`.
fn pseudo(phi: &DVector<f64>, at: usize) -> Matrix4<f64> {
    let ten: [f64; 10] = std::array::from_fn(|k| phi[at + k]);
    Inertia::from_array(&ten).pseudo().0
}

fn put(phi: &mut DVector<f64>, at: usize, p: &Matrix4<f64>) {
    phi.rows_mut(at, 10).copy_from_slice(&PseudoInertia(*p).inertia().to_array());
}

/// The symmetric G with `tr(G P) = g · φ` for the ten that begin at `at`.
fn dual(g: &DVector<f64>, at: usize) -> Matrix4<f64> {
    let [m, x, y, z, xx, xy, xz, yy, yz, zz]: [f64; 10] = std::array::from_fn(|k| g[at + k]);
    // P holds tr(I)/2 1 − I, so Ixx counts −½, ½, ½ on the diagonal and Ixy −1 twice beside it.
    let (xy, xz, yz) = (-0.5 * xy, -0.5 * xz, -0.5 * yz);
    let (x, y, z) = (0.5 * x, 0.5 * y, 0.5 * z);
    Matrix4::new(yy + zz, xy, xz, x, xy, xx + zz, yz, y, xz, yz, xx + yy, z, x, y, z, m)
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
        let b = base.rank();
        let distance = Distance::of(&base, &guess, &DVector::zeros(b), &DVector::from_element(b, 1.0));
        let mut rng = Seed::new(51).stream("consistent set", 0);
        let centre = distance.centre();
        let phi = centre.map(|x| x * (1.0 + 0.01 * rng.random_range(-1.0..1.0)));
        for _ in 0..20 {
            // A direction of the size of the distance's own curvature.
            let g = DVector::from_fn(phi.len(), |c, _| rng.random_range(-1.0..1.0) / (1e-6 + phi[c].abs()));
            let mut d = distance.inverse_hessian(&phi, &g);
            d /= distance.curvature(&phi, &d).sqrt();
            let h = 1e-3;
            let at = |side: f64| distance.value(&(&phi + &d * (side * h)));
            let slope = (at(1.0) - at(-1.0)) / (2.0 * h);
            let bend = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (h * h);
            // ∇D · d = −pullᵀ ∇²D d by polarisation of the curvature.
            let pull = distance.pull(&phi);
            let of = |v: DVector<f64>| distance.curvature(&phi, &v);
            let expected = -0.25 * (of(&pull + &d) - of(&pull - &d));
            assert!((slope - expected).abs() < 1e-5 * (1.0 + of(pull).sqrt()), "{slope} {expected}");
            assert!((bend - 1.0).abs() < 1e-4, "{bend}");
            // The inverse Hessian undoes the Hessian: gᵀ H⁻¹ g is the curvature of H⁻¹ g.
            let step = distance.inverse_hessian(&phi, &g);
            assert!((g.dot(&step) / distance.curvature(&phi, &step) - 1.0).abs() < 1e-9);
        }
        assert!(distance.pull(&centre).amax() < 1e-12 * centre.amax());
    }
}
