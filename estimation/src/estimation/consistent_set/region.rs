//! The consistent sets, seen from a guess inside them.

use nalgebra::{DVector, Matrix4};

use super::shape_bounds::ShapeBounds;
use crate::base::BaseReduction;
use crate::estimation::completion::check_links;
use crate::estimation::error::EstimationError;
use crate::model::term::Sign;
use crate::model::{ParameterId, ParameterKind, StandardParameters};
use crate::spatial::{Inertia, PseudoInertia};

/// Part of a link's pseudo-inertia that stands for what a guess does not say: where P₀ is not positive definite.
const INFLATION: f64 = 1e-3;

/// The scale of a rotor inertia or a friction that neither guess nor estimate determines, SI.
const UNKNOWN_DRIVE: f64 = 1e-3;

/// How far from the guess sets are looked for: S at most this many times its value at the guess, so that an optimum exists where
/// the data would have links grow without end.
const HORIZON: f64 = 1e3;

/// All consistent sets: positive definite pseudo-inertias P, `tr(Q P) > 0` for the bounds of a shape, and what is never negative.
///
/// Each quantity has a guess inside, from which distances are counted.
pub(super) struct Region {
    parameters: Vec<ParameterId>,
    pub(super) links: Vec<LinkRegion>,
    /// Position and guess x₀ of each quantity that is never negative.
    pub(super) drives: Vec<(usize, f64)>,
    /// Position, guess and size of each quantity of either sign.
    pub(super) offsets: Vec<(usize, f64, f64)>,
    /// Links, from one, whose guess lies outside their shape, which then bounds nothing.
    pub(super) beyond_shape: Vec<usize>,
}

/// The bodies that one link can be.
pub(super) struct LinkRegion {
    /// Position of its ten among the parameters.
    pub(super) at: usize,
    /// The guess P₀ = L₀ L₀ᵀ.
    pub(super) p0: Matrix4<f64>,
    /// L₀⁻¹.
    pub(super) whitening: Matrix4<f64>,
    /// Q of each bound `tr(Q P) > 0`.
    pub(super) bounds: Vec<Matrix4<f64>>,
}

impl Region {
    /// The sets around a guess. Where it says nothing of a drive, x₀ is the estimate `beta`, with the standard deviations
    /// `std`, of the base parameter that the drive stands for, but not less than its standard deviation.
    ///
    /// # Errors
    /// [`EstimationError::Count`] where the guess is of another arm or the ten of a link do not stand together,
    /// [`EstimationError::NotDefinite`] where a number of the guess is none.
    pub(super) fn of(
        base: &BaseReduction,
        guess: &StandardParameters,
        beta: &DVector<f64>,
        std: &DVector<f64>,
        shapes: &ShapeBounds,
    ) -> Result<Self, EstimationError> {
        check(base, guess)?;
        let mut region = Self {
            parameters: base.parameters.clone(),
            links: Vec::new(),
            drives: Vec::new(),
            offsets: Vec::new(),
            beyond_shape: Vec::new(),
        };
        for (c, &id) in base.parameters.iter().enumerate() {
            let value = guess.get(id);
            match id.kind {
                ParameterKind::M => {
                    let p0 = within_the_cone(guess.links[id.index].pseudo());
                    let mut bounds = shapes.of_link(id.index).to_vec();
                    if bounds.iter().any(|q| margin(q, &p0) <= 0.0) {
                        region.beyond_shape.push(id.index + 1);
                        bounds.clear();
                    }
                    let root = p0.cholesky().ok_or(EstimationError::NotDefinite)?.l();
                    let whitening = root.try_inverse().ok_or(EstimationError::NotDefinite)?;
                    region.links.push(LinkRegion { at: c, p0, whitening, bounds });
                }
                ParameterKind::Term(term) => match term.entry().sign {
                    Sign::Any => region.offsets.push((c, value, value.abs().max(1.0))),
                    Sign::NotNegative => {
                        let estimated = base.kept.iter().position(|&kept| kept == c);
                        let unknown = estimated.map_or(UNKNOWN_DRIVE, |row| beta[row].max(std[row]));
                        region.drives.push((c, if value > 0.0 { value } else { unknown.max(f64::MIN_POSITIVE) }));
                    }
                },
                // The other nine stand beside their mass.
                _ => {}
            }
        }
        Ok(region)
    }

