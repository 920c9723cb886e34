//! The law of a term: once as it is written, once as it is called.

use std::fmt;

use super::entry::{Structure, TermEntry};
use super::input::{Shapes, TermBlock, TermInput};
use super::number::{Number, Slope};

/// The law of a term as it is written, once for values, slopes and lanes.
///
/// ```text
/// τ += φ d g(dᵀq, dᵀq̇, dᵀq̈, …)        d = e_j (a joint's) or Cᵀe_j (a motor's)
/// ```
/// `g` is the torque of one unit of the coefficient `φ`. It must be affine in acceleration with a constant slope (the
/// slope is the term's part in the mass matrix), and at rest at zero acceleration depend on nothing that jumps.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::term::{Number, Term, TermEntry, TermInput, TermLaw, ViscousFriction};
/// /// Air drag, `g = v |v|`.
/// #[derive(Debug)]
/// struct Drag;
/// impl TermLaw for Drag {
///     const ENTRY: TermEntry = TermEntry { symbol: "Fr", name: "drag", ..ViscousFriction::ENTRY };
///     fn law<R: Number>(&self, x: &TermInput<R>) -> R {
///         x.qd * x.qd.magnitude()
///     }
/// }
/// const DRAG: Term = Term::new(&Drag);
/// assert_eq!(DRAG.symbol(), "Fr");
/// ```
pub trait TermLaw: fmt::Debug + Send + Sync + 'static {
    /// Everything but the law.
    const ENTRY: TermEntry;

    /// `g`, effort per unit of the coefficient.
    fn law<R: Number>(&self, x: &TermInput<R>) -> R;

    /// Energy stored in one unit of the coefficient at `(q, q̇)` of `x`, J: kinetic for an inertia, potential for a spring.
    fn energy(&self, x: &TermInput<f64>) -> f64 {
        let _ = x;
        0.0
    }

    /// How the structural reduction sees the law with these shape parameters: as the entry says, unless one of them makes
    /// another function of it.
    fn structure_at(&self, shape: &Shapes) -> Structure {
        let _ = shape;
        Self::ENTRY.structure
    }
}

/// The law of a term as it is called: in blocks, without knowing which it is. Every [`TermLaw`] is one.
pub trait TorqueTerm: fmt::Debug + Send + Sync {
    /// Everything but the law.
    fn entry(&self) -> &'static TermEntry;

    /// `g` of every entry of a block; `out` is as long.
    fn torques(&self, block: &TermBlock<'_>, out: &mut [f64]);

    /// `∂g/∂(q, q̇, q̈, τ_t)` of every entry of a block; `out` is as long.
    fn slopes(&self, block: &TermBlock<'_>, out: &mut [[f64; Slope::COUNT]]);

    /// See [`TermLaw::energy`].
    fn energy(&self, x: &TermInput<f64>) -> f64;

    /// See [`TermLaw::structure_at`].
    fn structure_at(&self, shape: &Shapes) -> Structure;
}

impl<T: TermLaw> TorqueTerm for T {
    fn entry(&self) -> &'static TermEntry {
        const { &T::ENTRY }
    }

    #[inline]
    fn torques(&self, block: &TermBlock<'_>, out: &mut [f64]) {
        for (k, out) in out.iter_mut().enumerate() {
            *out = self.law(&block.entry(k));
        }
    }

    fn slopes(&self, block: &TermBlock<'_>, out: &mut [[f64; Slope::COUNT]]) {
        for (k, out) in out.iter_mut().enumerate() {
            let TermInput { q, qd, qdd, load, warmth, shape } = block.entry(k);
            let variables = TermInput {
                q: Slope::variable(q, 0),
                qd: Slope::variable(qd, 1),
                qdd: Slope::variable(qdd, 2),
                load: Slope::variable(load, 3),
                warmth: Slope::fixed(warmth),
                shape,
            };
            *out = self.law(&variables).by;
        }
    }

    fn energy(&self, x: &TermInput<f64>) -> f64 {
        TermLaw::energy(self, x)
    }

    fn structure_at(&self, shape: &Shapes) -> Structure {
        TermLaw::structure_at(self, shape)
    }
}
