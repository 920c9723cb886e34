//! Which shapes and pairs of links a clearance is held against, and which not and why.

use std::collections::BTreeSet;

use armid::excitation::clearance::Scene;
use armid::model::Robot;
use armid_io::robot::HeldShapes;
use serde::{Serialize, Serializer};
use serde_json::json;

/// Which clearances a design holds.
#[derive(Clone, Copy, Debug)]
pub struct HeldClearance<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// The distance that is held, m.
    pub required_m: f64,
    /// The shapes that it is held against, and those that it is not.
    pub shapes: &'a HeldShapes,
}

/// Two links that no clearance is held between.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairLeftOut {
    /// Their numbers.
    pub links: (usize, usize),
    /// Why, as the end of a sentence about them.
    pub reason: String,
}

impl Serialize for HeldClearance<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
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
        .serialize(serializer)
    }
}

impl HeldClearance<'_> {
    /// Pairs of links with shapes that are held, and the others.
    pub fn pairs(&self) -> (BTreeSet<(usize, usize)>, Vec<PairLeftOut>) {
        let scene = Scene::new(self.robot);
        let held: BTreeSet<(usize, usize)> = (0..scene.pairs.len()).filter_map(|pair| scene.links(pair)).collect();
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
