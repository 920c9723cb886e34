//! From a number to a place: linear and logarithmic axes.

use libm::log10;

/// How numbers are spread along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal differences are equally long.
    #[default]
    Linear,
    /// Equal ratios are equally long; every number must be positive.
    Log,
}

/// What an axis says and which numbers it must reach beside those drawn along it.
///
/// The range is never given: it always covers everything that is drawn, so nothing can be cut off.
///
/// ```
/// use armid_reports::Axis;
/// assert_eq!(Axis::linear("velocity", "rad/s").text(), "velocity (rad/s)");
/// assert_eq!(Axis::log("condition number", "").text(), "condition number");
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name of the quantity.
    pub label: String,
    /// Unit, empty for a number without one.
    pub unit: String,
    /// Linear or logarithmic.
    pub scale: Scale,
    /// Numbers that the range reaches in any case, for instance 0 or ±100.
    pub include: Vec<f64>,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), scale: Scale::Linear, include: Vec::new() }
    }

    /// A logarithmic axis.
    pub fn log(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label, unit) }
    }

    /// Returns this axis, which also reaches `values`.
    #[must_use]
    pub fn including(mut self, values: &[f64]) -> Self {
        self.include.extend_from_slice(values);
        self
    }

    /// The label with its unit in parentheses.
    pub fn text(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} ({})", self.label, self.unit) }
    }
}

/// The numbers at both ends of an axis, `low < high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Span {
    /// The span from the smallest to the largest of `values` (checked before: finite, and positive on a log scale),
    /// widened by `pad` of its length at each end; an end at zero stays there. `None` without values.
    pub(crate) fn covering(scale: Scale, values: impl Iterator<Item = f64>, pad: f64) -> Option<Self> {
        let mut ends: Option<(f64, f64)> = None;
        for value in values {
            let (low, high) = ends.unwrap_or((value, value));
            ends = Some((low.min(value), high.max(value)));
        }
        let (low, high) = ends?;
        Some(match scale {
            Scale::Linear => {
                let least = 1e-9 * low.abs().max(high.abs());
                if high - low <= least {
                    let half = if low.abs().max(high.abs()) > 0.0 { 0.1 * low.abs().max(high.abs()) } else { 1.0 };
                    Self { scale, low: low - half, high: high + half }
                } else {
                    let extra = pad * (high - low);
                    let padded_low = if low.abs() <= 0.0 { low } else { low - extra };
                    let padded_high = if high.abs() <= 0.0 { high } else { high + extra };
                    Self { scale, low: padded_low, high: padded_high }
                }
            }
            Scale::Log => {
                let (low, high) = (log10(low), log10(high));
                let extra = if high - low < 1e-6 { 0.3 } else { pad * (high - low) };
                Self { scale, low: libm::exp10(low - extra), high: libm::exp10(high + extra) }
            }
        })
    }

    /// Returns this span, widened so that `low_px` and `high_px` of `length_px` are free at its ends.
    pub(crate) fn with_room(self, low_px: f64, high_px: f64, length_px: f64) -> Self {
        let free = (length_px - low_px - high_px).max(0.2 * length_px);
        match self.scale {
            Scale::Linear => {
                let per_px = (self.high - self.low) / free;
                Self { low: self.low - low_px * per_px, high: self.high + high_px * per_px, ..self }
            }
            Scale::Log => {
                let (low, high) = (log10(self.low), log10(self.high));
                let per_px = (high - low) / free;
                Self { low: libm::exp10(low - low_px * per_px), high: libm::exp10(high + high_px * per_px), ..self }
            }
        }
    }

    /// Place of `value`: 0 at the low end, 1 at the high end.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log => (log10(value) - log10(self.low)) / (log10(self.high) - log10(self.low)),
        }
    }

    pub(crate) fn contains(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }
}

#[cfg(test)]
mod tests {
    use super::{Scale, Span};

    #[test]
    fn analytic_fractions() {
        let linear = Span { scale: Scale::Linear, low: -2.0, high: 6.0 };
        assert!((linear.fraction(0.0) - 0.25).abs() < 1e-15);
        let log = Span { scale: Scale::Log, low: 1.0, high: 1e4 };
        assert!((log.fraction(100.0) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn analytic_span_of_equal_values_is_not_empty() {
        for value in [0.0, 5.0, -1e-12, 1e90] {
            let span = Span::covering(Scale::Linear, [value, value].into_iter(), 0.05).unwrap();
            assert!(span.low < value && value < span.high, "{span:?}");
        }
        let span = Span::covering(Scale::Log, [7.0].into_iter(), 0.05).unwrap();
        assert!(span.low < 7.0 && 7.0 < span.high);
        assert!(Span::covering(Scale::Linear, [].into_iter(), 0.05).is_none());
    }

    #[test]
    fn analytic_room_in_pixels() {
        let span = Span { scale: Scale::Linear, low: 0.0, high: 10.0 }.with_room(20.0, 30.0, 150.0);
        assert!((span.fraction(0.0) * 150.0 - 20.0).abs() < 1e-9);
        assert!((span.fraction(10.0) * 150.0 - 120.0).abs() < 1e-9);
    }
}
