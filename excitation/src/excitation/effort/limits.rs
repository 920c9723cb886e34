//! Effort limits as rows for the optimiser, at the true peaks in time.
//!
//! ```text
//! ∂c/∂x = Σ_j B_q(θ)ᵀ ∂c/∂q_j + B_v(θ)ᵀ ∂c/∂q̇_j + B_a(θ)ᵀ ∂c/∂q̈_j      (the regressor's adjoint, ramps by σ̇ and σ̈)
//! ```
//! At a peak the time derivative vanishes, and the partial derivatives are the total ones. At a reversal Coulomb
//! friction turns within milliseconds; there, too, only the peak beside it counts.

use super::channel::Channel;
use super::model::{EffortModel, Load};
use super::worst::{Peak, Place, Survey, refine};
use crate::dynamics::States;
use crate::excitation::basis::MotionBasis;
use crate::optimiser::{Row, SmoothLimits, SmoothRow};
use crate::regressor::PartWeights;
use crate::trajectory::{PathPoint, Segment, Timeline, Trajectory};

/// Local peaks below this part of the permitted effort get no row.
const NEAR: f64 = 0.75;

/// The effort limits of a design problem.
#[derive(Clone, Debug)]
pub struct EffortLimits {
    model: EffortModel,
    /// With the permitted part of each limit.
    channels: Vec<Channel>,
    basis: MotionBasis,
    timeline: Timeline,
    samples: usize,
    /// The point of the last evaluation, its peaks and root mean squares over what is permitted.
    at: Vec<f64>,
    peaks: Vec<Peak>,
    mean_squares: Vec<f64>,
    loads: Vec<Load>,
    /// Where the last motion that did not hold failed.
    failed: Option<Place>,
}

/// Where the slopes of a channel's effort are asked for, of which sign, and times what.
struct Instant {
    channel: usize,
    sign: f64,
    scale: f64,
    point: PathPoint,
}

impl EffortLimits {
    /// The part `use_at_most` of the limits of `channels`, watched on a grid of `samples` per period.
    pub fn new(
        model: EffortModel,
        channels: &[Channel],
        basis: &MotionBasis,
        timeline: Timeline,
        samples: usize,
        use_at_most: f64,
    ) -> Self {
        let mut channels = Channel::binding(channels);
        for channel in &mut channels {
            channel.peak *= use_at_most;
            channel.continuous *= use_at_most;
        }
        Self {
            model,
            channels,
            basis: basis.clone(),
            timeline,
            samples,
            at: Vec::new(),
            peaks: Vec::new(),
            mean_squares: Vec::new(),
            loads: Vec::new(),
            failed: None,
        }
    }

    /// Whether a motion of any family uses at most the part `most` of what is permitted, peaks and root mean squares, on
    /// a grid of `samples`, refined in time.
    ///
    /// Where the motion asked about before failed, this one is looked at first: one that differs little fails there too.
    pub fn holds(&mut self, motion: &dyn Trajectory, samples: usize, most: f64) -> bool {
        if let Some((segment, part)) = self.failed {
            self.model.move_to(motion, self.basis.omega(), &self.timeline.point(segment, part));
            if self.channels.iter().any(|channel| self.model.load(channel).largest() > most * channel.peak) {
                return false;
            }
        }
        let (model, channels) = (&mut self.model, &self.channels);
        match Survey::below(model, channels, motion, self.timeline, samples, most) {
            Err(place) => {
                self.failed = Some(place);
                false
            }
            Ok(survey) => channels.iter().enumerate().all(|(c, channel)| {
                survey.root_mean_square(c) <= most * channel.continuous.min(channel.peak)
                    && survey
                        .peaks(c, f64::NEG_INFINITY)
                        .into_iter()
                        .all(|peak| refine(model, channels, motion, self.timeline, peak, &survey).ratio <= most)
            }),
        }
    }

