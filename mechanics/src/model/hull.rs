//! A convex body around given points, made of a few of them and a rounding that reaches the others.
//!
//! ```text
//! body = conv(S) ⊕ ball(margin)        S ⊂ points        margin = max_p dist(p, conv S)
//! conv(points) ⊂ body, and no point of the body is further than the margin from conv(points)
//! ```
//! S grows by the point that is furthest from its hull, until that is within [`HULL_TOLERANCE`] or S has [`HULL_POINTS`]
//! points. A distance to the body is then never above that to the hull of all points, and below it by the margin at most.
//!
//! The corners next to a point are found by `parry3d` (E. G. Gilbert, D. W. Johnson, S. S. Keerthi, IEEE Journal of Robotics and
//! Automation 4(2), 1988); the distance is that from a point of their hull, so that rounding in flat hulls cannot make it too small.

use std::collections::BinaryHeap;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::gjk::{ConstantPoint, CsoPoint, VoronoiSimplex, closest_points};
use parry3d_f64::shape::SupportMap;

use super::capsule::Capsule;
use crate::spatial::Placement;

/// How far a body may reach beyond the points it stands for before another of them is taken, m.
pub const HULL_TOLERANCE: f64 = 5e-4;

/// Points of a body at most: a distance takes time in proportion to them.
pub const HULL_POINTS: usize = 64;

/// Sides of the prism of a cylinder, at least and at most.
const SIDES: (usize, usize) = (8, HULL_POINTS / 2);

/// Beyond this, m, a distance is not looked at more closely.
const FAR: f64 = 1e6;

/// A distance below this share of the simplex's size is that of a point inside.
const ROUNDING: f64 = 1e-14;

/// Every point within `margin` of the convex hull of some points.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::Hull;
/// use nalgebra::Vector3;
/// let corner = |k: usize| Vector3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
/// let mut points: Vec<Vector3<f64>> = (0..8).map(corner).collect();
/// points.push(Vector3::new(0.5, 0.2, 0.7));
/// let hull = Hull::enclosing(&points).unwrap();
/// assert_eq!((hull.points.len(), hull.margin), (8, 0.0));
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hull {
    /// The points, in the frame of the link, m.
    #[serde(with = "crate::plain::vector::list")]
    pub points: Vec<Vector3<f64>>,
    /// How far the body reaches beyond their hull, m.
    pub margin: f64,
}

impl Hull {
    /// A convex body around finite points (m); `None` without a point.
    pub fn enclosing(points: &[Vector3<f64>]) -> Option<Self> {
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
        points.dedup();
        let mean = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
        let mut first = points.first()?;
        for point in &points {
            if (point - mean).norm() > (first - mean).norm() {
                first = point;
            }
        }
        let mut chosen = vec![*first];
        // Distances from the hull so far only shrink as it grows: one that was found earlier is an upper bound.
        let mut open: BinaryHeap<Open> =
            points.iter().enumerate().map(|(point, p)| Open { distance: (p - first).norm(), point }).collect();
        let margin = loop {
            let Some(furthest) = furthest(&mut open, &points, &chosen) else { break 0.0 };
            if furthest.distance <= HULL_TOLERANCE || chosen.len() == HULL_POINTS {
                break furthest.distance;
            }
            chosen.push(points[furthest.point]);
        };
        Some(Self { points: chosen, margin })
    }

