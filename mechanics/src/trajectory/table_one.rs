//! `radkhah2007` Table I: the trajectory of its experiments, as printed and as it must have been.
//!
//! The printed start angles (IV.C) follow from the printed coefficients with ω = 2π/10 s for five joints, and for
//! joint 1 once its b5 is read as −0.150 (printed +0.150). The table's angles are Denavit–Hartenberg angles, while
//! the robot's own zero is the arm straight up:
//!
//! ```text
//! q2 = q2_table − 90°,   q3 = q3_table + 90°
//! ```
//! which brings the whole trajectory inside the arm's limits. The printed sign of joint 3's start angle, +38.01
//! degrees, is a misprint as well: its own end angle is −38.00.

use std::f64::consts::FRAC_PI_2;

use super::fourier::{FourierJoint, FourierTrajectory};

/// Velocity amplitudes a of joints 1 to 6, rad/s, harmonics 1 to 5.
const A: [[f64; 5]; 6] = [
    [0.156, -0.478, 0.078, -0.388, -0.070],
    [0.064, -0.335, 0.451, 0.292, 1.046],
    [0.634, -0.421, 0.216, -0.310, -0.357],
    [-0.197, -0.282, 0.173, 0.154, -0.095],
    [0.499, -0.135, -0.112, -0.263, -0.086],
    [0.435, 0.111, -0.245, -0.162, -0.442],
];

/// Velocity amplitudes b, rad/s.
const B: [[f64; 5]; 6] = [
    [0.088, 0.253, -0.207, 0.549, 0.150],
    [-0.125, 0.292, -0.369, 0.557, 0.964],
    [-0.359, 0.112, -0.128, -0.069, 0.183],
    [0.408, -0.714, 0.267, 0.291, 0.751],
    [0.552, 0.085, -0.184, -0.065, 0.116],
    [-0.017, -0.178, 0.340, -0.552, -0.089],
];

/// Mean positions q0, rad.
const Q0: [f64; 6] = [0.0, 1.813, -1.184, 0.087, -0.415, 0.124];

/// Its period: 18 of them are the 180 s of the experiments.
const PERIOD_S: f64 = 10.0;

/// Table I as it is printed, in the angles it is printed in.
pub fn printed() -> FourierTrajectory {
    let joints =
        (0..6).map(|i| FourierJoint { name: format!("joint{}", i + 1), a: A[i].to_vec(), b: B[i].to_vec(), q0: Q0[i] });
    FourierTrajectory { period_s: PERIOD_S, joints: joints.collect() }
}

/// Table I with b5 of joint 1 as −0.150 and the angles counted from the arm straight up, as in the robot file.
pub fn corrected() -> FourierTrajectory {
    let mut trajectory = printed();
    trajectory.joints[0].b[4] = -0.150;
    trajectory.joints[1].q0 -= FRAC_PI_2;
    trajectory.joints[2].q0 += FRAC_PI_2;
    trajectory
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::PeriodicMotion;
    use crate::trajectory::Trajectory;

    fn start_deg(trajectory: &FourierTrajectory) -> [f64; 6] {
        let (mut q, mut qd, mut qdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
        trajectory.evaluate(0.0, &mut q, &mut qd, &mut qdd);
        q.map(f64::to_degrees)
    }

    #[test]
    fn published_start_angles_are_recovered() {
        // Section IV.C, with the sign of joint 3 as in its end angle.
        let published = [-23.04, 82.94, -38.01, -28.08, -73.00, 20.64];
        let found = start_deg(&corrected());
        let offset = [0.0, 90.0, -90.0, 0.0, 0.0, 0.0];
        for i in 0..6 {
            assert!((found[i] + offset[i] - published[i]).abs() < 0.1, "joint {}: {}", i + 1, found[i]);
        }
        // As printed, joint 1 would start 5.5 degrees off: the sign of its b5 is a misprint.
        assert!((start_deg(&printed())[0] - published[0]).abs() > 5.0);
    }

    #[test]
    fn published_peak_speeds_and_position_ranges() {
        // Peak speeds, deg/s, and ranges of joints 2 and 3, deg, as an independent computation found them.
        let trajectory = corrected();
        for (i, speed) in [96.0, 119.0, 72.0, 95.0, 60.0, 89.0].into_iter().enumerate() {
            let peak = trajectory.curve(i, 1).peak().to_degrees();
            assert!((peak - speed).abs() < 0.5, "joint {}: {peak} deg/s", i + 1);
        }
        for (i, low, high) in [(1, -54.0, 58.0), (2, -73.0, 80.0)] {
            let q = trajectory.position(i);
            let (from, to) = (q.minimum().value.to_degrees(), q.maximum().value.to_degrees());
            assert!((from - low).abs() < 0.6 && (to - high).abs() < 0.6, "joint {}: {from} to {to}", i + 1);
        }
    }
}
