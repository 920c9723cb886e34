//! The largest use of each effort limit over an experiment, refined in time.

use super::channel::{Channel, EffortKind};
use super::model::{EffortModel, Load};
use crate::dynamics::States;
use crate::excitation::limits::WorstUse;
use crate::optimiser::{CurvePoint, climb};
use crate::trajectory::{Segment, Timeline, Trajectory};

/// A peak that may use more than this part of a limit between the samples is refined in time.
const REFINE: f64 = 0.97;

/// How well its time is then known, in steps of the grid.
const REFINED: f64 = 1e-3;

/// Instants that are looked at together where one may use too much: enough to fill lanes, and few where it is among the first.
const AT_ONCE: usize = 32;

/// A peak of one channel on one segment of an experiment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Peak {
    pub(super) channel: usize,
    pub(super) sign: f64,
    pub(super) segment: Segment,
    /// Part of the segment, from 0 to 1.
    pub(super) part: f64,
    /// `sign · value + spread` over the channel's peak limit.
    pub(super) ratio: f64,
    /// What that may be between the samples: where a joint turns round, friction leaves a corner, and the effort rises up to
    /// it as it does on the side that is less steep.
    pub(super) reach: f64,
}

/// The largest use of one kind of effort.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortUse {
    /// Of the peak limit, uncertainty included.
    pub peak: WorstUse,
    /// Of the peak limit by the nominal parameters alone.
    pub nominal: f64,
    /// Of the continuous limit by the root mean square over a period; where none is stated, of the peak limit.
    pub mean_square: WorstUse,
}

/// The largest uses of torque and current limits; `None` where there is no such limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WorstEfforts {
    /// Joint torques.
    pub torque: Option<EffortUse>,
    /// Motor currents.
    pub current: Option<EffortUse>,
}

impl WorstEfforts {
    /// The largest uses over period and ramps of an experiment around a motion, on a grid of `samples` per period, refined in time.
    pub fn compute(
        model: &mut EffortModel,
        channels: &[Channel],
        motion: &dyn Trajectory,
        timeline: Timeline,
        samples: usize,
    ) -> Self {
        let survey = Survey::of(model, channels, motion, timeline, samples);
        let mut found = Self::default();
        for (c, channel) in channels.iter().enumerate() {
            let mut peak = WorstUse::NONE;
            if channel.peak.is_finite() {
                for best in survey.peaks(c, f64::NEG_INFINITY) {
                    let best = refine(model, channels, motion, timeline, best, &survey);
                    peak = peak.worst_of(WorstUse {
                        ratio: best.ratio,
                        joint: channel.joint,
                        t: timeline.time_s(best.segment, best.part),
                        value: best.sign * best.ratio * channel.peak,
                        limit: best.sign * channel.peak,
                    });
                }
            }
            let rms = survey.root_mean_square(c);
            let limit = channel.continuous.min(channel.peak);
            let mean_square = WorstUse { ratio: rms / limit, joint: channel.joint, t: 0.0, value: rms, limit };
            let own = EffortUse { peak, nominal: survey.nominal_ratio(c), mean_square };
            let place = match channel.kind {
                EffortKind::Torque => &mut found.torque,
                EffortKind::Current => &mut found.current,
            };
            *place = Some(place.map_or(own, |known| EffortUse {
                peak: known.peak.worst_of(own.peak),
                nominal: known.nominal.max(own.nominal),
                mean_square: known.mean_square.worst_of(own.mean_square),
            }));
        }
        found
    }
}

/// Efforts on the grid of one segment.
struct Sampled {
    segment: Segment,
    count: usize,
    /// Of every sample and channel.
    loads: Vec<Load>,
}

/// Efforts on a grid of all segments.
pub(super) struct Survey {
    /// Peak limit of each channel.
    limits: Vec<f64>,
    segments: Vec<Sampled>,
}

/// An instant of an experiment: a segment and the part of it.
pub(super) type Place = (Segment, f64);

impl Survey {
    pub(super) fn of(
        model: &mut EffortModel,
        channels: &[Channel],
        motion: &dyn Trajectory,
        timeline: Timeline,
        samples: usize,
    ) -> Self {
        Self::below(model, channels, motion, timeline, samples, f64::INFINITY)
            .unwrap_or_else(|_| Self { limits: Vec::new(), segments: Vec::new() })
    }

