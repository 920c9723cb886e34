//! The Newton–Euler recursion, operation by operation: the torque of a motion, and its columns by parameters.
//!
//! ```text
//! τ_i = s_iᵀ Σ_{k ≥ i} f_k        f_k = K_k φ_k, from outside in        column of a parameter of link k:  s_iᵀ K_k e, i ≤ k
//! ```
//! s_i is the axis of joint i and f_k the wrench on link k, both in the frame of one link (SI).

use super::expression::{Expression, Expressions, Id};
use super::vector::Triple;
use crate::model::term::{MOTOR_VISCOUS, OFFSET, Place, ROTOR, ShapeParameter, Term, VISCOUS};
use crate::model::{JointKind, ParameterId, Robot, StandardParameters};
use crate::spatial::Motion;

/// The recursion over the links in their own frames, forces about their origins.
pub(super) struct Recursion<'a> {
    pub(super) robot: &'a Robot,
    pub(super) links: &'a StandardParameters,
    /// Term, joint or motor, value.
    pub(super) terms: &'a [(Term, usize, f64)],
    pub(super) expressions: Expressions,
}

/// One link's pose in the one before: rows of the rotation, and the translation.
struct Pose {
    rotation: [Triple; 3],
    translation: Triple,
}

impl Pose {
    /// Takes a spatial motion, angular and linear, from the link before.
    fn carry(&self, x: &mut Expressions, [ang, lin]: &[Triple; 2]) -> [Triple; 2] {
        let arm = x.cross(ang, &self.translation);
        let lin = x.add(lin, &arm);
        [x.transposed_times(&self.rotation, ang), x.transposed_times(&self.rotation, &lin)]
    }
}

/// How a link moves: its velocity, and its acceleration less that of gravity, as spatial motions.
struct LinkMotion {
    pose: Pose,
    velocity: [Triple; 2],
    acceleration: [Triple; 2],
}

