//! The tail of the F distribution.

/// Change of a continued fraction that is rounding.
const ROUNDING: f64 = 1e-16;

/// Terms of a continued fraction at most: √ν are enough.
const TERMS: usize = 100_000;

/// Degrees of freedom beyond which a variance counts as known: the tail then changes by (ν₁ F)²/4e7 of itself.
const MANY: f64 = 1e7;

/// Probability that a ratio of two variances with `first` and `second` degrees of freedom is above `f`: 1 where `f` is not positive,
/// NaN where it is none or a number of degrees of freedom is not positive.
///
/// ```text
/// Q = I_x(ν₂/2, ν₁/2)        x = ν₂/(ν₂ + ν₁ F)        I the regularised incomplete beta function
/// ```
/// By the continued fraction of *NIST Digital Library of Mathematical Functions*, 8.17.22, on the side on which it converges; within
/// 1e-9 of itself for up to 1e6 degrees of freedom. For more than 1e7 it is the tail of χ²/ν₁ (8.7.1, 8.9.2).
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::statistics::f_tail;
/// // With 2 and 2 degrees of freedom the tail is 1/(1 + F).
/// assert!((f_tail(3.0, 2.0, 2.0) - 0.25).abs() < 1e-15);
/// ```
pub fn f_tail(f: f64, first: f64, second: f64) -> f64 {
    let is_sound = first > 0.0 && second > 0.0 && first.is_finite();
    if f.is_nan() || !is_sound {
        return f64::NAN;
    }
    if f <= 0.0 {
        return 1.0;
    }
    if f.is_infinite() {
        return 0.0;
    }
    let (a, b) = (0.5 * second, 0.5 * first);
    let product = b * f;
    if second > MANY {
        return gamma_tail(b, product);
    }
    let (x, rest) = (a / (a + product), product / (a + product));
    // ln x^a (1 − x)^b / B(a, b); of x by what it lacks to one.
    let front = a * libm::log1p(-rest) + b * libm::log(rest) - log_beta(a, b);
    if x < (a + 1.0) / (a + b + 2.0) {
        libm::exp(front) * fraction(x, a, b) / a
    } else {
        1.0 - libm::exp(front) * fraction(rest, b, a) / b
    }
}

/// `Γ(a, x)/Γ(a)`.
fn gamma_tail(a: f64, x: f64) -> f64 {
    let front = libm::exp(a * libm::log(x) - x - libm::lgamma(a));
    if x < a + 1.0 {
        let (mut sum, mut term, mut k) = (0.0, 1.0 / a, 0.0);
        while term > ROUNDING * sum {
            sum += term;
            k += 1.0;
            term *= x / (a + k);
        }
        return 1.0 - front * sum;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / f64::MIN_POSITIVE;
    let mut d = 1.0 / b;
    let mut value = d;
    for k in 1..TERMS {
        let k = k as f64;
        b += 2.0;
        d = 1.0 / (b - k * (k - a) * d);
        c = b - k * (k - a) / c;
        value *= c * d;
        if (c * d - 1.0).abs() <= ROUNDING {
            break;
        }
    }
    front * value
}

/// `ln B(a, b)`, without the difference of two large logarithms where a is large.
fn log_beta(a: f64, b: f64) -> f64 {
    const LARGE: f64 = 1e3;
    if a < LARGE {
        return libm::lgamma(a) + libm::lgamma(b) - libm::lgamma(a + b);
    }
    // Stirling's series of both.
    let rest = |x: f64| (1.0 / 12.0 - (1.0 / 360.0 - 1.0 / (1260.0 * x * x)) / (x * x)) / x;
    let ratio = (a - 0.5) * libm::log1p(b / a) + b * libm::log(a + b) - b;
    libm::lgamma(b) - ratio + rest(a) - rest(a + b)
}

/// The continued fraction of `I_x(a, b) a B(a, b) / (x^a (1 − x)^b)`, by Lentz's method.
fn fraction(x: f64, a: f64, b: f64) -> f64 {
    let tiny = |value: f64| if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / tiny(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for m in 1..TERMS {
        let m = m as f64;
        let mut change = 1.0;
        for coefficient in [
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0)),
        ] {
            d = 1.0 / tiny(1.0 + coefficient * d);
            c = tiny(1.0 + coefficient / c);
            change = c * d;
            value *= change;
        }
        if (change - 1.0).abs() <= ROUNDING {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scipy_tails() {
        for line in include_str!("f_tails.csv").lines().skip(1) {
            let [f, first, second, expected] =
                line.split(',').map(|text| text.parse::<f64>().unwrap()).collect::<Vec<_>>()[..]
            else {
                panic!("{line}")
            };
            let found = f_tail(f, first, second);
            assert!((found / expected - 1.0).abs() < 1e-9, "{line}: {found}");
        }
    }

    #[test]
    fn identity_closed_forms() {
        // F of (2, ν): (1 + 2F/ν)^(−ν/2); of (1, ν) the square of Student's t; a known variance gives χ².
        for f in [0.1_f64, 1.0, 4.0, 40.0] {
            for second in [1.0, 2.0, 7.5, 60.0, 2000.0] {
                let expected = (1.0 + 2.0 * f / second).powf(-0.5 * second);
                assert!((f_tail(f, 2.0, second) / expected - 1.0).abs() < 1e-11 * second.max(1.0), "{f} {second}");
            }
            assert!((f_tail(f, 2.0, f64::INFINITY) / libm::exp(-f) - 1.0).abs() < 1e-12, "{f}");
        }
        let t = crate::statistics::student_quantile(0.975, 12.0);
        assert!((f_tail(t * t, 1.0, 12.0) - 0.05).abs() < 1e-13);
        let limit = crate::statistics::chi_squared_quantile(0.95, 6.0);
        assert!((f_tail(limit / 6.0, 6.0, f64::INFINITY) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_ratio_is_said() {
        assert_eq!((f_tail(0.0, 3.0, 4.0), f_tail(f64::INFINITY, 3.0, 4.0)), (1.0, 0.0));
        assert!(f_tail(f64::NAN, 3.0, 4.0).is_nan() && f_tail(1.0, 0.0, 4.0).is_nan());
    }
}
