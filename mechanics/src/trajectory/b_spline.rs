//! Periodic splines: every joint moves along polynomials that meet smoothly at equidistant knots.
//!
//! ```text
//! q(t) = Σ_{k=0}^{K−1} c_k N(K t/T − k)  (repeated with period K)        N(x) the cardinal B-spline of degree 3 or 5
//! q on knot interval i:  Σ_{j=0}^{d} c_{(i−j) mod K} P_j(s),   s = K t/T − i ∈ [0, 1]
//! ```
//! The values c are in rad; since the bumps N add up to 1, equal values stand still, and the motion stays between the
//! smallest and the largest of them. Cubic splines have continuous acceleration, quintic ones continuous snap.
//!
//! Reference: C. de Boor, *A Practical Guide to Splines*, rev. ed., 2001, ch. IX.

use serde::{Deserialize, Serialize};

use super::curve::Curve;
use super::definition::{PeriodicMotion, Trajectory};
use super::error::TrajectoryError;
use super::piecewise::PiecewisePolynomial;

/// `6 P_j(s)` of the cubic, ascending powers.
const CUBIC: [[f64; 4]; 4] =
    [[0.0, 0.0, 0.0, 1.0], [1.0, 3.0, 3.0, -3.0], [4.0, 0.0, -6.0, 3.0], [1.0, -3.0, 3.0, -1.0]];

/// `120 P_j(s)` of the quintic, ascending powers.
const QUINTIC: [[f64; 6]; 6] = [
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
];

/// Coefficient of `s^power` in the derivative of this order of P_j.
pub(super) fn coefficient(degree: usize, j: usize, order: usize, power: usize) -> f64 {
    let (row, scale): (&[f64], f64) = if degree == 3 { (&CUBIC[j], 6.0) } else { (&QUINTIC[j], 120.0) };
    let falling: f64 = (power + 1..=power + order).map(|x| x as f64).product();
    row.get(power + order).map_or(0.0, |c| c * falling / scale)
}

/// The spline of one joint.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BSplineJoint {
    /// Name of the joint.
    pub name: String,
    /// One value for each knot, rad.
    pub c: Vec<f64>,
}

/// A spline trajectory of all joints; each joint may have knots of its own.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{BSplineJoint, BSplineTrajectory, Trajectory};
/// let joint = BSplineJoint { name: "joint1".into(), c: vec![0.4; 7] };
/// let motion = BSplineTrajectory::new(10.0, 3, vec![joint]).unwrap();
/// let (mut q, mut qd, mut qdd) = ([0.0], [0.0], [0.0]);
/// motion.evaluate(1.3, &mut q, &mut qd, &mut qdd);
/// assert!((q[0] - 0.4).abs() < 1e-15 && qd[0].abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct BSplineTrajectory {
    /// Period T, s.
    pub period_s: f64,
    /// Degree d of the polynomials, 3 or 5.
    pub degree: usize,
    /// The joints from the base outwards.
    pub joints: Vec<BSplineJoint>,
}

// Refuses what `BSplineTrajectory::new` refuses.
crate::plain::checked_when_read!(BSplineTrajectory, |value| Self::new(value.period_s, value.degree, value.joints));

impl BSplineTrajectory {
    /// Checks and takes the splines of all joints.
    ///
    /// # Errors
    /// [`TrajectoryError`] if the period is not a finite number above zero, the degree neither 3 nor 5, a joint has fewer
    /// knots than the degree and one more, a value is not finite, or there is no joint.
    pub fn new(period_s: f64, degree: usize, joints: Vec<BSplineJoint>) -> Result<Self, TrajectoryError> {
        if !(period_s.is_finite() && period_s > 0.0) {
            return Err(TrajectoryError::Period { found: period_s });
        }
        if degree != 3 && degree != 5 {
            return Err(TrajectoryError::Degree { found: degree });
        }
        if joints.is_empty() {
            return Err(TrajectoryError::NoJoint);
        }
        for BSplineJoint { name, c } in &joints {
            let joint = || name.clone();
            if c.len() <= degree {
                return Err(TrajectoryError::Knots { joint: joint(), found: c.len(), degree });
            }
            if let Some(&found) = c.iter().find(|value| !value.is_finite()) {
                return Err(TrajectoryError::NotFinite { joint: joint(), found });
            }
        }
        Ok(Self { period_s, degree, joints })
    }

    /// Every segment P_j and its first two derivatives with respect to time at `s`, for joints of this many knots.
    fn segments(&self, knots: usize, s: f64) -> [[f64; 6]; 3] {
        let mut values = [[0.0; 6]; 3];
        let mut rate = 1.0;
        for (order, values) in values.iter_mut().enumerate() {
            for (j, value) in values.iter_mut().enumerate().take(self.degree + 1) {
                let powers = (0..=self.degree - order).rev();
                *value = rate * powers.fold(0.0, |sum, power| sum * s + coefficient(self.degree, j, order, power));
            }
            rate *= knots as f64 / self.period_s;
        }
        values
    }

