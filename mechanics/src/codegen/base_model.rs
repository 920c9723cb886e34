//! The Newton–Euler recursion with base parameters, operation by operation.

use nalgebra::DVector;

use super::error::CodegenError;
use super::expression::{Expression, Expressions, Id};
use super::vector::Triple;
use crate::base::{BaseReduction, Category};
use crate::model::term::{
    COULOMB, LOAD_FRICTION, MOTOR_COULOMB, MOTOR_LOAD_FRICTION, MOTOR_VISCOUS, OFFSET, Place, ROTOR, ShapeParameter,
    Term, VISCOUS,
};
use crate::model::{JointKind, Robot, StandardParameters, smooth_sign};

/// Terms whose laws are written.
const WRITTEN: [Term; 8] =
    [ROTOR, VISCOUS, COULOMB, OFFSET, MOTOR_VISCOUS, MOTOR_COULOMB, LOAD_FRICTION, MOTOR_LOAD_FRICTION];

/// Inverse dynamics, gravity torque and mass matrix of an arm in base parameters.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::base::{Method, reduce};
/// use armid::codegen::{BaseModel, Language};
/// use armid::model::{Columns, StandardParameters};
/// use armid::seed::Seed;
/// # let robot = armid::chains::planar_2r();
/// let base = reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0))?;
/// let beta = base.beta(&StandardParameters::zero(2).vector(&robot, Columns::RIGID));
/// let model = BaseModel::new(&robot, &base, &beta)?;
/// assert!(model.source(Language::C, "").contains("void armid_inverse_dynamics(const double q[2]"));
/// // An arm that weighs nothing needs no operation at all.
/// assert_eq!(model.operations(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BaseModel {
    pub(super) dof: usize,
    pub(super) expressions: Expressions,
    /// τ(q, q̇, q̈), n.
    pub(super) torque: Vec<Id>,
    /// τ(q, 0, 0) of the links alone, n.
    pub(super) gravity: Vec<Id>,
    /// M(q) by rows, n × n.
    pub(super) mass: Vec<Id>,
    /// Joints, from zero, whose constant offset the base does not tell from the weight of the links, so that
    /// [`gravity`](Self::gravity) has it: a prismatic joint whose axis keeps its angle to gravity, with a rotor.
    pub offset_in_weight: Vec<usize>,
}

impl BaseModel {
    /// The model of a robot with base parameters β (b), SI.
    ///
    /// # Errors
    /// [`CodegenError`] where β or the base are not of this robot, or a base parameter is of a torque term that is not written.
    pub fn new(robot: &Robot, base: &BaseReduction, beta: &DVector<f64>) -> Result<Self, CodegenError> {
        let dof = robot.dof();
        if beta.len() != base.rank() {
            return Err(CodegenError::Count { found: beta.len(), expected: base.rank() });
        }
        let mut parameters = StandardParameters::zero(dof);
        let mut terms = Vec::new();
        for (&column, &value) in base.kept.iter().zip(beta) {
            let id = base.parameters[column];
            if id.index >= dof {
                return Err(CodegenError::OtherRobot { parameter: id.to_string(), dof });
            }
            match id.kind.term() {
                Some(term) if WRITTEN.contains(&term) => terms.push((term, id.index, value)),
                Some(_) => return Err(CodegenError::Term { parameter: id.to_string() }),
                None => parameters.set(id, value),
            }
        }
        let mut recursion = Recursion { robot, links: &parameters, terms: &terms, expressions: Expressions::default() };
        let x = &mut recursion.expressions;
        let zero = vec![x.number(0.0); dof];
        let one = x.number(1.0);
        let qd: Vec<Id> = (0..dof).map(|i| x.intern(Expression::Velocity(i))).collect();
        let qdd: Vec<Id> = (0..dof).map(|i| x.intern(Expression::Acceleration(i))).collect();
        let torque = recursion.torque(&qd, &qdd, true, &WRITTEN);
        let gravity = recursion.torque(&zero, &zero, true, &[]);
        let mut mass = vec![zero[0]; dof * dof];
        for j in 0..dof {
            let mut unit = zero.clone();
            unit[j] = one;
            let column = recursion.torque(&zero, &unit, false, &[ROTOR]);
            // The upper triangle is the lower one: what both have in common is computed once.
            for (i, &entry) in column.iter().enumerate().skip(j) {
                mass[i * dof + j] = entry;
                mass[j * dof + i] = entry;
            }
        }
        Ok(Self {
            dof,
            expressions: recursion.expressions,
            torque,
            gravity,
            mass,
            offset_in_weight: offset_in_weight(base),
        })
    }

