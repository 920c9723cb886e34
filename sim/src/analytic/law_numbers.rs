//! The numbers that torque laws are evaluated in: one of each of several runs, alone or with its slope by velocity.

use armid::model::term::{Number, Runs, Scale, TermInput};

use armid::lanes;
use armid::lanes::Lane;

/// A number of each of several runs, as torque laws take it.
#[derive(Clone, Copy)]
pub(super) struct Lanes<V>(pub(super) V);

lanes::arithmetic_of! { impl[V: Lane] Lanes<V>, |a, b| Self(a.0 + b.0), Self(a.0 - b.0), Self(a.0 * b.0), Self(-a.0) }

impl<V: Lane> Number for Lanes<V> {
    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        Self(self.0.splat(x))
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Self(self.0.magnitude())
    }

    #[inline(always)]
    fn over(self, scale: Scale) -> Self {
        Self(self.0 * self.0.splat(scale.reciprocal))
    }

    #[inline(always)]
    fn smooth_sign(self, scale: Scale) -> Self {
        Self(lanes::tanh(self.0 * self.0.splat(scale.reciprocal)))
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        Self(lanes::exp(self.0))
    }

    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (sine, cosine) = lanes::sin_cos(self.0);
        (Self(sine), Self(cosine))
    }
}

impl<V: Lane> Runs for Lanes<V> {
    #[inline(always)]
    fn apart(input: &TermInput<Self>, mut law: impl FnMut(&TermInput<f64>) -> f64) -> Self {
        let TermInput { q, qd, qdd, load, warmth, shape } = *input;
        Self(V::each([q.0, qd.0, qdd.0, load.0, warmth.0], |[q, qd, qdd, load, warmth]| {
            law(&TermInput { q, qd, qdd, load, warmth, shape })
        }))
    }
}

/// A torque with its slope by the velocity of the coordinate.
#[derive(Clone, Copy)]
pub(super) struct Rates<V> {
    pub(super) value: V,
    pub(super) slope: V,
}

impl<V: Lane> Rates<V> {
    /// A number that does not depend on velocity.
    #[inline(always)]
    pub(super) fn fixed(value: V) -> Self {
        Self { value, slope: value.splat(0.0) }
    }

    /// The velocity itself.
    #[inline(always)]
    pub(super) fn velocity(value: V) -> Self {
        Self { value, slope: value.splat(1.0) }
    }
}

lanes::arithmetic_of! { impl[V: Lane] Rates<V>, |a, b|
    Self { value: a.value + b.value, slope: a.slope + b.slope },
    Self { value: a.value - b.value, slope: a.slope - b.slope },
    Self { value: a.value * b.value, slope: a.slope * b.value + a.value * b.slope },
    Self { value: -a.value, slope: -a.slope }
}

impl<V: Lane> Number for Rates<V> {
    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        Self::fixed(self.value.splat(x))
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        let zero = self.value.splat(0.0);
        Self { value: self.value.magnitude(), slope: self.value.less(zero, -self.slope, self.slope) }
    }

    #[inline(always)]
    fn over(self, scale: Scale) -> Self {
        let reciprocal = self.value.splat(scale.reciprocal);
        Self { value: self.value * reciprocal, slope: self.slope * reciprocal }
    }

    #[inline(always)]
    fn smooth_sign(self, scale: Scale) -> Self {
        let reciprocal = self.value.splat(scale.reciprocal);
        let t = lanes::tanh(self.value * reciprocal);
        Self { value: t, slope: self.slope * reciprocal * (t.splat(1.0) - t * t) }
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        let e = lanes::exp(self.value);
        Self { value: e, slope: self.slope * e }
    }

    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        let (sine, cosine) = lanes::sin_cos(self.value);
        (Self { value: sine, slope: self.slope * cosine }, Self { value: cosine, slope: -self.slope * sine })
    }
}

impl<V: Lane> Runs for Rates<V> {
    #[inline(always)]
    fn apart(input: &TermInput<Self>, mut law: impl FnMut(&TermInput<f64>) -> f64) -> Self {
        // A law from outside is known by its values; its slope by velocity is their central difference.
        let TermInput { q, qd, qdd, load, warmth, shape } = *input;
        let values = [q, qd, qdd, load, warmth].map(|x| x.value);
        let mut at = |step: f64| {
            V::each(values, |[q, qd, qdd, load, warmth]| law(&TermInput { q, qd: qd + step, qdd, load, warmth, shape }))
        };
        let (before, value, after) = (at(-STEP), at(0.0), at(STEP));
        Self { value, slope: (after - before) * value.splat(0.5 / STEP) }
    }
}

/// Step of that difference, rad/s (m/s): far below any velocity scale.
const STEP: f64 = 1e-6;
