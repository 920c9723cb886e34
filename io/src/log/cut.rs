//! Parts of a log.

use armid::signal::{Interpolation, resample};

use super::joint_log::{Log, Segment};

impl Log {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.q.len() / self.dof.max(1)
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.q.is_empty()
    }

    /// The samples from one time until another, s since the beginning of the log.
    #[must_use]
    pub(super) fn between(&self, from_s: f64, until_s: f64) -> Self {
        let at = |segment: &Segment, time: f64| -> usize {
            ((time - segment.start_s) * self.rate_hz).round().clamp(0.0, segment.samples as f64) as usize
        };
        self.pieces(|segment, _| (at(segment, from_s), at(segment, until_s)))
    }

    /// The first `count` samples, and the others.
    #[must_use]
    pub(super) fn split(&self, count: usize) -> (Self, Self) {
        let inside = |segment: &Segment, before: usize| count.saturating_sub(before).min(segment.samples);
        (
            self.pieces(|segment, before| (0, inside(segment, before))),
            self.pieces(|segment, before| (inside(segment, before), segment.samples)),
        )
    }

    /// Returns this log at another rate, segment by segment.
    #[must_use]
    pub(super) fn resampled(&self, rate_hz: f64) -> Self {
        let (n, mut before) = (self.dof, 0);
        let mut even = self.pieces(|_, _| (0, 0));
        even.rate_hz = rate_hz;
        for segment in &self.segments {
            let rows = before * n..(before + segment.samples) * n;
            let t: Vec<f64> = (0..segment.samples).map(|k| k as f64 / self.rate_hz).collect();
            let span = segment.samples.saturating_sub(1) as f64 / self.rate_hz;
            let count = (span * rate_hz + 1e-6) as usize + 1;
            let onto = |table: &[f64], way| resample(&t, &table[rows.clone()], n, rate_hz, count, way);
            even.q.extend(onto(&self.q, Interpolation::Cubic));
            even.effort.extend(onto(&self.effort, Interpolation::Lines));
            for (to, from) in [(&mut even.qd, &self.qd), (&mut even.link_q, &self.link_q)] {
                if let (Some(to), Some(from)) = (to, from) {
                    to.extend(onto(from, Interpolation::Cubic));
                }
            }
            if !self.excluded.is_empty() {
                let marks: Vec<f64> = self.excluded.iter().map(|&mark| f64::from(u8::from(mark))).collect();
                even.excluded.extend(onto(&marks, Interpolation::Lines).into_iter().map(|mark| mark > 0.0));
            }
            even.segments.push(Segment { start_s: segment.start_s, samples: count });
            before += segment.samples;
        }
        even
    }

    /// A part of each segment, by the places of its first sample and behind its last; `part` receives the number of samples
    /// before the segment.
    pub(super) fn pieces(&self, part: impl Fn(&Segment, usize) -> (usize, usize)) -> Self {
        let n = self.dof;
        let mut log = Self {
            q: Vec::new(),
            qd: self.qd.as_ref().map(|_| Vec::new()),
            link_q: self.link_q.as_ref().map(|_| Vec::new()),
            effort: Vec::new(),
            excluded: Vec::new(),
            segments: Vec::new(),
            name: self.name.clone(),
            joints: self.joints.clone(),
            dof: n,
            rate_hz: self.rate_hz,
            effort_unit: self.effort_unit,
            robot: self.robot.clone(),
            recording: None,
            servo: self.servo.clone(),
            notes: self.notes.clone(),
            complete: self.complete,
            conversion: self.conversion.clone(),
            origin: self.origin.clone(),
        };
        let mut before = 0;
        for segment in &self.segments {
            let (first, end) = part(segment, before);
            if first < end {
                let rows = (before + first) * n..(before + end) * n;
                log.q.extend_from_slice(&self.q[rows.clone()]);
                log.effort.extend_from_slice(&self.effort[rows.clone()]);
                for (to, from) in [(&mut log.qd, &self.qd), (&mut log.link_q, &self.link_q)] {
                    if let (Some(to), Some(from)) = (to, from) {
                        to.extend_from_slice(&from[rows.clone()]);
                    }
                }
                if !self.excluded.is_empty() {
                    log.excluded.extend_from_slice(&self.excluded[rows]);
                }
                let start_s = segment.start_s + first as f64 / self.rate_hz;
                log.segments.push(Segment { start_s, samples: end - first });
            }
            before += segment.samples;
        }
        log
    }
}

#[cfg(test)]
mod tests {
    use crate::log::parse_csv;
    use crate::text::Text;

    #[test]
    fn parts_keep_their_times_and_breaks() {
        // Two segments of 1 s at 100 Hz with 1 s between them.
        let rows: String =
            (0..200).map(|k| format!("{},{k},0.5\n", f64::from(k) * 0.01 + if k < 100 { 0.0 } else { 1.0 })).collect();
        let log = parse_csv(Text::new("r.csv", format!("t,q1,tau1\n{rows}"))).unwrap();
        assert_eq!(log.segments.iter().map(|s| s.samples).collect::<Vec<_>>(), [100, 100]);
        let part = log.between(0.5, 2.5);
        assert_eq!((part.len(), part.q[0], part.q[99]), (100, 50.0, 149.0));
        assert_eq!(part.segments.iter().map(|s| s.samples).collect::<Vec<_>>(), [50, 50]);
        let (first, last) = log.split(160);
        assert_eq!((first.len(), last.len(), last.segments.len(), last.q[0]), (160, 40, 1, 160.0));
        assert!((last.segments[0].start_s - 2.6).abs() < 1e-9);
        assert!(log.between(1.2, 1.8).is_empty());
    }
}
