//! Every moment of an experiment as a point of the periodic motion: the ramps run the same path at another speed.
//!
//! ```text
//! q(t) = r(σ)      q̇ = r′ σ̇      q̈ = r″ σ̇² + r′ σ̈      q⃛ = r‴ σ̇³ + 3 r″ σ̇ σ̈ + r′ σ⃛
//! σ̇ = S(u),  σ = T_ramp (∫S − ½),   u = t / T_ramp on the ramp in;  the ramp out is its mirror image
//! ```
//! S is the [`QuinticStep`]. On the period itself σ̇ = 1 and σ̈ = σ⃛ = 0. So everything that is linear in the coefficients
//! of the motion stays linear on the ramps. Designs, certificates and the commanded motion all take their points here.

use std::f64::consts::TAU;

use super::quintic_step::QuinticStep;

/// One part of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Segment {
    /// The periodic motion.
    Period,
    /// From rest into it.
    RampIn,
    /// Back to rest.
    RampOut,
}

/// A point of the motion, and how fast the path is run there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Time σ on the path, s: 0 where the period begins, and again where it ends.
    pub path_s: f64,
    /// Phase ωσ of the motion, rad.
    pub phase: f64,
    /// Speed σ̇ along the path; 1 on the period.
    pub path_speed: f64,
    /// σ̈, 1/s.
    pub path_acceleration: f64,
    /// σ⃛, 1/s².
    pub path_jerk: f64,
}

impl PathPoint {
    /// Weights of the motion's position, velocity and acceleration in a quantity whose weights on the commanded ones
    /// are given.
    pub fn weights(&self, [q, qd, qdd]: [f64; 3]) -> [f64; 3] {
        [q, self.path_speed * qd + self.path_acceleration * qdd, self.path_speed * self.path_speed * qdd]
    }

    /// Makes the motion's velocity (n) and acceleration (n) at this point the commanded ones, in place.
    pub fn scale_motion(&self, qd: &mut [f64], qdd: &mut [f64]) {
        for (qd, qdd) in qd.iter_mut().zip(qdd) {
            *qdd = *qdd * self.path_speed * self.path_speed + *qd * self.path_acceleration;
            *qd *= self.path_speed;
        }
    }
}

/// The segments of an experiment around a motion of one period.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::trajectory::{Segment, Timeline};
/// let timeline = Timeline { period_s: 10.0, ramp_s: Some(2.0) };
/// let rest = timeline.point(Segment::RampIn, 0.0);
/// assert_eq!((rest.path_s, rest.path_speed), (-1.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timeline {
    /// Period of the motion, s.
    pub period_s: f64,
    /// Length of each ramp, s; without it only the period counts.
    pub ramp_s: Option<f64>,
}

