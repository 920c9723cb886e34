//! Links that are near each other in nearly every posture: their shapes meet in a joint, or one of them is coarse.
//!
//! No motion keeps them apart, so a clearance between them would forbid every design. Robot files list such pairs (`may_touch`);
//! for shapes of a URDF they are found by drawing postures.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use rand::RngExt;

use super::scene::Scene;
use crate::model::{Joint, JointKind, Robot};
use crate::seed::Seed;

/// Postures that are drawn.
const POSTURES: usize = 400;

/// Share of them from which on two links count as always near.
const SHARE: f64 = 0.95;

/// Two links that are always near.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct TouchingLinks {
    /// The links, 0 is the base, the lower first.
    pub links: (usize, usize),
    /// Share of the postures in which they are.
    pub share: f64,
}

/// Pairs of links of which two bodies come within `clearance` (m) in at least 95 % of 400 postures drawn evenly within the
/// position limits, within ±π or ±1 m where there are none. The postures are the same for every robot of as many joints.
pub fn touching_links(robot: &Robot, clearance: f64) -> Vec<TouchingLinks> {
    let mut scene = Scene::new(robot);
    let mut near: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut rng = Seed::new(0).stream("touching links", 0);
    for _ in 0..POSTURES {
        let q: Vec<f64> = robot.joints().iter().map(|joint| place(joint, rng.random_range(0.0..1.0))).collect();
        scene.place(&q);
        let mut here = BTreeSet::new();
        for pair in 0..scene.pairs.len() {
            let Some(links) = scene.links(pair) else { continue };
            if !here.contains(&links) && scene.distance_within(pair, clearance) < clearance {
                here.insert(links);
            }
        }
        for links in here {
            *near.entry(links).or_default() += 1;
        }
    }
    let shares = near.into_iter().map(|(links, count)| TouchingLinks { links, share: count as f64 / POSTURES as f64 });
    shares.filter(|touching| touching.share >= SHARE).collect()
}

/// A coordinate at a part of a joint's range.
fn place(joint: &Joint, part: f64) -> f64 {
    let (low, high) = joint.limits.position;
    let (low, high) = match (low.is_finite() && high.is_finite(), joint.kind) {
        (true, _) => (low, high),
        (false, JointKind::Revolute) => (-PI, PI),
        (false, JointKind::Prismatic) => (-1.0, 1.0),
    };
    low + part * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::model::{Capsule, Shape, Solid};
    use nalgebra::Vector3;

    #[test]
    fn links_whose_shapes_always_meet_are_found_and_others_are_not() {
        let robot = chains::crs_a460();
        assert_eq!(touching_links(&robot, 0.0), []);
        // A ball around the elbow, in the frame of the upper arm's link and in that of the wrist's.
        let mut shapes = robot.shapes().to_vec();
        let elbow = Vector3::zeros();
        for (link, radius) in [(2, 0.5), (4, 0.5)] {
            shapes.push(Shape { link, solid: Solid::Capsule(Capsule { from: elbow, to: elbow, radius }) });
        }
        let coarse = robot.with_spec(|spec| (spec.shapes, spec.may_touch) = (shapes, Vec::new())).unwrap();
        let found = touching_links(&coarse, 0.0);
        assert!(found.iter().any(|touching| touching.links == (2, 4) && touching.share == 1.0), "{found:?}");
        let held = coarse.with_spec(|spec| spec.may_touch = found.iter().map(|t| t.links).collect()).unwrap();
        assert_eq!(touching_links(&held, 0.0), []);
    }
}
