//! How is a number written for a reader?

/// `value` with `digits` significant digits, without zeros at its end; with an exponent below 0.001 and from a million on.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::number::significant;
/// assert_eq!(significant(0.019_14, 3), "0.0191");
/// assert_eq!(significant(-8.216e-6, 3), "-8.22e-6");
/// assert_eq!(significant(39.5, 4), "39.5");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return match value {
            v if v == f64::INFINITY => "∞".to_owned(),
            v if v == f64::NEG_INFINITY => "−∞".to_owned(),
            v if v.is_nan() => "not a number".to_owned(),
            _ => "0".to_owned(),
        };
    }
    let decimals = digits.max(1) - 1;
    // Rounding may carry into the next power of ten, so the exponent is read off the rounded number.
    let rounded = format!("{value:.decimals$e}");
    let exponent: i32 = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if !(-3..6).contains(&exponent) {
        return rounded;
    }
    let text = format!("{value:.*}", (decimals as i32 - exponent).max(0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}
