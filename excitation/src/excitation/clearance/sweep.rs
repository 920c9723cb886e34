//! The smallest clearance over a whole motion, bounded between samples.

use super::scene::Scene;
use crate::trajectory::Trajectory;

/// How far the certified clearance may lie below the true one, m.
pub const CLEARANCE_TOLERANCE: f64 = 1e-4;

/// Halvings after which a segment of time counts by its bound, which is then below the distance by more than the
/// tolerance: 2⁻²⁰ of a sample is below a microsecond, in which no arm moves that far.
const DEEPEST: u32 = 20;

/// Where two bodies come nearest.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct WorstClearance {
    /// A distance that is never undercut, at most [`CLEARANCE_TOLERANCE`] below the true smallest one, m; further below
    /// where joints move that far within 2⁻²⁰ of a sample.
    pub distance_m: f64,
    /// What comes near to what: links by their joints, obstacles by their names.
    pub pair: [String; 2],
    /// When, s.
    pub t: f64,
}

/// A pair during a segment of time about its middle.
struct Segment {
    pair: usize,
    middle: f64,
    half: f64,
    /// The distance is never below this here.
    at_least: f64,
    depth: u32,
}

/// The smallest clearance over one period of a motion, from a grid of `samples` that is refined until the bound
/// between samples meets the value; `None` where no two bodies can meet.
///
/// `acceleration` bounds the acceleration of each joint over the period, rad/s² (n).
pub fn smallest_clearance(
    scene: &mut Scene,
    motion: &dyn Trajectory,
    acceleration: &[f64],
    samples: usize,
) -> Option<WorstClearance> {
    if scene.pairs.is_empty() {
        return None;
    }
    let mut look = Look {
        scene,
        motion,
        acceleration,
        q: vec![0.0; motion.dof()],
        qd: vec![0.0; motion.dof()],
        qdd: vec![0.0; motion.dof()],
        moved: vec![0.0; motion.dof()],
    };
    let half = 0.5 * motion.period_s() / samples as f64;
    let mut nearest = (f64::INFINITY, 0, 0.0);
    let mut open = Vec::new();
    for k in 0..samples {
        let middle = (2 * k + 1) as f64 * half;
        look.go(middle, half);
        for pair in 0..look.scene.pairs.len() {
            let closing = look.scene.closing(pair, &look.moved);
            let distance = look.scene.distance_within(pair, nearest.0 + closing);
            if distance < nearest.0 {
                nearest = (distance, pair, middle);
            }
            open.push(Segment { pair, middle, half, at_least: distance - closing, depth: 0 });
        }
    }
    // A lower bound by balls may have stood for a distance above; it is never the smallest, since it is refined.
    open.retain(|segment| segment.at_least < nearest.0 - CLEARANCE_TOLERANCE);
    open.sort_by(|x, y| y.at_least.total_cmp(&x.at_least));
    while let Some(segment) = open.pop() {
        if segment.at_least >= nearest.0 - CLEARANCE_TOLERANCE {
            continue;
        }
        let half = 0.5 * segment.half;
        for middle in [segment.middle - half, segment.middle + half] {
            look.go(middle, half);
            let distance = look.scene.separation(segment.pair).distance;
            if distance < nearest.0 {
                nearest = (distance, segment.pair, middle);
            }
            let at_least = distance - look.scene.closing(segment.pair, &look.moved);
            if at_least < nearest.0 - CLEARANCE_TOLERANCE {
                if segment.depth < DEEPEST {
                    open.push(Segment { pair: segment.pair, middle, half, at_least, depth: segment.depth + 1 });
                } else {
                    nearest = (at_least + CLEARANCE_TOLERANCE, segment.pair, middle);
                }
            }
        }
    }
    let (distance, pair, t) = nearest;
    Some(WorstClearance { distance_m: distance - CLEARANCE_TOLERANCE, pair: scene.pair_names(pair), t })
}

/// The robot at one time, and how far its joints can move around it.
struct Look<'a> {
    scene: &'a mut Scene,
    motion: &'a dyn Trajectory,
    acceleration: &'a [f64],
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    moved: Vec<f64>,
}

impl Look<'_> {
    fn go(&mut self, t: f64, half: f64) {
        self.motion.evaluate(t, &mut self.q, &mut self.qd, &mut self.qdd);
        self.scene.place(&self.q);
        for ((moved, qd), acceleration) in self.moved.iter_mut().zip(&self.qd).zip(self.acceleration) {
            *moved = half * (qd.abs() + 0.5 * half * acceleration);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::excitation::radkhah2007_start;
    use crate::seed::Seed;

    #[test]
    fn identity_no_sample_is_nearer_than_the_sweep_says() {
        let robot = chains::crs_a460();
        let mut scene = Scene::new(&robot);
        for index in 0..4 {
            let motion = radkhah2007_start(&robot, 10.0, 5, Seed::new(9), index).unwrap();
            let found = smallest_clearance(&mut scene, &motion, &[12.566; 6], 500).unwrap();
            let states = motion.sample(20_011);
            let mut least = f64::INFINITY;
            for k in 0..states.len() {
                scene.place(states.q(k));
                for pair in 0..scene.pairs.len() {
                    least = least.min(scene.separation(pair).distance);
                }
            }
            // Half a millisecond at 3 m/s is 0.8 mm, and next to a minimum much less.
            assert!(found.distance_m <= least && least - found.distance_m < 3e-4, "{found:?} {least}");
        }
    }
}
