//! Which values of a base parameter no real arm of this shape can have: `radkhah2007`'s "values that are not reasonable",
//! made a test.
//!
//! ```text
//! link k is a mass distribution ρ ≥ 0 inside its shape, of total mass at most m_max
//! β_b = Σ_k ∫ f_bk(x) ρ_k(x) dx       f_bk(x) = c₀ + gᵀx + xᵀQx, from row b of K and the ten of a unit point mass at x
//! range of β_b = [ Σ_k m_max min(0, min f_bk),  Σ_k m_max max(0, max f_bk) ]
//! ```
//! The extremes of a linear functional over such distributions are point masses, so the range is exact once each
//! quadratic is maximised over the link's capsules. An estimate outside the range is invalid. A value inside may still
//! be wrong: parameters are tested one at a time. Rotor inertia and friction are only bounded below, by zero; offsets
//! not at all.

use crate::model::term::Sign;
use nalgebra::{Matrix3, Vector3};

use crate::base::BaseReduction;
use crate::model::{Capsule, Robot};
use crate::statistics::Interval;

/// Steps of an ascent at most; the A460's come to rest within 150.
const ASCENT_STEPS: usize = 2000;

/// Length of a step that counts as rest, m.
const AT_REST: f64 = 1e-12;

/// The interval of values of every base parameter that links of at most `max_mass` kg inside their shapes can have.
///
/// A link without a shape of its own takes those of its neighbours nearest to the base.
pub fn feasible_ranges(robot: &Robot, base: &BaseReduction, max_mass: f64) -> Vec<Interval> {
    let shapes: Vec<Vec<Capsule>> = (0..robot.dof()).map(|link| shapes_of(robot, link)).collect();
    (0..base.rank())
        .map(|row| {
            let mut range = Interval { low: 0.0, high: 0.0 };
            for (link, capsules) in shapes.iter().enumerate() {
                let mut ten = [0.0; 10];
                for (column, id) in base.parameters.iter().enumerate() {
                    let k = base.k[(row, column)];
                    if id.index != link || k == 0.0 {
                        continue;
                    }
                    match (id.kind.link_place(), id.kind.term().map(|term| term.entry().sign)) {
                        (Some(place), _) => ten[place] = k,
                        (None, Some(Sign::NotNegative)) if k > 0.0 => range.high = f64::INFINITY,
                        (None, Some(Sign::NotNegative)) => range.low = f64::NEG_INFINITY,
                        (None, Some(Sign::Any) | None) => {
                            range = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
                        }
                    }
                }
                let unit_mass = Quadratic::of_point_mass(&ten);
                range.high += max_mass * unit_mass.maximum(capsules).max(0.0);
                range.low -= max_mass * unit_mass.negated().maximum(capsules).max(0.0);
            }
            range
        })
        .collect()
}

/// The capsules of one link in its own frame; borrowed from the nearest link towards the base that has any, seen at
/// the zero position, where it has none.
fn shapes_of(robot: &Robot, link: usize) -> Vec<Capsule> {
    let poses = robot.poses(&vec![0.0; robot.dof()]);
    for owner in (0..=link).rev() {
        let own = robot.shapes().iter().filter(|shape| shape.link == owner + 1);
        let own: Vec<Capsule> = own.map(|shape| shape.solid.enclosing_capsule()).collect();
        if !own.is_empty() {
            let from_owner = poses[link].inverse().compose(&poses[owner]);
            return own
                .into_iter()
                .map(|c| Capsule { from: from_owner.point(&c.from), to: from_owner.point(&c.to), radius: c.radius })
                .collect();
        }
    }
    Vec::new()
}

/// `c₀ + gᵀx + xᵀQx`.
struct Quadratic {
    constant: f64,
    linear: Vector3<f64>,
    square: Matrix3<f64>,
}

impl Quadratic {
    /// Value of `Σ c_p φ_p` for a unit point mass at x: its ten are 1, x, y, z, y²+z², −xy, −xz, x²+z², −yz, x²+y².
    fn of_point_mass(c: &[f64; 10]) -> Self {
        let (xx, yy, zz) = (c[4], c[7], c[9]);
        let [xy, xz, yz] = [c[5], c[6], c[8]].map(|product| -0.5 * product);
        Self {
            constant: c[0],
            linear: Vector3::new(c[1], c[2], c[3]),
            square: Matrix3::new(yy + zz, xy, xz, xy, xx + zz, yz, xz, yz, xx + yy),
        }
    }

