//! Several runs of one arm that advance together, one per lane of the processor.

use std::marker::PhantomData;

use armid::experiment::PlantError;
use pulp::{Arch, Simd, WithSimd};

use super::chain::Chain;
use super::integrator::{self, State};
use super::plant::AnalyticPlant;
use armid::lanes::{MOST_LANES, Wide};

/// Several runs of the same arm: equal equations, states and torques of their own, one step for all.
///
/// Each run has the bits that an [`AnalyticPlant`] of its own would give, on any processor.
///
/// ```
/// use armid::conformance::chains;
/// use armid::experiment::Plant;
/// use armid::seed::Seed;
/// use armid_sim::AnalyticPlant;
/// let (robot, parameters) = chains::random_robot(&mut Seed::new(1).stream("doc", 0), 4);
/// let mut alone = AnalyticPlant::new(&robot, &parameters).unwrap();
/// let mut batch = alone.batch(3);
/// for run in 0..3 {
///     batch.reset(run, &[0.1 * run as f64; 4], &[0.0; 4]);
///     batch.push(run, &[1.0; 4]);
/// }
/// batch.step(1e-3);
/// alone.reset(&[0.2; 4], &[0.0; 4]);
/// alone.step(&[1.0; 4], 1e-3).unwrap();
/// assert_eq!(batch.state(2), alone.state());
/// ```
#[derive(Debug)]
pub struct AnalyticBatch {
    members: Box<dyn Members>,
    arch: Arch,
}

impl AnalyticPlant {
    /// `runs` copies of this arm in its present state, with no torque.
    pub fn batch(&self, runs: usize) -> AnalyticBatch {
        AnalyticBatch { members: self.members(runs), arch: Arch::new() }
    }
}

impl AnalyticBatch {
    /// Number of runs.
    pub fn runs(&self) -> usize {
        self.members.runs()
    }

    /// Joint coordinates and velocities of one run, n each.
    ///
    /// # Panics
    /// If there is no such run.
    pub fn state(&self, run: usize) -> (&[f64], &[f64]) {
        self.members.state(run)
    }

    /// Puts one run into a state.
    ///
    /// # Panics
    /// If there is no such run, or a slice has another length than n.
    pub fn reset(&mut self, run: usize, q: &[f64], qd: &[f64]) {
        self.members.reset(run, q, qd);
    }

    /// Sets the efforts on the joints of one run until they are set again, N·m (N), n.
    ///
    /// # Panics
    /// If there is no such run, or the slice has another length than n.
    pub fn push(&mut self, run: usize, tau: &[f64]) {
        self.members.push(run, tau);
    }

    /// Advances every run by `dt` seconds. A run whose state is no longer finite disturbs no other;
    /// [`AnalyticBatch::fault`] finds it.
    pub fn step(&mut self, dt: f64) {
        self.members.step(dt, self.arch);
    }

    /// What is wrong with the state of one run, if anything.
    pub fn fault(&self, run: usize) -> Option<PlantError> {
        let (q, qd) = self.state(run);
        PlantError::of_state(q, qd)
    }
}

/// A number of joints that is known when this is compiled, behind one that is not.
pub(super) trait Members: std::fmt::Debug + Send {
    fn runs(&self) -> usize;
    fn state(&self, run: usize) -> (&[f64], &[f64]);
    fn reset(&mut self, run: usize, q: &[f64], qd: &[f64]);
    fn push(&mut self, run: usize, tau: &[f64]);
    fn step(&mut self, dt: f64, arch: Arch);
}

#[derive(Debug)]
pub(super) struct Side<const N: usize, A> {
    chain: Chain<N>,
    q: Vec<[f64; N]>,
    v: Vec<[f64; N]>,
    tau: Vec<[f64; N]>,
    advance: PhantomData<fn() -> A>,
}

/// How the runs of a batch advance.
pub(super) trait Advance: std::fmt::Debug + 'static {
    /// One step of all runs.
    fn step<const N: usize>(side: &mut Side<N, Self>, dt: f64, arch: Arch)
    where
        Self: Sized;
}

/// Side by side on the lanes of the processor: compiled once for each width, so only for the usual numbers of joints.
#[derive(Debug)]
pub(super) struct OnLanes;

impl Advance for OnLanes {
    fn step<const N: usize>(side: &mut Side<N, Self>, dt: f64, arch: Arch) {
        arch.dispatch(Step { side, dt });
    }
}

/// One after the other.
#[derive(Debug)]
pub(super) struct InTurn;

impl Advance for InTurn {
    fn step<const N: usize>(side: &mut Side<N, Self>, dt: f64, _: Arch) {
        side.step_in_turn(dt);
    }
}

impl<const N: usize, A> Side<N, A> {
    fn step_in_turn(&mut self, dt: f64) {
        for ((q, v), tau) in self.q.iter_mut().zip(&mut self.v).zip(&self.tau) {
            let mut state = State { q: *q, v: *v };
            integrator::step_alone(&self.chain, &mut state, tau, dt);
            (*q, *v) = (state.q, state.v);
        }
    }

