//! How much a residual counts.

/// A loss by its influence ψ and weight `ω(u) = ψ(u)/u`; u is a residual over its scale.
///
/// Constants give 95 % of the efficiency of least squares where noise is normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Loss {
    /// `ψ = u` up to k, `k sgn u` beyond; k = 1.345.
    Huber,
    /// `ψ = u (1 − (u/c)²)²` up to c, 0 beyond; c = 4.685.
    Tukey,
    /// `ψ = u / (1 + (u/c)²)`; c = 2.385.
    Cauchy,
}

const HUBER: f64 = 1.345;
const TUKEY: f64 = 4.685;
const CAUCHY: f64 = 2.385;

impl Loss {
    /// ω(u), in 0 to 1.
    pub(crate) fn weight(self, u: f64) -> f64 {
        match self {
            Self::Huber => (HUBER / u.abs()).min(1.0),
            Self::Tukey => biweight(u / TUKEY),
            Self::Cauchy => 1.0 / (1.0 + (u / CAUCHY) * (u / CAUCHY)),
        }
    }

    /// ψ(u).
    pub(crate) fn influence(self, u: f64) -> f64 {
        if u == 0.0 { 0.0 } else { self.weight(u) * u }
    }

    /// ψ'(u).
    pub(crate) fn slope(self, u: f64) -> f64 {
        match self {
            Self::Huber => f64::from(u8::from(u.abs() <= HUBER)),
            Self::Tukey => {
                let v = (u / TUKEY) * (u / TUKEY);
                if v < 1.0 { (1.0 - v) * (1.0 - 5.0 * v) } else { 0.0 }
            }
            Self::Cauchy => {
                let v = (u / CAUCHY) * (u / CAUCHY);
                (1.0 - v) / ((1.0 + v) * (1.0 + v))
            }
        }
    }

    /// Whether ψ falls again, so that far residuals have little influence or none.
    pub(crate) const fn redescends(self) -> bool {
        matches!(self, Self::Tukey | Self::Cauchy)
    }
}

/// `(1 − v²)²` up to 1, 0 beyond: Tukey's weight.
pub(super) fn biweight(v: f64) -> f64 {
    let left = 1.0 - v * v;
    if v.abs() < 1.0 { left * left } else { 0.0 }
}

/// `1 − (1 − v²)³` up to 1, 1 beyond: Tukey's loss, from 0 to 1.
pub(super) fn biweight_loss(v: f64) -> f64 {
    let left = (1.0 - v * v).max(0.0);
    1.0 - left * left * left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::normal_quantile;

    #[test]
    fn analytic_constants_give_95_percent_efficiency() {
        // E over a standard normal as the mean over its quantiles.
        let points: Vec<f64> = (0..200_000).map(|k| normal_quantile((f64::from(k) + 0.5) / 200_000.0)).collect();
        let mean = |f: &dyn Fn(f64) -> f64| points.iter().map(|&u| f(u)).sum::<f64>() / points.len() as f64;
        for loss in [Loss::Huber, Loss::Tukey, Loss::Cauchy] {
            let slope = mean(&|u| loss.slope(u));
            let efficiency = slope * slope / mean(&|u| loss.influence(u) * loss.influence(u));
            assert!((efficiency - 0.95).abs() < 2e-3, "{loss:?}: {efficiency}");
        }
        // The loss behind the S-estimate has expectation ½ at its constant.
        let half = mean(&|u| biweight_loss(u / super::super::scale::S_CONSTANT));
        assert!((half - 0.5).abs() < 1e-4, "{half}");
    }

    #[test]
    fn analytic_slopes_are_differences_of_the_influence() {
        for loss in [Loss::Huber, Loss::Tukey, Loss::Cauchy] {
            for u in [-6.0, -3.0, -1.0, -0.2, 0.0, 0.3, 1.1, 2.0, 4.0, 5.0] {
                let slope = (loss.influence(u + 1e-6) - loss.influence(u - 1e-6)) / 2e-6;
                assert!((slope - loss.slope(u)).abs() < 1e-6, "{loss:?} {u}");
            }
        }
    }
}
