//! The robot among what stands around it: which pairs of bodies can meet, where they are, and how their distance
//! changes with the joints.

use nalgebra::Vector3;

use super::body::{Placed, Separation};
use crate::dynamics::LinkPose;
use crate::model::{Joint, JointKind, Obstacle, Robot, Solid};
use crate::spatial::Placement;

/// What the second body of a pair may meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Partner {
    /// A body of the robot.
    Body(usize),
    /// Something that stands still.
    Still(usize),
}

/// Two bodies that can meet; the second one belongs to a link further out.
#[derive(Clone, Debug)]
pub struct Pair {
    first: Partner,
    second: usize,
    /// Joints that move the second body against the first: `from .. to`, counted from zero.
    from: usize,
    to: usize,
    /// For each of them the largest distance of a point of the second body from the joint's axis, m (1 for a
    /// prismatic one).
    reach: Vec<f64>,
}

/// The bodies of a robot and of its surroundings.
#[derive(Clone, Debug)]
pub struct Scene {
    joints: Vec<Joint>,
    /// The joints' moving poses, up to the last link with a body.
    moving: Vec<LinkPose>,
    /// Link and shape of each body of the robot.
    bodies: Vec<(usize, Solid)>,
    obstacles: Vec<Obstacle>,
    /// The pairs that can meet.
    pub pairs: Vec<Pair>,
    /// Pose of the base and of every link, at the last configuration.
    poses: Vec<Placement>,
    placed: Vec<Placed>,
}

