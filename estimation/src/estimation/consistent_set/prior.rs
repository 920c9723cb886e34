//! What a search weighs beside the data.

use nalgebra::DVector;

use super::region::{Region, pseudo};

/// How a guess counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::estimation) enum Prior {
    /// Not at all; it only decides what torque does not show.
    None,
    /// By `Σ tr(P₀⁻¹P) − ln det P + Σ x/x₀ − ln x`, in nats.
    Entropic,
    /// By its curvature at the guess: `½ Σ tr((P₀⁻¹ΔP)²) + ½ Σ (Δx/x₀)²`.
    Pullback,
    /// By `½ |φ − φ₀|²/s²` in SI, s² the mean square of φ₀.
    Euclidean,
}

/// The factors of the terms of one minimisation:
///
/// ```text
/// ½ data χ² + quadratic Q + linear (Σ tr(P₀⁻¹P) + Σ x/x₀) + ½ offsets Σ ((o − o₀)/s)²
///     − logarithms (Σ ln det P + Σ ln x) − bounds Σ ln tr(Q P) − horizon ln(H − S)
/// ```
#[derive(Clone, Copy, Debug)]
pub(super) struct Weights {
    /// Infinite: the base parameters are the estimated ones.
    pub(super) data: f64,
    pub(super) quadratic: f64,
    pub(super) linear: f64,
    pub(super) offsets: f64,
    pub(super) logarithms: f64,
    pub(super) bounds: f64,
    pub(super) horizon: f64,
}

/// The distance from the guess among the sets with the estimated base parameters.
pub(super) const NEAREST: Weights = Weights {
    data: f64::INFINITY,
    quadratic: 0.0,
    linear: 1.0,
    offsets: 1.0,
    logarithms: 1.0,
    bounds: 1.0,
    horizon: 0.0,
};

impl Prior {
    /// `λ (½ χ² + R) + barrier`, R the prior. Where there is none, the horizon bounds what the data leave free.
    pub(super) const fn weights(self, lambda: f64) -> Weights {
        let barrier = Weights { data: lambda, linear: 0.0, offsets: 0.0, ..NEAREST };
        match self {
            Self::None => Weights { horizon: 1.0, ..barrier },
            Self::Entropic => Weights { linear: lambda, offsets: lambda, logarithms: lambda, ..barrier },
            Self::Pullback => Weights { quadratic: lambda, offsets: lambda, ..barrier },
            Self::Euclidean => Weights { quadratic: lambda, ..barrier },
        }
    }

    /// The prior alone, without what keeps a set consistent.
    pub(super) const fn alone(self) -> Weights {
        let only = Weights { bounds: 0.0, horizon: 0.0, ..self.weights(1.0) };
        match self {
            Self::None | Self::Entropic => only,
            Self::Pullback | Self::Euclidean => Weights { logarithms: 0.0, ..only },
        }
    }
    /// R, zero at the guess.
    pub(super) fn value(self, region: &Region, phi: &DVector<f64>) -> f64 {
        let offsets =
            || region.offsets.iter().map(|&(at, x0, size)| 0.5 * ((phi[at] - x0) / size).powi(2)).sum::<f64>();
        match self {
            Self::None => 0.0,
            Self::Entropic => region.divergence(phi),
            Self::Pullback => {
                let links =
                    region.links.iter().map(|link| link.whitened(&(pseudo(phi, link.at) - link.p0)).norm_squared());
                let drives = region.drives.iter().map(|&(at, x0)| (phi[at] / x0 - 1.0).powi(2));
                0.5 * links.chain(drives).sum::<f64>() + offsets()
            }
            Self::Euclidean => {
                let centre = region.centre();
                0.5 * (phi - &centre).norm_squared() / euclidean_size(&centre)
            }
        }
    }
}

/// Mean square of the guess.
pub(super) fn euclidean_size(centre: &DVector<f64>) -> f64 {
    (centre.norm_squared() / centre.len() as f64).max(f64::MIN_POSITIVE)
}
