//! The highest point of a curve of one variable, without derivatives.

/// Evaluations of [`climb`] before it settles for what it has.
const CLIMB_EVALUATIONS: usize = 30;

/// The highest point of a curve between `low` and `high`, to `tolerance` in place, from a point `(place, value)` there.
///
/// Brent's method: parabolas where they help, golden sections where not (R. P. Brent, *Algorithms for Minimization
/// without Derivatives*, 1973, ch. 5). It needs neither derivatives nor a smooth curve: efforts have corners, where joints
/// turn round. Where the curve has several peaks it finds one.
pub(crate) fn climb(
    mut value: impl FnMut(f64) -> f64,
    from: (f64, f64),
    (mut low, mut high): (f64, f64),
    tolerance: f64,
) -> (f64, f64) {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let (mut best, mut second, mut third) = (from, from, from);
    let (mut step, mut before) = (0.0_f64, 0.0_f64);
    for _ in 0..CLIMB_EVALUATIONS {
        let middle = 0.5 * (low + high);
        if (best.0 - middle).abs() <= 2.0 * tolerance - 0.5 * (high - low) {
            break;
        }
        // The vertex of the parabola through the three best points.
        let r = (best.0 - second.0) * (best.1 - third.1);
        let s = (best.0 - third.0) * (best.1 - second.1);
        let vertex = 0.5 * ((best.0 - third.0) * s - (best.0 - second.0) * r) / (r - s);
        let helps = vertex.abs() < 0.5 * before.abs() && low < best.0 + vertex && best.0 + vertex < high;
        (before, step) = if helps {
            (step, vertex)
        } else {
            let side = if best.0 < middle { high - best.0 } else { low - best.0 };
            (side, GOLDEN * side)
        };
        let least = tolerance.copysign(if helps { middle - best.0 } else { step });
        let place = best.0 + if step.abs() < tolerance { least } else { step };
        let trial = (place, value(place));
        let (end, other) = if place > best.0 { (&mut high, &mut low) } else { (&mut low, &mut high) };
        if trial.1 >= best.1 {
            *other = best.0;
            (best, second, third) = (trial, best, second);
        } else {
            *end = place;
            if trial.1 >= second.1 || second.0 == best.0 {
                (second, third) = (trial, second);
            } else if trial.1 >= third.1 || third.0 == best.0 || third.0 == second.0 {
                third = trial;
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_climbs_to_the_top_of_smooth_and_pointed_hills() {
        let mut evaluations = 0;
        let smooth = |x: f64| -(x - 0.3).powi(2) * (1.0 + 0.2 * x);
        let (place, height) = climb(
            |x| {
                evaluations += 1;
                smooth(x)
            },
            (0.0, smooth(0.0)),
            (-1.0, 1.0),
            1e-3,
        );
        assert!((place - 0.3).abs() < 1e-3 && height > -1e-6 && evaluations < 12, "{place} {height} {evaluations}");
        // Corners, even, steep on one side, and a jump: at 0.3.
        let pointed = |x: f64| -(x - 0.3).abs();
        let steep = |x: f64| if x < 0.3 { x } else { 0.3 - 50.0 * (x - 0.3) };
        let jump = |x: f64| if x < 0.3 { x } else { -5.0 - x };
        for hill in [&pointed as &dyn Fn(f64) -> f64, &steep, &jump] {
            for from in [-0.9, 0.0, 0.25, 0.29] {
                let (place, _) = climb(hill, (from, hill(from)), (-1.0, 1.0), 1e-3);
                assert!((place - 0.3).abs() < 2e-3, "{from}: {place}");
            }
        }
        // The top at an end, and the start there.
        let (place, _) = climb(|x| x, (1.0, 1.0), (0.0, 1.0), 1e-3);
        assert_eq!(place, 1.0);
        let (place, _) = climb(|x| -x, (1.0, -1.0), (0.0, 1.0), 1e-3);
        assert!(place < 2e-3, "{place}");
    }
}
