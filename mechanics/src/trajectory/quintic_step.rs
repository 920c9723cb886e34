//! The polynomial of fifth degree that rises from 0 to 1 with slope and curvature zero at both ends.
//!
//! ```text
//! S(u) = 10u³ − 15u⁴ + 6u⁵      S′ = 30u² (1 − u)²      S″ = 60u (1 − u)(1 − 2u)      ∫S = 5/2 u⁴ − 3u⁵ + u⁶
//! ```
//! A ramp runs a path at the speed S; a move from point to point, and a transition that fades in, follow S itself. It
//! stands here alone, so that what is certified and what is commanded are the same bits.
//!
//! Reference: T. Flash, N. Hogan, "The coordination of arm movements", J. Neuroscience 5(7), 1985: S is the path
//! between two points of minimum jerk.

/// S and its derivatives with respect to u at one place.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::QuinticStep;
/// let half = QuinticStep::evaluate(0.5);
/// assert_eq!((half.value, half.slope, half.curvature), (0.5, 1.875, 0.0));
/// assert_eq!(QuinticStep::evaluate(1.0).integral, 0.5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuinticStep {
    /// `∫₀ᵘ S`.
    pub integral: f64,
    /// S.
    pub value: f64,
    /// S′.
    pub slope: f64,
    /// S″.
    pub curvature: f64,
}

impl QuinticStep {
    /// S and its derivatives at `u`, which is taken as 0 below 0 and as 1 above 1.
    pub fn evaluate(u: f64) -> Self {
        let u = u.clamp(0.0, 1.0);
        let cube = u * u * u;
        let rest = (1.0 - u) * (1.0 - u);
        Self {
            integral: cube * u * (2.5 - 3.0 * u + u * u),
            value: cube * (10.0 - 15.0 * u + 6.0 * u * u),
            slope: 30.0 * u * u * rest,
            curvature: 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_each_is_the_derivative_of_the_one_before() {
        let h = 1e-5;
        for k in 1..20 {
            let u = 0.05 * f64::from(k);
            let (before, here, after) =
                (QuinticStep::evaluate(u - h), QuinticStep::evaluate(u), QuinticStep::evaluate(u + h));
            let slope = |of: fn(&QuinticStep) -> f64| (of(&after) - of(&before)) / (2.0 * h);
            // Central differences: h²/6 times a derivative of at most 360.
            assert!((slope(|step| step.integral) - here.value).abs() < 1e-8);
            assert!((slope(|step| step.value) - here.slope).abs() < 1e-8);
            assert!((slope(|step| step.slope) - here.curvature).abs() < 1e-8);
        }
    }

    #[test]
    fn analytic_ends_and_beyond() {
        for below in [QuinticStep::evaluate(0.0), QuinticStep::evaluate(-1.0)] {
            assert_eq!((below.integral, below.value, below.slope, below.curvature), (0.0, 0.0, 0.0, 0.0));
        }
        for above in [QuinticStep::evaluate(1.0), QuinticStep::evaluate(7.0)] {
            assert_eq!((above.integral, above.value, above.slope, above.curvature.abs()), (0.5, 1.0, 0.0, 0.0));
        }
    }
}
