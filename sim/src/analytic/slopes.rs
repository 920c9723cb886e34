//! The analytic arm with the derivatives of its state by some of its parameters: forward sensitivities.
//!
//! ```text
//! H(q) q̈ + … = Y(q, q̇, q̈) φ = τ        ∂q̈/∂φ_j = ∂q̈/∂q q'_j + ∂q̈/∂q̇ q̇'_j + H⁻¹ (τ'_j − Y_j)
//! ```
//! Propagated through every stage of the Runge–Kutta step, so that they are the derivatives of the simulation itself and not
//! of the equations that it approximates. The division of a step where friction is stiff is taken as given. A rigid part that is
//! held moves with the state in which it was taken. Derivatives by the state come from [`Jet`]s through the plant's own recursion,
//! columns from the core's regressor.

use armid::experiment::{Plant, PlantError};
use armid::model::{Columns, ParameterId, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use pulp::{Arch, Simd, WithSimd};

use super::chain::Chain;
use super::forward::Rigid;
use super::integrator::{self, Held, State, after, after_middle, along};
use super::jet::Jet;
use super::plant::{AnalyticError, AnalyticPlant};

/// An arm whose state moves with its parameters, behind a number of joints that is known when this is compiled.
pub(crate) trait SlopedArm {
    /// Puts it at rest at `q`, whatever the parameters.
    fn reset(&mut self, q: &[f64]);
    /// Puts it into a state (n each) that moves with these derivatives (n × d each).
    fn begin(&mut self, state: (&[f64], &[f64]), slopes: (&[f64], &[f64]));
    /// Joint coordinates and velocities.
    fn state(&self) -> (&[f64], &[f64]);
    /// Their derivatives, n × d each.
    fn slopes(&self) -> (&[f64], &[f64]);
    /// Advances by `dt` under torque `tau` (n) whose derivatives are `by` (n × d).
    fn step(&mut self, tau: &[f64], by: &[f64], dt: f64) -> Result<(), PlantError>;
}

/// The arm with these parameters, and derivatives by some of them and `beside` numbers that its equations do not hold, such as
/// those of the state that it begins in: d of both together, in that order.
///
/// # Errors
/// As [`AnalyticPlant::new`]; [`AnalyticError::Derivative`] for a parameter by which none can be taken.
pub(crate) fn sloped_arm(
    robot: &Robot,
    parameters: &StandardParameters,
    by: &[ParameterId],
    beside: usize,
) -> Result<Box<dyn SlopedArm>, AnalyticError> {
    // All checks are those of the plant.
    let dof = AnalyticPlant::new(robot, parameters)?.dof();
    let columns = by.iter().filter_map(|id| id.kind.term()).fold(Columns::RIGID, Columns::with_term);
    let beyond = |_| columns.beyond_motion().map_or_else(String::new, |term| term.symbol().to_owned());
    let regressor = JointTorqueRegressor::new(robot, columns);
    let regressor = regressor.map_err(|fault| AnalyticError::Derivative { parameter: beyond(fault) })?;
    let column = |id: &ParameterId| {
        let found = regressor.parameters().iter().position(|own| own == id);
        let of_term = id.kind.term().is_some_and(|term| !term.is_inertia());
        let found = found.map(|column| (column, of_term));
        found.ok_or_else(|| AnalyticError::Derivative { parameter: id.to_string() })
    };
    let kept: Vec<(usize, bool)> = by.iter().map(column).collect::<Result<_, _>>()?;
    let spec = (robot, parameters, regressor, kept, beside);
    let arm: Box<dyn SlopedArm> = match dof {
        1 => Box::new(Sloped::<1, 1>::new(spec)),
        2 => Box::new(Sloped::<2, 1>::new(spec)),
        3 => Box::new(Sloped::<3, 2>::new(spec)),
        4 => Box::new(Sloped::<4, 2>::new(spec)),
        5 => Box::new(Sloped::<5, 3>::new(spec)),
        6 => Box::new(Sloped::<6, 3>::new(spec)),
        7 => Box::new(Sloped::<7, 4>::new(spec)),
        _ => Box::new(Sloped::<8, 4>::new(spec)),
    };
    Ok(arm)
}

/// Numbers of state by which a sweep takes derivatives: as many as the lanes of a usual processor. Sweeps with more of them are longer to
/// compile, and no faster.
const BLOCK: usize = 4;

/// A number with its derivatives by one block of the 2 N of the state, the coordinates first.
type BlockJet = Jet<BLOCK>;

/// N joints, M = ⌈2 N / BLOCK⌉ blocks.
struct Sloped<const N: usize, const M: usize> {
    chain: Chain<N>,
    regressor: JointTorqueRegressor,
    /// Which column each direction is, and whether it is friction's.
    kept: Vec<(usize, bool)>,
    /// d.
    directions: usize,
    state: State<N, f64>,
    /// Derivatives of coordinates and velocities, N × d each.
    q: Vec<f64>,
    v: Vec<f64>,
    /// Those where a held rigid part was taken, and at the beginning of a divided step.
    taken_q: Vec<f64>,
    taken_v: Vec<f64>,
    start_q: Vec<f64>,
    start_v: Vec<f64>,
    /// Those at the stage, and of the accelerations of all four.
    stage_q: Vec<f64>,
    stage_v: Vec<f64>,
    sum_q: Vec<f64>,
    sum_v: Vec<f64>,
    a: Vec<f64>,
    y: Vec<f64>,
    y_of_terms: Vec<f64>,
}

/// The rigid part of the equations, the same while it is held, and where it was taken.
struct Taken<const N: usize, const M: usize> {
    rigid: [Rigid<N, BlockJet>; M],
    held: Held<N, f64>,
    at: State<N, f64>,
}

impl<const N: usize, const M: usize> Sloped<N, M> {
    fn new(
        (robot, parameters, regressor, kept, beside): (
            &Robot,
            &StandardParameters,
            JointTorqueRegressor,
            Vec<(usize, bool)>,
            usize,
        ),
    ) -> Self {
        let directions = kept.len() + beside;
        let zero = || vec![0.0; N * directions];
        Self {
            chain: Chain::new(robot, parameters),
            y: vec![0.0; N * regressor.cols()],
            y_of_terms: vec![0.0; N * regressor.cols()],
            regressor,
            state: State { q: [0.0; N], v: [0.0; N] },
            q: zero(),
            v: zero(),
            taken_q: zero(),
            taken_v: zero(),
            start_q: zero(),
            start_v: zero(),
            stage_q: zero(),
            stage_v: zero(),
            sum_q: zero(),
            sum_v: zero(),
            a: zero(),
            kept,
            directions,
        }
    }

    /// Accelerations at a state under `tau`, and in `a` their derivatives where those of the state are `stage_q` and `stage_v`.
    /// The rigid part is `taken`, of this state where `whole`.
    #[inline(always)]
    fn accelerate(
        &mut self,
        taken: &Taken<N, M>,
        at: &State<N, f64>,
        tau: &[f64; N],
        by: &[f64],
        whole: bool,
    ) -> [f64; N] {
        let friction = self.chain.forces.torque_and_slopes(&at.q, &at.v);
        // What the state changes in friction is not told apart from a change of torque.
        let (efforts, fixed) = (tau.map(BlockJet::fixed), friction.torque.map(BlockJet::fixed));
        let mut qdd = [0.0; N];
        let mut by_state = [[[0.0; BLOCK]; M]; N];
        for (block, rigid) in taken.rigid.iter().enumerate() {
            let found = rigid.accelerations(&efforts, &fixed);
            for i in 0..N {
                qdd[i] = found[i].value;
                by_state[i][block] = found[i].by;
            }
        }
        if !whole {
            qdd = taken.held.accelerations(&friction.torque);
        }
        self.regressor.evaluate(&taken.at.q, &taken.at.v, &qdd, &mut self.y);
        if !whole {
            self.regressor.evaluate(&at.q, &at.v, &qdd, &mut self.y_of_terms);
        }
        let (d, p) = (self.directions, self.regressor.cols());
        self.a.copy_from_slice(by);
        for i in 0..N {
            let own = &mut self.a[i * d..(i + 1) * d];
            for (a, &(column, of_term)) in own.iter_mut().zip(&self.kept) {
                let y = if of_term && !whole { &self.y_of_terms } else { &self.y };
                *a -= y[i * p + column];
            }
            add_products(own, -1.0, (&friction.by_q[i], &friction.by_v[i]), (&self.stage_q, &self.stage_v));
        }
        taken.rigid[0].factor.map(|jet| jet.value).solve_rows(&mut self.a, d);
        let (of_q, of_v) = if whole { (&self.stage_q, &self.stage_v) } else { (&self.taken_q, &self.taken_v) };
        for i in 0..N {
            let (by_q, by_v) = by_state[i].as_flattened()[..2 * N].split_at(N);
            add_products(&mut self.a[i * d..(i + 1) * d], 1.0, (by_q, by_v), (of_q, of_v));
        }
        qdd
    }

    /// One step of length `h`, by the midpoint rule where it is `to_middle`, else by Runge and Kutta's. The rigid part is taken anew at each
    /// stage where `whole`, else at the beginning where `new`. Written as a loop so that the recursion is compiled once.
    #[inline(always)]
    fn advance(
        &mut self,
        taken: &mut Taken<N, M>,
        (new, to_middle): (bool, bool),
        (tau, by): (&[f64; N], &[f64]),
        h: f64,
        whole: bool,
    ) {
        let start = self.state;
        let half = h * 0.5;
        let mut at = start;
        let mut stages = [([0.0; N], [0.0; N]); 4];
        self.stage_q.copy_from_slice(&self.q);
        self.stage_v.copy_from_slice(&self.v);
        self.sum_q.fill(0.0);
        self.sum_v.fill(0.0);
        // By how much the next stage is ahead, and six times the weight of the slope.
        let weighted = if to_middle {
            [(half, 0.0), (0.0, 6.0), (0.0, 0.0), (0.0, 0.0)]
        } else {
            [(half, 1.0), (half, 2.0), (h, 2.0), (0.0, 1.0)]
        };
        let last = if to_middle { 1 } else { 3 };
        for (stage, (ahead, weight)) in weighted.into_iter().take(last + 1).enumerate() {
            if whole {
                taken.at = at;
            }
            if whole || (new && stage == 0) {
                for block in 0..M {
                    let (mut q, mut v) = (taken.at.q.map(BlockJet::fixed), taken.at.v.map(BlockJet::fixed));
                    for (place, k) in (BLOCK * block..(2 * N).min(BLOCK * (block + 1))).enumerate() {
                        let number = if k < N { &mut q[k] } else { &mut v[k - N] };
                        number.by[place] = 1.0;
                    }
                    taken.rigid[block] = self.chain.rigid(&q, &v);
                }
                if !whole {
                    taken.held = Held::new(&taken.rigid[0].map(|jet| jet.value), tau);
                }
            }
            let a = self.accelerate(taken, &at, tau, by, whole);
            stages[stage] = (at.v, a);
            for k in 0..self.q.len() {
                self.sum_q[k] += weight * self.stage_v[k];
                self.sum_v[k] += weight * self.a[k];
            }
            if stage < last {
                at = State { q: along(&start.q, &at.v, ahead), v: along(&start.v, &a, ahead) };
                for k in 0..self.q.len() {
                    self.stage_q[k] = self.q[k] + ahead * self.stage_v[k];
                    self.stage_v[k] = self.v[k] + ahead * self.a[k];
                }
            }
        }
        self.state = if to_middle { after_middle(&start, &stages[1], h) } else { after(&start, &stages, h) };
        let sixth = h * (1.0 / 6.0);
        for k in 0..self.q.len() {
            self.q[k] += sixth * self.sum_q[k];
            self.v[k] += sixth * self.sum_v[k];
        }
    }

    /// One step, with the bits of the plant's.
    #[inline(always)]
    fn step(&mut self, tau: &[f64; N], by: &[f64], dt: f64) {
        let parts = integrator::parts_of_step(&self.chain, &self.state, tau, dt);
        let whole = parts == 1.0;
        let start = self.state;
        if !whole {
            self.start_q.copy_from_slice(&self.q);
            self.start_v.copy_from_slice(&self.v);
            self.taken_q.copy_from_slice(&self.q);
            self.taken_v.copy_from_slice(&self.v);
        }
        let nothing = Rigid::nothing(Jet::fixed(0.0));
        let held = Held::new(&nothing.map(|jet| jet.value), tau);
        let mut taken = Taken { rigid: [nothing; M], held, at: start };
        let to_middle = if whole { 0.0 } else { integrator::parts_to_middle(parts) };
        for (length, parts) in [(0.5 * dt, to_middle), (dt, parts)] {
            let mut done = 0.0;
            while done < parts {
                self.advance(&mut taken, (done == 0.0, length < dt), (tau, by), length / parts, whole);
                done += 1.0;
            }
            if !whole && length < dt {
                taken.at = self.state;
                self.taken_q.copy_from_slice(&self.q);
                self.taken_v.copy_from_slice(&self.v);
                self.state = start;
                self.q.copy_from_slice(&self.start_q);
                self.v.copy_from_slice(&self.start_v);
            }
        }
    }
}

/// Adds to `own`, of d numbers, `sign` times what changes of the state in d directions (n × d each) do to a number with derivatives by n
/// coordinates and n velocities.
#[inline(always)]
fn add_products(own: &mut [f64], sign: f64, by: (&[f64], &[f64]), (of_q, of_v): (&[f64], &[f64])) {
    let d = own.len();
    for (k, (by_q, by_v)) in by.0.iter().zip(by.1).enumerate() {
        let (by_q, by_v) = (sign * by_q, sign * by_v);
        let rows = of_q[k * d..(k + 1) * d].iter().zip(&of_v[k * d..(k + 1) * d]);
        for (own, (q, v)) in own.iter_mut().zip(rows) {
            *own += by_q * q + by_v * v;
        }
    }
}

/// One step, compiled for the processor's vectors; every lane does what it would do alone.
struct Step<'a, const N: usize, const M: usize> {
    arm: &'a mut Sloped<N, M>,
    tau: [f64; N],
    by: &'a [f64],
    dt: f64,
}

