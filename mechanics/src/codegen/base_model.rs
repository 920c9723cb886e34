//! The dynamics in base parameters as operations.

use nalgebra::DVector;

use super::error::CodegenError;
use super::expression::{Expression, Expressions, Id};
use super::recursion::Recursion;
use crate::base::{BaseReduction, Category};
use crate::model::term::{
    COULOMB, LOAD_FRICTION, MOTOR_COULOMB, MOTOR_LOAD_FRICTION, MOTOR_VISCOUS, OFFSET, ROTOR, Term, VISCOUS,
};
use crate::model::{ParameterId, Robot, StandardParameters, smooth_sign};

/// Terms whose laws are written.
const WRITTEN: [Term; 8] =
    [ROTOR, VISCOUS, COULOMB, OFFSET, MOTOR_VISCOUS, MOTOR_COULOMB, LOAD_FRICTION, MOTOR_LOAD_FRICTION];

/// Inverse and forward dynamics, gravity torque, mass matrix and regressor of an arm in base parameters.
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
    /// q̈(q, q̇, τ), n; `None` where friction depends on the load.
    pub(super) forward: Option<Vec<Id>>,
    /// Y_b(q, q̇, q̈) by rows, n × b.
    pub(super) regressor: Vec<Id>,
    /// β (b).
    pub(super) beta: Vec<f64>,
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
        let load = recursion.torque(&qd, &qdd, true, &[]);
        let ids: Vec<ParameterId> = base.kept.iter().map(|&column| base.parameters[column]).collect();
        let columns = recursion.columns(&ids, &qd, &qdd, &load);
        let regressor = (0..dof).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
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
        let forward = terms.iter().all(|(term, ..)| !term.entry().needs.load).then(|| {
            let bias = recursion.torque(&qd, &zero, true, &WRITTEN);
            recursion.expressions.forward(&mass, &bias)
        });
        Ok(Self {
            dof,
            expressions: recursion.expressions,
            torque,
            gravity,
            mass,
            forward,
            regressor,
            beta: beta.iter().copied().collect(),
            offset_in_weight: offset_in_weight(base),
        })
    }

    /// Sums, differences, products, sines and cosines of the inverse dynamics.
    pub fn operations(&self) -> usize {
        use Expression::{Acceleration, Effort, Negative, Number, Position, Velocity};
        let needed = self.expressions.needed_for(self.torque.iter().copied());
        let costs = |expression: &Expression| {
            !matches!(expression, Number(_) | Position(_) | Velocity(_) | Acceleration(_) | Effort(_) | Negative(_))
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

    /// Whether accelerations can be written: not where friction depends on the load, which depends on them.
    pub const fn has_forward_dynamics(&self) -> bool {
        self.forward.is_some()
    }

    /// Acceleration q̈ (n) under a torque τ, at a state q, q̇ (n each). It is not finite where the mass matrix of β has no inverse, and
    /// not a number without [`Self::has_forward_dynamics`].
    ///
    /// # Panics
    /// If a slice has not one number per joint.
    pub fn forward_dynamics(&self, q: &[f64], qd: &[f64], tau: &[f64], qdd: &mut [f64]) {
        match &self.forward {
            Some(forward) => self.evaluate([q, qd, tau], forward, qdd),
            None => qdd.fill(f64::NAN),
        }
    }

    /// Regressor `Y_b` by rows (n × b), `τ = Y_b β`, at a state q, q̇, q̈ (n each). Columns of load friction take the load of the model's β.
    ///
    /// # Panics
    /// If a slice has not one number per joint, or `y` not n b.
    pub fn regressor(&self, q: &[f64], qd: &[f64], qdd: &[f64], y: &mut [f64]) {
        self.evaluate([q, qd, qdd], &self.regressor, y);
    }

    fn evaluate(&self, [q, qd, third]: [&[f64]; 3], outputs: &[Id], out: &mut [f64]) {
        assert!([q.len(), qd.len(), third.len()] == [self.dof; 3], "one number per joint");
        assert_eq!(out.len(), outputs.len(), "one place per result");
        let mut values: Vec<f64> = Vec::with_capacity(self.expressions.list.len());
        for &expression in &self.expressions.list {
            let value = match expression {
                Expression::Number(bits) => f64::from_bits(bits),
                Expression::Position(i) => q[i],
                Expression::Velocity(i) => qd[i],
                Expression::Acceleration(i) | Expression::Effort(i) => third[i],
                Expression::Sine(i) => libm::sin(q[i]),
                Expression::Cosine(i) => libm::cos(q[i]),
                Expression::SmoothSign(a, scale) => smooth_sign(values[a], f64::from_bits(scale)),
                Expression::Negative(a) => -values[a],
                Expression::Magnitude(a) => values[a].abs(),
                Expression::Reciprocal(a) => 1.0 / values[a],
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
