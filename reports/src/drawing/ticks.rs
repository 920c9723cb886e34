//! Which numbers stand along an axis, and how they are written.
//!
//! Linear axes step by 1, 2 or 5 times a power of ten. Logarithmic axes take the densest of: linear steps (under a third of
//! a decade), 1 to 9, 1-2-5, 1-3, powers of ten, every second, third, … power. Labels keep a gap between them.

use libm::log10;

use super::axis::{Scale, Span};

/// A number along an axis.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// Ticks of `span` on an axis `length` px long, the densest for which neighbours fit: `extent` gives the length of a label
/// along the axis, px.
pub(crate) fn ticks(span: &Span, length: f64, gap: f64, extent: impl Fn(&str) -> f64) -> Vec<Tick> {
    let mut sparsest = Vec::new();
    let apart = |low: f64, high: f64| (span.fraction(high) - span.fraction(low)) * length;
    for values in candidates(span) {
        // Where not even empty labels fit, none is written: the densest have two thousand.
        if values.windows(2).any(|pair| apart(pair[0], pair[1]) < gap) {
            continue;
        }
        let ticks = write(values, span);
        let fits = ticks.windows(2).all(|pair| {
            let room = 0.5 * (extent(&pair[0].label) + extent(&pair[1].label)) + gap;
            apart(pair[0].value, pair[1].value) >= room
        });
        if fits && ticks.len() >= 2 {
            return ticks;
        }
        if fits && sparsest.is_empty() {
            sparsest = ticks;
        }
    }
    sparsest
}

/// Lists of tick positions from dense to sparse.
fn candidates(span: &Span) -> Vec<Vec<f64>> {
    match span.scale {
        Scale::Linear => linear_candidates(span),
        Scale::Log => {
            let decades = log10(span.high) - log10(span.low);
            let mut lists = Vec::new();
            if decades > 0.9 {
                lists.push(
                    log_multiples(span, &[1, 2, 3, 4, 5, 6, 7, 8, 9]).into_iter().filter(|_| decades < 1.2).collect(),
                );
                lists.push(log_multiples(span, &[1, 2, 5]));
                lists.push(log_multiples(span, &[1, 3]));
                lists.extend((1..=60).map(|stride| log_powers(span, stride)));
            }
            lists.extend(linear_candidates(span));
            lists
        }
    }
}

fn linear_candidates(span: &Span) -> Vec<Vec<f64>> {
    let start = log10(span.high - span.low).floor() as i32 - 2;
    let mut lists = Vec::new();
    for exponent in start..start + 5 {
        for mantissa in [1.0, 2.0, 5.0] {
            lists.push(multiples(span, mantissa, exponent));
        }
    }
    lists
}

/// Multiples of `mantissa · 10^exponent` inside the span.
fn multiples(span: &Span, mantissa: f64, exponent: i32) -> Vec<f64> {
    // Dividing by a positive power of ten rounds once, so 0.3 is the number that one writes as 0.3.
    let place = |count: f64| {
        let units = count * mantissa;
        if exponent < 0 { units / libm::exp10(f64::from(-exponent)) } else { units * libm::exp10(f64::from(exponent)) }
    };
    let step = place(1.0);
    let (first, last) = ((span.low / step - 1e-9).ceil(), (span.high / step + 1e-9).floor());
    if !(last - first).is_finite() || last - first > 2000.0 {
        return Vec::new();
    }
    (0..=(last - first).max(-1.0) as i64).map(|k| place(first + k as f64) + 0.0).collect()
}

fn log_multiples(span: &Span, mantissas: &[u8]) -> Vec<f64> {
    let (first, last) = (log10(span.low).floor() as i32, log10(span.high).ceil() as i32);
    let all = (first..=last).flat_map(|power| mantissas.iter().map(move |&m| times_power_of_ten(m, power)));
    all.filter(|&value| span.contains(value)).collect()
}

fn log_powers(span: &Span, stride: i32) -> Vec<f64> {
    let (first, last) = (log10(span.low).floor() as i32, log10(span.high).ceil() as i32);
    let powers = (first..=last).filter(|power| power.rem_euclid(stride) == 0);
    powers.map(|power| times_power_of_ten(1, power)).filter(|&value| span.contains(value)).collect()
}