impl<const N: usize, const M: usize> WithSimd for Step<'_, N, M> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { arm, tau, by, dt } = self;
        arm.step(&tau, by, dt);
    }
}

impl<const N: usize, const M: usize> SlopedArm for Sloped<N, M> {
    fn reset(&mut self, q: &[f64]) {
        self.state = State { q: [0.0; N], v: [0.0; N] };
        self.state.q.copy_from_slice(q);
        self.q.fill(0.0);
        self.v.fill(0.0);
    }

    fn begin(&mut self, state: (&[f64], &[f64]), slopes: (&[f64], &[f64])) {
        self.state.q.copy_from_slice(state.0);
        self.state.v.copy_from_slice(state.1);
        self.q.copy_from_slice(slopes.0);
        self.v.copy_from_slice(slopes.1);
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.state.q, &self.state.v)
    }

    fn slopes(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.v)
    }

    fn step(&mut self, tau: &[f64], by: &[f64], dt: f64) -> Result<(), PlantError> {
        let mut held = [0.0; N];
        held.copy_from_slice(tau);
        // For the usual numbers of joints alone: each is compiled once for every width.
        if N == 6 || N == 7 {
            Arch::new().dispatch(Step { arm: self, tau: held, by, dt });
        } else {
            Self::step(self, &held, by, dt);
        }
        PlantError::of_state(&self.state.q, &self.state.v).map_or(Ok(()), Err)
    }
}
