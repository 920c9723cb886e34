//! Every random number of armid comes from a stream derived here, from the study's seed, the purpose and the run.
//!
//! ```text
//! stream(seed, purpose, run) = ChaCha8(key = SHA-256(seed ‖ purpose), stream = run)
//! ```
//!
//! ChaCha is counter based: two streams with another `run` never overlap, so a run's numbers depend on neither the
//! number of threads, the order of runs, the shard nor what was resumed.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// The generator behind every stream.
pub type Stream = ChaCha8Rng;

/// The seed of a study, a design or a single experiment; hands out independent streams.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::seed::Seed;
/// use rand::RngExt;
/// let seed = Seed::new(7);
/// let a: f64 = seed.stream("current noise", 3).random();
/// let b: f64 = seed.stream("current noise", 3).random();
/// let c: f64 = seed.stream("current noise", 4).random();
/// assert!(a == b && a != c);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(transparent)]
pub struct Seed(u64);

impl Seed {
    /// A seed from a number that a person wrote down.
    #[must_use]
    pub const fn new(value: u64) -> Self {
        Self(value)
    }

    /// The number itself.
    pub const fn value(self) -> u64 {
        self.0
    }

    /// The stream of random numbers for one purpose and one run.
    pub fn stream(self, purpose: &str, run: u64) -> Stream {
        let mut rng = ChaCha8Rng::from_seed(self.key(purpose));
        rng.set_stream(run);
        rng
    }

    /// The random numbers of one run.
    pub const fn of_run(self, run: u64) -> RunNoise {
        RunNoise { seed: self, run, opposite: false }
    }

    /// A seed of its own for a part of the work, so that the part can be rerun alone.
    #[must_use]
    pub fn child(self, purpose: &str, index: u64) -> Self {
        let key = Self(self.0 ^ index.rotate_left(32)).key(purpose);
        let (head, _) = key.split_at(8);
        Self(head.iter().fold(0, |value, &byte| (value << 8) | u64::from(byte)))
    }

    fn key(self, purpose: &str) -> [u8; 32] {
        let mut hash = Sha256::new();
        hash.update(self.0.to_le_bytes());
        hash.update(purpose.as_bytes());
        hash.finalize().into()
    }
}

/// The random numbers of one run of an experiment, or their opposites.
///
/// Every number whose distribution is symmetrical about zero (noise, a grid's place, jitter) has the other sign in a run with
/// opposite noise: antithetic variates (J. M. Hammersley and K. W. Morton, *Proc. Cambridge Phil. Soc.* 52(3), 1956). Events with
/// a probability, as the loss of a sample, are the same in both.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::seed::Seed;
/// let run = Seed::new(7).of_run(3);
/// assert_eq!((run.sign(), run.opposite().sign()), (1.0, -1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunNoise {
    /// Root of the streams.
    pub seed: Seed,
    /// Number of the stream of each purpose.
    pub run: u64,
    opposite: bool,
}

impl RunNoise {
    /// The run with the opposite of these numbers.
    #[must_use]
    pub const fn opposite(self) -> Self {
        Self { opposite: !self.opposite, ..self }
    }

    /// What symmetrical numbers are multiplied with: 1, or −1.
    pub const fn sign(self) -> f64 {
        if self.opposite { -1.0 } else { 1.0 }
    }

    /// The stream for one purpose; its numbers have no sign yet.
    pub fn stream(self, purpose: &str) -> Stream {
        self.seed.stream(purpose, self.run)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;

    #[test]
    fn streams_differ_by_purpose_run_and_child() {
        let seed = Seed::new(1);
        let first = |mut s: Stream| -> u64 { s.random() };
        let values = [
            first(seed.stream("a", 0)),
            first(seed.stream("a", 1)),
            first(seed.stream("b", 0)),
            first(seed.child("a", 0).stream("a", 0)),
            first(seed.child("a", 1).stream("a", 0)),
        ];
        for (i, a) in values.iter().enumerate() {
            for b in &values[i + 1..] {
                assert_ne!(a, b);
            }
        }
    }
}
