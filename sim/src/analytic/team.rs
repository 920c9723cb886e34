//! Several runs of one arm that advance together, one per lane of the processor.

use std::any::Any;
use std::marker::PhantomData;
use std::ops::Range;

use armid::experiment::{PlantError, Runs};
use pulp::{Arch, Simd, WithSimd};

use super::chain::Chain;
use super::integrator::{self, State, Workspace};
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
/// let (q, qd) = batch.state(2);
/// assert_eq!((&q[..], &qd[..]), alone.state());
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
    pub fn state(&self, run: usize) -> (Vec<f64>, Vec<f64>) {
        assert!(run < self.runs(), "run {run} of {}", self.runs());
        let (q, qd, _) = self.members.group(run / MOST_LANES);
        let of_run = |joints: &[Runs]| joints.iter().map(|joint| joint[run % MOST_LANES]).collect();
        (of_run(q), of_run(qd))
    }

    /// Coordinates, velocities and efforts of the joints of [`MOST_LANES`] runs, n each. What stands beyond the last run means nothing.
    ///
    /// # Panics
    /// If there is no such group.
    pub fn group(&self, group: usize) -> (&[Runs], &[Runs], &[Runs]) {
        self.members.group(group)
    }

    /// The same, with efforts that can be set.
    ///
    /// # Panics
    /// If there is no such group.
    pub fn group_mut(&mut self, group: usize) -> (&[Runs], &[Runs], &mut [Runs]) {
        self.members.group_mut(group)
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
        PlantError::of_state(&q, &qd)
    }
}

/// A number of joints that is known when this is compiled, behind one that is not.
pub(super) trait Members: std::fmt::Debug + Send {
    fn runs(&self) -> usize;
    fn group(&self, group: usize) -> (&[Runs], &[Runs], &[Runs]);
    fn group_mut(&mut self, group: usize) -> (&[Runs], &[Runs], &mut [Runs]);
    fn reset(&mut self, run: usize, q: &[f64], qd: &[f64]);
    fn push(&mut self, run: usize, tau: &[f64]);
    fn step(&mut self, dt: f64, arch: Arch);
}

/// As many runs as lanes, joint by joint, aligned to lines of the cache.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Group<const N: usize> {
    q: [Runs; N],
    v: [Runs; N],
    tau: [Runs; N],
}

#[derive(Debug)]
pub(super) struct Side<const N: usize, A> {
    chain: Chain<N>,
    runs: usize,
    groups: Vec<Group<N>>,
    /// A [`Workspace`] of the processor's lanes: how many they are is found out when the program runs.
    workspace: Option<Box<dyn Any + Send>>,
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
        let mut workspace = Workspace::nothing(0.0);
        for run in 0..self.runs {
            let (lanes, lane) = (self.lanes(run), run % MOST_LANES);
            let group = &mut self.groups[run / MOST_LANES];
            let of_run = |joints: &[Runs; N]| std::array::from_fn(|i| joints[i][lane]);
            let mut state = State { q: of_run(&group.q), v: of_run(&group.v) };
            integrator::step_alone(&self.chain, &mut state, &of_run(&group.tau), dt, &mut workspace);
            for lane in lanes {
                for i in 0..N {
                    (group.q[i][lane], group.v[i][lane]) = (state.q[i], state.v[i]);
                }
            }
        }
    }

    pub(super) fn new(chain: &Chain<N>, state: &State<N, f64>, runs: usize) -> Self {
        let of_all = |joints: [f64; N]| joints.map(|x| [x; MOST_LANES]);
        let group = Group { q: of_all(state.q), v: of_all(state.v), tau: [[0.0; MOST_LANES]; N] };
        Self {
            chain: chain.clone(),
            runs,
            groups: vec![group; runs.div_ceil(MOST_LANES)],
            workspace: None,
            advance: PhantomData,
        }
    }

    /// The lanes of a run: its own, and of the last one those that are left.
    fn lanes(&self, run: usize) -> Range<usize> {
        assert!(run < self.runs, "run {run} of {}", self.runs);
        let lane = run % MOST_LANES;
        lane..if run + 1 == self.runs { MOST_LANES } else { lane + 1 }
    }
}

impl<const N: usize, A: Advance> Members for Side<N, A> {
    fn runs(&self) -> usize {
        self.runs
    }

    fn group(&self, group: usize) -> (&[Runs], &[Runs], &[Runs]) {
        let Group { q, v, tau } = &self.groups[group];
        (q, v, tau)
    }

    fn group_mut(&mut self, group: usize) -> (&[Runs], &[Runs], &mut [Runs]) {
        let Group { q, v, tau } = &mut self.groups[group];
        (q, v, tau)
    }

    fn reset(&mut self, run: usize, q: &[f64], qd: &[f64]) {
        assert!(q.len() == N && qd.len() == N, "{N} coordinates and velocities");
        let lanes = self.lanes(run);
        let group = &mut self.groups[run / MOST_LANES];
        for i in 0..N {
            group.q[i][lanes.clone()].fill(q[i]);
            group.v[i][lanes.clone()].fill(qd[i]);
        }
    }

    fn push(&mut self, run: usize, tau: &[f64]) {
        assert_eq!(tau.len(), N, "one effort for each joint");
        let lanes = self.lanes(run);
        let group = &mut self.groups[run / MOST_LANES];
        for i in 0..N {
            group.tau[i][lanes.clone()].fill(tau[i]);
        }
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

/// One number of each of the runs that fill the lanes of this processor, the first of them at a multiple of their number.
#[inline(always)]
fn load<const N: usize, S: Simd>(simd: S, joints: &[Runs; N], first: usize) -> [Wide<S>; N] {
    let mut out = [Wide::new(simd, simd.splat_f64s(0.0)); N];
    for i in 0..N {
        out[i] = Wide::new(simd, S::as_simd_f64s(&joints[i]).0[first / S::F64_LANES]);
    }
    out
}

#[inline(always)]
fn store<const N: usize, S: Simd>(wide: &[Wide<S>; N], joints: &mut [Runs; N], first: usize) {
    for i in 0..N {
        S::as_mut_simd_f64s(&mut joints[i]).0[first / S::F64_LANES] = wide[i].x;
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
        // That of the last step, unless another width of lanes took it.
        if !side.workspace.as_ref().is_some_and(|workspace| workspace.is::<Workspace<N, Wide<S>>>()) {
            let zero = Wide::new(simd, simd.splat_f64s(0.0));
            side.workspace = Some(Box::new(Workspace::<N, Wide<S>>::nothing(zero)));
        }
        let workspace = side.workspace.as_mut().and_then(|workspace| workspace.downcast_mut());
        let workspace = workspace.expect("it was just made for these lanes");
        let mut first = 0;
        while first < side.runs {
            let (group, lane) = (&mut side.groups[first / MOST_LANES], first % MOST_LANES);
            let mut y = State { q: load(simd, &group.q, lane), v: load(simd, &group.v, lane) };
            let tau = load(simd, &group.tau, lane);
            integrator::step(&side.chain, &mut y, &tau, dt, workspace);
            store(&y.q, &mut group.q, lane);
            store(&y.v, &mut group.v, lane);
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
                    let (q, qd) = batch.state(k);
                    assert_eq!((&q[..], &qd[..]), alone.state(), "chain {run}, run {k}, {arch:?}");
                }
            }
        }
    }
}
