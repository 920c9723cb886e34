//! How the parameters of a link look from the link before it while the joint between them moves.
//!
//! ```text
//! π_parent = A(q) π_child         A(q) = A(before) exp(G q) A(after)
//! revolute:   exp(G q) = P0 + P1 cos q + G P1 sin q + P2 cos 2q + ½ G P2 sin 2q        (G has eigenvalues 0, ±i, ±2i)
//! prismatic:  exp(G q) = 1 + G q + ½ G² q²                                             (G³ = 0)
//! ```
//! The projections are polynomials in G, whose entries are small integers: they are exact.

use nalgebra::{Matrix4, SMatrix, SVector};

use crate::model::JointKind;
use crate::spatial::{Inertia, Motion, Placement, PseudoInertia};

/// A linear map on the ten parameters of a link.
type Map = SMatrix<f64, 10, 10>;

/// A linear functional of the ten parameters of a link.
pub(super) type Functional = SVector<f64, 10>;

/// The coefficient maps of A(q): one that stays, and those that go with independent functions of q.
pub(super) struct Harmonics {
    constant: Map,
    moving: Vec<Map>,
}

impl Harmonics {
    /// The maps of one joint.
    pub(super) fn of(kind: JointKind, before: &Placement, after: &Placement) -> Self {
        let g = generator(kind);
        let one = Map::identity();
        let g2 = g * g;
        let (constant, moving) = match kind {
            JointKind::Revolute => {
                let p0 = (one + g2) * (one * 4.0 + g2) / 4.0;
                let p1 = g2 * (one * 4.0 + g2) / -3.0;
                let p2 = g2 * (one + g2) / 12.0;
                (p0, vec![p1, g * p1, p2, g * p2])
            }
            JointKind::Prismatic => (one, vec![g, g2]),
        };
        let (before, after) = (placement_map(before), placement_map(after));
        let place = |map: Map| before * map * after;
        Self { constant: place(constant), moving: moving.into_iter().map(place).collect() }
    }

    /// The constant part of the functional `r` of the parent's parameters, as a functional of the child's.
    pub(super) fn constant_part(&self, r: &Functional) -> Functional {
        self.constant.tr_mul(r)
    }

    /// Its moving parts.
    pub(super) fn moving_parts(&self, r: &Functional) -> impl Iterator<Item = Functional> {
        self.moving.iter().map(move |map| map.tr_mul(r))
    }
}

/// The functional `π ↦ vᵀ I[π] s`.
pub(super) fn inner_product(v: &Motion, s: &Motion) -> Functional {
    Functional::from_fn(|k, _| v.dot(&unit_inertia(k).apply(s)))
}

/// The k-th of the ten is 1, the others 0.
fn unit_inertia(k: usize) -> Inertia {
    let mut ten = [0.0; 10];
    ten[k] = 1.0;
    Inertia::from_array(&ten)
}

/// The map from a link's parameters to those seen from a frame in which it stands at `placement`: `P → T P Tᵀ`.
fn placement_map(placement: &Placement) -> Map {
    let mut t = Matrix4::identity();
    t.fixed_view_mut::<3, 3>(0, 0).copy_from(&placement.rotation);
    t.fixed_view_mut::<3, 1>(0, 3).copy_from(&placement.translation);
    pseudo_map(|p| t * p * t.transpose())
}

/// The rate of the ten when the link moves along or about z with unit speed: `P → X P + P Xᵀ`.
fn generator(kind: JointKind) -> Map {
    let mut x = Matrix4::zeros();
    match kind {
        JointKind::Revolute => {
            x[(0, 1)] = -1.0;
            x[(1, 0)] = 1.0;
        }
        JointKind::Prismatic => x[(2, 3)] = 1.0,
    }
    pseudo_map(|p| x * p + p * x.transpose())
}

fn pseudo_map(change: impl Fn(Matrix4<f64>) -> Matrix4<f64>) -> Map {
    let mut map = Map::zeros();
    for k in 0..10 {
        let image = PseudoInertia(change(unit_inertia(k).pseudo().0)).inertia().to_array();
        map.set_column(k, &Functional::from(image));
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_the_maps_add_up_to_the_moved_inertia() {
        let (s, c) = libm::sincos(0.4);
        let before = Placement::rotation_x(s, c).compose(&Placement::translation(0.1, -0.3, 0.2));
        let after = Placement::translation(0.5, 0.2, -0.1).compose(&Placement::rotation_y(c, s));
        let child = Functional::from_fn(|k, _| libm::cos((k * k) as f64));
        let q: f64 = 0.83;
        let (sin, cos) = libm::sincos(q);
        let (sin2, cos2) = libm::sincos(2.0 * q);
        for (kind, moved, weights) in [
            (JointKind::Revolute, Placement::rotation_z(sin, cos), vec![cos, sin, cos2, 0.5 * sin2]),
            (JointKind::Prismatic, Placement::translation(0.0, 0.0, q), vec![q, 0.5 * q * q]),
        ] {
            let harmonics = Harmonics::of(kind, &before, &after);
            let expected = placement_map(&before.compose(&moved).compose(&after)) * child;
            for k in 0..10 {
                let mut r = Functional::zeros();
                r[k] = 1.0;
                let mut sum = harmonics.constant_part(&r).dot(&child);
                for (part, weight) in harmonics.moving_parts(&r).zip(&weights) {
                    sum += weight * part.dot(&child);
                }
                assert!((sum - expected[k]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn identity_moving_a_body_and_moving_the_frame_give_the_same_energy() {
        // ½ vᵀ I v does not depend on the frame in which it is written.
        let (s, c) = libm::sincos(0.7);
        let x = Placement::rotation_x(s, c).compose(&Placement::translation(0.1, -0.3, 0.2));
        let v = Motion::new([0.3, -0.2, 0.9].into(), [1.1, 0.4, -0.6].into());
        let child = Functional::from_fn(|k, _| libm::cos((k * k) as f64));
        let seen = placement_map(&x) * child;
        let here = inner_product(&v, &v).dot(&seen);
        let v_child = x.motion_to_child(&v);
        assert!((here - inner_product(&v_child, &v_child).dot(&child)).abs() < 1e-14);
    }
}
