//! Uneven samples onto an even grid.
//!
//! ```text
//! lines    x(t) = x_k + s (x_{k+1} − x_k)                          s = (t − t_k)/(t_{k+1} − t_k)
//! cubic    x(t) = h00 x_k + h10 Δ m_k + h01 x_{k+1} + h11 Δ m_{k+1}      m_k: slope of the parabola through three samples
//! ```
//! Cubic pieces are for what moves smoothly, positions and velocities: a straight line between two samples of a tone of
//! frequency f, Δ apart, is off by `(π f Δ)²/2` of its amplitude and has no acceleration; the cubic by the order `(π f Δ)⁴`.
//! Straight lines are for efforts: they add nothing to their noise.
//!
//! Reference: C. de Boor, *A Practical Guide to Splines*, rev. ed., 2001, ch. IV (Bessel's slopes).

/// How the values between two samples are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Interpolation {
    /// Straight lines.
    Lines,
    /// Cubic pieces with continuous slope.
    Cubic,
}

/// The columns of `rows` (N × `width`, row-major, taken at the rising times `t`, s) at `count` even times, the first at
/// `t[0]`, the others 1/`rate_hz` apart: `count` × `width`. Times behind the last sample take its value.
///
/// ```
/// # use armid_measurement as armid;
/// use armid::signal::{Interpolation, resample};
/// let t = [0.0, 0.1, 0.3, 0.4];
/// let line: Vec<f64> = t.iter().map(|t| 1.0 + 2.0 * t).collect();
/// for way in [Interpolation::Lines, Interpolation::Cubic] {
///     let even = resample(&t, &line, 1, 10.0, 5, way);
///     assert!((even[2] - 1.4).abs() < 1e-12);
/// }
/// ```
///
/// # Panics
/// If `rows` has not `width` values for each time.
pub fn resample(t: &[f64], rows: &[f64], width: usize, rate_hz: f64, count: usize, way: Interpolation) -> Vec<f64> {
    assert_eq!(rows.len(), t.len() * width, "one row per time");
    let mut even = Vec::with_capacity(count * width);
    let Some((&first, &last)) = t.first().zip(t.last()) else { return even };
    let mut k = 0;
    for sample in 0..count {
        let now = (first + sample as f64 / rate_hz).min(last);
        while k + 2 < t.len() && t[k + 1] <= now {
            k += 1;
        }
        let next = (k + 1).min(t.len() - 1);
        let step = t[next] - t[k];
        let s = if step > 0.0 { (now - t[k]) / step } else { 0.0 };
        for i in 0..width {
            let (a, b) = (rows[k * width + i], rows[next * width + i]);
            even.push(match way {
                Interpolation::Lines => a + s * (b - a),
                Interpolation::Cubic => {
                    let slope = |at: usize| step * slope(t, rows, width, i, at);
                    hermite(s, [a, b], [slope(k), slope(next)])
                }
            });
        }
    }
    even
}

/// Slope at a sample of the parabola through it and its neighbours; through the three samples at an end.
fn slope(t: &[f64], rows: &[f64], width: usize, i: usize, at: usize) -> f64 {
    let n = t.len();
    if n < 3 {
        return if n == 2 { (rows[width + i] - rows[i]) / (t[1] - t[0]) } else { 0.0 };
    }
    let middle = at.clamp(1, n - 2);
    let (h0, h1) = (t[middle] - t[middle - 1], t[middle + 1] - t[middle]);
    let d0 = (rows[middle * width + i] - rows[(middle - 1) * width + i]) / h0;
    let d1 = (rows[(middle + 1) * width + i] - rows[middle * width + i]) / h1;
    let curvature = (d1 - d0) / (h0 + h1);
    match at {
        0 => d0 - curvature * h0,
        _ if at == n - 1 => d1 + curvature * h1,
        _ => d0 + curvature * h0,
    }
}

