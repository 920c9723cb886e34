//! Quantiles of χ².

/// Part of a sum that is rounding.
const ROUNDING: f64 = 1e-17;

/// The value that a sum of `freedom` squared standard normal variables stays below with probability `p`.
///
/// ```text
/// P(a, x) = x^a e^(−x) / Γ(a + 1) Σ_k x^k / ((a + 1) ⋯ (a + k))        p = P(ν/2, χ²/2)
/// ```
/// Found by halving an interval to its last bit. NaN where `p` is no probability below one or `freedom` is not positive. Reference:
/// *NIST Digital Library of Mathematical Functions*, 8.7.1.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::chi_squared_quantile;
/// assert!((chi_squared_quantile(0.95, 10.0) - 18.307_038_053_275).abs() < 1e-11);
/// ```
pub fn chi_squared_quantile(p: f64, freedom: f64) -> f64 {
    if !((0.0..1.0).contains(&p) && freedom > 0.0 && freedom.is_finite()) {
        return f64::NAN;
    }
    let a = 0.5 * freedom;
    let below = |x: f64| {
        if x <= 0.0 {
            return 0.0;
        }
        let (mut sum, mut term, mut k) = (0.0, 1.0, 0.0);
        while term > ROUNDING * sum {
            sum += term;
            k += 1.0;
            term *= x / (a + k);
        }
        libm::exp(a * libm::log(x) - x - libm::lgamma(a + 1.0)) * sum
    };
    let (mut low, mut high) = (0.0, a + 1.0);
    while below(high) < p {
        (low, high) = (high, 2.0 * high);
    }
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return 2.0 * high;
        }
        if below(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_table_of_chi_squared() {
        // M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, table 26.8.
        for (p, freedom, expected) in [
            (0.95, 1.0, 3.841_46),
            (0.95, 5.0, 11.070_5),
            (0.95, 30.0, 43.772_9),
            (0.95, 100.0, 124.342),
            (0.05, 10.0, 3.940_30),
            (0.5, 2.0, 1.386_29),
        ] {
            let found = chi_squared_quantile(p, freedom);
            assert!((found / expected - 1.0).abs() < 5e-6, "{p} {freedom}: {found}");
        }
    }

    #[test]
    fn identity_two_degrees_of_freedom_have_a_closed_form() {
        for p in [1e-6, 0.3, 0.95, 0.999_999] {
            let exact = -2.0 * libm::log1p(-p);
            assert!((chi_squared_quantile(p, 2.0) / exact - 1.0).abs() < 1e-9, "{p}");
        }
        assert!(chi_squared_quantile(1.0, 2.0).is_nan() && chi_squared_quantile(0.5, 0.0).is_nan());
    }
}
