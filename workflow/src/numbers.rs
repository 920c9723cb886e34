//! Numbers as they are read.

use armid::number::significant;

/// A result for reading: three significant digits, without an exponent where that is readable.
pub fn number(value: f64) -> String {
    significant(value, 3)
}

/// A value that a file or an option states, which a reader compares with it: four significant digits.
pub fn stated(value: f64) -> String {
    significant(value, 4)
}

/// A share in percent, or a dash.
pub fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".to_owned(), error_percent)
}

/// An error in percent: three digits, and two after the point below ten percent, so that a small difference is seen.
pub fn error_percent(share: f64) -> String {
    let value = 100.0 * share;
    let decimals = if value < 9.995 { 2 } else { usize::from(value < 99.95) };
    format!("{value:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::{error_percent, number, stated};

    #[test]
    fn numbers_are_readable() {
        for (value, text) in [
            (0.0, "0"),
            (39.5, "39.5"),
            (0.3302, "0.33"),
            (400_000.0, "400000"),
            (3.054_326, "3.05"),
            (1e-7, "1.00e-7"),
            (f64::INFINITY, "∞"),
            (-12.566_37, "-12.6"),
            (0.02, "0.02"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(stated(0.3302), "0.3302");
        let percents =
            [(0.0, "0.00 %"), (0.099_94, "9.99 %"), (0.099_96, "10.0 %"), (0.9994, "99.9 %"), (1.0, "100 %")];
        for (share, text) in percents {
            assert_eq!(error_percent(share), text);
        }
    }
}