    fn negated(&self) -> Self {
        Self { constant: -self.constant, linear: -self.linear, square: -self.square }
    }

    fn at(&self, x: &Vector3<f64>) -> f64 {
        self.constant + self.linear.dot(x) + x.dot(&(self.square * x))
    }

    /// The largest value over the capsules: projected gradient ascent from points spread over ends, middles and
    /// surfaces. A quadratic on a ball has at most two local maxima that are not global (Martínez 1994), so the spread
    /// of starts finds the global one. Infinite where an ascent does not come to rest: a maximum that was not reached
    /// rules no value out.
    fn maximum(&self, capsules: &[Capsule]) -> f64 {
        let mut best = f64::NEG_INFINITY;
        for capsule in capsules {
            for start in starts(capsule) {
                let top = self.ascent(start, capsule).map_or(f64::INFINITY, |top| self.at(&top));
                best = best.max(top).max(self.at(&start));
            }
        }
        best
    }

    /// Where a projected gradient ascent comes to rest; `None` if it does not in [`ASCENT_STEPS`].
    fn ascent(&self, start: Vector3<f64>, capsule: &Capsule) -> Option<Vector3<f64>> {
        let step = 0.5 / (self.square.norm() + self.linear.norm() + f64::MIN_POSITIVE);
        let mut x = start;
        for _ in 0..ASCENT_STEPS {
            let gradient = self.linear + self.square * x * 2.0;
            let next = project(&(x + gradient * step), capsule);
            let moved = (next - x).norm();
            x = next;
            if moved < AT_REST {
                return Some(x);
            }
        }
        None
    }
}

fn starts(capsule: &Capsule) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let axis = capsule.to - capsule.from;
    [0.0, 0.5, 1.0].into_iter().flat_map(move |s| {
        (0..27).map(move |corner| {
            let direction =
                Vector3::new(f64::from(corner % 3 - 1), f64::from(corner / 3 % 3 - 1), f64::from(corner / 9 - 1));
            let length = direction.norm();
            let offset = if length > 0.0 { direction * (capsule.radius / length) } else { direction };
            project(&(capsule.from + axis * s + offset), capsule)
        })
    })
}

