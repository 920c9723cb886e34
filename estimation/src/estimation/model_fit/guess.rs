//! What is known of the bodies before a log: the robot file's own, or bodies of uniform density.
//!
//! ```text
//! box of half lengths a, b, c     P = m diag(a², b², c², 3)/3 in its frame        m = 8 ρ a b c        ρ = 1000 kg/m³
//! rod of length l, radius r       P = m diag(r²/4, r²/4, l²/12, 1)                m = ρ π r² l
//! ```
//! A link without shapes is a rod from its joint to the next one, with a radius of a fifth of its length.

use nalgebra::{Matrix4, Vector3};

use crate::model::{Capsule, Cuboid, Robot, Solid, StandardParameters};
use crate::spatial::{Inertia, Placement, PseudoInertia};

/// ρ, kg/m³: that of water; arms are between half and twice as dense.
const DENSITY: f64 = 1000.0;

/// Radius of a rod over its length, and its least length, m.
const SLENDERNESS: f64 = 0.2;
const SHORTEST: f64 = 0.05;

/// A link whose mass is less than this part of the heaviest one's is not stated: files write such masses where they know none.
const STATED: f64 = 1e-4;

/// Smallest eigenvalue of a stated body relative to the largest, in units in which its diagonal is one, below which it is a point, a
/// line or a plate, and gets the extent of a small ball.
const FLAT: f64 = 1e-6;

/// How far a mass may be from its guess, as a factor: of a stated body and of a uniform one. The last link may carry a tool that the
/// robot file does not know.
const OF_STATED: f64 = 10.0;
const OF_UNIFORM: f64 = 100.0;
const OF_TOOL: f64 = 10.0;

/// Where the guess of a body comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BodyOrigin {
    /// The robot file states it.
    Stated,
    /// The link's shapes, of uniform density.
    Shapes,
    /// A uniform rod from the link's joint to the next one.
    Length,
}

/// Bodies and drives that a fit stays near.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelGuess {
    /// The set; drives are zero where nothing is stated.
    pub parameters: StandardParameters,
    /// Where each body comes from.
    pub origins: Vec<BodyOrigin>,
}

impl ModelGuess {
    /// What a robot file states, and uniform bodies where it states none. `shapes` are solids with the link (from zero) whose frame they
    /// are in, beside those of the robot.
    ///
    /// ```
    /// # use armid_estimation as armid;
    /// use armid::chains;
    /// use armid::estimation::{BodyOrigin, ModelGuess};
    /// let (robot, stated) = chains::random_robot(&mut armid::seed::Seed::new(1).stream("doc", 0), 3);
    /// assert_eq!(ModelGuess::new(&robot, Some(&stated), &[]).parameters, stated);
    /// let uniform = ModelGuess::new(&robot, None, &[]);
    /// assert_eq!(uniform.origins, [BodyOrigin::Length; 3]);
    /// assert!(uniform.parameters.links.iter().all(|link| link.check().is_ok()));
    /// ```
    pub fn new(robot: &Robot, stated: Option<&StandardParameters>, shapes: &[(usize, Solid)]) -> Self {
        let n = robot.dof();
        let mut parameters = stated.cloned().unwrap_or_else(|| StandardParameters::zero(n));
        let heaviest = parameters.links.iter().fold(0.0_f64, |most, link| most.max(link.mass));
        let mut origins = Vec::with_capacity(n);
        for (index, link) in parameters.links.iter_mut().enumerate() {
            if link.mass > STATED * heaviest && link.to_array().iter().all(|x| x.is_finite()) {
                *link = with_extent(link);
                origins.push(BodyOrigin::Stated);
                continue;
            }
            let own = robot.shapes().iter().filter(|shape| shape.link == index + 1).map(|shape| &shape.solid);
            let others = shapes.iter().filter(|(link, _)| *link == index).map(|(_, solid)| solid);
            let sum = own.chain(others).fold(Matrix4::zeros(), |sum, solid| sum + uniform(solid));
            let body = PseudoInertia(sum).inertia();
            let (body, origin) = match body.check() {
                Ok(()) => (body, BodyOrigin::Shapes),
                Err(_) => (rod_of_link(robot, index), BodyOrigin::Length),
            };
            *link = body;
            origins.push(origin);
        }
        Self { parameters, origins }
    }

    /// Least and largest mass of a link (from zero) over that of its guess.
    pub(super) fn bounds(&self, index: usize) -> (f64, f64) {
        let factor = if self.origins[index] == BodyOrigin::Stated { OF_STATED } else { OF_UNIFORM };
        let factor = if index + 1 == self.origins.len() { factor * OF_TOOL } else { factor };
        (1.0 / factor, factor)
    }
}