impl Recursion<'_> {
    /// Torque τ (n) with the terms among `terms`.
    pub(super) fn torque(&mut self, qd: &[Id], qdd: &[Id], has_gravity: bool, terms: &[Term]) -> Vec<Id> {
        let motions = self.motions(qd, qdd, has_gravity);
        let mut forces = Vec::with_capacity(motions.len());
        for (motion, link) in motions.iter().zip(&self.links.links) {
            forces.push(self.expressions.wrench(&link.to_array(), motion));
        }
        let x = &mut self.expressions;
        let zero = [x.number(0.0); 3];
        let mut tau = vec![zero[0]; motions.len()];
        let mut from_outside = [zero; 2];
        for (i, motion) in motions.iter().enumerate().rev() {
            let moment = x.add(&forces[i][0], &from_outside[0]);
            let force = x.add(&forces[i][1], &from_outside[1]);
            let axis = x.motion_vector(&self.robot.axes()[i]);
            tau[i] = x.power(&axis, &[moment, force]);
            let lin = x.times(&motion.pose.rotation, &force);
            let (ang, arm) = (x.times(&motion.pose.rotation, &moment), x.cross(&motion.pose.translation, &lin));
            from_outside = [x.add(&ang, &arm), lin];
        }
        self.add_terms(&mut tau, qd, qdd, terms);
        tau
    }

    /// Columns of the regressor (n each) of parameters: the torque of a unit of each, others zero. Friction of the load is that of
    /// the torque `load` (n).
    pub(super) fn columns(&mut self, ids: &[ParameterId], qd: &[Id], qdd: &[Id], load: &[Id]) -> Vec<Vec<Id>> {
        let motions = self.motions(qd, qdd, true);
        let zero = self.expressions.number(0.0);
        let mut columns = vec![vec![zero; motions.len()]; ids.len()];
        let mut axes: Vec<[Triple; 2]> = Vec::new();
        for (k, motion) in motions.iter().enumerate() {
            let x = &mut self.expressions;
            for axis in &mut axes {
                *axis = motion.pose.carry(x, axis);
            }
            axes.push(x.motion_vector(&self.robot.axes()[k]));
            let of_link = |id: &ParameterId| id.index == k && id.kind.term().is_none();
            for (id, column) in ids.iter().zip(&mut columns).filter(|(id, _)| of_link(id)) {
                let mut unit = StandardParameters::zero(motions.len());
                unit.set(*id, 1.0);
                let wrench = x.wrench(&unit.links[k].to_array(), motion);
                for (place, axis) in column.iter_mut().zip(&axes) {
                    *place = x.power(axis, &wrench);
                }
            }
        }
        for (id, column) in ids.iter().zip(&mut columns) {
            if let Some(term) = id.kind.term() {
                self.add_term(column, (term, id.index, 1.0), qd, qdd, load);
            }
        }
        columns
    }

    fn motions(&mut self, qd: &[Id], qdd: &[Id], has_gravity: bool) -> Vec<LinkMotion> {
        let n = self.robot.dof();
        let x = &mut self.expressions;
        let zero = [x.number(0.0); 3];
        let (mut velocity, mut acceleration) = ([zero; 2], [zero; 2]);
        if has_gravity {
            acceleration[1] = x.vector(&-self.robot.gravity());
        }
        let mut motions = Vec::with_capacity(n);
        for i in 0..n {
            let pose = self.pose(i);
            let x = &mut self.expressions;
            let axis = x.motion_vector(&self.robot.axes()[i]);
            let (moved, changed) = (pose.carry(x, &velocity), pose.carry(x, &acceleration));
            let own = axis.map(|s| x.scaled(&s, qd[i]));
            let gained = axis.map(|s| x.scaled(&s, qdd[i]));
            velocity = [0, 1].map(|part| x.add(&moved[part], &own[part]));
            // v × S q̇ of spatial motions.
            let turned = x.cross(&velocity[0], &own[0]);
            let (slid, swept) = (x.cross(&velocity[0], &own[1]), x.cross(&velocity[1], &own[0]));
            let (a, b) = (x.add(&gained[0], &turned), x.add(&slid, &swept));
            let b = x.add(&gained[1], &b);
            acceleration = [x.add(&changed[0], &a), x.add(&changed[1], &b)];
            motions.push(LinkMotion { pose, velocity, acceleration });
        }
        motions
    }

    fn pose(&mut self, i: usize) -> Pose {
        let joint = &self.robot.joints()[i];
        let x = &mut self.expressions;
        let (before, after) = (x.matrix(&joint.before.rotation), x.matrix(&joint.after.rotation));
        let (start, end) = (x.vector(&joint.before.translation), x.vector(&joint.after.translation));
        let (zero, one) = (x.number(0.0), x.number(1.0));
        let (turn, slide) = match joint.kind {
            JointKind::Revolute => {
                let (s, c) = (x.intern(Expression::Sine(i)), x.intern(Expression::Cosine(i)));
                let minus = x.negative(s);
                ([[c, minus, zero], [s, c, zero], [zero, zero, one]], end)
            }
            JointKind::Prismatic => {
                let q = x.intern(Expression::Position(i));
                let height = x.sum(end[2], q);
                ([[one, zero, zero], [zero, one, zero], [zero, zero, one]], [end[0], end[1], height])
            }
        };
        let turned = x.times(&turn, &slide);
        let reached = x.times(&before, &turned);
        let first = x.composed(&before, &turn);
        Pose { rotation: x.composed(&first, &after), translation: x.add(&start, &reached) }
    }

    /// `τ += φ d g(dᵀq̇, dᵀq̈, τ_l)` for each term, τ being the torque τ_l of the links before.
    fn add_terms(&mut self, tau: &mut [Id], qd: &[Id], qdd: &[Id], terms: &[Term]) {
        let load = tau.to_vec();
        for &term in self.terms.iter().filter(|(term, ..)| terms.contains(term)) {
            self.add_term(tau, term, qd, qdd, &load);
        }
    }

    fn add_term(
        &mut self,
        tau: &mut [Id],
        (term, index, value): (Term, usize, f64),
        qd: &[Id],
        qdd: &[Id],
        load: &[Id],
    ) {
        let n = tau.len();
        let own = || (0..n).map(|j| if j == index { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
        let coupling = self.robot.coupling().filter(|_| term.entry().place != Place::Joint);
        let direction = coupling.map_or_else(own, |c| c.row(index).iter().copied().collect());
        // What a motor takes of the joints' torques: C⁻ᵀ.
        let inverse = coupling.and_then(|c| c.clone().try_inverse());
        let share = inverse.map_or_else(own, |c| c.column(index).iter().copied().collect());
        let scale = self.robot.joints()[index].drive.shape(&ShapeParameter::COULOMB_VELOCITY);
        let x = &mut self.expressions;
        let along = |x: &mut Expressions, direction: &[f64], of: &[Id]| {
            let mut sum = x.number(0.0);
            for (&d, &of) in direction.iter().zip(of) {
                let d = x.number(d);
                let part = x.product(d, of);
                sum = x.sum(sum, part);
            }
            sum
        };
        let law = if term == ROTOR {
            along(x, &direction, qdd)
        } else if term == OFFSET {
            x.number(1.0)
        } else {
            let speed = along(x, &direction, qd);
            let sign = |x: &mut Expressions| x.smooth_sign(speed, scale);
            if term == VISCOUS || term == MOTOR_VISCOUS {
                speed
            } else if term.entry().needs.load {
                let load = along(x, &share, load);
                let (size, sign) = (x.magnitude(load), sign(x));
                x.product(size, sign)
            } else {
                sign(x)
            }
        };
        let value = x.number(value);
        let acts = x.product(value, law);
        for (tau, &d) in tau.iter_mut().zip(&direction) {
            let d = x.number(d);
            let part = x.product(d, acts);
            *tau = x.sum(*tau, part);
        }
    }
}

impl Expressions {
    fn motion_vector(&mut self, axis: &Motion) -> [Triple; 2] {
        [self.vector(&axis.ang), self.vector(&axis.lin)]
    }

    /// Of a motion against a moment and a force.
    fn power(&mut self, motion: &[Triple; 2], wrench: &[Triple; 2]) -> Id {
        let (a, b) = (self.dot(&motion[0], &wrench[0]), self.dot(&motion[1], &wrench[1]));
        self.sum(a, b)
    }

    /// `K φ` of [`BodyRegressor`](crate::regressor::BodyRegressor): moment and force on a link with these ten parameters.
    fn wrench(&mut self, ten: &[f64; 10], motion: &LinkMotion) -> [Triple; 2] {
        let ([w, v], [dw, dv]) = (&motion.velocity, &motion.acceleration);
        let [m, hx, hy, hz, xx, xy, xz, yy, yz, zz] = ten.map(|value| self.number(value));
        let h = [hx, hy, hz];
        let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        // b = a + ω × v;  f = m b + α × h + ω × (ω × h);  n = h × b + I α + ω × I ω.
        let swept = self.cross(w, v);
        let b = self.add(dv, &swept);
        let (carried, turned, once) = (self.scaled(&b, m), self.cross(dw, &h), self.cross(w, &h));
        let twice = self.cross(w, &once);
        let first = self.add(&carried, &turned);
        let force = self.add(&first, &twice);
        let (arm, spun, momentum) = (self.cross(&h, &b), self.times(&inertia, dw), self.times(&inertia, w));
        let gyroscopic = self.cross(w, &momentum);
        let second = self.add(&arm, &spun);
        [self.add(&second, &gyroscopic), force]
    }
}
