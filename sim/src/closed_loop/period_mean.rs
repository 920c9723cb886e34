//! The mean of the recorded periods of a motion, of which no more are simulated than differ.

/// Two periods whose positions differ by less than this everywhere are the same, rad (m).
const SAME: f64 = 1e-12;

/// Tables of one period, each in rows; the first holds positions.
pub(super) type Period = Vec<Vec<f64>>;

/// Periods that come one after the other.
pub(super) struct PeriodMean {
    /// Periods that count.
    planned: usize,
    counted: usize,
    before: Vec<f64>,
    sum: Option<Period>,
}

impl PeriodMean {
    /// Of `planned` periods.
    pub(super) fn new(planned: usize) -> Self {
        Self { planned, counted: 0, before: Vec::new(), sum: None }
    }

    /// Takes the next period, `counts` or not; the mean where no other is needed.
    pub(super) fn take(&mut self, period: Period, counts: bool) -> Option<Period> {
        let positions = &period[0];
        let repeats = self.before.len() == positions.len()
            && self.before.iter().zip(positions).all(|(before, now)| (before - now).abs() <= SAME);
        self.before.clone_from(positions);
        if !counts {
            return None;
        }
        if repeats && self.sum.is_none() {
            return Some(period);
        }
        // What is left is this period again.
        let times = if repeats { self.planned - self.counted } else { 1 };
        self.counted += times;
        let sum = self.sum.get_or_insert_with(|| period.iter().map(|table| vec![0.0; table.len()]).collect());
        for (sum, table) in sum.iter_mut().zip(&period) {
            for (sum, value) in sum.iter_mut().zip(table) {
                *sum += times as f64 * value;
            }
        }
        if self.counted < self.planned {
            return None;
        }
        let mut mean = self.sum.take()?;
        for value in mean.iter_mut().flatten() {
            *value /= self.planned as f64;
        }
        Some(mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_means_of_periods_that_settle() {
        let period = |x: f64| vec![vec![x, 2.0 * x], vec![10.0 * x]];
        let mut mean = PeriodMean::new(5);
        assert_eq!(mean.take(period(9.0), false), None);
        assert_eq!(mean.take(period(4.0), true), None);
        assert_eq!(mean.take(period(2.0), true), None);
        // The third is the second again, and so are the fourth and the fifth: (4 + 2 + 3 · 2)/5.
        let found = mean.take(period(2.0), true).unwrap();
        assert!((found[0][0] - 2.4).abs() < 1e-15 && (found[1][0] - 24.0).abs() < 1e-14);
        // One that is that of the discarded period needs no other.
        let mut mean = PeriodMean::new(5);
        mean.take(period(3.0), false);
        assert_eq!(mean.take(period(3.0), true), Some(period(3.0)));
        // None that repeats.
        let mut mean = PeriodMean::new(2);
        assert_eq!(mean.take(period(1.0), true), None);
        assert_eq!(mean.take(period(2.0), true), Some(period(1.5)));
    }
}