    /// Derivative of this order on knot interval `i` of a joint, ascending powers of s, in rad and s.
    fn piece(&self, joint: usize, i: usize, order: usize) -> Vec<f64> {
        let c = &self.joints[joint].c;
        let knots = c.len();
        let rate = (knots as f64 / self.period_s).powi(i32::try_from(order).unwrap_or(i32::MAX));
        let mut piece = vec![0.0; self.degree.saturating_sub(order) + 1];
        for j in 0..=self.degree {
            let value = rate * c[(i + knots - j) % knots];
            for (power, sum) in piece.iter_mut().enumerate() {
                *sum += value * coefficient(self.degree, j, order, power);
            }
        }
        piece
    }
}

impl Trajectory for BSplineTrajectory {
    fn dof(&self) -> usize {
        self.joints.len()
    }

    fn period_s(&self) -> f64 {
        self.period_s
    }

    fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let turns = t / self.period_s;
        let u = turns - turns.floor();
        // Joints of equally many knots share the values of the segments.
        let (mut known, mut interval, mut values) = (0, 0, [[0.0; 6]; 3]);
        for (joint, spline) in self.joints.iter().enumerate() {
            let knots = spline.c.len();
            if knots != known {
                let x = u * knots as f64;
                interval = (x.floor() as usize).min(knots - 1);
                values = self.segments(knots, x - interval as f64);
                known = knots;
            }
            let mut motion = [0.0; 3];
            for (sum, values) in motion.iter_mut().zip(&values) {
                for (j, value) in values.iter().enumerate().take(self.degree + 1) {
                    *sum += value * spline.c[(interval + knots - j) % knots];
                }
            }
            (q[joint], qd[joint], qdd[joint]) = (motion[0], motion[1], motion[2]);
        }
    }
}

impl PeriodicMotion for BSplineTrajectory {
    fn names(&self) -> Vec<&str> {
        self.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    fn curve(&self, joint: usize, order: usize) -> Curve {
        let knots = self.joints[joint].c.len();
        Curve::Piecewise(PiecewisePolynomial::uniform((0..knots).map(|i| self.piece(joint, i, order)).collect()))
    }

    fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
        let c = &mut self.joints[joint].c;
        let mean = c.iter().sum::<f64>() / c.len() as f64;
        for value in c {
            if factor != 1.0 {
                *value = mean + factor * (*value - mean);
            }
            *value += shift;
        }
    }

    fn slow_down(&mut self, part: f64) {
        self.period_s /= part;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::piecewise::horner;

    #[test]
    fn published_segments_follow_the_recursion_of_de_boor() {
        // N_d(x) = ( x N_{d−1}(x) + (d+1−x) N_{d−1}(x−1) ) / d, from the box of degree 0.
        let mut segments = vec![vec![1.0]];
        for d in 1..=5_usize {
            let before = |j: usize| segments.get(j).cloned().unwrap_or_else(|| vec![0.0; d]);
            let next: Vec<Vec<f64>> = (0..=d)
                .map(|j| {
                    let mut piece = vec![0.0; d + 1];
                    let left = if j < d { before(j) } else { vec![0.0; d] };
                    let right = if j > 0 { before(j - 1) } else { vec![0.0; d] };
                    for power in 0..d {
                        piece[power] += (j as f64 * left[power] + (d + 1 - j) as f64 * right[power]) / d as f64;
                        piece[power + 1] += (left[power] - right[power]) / d as f64;
                    }
                    piece
                })
                .collect();
            segments = next;
            if d == 3 || d == 5 {
                for (j, expected) in segments.iter().enumerate() {
                    let found: Vec<f64> = (0..=d).map(|power| coefficient(d, j, 0, power)).collect();
                    assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-14), "{d} {j} {found:?}");
                }
            }
        }
    }

    #[test]
    fn identity_pieces_meet_with_continuous_derivatives() {
        for (degree, continuous) in [(3, 2), (5, 4)] {
            let c: Vec<f64> = (0..9).map(|k| libm::sin(f64::from(k * k))).collect();
            let joint = BSplineJoint { name: String::new(), c };
            let motion = BSplineTrajectory::new(2.0, degree, vec![joint]).unwrap();
            for order in 0..=continuous {
                for i in 0..9 {
                    let (end, begin) =
                        (horner(&motion.piece(0, i, order), 1.0), motion.piece(0, (i + 1) % 9, order)[0]);
                    assert!((end - begin).abs() < 1e-10, "degree {degree} order {order}: {end} {begin}");
                }
            }
            let (end, begin) = (horner(&motion.piece(0, 0, degree), 1.0), motion.piece(0, 1, degree)[0]);
            assert!((end - begin).abs() > 1.0);
        }
    }

    #[test]
    fn faults_say_what_was_found() {
        let joint = |c: Vec<f64>| BSplineJoint { name: "elbow".into(), c };
        let text = |result: Result<BSplineTrajectory, TrajectoryError>| result.unwrap_err().to_string();
        assert!(text(BSplineTrajectory::new(1.0, 4, vec![joint(vec![0.0; 9])])).contains("degree is 4"));
        assert!(text(BSplineTrajectory::new(1.0, 5, vec![joint(vec![0.0; 5])])).contains("at least 6"));
        assert!(text(BSplineTrajectory::new(1.0, 3, vec![joint(vec![f64::NAN; 5])])).contains("\"elbow\" is NaN"));
    }
}