impl Timeline {
    /// The segments that count.
    pub fn segments(&self) -> &'static [Segment] {
        match self.ramp_s {
            Some(_) => &[Segment::Period, Segment::RampIn, Segment::RampOut],
            None => &[Segment::Period],
        }
    }

    /// Length of a segment, s.
    pub fn length_s(&self, segment: Segment) -> f64 {
        match segment {
            Segment::Period => self.period_s,
            Segment::RampIn | Segment::RampOut => self.ramp_s.unwrap_or(0.0),
        }
    }

    /// Samples of a segment, where the period has `samples`: as dense, and at least eight.
    pub fn samples(&self, segment: Segment, samples: usize) -> usize {
        match segment {
            Segment::Period => samples,
            Segment::RampIn | Segment::RampOut => {
                ((samples as f64 * self.length_s(segment) / self.period_s).ceil() as usize).max(8)
            }
        }
    }

    /// The point `t` (s) after the beginning of the first period, in it or in one of those that follow.
    pub fn on_period(&self, t: f64) -> PathPoint {
        let phase = TAU / self.period_s * t;
        PathPoint { path_s: t, phase, path_speed: 1.0, path_acceleration: 0.0, path_jerk: 0.0 }
    }

    /// The point after the part `part` of a segment, from 0 to 1.
    pub fn point(&self, segment: Segment, part: f64) -> PathPoint {
        let (u, mirror) = match segment {
            Segment::Period => {
                // The phase of a part, not of its time, which would round it once more.
                return PathPoint { phase: TAU * part, ..self.on_period(part * self.period_s) };
            }
            Segment::RampIn => (part, 1.0),
            Segment::RampOut => (1.0 - part, -1.0),
        };
        let ramp_s = self.length_s(segment);
        let step = QuinticStep::evaluate(u);
        let path_s = mirror * (ramp_s * (step.integral - 0.5));
        PathPoint {
            path_s,
            phase: TAU / self.period_s * path_s,
            path_speed: step.value,
            path_acceleration: mirror * (step.slope / ramp_s),
            path_jerk: step.curvature / (ramp_s * ramp_s),
        }
    }

    /// The time of that point, s, where 0 is the beginning of the first period: negative on the ramp in, beyond the
    /// period on the ramp out.
    pub fn time_s(&self, segment: Segment, part: f64) -> f64 {
        match segment {
            Segment::Period => part * self.period_s,
            Segment::RampIn => (part - 1.0) * self.length_s(segment),
            Segment::RampOut => self.period_s + part * self.length_s(segment),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_ramps_join_the_period_and_begin_at_rest() {
        let timeline = Timeline { period_s: 10.0, ramp_s: Some(2.0) };
        let begin = timeline.point(Segment::RampIn, 0.0);
        assert_eq!((begin.path_speed, begin.path_acceleration), (0.0, 0.0));
        assert!((begin.phase + TAU / 10.0).abs() < 1e-15);
        for seam in [timeline.point(Segment::RampIn, 1.0), timeline.point(Segment::RampOut, 0.0)] {
            let PathPoint { phase, path_speed, path_acceleration, .. } = seam;
            assert_eq!((phase.abs(), path_speed, path_acceleration.abs()), (0.0, 1.0, 0.0));
        }
        for segment in [Segment::RampIn, Segment::RampOut] {
            for part in [0.2, 0.5, 0.9] {
                let h = 1e-6;
                let (a, here, b) = (
                    timeline.point(segment, part - h),
                    timeline.point(segment, part),
                    timeline.point(segment, part + h),
                );
                // Each is the derivative of the one before with respect to time.
                assert!(((b.path_s - a.path_s) / (4.0 * h) - here.path_speed).abs() < 1e-9);
                assert!(((b.path_speed - a.path_speed) / (4.0 * h) - here.path_acceleration).abs() < 1e-9);
                assert!(((b.path_acceleration - a.path_acceleration) / (4.0 * h) - here.path_jerk).abs() < 1e-8);
            }
        }
        assert_eq!(timeline.samples(Segment::RampOut, 200), 40);
    }

    /// Phase, σ̇, σ̈ and σ⃛ that designs up to version 0.1.0 were certified with, for ramps of 1.7 s around a period of 8.3 s.
    #[test]
    fn frozen_points_are_those_of_the_certificates_so_far() {
        let timeline = Timeline { period_s: 8.3, ramp_s: Some(1.7) };
        let frozen: [(Segment, f64, [u64; 4]); 8] = [
            (
                Segment::RampIn,
                0.1,
                [0xbfe4_94e2_53c9_dafd, 0x3f81_87e7_c06e_19bb, 0x3fc2_4be5_7f18_b24d, 0x3ff7_eabd_9063_360a],
            ),
            (
                Segment::RampIn,
                0.3,
                [0xbfe4_06e6_0f57_3699, 0x3fc4_dfce_3150_dae4, 0x3fe8_e74d_b41a_80e6, 0x3ffb_e732_7dc9_1461],
            ),
            (
                Segment::RampIn,
                0.61,
                [0xbfdd_4c25_87c1_a23b, 0x3fe6_63df_b3d6_c7fd, 0x3fef_f5d7_e6cf_a0b1, 0xbff1_62b8_dbcb_8812],
            ),
            (
                Segment::RampIn,
                0.83,
                [0xbfcb_b9be_83b7_b821, 0x3fee_cd2d_c374_c3d1, 0x3fd6_7c56_92b3_cc4d, 0xbffe_ef41_2cb1_d08a],
            ),
            (
                Segment::RampOut,
                0.1,
                [0x3fc0_6fa6_d3b2_fd26, 0x3fef_b9e0_60fe_479c, 0xbfc2_4be5_7f18_b24a, 0xbff7_eabd_9063_3609],
            ),
            (
                Segment::RampOut,
                0.3,
                [0x3fd7_94d3_7fd1_517e, 0x3fea_c80c_73ab_c944, 0xbfe8_e74d_b41a_80ea, 0xbffb_e732_7dc9_145f],
            ),
            (
                Segment::RampOut,
                0.61,
                [0x3fe3_2dbd_892a_6bef, 0x3fd3_3840_9852_7005, 0xbfef_f5d7_e6cf_a0b1, 0x3ff1_62b8_dbcb_8812],
            ),
            (
                Segment::RampOut,
                0.83,
                [0x3fe4_856f_f0ca_be7d, 0x3fa3_2d23_c8b3_c2d1, 0xbfd6_7c56_92b3_cc4e, 0x3ffe_ef41_2cb1_d08a],
            ),
        ];
        for (segment, part, bits) in frozen {
            let PathPoint { phase, path_speed, path_acceleration, path_jerk, .. } = timeline.point(segment, part);
            let found = [phase, path_speed, path_acceleration, path_jerk];
            assert_eq!(found.map(f64::to_bits), bits, "{segment:?} {part}: {found:?}");
        }
    }
}
