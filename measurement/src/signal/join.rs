//! Several experiments as one.

use std::ops::Range;

use super::error::SignalError;
use super::joined_experiment::JoinedExperiment;
use super::samples::Samples;
use crate::dynamics::States;

impl Samples {
    /// The samples of several experiments on one arm as one, in their order.
    ///
    /// Periods that repeat are periods of one experiment only: the result has none, and estimators take its noise from their
    /// residual. Filters and derivatives stay within an experiment. The last instant of an experiment counts as a neighbour of the first of the
    /// next where the residual's correlation in time is measured; that is one product among as many as there are blocks.
    ///
    /// # Errors
    /// [`SignalError::JointUnits`], [`SignalError::Rates`] or [`SignalError::Blocks`] where they differ,
    /// [`SignalError::NoExperiment`] where there are none.
    pub fn join(parts: Vec<Self>) -> Result<Self, SignalError> {
        let mut parts = parts.into_iter().peekable();
        let mut all = parts.next().ok_or(SignalError::NoExperiment)?;
        if parts.peek().is_none() {
            return Ok(all);
        }
        all.joined = all.parts();
        for part in parts {
            if part.dof() != all.dof() || part.units != all.units {
                return Err(SignalError::JointUnits { found: part.units, first: all.units });
            }
            if part.rate_hz.to_bits() != all.rate_hz.to_bits() {
                return Err(SignalError::Rates { found: part.rate_hz, first: all.rate_hz });
            }
            if part.block != all.block {
                return Err(SignalError::Blocks { found: part.block, first: all.block });
            }
            let behind = all.len() - all.blocks() * all.block;
            all.keep_whole_blocks();
            if let Some(last) = all.joined.last_mut() {
                last.samples -= behind;
            }
            all.joined.extend(part.parts());
            all.link_q = all.link_q.zip(part.link_q).map(|(all, part)| [all, part].concat());
            all.states.q.extend(part.states.q);
            all.states.qd.extend(part.states.qd);
            all.states.qdd.extend(part.states.qdd);
            all.tau.extend(part.tau);
            all.slow.resize(all.used.len(), false);
            all.slow.extend(part.slow);
            all.used.extend(part.used);
            all.slow.resize(all.used.len(), false);
            for (band, other) in all.position_band_hz.iter_mut().zip(part.position_band_hz) {
                *band = band.min(other);
            }
            all.torque_band_hz = all.torque_band_hz.zip(part.torque_band_hz).map(|(band, other)| band.max(other));
            if all.provenance != part.provenance {
                all.provenance = None;
            }
        }
        all.periods = 1;
        (all.period_s, all.torque_covariance, all.position_noise, all.noise) = (None, None, None, None);
        all.position_floor = Vec::new();
        Ok(all)
    }

    /// The experiments that the samples are of, each with its range of instants: one, unless some were [joined](Self::join).
    pub fn experiments(&self) -> impl Iterator<Item = (Range<usize>, JoinedExperiment)> {
        let mut first = 0;
        self.parts().into_iter().map(move |of| {
            let range = first..first + of.samples;
            first = range.end;
            (range, of)
        })
    }

    fn parts(&self) -> Vec<JoinedExperiment> {
        if self.joined.is_empty() { vec![self.whole()] } else { self.joined.clone() }
    }

    /// All samples as one experiment.
    pub(super) fn whole(&self) -> JoinedExperiment {
        JoinedExperiment {
            samples: self.len(),
            period_s: self.period_s,
            position_band_hz: self.position_band_hz.clone(),
            position_floor: self.position_floor.clone(),
            torque_band_hz: self.torque_band_hz,
        }
    }