    fn look_at(&mut self, x: &[f64]) {
        if self.at == x {
            return;
        }
        let trajectory = self.basis.trajectory(x);
        let survey = Survey::of(&mut self.model, &self.channels, &trajectory, self.timeline, self.samples);
        self.peaks.clear();
        self.mean_squares.clear();
        for c in 0..self.channels.len() {
            if self.channels[c].peak.is_finite() {
                for peak in survey.peaks(c, NEAR) {
                    let peak = refine(&mut self.model, &self.channels, &trajectory, self.timeline, peak, &survey);
                    self.peaks.push(peak);
                }
            }
            self.mean_squares.push(survey.root_mean_square(c) / self.channels[c].continuous);
        }
        self.loads = survey.into_period_loads();
        self.at = x.to_vec();
    }

    /// Row of the root mean square of one channel.
    fn mean_square_row(&mut self, c: usize, x: &[f64]) -> Row {
        let trajectory = self.basis.trajectory(x);
        let (width, count) = (self.channels.len(), self.samples);
        let limit = self.channels[c].continuous;
        let rms = self.mean_squares[c] * limit;
        let instant = |k: usize| {
            let load = self.loads[k * width + c];
            let scale = load.largest() / (count as f64 * rms * limit);
            let point = self.timeline.point(Segment::Period, k as f64 / count as f64);
            Instant { channel: c, sign: load.value.signum(), scale, point }
        };
        let instants: Vec<Instant> = (0..count).map(instant).collect();
        let slopes = self.slopes(&trajectory, &instants);
        let mut normal = vec![0.0; x.len()];
        for (k, instant) in instants.iter().enumerate() {
            self.add_row(&instant.point, slopes.sample(k), &mut normal);
        }
        Row { start: 0, normal, bound: 1.0 - self.mean_squares[c] }
    }

    /// Slopes of `scale · (sign · value + spread)` at instants of the motion, by coordinates, velocities and accelerations.
    fn slopes(&mut self, motion: &dyn Trajectory, instants: &[Instant]) -> States {
        let (n, omega) = (self.model.dof(), self.basis.omega());
        let places = n * self.model.phi.len();
        let (mut states, mut slopes) = (States::new(n), States::with_len(n, instants.len()));
        let mut all_weights = vec![0.0; places * instants.len()];
        for (instant, weights) in instants.iter().zip(all_weights.chunks_exact_mut(places)) {
            let channel = &self.channels[instant.channel];
            let [q, qd, qdd] = self.model.move_channel_to(channel, motion, omega, &instant.point);
            states.push(q, qd, qdd);
            self.model.write_weights(channel, instant.sign, instant.scale, weights);
        }
        let weights = |part: &mut PartWeights| {
            let own = all_weights.chunks_exact(places).skip(part.first).take(part.count);
            own.enumerate().for_each(|(k, g)| part.put_sample(k, g));
        };
        self.model.regressor.adjoint_of_samples(states.arrays(), weights, slopes.arrays_mut());
        slopes
    }

    /// Adds to a gradient by the variables what slopes at a point of the motion come to.
    fn add_row(&self, point: &PathPoint, [dq, dqd, dqdd]: [&[f64]; 3], normal: &mut [f64]) {
        let mut row = Vec::new();
        for j in 0..self.model.dof() {
            let weights = point.weights([dq[j], dqd[j], dqdd[j]]);
            self.basis.add_combined_row(j, point.phase, weights, &mut row, normal);
        }
    }
}

impl SmoothLimits for EffortLimits {
    fn excess(&mut self, x: &[f64]) -> f64 {
        self.look_at(x);
        // Each sign is a limit of its own, as in `linearise`.
        let mut worst = vec![[0.0_f64; 2]; self.channels.len()];
        for peak in &self.peaks {
            let worst = &mut worst[peak.channel][usize::from(peak.sign > 0.0)];
            *worst = worst.max(peak.ratio - 1.0);
        }
        let over: f64 = self.mean_squares.iter().map(|ratio| (ratio - 1.0).max(0.0)).sum();
        worst.iter().flatten().sum::<f64>() + over
    }

