//! The analytic arm with the derivatives of its state by some of its parameters: forward sensitivities.
//!
//! ```text
//! H(q) q̈ + … = Y(q, q̇, q̈) φ = τ        ∂q̈/∂φ_j = ∂q̈/∂q q'_j + ∂q̈/∂q̇ q̇'_j + H⁻¹ (τ'_j − Y_j)
//! ```
//! Propagated through every stage of the Runge–Kutta step, so that they are the derivatives of the simulation itself and not
//! of the equations that it approximates; the division of a step where friction is stiff is taken as given. Derivatives by the
//! state come from [`Jet`]s through the plant's own recursion, columns from the core's regressor.

use armid::experiment::{Plant, PlantError};
use armid::model::{Columns, ParameterId, Robot, StandardParameters};
use armid::regressor::JointTorqueRegressor;
use pulp::{Arch, Simd, WithSimd};

use super::chain::Chain;
use super::integrator::{self, State};
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
        found.ok_or_else(|| AnalyticError::Derivative { parameter: id.to_string() })
    };
    let kept: Vec<usize> = by.iter().map(column).collect::<Result<_, _>>()?;
    let spec = (robot, parameters, regressor, kept, beside);
    let arm: Box<dyn SlopedArm> = match dof {
        1 => Box::new(Sloped::<1, 2>::new(spec)),
        2 => Box::new(Sloped::<2, 4>::new(spec)),
        3 => Box::new(Sloped::<3, 6>::new(spec)),
        4 => Box::new(Sloped::<4, 8>::new(spec)),
        5 => Box::new(Sloped::<5, 10>::new(spec)),
        6 => Box::new(Sloped::<6, 12>::new(spec)),
        7 => Box::new(Sloped::<7, 14>::new(spec)),
        _ => Box::new(Sloped::<8, 16>::new(spec)),
    };
    Ok(arm)
}

/// N joints, K = 2 N numbers of state.
struct Sloped<const N: usize, const K: usize> {
    chain: Chain<N>,
    regressor: JointTorqueRegressor,
    kept: Vec<usize>,
    /// d.
    directions: usize,
    state: State<N, f64>,
    /// Derivatives of coordinates and velocities, N × d each.
    q: Vec<f64>,
    v: Vec<f64>,
    /// Those at the stage, and of the accelerations of all four.
    stage_q: Vec<f64>,
    stage_v: Vec<f64>,
    sum_q: Vec<f64>,
    sum_v: Vec<f64>,
    a: Vec<f64>,
    y: Vec<f64>,
}

