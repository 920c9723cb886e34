//! Numbers as they are read.

/// A number for reading: four significant digits, without an exponent where that is readable.
#[must_use]
pub fn number(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return match value {
            v if v == f64::INFINITY => "∞".to_owned(),
            v if v == f64::NEG_INFINITY => "−∞".to_owned(),
            v if v.is_nan() => "not a number".to_owned(),
            _ => "0".to_owned(),
        };
    }
    let magnitude = value.abs();
    if (1e-3..1e6).contains(&magnitude) {
        let digits = (3 - magnitude.log10().floor() as i32).clamp(0, 8) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.3e}")
    }
}

/// A share in percent.
#[must_use]
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.2} %", 100.0 * share))
}

/// An error in percent: two digits after the point below ten percent, so that a small difference is seen.
#[must_use]
pub fn error_percent(share: f64) -> String {
    let value = 100.0 * share;
    if value < 10.0 { format!("{value:.2} %") } else { format!("{value:.1} %") }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_readable() {
        for (value, text) in [
            (0.0, "0"),
            (39.5, "39.5"),
            (0.3302, "0.3302"),
            (400_000.0, "400000"),
            (3.054_326, "3.054"),
            (1e-7, "1.000e-7"),
            (f64::INFINITY, "∞"),
            (-12.566_37, "-12.57"),
            (0.02, "0.02"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