    /// The region around a guess that is `factor` times as large.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let root = 1.0 / factor.sqrt();
        let link = |link: &LinkRegion| LinkRegion {
            at: link.at,
            p0: link.p0 * factor,
            whitening: link.whitening * root,
            bounds: link.bounds.clone(),
        };
        Self {
            parameters: self.parameters.clone(),
            links: self.links.iter().map(link).collect(),
            drives: self.drives.iter().map(|&(at, x0)| (at, x0 * factor)).collect(),
            offsets: self.offsets.iter().map(|&(at, value, size)| (at, value * factor, size * factor)).collect(),
            beyond_shape: self.beyond_shape.clone(),
        }
    }

    /// Number of parameters p.
    pub(super) const fn parameters(&self) -> usize {
        self.parameters.len()
    }

    /// The guess, or what stands for it where it is not consistent.
    pub(super) fn centre(&self) -> DVector<f64> {
        let mut phi = DVector::zeros(self.parameters.len());
        for link in &self.links {
            put(&mut phi, link.at, &link.p0);
        }
        for &(at, x0) in &self.drives {
            phi[at] = x0;
        }
        for &(at, value, _) in &self.offsets {
            phi[at] = value;
        }
        phi
    }

    /// How many logarithms keep a set inside: those of eigenvalues and drives, and those of bounds.
    pub(super) fn logarithms(&self) -> (usize, usize) {
        (4 * self.links.len() + self.drives.len(), self.links.iter().map(|link| link.bounds.len()).sum())
    }

    /// H, the largest S that is looked for.
    pub(super) fn horizon(&self) -> f64 {
        HORIZON * self.logarithms().0 as f64
    }

    /// Whether a set is consistent.
    pub(super) fn contains(&self, phi: &DVector<f64>) -> bool {
        self.drives.iter().all(|&(at, _)| phi[at] > 0.0)
            && self.links.iter().all(|link| {
                let p = pseudo(phi, link.at);
                p.cholesky().is_some() && link.bounds.iter().all(|q| margin(q, &p) > 0.0)
            })
    }

    /// S = `Σ tr(P₀⁻¹ P) + Σ x/x₀ + ½ Σ ((o − o₀)/s)²`: how far a set is from the guess, without what its logarithms say.
    pub(super) fn growth(&self, phi: &DVector<f64>) -> f64 {
        let links: f64 = self.links.iter().map(|link| link.whitened(&pseudo(phi, link.at)).trace()).sum();
        let drives: f64 = self.drives.iter().map(|&(at, x0)| phi[at] / x0).sum();
        links + drives + self.offsets.iter().map(|&(at, x0, size)| 0.5 * ((phi[at] - x0) / size).powi(2)).sum::<f64>()
    }

    /// `Σ tr(P₀⁻¹P) − 4 − ln det(P₀⁻¹P) + Σ x/x₀ − 1 − ln(x/x₀) + ½ Σ ((o − o₀)/s)²`, zero at the guess; infinite outside.
    pub(super) fn divergence(&self, phi: &DVector<f64>) -> f64 {
        let mut sum = self.growth(phi);
        for link in &self.links {
            let Some(factor) = link.whitened(&pseudo(phi, link.at)).cholesky() else { return f64::INFINITY };
            sum -= 4.0 + factor.l_dirty().diagonal().iter().map(|&d| 2.0 * libm::log(d)).sum::<f64>();
        }
        for &(at, x0) in &self.drives {
            if phi[at] <= 0.0 {
                return f64::INFINITY;
            }
            sum -= 1.0 + libm::log(phi[at] / x0);
        }
        sum
    }
}

