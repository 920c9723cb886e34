//! From one link to the next without the products that right angles make zero.
//!
//! ```text
//! T(q) = [Rx(β) Rz(q + θ) Rx(α), p(q)]      β, θ, α multiples of 90°
//! ```
//! So stand most links of DH tables and URDFs. What is left out is `0 · x`, `1 · x` and `x + 0`, so the bits are those of all
//! products.

use nalgebra::{Matrix3, Vector3};

use crate::lanes::Lane;
use crate::spatial::{LaneMotion, LanePlacement, Three, cross, sum};

/// The rotation `Rx(β) Rz(q + θ) Rx(α)` by quarter turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct QuarterTurns {
    before: Quarter,
    about: Quarter,
    after: Quarter,
}

/// So many right angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quarter {
    None,
    One,
    Two,
    Three,
}

/// Which numbers of a link's position in the one before may differ from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shift {
    Nowhere,
    AlongZ,
    AcrossZ,
    Anywhere,
}

/// Where a link stands in the one before, of each of several samples.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LinkStep<V> {
    /// In any way.
    Any(LanePlacement<V>),
    /// Turned by right angles but for the joint's own.
    Right(RightStep<V>),
}

/// A link's pose in the one before where all angles but its joint's are right.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RightStep<V> {
    pub(super) turns: QuarterTurns,
    pub(super) shift: Shift,
    /// Of `q + θ`.
    pub(super) cosine: V,
    pub(super) sine: V,
    /// m.
    pub(super) origin: Three<V>,
}

impl Quarter {
    const ALL: [Self; 4] = [Self::None, Self::One, Self::Two, Self::Three];

    /// Cosine and sine.
    const fn numbers(self) -> [f64; 2] {
        match self {
            Self::None => [1.0, 0.0],
            Self::One => [0.0, 1.0],
            Self::Two => [-1.0, 0.0],
            Self::Three => [0.0, -1.0],
        }
    }

    /// `Rx`.
    fn about_x(self) -> Matrix3<f64> {
        let [c, s] = self.numbers();
        Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
    }

    /// `Rxᵀ x`.
    #[inline(always)]
    fn back<V: Lane>(self, [x, y, z]: Three<V>) -> Three<V> {
        match self {
            Self::None => [x, y, z],
            Self::One => [x, z, -y],
            Self::Two => [x, -y, -z],
            Self::Three => [x, -z, y],
        }
    }
}

impl QuarterTurns {
    /// Those of `R(q) = constant + cos q · along_x + sin q · along_y`, if it has such ones.
    pub(super) fn of(constant: &Matrix3<f64>, along_x: &Matrix3<f64>, along_y: &Matrix3<f64>) -> Option<Self> {
        // Rz(q) = z + cos q · flat + sin q · quarter.
        let z = Matrix3::from_diagonal(&Vector3::z());
        let (flat, quarter) = (Matrix3::identity() - z, Vector3::z().cross_matrix());
        let with = |before: Quarter| Quarter::ALL.map(|about| Quarter::ALL.map(|after| Self { before, about, after }));
        Quarter::ALL.map(with).as_flattened().as_flattened().iter().copied().find(|turns| {
            let [c, s] = turns.about.numbers();
            let turned = |m: Matrix3<f64>| turns.before.about_x() * m * turns.after.about_x();
            let found = [turned(z), turned(flat * c + quarter * s), turned(quarter * c - flat * s)];
            found == [*constant, *along_x, *along_y]
        })
    }

    /// Cosine and sine of `q + θ`.
    #[inline(always)]
    pub(super) fn turn<V: Lane>(self, cosine: V, sine: V) -> (V, V) {
        match self.about {
            Quarter::None => (cosine, sine),
            Quarter::One => (-sine, cosine),
            Quarter::Two => (-cosine, -sine),
            Quarter::Three => (sine, -cosine),
        }
    }
}

impl Shift {
    /// That of a position whose numbers are zero for every q where all of these are.
    pub(super) fn of(parts: [[f64; 3]; 3]) -> Self {
        let zero = |k: usize| parts.iter().all(|part| part[k] == 0.0);
        match (zero(0) && zero(1), zero(2)) {
            (true, true) => Self::Nowhere,
            (true, false) => Self::AlongZ,
            (false, true) => Self::AcrossZ,
            (false, false) => Self::Anywhere,
        }
    }
}

impl<V: Lane> LinkStep<V> {
    /// A motion given in the link before, expressed in this link: `ω' = Rᵀω`, `v' = Rᵀ(v + ω × p)`.
    #[inline(always)]
    pub(crate) fn motion_to_child(&self, motion: &LaneMotion<V>) -> LaneMotion<V> {
        match self {
            Self::Any(placement) => placement.motion_to_child(motion),
            Self::Right(right) => right.motion_to_child(motion),
        }
    }
}

impl<V: Lane> RightStep<V> {
    #[inline(always)]
    fn motion_to_child(&self, motion: &LaneMotion<V>) -> LaneMotion<V> {
        let (mut w, v, p) = (motion.ang, motion.lin, &self.origin);
        let mut u = match self.shift {
            Shift::Nowhere => v,
            Shift::AlongZ => [v[0] + w[1] * p[2], v[1] - w[0] * p[2], v[2]],
            Shift::AcrossZ => [v[0] - w[2] * p[1], v[1] + w[2] * p[0], v[2] + (w[0] * p[1] - w[1] * p[0])],
            Shift::Anywhere => sum(&v, &cross(&w, p)),
        };
        if self.turns.before != Quarter::None {
            (w, u) = (self.turns.before.back(w), self.turns.before.back(u));
        }
        let (w, u) = (self.turned(w), self.turned(u));
        // One question for both.
        match self.turns.after {
            Quarter::None => LaneMotion { ang: w, lin: u },
            Quarter::One => LaneMotion { ang: Quarter::One.back(w), lin: Quarter::One.back(u) },
            Quarter::Two => LaneMotion { ang: Quarter::Two.back(w), lin: Quarter::Two.back(u) },
            Quarter::Three => LaneMotion { ang: Quarter::Three.back(w), lin: Quarter::Three.back(u) },
        }
    }

    /// `Rz(q + θ)ᵀ x`.
    #[inline(always)]
    fn turned(&self, [x, y, z]: Three<V>) -> Three<V> {
        let (c, s) = (self.cosine, self.sine);
        [c * x + s * y, c * y - s * x, z]
    }
}
