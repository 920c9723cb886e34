//! Several experiments of one arm, servo step by servo step together.

use std::ops::Range;
use std::sync::Arc;

use super::arm::{Ending, Sink};
use super::command_table::CommandTable;
use super::cycle::{Cycle, Next, Timing};
use super::joint_loops::{JointLoops, Runs};
use super::plant::PlantError;
use crate::lanes::MOST_LANES;

/// Up to eight experiments of one servo that begin together, each with the bits that it has alone.
///
/// States of the plants are one [`Runs`] for each joint. The servos of a plain arm stand side by side on the lanes of the
/// processor; where motors are coupled, or drives and sensors have effects, they step one by one.
#[derive(Debug)]
pub struct CycleGroup {
    members: Vec<Member>,
    loops: Option<JointLoops>,
    /// The commands of all runs, where they are one table.
    shared: Option<Arc<CommandTable>>,
    /// Rows of n, for what is said of one run.
    rows: [Vec<f64>; 2],
}

#[derive(Debug)]
struct Member {
    place: usize,
    cycle: Cycle,
    ending: Option<Ending>,
    /// Whether the step that is taken has a sample.
    due: bool,
}

/// The lanes of a run: its own, and of the last one those that are left.
fn lanes(run: usize, runs: usize) -> Range<usize> {
    run..if run + 1 == runs { MOST_LANES } else { run + 1 }
}

/// Numbers that are looked at together. Lanes beyond the runs hold none, so most of them are left out.
const TOGETHER: usize = 8;

/// What some runs have of each joint, a few at a time.
fn parts(joint: &Runs, runs: usize) -> &[[f64; TOGETHER]] {
    &joint.as_chunks().0[..runs.div_ceil(TOGETHER)]
}

/// Whether all numbers of some runs are.
fn all_finite(joints: &[Runs], runs: usize) -> bool {
    let parts = joints.iter().flat_map(|joint| parts(joint, runs));
    parts.fold(true, |finite, part| part.iter().fold(finite, |finite, x| finite & x.is_finite()))
}

/// Whether no joint of some runs is faster than its limit.
fn all_slow(qd: &[Runs], runs: usize, limits: &[f64]) -> bool {
    // Differences, so that lanes are compared as vectors. One that is no number is found by the other test.
    let mut most = [0.0; TOGETHER];
    for (joint, limit) in qd.iter().zip(limits) {
        for part in parts(joint, runs) {
            for (most, qd) in most.iter_mut().zip(part) {
                let excess = qd.abs() - limit;
                *most = if excess > *most { excess } else { *most };
            }
        }
    }
    most == [0.0; TOGETHER] && all_finite(qd, runs)
}

impl CycleGroup {
    /// These experiments of one servo, none of which has begun, each with the place of its sink.
    ///
    /// # Panics
    /// If there is none, or more than a group has lanes.
    pub fn new(cycles: Vec<(usize, Cycle)>) -> Self {
        assert!((1..=MOST_LANES).contains(&cycles.len()), "one to {MOST_LANES} experiments, not {}", cycles.len());
        let loops = JointLoops::new(&cycles.iter().map(|(_, cycle)| &cycle.joints).collect::<Vec<_>>());
        let (row, Timing { table, .. }) = (vec![0.0; cycles[0].1.start().len()], &cycles[0].1.timing);
        // None has begun, so that they are commanded alike as long as they go on.
        let is_shared =
            cycles.iter().all(|(_, cycle)| Arc::ptr_eq(&cycle.timing.table, table) && cycle.place.step == 0);
        let shared = is_shared.then(|| Arc::clone(table));
        let member = |(place, cycle)| Member { place, cycle, ending: None, due: false };
        Self { members: cycles.into_iter().map(member).collect(), loops, shared, rows: [row.clone(), row] }
    }

    /// Length of a servo step, s.
    pub fn dt(&self) -> f64 {
        self.members[0].cycle.dt()
    }

    /// Steps of the plants in a servo step, of equal length: one, unless effects of the drives need more.
    pub fn parts(&self) -> usize {
        self.members[0].cycle.parts()
    }

    /// Where each plant must be at rest when the experiments begin, n.
    pub fn starts(&self) -> impl Iterator<Item = &[f64]> {
        self.members.iter().map(|member| member.cycle.start())
    }