    /// The worst use of each limit if no sample uses more than `most` of a peak limit; else the first place that does.
    pub(super) fn below(
        model: &mut EffortModel,
        channels: &[Channel],
        motion: &dyn Trajectory,
        timeline: Timeline,
        samples: usize,
        most: f64,
    ) -> Result<Self, Place> {
        let omega = std::f64::consts::TAU / timeline.period_s;
        let mut segments = Vec::with_capacity(timeline.segments().len());
        for &segment in timeline.segments() {
            let count = timeline.samples(segment, samples);
            let part = |k: usize| k as f64 / count as f64;
            let mut loads = Vec::with_capacity(count * channels.len());
            let at_once = if most.is_finite() { AT_ONCE } else { count.max(1) };
            for first in (0..count).step_by(at_once) {
                let mut states = States::new(model.dof());
                for k in first..count.min(first + at_once) {
                    let [q, qd, qdd] = model.move_state_to(motion, omega, &timeline.point(segment, part(k)));
                    states.push(q, qd, qdd);
                }
                model.add_loads(&states, channels, &mut loads);
                for (k, loads) in loads.chunks_exact(channels.len().max(1)).enumerate().skip(first) {
                    if loads.iter().zip(channels).any(|(load, channel)| load.largest() > most * channel.peak) {
                        return Err((segment, part(k)));
                    }
                }
            }
            segments.push(Sampled { segment, count, loads });
        }
        Ok(Self { limits: channels.iter().map(|channel| channel.peak).collect(), segments })
    }

    /// Local peaks of a channel above `threshold`, and the largest sample of every segment.
    pub(super) fn peaks(&self, channel: usize, threshold: f64) -> Vec<Peak> {
        let (width, limit) = (self.limits.len(), self.limits[channel]);
        let mut peaks = Vec::new();
        for Sampled { segment, count, loads } in &self.segments {
            for sign in [1.0, -1.0] {
                let own = loads.iter().skip(channel).step_by(width);
                let ratios: Vec<f64> = own.map(|load| (sign * load.value + load.spread) / limit).collect();
                let top = (0..*count).fold(0, |top, k| if ratios[k] > ratios[top] { k } else { top });
                for k in 0..*count {
                    let here = ratios[k];
                    // The period closes on itself; a ramp does not.
                    let closed = *segment == Segment::Period;
                    let before = if k > 0 { Some(ratios[k - 1]) } else { ratios.last().copied().filter(|_| closed) };
                    let after = ratios.get(k + 1).or(ratios.first().filter(|_| closed)).copied();
                    let rises = before.is_some_and(|before| here >= before);
                    let falls = after.is_some_and(|after| here > after);
                    if (k == top || (rises && falls)) && here > threshold {
                        let part = k as f64 / *count as f64;
                        let slopes = [before, after].into_iter().flatten().map(|beside| (here - beside).abs());
                        let reach = here + slopes.fold(f64::INFINITY, f64::min);
                        peaks.push(Peak { channel, sign, segment: *segment, part, ratio: here, reach });
                    }
                }
            }
        }
        peaks
    }

    /// Step of the grid on a segment, as a part of it.
    pub(super) fn step(&self, segment: Segment) -> f64 {
        self.segments.iter().find(|known| known.segment == segment).map_or(1.0, |known| 1.0 / known.count as f64)
    }

    /// Root mean square over the period of what an effort may be.
    pub(super) fn root_mean_square(&self, channel: usize) -> f64 {
        let width = self.limits.len();
        let Sampled { count, loads, .. } = &self.segments[0];
        let square = |k: usize| loads[k * width + channel].largest() * loads[k * width + channel].largest();
        ((0..*count).map(square).sum::<f64>() / *count as f64).sqrt()
    }

    /// Largest use of the peak limit by the nominal parameters, on the grid.
    fn nominal_ratio(&self, channel: usize) -> f64 {
        let width = self.limits.len();
        let values = self.segments.iter().flat_map(|known| known.loads.iter().skip(channel).step_by(width));
        values.map(|load| load.value.abs()).fold(0.0, f64::max) / self.limits[channel]
    }

    /// The efforts at every sample of the period, of every channel.
    pub(super) fn into_period_loads(mut self) -> Vec<Load> {
        self.segments.swap_remove(0).loads
    }
}

/// The top around a peak of the grid.
pub(super) fn refine(
    model: &mut EffortModel,
    channels: &[Channel],
    motion: &dyn Trajectory,
    timeline: Timeline,
    peak: Peak,
    survey: &Survey,
) -> Peak {
    if peak.reach < REFINE {
        return peak;
    }
    let omega = std::f64::consts::TAU / timeline.period_s;
    let channel = &channels[peak.channel];
    let ratio = |part: f64| {
        let load = model.load_at(channel, motion, omega, &timeline.point(peak.segment, part));
        (peak.sign * load.value + load.spread) / channel.peak
    };
    let step = survey.step(peak.segment);
    let from = CurvePoint { place: peak.part, value: peak.ratio };
    let top = climb(ratio, from, peak.part - step..peak.part + step, REFINED * step);
    Peak { part: top.place, ratio: top.value, ..peak }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_that_of_its_own_segment_and_the_whole_of_one_that_is_not_there() {
        let sampled = |segment, count| Sampled { segment, count, loads: vec![Load { value: 3.0, spread: 1.0 }; count] };
        let survey =
            Survey { limits: vec![8.0], segments: vec![sampled(Segment::Period, 10), sampled(Segment::RampIn, 4)] };
        assert_eq!([Segment::Period, Segment::RampIn, Segment::RampOut].map(|of| survey.step(of)), [0.1, 0.25, 1.0]);
        // Value and spread add up: 4 at each sample.
        assert_eq!(survey.root_mean_square(0), 4.0);
    }
}