    pub(super) fn new(chain: &Chain<N>, state: &State<N, f64>, runs: usize) -> Self {
        let (q, v, tau) = (vec![state.q; runs], vec![state.v; runs], vec![[0.0; N]; runs]);
        Self { chain: chain.clone(), q, v, tau, advance: PhantomData }
    }
}

impl<const N: usize, A: Advance> Members for Side<N, A> {
    fn runs(&self) -> usize {
        self.q.len()
    }

    fn state(&self, run: usize) -> (&[f64], &[f64]) {
        (&self.q[run], &self.v[run])
    }

    fn reset(&mut self, run: usize, q: &[f64], qd: &[f64]) {
        self.q[run].copy_from_slice(q);
        self.v[run].copy_from_slice(qd);
    }

    fn push(&mut self, run: usize, tau: &[f64]) {
        self.tau[run].copy_from_slice(tau);
    }

    fn step(&mut self, dt: f64, arch: Arch) {
        A::step(self, dt, arch);
    }
}

/// One step of all runs on lanes of a width that is found out when the program runs.
struct Step<'a, const N: usize> {
    side: &'a mut Side<N, OnLanes>,
    dt: f64,
}

/// One number of each of a chunk's runs; lanes beyond the last run repeat it.
#[inline(always)]
fn load<const N: usize, S: Simd>(simd: S, runs: &[[f64; N]], first: usize) -> [Wide<S>; N] {
    let mut out = [Wide::new(simd, simd.splat_f64s(0.0)); N];
    let mut lanes = [0.0; MOST_LANES];
    for i in 0..N {
        for l in 0..S::F64_LANES {
            lanes[l] = runs[(first + l).min(runs.len() - 1)][i];
        }
        out[i] = Wide::new(simd, S::as_simd_f64s(&lanes).0[0]);
    }
    out
}

#[inline(always)]
fn store<const N: usize, S: Simd>(wide: &[Wide<S>; N], runs: &mut [[f64; N]], first: usize) {
    let mut lanes = [0.0; MOST_LANES];
    let last = runs.len().min(first + S::F64_LANES);
    for i in 0..N {
        S::as_mut_simd_f64s(&mut lanes).0[0] = wide[i].x;
        for run in first..last {
            runs[run][i] = lanes[run - first];
        }
    }
}

impl<const N: usize> WithSimd for Step<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { side, dt } = self;
        if S::F64_LANES == 1 {
            side.step_in_turn(dt);
            return;
        }
        let mut first = 0;
        while first < side.q.len() {
            let mut y = State { q: load(simd, &side.q, first), v: load(simd, &side.v, first) };
            let tau = load(simd, &side.tau, first);
            integrator::step(&side.chain, &mut y, &tau, dt);
            store(&y.q, &mut side.q, first);
            store(&y.v, &mut side.v, first);
            first += S::F64_LANES;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use armid::conformance::chains::{self, ChainRecipe};
    use armid::experiment::Plant;
    use armid::model::StandardParameters;
    use armid::seed::Seed;

    fn widths() -> Vec<Arch> {
        let mut widths = vec![Arch::Scalar, Arch::new()];
        #[cfg(target_arch = "x86_64")]
        widths.extend(pulp::x86::V3::try_new().map(Arch::V3));
        widths
    }

    #[test]
    fn identity_a_run_has_the_same_bits_alone_and_beside_others_on_any_width() {
        for run in 0..7 {
            let mut rng = Seed::new(9).stream("chains", run);
            let dof = 1 + run as usize;
            let recipe = ChainRecipe { coupled: run % 2 == 0, tilted: true, ..ChainRecipe::new(dof) };
            let (robot, parameters): (_, StandardParameters) = recipe.draw(&mut rng);
            let mut alone = AnalyticPlant::new(&robot, &parameters).unwrap();
            // Eleven runs fill no width; some are slow, where friction divides steps, and one is lost.
            let states: Vec<_> = (0..11)
                .map(|k| {
                    let (q, mut qd, tau) = chains::random_state(&mut rng, dof);
                    qd.iter_mut().for_each(|v| *v *= if k % 3 == 0 { 0.01 } else { 1.0 });
                    (q, qd, tau)
                })
                .collect();
            for arch in widths() {
                let mut batch = alone.batch(states.len());
                batch.arch = arch;
                for (k, (q, qd, tau)) in states.iter().enumerate() {
                    batch.reset(k, q, qd);
                    batch.push(k, tau);
                }
                batch.reset(4, &vec![f64::NAN; dof], &vec![0.0; dof]);
                for _ in 0..50 {
                    batch.step(1e-3);
                }
                assert!(batch.fault(4).is_some());
                for (k, (q, qd, tau)) in states.iter().enumerate().filter(|(k, _)| *k != 4) {
                    alone.reset(q, qd);
                    for _ in 0..50 {
                        alone.step(tau, 1e-3).unwrap();
                    }
                    assert_eq!(batch.state(k), alone.state(), "chain {run}, run {k}, {arch:?}");
                }
            }
        }
    }
}
