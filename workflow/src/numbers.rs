//! Numbers as they are read.

use armid::number::significant;

/// A number for reading: four significant digits, without an exponent where that is readable.
pub fn number(value: f64) -> String {
    significant(value, 4)
}

/// A share in percent.
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), |share| format!("{:.2} %", 100.0 * share))
}

/// An error in percent: two digits after the point below ten percent, so that a small difference is seen.
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
