//! Which clearances a design holds, in words.

use std::collections::BTreeMap;
use std::fmt::Write;

use armid_workflow::design::{HeldClearance, PairLeftOut};

/// Width of the text.
const WIDTH: usize = 98;

/// Shapes that are not held which the text names one by one, unless it is to name all.
const NAMED: usize = 8;

/// Shapes and pairs of links that a clearance is held between, and which not and why.
pub(crate) fn text(clearance: &HeldClearance<'_>, verbose: bool) -> String {
    let mut text = String::new();
    let (held, left_out) = (&clearance.shapes.held, &clearance.shapes.left_out);
    let (pairs, pairs_left_out) = clearance.pairs();
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    for shape in held {
        *kinds.entry(shape.kind).or_default() += 1;
    }
    let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} × {kind}")).collect();
    let margin = held.iter().map(|shape| shape.margin_m).fold(0.0, f64::max);
    let mut words = vec![format!(
        "clearance of {} m is held between {} collision shapes of the robot, in {} pairs of links",
        clearance.required_m,
        held.len(),
        pairs.len()
    )];
    if !clearance.robot.obstacles().is_empty() {
        words.push("and from what stands around it".to_owned());
    }
    if !kinds.is_empty() {
        words.push(format!("({})", kinds.join(", ")));
    }
    if margin > 0.0 {
        words.push(format!(
            "; cylinders and meshes count as convex hulls, at most {:.2} mm larger than they are",
            1e3 * margin
        ));
    }
    text.push_str(&wrapped(&words.join(" ").replace(" ;", ";"), 2));
    if verbose {
        for shape in held {
            let file = shape.file.as_ref().map_or_else(String::new, |file| format!(", {}", file.display()));
            let hull = match shape.points {
                0 => String::new(),
                points => format!(", {points} points, at most {:.2} mm larger", 1e3 * shape.margin_m),
            };
            let _ = writeln!(text, "    {} of \"{}\"{hull}{file}", shape.kind, shape.body);
        }
    }
    let named = if verbose { left_out.len() } else { NAMED };
    for shape in left_out.iter().take(named) {
        let line = format!("not held: {} of \"{}\": {}", shape.kind, shape.body, shape.reason);
        text.push_str(&wrapped(&line, 2));
    }
    if left_out.len() > named {
        let _ = writeln!(text, "  not held: {} more, which -v names", left_out.len() - named);
    }
    let mut by_reason: Vec<(String, Vec<String>)> = Vec::new();
    for PairLeftOut { links: (inner, outer), reason } in pairs_left_out {
        let pair = format!("{} to {}", clearance.robot.link_name(inner), clearance.robot.link_name(outer));
        match by_reason.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, pairs)) => pairs.push(pair),
            None => by_reason.push((reason, vec![pair])),
        }
    }
    for (reason, pairs) in by_reason {
        text.push_str(&wrapped(&format!("no clearance between links that {reason}: {}", pairs.join(", ")), 2));
    }
    text
}

/// Lines of words, indented; those after the first by two more.
fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = String::new();
    let mut line = " ".repeat(indent);
    let mut is_empty = true;
    for word in text.split(' ') {
        if !is_empty && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push_str(line.trim_end());
            lines.push('\n');
            line = " ".repeat(indent + 2);
            is_empty = true;
        }
        if !is_empty {
            line.push(' ');
        }
        line.push_str(word);
        is_empty = false;
    }
    lines + line.trim_end() + "\n"
}