    /// Sums, differences, products, sines and cosines of the inverse dynamics.
    pub fn operations(&self) -> usize {
        use Expression::{Acceleration, Negative, Number, Position, Velocity};
        let needed = self.expressions.needed_for(self.torque.iter().copied());
        let costs = |expression: &Expression| {
            !matches!(expression, Number(_) | Position(_) | Velocity(_) | Acceleration(_) | Negative(_))
        };
        self.expressions.list.iter().zip(needed).filter(|(expression, needed)| *needed && costs(expression)).count()
    }

    /// Inverse dynamics τ (n) by the operations that are written, at a state q, q̇, q̈ (n each).
    ///
    /// # Panics
    /// If a slice has not one number per joint.
    pub fn inverse_dynamics(&self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        self.evaluate([q, qd, qdd], &self.torque, tau);
    }

    /// Torque of the links' weight at rest (n), at positions q (n), with the offsets that count as weight.
    ///
    /// # Panics
    /// If a slice has not one number per joint.
    pub fn gravity(&self, q: &[f64], tau: &mut [f64]) {
        let zero = vec![0.0; self.dof];
        self.evaluate([q, &zero, &zero], &self.gravity, tau);
    }

    /// Mass matrix by rows (n × n), rotors among it, at positions q (n).
    ///
    /// # Panics
    /// If `q` has not n numbers, or `mass` not n².
    pub fn mass_matrix(&self, q: &[f64], mass: &mut [f64]) {
        let zero = vec![0.0; self.dof];
        self.evaluate([q, &zero, &zero], &self.mass, mass);
    }

    fn evaluate(&self, [q, qd, qdd]: [&[f64]; 3], outputs: &[Id], out: &mut [f64]) {
        assert!([q.len(), qd.len(), qdd.len()] == [self.dof; 3], "one number per joint");
        assert_eq!(out.len(), outputs.len(), "one place per result");
        let mut values: Vec<f64> = Vec::with_capacity(self.expressions.list.len());
        for &expression in &self.expressions.list {
            let value = match expression {
                Expression::Number(bits) => f64::from_bits(bits),
                Expression::Position(i) => q[i],
                Expression::Velocity(i) => qd[i],
                Expression::Acceleration(i) => qdd[i],
                Expression::Sine(i) => libm::sin(q[i]),
                Expression::Cosine(i) => libm::cos(q[i]),
                Expression::SmoothSign(a, scale) => smooth_sign(values[a], f64::from_bits(scale)),
                Expression::Negative(a) => -values[a],
                Expression::Magnitude(a) => values[a].abs(),
                Expression::Sum(a, b) => values[a] + values[b],
                Expression::Difference(a, b) => values[a] - values[b],
                Expression::Product(a, b) => values[a] * values[b],
            };
            values.push(value);
        }
        for (out, &id) in out.iter_mut().zip(outputs) {
            *out = values[id];
        }
    }
}

/// Joints whose offset is part of a base parameter that a link's parameter stands for.
fn offset_in_weight(base: &BaseReduction) -> Vec<usize> {
    let is_offset = |column: &usize| base.parameters[*column].kind.term() == Some(OFFSET);
    let combined = (0..base.parameters.len()).filter(|column| base.categories[*column] == Category::Combination);
    combined.filter(is_offset).map(|column| base.parameters[column].index).collect()
}

/// The recursion over the links in their own frames, forces about their origins.
struct Recursion<'a> {
    robot: &'a Robot,
    links: &'a StandardParameters,
    /// Term, joint or motor, value.
    terms: &'a [(Term, usize, f64)],
    expressions: Expressions,
}

/// One link's pose in the one before: rows of the rotation, and the translation.
struct Pose {
    rotation: [Triple; 3],
    translation: Triple,
}