    /// One servo step of every experiment that goes on, as [`Cycle::advance`]; returns whether one does. Coordinates and velocities of
    /// the joints in, efforts on them out.
    pub fn advance<S: Sink>(&mut self, q: &[Runs], qd: &[Runs], tau: &mut [Runs], sinks: &mut [S]) -> bool {
        let Self { members, loops, shared, rows } = self;
        let step = going(members).next().map(|(_, member)| member.cycle.place.step);
        let shared = shared.as_deref().zip(step).map(|(table, step)| table.row(step));
        match loops {
            Some(loops) => {
                begin_step(members, loops, shared, (q, qd), rows);
                loops.step(q, qd, tau);
                finish_step(members, loops, shared, rows, sinks);
            }
            None => {
                for (run, member) in going(members) {
                    let [q, qd] = states(run, (q, qd), rows);
                    if let Next::End(ending) = member.cycle.advance(q, qd, &mut sinks[member.place], &mut |_| {}) {
                        member.ending = Some(ending);
                    }
                }
            }
        }
        going(members).next().is_some()
    }

    /// Decides the efforts for the next of [`CycleGroup::parts`] steps of the plants, as [`Cycle::push`].
    pub fn push(&mut self, q: &[Runs], qd: &[Runs], tau: &mut [Runs]) {
        if self.loops.is_some() {
            return;
        }
        let runs = self.members.len();
        for (run, member) in going(&mut self.members) {
            let [q, qd] = states(run, (q, qd), &mut self.rows);
            member.cycle.push(q, qd);
            for (joint, tau) in tau.iter_mut().zip(member.cycle.tau()) {
                joint[lanes(run, runs)].fill(*tau);
            }
        }
    }

    /// Ends every experiment whose plant is no longer at a finite state.
    pub fn check(&mut self, q: &[Runs], qd: &[Runs]) {
        let runs = self.members.len();
        if all_finite(q, runs) && all_finite(qd, runs) {
            return;
        }
        for (run, member) in going(&mut self.members) {
            let [q, qd] = states(run, (q, qd), &mut self.rows);
            member.ending = PlantError::of_state(q, qd).map(|fault| member.cycle.fail(fault));
        }
    }

    /// How the experiments ended, with their places; none of one that goes on.
    pub fn into_endings(self) -> impl Iterator<Item = (usize, Ending)> {
        self.members.into_iter().filter_map(|member| Some((member.place, member.ending?)))
    }
}

/// Commands and noise of a step of all runs that go on; some end instead. `shared` is what all are commanded, if that is one thing.
fn begin_step(
    members: &mut [Member],
    loops: &mut JointLoops,
    shared: Option<&[f64]>,
    (q, qd): (&[Runs], &[Runs]),
    rows: &mut [Vec<f64>; 2],
) {
    let runs = members.len();
    if let Some(command) = shared {
        loops.command(0..MOST_LANES, command);
    }
    let calm = all_finite(q, runs) && all_slow(qd, runs, &members[0].cycle.runaway);
    for (run, Member { cycle, ending, due, .. }) in going(members) {
        match cycle.place.begin(&cycle.timing) {
            None => *ending = Some(cycle.end(Ending::Completed)),
            Some(now) => *due = now,
        }
        if !calm && ending.is_none() {
            let [q, qd] = states(run, (q, qd), rows);
            *ending = cycle.runaway(q, qd);
        }
        if ending.is_some() {
            continue;
        }
        if shared.is_none() {
            loops.command(lanes(run, runs), cycle.place.command(&cycle.timing));
        }
        loops.draw_noise(run, &mut cycle.joints.sensors, *due);
    }
}

/// Hands the samples of a step on.
fn finish_step<S: Sink>(
    members: &mut [Member],
    loops: &JointLoops,
    shared: Option<&[f64]>,
    rows: &mut [Vec<f64>; 2],
    sinks: &mut [S],
) {
    for (run, Member { cycle, ending, due, place }) in going(members) {
        let [q, effort] = rows;
        if *due {
            loops.read(run, q, effort);
        }
        let reported = due.then_some([&q[..], &effort[..], &[], &[]]);
        let command = shared.unwrap_or_else(|| cycle.place.command(&cycle.timing));
        let stopped = cycle.place.finish(&cycle.timing, command, reported, &mut sinks[*place]);
        *ending = stopped.map(|stopped| cycle.end(stopped));
    }
}

