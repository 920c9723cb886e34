//! Which designs of two families are a pair: those whose search began at the same place.

/// Where the search of a design began. Designs of two families with the same beginning are a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharedStart {
    /// At the first guess of this number, its own or that of the first experiment of its sequence; or the runs of all designs of this
    /// number share their noise.
    Guess(usize),
    /// With the random draws of this number.
    Draws(usize),
    /// Nowhere: a fixed trajectory.
    Fixed,
}