fn times_power_of_ten(mantissa: u8, power: i32) -> f64 {
    let size = libm::exp10(f64::from(power.abs()));
    if power < 0 { f64::from(mantissa) / size } else { f64::from(mantissa) * size }
}

/// Short strokes without numbers between the numbers of a logarithmic axis.
pub(crate) fn minor_ticks(span: &Span) -> Vec<f64> {
    let decades = log10(span.high.abs()) - log10(span.low.abs());
    match span.scale {
        Scale::Linear => Vec::new(),
        Scale::Log if decades > 8.0 => log_powers(span, 1),
        Scale::Log if decades > 4.0 => log_multiples(span, &[1, 2, 5]),
        Scale::Log => log_multiples(span, &[1, 2, 3, 4, 5, 6, 7, 8, 9]),
    }
}

/// Writes all numbers of an axis in one manner: plain, or with powers of ten where one of them is very large or small.
fn write(values: Vec<f64>, span: &Span) -> Vec<Tick> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let smallest = values.iter().fold(f64::INFINITY, |least, value| least.min(value.abs()));
    let spread = values.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let label = |value: f64| -> String {
        match span.scale {
            // Between numbers of a log axis the steps differ: each number takes the digits it needs.
            Scale::Log if largest > 99_999.0 || smallest < 0.000_99 => powered(value, 9),
            Scale::Log => shortest(value, 12),
            Scale::Linear if !(0.000_99..=999_999.0).contains(&largest) => {
                let digits = (log10(largest.max(f64::MIN_POSITIVE)).floor() - log10(spread).floor()).clamp(0.0, 12.0);
                powered(value, if spread.is_finite() { digits as usize } else { 3 })
            }
            Scale::Linear => {
                let decimals =
                    if spread.is_finite() { (-(log10(spread) + 1e-9).floor()).clamp(0.0, 15.0) } else { 6.0 };
                plain(value, decimals as usize)
            }
        }
    };
    let mut ticks: Vec<Tick> = values.iter().map(|&value| Tick { value, label: label(value) }).collect();
    if span.scale == Scale::Linear && !spread.is_finite() {
        for tick in &mut ticks {
            tick.label = shortest(tick.value, 6);
        }
    }
    ticks
}

/// Fixed-point digits, a real minus sign, thin spaces between thousands from five digits on.
pub(crate) fn plain(value: f64, decimals: usize) -> String {
    let written = format!("{:.decimals$}", value.abs());
    let (whole, fraction) =
        written.split_once('.').map_or((written.as_str(), ""), |(whole, fraction)| (whole, fraction));
    let mut text = String::new();
    if value < 0.0 && written.bytes().any(|byte| (b'1'..=b'9').contains(&byte)) {
        text.push('−');
    }
    for (position, digit) in whole.chars().enumerate() {
        if whole.len() > 4 && position > 0 && (whole.len() - position).is_multiple_of(3) {
            text.push('\u{202F}');
        }
        text.push(digit);
    }
    if !fraction.is_empty() {
        text.push('.');
        text.push_str(fraction);
    }
    text
}

/// `value` rounded to `digits` significant digits.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value.abs() <= 0.0 {
        return "0".to_owned();
    }
    // Rounding may carry into the next power of ten, so the exponent is read off the rounded number.
    let rounded = format!("{:.*e}", digits - 1, value.abs());
    let exponent: i32 = rounded.split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    if !(-4..6).contains(&exponent) {
        return powered_in_full(value, digits - 1);
    }
    plain(value, (digits as i32 - 1 - exponent).max(0) as usize)
}

/// Fixed-point digits, or a power of ten where they would be too many to read.
pub(crate) fn compact(value: f64, decimals: usize) -> String {
    if value.abs() < 1e6 { plain(value, decimals.min(12)) } else { powered(value, 2) }
}