impl Recursion<'_> {
    fn torque(&mut self, qd: &[Id], qdd: &[Id], has_gravity: bool, terms: &[Term]) -> Vec<Id> {
        let n = self.robot.dof();
        let x = &mut self.expressions;
        let zero = [x.number(0.0); 3];
        let (mut w, mut v, mut dw) = (zero, zero, zero);
        let mut dv = if has_gravity { x.vector(&-self.robot.gravity()) } else { zero };
        let (mut poses, mut forces) = (Vec::with_capacity(n), Vec::with_capacity(n));
        for i in 0..n {
            let pose = self.pose(i);
            let axis = self.robot.axes()[i];
            let x = &mut self.expressions;
            let axis = [x.vector(&axis.ang), x.vector(&axis.lin)];
            let carried = |x: &mut Expressions, ang: &Triple, lin: &Triple| {
                let arm = x.cross(ang, &pose.translation);
                let lin = x.add(lin, &arm);
                (x.transposed_times(&pose.rotation, ang), x.transposed_times(&pose.rotation, &lin))
            };
            let (ang, lin) = carried(x, &w, &v);
            let (dang, dlin) = carried(x, &dw, &dv);
            let own = axis.map(|s| x.scaled(&s, qd[i]));
            let gained = axis.map(|s| x.scaled(&s, qdd[i]));
            (w, v) = (x.add(&ang, &own[0]), x.add(&lin, &own[1]));
            // v × S q̇ of spatial motions.
            let turned = x.cross(&w, &own[0]);
            let (slid, swept) = (x.cross(&w, &own[1]), x.cross(&v, &own[0]));
            let moved = x.add(&slid, &swept);
            let (a, b) = (x.add(&gained[0], &turned), x.add(&gained[1], &moved));
            (dw, dv) = (x.add(&dang, &a), x.add(&dlin, &b));
            forces.push(self.wrench(i, &w, &v, &dw, &dv));
            poses.push(pose);
        }
        let mut tau = vec![zero[0]; n];
        let mut from_outside = [zero; 2];
        for i in (0..n).rev() {
            let axis = self.robot.axes()[i];
            let x = &mut self.expressions;
            let moment = x.add(&forces[i][0], &from_outside[0]);
            let force = x.add(&forces[i][1], &from_outside[1]);
            let (by_moment, by_force) = (x.vector(&axis.ang), x.vector(&axis.lin));
            let (a, b) = (x.dot(&by_moment, &moment), x.dot(&by_force, &force));
            tau[i] = x.sum(a, b);
            let lin = x.times(&poses[i].rotation, &force);
            let (ang, arm) = (x.times(&poses[i].rotation, &moment), x.cross(&poses[i].translation, &lin));
            from_outside = [x.add(&ang, &arm), lin];
        }
        self.add_terms(&mut tau, qd, qdd, terms);
        tau
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

    /// `K φ` of [`BodyRegressor`](crate::regressor::BodyRegressor): moment and force on a link.
    fn wrench(&mut self, i: usize, w: &Triple, v: &Triple, dw: &Triple, dv: &Triple) -> [Triple; 2] {
        let ten = self.links.links[i].to_array();
        let x = &mut self.expressions;
        let ten = ten.map(|value| x.number(value));
        let [m, hx, hy, hz, xx, xy, xz, yy, yz, zz] = ten;
        let h = [hx, hy, hz];
        let inertia = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        // b = a + ω × v;  f = m b + α × h + ω × (ω × h);  n = h × b + I α + ω × I ω.
        let swept = x.cross(w, v);
        let b = x.add(dv, &swept);
        let (carried, turned, once) = (x.scaled(&b, m), x.cross(dw, &h), x.cross(w, &h));
        let twice = x.cross(w, &once);
        let first = x.add(&carried, &turned);
        let force = x.add(&first, &twice);
        let (arm, spun, momentum) = (x.cross(&h, &b), x.times(&inertia, dw), x.times(&inertia, w));
        let gyroscopic = x.cross(w, &momentum);
        let second = x.add(&arm, &spun);
        [x.add(&second, &gyroscopic), force]
    }

    /// `τ += φ d g(dᵀq̇, dᵀq̈, τ_l)` for each term, τ being the torque τ_l of the links before.
    fn add_terms(&mut self, tau: &mut [Id], qd: &[Id], qdd: &[Id], terms: &[Term]) {
        let (n, load) = (tau.len(), tau.to_vec());
        for &(term, index, value) in self.terms.iter().filter(|(term, ..)| terms.contains(term)) {
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
                    let load = along(x, &share, &load);
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
}