/// The cubic with values `x` and slopes `m` (per unit of s) at s = 0 and s = 1.
fn hermite(s: f64, x: [f64; 2], m: [f64; 2]) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    (2.0 * s3 - 3.0 * s2 + 1.0) * x[0] + (s3 - 2.0 * s2 + s) * m[0] + (3.0 * s2 - 2.0 * s3) * x[1] + (s3 - s2) * m[1]
}

#[cfg(test)]
mod tests {
    use super::{Interpolation, resample};
    use crate::seed::Seed;
    use rand::RngExt;

    /// Rising times, 1 ms apart on average, each step between 0.2 and 1.8 ms.
    fn jittered(n: usize) -> Vec<f64> {
        let mut rng = Seed::new(3).stream("stamps", 0);
        let mut t = 0.0;
        (0..n)
            .map(|_| {
                t += 1e-3 * rng.random_range(0.2..1.8);
                t
            })
            .collect()
    }

    #[test]
    fn identity_even_samples_come_back_and_parabolas_are_exact() {
        let even: Vec<f64> = (0..50).map(|k| f64::from(k) * 0.01).collect();
        let x: Vec<f64> = even.iter().map(|t| libm::sin(20.0 * t)).collect();
        for way in [Interpolation::Lines, Interpolation::Cubic] {
            for (a, b) in resample(&even, &x, 1, 100.0, 50, way).iter().zip(&x) {
                assert!((a - b).abs() < 1e-12);
            }
        }
        let t = jittered(200);
        let parabola: Vec<f64> = t.iter().map(|t| 1.0 - 3.0 * t + 40.0 * t * t).collect();
        let count = ((t[199] - t[0]) * 1000.0) as usize;
        for (k, x) in resample(&t, &parabola, 1, 1000.0, count, Interpolation::Cubic).iter().enumerate() {
            let at = t[0] + k as f64 * 1e-3;
            assert!((x - (1.0 - 3.0 * at + 40.0 * at * at)).abs() < 1e-12, "sample {k}");
        }
    }

    #[test]
    fn analytic_error_on_a_tone_is_within_its_bound() {
        let t = jittered(2000);
        let tone = |t: f64| libm::sin(std::f64::consts::TAU * 5.0 * t);
        let x: Vec<f64> = t.iter().map(|&t| tone(t)).collect();
        let worst = |way| {
            let even = resample(&t, &x, 1, 1000.0, 1800, way);
            even.iter().enumerate().map(|(k, x)| (x - tone(t[0] + k as f64 * 1e-3)).abs()).fold(0.0, f64::max)
        };
        // Largest step 1.8 ms: lines (π f Δ)²/2 = 4e-4; the cubic's slopes see up to two such steps.
        assert!(worst(Interpolation::Lines) < 4.1e-4);
        assert!(worst(Interpolation::Cubic) < 1e-5);
    }

    #[test]
    fn columns_stay_apart_and_the_end_is_held() {
        let (t, rows) = ([0.0, 1.0, 2.0], [0.0, 5.0, 1.0, 5.0, 2.0, 5.0]);
        let even = resample(&t, &rows, 2, 2.0, 6, Interpolation::Cubic);
        assert_eq!(even, [0.0, 5.0, 0.5, 5.0, 1.0, 5.0, 1.5, 5.0, 2.0, 5.0, 2.0, 5.0]);
        assert_eq!(resample(&[], &[], 2, 2.0, 6, Interpolation::Lines), Vec::<f64>::new());
        // t² at uneven times, to its end.
        for (k, x) in resample(&[0.0, 1.0, 3.0], &[0.0, 1.0, 9.0], 1, 2.0, 7, Interpolation::Cubic).iter().enumerate() {
            assert!((x - 0.25 * (k * k) as f64).abs() < 1e-14, "{k}: {x}");
        }
        assert_eq!(resample(&[0.0, 2.0], &[1.0, 5.0], 1, 2.0, 3, Interpolation::Cubic), [1.0, 2.0, 3.0]);
        assert_eq!(resample(&[1.0], &[7.0], 1, 2.0, 2, Interpolation::Cubic), [7.0, 7.0]);
    }
}