/// The body itself, or where it is a point, a line or none, its mass with the extent of a ball.
fn with_extent(link: &Inertia) -> Inertia {
    let p = link.pseudo().0;
    let unit = p.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { f64::NAN });
    let scaled = PseudoInertia(Matrix4::from_fn(|i, j| p[(i, j)] * unit[i] * unit[j]));
    if scaled.0.iter().all(|x| x.is_finite()) && scaled.smallest_eigenvalue() > FLAT {
        return *link;
    }
    let com = link.com().unwrap_or_default();
    // The radius of gyration that the moments speak of.
    let stated = (link.about_com().trace() / (3.0 * link.mass)).max(0.0).sqrt();
    Inertia::with_gyration(link.mass, com.into(), stated.max(0.4 * SHORTEST))
}

/// The pseudo-inertia of a solid of uniform density in the frame of its link; a hull is the box around it.
fn uniform(solid: &Solid) -> Matrix4<f64> {
    match solid {
        Solid::Cuboid(Cuboid { placement, half }) => cuboid(placement, half),
        // The cylinder of the same radius and volume.
        Solid::Capsule(Capsule { from, to, radius }) => rod(from, to, *radius, 4.0 / 3.0 * radius),
        Solid::Hull(hull) => {
            let middle = hull.middle();
            cuboid(&Placement::translation(middle.x, middle.y, middle.z), &hull.half_box())
        }
    }
}

fn cuboid(placement: &Placement, half: &Vector3<f64>) -> Matrix4<f64> {
    let mass = 8.0 * DENSITY * half.product();
    let third = half.component_mul(half) * (mass / 3.0);
    seen_from(placement, &third, mass)
}

/// A rod between two points, longer than their distance by `more`.
fn rod(from: &Vector3<f64>, to: &Vector3<f64>, radius: f64, more: f64) -> Matrix4<f64> {
    let way = to - from;
    let length = way.norm() + more;
    let mass = DENSITY * std::f64::consts::PI * radius * radius * length;
    let across = 0.25 * radius * radius;
    let along = length * length / 12.0 - across;
    let e = way.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let middle = (from + to) * 0.5;
    let mut p = seen_from(&Placement::translation(middle.x, middle.y, middle.z), &Vector3::repeat(mass * across), mass);
    let mut block = p.fixed_view_mut::<3, 3>(0, 0);
    block += e * e.transpose() * (mass * along);
    p
}

/// `T diag(σ, m) Tᵀ` for the second moments σ about the centre, along the axes of a frame.
fn seen_from(placement: &Placement, moments: &Vector3<f64>, mass: f64) -> Matrix4<f64> {
    let mut t = Matrix4::identity();
    t.fixed_view_mut::<3, 3>(0, 0).copy_from(&placement.rotation);
    t.fixed_view_mut::<3, 1>(0, 3).copy_from(&placement.translation);
    t * Matrix4::from_diagonal(&moments.push(mass)) * t.transpose()
}

/// A rod from the joint of a link (from zero) to the next; of the last link, as long as half the one before.
fn rod_of_link(robot: &Robot, index: usize) -> Inertia {
    let joints = robot.joints();
    let own = joints[index].after.inverse();
    let from = own.translation;
    let to = match joints.get(index + 1) {
        Some(next) => next.before.translation,
        None => from + own.rotation.column(2) * (0.5 * joints[index].before.translation.norm()),
    };
    let length = (to - from).norm();
    let short = (SHORTEST - length).max(0.0);
    PseudoInertia(rod(&from, &to, SLENDERNESS * length.max(SHORTEST), short)).inertia()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::planar_2r;

    #[test]
    fn analytic_a_rod_has_the_moments_of_a_solid_cylinder() {
        let (radius, length) = (0.1, 0.5);
        let body = PseudoInertia(rod(&Vector3::zeros(), &Vector3::new(0.3, 0.0, 0.0), radius, 0.2)).inertia();
        let mass = DENSITY * std::f64::consts::PI * radius * radius * length;
        let about_centre = mass * (radius * radius / 4.0 + length * length / 12.0);
        let expected = [mass, 0.15 * mass, 0.5 * mass * radius * radius, about_centre + 0.15 * 0.15 * mass];
        let found = [body.mass, body.first_moment.x, body.rotational[(0, 0)], body.rotational[(2, 2)]];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn analytic_a_link_is_a_rod_to_the_next_joint_and_the_last_one_half_as_long_as_that_before() {
        let robot = planar_2r()
            .with_joints(|joint| {
                joint.dh = None;
                (joint.before, joint.after) = (Placement::translation(0.3, 0.0, 0.4), Placement::identity());
            })
            .unwrap();
        let links = [(0.5, Vector3::new(0.15, 0.0, 0.2)), (0.25, Vector3::new(0.0, 0.0, 0.125))];
        for (index, (length, centre)) in links.into_iter().enumerate() {
            let body = rod_of_link(&robot, index);
            let radius = SLENDERNESS * length;
            let mass = DENSITY * std::f64::consts::PI * radius * radius * length;
            assert!((body.mass / mass - 1.0).abs() < 1e-12, "{} {mass}", body.mass);
            assert!((body.first_moment / body.mass - centre).norm() < 1e-12);
        }
    }
}
