//! The commanded motion of a plan as a function of time, from the first moment of settling to rest again.

use super::layout::Layout;
use super::phase::Phase;
use super::plan::ExperimentPlan;
use crate::trajectory::{PathPoint, Segment, Timeline, Trajectory};

/// The commanded motion: position, velocity and acceleration are continuous from beginning to end.
///
/// Its ramps and periods are those of [`ExperimentPlan::timeline`], which its limits are verified on.
#[derive(Clone, Copy)]
pub struct Command<'a> {
    trajectory: &'a dyn Trajectory,
    timeline: Timeline,
    ramp_in_s: f64,
    /// When the periodic motion begins, s after the beginning of the experiment: its phase is zero there.
    pub periodic_s: f64,
    ramp_out_s: f64,
}

impl<'a> Command<'a> {
    /// The commanded motion of a plan whose layout is known.
    pub fn new(plan: &'a ExperimentPlan, layout: &Layout) -> Self {
        let at = |sample: usize| sample as f64 / plan.rate_hz;
        let (ramp_in, ramp_out) = (layout.span(Phase::RampIn), layout.span(Phase::RampOut));
        Self {
            trajectory: &plan.trajectory,
            timeline: plan.timeline(layout),
            ramp_in_s: at(ramp_in.start),
            periodic_s: at(ramp_in.end),
            ramp_out_s: at(ramp_out.start),
        }
    }

    /// Where the commanded motion is on the path of its trajectory, and how fast, at time `t` (s) of the experiment. The
    /// time on the path grows through all periods.
    pub fn point(&self, t: f64) -> PathPoint {
        if t < self.periodic_s {
            let part = (t - self.ramp_in_s) / self.timeline.length_s(Segment::RampIn);
            self.timeline.point(Segment::RampIn, part)
        } else if t <= self.ramp_out_s {
            self.timeline.on_period(t - self.periodic_s)
        } else {
            let part = (t - self.ramp_out_s) / self.timeline.length_s(Segment::RampOut);
            let point = self.timeline.point(Segment::RampOut, part);
            PathPoint { path_s: self.ramp_out_s - self.periodic_s + point.path_s, ..point }
        }
    }

    /// Commanded position, velocity and acceleration at time `t` (s since the beginning of the experiment), n each.
    pub fn evaluate(&self, t: f64, q: &mut [f64], qd: &mut [f64], qdd: &mut [f64]) {
        let point = self.point(t);
        self.trajectory.evaluate(point.path_s, q, qd, qdd);
        point.scale_motion(qd, qdd);
    }