    /// A cylinder about the z axis of its own frame, as a prism whose edges lie on it:
    ///
    /// ```text
    /// margin = radius (1 − cos(π / sides))
    /// ```
    pub fn cylinder(placement: &Placement, radius: f64, half_length: f64) -> Self {
        let margin = |sides: usize| radius * (1.0 - libm::cos(std::f64::consts::PI / sides as f64));
        let sides = (SIDES.0..SIDES.1).find(|&sides| margin(sides) <= HULL_TOLERANCE).unwrap_or(SIDES.1);
        let corner = |k: usize, z: f64| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / sides as f64);
            placement.point(&Vector3::new(radius * cos, radius * sin, z))
        };
        let points = (0..sides).flat_map(|k| [corner(k, -half_length), corner(k, half_length)]).collect();
        Self { points, margin: margin(sides) }
    }

    /// The furthest that the body reaches along a unit vector, m.
    pub fn extent(&self, direction: &Vector3<f64>) -> f64 {
        self.points.iter().map(|p| direction.dot(p)).fold(f64::NEG_INFINITY, f64::max) + self.margin
    }

    /// Half the lengths of the box around the body, along the axes of the frame, m.
    pub fn half_box(&self) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| {
            let n = Vector3::ith(axis, 1.0);
            0.5 * (self.extent(&n) + self.extent(&-n))
        })
    }

    /// The middle of the box around the points, along the axes of the frame.
    pub fn middle(&self) -> Vector3<f64> {
        let along = |axis: usize| {
            let (low, high) = self
                .points
                .iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[axis]), high.max(p[axis])));
            0.5 * (low + high)
        };
        Vector3::new(along(0), along(1), along(2))
    }

    /// A capsule that holds the body: about the line through its middle along which its points scatter most.
    pub fn enclosing_capsule(&self) -> Capsule {
        let middle = self.middle();
        let scatter: Matrix3<f64> = self.points.iter().map(|p| (p - middle) * (p - middle).transpose()).sum();
        let found = SymmetricEigen::new(scatter);
        let axis: Vector3<f64> = found.eigenvectors.column(found.eigenvalues.imax()).into_owned();
        // Of each point the place along the line and the distance across.
        let place = |p: &Vector3<f64>| {
            let along = axis.dot(&(p - middle));
            (along, (p - middle - axis * along).norm())
        };
        let places: Vec<(f64, f64)> = self.points.iter().map(place).collect();
        let radius = places.iter().map(|place| place.1).fold(0.0, f64::max);
        // The round ends reach this much further where a point lies closer to the line.
        let rest = |across: f64| (radius * radius - across * across).max(0.0).sqrt();
        let end = places.iter().map(|&(along, across)| along - rest(across)).fold(f64::NEG_INFINITY, f64::max);
        let start = places.iter().map(|&(along, across)| along + rest(across)).fold(f64::INFINITY, f64::min);
        let (start, end) = if start <= end { (start, end) } else { (0.5 * (start + end), 0.5 * (start + end)) };
        Capsule { from: middle + axis * start, to: middle + axis * end, radius: radius + self.margin }
    }
}

/// A point of which an upper bound of the distance from the hull is known.
#[derive(Clone, Copy, PartialEq)]
struct Open {
    distance: f64,
    point: usize,
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.distance.total_cmp(&other.distance).then(other.point.cmp(&self.point))
    }
}

/// The point that is furthest from the hull of those chosen; `None` where all are in it.
fn furthest(open: &mut BinaryHeap<Open>, points: &[Vector3<f64>], chosen: &[Vector3<f64>]) -> Option<Open> {
    let hull = PointHull::new(chosen);
    while let Some(known) = open.pop() {
        let distance = hull.distance(&points[known.point]);
        let now = Open { distance, ..known };
        if open.peek().is_none_or(|next| now >= *next) {
            return (distance > 0.0).then_some(now);
        }
        if distance > 0.0 {
            open.push(now);
        }
    }
    None
}

/// The convex hull of some points as its support function: the furthest of them along a direction.
#[derive(Clone, Debug)]
pub struct PointHull(Vec<Vector>);

impl PointHull {
    /// The hull of `points`, m.
    pub fn new(points: &[Vector3<f64>]) -> Self {
        Self(points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect())
    }

