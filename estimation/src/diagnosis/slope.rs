//! Measured torque against the torque of the robot file's own links, joint by joint: sign and unit of all efforts at once.
//!
//! ```text
//! τ_i = s_i τ̂_i + c_i sgn q̇_i + v_i q̇_i        s_i by least squares; certain where τ̂_i explains half of what friction leaves
//! ```
//! A fit of the parameters is blind to a sign or a factor that all efforts share: negative masses explain reversed torques as well.
//! The robot file's torque need not be good for this: a link that weighs half as much again still has its weight's sign.

use nalgebra::{Matrix3, Vector3};

use super::evidence::{Instants, rms};
use super::mistake::Mistake;
use crate::dynamics::Dynamics;
use crate::model::{Robot, StandardParameters};

/// Joints whose torque by the file is a smaller part of the largest joint's are not looked at.
const LEAST_LOAD: f64 = 0.02;
/// Joints that carry load, by the same measure: a unit shows in them.
const LOADED: f64 = 0.2;
/// Part of the torque that friction leaves that the file's torque must explain for a slope to be certain.
const EXPLAINED: f64 = 0.5;
/// Slopes of a smaller size show no sign: a robot file may be off by this factor, and more where rotors are missing.
const LEAST_SLOPE: f64 = 0.25;
/// Slopes below this are no torques of the joints.
const SMALL: f64 = 0.25;
/// Standard deviations of a slope by which it may be larger; an instant is much like the next.
const DOUBT: f64 = 4.0;

/// One joint.
#[derive(Clone, Copy, Debug)]
struct Slope {
    /// s.
    value: f64,
    /// What its size is not above.
    bound: f64,
    /// Whether the file's torque explains the measured one.
    certain: bool,
    /// RMS of the file's torque.
    load: f64,
    /// Gear of its drive.
    gear: f64,
}

/// Slopes of all joints.
pub(super) struct Slopes(Vec<Slope>);

impl Slopes {
    /// Those of some instants, by the links of a robot file.
    pub(super) fn new(robot: &Robot, nominal: &StandardParameters, instants: &Instants) -> Self {
        let n = robot.dof();
        let mut links = nominal.clone();
        links.drives.iter_mut().for_each(|drive| *drive = Default::default());
        let mut dynamics = Dynamics::new(robot, &links);
        let mut of_file = vec![0.0; instants.tau.len()];
        for (k, tau) in of_file.chunks_exact_mut(n).enumerate() {
            let span = k * n..(k + 1) * n;
            dynamics.inverse(&instants.q[span.clone()], &instants.qd[span.clone()], &instants.qdd[span], tau);
        }
        let of = |i: usize| {
            let (mut normal, mut right, mut square) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
            let column = |table: &[f64]| table.iter().skip(i).step_by(n).copied().collect::<Vec<_>>();
            for ((file, measured), qd) in
                column(&of_file).into_iter().zip(column(&instants.tau)).zip(column(&instants.qd))
            {
                let row = Vector3::new(file, if qd == 0.0 { 0.0 } else { qd.signum() }, qd);
                normal += row * row.transpose();
                right += row * measured;
                square += measured * measured;
            }
            let load = rms(&of_file, i, n);
            let inverse = |normal: Matrix3<f64>| {
                // A joint at rest has no friction to tell apart.
                let ridge = Matrix3::from_diagonal(&normal.diagonal().map(|x| 1e-12 * x + 1e-300));
                (normal + ridge).cholesky().map_or(Matrix3::zeros(), |factor| factor.inverse())
            };
            let covariance = inverse(normal);
            let all = covariance * right;
            // What friction alone leaves, and what is left with the file's torque beside it.
            let mut friction = normal;
            friction.row_mut(0).fill(0.0);
            friction.column_mut(0).fill(0.0);
            let of_friction = inverse(friction) * Vector3::new(0.0, right[1], right[2]);
            let before = square - of_friction[1] * right[1] - of_friction[2] * right[2];
            let after = square - all.dot(&right);
            let certain = before > 0.0 && after <= (1.0 - EXPLAINED) * before;
            let variance = after.max(0.0) / (instants.tau.len() / n).max(1) as f64 * covariance[(0, 0)];
            let bound = all[0].abs() + DOUBT * variance.sqrt();
            Slope { value: all[0], bound, certain, load, gear: robot.joints()[i].drive.gear }
        };
        Self((0..n).map(of).collect())
    }

    /// Joints with at least this part of the largest torque.
    fn loaded(&self, part: f64) -> impl Iterator<Item = &Slope> {
        let largest = self.0.iter().map(|slope| slope.load).fold(0.0, f64::max);
        self.0.iter().filter(move |slope| slope.load > 0.0 && slope.load >= part * largest)
    }

    /// Median of the slopes where all that are certain, at least half of the loaded joints, are of one sign and no small ones.
    pub(super) fn sign(&self) -> Option<f64> {
        let mut certain: Vec<f64> =
            self.loaded(LEAST_LOAD).filter(|slope| slope.certain).map(|slope| slope.value).collect();
        certain.sort_by(f64::total_cmp);
        let (first, last) = (*certain.first()?, *certain.last()?);
        let alike = first * last > 0.0 && certain.iter().all(|slope| slope.abs() >= LEAST_SLOPE);
        (alike && 2 * certain.len() >= self.loaded(LEAST_LOAD).count()).then(|| certain[certain.len() / 2])
    }

    /// What the efforts are where those of all joints, as far as the file's torque explains them, are too small to be torques of the joints.
    pub(super) fn unit(&self) -> Option<Mistake> {
        // Where joints are exchanged, those that are not have their torque.
        if self.loaded(LEAST_LOAD).any(|slope| slope.certain && slope.value.abs() > SMALL) {
            return None;
        }
        let loaded: Vec<&Slope> = self.loaded(LOADED).collect();
        if loaded.is_empty() || loaded.iter().any(|slope| slope.bound > SMALL) {
            return None;
        }
        let at_motors = |slope: &&Slope| {
            slope.gear != 1.0 && libm::log(slope.value * slope.gear).abs() < libm::log(LEAST_SLOPE.recip())
        };
        if loaded.iter().all(|slope| slope.certain && at_motors(slope)) {
            return Some(Mistake::MotorTorques);
        }
        let times = |slope: &&Slope| if slope.certain { slope.value.abs().recip() } else { slope.bound.recip() };
        let all = loaded.iter().map(times).filter(|times| times.is_finite());
        let [least, most] = all.fold([f64::INFINITY, 0.0], |[least, most], x| [f64::min(least, x), f64::max(most, x)]);
        (most > 0.0).then_some(Mistake::EffortsSmall { times: [least, most] })
    }
}