    /// The start pose: where the arm rests before the ramp, n.
    pub fn start(&self, q: &mut [f64]) {
        let (mut qd, mut qdd) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        self.evaluate(0.0, q, &mut qd, &mut qdd);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::hinges;

    fn plan() -> ExperimentPlan {
        ExperimentPlan { settle_s: 0.3, ramp_s: 0.8, periods: 2, ..ExperimentPlan::new(hinges::trajectory(2)) }
    }

    #[test]
    fn analytic_command_is_continuous_to_the_second_derivative_and_starts_and_ends_at_rest() {
        let plan = plan();
        let layout = plan.layout().unwrap();
        let command = Command::new(&plan, &layout);
        let at = |t: f64| {
            let mut state = [[0.0; 2]; 3];
            let [q, qd, qdd] = &mut state;
            command.evaluate(t, q, qd, qdd);
            state
        };
        let joints =
            [layout.span(Phase::RampIn).start, layout.span(Phase::Discard).start, layout.span(Phase::RampOut).start];
        for seam in joints.iter().map(|&k| k as f64 * 1e-3).chain([layout.samples() as f64 * 1e-3]) {
            let (before, after) = (at(seam - 1e-7), at(seam + 1e-7));
            for (x, y) in before.iter().flatten().zip(after.iter().flatten()) {
                // 2e-7 s of a motion whose jerk stays below 100 rad/s³.
                assert!((x - y).abs() < 2e-5, "{x} {y} at {seam}");
            }
        }
        for end in [at(0.0), at(1e9)] {
            assert_eq!((end[1], end[2]), ([0.0; 2], [0.0; 2]));
        }
        // Inside the ramps, velocity and acceleration are the derivatives of position.
        for t in [0.35, 0.6, 0.93, 7.2, 7.6] {
            let h = 1e-4;
            let (low, mid, high) = (at(t - h), at(t), at(t + h));
            for i in 0..2 {
                assert!(((high[0][i] - low[0][i]) / (2.0 * h) - mid[1][i]).abs() < 1e-6);
                assert!(((high[1][i] - low[1][i]) / (2.0 * h) - mid[2][i]).abs() < 1e-5);
            }
        }
    }

    /// σ, σ̇ and σ̈ as they were commanded up to version 0.1.0, when the ramps stood here a second time: σ alone decides what
    /// a simulated arm does, and its bits stay. σ̈ was rounded otherwise than that of the certificates, which it is now.
    #[test]
    fn frozen_commands_are_those_of_the_recordings_so_far() {
        let plan = plan();
        let layout = plan.layout().unwrap();
        let command = Command::new(&plan, &layout);
        let frozen: [(f64, [u64; 3]); 9] = [
            (0.35, [0xbfd9_9923_0000_0000, 0x3f62_2bff_ffff_fffd, 0x3fc0_7abf_ffff_fffd]),
            (0.62, [0xbfd7_afb4_8e11_a61c, 0x3fd4_50ef_dc9c_4da9, 0x4001_47ae_147a_e148]),
            (0.93, [0xbfc5_5c96_d689_e4ed, 0x3fed_d32f_65a9_a803, 0x3ff0_cd67_5c28_f5bf]),
            (1.07, [0xbf9e_b754_4b38_e374, 0x3fef_fbeb_5ad9_6a6d, 0x3fa9_0351_eb85_1eaf]),
            (3.21, [0x4000_e147_ae14_7ae1, 0x3ff0_0000_0000_0000, 0x0000_0000_0000_0000]),
            (7.14, [0x4018_28f2_ad31_2613, 0x3fef_f683_3c60_0297, 0xbfb5_a8f5_c28f_5c34]),
            (7.33, [0x4018_e1e4_811c_bda6, 0x3feb_4c42_02c9_0814, 0xbff9_2d34_28f5_c29f]),
            (7.66, [0x4019_8e62_cf02_3133, 0x3fc4_dfce_3150_dac5, 0xbffa_75c2_8f5c_28e5]),
            (7.89, [0x4019_9999_965f_450a, 0x3ef4_1911_48fd_9f97, 0xbf77_675c_28f5_c260]),
        ];
        for (t, [path, speed, acceleration]) in frozen {
            let point = command.point(t);
            assert_eq!((point.path_s.to_bits(), point.path_speed.to_bits()), (path, speed), "{point:?} at {t}");
            let before = f64::from_bits(acceleration);
            assert!((point.path_acceleration - before).abs() <= 2.0 * f64::EPSILON * before.abs(), "{point:?} at {t}");
        }
    }

    #[test]
    fn identity_the_command_runs_through_the_points_of_its_timeline() {
        let plan = plan();
        let layout = plan.layout().unwrap();
        let (command, timeline) = (Command::new(&plan, &layout), plan.timeline(&layout));
        for &segment in timeline.segments() {
            for k in 1..20 {
                let part = 0.05 * f64::from(k);
                let certified = timeline.point(segment, part);
                let mut t = command.periodic_s + timeline.time_s(segment, part);
                let mut path_s = certified.path_s;
                if segment == Segment::RampOut {
                    // The ramp out follows the last of three periods, not the first.
                    t += 2.0 * timeline.period_s;
                    path_s += 3.0 * timeline.period_s;
                }
                let commanded = command.point(t);
                // Rounding of a time of 8 s, in a ramp whose jerk is at most 10 /s².
                assert!((commanded.path_s - path_s).abs() < 1e-14 * 8.0, "{segment:?} {part}: {commanded:?}");
                assert!((commanded.path_speed - certified.path_speed).abs() < 1e-13);
                assert!((commanded.path_acceleration - certified.path_acceleration).abs() < 1e-12);
            }
        }
    }
}
