//! Sines and cosines of all joints of an arm.

use pulp::Simd;

use super::elementary::sin_cos;
use super::lane::Lane;
use super::wide::{Wide, sines_and_cosines};

/// Numbers of which several sines are found together.
pub trait Sines: Lane {
    /// Sines and cosines of N numbers, each with the bits of [`sin_cos`].
    #[inline(always)]
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N] {
        let mut out = [(x[0], x[0]); N];
        for i in 0..N {
            out[i] = sin_cos(x[i]);
        }
        out
    }
}

impl Sines for f64 {
    /// As many at once as the processor has lanes.
    #[inline(always)]
    fn sines<const N: usize>(x: &[Self; N]) -> [(Self, Self); N] {
        let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
        sines_and_cosines(x, &mut sines, &mut cosines);
        let mut out = [(0.0, 0.0); N];
        for i in 0..N {
            out[i] = (sines[i], cosines[i]);
        }
        out
    }
}

impl<S: Simd> Sines for Wide<S> {}
