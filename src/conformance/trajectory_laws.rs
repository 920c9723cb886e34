//! What every periodic motion obeys.
//!
//! ```text
//! q(t + T) = q(t)      ∫ q̇ dt = Δq      ∫ q̈ dt = Δq̇      curve_k(ωt) = dᵏq/dtᵏ      min ≤ curve ≤ max
//! ```
//! - position, velocity and acceleration come back after a period and are each other's integrals;
//! - the curves of position, velocity and acceleration are the evaluation, that of jerk integrates to the acceleration;
//! - the extrema of a curve bound it everywhere, and are reached;
//! - adjusting scales a joint's velocity and shifts its position, and leaves the other joints alone;
//! - slower is the same path: velocity and acceleration have the part and its square.

use std::f64::consts::TAU;

use super::law_error::LawError;
use crate::trajectory::PeriodicMotion;

/// Panels of a period on which integrals are taken.
const PANELS: usize = 2000;

/// Points and weights of Gauss's rule of three points on [0, 1].
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Position, velocity and acceleration of all joints.
type State = [Vec<f64>; 3];

/// Checks one motion.
///
/// ```
/// use armid::conformance::trajectory_laws;
/// use armid::study::radkhah2007::table_one;
/// trajectory_laws::check(&table_one::corrected()).unwrap();
/// ```
///
/// # Errors
/// [`LawError`]: the first law that does not hold, with what was found.
pub fn check<M: PeriodicMotion + Clone>(motion: &M) -> Result<(), LawError> {
    let (n, period) = (motion.dof(), motion.period_s());
    let law = "a motion has a period, joints and a name for each";
    let found = format!("{period} s, {n} joints, {} names", motion.names().len());
    let sound = period.is_finite() && period > 0.0 && n > 0 && motion.names().len() == n;
    LawError::unless(law, sound, found, "a finite number above zero, one or more, as many")?;
    let highest = motion.highest_hz();
    LawError::unless(
        "the highest frequency is finite and not below that of the period",
        highest.is_finite() && highest * period >= 1.0 - 1e-9,
        format!("{highest} Hz"),
        format!("{} Hz or more", 1.0 / period),
    )?;
    periodic(motion)?;
    integrals(motion)?;
    for joint in 0..n {
        curves(motion, joint)?;
        adjusting(motion, joint)?;
    }
    slowing(motion)
}

fn at<M: PeriodicMotion>(motion: &M, t: f64) -> State {
    let n = motion.dof();
    let mut state = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    let [q, qd, qdd] = &mut state;
    motion.evaluate(t, q, qd, qdd);
    state
}

/// Largest difference of two states, each quantity in units of its size.
fn difference(x: &State, y: &State, scale: &[f64; 3]) -> f64 {
    let of = |k: usize| x[k].iter().zip(&y[k]).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / scale[k];
    of(0).max(of(1)).max(of(2))
}

/// The size of each quantity over a period, at least 1.
fn scale<M: PeriodicMotion>(motion: &M) -> [f64; 3] {
    let states: Vec<State> = (0..64).map(|k| at(motion, motion.period_s() * f64::from(k) / 64.0)).collect();
    [0, 1, 2].map(|k| states.iter().flat_map(|state| &state[k]).fold(1.0_f64, |most, x| most.max(x.abs())))
}

fn periodic<M: PeriodicMotion>(motion: &M) -> Result<(), LawError> {
    let (period, scale) = (motion.period_s(), scale(motion));
    for k in 0..37 {
        let t = period * (0.01 + f64::from(k) / 37.0);
        for later in [t + period, t + 3.0 * period] {
            let away = difference(&at(motion, t), &at(motion, later), &scale);
            LawError::unless_at_most("the motion comes back after a period", away, 1e-9)?;
        }
    }
    Ok(())
}