    fn linearise(&mut self, x: &[f64], rows: &mut Vec<SmoothRow>) {
        self.look_at(x);
        let trajectory = self.basis.trajectory(x);
        let instant = |peak: &Peak| Instant {
            channel: peak.channel,
            sign: peak.sign,
            scale: 1.0 / self.channels[peak.channel].peak,
            point: self.timeline.point(peak.segment, peak.part),
        };
        let instants: Vec<Instant> = self.peaks.iter().map(instant).collect();
        let slopes = self.slopes(&trajectory, &instants);
        for (k, (peak, instant)) in self.peaks.iter().zip(&instants).enumerate() {
            let mut normal = vec![0.0; x.len()];
            self.add_row(&instant.point, slopes.sample(k), &mut normal);
            rows.push(SmoothRow {
                row: Row { start: 0, normal, bound: 1.0 - peak.ratio },
                limit: 3 * peak.channel + usize::from(peak.sign > 0.0),
                at: self.timeline.time_s(peak.segment, peak.part) / self.timeline.period_s,
            });
        }
        for c in 0..self.channels.len() {
            if self.mean_squares[c] > NEAR {
                rows.push(SmoothRow { row: self.mean_square_row(c, x), limit: 3 * c + 2, at: 0.0 });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::effort::{CONFIDENCE_95, ParameterSpread};
    use crate::excitation::{DesignSpace, radkhah2007_start};
    use crate::model::{bundled, format::parse_nominal};
    use crate::seed::Seed;
    use crate::trajectory::Family;

    #[test]
    fn identity_rows_are_the_slopes_of_peaks_and_mean_squares() {
        let robot = chains::crs_a460().with_joints(|joint| joint.limits.continuous_torque = 20.0).unwrap();
        let nominal = parse_nominal(bundled()[0].nominal, &robot).unwrap();
        let spread = ParameterSpread::new(&robot, &nominal.parameters, &nominal.relative_uncertainty, CONFIDENCE_95);
        let model = EffortModel::new(&robot, &nominal.parameters, Some(&spread));
        let basis = MotionBasis::new(&robot, &DesignSpace::new(Family::Fourier, 10.0, vec![5; 6])).unwrap();
        let start = radkhah2007_start(&robot, 10.0, 5, Seed::new(2), 1).unwrap().into();
        let x = basis.coefficients(&start).unwrap();
        let timeline = Timeline { period_s: 10.0, ramp_s: Some(1.0) };
        let mut limits = EffortLimits::new(model, &Channel::all(&robot), &basis, timeline, 200, 0.9);
        let mut rows = Vec::new();
        limits.linearise(&x, &mut rows);
        let peaks = limits.peaks.clone();
        assert!(peaks.len() > 10 && rows.len() > peaks.len(), "{} {}", peaks.len(), rows.len());
        assert!(peaks.iter().any(|peak| peak.segment != Segment::Period));
        let squares: Vec<usize> = (0..limits.channels.len()).filter(|&c| limits.mean_squares[c] > NEAR).collect();
        for (r, SmoothRow { row, limit, .. }) in rows.iter().enumerate() {
            // Of each channel: its lower peaks, its upper ones, its mean square.
            let of_peak = |peak: &Peak| 3 * peak.channel + usize::from(peak.sign > 0.0);
            assert_eq!(*limit, peaks.get(r).map_or_else(|| 3 * squares[r - peaks.len()] + 2, of_peak), "row {r}");
            for i in (0..x.len()).step_by(9) {
                let mut at = |h: f64| {
                    let mut moved = x.clone();
                    moved[i] += h;
                    if let Some(peak) = peaks.get(r) {
                        let trajectory = basis.trajectory(&moved);
                        limits.model.move_to(&trajectory, basis.omega(), &timeline.point(peak.segment, peak.part));
                        let load = limits.model.load(&limits.channels[peak.channel]);
                        (peak.sign * load.value + load.spread) / limits.channels[peak.channel].peak
                    } else {
                        limits.look_at(&moved);
                        limits.mean_squares[squares[r - peaks.len()]]
                    }
                };
                let h = 1e-5;
                let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                // Coulomb friction turns within 0.01 rad/s: its third derivative is large, its share small.
                assert!((difference - row.normal[i]).abs() < 2e-6, "row {r}: {difference} {}", row.normal[i]);
            }
        }
    }
}