/// Fixed-point digits without trailing zeros, at most `decimals` of them.
pub(crate) fn shortest(value: f64, decimals: usize) -> String {
    let text = plain(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// `1.5×10⁻⁶`, with at most `digits` digits after the point and without trailing zeros; `10³` where the mantissa is 1.
pub(crate) fn powered(value: f64, digits: usize) -> String {
    if value.abs() <= 0.0 {
        return "0".to_owned();
    }
    let (sign, mantissa, power) = split(value, digits);
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { &mantissa };
    match (mantissa, power.as_str()) {
        ("1", _) => format!("{sign}10{power}"),
        (_, "⁰") => format!("{sign}{mantissa}"),
        _ => format!("{sign}{mantissa}×10{power}"),
    }
}

/// `1.0×10⁻⁶`, with exactly `digits` digits after the point.
pub(crate) fn powered_in_full(value: f64, digits: usize) -> String {
    let (sign, mantissa, power) = split(value, digits);
    format!("{sign}{mantissa}×10{power}")
}

/// Sign, mantissa with `digits` digits after the point, and exponent in superscript.
fn split(value: f64, digits: usize) -> (&'static str, String, String) {
    let written = format!("{:.digits$e}", value.abs());
    let (mantissa, exponent) = written.split_once('e').unwrap_or((&written, "0"));
    (if value < 0.0 { "−" } else { "" }, mantissa.to_owned(), exponent.chars().map(superscript).collect())
}

fn superscript(character: char) -> char {
    match character {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        _ => '⁻',
    }
}

#[cfg(test)]
mod tests {
    use super::{Scale, Span, plain, powered, powered_in_full, ticks};

    fn labels(scale: Scale, low: f64, high: f64, length: f64) -> Vec<String> {
        let span = Span { scale, low, high };
        ticks(&span, length, 12.0, |label| 7.0 * label.chars().count() as f64)
            .into_iter()
            .map(|tick| tick.label)
            .collect()
    }

    #[test]
    fn analytic_linear_ticks_step_by_one_two_or_five() {
        assert_eq!(labels(Scale::Linear, -1.05, 1.05, 200.0), ["−1.0", "−0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Linear, 0.0, 10.0, 300.0).last().map(String::as_str), Some("10"));
        assert_eq!(
            labels(Scale::Linear, 0.0, 62_000.0, 250.0),
            ["0", "20\u{202F}000", "40\u{202F}000", "60\u{202F}000"]
        );
        assert_eq!(labels(Scale::Linear, 0.0, 4.2e-6, 200.0), ["0", "2×10⁻⁶", "4×10⁻⁶"]);
    }

    #[test]
    fn analytic_log_ticks_are_one_two_five_or_powers() {
        assert_eq!(labels(Scale::Log, 45.0, 1200.0, 300.0), ["50", "100", "200", "500", "1000"]);
        assert_eq!(labels(Scale::Log, 0.5e-6, 2e2, 230.0), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰", "10²"]);
        let narrow = labels(Scale::Log, 51.0, 58.0, 200.0);
        assert!(narrow.len() >= 3, "{narrow:?}");
    }

    #[test]
    fn analytic_any_span_has_ticks_that_do_not_touch() {
        let spans =
            [(1e-90, 1e90), (0.9999, 1.0001), (1e-3, 1.1e-3), (3.0, 4.0), (9.5, 10.5), (1e8, 3e8), (2e-7, 9e-7)];
        for (low, high) in spans {
            for scale in [Scale::Linear, Scale::Log] {
                for length in [120.0, 250.0, 800.0] {
                    let found = labels(scale, low, high, length);
                    assert!(!found.is_empty(), "{scale:?} {low} {high} {length}");
                    let mut unique = found.clone();
                    unique.dedup();
                    assert_eq!(unique, found, "{scale:?} {low} {high} {length}");
                }
            }
        }
    }

    #[test]
    fn analytic_numbers_as_written() {
        assert_eq!(plain(-0.0001, 2), "0.00");
        assert_eq!(plain(-1234567.891, 1), "−1\u{202F}234\u{202F}567.9");
        assert_eq!(plain(1234.0, 0), "1234");
        assert_eq!(powered(1.5e-6, 3), "1.5×10⁻⁶");
        assert_eq!(powered(-1e12, 3), "−10¹²");
        assert_eq!(powered(1.0, 3), "10⁰");
        assert_eq!(powered(0.0, 3), "0");
        assert_eq!(powered_in_full(1e-5, 1), "1.0×10⁻⁵");
    }
}