fn integrals<M: PeriodicMotion>(motion: &M) -> Result<(), LawError> {
    let (n, scale) = (motion.dof(), scale(motion));
    let step = motion.period_s() / PANELS as f64;
    let start = at(motion, 0.0);
    let mut sums = [vec![0.0; n], vec![0.0; n]];
    for panel in 0..PANELS {
        for (point, weight) in GAUSS {
            let state = at(motion, step * (panel as f64 + point));
            for (sum, rate) in sums.iter_mut().zip(&state[1..]) {
                for (sum, rate) in sum.iter_mut().zip(rate) {
                    *sum += step * weight * rate;
                }
            }
        }
        let now = at(motion, step * (panel + 1) as f64);
        for (order, sum) in sums.iter().enumerate() {
            for joint in 0..n {
                // A corner of the acceleration leaves the square of a panel of 1/2000 of the period.
                let away = (now[order][joint] - start[order][joint] - sum[joint]).abs() / scale[order + 1];
                let law = ["velocity integrates to position", "acceleration integrates to velocity"][order];
                LawError::unless_at_most(law, away, 1e-5 * motion.period_s().max(1.0))?;
            }
        }
    }
    Ok(())
}

fn curves<M: PeriodicMotion>(motion: &M, joint: usize) -> Result<(), LawError> {
    let (period, scale) = (motion.period_s(), scale(motion));
    for order in 0..3 {
        let curve = motion.curve(joint, order);
        let (low, high) = (curve.minimum(), curve.maximum());
        for extremum in [low, high] {
            let away = (curve.value(extremum.phase) - extremum.value).abs() / scale[order];
            LawError::unless_at_most("a curve reaches its extrema", away, 1e-9)?;
        }
        for k in 0..733 {
            let t = period * f64::from(k) / 733.0;
            let value = curve.value(TAU * t / period);
            let away = (value - at(motion, t)[order][joint]).abs() / scale[order];
            LawError::unless_at_most("a curve is the evaluation", away, 1e-8)?;
            let beyond = (value - high.value).max(low.value - value) / scale[order];
            LawError::unless_at_most("the extrema of a curve bound it", beyond, 1e-8)?;
        }
    }
    let jerk = motion.curve(joint, 3);
    let (mut sum, mut size) = (0.0, 1.0);
    let start = at(motion, 0.0)[2][joint];
    for panel in 0..PANELS {
        for (point, weight) in GAUSS {
            let rate = jerk.value(TAU * (panel as f64 + point) / PANELS as f64);
            sum += period / PANELS as f64 * weight * rate;
            size += period / PANELS as f64 * weight * rate.abs();
        }
        let now = at(motion, period * (panel + 1) as f64 / PANELS as f64)[2][joint];
        // Jerk may jump inside a panel, which leaves a part of the panel times the jump.
        LawError::unless_at_most("jerk integrates to acceleration", (now - start - sum).abs() / size, 1e-2)?;
    }
    Ok(())
}

fn adjusting<M: PeriodicMotion + Clone>(motion: &M, joint: usize) -> Result<(), LawError> {
    let (mut scaled, mut shifted) = (motion.clone(), motion.clone());
    scaled.adjust(joint, 0.5, 0.0);
    shifted.adjust(joint, 1.0, 0.3);
    for k in 0..29 {
        let t = motion.period_s() * f64::from(k) / 29.0;
        let (before, half, moved) = (at(motion, t), at(&scaled, t), at(&shifted, t));
        for order in [1, 2] {
            let size = 1.0 + before[order][joint].abs();
            let away = (half[order][joint] - 0.5 * before[order][joint]).abs() / size;
            LawError::unless_at_most("adjusting scales a joint's velocity", away, 1e-9)?;
            let away = (moved[order][joint] - before[order][joint]).abs() / size;
            LawError::unless_at_most("a shift leaves a joint's velocity", away, 1e-9)?;
        }
        let away = (moved[0][joint] - before[0][joint] - 0.3).abs();
        LawError::unless_at_most("a shift moves a joint's position", away, 1e-9)?;
        for other in (0..motion.dof()).filter(|&other| other != joint) {
            let same = (0..3).all(|k| half[k][other] == before[k][other] && moved[k][other] == before[k][other]);
            LawError::unless("adjusting a joint leaves the others alone", same, "another motion", "the same bits")?;
        }
    }
    Ok(())
}

