//! The highest point of a curve of one variable, without derivatives.

use std::ops::Range;

/// Evaluations after which [`climb`] takes golden sections alone.
const WITH_PARABOLAS: usize = 30;

/// A point of a curve of one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The variable.
    pub place: f64,
    /// The curve's value there.
    pub value: f64,
}

/// The highest point of a curve inside a range, to `tolerance` in place, from a point `from` of the curve in that range.
///
/// Brent's method: parabolas where they help, golden sections where not (R. P. Brent, *Algorithms for Minimization
/// without Derivatives*, 1973, ch. 5). It needs neither derivatives nor a smooth curve: efforts have corners, where joints
/// turn round. Where the curve has several peaks it finds one.
///
/// It ends at the tolerance and nowhere else. Brent's parabolas may be slow on a curve without curvature: after
/// `WITH_PARABOLAS` evaluations golden sections follow, two of which take away 30 % of the interval at least. A
/// tolerance below the spacing of numbers there counts as that spacing; with an end or a tolerance that is NaN the start
/// is returned.
pub fn climb(
    mut value: impl FnMut(f64) -> f64,
    from: CurvePoint,
    Range { start: mut low, end: mut high }: Range<f64>,
    tolerance: f64,
) -> CurvePoint {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let (mut best, mut second, mut third) = (from, from, from);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    let tolerance = tolerance.max(2.0 * f64::EPSILON * low.abs().max(high.abs()));
    let mut evaluations = 0;
    while (best.place - 0.5 * (low + high)).abs() > 2.0 * tolerance - 0.5 * (high - low) {
        let middle = 0.5 * (low + high);
        // The vertex of the parabola through the three best points.
        let r = (best.place - second.place) * (best.value - third.value);
        let s = (best.place - third.place) * (best.value - second.value);
        let vertex = 0.5 * ((best.place - third.place) * s - (best.place - second.place) * r) / (r - s);
        let inside = low < best.place + vertex && best.place + vertex < high;
        let helps = evaluations < WITH_PARABOLAS && vertex.abs() < 0.5 * before.abs() && inside;
        (before, step) = if helps {
            (step, vertex)
        } else {
            let side = if best.place < middle { high - best.place } else { low - best.place };
            (side, GOLDEN * side)
        };
        let least = tolerance.copysign(if helps { middle - best.place } else { step });
        let place = best.place + if step.abs() < tolerance { least } else { step };
        let trial = CurvePoint { place, value: value(place) };
        evaluations += 1;
        let (end, other) = if place > best.place { (&mut high, &mut low) } else { (&mut low, &mut high) };
        if trial.value >= best.value {
            *other = best.place;
            (best, second, third) = (trial, best, second);
        } else {
            *end = place;
            if trial.value >= second.value || second.place == best.place {
                (second, third) = (trial, second);
            } else if trial.value >= third.value || third.place == best.place || third.place == second.place {
                third = trial;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn top(curve: impl Fn(f64) -> f64, from: f64, inside: Range<f64>, tolerance: f64) -> f64 {
        climb(&curve, CurvePoint { place: from, value: curve(from) }, inside, tolerance).place
    }

    #[test]
    fn analytic_climbs_to_the_top_of_smooth_and_pointed_hills() {
        let mut evaluations = 0;
        let smooth = |x: f64| -(x - 0.3).powi(2) * (1.0 + 0.2 * x);
        let CurvePoint { place, value: height } = climb(
            |x| {
                evaluations += 1;
                smooth(x)
            },
            CurvePoint { place: 0.0, value: smooth(0.0) },
            -1.0..1.0,
            1e-3,
        );
        assert!((place - 0.3).abs() < 1e-3 && height > -1e-6 && evaluations < 12, "{place} {height} {evaluations}");
        // Corners, even, steep on one side, and a jump: at 0.3.
        let pointed = |x: f64| -(x - 0.3).abs();
        let steep = |x: f64| if x < 0.3 { x } else { 0.3 - 50.0 * (x - 0.3) };
        let jump = |x: f64| if x < 0.3 { x } else { -5.0 - x };
        for hill in [&pointed as &dyn Fn(f64) -> f64, &steep, &jump] {
            for from in [-0.9, 0.0, 0.25, 0.29] {
                let place = top(hill, from, -1.0..1.0, 1e-3);
                assert!((place - 0.3).abs() < 2e-3, "{from}: {place}");
            }
        }
        // The top at an end, and the start there.
        assert_eq!(top(|x| x, 1.0, 0.0..1.0, 1e-3), 1.0);
        let place = top(|x| -x, 1.0, 0.0..1.0, 1e-3);
        assert!(place < 2e-3, "{place}");
    }

    #[test]
    fn it_ends_at_the_tolerance_however_fine_and_on_any_curve() {
        // Forty golden sections and more, to the spacing of numbers, where a fixed number of evaluations stopped short.
        for tolerance in [1e-9, 1e-13, 0.0] {
            let place = top(|x| -(x - 0.3).abs(), 0.9, -1.0..1.0, tolerance);
            assert!((place - 0.3).abs() < 3.0 * tolerance + 4e-15, "{tolerance}: {place}");
        }
        for flat in [0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let place = top(|_| flat, 0.5, 0.0..1.0, 1e-6);
            assert!((0.0..=1.0).contains(&place), "{flat}: {place}");
        }
        assert_eq!(top(|x| x, 0.5, 0.0..f64::NAN, 1e-3), 0.5);
        assert_eq!(top(|x| x, 0.5, 0.0..1.0, f64::INFINITY), 0.5);
    }
}
