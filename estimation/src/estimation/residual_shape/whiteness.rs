//! Whether the residual of a joint is white in time.

use crate::statistics::f_tail;

/// Lags that are tested together, at most.
const LAGS: usize = 20;

/// p-values below this are written as less than it.
const LEAST: f64 = 1e-6;

/// Autocorrelation of a joint's residual, and the test of Ljung and Box.
///
/// ```text
/// ρ_l = c Σ_k r_k r_k+l / Σ_k r_k²,  c = M/M_l        Q = M (M + 2) Σ_l ρ_l² / (M − l) ~ χ²(h)  where r is white
/// ```
/// over pairs of which both are equations, M_l of them. G. M. Ljung, G. E. P. Box, "On a measure of lack of fit in time series models",
/// Biometrika 65(2), 1978. The fitted parameters take a little of the correlation away; of many equations that is not seen.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Whiteness {
    /// Time between two equations, s.
    pub step_s: f64,
    /// ρ_1 … ρ_h.
    pub autocorrelation: Vec<f64>,
    /// What |ρ| of white noise stays below in 95 % of cases.
    pub limit: f64,
    /// Q.
    pub statistic: f64,
    /// Its p-value, adjusted (Holm) over the joints.
    pub p_adjusted: f64,
}

impl Whiteness {
    /// Of residuals with `None` where a sample is no equation; `p_adjusted` is not adjusted yet. `None` of fewer than 10 equations.
    pub(super) fn of(residual: &[Option<f64>], step_s: f64) -> Option<Self> {
        let known: Vec<f64> = residual.iter().flatten().copied().collect();
        let (count, power) = (known.len(), known.iter().map(|r| r * r).sum::<f64>());
        if count < 10 || power <= 0.0 {
            return None;
        }
        let m = count as f64;
        let (mut autocorrelation, mut statistic) = (Vec::new(), 0.0);
        for lag in 1..=LAGS.min(count / 5) {
            let pairs = residual.iter().zip(residual.iter().skip(lag)).filter_map(|(a, b)| Some((*a)? * (*b)?));
            let (mut sum, mut of_lag) = (0.0, 0_usize);
            for product in pairs {
                sum += product;
                of_lag += 1;
            }
            let rho = if of_lag > 0 { (m / of_lag as f64) * sum / power } else { 0.0 };
            autocorrelation.push(rho);
            // The variance of ρ is that of a mean over the pairs.
            statistic += (m + 2.0) / m * of_lag as f64 * rho * rho;
        }
        let h = autocorrelation.len() as f64;
        let p_adjusted = f_tail(statistic / h, h, f64::INFINITY);
        Some(Self { step_s, autocorrelation, limit: 1.96 / m.sqrt(), statistic, p_adjusted })
    }

    /// Whether the residual is taken to be white, at 5 % over all joints.
    pub fn is_white(&self) -> bool {
        self.p_adjusted >= 0.05
    }

    /// The sentence that the autocorrelation supports.
    pub fn sentence(&self, joint: &str) -> String {
        let (lags, first) = (self.autocorrelation.len(), self.autocorrelation.first().copied().unwrap_or(0.0));
        let test = format!("Ljung–Box of {lags} lags {}", probability(self.p_adjusted));
        if self.is_white() {
            return format!("{joint}: white as far as {lags} lags show (lag-1 autocorrelation {first:.2}, {test}).");
        }
        let sum: f64 = self.autocorrelation.iter().take_while(|&&rho| rho > self.limit).sum();
        let narrow = (1.0 + 2.0 * sum).max(0.0).sqrt();
        let so = if narrow > 1.05 {
            format!("; intervals that take equations as independent would be about {narrow:.1} times too narrow")
        } else {
            String::new()
        };
        format!("{joint}: not white: lag-1 autocorrelation {first:.2} at {:.3} s, {test}{so}.", self.step_s)
    }
}

/// `p = 0.12`, `p = 0.003`, `p = 2e-4`, `p < 1e-6`.
pub(in crate::estimation) fn probability(p: f64) -> String {
    if p < LEAST {
        "p < 1e-6".to_owned()
    } else if p < 0.001 {
        format!("p = {p:.0e}")
    } else if p < 0.01 {
        format!("p = {p:.3}")
    } else {
        format!("p = {p:.2}")
    }
}
