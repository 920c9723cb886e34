//! Readings of a current that say nothing of it: bits that are lost on a line, a switch next to a cable.
//!
//! ```text
//! î = i with probability 1 − p, else R u,  u uniform in [−1, 1)        R the converter's range
//! ```
//! Each reading of each joint by itself. The servo does not act on measured currents: the arm moves as it would without.

use rand::RngExt;

use crate::seed::Stream;

/// How often one current is read wrong, and within which range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::experiment) struct Spikes {
    /// Share of readings, 0 to 1.
    pub(super) share: f64,
    /// Largest reading, A.
    pub(super) range: f64,
}

impl Spikes {
    /// What is read in place of the current, where this reading is a spike; draws nothing where there are none.
    pub(in crate::experiment) fn reading(&self, stream: &mut Stream, sign: f64) -> Option<f64> {
        (self.share > 0.0 && stream.random::<f64>() < self.share)
            .then(|| sign * self.range * (2.0 * stream.random::<f64>() - 1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn analytic_spikes_have_their_rate_and_the_variance_of_a_uniform_law() {
        let spikes = Spikes { share: 0.1, range: 6.0 };
        let mut stream = Seed::new(4).stream("spikes", 0);
        let found: Vec<f64> = (0..100_000).filter_map(|_| spikes.reading(&mut stream, 1.0)).collect();
        // Binomial: 10 000 ± 95; 4 of them.
        assert!((9_620..=10_380).contains(&found.len()), "{}", found.len());
        assert!(found.iter().all(|value| value.abs() <= 6.0));
        // R²/3 = 12; u² has the standard deviation √(4/45), over √10 000 and R²: 0.107; 4 of them.
        let square = found.iter().map(|value| value * value).sum::<f64>() / found.len() as f64;
        assert!((square - 12.0).abs() < 0.43, "{square}");
        // Mean 0 ± R/√3/100 = 0.035; 4 of them.
        assert!((found.iter().sum::<f64>() / found.len() as f64).abs() < 0.14);
    }

    #[test]
    fn identity_without_a_share_nothing_is_drawn() {
        let (mut stream, mut untouched) = (Seed::new(4).stream("spikes", 0), Seed::new(4).stream("spikes", 0));
        assert_eq!(Spikes { share: 0.0, range: 6.0 }.reading(&mut stream, 1.0), None);
        assert_eq!(stream.random::<u64>(), untouched.random::<u64>());
    }
}