/// The point of a capsule nearest to `x`.
fn project(x: &Vector3<f64>, capsule: &Capsule) -> Vector3<f64> {
    let axis = capsule.to - capsule.from;
    let length_squared = axis.norm_squared();
    let s = if length_squared > 0.0 { ((x - capsule.from).dot(&axis) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    let spine = capsule.from + axis * s;
    let away = x - spine;
    let distance = away.norm();
    if distance <= capsule.radius { *x } else { spine + away * (capsule.radius / distance) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Method, reduce};
    use crate::conformance::chains::crs_a460;
    use crate::model::{Columns, StandardParameters};
    use crate::seed::Seed;
    use crate::spatial::PseudoInertia;
    use rand::RngExt;

    #[test]
    fn analytic_extremes_over_a_ball_and_a_capsule() {
        let ball = Capsule { from: Vector3::zeros(), to: Vector3::zeros(), radius: 2.0 };
        // Mass: 1 everywhere. First moment x: the radius. Izz = x² + y²: the radius squared.
        let of = |index: usize| {
            let mut c = [0.0; 10];
            c[index] = 1.0;
            Quadratic::of_point_mass(&c)
        };
        assert!((of(0).maximum(&[ball]) - 1.0).abs() < 1e-12);
        assert!((of(1).maximum(&[ball]) - 2.0).abs() < 1e-9);
        assert!((of(9).maximum(&[ball]) - 4.0).abs() < 1e-9);
        // Ixy = −∫ x y ρ: its largest value on the ball is r²/2, at x = −y.
        assert!((of(5).maximum(&[ball]) - 2.0).abs() < 1e-9);
        // Iyz = −∫ y z ρ likewise.
        assert!((of(8).maximum(&[ball]) - 2.0).abs() < 1e-9);
        // (d·x)² + d·x is largest at 2 d, which no start is near.
        let d = Vector3::new(1.0, 2.0, 3.0).normalize();
        let off_axis = Quadratic { constant: 0.0, linear: d, square: d * d.transpose() };
        assert!((off_axis.maximum(&[ball]) - 6.0).abs() < 1e-6);
        // Starts lie on all sides: their mean is the centre.
        assert!(starts(&ball).sum::<Vector3<f64>>().norm() < 1e-12);
        let rod = Capsule { from: Vector3::zeros(), to: Vector3::new(3.0, 0.0, 0.0), radius: 0.5 };
        assert!((of(1).maximum(&[rod]) - 3.5).abs() < 1e-9);
        assert!((of(1).negated().maximum(&[rod]) - 0.5).abs() < 1e-9);
        // Izz = x² + y² is largest at the far end: (3.5)².
        assert!((of(9).maximum(&[rod]) - 12.25).abs() < 1e-8);
    }

    #[test]
    fn an_ascent_that_does_not_come_to_rest_rules_nothing_out() {
        let ball = Capsule { from: Vector3::zeros(), to: Vector3::zeros(), radius: 1.0 };
        let broken = Quadratic { constant: 0.0, linear: Vector3::repeat(f64::NAN), square: Matrix3::zeros() };
        assert_eq!(broken.maximum(&[ball]), f64::INFINITY);
    }

    #[test]
    fn identity_ranges_of_the_a460_are_finite_but_for_friction_offsets_and_rotors() {
        let robot = crs_a460();
        let base = reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0)).unwrap();
        let ranges = feasible_ranges(&robot, &base, 30.0);
        assert!(ranges.iter().all(|range| range.low.is_finite() && range.high.is_finite() && range.low <= 0.0));
        // By another route: point masses of 30 kg all over the shape of each link, the largest value of each added over links.
        let mut rng = Seed::new(1).stream("points", 0);
        let mut found = vec![Interval { low: 0.0, high: 0.0 }; base.rank()];
        for link in 0..robot.dof() {
            let mut of_link = vec![Interval { low: 0.0, high: 0.0 }; base.rank()];
            for capsule in shapes_of(&robot, link) {
                for _ in 0..2000 {
                    let x = capsule.from + (capsule.to - capsule.from) * rng.random_range(-1.0..2.0);
                    let x = project(&(x + Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0))), &capsule);
                    let mut arm = StandardParameters::zero(robot.dof());
                    arm.links[link] = PseudoInertia(x.push(1.0) * x.push(1.0).transpose() * 30.0).inertia();
                    let beta = base.beta(&arm.vector(&robot, Columns::RIGID));
                    for (range, value) in of_link.iter_mut().zip(&beta) {
                        *range = Interval { low: range.low.min(*value), high: range.high.max(*value) };
                    }
                }
            }
            for (sum, range) in found.iter_mut().zip(&of_link) {
                *sum = Interval { low: sum.low + range.low, high: sum.high + range.high };
            }
        }
        for (range, found) in ranges.iter().zip(&found) {
            let (width, reached) = (range.high - range.low, found.high - found.low);
            assert!(range.low <= found.low + 1e-9 && found.high <= range.high + 1e-9, "{range:?} {found:?}");
            assert!(reached > 0.9 * width, "{range:?} {found:?}");
        }
        // What is never negative has no upper end, an offset has none at all.
        let base = reduce(&robot, Columns::default(), Method::Structural, Seed::new(0)).unwrap();
        for (row, range) in feasible_ranges(&robot, &base, 30.0).iter().enumerate() {
            let kind = base.parameters[base.kept[row]].kind;
            let (has_low, has_high) = (range.low.is_finite(), range.high.is_finite());
            match kind.term().map(|term| term.entry().sign) {
                Some(Sign::NotNegative) => assert!(has_low && !has_high, "{kind:?}: {range:?}"),
                Some(Sign::Any) => assert!(!has_low && !has_high, "{kind:?}: {range:?}"),
                None => {}
            }
        }
    }
}
