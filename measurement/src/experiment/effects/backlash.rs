//! A gap between the flanks of a drive.
//!
//! ```text
//! u(δ) = ρ δ                          |δ| ≤ b/2        δ = motor − link, u what winds the spring, b the gap
//! u(δ) = sgn(δ) (|δ| − b/2 + ρ b/2)   beyond           ρ = 0.02
//! ```
//! A dead zone; `ρ` is what grease and rounded flanks leave of the stiffness inside the gap, assumed, so that torque
//! says where in the gap the motor is.

/// Share of the stiffness inside the gap.
const SOFT: f64 = 0.02;

/// Wind-up at the angle `delta` of the motor before its link, with a gap of `gap` rad; and its slope du/dδ.
pub(super) fn contact(delta: f64, gap: f64) -> (f64, f64) {
    let half = 0.5 * gap;
    if delta.abs() <= half {
        (SOFT * delta, if gap > 0.0 { SOFT } else { 1.0 })
    } else {
        (delta - (1.0 - SOFT) * half.copysign(delta), 1.0)
    }
}

/// The angle of the motor before its link that winds the spring by `u`: the inverse of [`contact`].
pub(super) fn angle(u: f64, gap: f64) -> f64 {
    let half = 0.5 * gap;
    if u.abs() <= SOFT * half { u / SOFT } else { u + (1.0 - SOFT) * half.copysign(u) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_gap_is_crossed_without_torque_and_back() {
        let gap = 1e-3;
        // Far on either side the spring is wound by the same, and the motor has moved by the gap, less the soft rest.
        let (right, left) = (angle(2e-3, gap), angle(-2e-3, gap));
        assert!((right - left - (4e-3 + 0.98 * gap)).abs() < 1e-15);
        for k in -300..=300 {
            let delta = 1e-5 * f64::from(k);
            let (u, slope) = contact(delta, gap);
            assert!((angle(u, gap) - delta).abs() < 1e-15);
            let h = 1e-9;
            let numeric = (contact(delta + h, gap).0 - contact(delta - h, gap).0) / (2.0 * h);
            assert!((numeric - slope).abs() < 1e-4 || (delta.abs() - 0.5 * gap).abs() < 2.0 * h);
        }
        assert_eq!(contact(3e-4, 0.0), (3e-4, 1.0));
        assert_eq!(contact(0.0, 0.0).0, 0.0);
    }
}
