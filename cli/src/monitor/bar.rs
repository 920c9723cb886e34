//! A value on a line of characters.

/// Where a value stands between its limits: `├──·····┃········──┤`, soft limits where the dots end. A value outside is
/// drawn at the end that it has passed, as `◀` or `▶`.
pub(super) fn position(value: Option<f64>, hard: (f64, f64), soft: (f64, f64), width: usize) -> String {
    let (low, high) = hard;
    if !(low.is_finite() && high.is_finite() && high > low && width >= 4) {
        return " ".repeat(width);
    }
    let inner = width - 2;
    let cell = |x: f64| (((x - low) / (high - low) * inner as f64) as usize).min(inner - 1);
    let mut cells: Vec<char> =
        (0..inner).map(|k| if k < cell(soft.0) || k > cell(soft.1) { '─' } else { '·' }).collect();
    match value {
        Some(x) if x < low => cells[0] = '◀',
        Some(x) if x > high => cells[inner - 1] = '▶',
        Some(x) if x.is_finite() => cells[cell(x)] = '┃',
        _ => {}
    }
    format!("├{}┤", cells.into_iter().collect::<String>())
}

/// How much of something is used: full cells from the left, `▶` at the end where it is more than all.
pub(super) fn share(part: f64, width: usize) -> String {
    if !part.is_finite() {
        return " ".repeat(width);
    }
    let full = (part.clamp(0.0, 1.0) * width as f64).round() as usize;
    let mut cells: Vec<char> = (0..width).map(|k| if k < full { '█' } else { '░' }).collect();
    if part > 1.0 && width > 0 {
        cells[width - 1] = '▶';
    }
    cells.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_bars() {
        let bar = |value| position(value, (-10.0, 10.0), (-8.0, 8.0), 22);
        // Twenty cells of one unit each; the cell of a soft limit still has its dot.
        assert_eq!(bar(Some(0.0)), "├──········┃········─┤");
        assert_eq!(bar(Some(-10.0)).chars().nth(1), Some('┃'));
        assert_eq!(bar(Some(10.0)).chars().nth(20), Some('┃'));
        assert_eq!(bar(Some(12.0)).chars().nth(20), Some('▶'));
        assert_eq!(bar(Some(-12.0)).chars().nth(1), Some('◀'));
        assert!(!bar(Some(f64::NAN)).contains('┃') && !bar(None).contains('┃'));
        assert_eq!(position(Some(1.0), (f64::NEG_INFINITY, 1.0), (0.0, 1.0), 8), "        ");
        assert_eq!((share(0.5, 4), share(2.0, 4), share(0.0, 4)), ("██░░".into(), "███▶".into(), "░░░░".into()));
        assert_eq!(share(f64::NAN, 3), "   ");
    }
}
