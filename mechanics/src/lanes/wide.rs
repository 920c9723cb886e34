//! As many runs side by side as the processor has lanes for, found out when the program runs.

use pulp::{Arch, Simd, WithSimd};

use super::elementary::sin_cos;
use super::lane::{Lane, ROUND};

/// More lanes than any processor has.
pub const MOST_LANES: usize = 16;

/// A number of each of `S::F64_LANES` runs, where the widest processors read and write it at once: in one line of their caches.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Wide<S: Simd> {
    simd: S,
    /// One number per lane.
    pub x: S::f64s,
}

impl<S: Simd> Wide<S> {
    /// These numbers.
    #[inline(always)]
    pub fn new(simd: S, x: S::f64s) -> Self {
        Self { simd, x }
    }
}

crate::lanes::arithmetic_of! { impl[S: Simd] Wide<S>, |a, b|
    Self::new(a.simd, a.simd.add_f64s(a.x, b.x)),
    Self::new(a.simd, a.simd.sub_f64s(a.x, b.x)),
    Self::new(a.simd, a.simd.mul_f64s(a.x, b.x)),
    Self::new(a.simd, a.simd.neg_f64s(a.x))
}

impl<S: Simd> Lane for Wide<S> {
    #[inline(always)]
    fn splat(self, x: f64) -> Self {
        Self::new(self.simd, self.simd.splat_f64s(x))
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.splat(1.0).over(self)
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        Self::new(self.simd, self.simd.div_f64s(self.x, other.x))
    }

    #[inline(always)]
    fn nearest(self) -> Self {
        (self + self.splat(ROUND)) - self.splat(ROUND)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Self::new(self.simd, self.simd.abs_f64s(self.x))
    }

    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        self.less(other, self, other)
    }

    #[inline(always)]
    fn less(self, other: Self, a: Self, b: Self) -> Self {
        let mask = self.simd.less_than_f64s(self.x, other.x);
        Self::new(self.simd, self.simd.select_f64s(mask, a.x, b.x))
    }

    #[inline(always)]
    fn most(self) -> f64 {
        self.simd.reduce_max_f64s(self.x)
    }

    #[inline(always)]
    fn reaches(self, least: f64) -> bool {
        let reach = self.simd.less_than_or_equal_f64s(self.simd.splat_f64s(least), self.x);
        self.simd.first_true_m64s(self.simd.not_m64s(reach)) == S::F64_LANES
    }

    #[inline(always)]
    fn each<const K: usize>(x: [Self; K], mut f: impl FnMut([f64; K]) -> f64) -> Self {
        let simd = x[0].simd;
        let mut numbers = [[0.0; MOST_LANES]; K];
        for (numbers, x) in numbers.iter_mut().zip(&x) {
            simd.partial_store_f64s(&mut numbers[..S::F64_LANES], x.x);
        }
        let mut out = [0.0; MOST_LANES];
        for (lane, out) in out.iter_mut().enumerate().take(S::F64_LANES) {
            *out = f(std::array::from_fn(|k| numbers[k][lane]));
        }
        Self::new(simd, simd.partial_load_f64s(&out[..S::F64_LANES]))
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        let bits = self.simd.transmute_u64s_f64s((self + self.splat(ROUND + 1023.0)).x);
        let exponent = self.simd.mul_u64s(bits, self.simd.splat_u64s(1 << 52));
        Self::new(self.simd, self.simd.transmute_f64s_u64s(exponent))
    }
}

/// Sines and cosines of any number of angles, as many at once as there are lanes for: bit by bit those of
/// [`sin_cos`], angle by angle.
///
/// # Panics
/// If the slices are not of one length.
#[inline]
pub fn sines_and_cosines(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) {
    assert!(angles.len() == sines.len() && angles.len() == cosines.len(), "as many sines and cosines as angles");
    Arch::new().dispatch(Angles { angles, sines, cosines });
}

struct Angles<'a> {
    angles: &'a [f64],
    sines: &'a mut [f64],
    cosines: &'a mut [f64],
}

impl WithSimd for Angles<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let mut first = 0;
        while first < self.angles.len() {
            let some = first..self.angles.len().min(first + S::F64_LANES);
            let angles = Wide::new(simd, simd.partial_load_f64s(&self.angles[some.clone()]));
            let (sines, cosines) = sin_cos(angles);
            simd.partial_store_f64s(&mut self.sines[some.clone()], sines.x);
            simd.partial_store_f64s(&mut self.cosines[some], cosines.x);
            first += S::F64_LANES;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_sines_of_many_angles_are_those_of_each_to_the_bit() {
        for count in 0..20 {
            let angles: Vec<f64> = (0..count).map(|k| f64::from(k * k) * 1.7 - 3.0).collect();
            let (mut sines, mut cosines) = (vec![0.0; angles.len()], vec![0.0; angles.len()]);
            sines_and_cosines(&angles, &mut sines, &mut cosines);
            let each: (Vec<f64>, Vec<f64>) = angles.iter().map(|&angle| sin_cos(angle)).unzip();
            assert_eq!((sines, cosines), each);
        }
    }
}
