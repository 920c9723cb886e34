//! Quantiles of the normal and of Student's t distribution.
//!
//! ```text
//! Φ(z) = p        z from 0 by Newton's method          T_ν(t) = p        t from z by Newton's method
//! ```
//! Both distribution functions are concave above their median, so that Newton's method rises to the root from below and
//! never passes it; it ends where rounding stops the rise. All functions come from `libm`: the same bits on every CPU.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// A term below this fraction of the sum is lost in rounding.
const ROUNDING: f64 = 1e-17;

/// From this many degrees of freedom on the asymptotic expansion is exact to the last digits.
const MANY: f64 = 2000.0;

/// The root of an increasing concave function from a point below it; `step` is what Newton's method adds there.
fn rise(mut x: f64, step: impl Fn(f64) -> f64) -> f64 {
    loop {
        let next = x + step(x);
        if next > x {
            x = next;
        } else {
            return x;
        }
    }
}

/// The quantile of the standard normal distribution at probability `p`: infinite at 0 and 1, NaN outside of them.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::normal_quantile;
/// assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-15);
/// assert_eq!(normal_quantile(0.1), -normal_quantile(0.9));
/// ```
pub fn normal_quantile(p: f64) -> f64 {
    if p < 0.5 {
        return -normal_quantile(1.0 - p);
    }
    if p.is_nan() || p >= 1.0 {
        return if p == 1.0 { f64::INFINITY } else { f64::NAN };
    }
    let tail = 1.0 - p;
    let density = |z: f64| libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt();
    rise(0.0, |z| (0.5 * libm::erfc(z * FRAC_1_SQRT_2) - tail) / density(z))
}

/// The quantile of Student's t distribution with `freedom` degrees of freedom at probability `p`; fewer than one degree
/// of freedom, and NaN, count as one.
///
/// ```text
/// T_ν(t) = 1/2 + 1/2 I_y(1/2, ν/2) = 1 − 1/2 I_{1−y}(ν/2, 1/2)        y = t²/(ν + t²)
/// I_x(a, b) = x^a (1 − x)^b / (a B(a, b)) Σ_k x^k Π_{j<k} (a + b + j)/(a + 1 + j)        all terms positive
/// ```
/// of the two the one with the smaller x. Within 1e-13 of the exact value, relatively. Reference: *NIST Digital
/// Library of Mathematical Functions*, 8.17.8; for many degrees of freedom M. Abramowitz and I. A. Stegun, *Handbook of
/// Mathematical Functions*, 26.7.5.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::student_quantile;
/// assert!((student_quantile(0.975, 10.0) - 2.228_138_851_986).abs() < 1e-12);
/// assert!((student_quantile(0.975, f64::INFINITY) - 1.959_963_984_540).abs() < 1e-12);
/// ```
pub fn student_quantile(p: f64, freedom: f64) -> f64 {
    if p < 0.5 {
        return -student_quantile(1.0 - p, freedom);
    }
    let freedom = if freedom >= 1.0 { freedom } else { 1.0 };
    let z = normal_quantile(p);
    if !z.is_finite() {
        return z;
    }
    if freedom >= MANY {
        return expansion(z, freedom);
    }
    // The density at t is `scale (1 + t²/ν)^(−(ν+1)/2)`, and B(1/2, ν/2) scale = 1/√ν.
    let scale = gamma_ratio(0.5 * freedom) / (PI * freedom).sqrt();
    rise(z, |t| {
        let (y, rest) = (t * t / (freedom + t * t), freedom / (freedom + t * t));
        // rest^(ν/2), and the density from it.
        let power = libm::exp(-0.5 * freedom * libm::log1p(t * t / freedom));
        let density = scale * power * rest.sqrt();
        let front = scale * power * y.sqrt();
        let lacking = if y < rest {
            p - 0.5 - front * freedom.sqrt() * series(y, 0.5 * freedom + 0.5, 1.5)
        } else {
            front / freedom.sqrt() * series(rest, 0.5 * freedom + 0.5, 0.5 * freedom + 1.0) - (1.0 - p)
        };
        lacking / density
    })
}

/// `Σ_k x^k Π_{j<k} (c + j)/(d + j)`.
fn series(x: f64, c: f64, d: f64) -> f64 {
    let (mut sum, mut term, mut k) = (0.0, 1.0, 0.0);
    while term > ROUNDING * sum {
        sum += term;
        term *= x * (c + k) / (d + k);
        k += 1.0;
    }
    sum
}

