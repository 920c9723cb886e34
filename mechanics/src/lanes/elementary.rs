//! Sine, cosine, the exponential and the hyperbolic tangent without branches, so that several runs can share one evaluation.
//!
//! ```text
//! x = k π/2 + r, |r| ≤ π/4:       sin r = r + r³ S(r²)       cos r = 1 − r²/2 + r⁴ C(r²)
//! −2|x| = k ln 2 + r:             e^r = (A + rB) / (A − rB)  tanh |x| = (1 − e^{−2|x|}) / (1 + e^{−2|x|})
//! ```
//! `S` and `C` are the minimax polynomials of W. Kahan's reduction as published in FDLIBM 5.3 (Sun Microsystems, 1993);
//! `A` and `B` the diagonal Padé approximant of order 6, whose error on |r| ≤ ln 2 / 2 is 2e-19. Bits depend on nothing
//! but IEEE arithmetic.

use super::lane::Lane;

/// First 33 bits of π/2, and what is left of it: `k` times the first is exact up to |k| = 2²⁰.
const HALF_PI: [f64; 2] = [1.570_796_326_734_125_6, 6.077_100_506_506_192e-11];
/// First 32 bits of ln 2, and what is left of it.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// Sine and cosine, within 1.5 units in the last place of 1 for |x| < 10⁵ rad.
#[inline(always)]
pub fn sin_cos<V: Lane>(x: V) -> (V, V) {
    let c = |value: f64| x.splat(value);
    let k = (x * c(std::f64::consts::FRAC_2_PI)).nearest();
    let r = (x - k * c(HALF_PI[0])) - k * c(HALF_PI[1]);
    let z = r * r;
    let s = c(1.589_690_995_211_55e-10);
    let s = z * s + c(-2.505_076_025_340_686_3e-08);
    let s = z * s + c(2.755_731_370_707_006_8e-06);
    let s = z * s + c(-0.000_198_412_698_298_579_5);
    let s = z * s + c(0.008_333_333_333_322_49);
    let s = z * s + c(-0.166_666_666_666_666_32);
    let sine = r + r * z * s;
    let p = c(-1.135_964_755_778_819_5e-11);
    let p = z * p + c(2.087_572_321_298_175e-09);
    let p = z * p + c(-2.755_731_435_139_066_3e-07);
    let p = z * p + c(2.480_158_728_947_673e-05);
    let p = z * p + c(-0.001_388_888_888_887_411);
    let p = z * p + c(0.041_666_666_666_666_6);
    let cosine = c(1.0) - (z * c(0.5) - z * z * p);
    // k mod 4 as −2, −1, 0, 1 or 2: whole numbers, exact.
    let quarter = k - (k * c(0.25)).nearest() * c(4.0);
    let odd = quarter * quarter;
    // odd = 1 swaps sine and cosine; 0 and 4 do not.
    let swap = |a: V, b: V| (odd - c(1.0)).magnitude().less(c(0.5), a, b);
    let (a, b) = (swap(cosine, sine), swap(sine, cosine));
    // sin is negative for quarter −1 and ±2, cos for 1 and ±2.
    let half = c(1.5).less(quarter.magnitude(), -c(1.0), c(1.0));
    let sign_sine = quarter.less(c(-0.5), c(-1.0), half);
    let sign_cosine = c(0.5).less(quarter, c(-1.0), half);
    (sign_sine * a, sign_cosine * b)
}

/// Hyperbolic tangent, within 4e-16; exactly ±1 beyond ±20.
#[inline(always)]
pub fn tanh<V: Lane>(x: V) -> V {
    let c = |value: f64| x.splat(value);
    let far = x.magnitude();
    if far.reaches(20.0) {
        // The bits of what follows: most joints in motion are here.
        return x.less(c(0.0), c(-1.0), c(1.0));
    }
    // In this order NaN stays NaN.
    let (a, b, scale) = exponential(c(20.0).smaller(far) * c(-2.0));
    let (below, above) = (a - b, (a + b) * scale);
    let size = (below - above).over(below + above);
    x.less(c(0.0), -size, size)
}

/// `eˣ`, within 4 units in the last place for |x| < 690; beyond, as at ±690.
#[inline(always)]
pub fn exp<V: Lane>(x: V) -> V {
    let c = |value: f64| x.splat(value);
    // In this order NaN stays NaN.
    let (a, b, scale) = exponential(-c(690.0).smaller(-c(690.0).smaller(x)));
    (a + b).over(a - b) * scale
}

/// `eˣ = (a + b)/(a − b) · scale`, a power of two: Padé's fraction of the rest of x modulo ln 2.
#[inline(always)]
fn exponential<V: Lane>(x: V) -> (V, V, V) {
    let c = |value: f64| x.splat(value);
    let k = (x * c(std::f64::consts::LOG2_E)).nearest();
    let r = (x - k * c(LN_2[0])) - k * c(LN_2[1]);
    let z = r * r;
    let a = c(1.0) + z * (c(5.0 / 44.0) + z * (c(1.0 / 792.0) + z * c(1.0 / 665_280.0)));
    let b = r * (c(0.5) + z * (c(1.0 / 66.0) + z * c(1.0 / 15_840.0)));
    (a, b, k.power_of_two())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_sine_and_cosine_agree_with_libm() {
        let mut worst: f64 = 0.0;
        for k in -200_000..200_000 {
            let x = f64::from(k) * 1.234_567e-3 + 1e-9 * f64::from(k % 1000);
            let (s, c) = sin_cos(x);
            worst = worst.max((s - libm::sin(x)).abs()).max((c - libm::cos(x)).abs());
        }
        // One unit in the last place of 1 and the rounding of libm itself.
        assert!(worst <= 2.3e-16, "{worst:e}");
        for k in [-1e5, -7.7e4, 3.3e4, 9.99e4] {
            let (s, c) = sin_cos::<f64>(k);
            assert!((s - libm::sin(k)).abs() + (c - libm::cos(k)).abs() < 5e-16);
        }
        assert!(sin_cos(f64::NAN).0.is_nan());
    }

    #[test]
    fn analytic_exponential_agrees_with_libm() {
        for k in -69_000..69_000 {
            let x = f64::from(k) * 1e-2;
            let expected = libm::exp(x);
            assert!((exp(x) - expected).abs() <= 9e-16 * expected, "{x}");
        }
        assert!(exp(-1e300) < 1e-299 && exp(f64::NAN).is_nan() && (exp(0.0_f64) - 1.0).abs() < f64::MIN_POSITIVE);
    }

    #[test]
    fn analytic_tanh_agrees_with_libm() {
        let mut worst: f64 = 0.0;
        for k in -100_000..100_000 {
            let x = f64::from(k) * 2.5e-4;
            worst = worst.max((tanh(x) - libm::tanh(x)).abs());
        }
        assert!(worst <= 4e-16, "{worst:e}");
        for (x, y) in [(20.0, 1.0), (-1e300, -1.0), (1e300, 1.0), (0.0, 0.0)] {
            assert!((tanh::<f64>(x) - y).abs() < f64::MIN_POSITIVE);
        }
        assert!(tanh(f64::NAN).is_nan());
    }
}