impl Scene {
    /// The bodies of `robot` and of its surroundings, and the pairs that can meet.
    ///
    /// Two links are left out where no link between them has a shape, since their shapes meet in a joint, and where the
    /// robot says that they may touch.
    pub fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        let bodies: Vec<(usize, Solid)> =
            robot.shapes().iter().map(|shape| (shape.link, shape.solid.clone())).collect();
        let mut bearing: Vec<usize> = bodies.iter().map(|body| body.0).collect();
        bearing.sort_unstable();
        bearing.dedup();
        let rank = |link: usize| bearing.iter().position(|&other| other == link).unwrap_or(0);
        let mut scene = Self {
            joints: robot.joints().to_vec(),
            moving: robot.joints().iter().take(bearing.last().map_or(0, |last| *last)).map(LinkPose::new).collect(),
            obstacles: robot.obstacles().to_vec(),
            pairs: Vec::new(),
            poses: vec![Placement::identity(); n + 1],
            placed: bodies.iter().map(|(_, solid)| Placed::new(solid, &Placement::identity())).collect(),
            bodies,
        };
        for second in 0..scene.bodies.len() {
            let outer = scene.bodies[second].0;
            for first in 0..scene.bodies.len() {
                let inner = scene.bodies[first].0;
                let follow = outer <= inner || rank(outer) - rank(inner) < 2;
                if !follow && !robot.may_touch().contains(&(inner, outer)) {
                    scene.add_pair(Partner::Body(first), second, inner);
                }
            }
            if outer > 0 {
                for obstacle in 0..scene.obstacles.len() {
                    scene.add_pair(Partner::Still(obstacle), second, 0);
                }
            }
        }
        scene
    }

    fn add_pair(&mut self, first: Partner, second: usize, from: usize) {
        let (to, solid) = (self.bodies[second].0, &self.bodies[second].1);
        let reach = (from..to).map(|joint| self.reach(joint, to, solid)).collect();
        self.pairs.push(Pair { first, second, from, to, reach });
    }

    /// How far a point of a body of link `to` can be from the axis of a joint, for any motion of the joints between.
    fn reach(&self, joint: usize, to: usize, solid: &Solid) -> f64 {
        if self.joints[joint].kind == JointKind::Prismatic {
            return 1.0;
        }
        let own = &self.joints[joint].after.translation;
        let mut reach = libm::hypot(own.x, own.y) + solid.reach();
        if to > joint + 1 {
            // What lies along the axis can turn away from it behind the next joint.
            reach += own.norm() - libm::hypot(own.x, own.y);
        }
        for between in &self.joints[joint + 1..to] {
            let (low, high) = between.limits.position;
            let travel = if between.kind == JointKind::Prismatic { low.abs().max(high.abs()) } else { 0.0 };
            reach += between.before.translation.norm() + between.after.translation.norm() + travel;
        }
        reach
    }

    /// The links of a pair of the robot's bodies, the inner one first; `None` where one of the two stands around.
    pub fn links(&self, pair: usize) -> Option<(usize, usize)> {
        let Pair { first, second, .. } = &self.pairs[pair];
        match first {
            Partner::Body(body) => Some((self.bodies[*body].0, self.bodies[*second].0)),
            Partner::Still(_) => None,
        }
    }

    /// What the two bodies of a pair are called: links by their joints, obstacles by their names.
    pub fn pair_names(&self, pair: usize) -> [String; 2] {
        let Pair { first, second, .. } = &self.pairs[pair];
        let link = |body: usize| match self.bodies[body].0 {
            0 => "base",
            link => &self.joints[link - 1].name,
        };
        let first = match first {
            Partner::Body(body) => link(*body),
            Partner::Still(obstacle) => self.obstacles[*obstacle].name(),
        };
        [first, link(*second)].map(str::to_owned)
    }

    /// Moves the robot to the joint coordinates `q` (n).
    pub fn place(&mut self, q: &[f64]) {
        for (i, (moving, &q)) in self.moving.iter().zip(q).enumerate() {
            self.poses[i + 1] = self.poses[i].compose(&moving.placement(q));
        }
        for (placed, (link, solid)) in self.placed.iter_mut().zip(&self.bodies) {
            if *link > 0 {
                placed.moved(solid, &self.poses[*link]);
            }
        }
    }

    /// The distance of a pair where the robot was last placed.
    pub fn separation(&self, pair: usize) -> Separation {
        let Pair { first, second, .. } = &self.pairs[pair];
        let second = &self.placed[*second];
        match first {
            Partner::Body(body) => self.placed[*body].separation(second),
            Partner::Still(obstacle) => match &self.obstacles[*obstacle] {
                Obstacle::Floor { z } => second.above(&Vector3::z(), *z),
                Obstacle::Plane { normal, offset, .. } => second.above(normal, *offset),
                Obstacle::Body { solid, .. } => Placed::new(solid, &Placement::identity()).separation(second),
            },
        }
    }

    /// The distance of a pair, or a lower bound of it where that alone is beyond `near`.
    pub(super) fn distance_within(&self, pair: usize, near: f64) -> f64 {
        if let Pair { first: Partner::Body(body), second, .. } = &self.pairs[pair] {
            let bound = self.placed[*body].at_least(&self.placed[*second], near);
            if bound > near {
                return bound;
            }
        }
        self.separation(pair).distance
    }

    /// `∂d/∂q` of a pair (n) where the robot was last placed: `n · (z_j × (p − o_j))`, or `n · z_j` for a prismatic
    /// joint.
    pub fn slopes(&self, pair: usize, separation: &Separation, slopes: &mut [f64]) {
        slopes.fill(0.0);
        let Pair { from, to, .. } = self.pairs[pair];
        for j in from..to {
            let (before, inner) = (&self.joints[j].before, &self.poses[j]);
            let axis = inner.rotation * before.rotation.column(2);
            let origin = inner.point(&before.translation);
            slopes[j] = match self.joints[j].kind {
                JointKind::Revolute => separation.normal.dot(&axis.cross(&(separation.point - origin))),
                JointKind::Prismatic => separation.normal.dot(&axis),
            };
        }
    }

    /// The most by which the distance of a pair can shrink while each joint moves by up to `moved` (n).
    pub fn closing(&self, pair: usize, moved: &[f64]) -> f64 {
        let Pair { from, to, reach, .. } = &self.pairs[pair];
        reach.iter().zip(&moved[*from..*to]).map(|(reach, moved)| reach * moved).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains;
    use crate::model::{Capsule, Cuboid, Obstacle};
    use crate::seed::Seed;
    use nalgebra::Vector3;
    use rand::RngExt;

    fn furnished() -> Robot {
        let placement = Placement::translation(0.5, 0.1, 0.6);
        let half = Vector3::new(0.1, 0.2, 0.3);
        let post = Capsule { from: Vector3::new(-0.6, 0.0, 0.0), to: Vector3::new(-0.6, 0.0, 1.0), radius: 0.05 };
        chains::crs_a460()
            .with_obstacle(Obstacle::Body { name: "box".into(), solid: Solid::Cuboid(Cuboid { placement, half }) })
            .with_obstacle(Obstacle::Body { name: "post".into(), solid: Solid::Capsule(post) })
            .with_obstacle(Obstacle::Plane { name: "wall".into(), normal: -Vector3::y(), offset: -0.6 })
    }

    #[test]
    fn analytic_pairs_of_the_a460() {
        let scene = Scene::new(&chains::crs_a460());
        let names: Vec<String> = (0..scene.pairs.len()).map(|pair| scene.pair_names(pair).join(" ")).collect();
        assert_eq!(
            names,
            ["floor shoulder", "base elbow", "floor elbow", "base tool_roll", "shoulder tool_roll", "floor tool_roll"]
        );
        // Straight up, the flange is at 1.0414 m and the hand's capsule begins at the wrist, 0.9652 m, radius 0.04.
        let mut scene = scene;
        scene.place(&[0.0; 6]);
        assert!((scene.separation(5).distance - (0.9652 - 0.04)).abs() < 1e-12);
        // The upper arm ends at the elbow, 0.635 m: 0.3302 m below the wrist.
        assert!((scene.separation(4).distance - (0.3302 - 0.04 - 0.075)).abs() < 1e-12);
    }

    #[test]
    fn identity_slopes_are_differences_of_distances() {
        let mut scene = Scene::new(&furnished());
        let mut rng = Seed::new(6).stream("postures", 0);
        let (mut checked, mut slopes) = (0, [0.0; 6]);
        for _ in 0..40 {
            let q: Vec<f64> = (0..6).map(|_| rng.random_range(-1.6..1.6)).collect();
            for pair in 0..scene.pairs.len() {
                scene.place(&q);
                let here = scene.separation(pair);
                scene.slopes(pair, &here, &mut slopes);
                for j in 0..6 {
                    let mut at = |h: f64| {
                        let mut moved = q.clone();
                        moved[j] += h;
                        scene.place(&moved);
                        scene.separation(pair)
                    };
                    let (after, before) = (at(1e-5), at(-1e-5));
                    // Where the nearest point jumps from one end to the other there is no derivative.
                    if (after.normal - before.normal).norm() > 1e-3 || (after.point - before.point).norm() > 1e-3 {
                        continue;
                    }
                    let difference = (after.distance - before.distance) / 2e-5;
                    // Distances to a box come from an iteration that stops at 1e-10 or so.
                    assert!(
                        (difference - slopes[j]).abs() < 2e-5,
                        "{:?} {j}: {difference} {slopes:?}",
                        scene.pair_names(pair)
                    );
                    checked += 1;
                }
            }
        }
        assert!(checked > 2000, "{checked}");
    }

    #[test]
    fn identity_distances_shrink_by_no_more_than_the_bound() {
        let mut scene = Scene::new(&furnished());
        let mut rng = Seed::new(7).stream("moves", 0);
        for _ in 0..300 {
            let q: Vec<f64> = (0..6).map(|_| rng.random_range(-2.0..2.0)).collect();
            let moved: Vec<f64> = (0..6).map(|_| rng.random_range(0.0..0.3)).collect();
            let there: Vec<f64> = q.iter().zip(&moved).map(|(q, m)| q + rng.random_range(-1.0..1.0) * m).collect();
            for pair in 0..scene.pairs.len() {
                scene.place(&q);
                let (here, closing) = (scene.separation(pair).distance, scene.closing(pair, &moved));
                scene.place(&there);
                assert!(scene.separation(pair).distance >= here - closing - 1e-9);
            }
        }
    }
}
