//! Which shapes and pairs of links a clearance is held against, and which not and why.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use armid::excitation::clearance::Scene;
use armid::model::Robot;
use armid_io::robot::HeldShapes;
use serde_json::{Value, json};

/// Width of the text.
const WIDTH: usize = 98;

/// Shapes that are not held which the text names one by one, unless it is to name all.
const NAMED: usize = 8;

/// What the answer of a design says of clearances.
pub(crate) struct ClearanceAnswer<'a> {
    pub(crate) robot: &'a Robot,
    /// The distance that is held, m.
    pub(crate) required_m: f64,
    pub(crate) shapes: &'a HeldShapes,
}

/// Two links that no clearance is held between.
struct PairLeftOut {
    links: (usize, usize),
    reason: String,
}

impl ClearanceAnswer<'_> {
    pub(crate) fn json(&self) -> Value {
        let name = |link: usize| self.robot.link_name(link);
        let (pairs, left_out) = self.pairs();
        json!({
            "held": self.shapes.held.iter().map(|shape| json!({
                "link": name(shape.link),
                "body": shape.body,
                "kind": shape.kind,
                "file": shape.file,
                "points": shape.points,
                "margin_m": shape.margin_m,
            })).collect::<Vec<_>>(),
            "not_held": self.shapes.left_out.iter().map(|shape| json!({
                "body": shape.body,
                "kind": shape.kind,
                "reason": shape.reason,
            })).collect::<Vec<_>>(),
            "pairs": pairs.iter().map(|&(inner, outer)| [name(inner), name(outer)]).collect::<Vec<_>>(),
            "pairs_not_held": left_out.iter().map(|pair| json!({
                "links": [name(pair.links.0), name(pair.links.1)],
                "reason": pair.reason,
            })).collect::<Vec<_>>(),
        })
    }

    pub(crate) fn text(&self, verbose: bool) -> String {
        let mut text = String::new();
        let (held, left_out) = (&self.shapes.held, &self.shapes.left_out);
        let (pairs, pairs_left_out) = self.pairs();
        let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
        for shape in held {
            *kinds.entry(shape.kind).or_default() += 1;
        }
        let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} × {kind}")).collect();
        let margin = held.iter().map(|shape| shape.margin_m).fold(0.0, f64::max);
        let mut words = vec![format!(
            "clearance of {} m is held between {} collision shapes of the robot, in {} pairs of links",
            self.required_m,
            held.len(),
            pairs.len()
        )];
        if !self.robot.obstacles().is_empty() {
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
            let pair = format!("{} to {}", self.robot.link_name(inner), self.robot.link_name(outer));
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

    /// Pairs of links with shapes that are held, and the others.
    fn pairs(&self) -> (BTreeSet<(usize, usize)>, Vec<PairLeftOut>) {
        let scene = Scene::new(self.robot);
        let held: BTreeSet<(usize, usize)> = (0..scene.pairs().len()).filter_map(|pair| scene.links(pair)).collect();
        let links: BTreeSet<usize> = self.robot.shapes().iter().map(|shape| shape.link).collect();
        let mut left_out = Vec::new();
        for &inner in &links {
            for &outer in links.iter().filter(|&&outer| outer > inner && !held.contains(&(inner, outer))) {
                let links = (inner, outer);
                let touching = self.shapes.touching.iter().find(|touching| touching.links == links);
                let reason = match touching {
                    Some(touching) => format!("are within it in {:.0} % of random postures", 100.0 * touching.share),
                    None if self.robot.may_touch().contains(&links) => "may touch by the robot file".to_owned(),
                    None => "follow each other".to_owned(),
                };
                left_out.push(PairLeftOut { links, reason });
            }
        }
        (held, left_out)
    }
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