    /// The distance of a point, m, and no less but for rounding; zero inside.
    fn distance(&self, point: &Vector3<f64>) -> f64 {
        let point = Vector::new(point.x, point.y, point.z);
        let mut simplex = VoronoiSimplex::new();
        simplex.reset(CsoPoint::from_shapes(&Pose::IDENTITY, self, &ConstantPoint(point), Vector::X));
        // What the iteration says of flat simplices may be false: only the corners that it ends with are taken.
        let _ = closest_points(&Pose::IDENTITY, self, &ConstantPoint(point), FAR, true, &mut simplex);
        let corners: Vec<Vector3<f64>> = (0..=simplex.dimension())
            .map(|k| simplex.point(k).point)
            .map(|corner| Vector3::new(corner.x, corner.y, corner.z))
            .collect();
        distance_of_origin(&corners)
    }
}

/// Distance of the origin from the hull of at most four points: the least over their faces, each by a point that is in it.
fn distance_of_origin(corners: &[Vector3<f64>]) -> f64 {
    let size = corners.iter().map(|corner| corner.norm()).fold(0.0, f64::max);
    let faces = 1..1_usize << corners.len();
    let distance = faces
        .filter_map(|face| {
            let mut of_face = (0..corners.len()).filter(|k| face >> k & 1 == 1).map(|k| corners[k]);
            let first = of_face.next()?;
            Some(point_of_face(first, &of_face.map(|corner| corner - first).collect::<Vec<_>>()).norm())
        })
        .fold(f64::INFINITY, f64::min);
    if distance <= ROUNDING * size { 0.0 } else { distance }
}

/// A point of the face with a corner `a` and edges `e` from it, the one nearest to the origin where that is inside:
///
/// ```text
/// a + Σ wᵢ eᵢ,   e w = −a,   then w ≥ 0 and Σ wᵢ ≤ 1 by cutting off and scaling
/// ```
fn point_of_face(a: Vector3<f64>, edges: &[Vector3<f64>]) -> Vector3<f64> {
    let weights = match *edges {
        [] => return a,
        [e] => Vector3::new(-a.dot(&e) / e.norm_squared(), 0.0, 0.0),
        // The part of a across the face is left over.
        [e, f] => solved(&Matrix3::from_columns(&[e, f, e.cross(&f)]), &a),
        [e, f, g, ..] => solved(&Matrix3::from_columns(&[e, f, g]), &a),
    };
    if weights.iter().any(|w| !w.is_finite()) {
        return a;
    }
    let mut weights = weights.map(|w| w.max(0.0));
    if edges.len() == 2 {
        weights.z = 0.0;
    }
    weights /= weights.sum().max(1.0);
    edges.iter().zip(weights.iter()).fold(a, |point, (edge, weight)| point + edge * *weight)
}

/// The solution of e w = −a; not a number where the face is flat.
fn solved(edges: &Matrix3<f64>, a: &Vector3<f64>) -> Vector3<f64> {
    edges.lu().solve(&-a).unwrap_or(Vector3::repeat(f64::NAN))
}