impl LinkRegion {
    /// `L₀⁻¹ P L₀⁻ᵀ`.
    pub(super) fn whitened(&self, p: &Matrix4<f64>) -> Matrix4<f64> {
        self.whitening * p * self.whitening.transpose()
    }
}

/// `tr(Q P)`.
pub(super) fn margin(q: &Matrix4<f64>, p: &Matrix4<f64>) -> f64 {
    q.component_mul(p).sum()
}

/// The pseudo-inertia of the ten that begin at `at`.
pub(super) fn pseudo(phi: &DVector<f64>, at: usize) -> Matrix4<f64> {
    let ten: [f64; 10] = std::array::from_fn(|k| phi[at + k]);
    Inertia::from_array(&ten).pseudo().0
}

fn put(phi: &mut DVector<f64>, at: usize, p: &Matrix4<f64>) {
    phi.rows_mut(at, 10).copy_from_slice(&PseudoInertia(*p).inertia().to_array());
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

/// Whether base and guess belong together, and the ten of each link follow its mass.
fn check(base: &BaseReduction, guess: &StandardParameters) -> Result<(), EstimationError> {
    check_links(base, guess)?;
    for (at, id) in base.parameters.iter().enumerate().filter(|(_, id)| id.kind == ParameterKind::M) {
        let of_link = |other: &&ParameterId| other.index == id.index && other.kind.term().is_none();
        let found = base.parameters[at..].iter().take(10).take_while(of_link).count();
        EstimationError::unless_equal("parameters of a link", found, 10)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::chains::random_robot;
    use crate::model::Columns;
    use crate::seed::Seed;

    /// The region around the parameters of a random arm, and sets: the guess itself and another arm's.
    fn region() -> (Region, [DVector<f64>; 2]) {
        let mut rng = Seed::new(7).stream("region", 0);
        let ((robot, guess), (_, other)) = (random_robot(&mut rng, 2), random_robot(&mut rng, 2));
        let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, Method::Structural, Seed::new(0)).unwrap();
        let [phi, other] = [&guess, &other]
            .map(|set| DVector::from_iterator(base.parameters.len(), base.parameters.iter().map(|&id| set.get(id))));
        let (beta, std) = (base.beta(&phi), DVector::from_element(base.rank(), 1.0));
        (Region::of(&base, &guess, &beta, &std, &ShapeBounds::default()).unwrap(), [phi, other])
    }

    #[test]
    fn analytic_distances_from_the_guess() {
        let (region, [phi, other]) = region();
        assert!((region.centre() - &phi).norm() < 1e-12 && region.contains(&phi) && region.contains(&other));
        // Each of four eigenvalues of a link and each drive is one there, and a divergence is zero.
        let count = region.logarithms().0 as f64;
        assert_eq!(region.logarithms(), (4 * 2 + region.drives.len(), 0));
        assert!((region.growth(&phi) - count).abs() < 1e-9 && region.divergence(&phi).abs() < 1e-9);
        // Twice the guess, but for offsets: x − 1 − ln x of each.
        let mut twice = &phi * 2.0;
        for &(at, value, size) in &region.offsets {
            twice[at] = value + 3.0 * size;
        }
        let expected = count * (1.0 - std::f64::consts::LN_2) + 4.5 * region.offsets.len() as f64;
        assert!((region.divergence(&twice) / expected - 1.0).abs() < 1e-9);
        assert_eq!(region.divergence(&-phi), f64::INFINITY);
    }

    #[test]
    fn identity_a_region_of_another_unit_measures_alike() {
        let (region, [phi, other]) = region();
        let scaled = region.scaled(5.0);
        assert!((scaled.centre() - &phi * 5.0).norm() < 1e-9);
        assert!((scaled.growth(&(&other * 5.0)) / region.growth(&other) - 1.0).abs() < 1e-9);
        assert!((scaled.divergence(&(&other * 5.0)) / region.divergence(&other) - 1.0).abs() < 1e-9);
        assert_eq!((scaled.parameters(), scaled.horizon()), (region.parameters(), region.horizon()));
    }
}
