//! What the shape of a link says about how its mass is distributed.
//!
//! ```text
//! tr(Q P) = ∫ xᵀ Q x dm ≥ 0        x = (position, 1), Q with xᵀ Q x ≥ 0 in the whole body
//! slab between two planes   (n·x − a)(b − n·x) ≥ 0        cylinder   R² − |x − p|² + (e·(x − p))² ≥ 0
//! ```
//! A box gives the slabs of its faces, a capsule the cylinder around it and the slab of its ends, a hull or several bodies of one link
//! the slabs of the box around them along the axes of the link. These are necessary: that a distribution inside the body exists is not shown.
//!
//! Reference: P. M. Wensing, S. Kim, J.-J. E. Slotine, "Linear matrix inequalities for physically consistent inertial parameter
//! identification: a statistical perspective on the mass distribution", IEEE Robotics and Automation Letters 3(1), 2018, section V.

use nalgebra::{Matrix4, Vector3, Vector4};

use crate::model::{Capsule, Cuboid, Robot, Solid};

/// The bounds of each link, from zero; links without a shape have none.
#[derive(Clone, Debug, Default)]
pub(in crate::estimation) struct ShapeBounds {
    links: Vec<Vec<Matrix4<f64>>>,
    /// A ball inside each shape: centre and radius.
    balls: Vec<Option<(Vector3<f64>, f64)>>,
}

impl ShapeBounds {
    /// The bounds by the shapes of a robot.
    pub(in crate::estimation) fn of(robot: &Robot) -> Self {
        let of_link = |link: usize| {
            let solids: Vec<&Solid> =
                robot.shapes().iter().filter(|shape| shape.link == link).map(|shape| &shape.solid).collect();
            match solids.as_slice() {
                [] => Vec::new(),
                [Solid::Capsule(capsule)] => around_capsule(capsule),
                [Solid::Cuboid(cuboid)] => around_box(cuboid),
                several => around_all(several),
            }
        };
        let ball = |link: usize| {
            robot.shapes().iter().find(|shape| shape.link == link).map(|shape| match &shape.solid {
                Solid::Capsule(Capsule { from, to, radius }) => ((from + to) * 0.5, *radius),
                Solid::Cuboid(Cuboid { placement, half }) => (placement.translation, half.min()),
                // Inside the box that its bounds are.
                Solid::Hull(hull) => (hull.middle(), hull.half_box().min()),
            })
        };
        let links = 1..=robot.dof();
        Self { links: links.clone().map(of_link).collect(), balls: links.map(ball).collect() }
    }

    /// Centre and radius (m) of a ball inside the shape of a link, from zero.
    pub(in crate::estimation) fn ball(&self, link: usize) -> Option<(Vector3<f64>, f64)> {
        self.balls.get(link).copied().flatten()
    }

    /// Q of each bound of a link, from zero.
    pub(super) fn of_link(&self, link: usize) -> &[Matrix4<f64>] {
        self.links.get(link).map_or(&[], Vec::as_slice)
    }
}

/// `(n·x − low)(high − n·x)`.
fn slab(n: &Vector3<f64>, low: f64, high: f64) -> Matrix4<f64> {
    let from = Vector4::new(n.x, n.y, n.z, -low);
    let to = Vector4::new(-n.x, -n.y, -n.z, high);
    (from * to.transpose() + to * from.transpose()) * 0.5
}

fn around_capsule(capsule: &Capsule) -> Vec<Matrix4<f64>> {
    let (along, length) = {
        let way = capsule.to - capsule.from;
        (way.try_normalize(0.0), way.norm())
    };
    let square = capsule.radius * capsule.radius;
    // |x − p|² as a quadratic form, and the square of the distance along the axis.
    let p = capsule.from;
    let mut around = -Matrix4::identity();
    around.fixed_view_mut::<3, 1>(0, 3).copy_from(&p);
    around.fixed_view_mut::<1, 3>(3, 0).copy_from(&p.transpose());
    around[(3, 3)] = square - p.norm_squared();
    let Some(e) = along else { return vec![around] };
    let ahead = Vector4::new(e.x, e.y, e.z, -e.dot(&p));
    let start = e.dot(&p);
    vec![around + ahead * ahead.transpose(), slab(&e, start - capsule.radius, start + length + capsule.radius)]
}

fn around_box(cuboid: &Cuboid) -> Vec<Matrix4<f64>> {
    let of = |axis: usize| {
        let n = cuboid.placement.rotation.column(axis).into_owned();
        let centre = n.dot(&cuboid.placement.translation);
        slab(&n, centre - cuboid.half[axis], centre + cuboid.half[axis])
    };
    (0..3).map(of).collect()
}

fn around_all(solids: &[&Solid]) -> Vec<Matrix4<f64>> {
    let of = |axis: usize| {
        let n = Vector3::ith(axis, 1.0);
        let low = solids.iter().map(|solid| -solid.extent(&-n)).fold(f64::INFINITY, f64::min);
        let high = solids.iter().map(|solid| solid.extent(&n)).fold(f64::NEG_INFINITY, f64::max);
        slab(&n, low, high)
    };
    (0..3).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::Placement;

    /// `xᵀ Q x` of the bounds at a point.
    fn at(bounds: &[Matrix4<f64>], x: [f64; 3]) -> Vec<f64> {
        let x = Vector4::new(x[0], x[1], x[2], 1.0);
        bounds.iter().map(|q| (x.transpose() * q * x)[0]).collect()
    }

    #[test]
    fn analytic_forms_are_positive_inside_zero_on_the_surface_negative_outside() {
        let capsule = Capsule { from: Vector3::new(0.1, 0.2, 0.3), to: Vector3::new(0.1, 0.2, 0.8), radius: 0.05 };
        let bounds = around_capsule(&capsule);
        assert!(at(&bounds, [0.1, 0.23, 0.5]).iter().all(|&value| value > 0.0));
        assert!(at(&bounds, [0.15, 0.2, 0.5])[0].abs() < 1e-15 && at(&bounds, [0.16, 0.2, 0.5])[0] < 0.0);
        assert!(at(&bounds, [0.1, 0.2, 0.85])[1].abs() < 1e-15 && at(&bounds, [0.1, 0.2, 0.24])[1] < 0.0);
        let ball = Capsule { from: Vector3::x(), to: Vector3::x(), radius: 0.5 };
        assert!(
            at(&around_capsule(&ball), [1.3, 0.0, 0.4])[0].abs() < 1e-15
                && at(&around_capsule(&ball), [1.3, 0.0, 0.5])[0] < 0.0
        );
        let cuboid = Cuboid { placement: Placement::translation(0.0, 0.0, 1.0), half: Vector3::new(0.1, 0.2, 0.3) };
        let bounds = around_box(&cuboid);
        assert!(at(&bounds, [0.05, 0.1, 1.2]).iter().all(|&value| value > 0.0));
        assert!(at(&bounds, [0.05, 0.1, 1.3])[2].abs() < 1e-15 && at(&bounds, [0.0, -0.3, 1.0])[1] < 0.0);
        let both = around_all(&[&Solid::Capsule(capsule), &Solid::Cuboid(cuboid)]);
        assert!(at(&both, [0.14, 0.24, 1.2]).iter().all(|&value| value > 0.0));
        assert!(at(&both, [0.16, 0.0, 1.0])[0] < 0.0 && at(&both, [0.0, 0.0, 0.2])[2] < 0.0);
    }
}