/// Those that go on, with their lanes.
fn going(members: &mut [Member]) -> impl Iterator<Item = (usize, &mut Member)> {
    members.iter_mut().enumerate().filter(|(_, member)| member.ending.is_none())
}

/// Coordinates and velocities of one run, n each.
fn states<'a>(run: usize, (q, qd): (&[Runs], &[Runs]), rows: &'a mut [Vec<f64>; 2]) -> [&'a [f64]; 2] {
    for (row, joints) in rows.iter_mut().zip([q, qd]) {
        row.iter_mut().zip(joints).for_each(|(x, joint)| *x = joint[run]);
    }
    let [q, qd] = rows;
    [q, qd]
}

#[cfg(test)]
mod tests {
    use pulp::Arch;

    use super::*;
    use crate::experiment::hinges::{self, FlyWheels};
    use crate::experiment::{ExperimentPlan, Flow, Plant, RawSample, Recording, Sensing, Servo};
    use crate::model::{Drive, EffortInterface, MotorCircuit, Robot};
    use crate::seed::Seed;

    /// Keeps what is reported, and stops the arm after so many samples.
    #[derive(Default)]
    struct Until {
        said: Vec<f64>,
        samples: usize,
        most: usize,
    }

    impl Sink for Until {
        fn begin(&mut self, _: &Recording) {}

        fn sample(&mut self, sample: &RawSample<'_>) -> Flow {
            self.said.extend([sample.q, sample.effort, sample.command].concat());
            self.samples += 1;
            if self.samples == self.most { Flow::Stop } else { Flow::Continue }
        }
    }

    /// What becomes of a run: its plan, after how many samples its sink stops, and what its plant is after 300 steps.
    struct Fate {
        plan: ExperimentPlan,
        most: usize,
        disturbed: Option<(f64, f64)>,
    }

    fn fates(dof: usize) -> Vec<Fate> {
        let plan =
            ExperimentPlan { settle_s: 0.1, ramp_s: 0.3, periods: 1, ..ExperimentPlan::new(hinges::trajectory(dof)) };
        let longer = plan.clone().with_periods(2);
        let fate = |plan: &ExperimentPlan, most, disturbed| Fate { plan: plan.clone(), most, disturbed };
        vec![
            fate(&plan, usize::MAX, None),
            fate(&longer, usize::MAX, None),
            fate(&plan, 700, None),
            fate(&plan, usize::MAX, Some((f64::NAN, 0.0))),
            fate(&longer, usize::MAX, Some((0.0, 1e9))),
            fate(&plan, usize::MAX, Some((0.0, f64::INFINITY))),
        ]
    }

    fn step(plant: &mut FlyWheels, tau: &[f64], dt: f64, count: usize, fate: &Fate) -> Option<PlantError> {
        let _ = plant.step(tau, dt);
        if let (300, Some((q, qd))) = (count, fate.disturbed) {
            plant.reset(&vec![q; tau.len()], &vec![qd; tau.len()]);
        }
        PlantError::of_state(plant.state().0, plant.state().1)
    }

    fn alone(mut cycle: Cycle, fate: &Fate, dof: usize) -> (Vec<f64>, Ending) {
        let (mut plant, mut sink) = (FlyWheels::new(dof), Until { most: fate.most, ..Until::default() });
        plant.reset(cycle.start(), &vec![0.0; dof]);
        for count in 0.. {
            let (q, qd) = plant.state();
            if let Next::End(ending) = cycle.advance(q, qd, &mut sink, &mut |_| {}) {
                return (sink.said, ending);
            }
            cycle.push(plant.state().0, plant.state().1);
            if let Some(fault) = step(&mut plant, cycle.tau(), cycle.dt(), count, fate) {
                return (sink.said, cycle.fail(fault));
            }
        }
        unreachable!("an experiment ends")
    }