/// `Γ(x + 1/2)/Γ(x)`: Stirling's series for a large argument (DLMF 5.11.13), and from there down by
/// `Γ(x + 1) = x Γ(x)`.
fn gamma_ratio(x: f64) -> f64 {
    const LARGE: f64 = 64.0;
    let (mut large, mut factor) = (x, 1.0);
    while large < LARGE {
        factor *= large / (large + 0.5);
        large += 1.0;
    }
    let u = 1.0 / large;
    let terms = [1.0, -1.0 / 8.0, 1.0 / 128.0, 5.0 / 1024.0, -21.0 / 32768.0, -399.0 / 262_144.0, 869.0 / 4_194_304.0];
    factor * large.sqrt() * terms.iter().rev().fold(0.0, |sum, term| sum * u + term)
}

/// Fisher's expansion of Student's quantile in 1/ν, the normal quantile z first.
fn expansion(z: f64, freedom: f64) -> f64 {
    let z2 = z * z;
    let g = [
        (z2 + 1.0) * z / 4.0,
        ((5.0 * z2 + 16.0) * z2 + 3.0) * z / 96.0,
        (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) * z / 384.0,
        ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) * z / 92_160.0,
    ];
    z + g.iter().rev().fold(0.0, |sum, g| (sum + g) / freedom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_table_of_students_t() {
        // Abramowitz & Stegun, table 26.10.
        for (freedom, t) in [(1.0, 12.706), (2.0, 4.303), (3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            assert!((student_quantile(0.975, freedom) - t).abs() < 6e-4, "{freedom}");
        }
        for (freedom, t) in [(120.0, 1.980), (1e9, 1.960)] {
            assert!((student_quantile(0.975, freedom) - t).abs() < 6e-4, "{freedom}");
        }
    }

    #[test]
    fn mpmath_quantiles() {
        // The roots of betainc(ν/2, 1/2, 0, ν/(ν + t²)) = 2 (1 − p) and of erfc, mpmath 1.3.0 with 40 digits.
        let student = [
            (0.975, 1.5, 6.016663104427928),
            (0.975, 3.0, 3.182446305283708),
            (0.975, 4.0, 2.7764451051977934),
            (0.975, 7.25, 2.3481948491053717),
            (0.975, 20.0, 2.0859634472658644),
            (0.975, 133.3, 1.9779203969579358),
            (0.975, 1999.0, 1.9611514201705615),
            (0.975, 2000.0, 1.9611508260994377),
            (0.975, 59999.0, 1.9600035238369327),
            (0.999999, 2000.0, 4.76748014538776),
            (0.95, 3.0, 2.353363434801823),
            (0.9, 12.0, 1.3562173340232055),
            (0.995, 3.0, 5.840909309733355),
            (0.995, 40.0, 2.7044592674331622),
            (0.9995, 5.0, 6.868826625881275),
        ];
        let normal = [
            (0.6, 0.2533471031357997),
            (0.8, 0.8416212335729144),
            (0.9, 1.2815515655446006),
            (0.95, 1.6448536269514722),
            (0.975, 1.9599639845400538),
            (0.99, 2.3263478740408408),
            (0.995, 2.5758293035489004),
            (0.9995, 3.290526731491926),
            (0.999999, 4.753424308817088),
        ];
        for (p, freedom, expected) in student {
            let found = student_quantile(p, freedom);
            assert!((found / expected - 1.0).abs() < 1e-13, "{p} {freedom}: {found} {expected}");
        }
        for (p, expected) in normal {
            let found = normal_quantile(p);
            assert!((found / expected - 1.0).abs() < 4e-16, "{p}: {found} {expected}");
        }
    }

    #[test]
    fn identity_one_and_two_degrees_of_freedom_have_closed_forms() {
        for p in [0.6, 0.9, 0.975, 0.995] {
            let (one, two) = (libm::tan(PI * (p - 0.5)), (2.0 * p - 1.0) / (2.0 * p * (1.0 - p)).sqrt());
            assert!((student_quantile(p, 1.0) / one - 1.0).abs() < 1e-13, "{p}");
            assert!((student_quantile(p, 2.0) / two - 1.0).abs() < 1e-13, "{p}");
        }
    }

    #[test]
    fn what_is_no_probability_is_said() {
        assert_eq!(normal_quantile(1.0), f64::INFINITY);
        assert_eq!(student_quantile(0.0, 4.0), f64::NEG_INFINITY);
        assert!(normal_quantile(1.5).is_nan() && normal_quantile(f64::NAN).is_nan());
        assert_eq!(student_quantile(0.975, f64::NAN), student_quantile(0.975, 1.0));
    }
}