impl<const N: usize, const K: usize> Sloped<N, K> {
    fn new(
        (robot, parameters, regressor, kept, beside): (
            &Robot,
            &StandardParameters,
            JointTorqueRegressor,
            Vec<usize>,
            usize,
        ),
    ) -> Self {
        let directions = kept.len() + beside;
        let zero = || vec![0.0; N * directions];
        Self {
            chain: Chain::new(robot, parameters),
            y: vec![0.0; N * regressor.cols()],
            regressor,
            state: State { q: [0.0; N], v: [0.0; N] },
            q: zero(),
            v: zero(),
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
    #[inline(always)]
    fn accelerate(&mut self, q: &[f64; N], v: &[f64; N], tau: &[f64; N], by: &[f64]) -> [f64; N] {
        let mut jets = ([Jet::<K>::fixed(0.0); N], [Jet::<K>::fixed(0.0); N], [Jet::<K>::fixed(0.0); N]);
        for i in 0..N {
            jets.0[i] = Jet::variable(q[i], i);
            jets.1[i] = Jet::variable(v[i], N + i);
            jets.2[i] = Jet::fixed(tau[i]);
        }
        let (found, factor) = self.chain.accelerate(&jets.0, &jets.1, &jets.2);
        let mut qdd = [0.0; N];
        for i in 0..N {
            qdd[i] = found[i].value;
        }
        self.regressor.evaluate(q, v, &qdd, &mut self.y);
        let (d, p) = (self.directions, self.regressor.cols());
        self.a.copy_from_slice(by);
        for i in 0..N {
            for (a, &column) in self.a[i * d..(i + 1) * d].iter_mut().zip(&self.kept) {
                *a -= self.y[i * p + column];
            }
        }
        factor.map(|jet| jet.value).solve_rows(&mut self.a, d);
        for i in 0..N {
            let own = &mut self.a[i * d..(i + 1) * d];
            for k in 0..N {
                let (of_q, of_v) = (found[i].by[k], found[i].by[N + k]);
                let rows = self.stage_q[k * d..(k + 1) * d].iter().zip(&self.stage_v[k * d..(k + 1) * d]);
                for (own, (q, v)) in own.iter_mut().zip(rows) {
                    *own += of_q * q + of_v * v;
                }
            }
        }
        qdd
    }

    /// One Runge–Kutta step of length `h`, with the bits of the plant's. Written as a loop so that the recursion is compiled once.
    #[inline(always)]
    fn advance(&mut self, tau: &[f64; N], by: &[f64], h: f64) {
        let start = self.state;
        let (half, sixth) = (h * 0.5, h * (1.0 / 6.0));
        let (mut q, mut v) = (start.q, start.v);
        let mut stages = [([0.0; N], [0.0; N]); 4];
        self.stage_q.copy_from_slice(&self.q);
        self.stage_v.copy_from_slice(&self.v);
        self.sum_q.fill(0.0);
        self.sum_v.fill(0.0);
        for (stage, ahead) in [half, half, h, 0.0].into_iter().enumerate() {
            let a = self.accelerate(&q, &v, tau, by);
            stages[stage] = (v, a);
            let weight = if stage == 1 || stage == 2 { 2.0 } else { 1.0 };
            for k in 0..self.q.len() {
                self.sum_q[k] += weight * self.stage_v[k];
                self.sum_v[k] += weight * self.a[k];
            }
            if stage < 3 {
                (q, v) = (moved(&start.q, &v, ahead), moved(&start.v, &a, ahead));
                for k in 0..self.q.len() {
                    self.stage_q[k] = self.q[k] + ahead * self.stage_v[k];
                    self.stage_v[k] = self.v[k] + ahead * self.a[k];
                }
            }
        }
        let [(v1, a1), (v2, a2), (v3, a3), (v4, a4)] = stages;
        for i in 0..N {
            self.state.q[i] = start.q[i] + sixth * (v1[i] + 2.0 * (v2[i] + v3[i]) + v4[i]);
            self.state.v[i] = start.v[i] + sixth * (a1[i] + 2.0 * (a2[i] + a3[i]) + a4[i]);
        }
        for k in 0..self.q.len() {
            self.q[k] += sixth * self.sum_q[k];
            self.v[k] += sixth * self.sum_v[k];
        }
    }

    /// One step: as many of those as the plant's has.
    #[inline(always)]
    fn step(&mut self, tau: &[f64; N], by: &[f64], dt: f64) {
        let parts = integrator::parts_of_step(&self.chain, &self.state, tau, dt);
        let h = dt / parts;
        let mut done = 0.0;
        while done < parts {
            self.advance(tau, by, h);
            done += 1.0;
        }
    }
}

#[inline(always)]
fn moved<const N: usize>(x: &[f64; N], slope: &[f64; N], h: f64) -> [f64; N] {
    let mut out = *x;
    for i in 0..N {
        out[i] = x[i] + h * slope[i];
    }
    out
}

/// One step, compiled for the processor's vectors; every lane does what it would do alone.
struct Step<'a, const N: usize, const K: usize> {
    arm: &'a mut Sloped<N, K>,
    tau: [f64; N],
    by: &'a [f64],
    dt: f64,
}

impl<const N: usize, const K: usize> WithSimd for Step<'_, N, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { arm, tau, by, dt } = self;
        arm.step(&tau, by, dt);
    }
}

impl<const N: usize, const K: usize> SlopedArm for Sloped<N, K> {
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