    fn together(cycles: Vec<Cycle>, fates: &[Fate], dof: usize, arch: Arch) -> Vec<(Vec<f64>, Ending)> {
        let mut sinks: Vec<Until> = fates.iter().map(|fate| Until { most: fate.most, ..Until::default() }).collect();
        let mut group = CycleGroup::new(cycles.into_iter().enumerate().collect());
        assert_eq!(group.loops.is_some(), group.members[0].cycle.joints.transmission.forward.is_none());
        if let Some(loops) = &mut group.loops {
            loops.arch = arch;
        }
        let mut plants: Vec<FlyWheels> = group
            .starts()
            .map(|start| {
                let mut plant = FlyWheels::new(dof);
                plant.reset(start, &vec![0.0; dof]);
                plant
            })
            .collect();
        let [mut q, mut qd, mut tau] = [(); 3].map(|()| vec![[0.0; MOST_LANES]; dof]);
        for count in 0.. {
            for lane in 0..MOST_LANES {
                let (of_q, of_qd) = plants[lane.min(plants.len() - 1)].state();
                for i in 0..dof {
                    (q[i][lane], qd[i][lane]) = (of_q[i], of_qd[i]);
                }
            }
            group.check(&q, &qd);
            if !group.advance(&q, &qd, &mut tau, &mut sinks) {
                break;
            }
            group.push(&q, &qd, &mut tau);
            for (run, (plant, fate)) in plants.iter_mut().zip(fates).enumerate() {
                let of_run: Vec<f64> = tau.iter().map(|joint| joint[run]).collect();
                step(plant, &of_run, group.dt(), count, fate);
            }
        }
        group.into_endings().map(|(place, ending)| (std::mem::take(&mut sinks[place].said), ending)).collect()
    }

    fn check(robot: &Robot, sensing: &Sensing, supply: Option<f64>) {
        let dof = robot.dof();
        let circuit =
            |supply| MotorCircuit { resistance: 1.5, inductance: 0.0, back_emf: 0.15, brush_drop: 1.0, supply };
        let motor = |drive: &Drive| Drive { circuit: supply.map(circuit), ..drive.clone() };
        let motors = robot.joints().iter().map(|joint| motor(&joint.drive)).collect();
        let servo = Servo::new(robot, &hinges::parameters(dof), FlyWheels::new(dof)).unwrap();
        let servo = servo.with_sensing(sensing.clone()).with_motors(motors);
        let fates = fates(dof);
        let streams: Vec<_> = (0..).map(|run| Seed::new(3).of_run(run)).take(fates.len()).collect();
        let of_plans =
            fates.iter().zip(&streams).flat_map(|(fate, &of_run)| servo.cycles(&fate.plan, &[of_run]).unwrap());
        // With plans of their own, and with one whose commands they share.
        for cycles in [of_plans.collect(), servo.cycles(&fates[0].plan, &streams).unwrap()] {
            compare(robot, &cycles, &fates, dof);
        }
    }

    fn compare(robot: &Robot, cycles: &[Cycle], fates: &[Fate], dof: usize) {
        let expected: Vec<_> = cycles.iter().zip(fates).map(|(cycle, fate)| alone(cycle.clone(), fate, dof)).collect();
        assert!(expected.iter().all(|(said, _)| !said.is_empty()));
        let mut widths = vec![Arch::Scalar, Arch::new()];
        #[cfg(target_arch = "x86_64")]
        widths.extend(pulp::x86::V3::try_new().map(Arch::V3));
        for arch in widths {
            let found = together(cycles.to_vec(), fates, dof, arch);
            assert!(found.iter().map(|run| &run.0).eq(expected.iter().map(|run| &run.0)), "{}, {arch:?}", robot.name());
            // As text, since a velocity that is no number equals nothing.
            let ending =
                |runs: &[(Vec<f64>, Ending)]| format!("{:?}", runs.iter().map(|run| &run.1).collect::<Vec<_>>());
            assert_eq!(ending(&found), ending(&expected));
        }
    }

    #[test]
    fn identity_each_run_has_the_bits_and_the_ending_that_it_has_alone_on_any_width() {
        let coupled = hinges::coupled();
        let plain = coupled.clone().with_spec(|spec| spec.coupling = None).unwrap();
        let noisy = Sensing { position_noise: vec![1e-5, 0.0], ..Sensing::default() };
        for effort in EffortInterface::ALL {
            let robot = |of: &Robot| of.clone().with_spec(|spec| spec.effort = effort).unwrap();
            check(&robot(&plain), &noisy, None);
            check(&robot(&coupled), &noisy, None);
        }
        check(&plain, &Sensing::ideal(), None);
        // 10 V turn the motor at 60 rad/s, the motion needs up to 100; 70 V are enough.
        check(&plain, &Sensing::default(), Some(10.0));
        check(&plain, &Sensing::default(), Some(70.0));
    }
}