fn slowing<M: PeriodicMotion + Clone>(motion: &M) -> Result<(), LawError> {
    let (part, scale) = (0.25, scale(motion));
    let mut slow = motion.clone();
    slow.slow_down(part);
    let law = "slower is a longer period";
    LawError::unless_at_most(law, (slow.period_s() * part / motion.period_s() - 1.0).abs(), 1e-12)?;
    for k in 0..29 {
        let t = motion.period_s() * (0.003 + f64::from(k) / 29.0);
        let [q, qd, qdd] = at(motion, t);
        let times = |values: Vec<f64>, factor: f64| values.into_iter().map(|x| factor * x).collect();
        let expected = [q, times(qd, part), times(qdd, part * part)];
        let away = difference(&at(&slow, t / part), &expected, &scale);
        LawError::unless_at_most("slower is the same path, with its part of the speed", away, 1e-9)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::table_one;
    use crate::trajectory::{
        BSplineJoint, BSplineTrajectory, ConstantSpeedJoint, ConstantSpeedTrajectory, Curve, FourierQuinticTrajectory,
        FourierTrajectory, Trajectory,
    };

    #[test]
    fn every_motion_obeys_the_laws() {
        check(&table_one::corrected()).unwrap();
        check(&FourierQuinticTrajectory::from(table_one::corrected())).unwrap();
        for degree in [3, 5] {
            let c = (0..11).map(|k| libm::sin(f64::from(k * k))).collect();
            let joint = BSplineJoint { name: "hinge".into(), c };
            check(&BSplineTrajectory::new(4.0, degree, vec![joint]).unwrap()).unwrap();
        }
        let joint = |q0: f64| ConstantSpeedJoint { name: "hinge".into(), q0, speed: vec![0.4, -0.4] };
        check(&ConstantSpeedTrajectory::new(0.8, vec![0.57, 0.57], vec![joint(0.0), joint(0.3)]).unwrap()).unwrap();
    }

    /// The series of Table I with one thing wrong.
    #[derive(Clone)]
    struct Broken(FourierTrajectory, &'static str);

    impl Trajectory for Broken {
        fn dof(&self) -> usize {
            self.0.dof()
        }

        fn period_s(&self) -> f64 {
            if self.1 == "period" { 0.9 * self.0.period_s } else { self.0.period_s }
        }

        fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
            self.0.evaluate(t, q, qd, qdd);
            if self.1 == "velocity" {
                qd[1] *= 1.001;
            }
        }
    }

    impl PeriodicMotion for Broken {
        fn names(&self) -> Vec<&str> {
            self.0.names()
        }

        fn curve(&self, joint: usize, order: usize) -> Curve {
            self.0.curve(joint, if self.1 == "curve" && order == 3 { 1 } else { order })
        }

        fn adjust(&mut self, joint: usize, factor: f64, shift: f64) {
            self.0.adjust(if self.1 == "adjust" { 0 } else { joint }, factor, shift);
        }

        fn slow_down(&mut self, part: f64) {
            self.0.slow_down(part);
            if self.1 == "slow" {
                self.0.joints[0].a[0] *= 2.0;
            }
        }
    }

    #[test]
    fn a_broken_motion_is_found() {
        let law = |what| check(&Broken(table_one::corrected(), what)).map_err(|broken| broken.law);
        assert_eq!(law("nothing"), Ok(()));
        for (what, word) in [
            ("period", "comes back"),
            ("velocity", "velocity integrates"),
            ("curve", "jerk integrates"),
            ("adjust", "scales a joint's velocity"),
            ("slow", "same path"),
        ] {
            let found = law(what).unwrap_err();
            assert!(found.contains(word), "{what}: {found}");
        }
    }
}