impl SupportMap for PointHull {
    fn local_support_point(&self, direction: Vector) -> Vector {
        let mut furthest = (f64::NEG_INFINITY, Vector::ZERO);
        for point in &self.0 {
            let along = point.dot(direction);
            if along > furthest.0 {
                furthest = (along, *point);
            }
        }
        furthest.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;
    use rand::{Rng, RngExt};

    fn direction(rng: &mut impl Rng) -> Vector3<f64> {
        loop {
            let x = Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
            if x.norm() > 0.1 && x.norm() < 1.0 {
                return x.normalize();
            }
        }
    }

    /// A convex body holds another where it reaches as far in every direction.
    #[test]
    fn identity_a_hull_holds_its_points_and_reaches_no_further_than_its_margin() {
        let mut rng = Seed::new(3).stream("hull", 0);
        for (count, stretch) in [(1, 1.0), (2, 1.0), (30, 1.0), (3000, 1.0), (2000, 6.0)] {
            // On an ellipsoid: every point is a corner.
            let points: Vec<Vector3<f64>> = (0..count)
                .map(|_| direction(&mut rng).component_mul(&Vector3::new(0.05, 0.06, 0.05 * stretch)))
                .collect();
            let hull = Hull::enclosing(&points).unwrap();
            assert!(hull.points.len() <= HULL_POINTS && hull.points.iter().all(|p| points.contains(p)));
            assert!(hull.margin <= HULL_TOLERANCE || hull.points.len() == HULL_POINTS, "{}", hull.margin);
            assert!(hull.margin < 0.012, "{}", hull.margin);
            let capsule = hull.enclosing_capsule();
            for _ in 0..2000 {
                let n = direction(&mut rng);
                let furthest = points.iter().map(|p| n.dot(p)).fold(f64::NEG_INFINITY, f64::max);
                assert!(furthest <= hull.extent(&n) + 1e-12 && hull.extent(&n) <= furthest + hull.margin + 1e-12);
                let around = n.dot(&capsule.from).max(n.dot(&capsule.to)) + capsule.radius;
                assert!(hull.extent(&n) <= around + 1e-12);
            }
        }
        assert_eq!(Hull::enclosing(&[]), None);
    }

    /// Points of nearly a line, and sizes from 1e-33 to 2 m: a point was once taken to be inside.
    #[test]
    fn regression_a_flat_hull_with_sizes_far_apart_holds_its_points() {
        let tiny = 1.65e-33;
        let mut rng = Seed::new(5).stream("hull", 0);
        let sizes = [0.0, tiny, 1.16e-19, 5e-10, 7.45e-9, 1.3e-4, 5.227e-4, -1.868, 0.3, 52.0, 1e3];
        for round in 0..20_000 {
            let count = 2 + round % 12;
            let mut coordinate = |_: usize, _: usize| sizes[rng.random_range(0..sizes.len())];
            let points: Vec<Vector3<f64>> = (0..count).map(|_| Vector3::from_fn(&mut coordinate)).collect();
            let hull = Hull::enclosing(&points).unwrap();
            for axis in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().flat_map(|axis| [axis, -axis]) {
                let furthest = points.iter().map(|p| axis.dot(p)).fold(f64::NEG_INFINITY, f64::max);
                assert!(furthest <= hull.extent(&axis) + 1e-11, "{points:?} {hull:?}");
            }
        }
    }

    #[test]
    fn analytic_a_prism_with_its_margin_holds_the_cylinder() {
        let placement = Placement::translation(0.1, -0.2, 0.3);
        for radius in [0.01, 0.06, 0.5] {
            let hull = Hull::cylinder(&placement, radius, 0.2);
            let mut rng = Seed::new(4).stream("hull", 0);
            for _ in 0..3000 {
                let n = direction(&mut rng);
                let exact = n.dot(&placement.translation) + radius * libm::hypot(n.x, n.y) + 0.2 * n.z.abs();
                assert!(exact <= hull.extent(&n) + 1e-15 && hull.extent(&n) <= exact + hull.margin + 1e-15);
            }
        }
        assert!(Hull::cylinder(&placement, 0.06, 0.2).margin < HULL_TOLERANCE);
    }

    #[test]
    fn analytic_a_flat_or_straight_set_of_points_has_a_hull() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.3, 0.4]];
        let square: Vec<Vector3<f64>> = square.iter().map(|[x, y]| Vector3::new(*x, *y, 0.7)).collect();
        let hull = Hull::enclosing(&square).unwrap();
        assert_eq!((hull.points.len(), hull.margin), (4, 0.0));
        let line: Vec<Vector3<f64>> = (0..9).map(|k| Vector3::new(0.1 * f64::from(k), 0.0, 0.0)).collect();
        let hull = Hull::enclosing(&line).unwrap();
        assert!(hull.points.len() <= 3 && hull.margin < 1e-15, "{hull:?}");
        let rod = hull.enclosing_capsule();
        assert!((rod.to - rod.from).norm() <= 0.8 + 1e-12 && rod.radius < 1e-12);
    }
}