    /// The states of each joined experiment as samples of their own, without torque.
    pub(super) fn apart(&self) -> impl Iterator<Item = Self> {
        let n = self.dof();
        self.experiments().map(move |(range, of)| {
            let rows = range.start * n..range.end * n;
            let own = |table: &[f64]| table[rows.clone()].to_vec();
            let (q, qd, qdd) = (own(&self.states.q), own(&self.states.qd), own(&self.states.qdd));
            let zeros = vec![0.0; q.len()];
            Self {
                period_s: of.period_s,
                position_band_hz: of.position_band_hz,
                position_floor: of.position_floor,
                torque_band_hz: of.torque_band_hz,
                derivatives: self.derivatives,
                torque_filter_order: self.torque_filter_order,
                ..Self::exact(States { dof: n, q, qd, qdd }, zeros, self.units.clone(), self.rate_hz)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A period of two harmonics of one joint, and torque that is known up to the first.
    fn experiment(amplitude: f64, period_s: f64) -> Samples {
        let (rate_hz, w) = (100.0, std::f64::consts::TAU / period_s);
        let mut states = States::new(1);
        for k in 0..(rate_hz * period_s) as usize {
            let (s, c) = (libm::sin(w * k as f64 / rate_hz), libm::cos(w * k as f64 / rate_hz));
            let (s5, c5) = (libm::sin(5.0 * w * k as f64 / rate_hz), libm::cos(5.0 * w * k as f64 / rate_hz));
            let small = 1e-3 * amplitude;
            let qdd = -w * w * (amplitude * s + 25.0 * small * s5);
            states.push(&[amplitude * s + small * s5], &[w * (amplitude * c + 5.0 * small * c5)], &[qdd]);
        }
        let tau = vec![0.0; states.len()];
        Samples {
            period_s: Some(period_s),
            position_band_hz: vec![6.0 / period_s],
            // A line has the power a²: that of the fifth is under a hundred times its noise, that of the first is not.
            position_floor: vec![1e-7 * amplitude * amplitude],
            torque_band_hz: Some(2.0 / period_s),
            ..Samples::exact(states, tau, vec!["N·m".to_owned()], rate_hz)
        }
    }

    #[test]
    fn identity_joined_experiments_are_filtered_and_differentiated_each_by_itself() {
        let each = [experiment(0.5, 4.0), experiment(0.3, 5.0), experiment(0.4, 2.0)];
        let first = Samples::join(each[..2].to_vec()).unwrap();
        let all = Samples::join(vec![first, each[2].clone()]).unwrap();
        assert_eq!(all.joined.iter().map(|of| of.samples).collect::<Vec<_>>(), [400, 500, 200]);
        let stacked = |of: &dyn Fn(&Samples) -> Vec<f64>| each.iter().flat_map(of).collect::<Vec<f64>>();
        assert_eq!(all.calm_states().unwrap().q, stacked(&|of| of.calm_states().unwrap().q));
        assert_ne!(all.calm_states().unwrap().q, all.states.q);
        assert_eq!(all.jerk(), stacked(&Samples::jerk));
        let friction = |of: &Samples| of.states.qd.iter().map(|qd| qd.signum()).collect::<Vec<f64>>();
        let filtered = all.filtered_as_torque(friction(&all), 1).unwrap();
        assert_eq!(filtered, stacked(&|of| of.filtered_as_torque(friction(of), 1).unwrap()));
    }

    #[test]
    fn joined_experiments_have_the_samples_that_they_say() {
        let all = Samples::join(vec![experiment(0.5, 4.0), experiment(0.3, 5.0)]).unwrap();
        let changed = |change: &dyn Fn(&mut JoinedExperiment)| {
            let mut wrong = all.clone();
            change(&mut wrong.joined[0]);
            wrong.check().unwrap_err()
        };
        assert!(all.check().is_ok());
        assert!(changed(&|of| of.samples = usize::MAX).starts_with("joined has"));
        assert!(changed(&|of| of.position_band_hz.clear()).contains("expected 1 entries each"));
    }

    #[test]
    fn identity_an_experiment_gives_up_what_is_behind_its_last_whole_block() {
        let blocks = |of: Samples| Samples { block: 150, used: vec![true; of.len() / 150], ..of };
        let all = Samples::join(vec![blocks(experiment(0.5, 4.0)), blocks(experiment(0.3, 5.0))]).unwrap();
        assert_eq!(all.experiments().map(|(range, _)| range).collect::<Vec<_>>(), [0..300, 300..800]);
    }
}
