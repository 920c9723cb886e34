//! Times the way from states to estimates on one core: `cargo bench --bench identification [-- --states FILE | --aperiodic]`.
//!
//! Without a file: per-sample times of the stacked regressor at several lengths, of 10,000 samples of the CRS A460 to ordinary
//! and weighted estimates with intervals, and of a record of 10⁶ samples without a period, with the memory it took (that alone with
//! `--aperiodic`). With one
//! (little-endian f64: q, q̇, q̈, τ of every sample, n each) it identifies the rigid base parameters from it and prints seconds
//! and parameters as JSON, for `benches/peers/identification.py`.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

use armid::base::{BaseReduction, Method, reduce};
use armid::conformance::chains;
use armid::dynamics::{Dynamics, States};
use armid::estimation::{Estimate, EstimatorKind, Identification, Observation};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, EffortInterface, Robot, StandardParameters, bundled};
use armid::observer::Unobserved;
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use armid::signal::{AperiodicRecord, Processing, Samples, process_aperiodic};
use armid::study::radkhah2007::table_one;
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};

fn a460() -> (Robot, StandardParameters) {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("a bundled robot");
    let robot = parse_robot(entry.robot).expect("a bundled robot is valid");
    let nominal = parse_nominal(entry.nominal, &robot).expect("bundled parameters are valid").parameters;
    (robot, nominal)
}

/// The fastest of `repeats`, s.
fn best<T>(repeats: usize, mut run: impl FnMut() -> T) -> f64 {
    let once = |_| {
        let began = Instant::now();
        black_box(run());
        began.elapsed().as_secs_f64()
    };
    (0..repeats).map(once).fold(f64::INFINITY, f64::min)
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|argument| argument == "--states") {
        Some(at) => from_file(arguments.get(at + 1).expect("a file after --states")),
        None if arguments.iter().any(|argument| argument == "--aperiodic") => {
            let (robot, nominal) = a460();
            aperiodic(&robot, &nominal);
        }
        None => alone(),
    }
}

fn estimates(identification: &Identification, samples: &Samples) -> Vec<Estimate> {
    let estimators = [EstimatorKind::Ols.estimator(), EstimatorKind::Wls.estimator()];
    identification.estimate_watched(samples, &estimators, &Unobserved).expect("the motion excites all")
}

fn from_file(path: &str) {
    let (robot, _) = a460();
    let n = robot.dof();
    let bytes = std::fs::read(path).expect("a readable file");
    let numbers: Vec<f64> = bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    let (mut states, mut tau) = (States::new(n), Vec::new());
    for sample in numbers.chunks_exact(4 * n) {
        states.push(&sample[..n], &sample[n..2 * n], &sample[2 * n..3 * n]);
        tau.extend_from_slice(&sample[3 * n..]);
    }
    let samples = Samples::exact(states, tau, vec!["N·m".to_owned(); n], 100.0);
    let identification = Identification::new(&robot, Columns::RIGID).expect("a bundled robot has a base");
    let seconds = best(5, || estimates(&identification, &samples));
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID).expect("columns of motion");
    let stack = best(5, || regressor.stack_means(&samples.states, &identification.base().kept, 1));
    let found = estimates(&identification, &samples);
    let list = |of: &[f64]| of.iter().map(|x| format!("{x:e}")).collect::<Vec<_>>().join(", ");
    let of = |estimate: &Estimate| {
        let (beta, std) = (estimate.beta(), estimate.std());
        format!("{{\"beta\": [{}], \"std\": [{}]}}", list(beta.as_slice()), list(std.as_slice()))
    };
    let names = identification.base().names().join("\", \"");
    println!(
        "{{\"seconds\": {seconds:e}, \"stack_seconds\": {stack:e}, \"names\": [\"{names}\"], \"ols\": {}, \"wls\": {}}}",
        of(&found[0]),
        of(&found[1])
    );
}

/// `count` random states with torque of the nominal parameters and noise.
fn noisy(robot: &Robot, nominal: &StandardParameters, count: usize, rng: &mut impl Rng) -> Samples {
    let n = robot.dof();
    let (mut states, mut tau) = (States::new(n), vec![0.0; n * count]);
    let mut dynamics = Dynamics::new(robot, nominal);
    for tau in tau.chunks_exact_mut(n) {
        let (q, qd, qdd) = chains::random_state(rng, n);
        dynamics.inverse(&q, &qd, &qdd, tau);
        for tau in tau {
            let z: f64 = StandardNormal.sample(rng);
            *tau += z;
        }
        states.push(&q, &qd, &qdd);
    }
    Samples::exact(states, tau, vec!["N·m".to_owned(); n], 100.0)
}

fn alone() {
    let (robot, nominal) = a460();
    let mut rng = Seed::new(1).stream("identification bench", 0);
    for columns in [Columns::RIGID, Columns::RIGID_ROTOR_FRICTION] {
        let base: BaseReduction =
            reduce(&robot, columns, Method::Structural, Seed::new(0)).expect("a bundled robot has a base");
        let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
        for count in [200, 1000, 10_000] {
            let samples = noisy(&robot, &nominal, count, &mut rng);
            let all = best(20, || regressor.stack(&samples.states)) / count as f64;
            let kept = best(20, || regressor.stack_means(&samples.states, &base.kept, 1)) / count as f64;
            let ones = vec![1.0; robot.dof()];
            let gram =
                best(20, || regressor.gram(samples.states.arrays(), &base.kept, &samples.tau, &ones)) / count as f64;
            println!(
                "{columns}: stack of {count} samples, per sample: {:.0} ns all {} columns, {:.0} ns the {} of the base, \
                 {:.0} ns their normal equations",
                all * 1e9,
                regressor.cols(),
                kept * 1e9,
                base.rank(),
                gram * 1e9
            );
        }
        let identification = Identification::new(&robot, columns).expect("a bundled robot has a base");
        let samples = noisy(&robot, &nominal, 10_000, &mut rng);
        let observation = Observation::new(&robot, &regressor, &base, &samples).expect("they belong together");
        let factor = best(5, || armid::estimation::Factorisation::new(&observation).expect("finite numbers"));
        let whole = best(5, || estimates(&identification, &samples));
        println!(
            "{columns}: 10,000 samples, {} parameters: stack, OLS and WLS with intervals {:.1} ms, of which factorisation {:.1} ms",
            base.rank(),
            whole * 1e3,
            factor * 1e3
        );
    }
    aperiodic(&robot, &nominal);
}

/// Records of Table I's motion at 1 kHz, taken for one without a period, with noise and a model error that does not decay.
fn aperiodic(robot: &Robot, nominal: &StandardParameters) {
    let n = robot.dof();
    let period = table_one::corrected().sample(10_000);
    let mut dynamics = Dynamics::new(robot, nominal);
    let mut once = vec![0.0; n * period.len()];
    for (k, tau) in once.chunks_exact_mut(n).enumerate() {
        dynamics.inverse(period.q(k), period.qd(k), period.qdd(k), tau);
        tau[0] += 0.5 * libm::sin(25.0 * period.q(k)[0]);
    }
    for count in [10_000, 100_000, 1_000_000] {
        let mut rng = Seed::new(2).stream("identification bench", 0);
        let (mut q, mut effort) = (Vec::with_capacity(n * count), Vec::with_capacity(n * count));
        for k in 0..count {
            q.extend_from_slice(period.q(k % period.len()));
            effort.extend(once[k % period.len() * n..][..n].iter().map(|tau| {
                let z: f64 = StandardNormal.sample(&mut rng);
                tau + z
            }));
        }
        let record = AperiodicRecord::new(n, 1000.0, &q, &effort);
        let began = Instant::now();
        let samples = process_aperiodic(&record, robot, EffortInterface::Torque, 40.0, &Processing::default())
            .expect("a record of this length");
        let processed = began.elapsed().as_secs_f64();
        let identification = Identification::new(robot, Columns::RIGID_ROTOR_FRICTION).expect("a base");
        let estimate = identification.estimate(&samples, EstimatorKind::Wls.estimator()).expect("excited");
        black_box(estimate);
        let memory = std::fs::read_to_string("/proc/self/status").ok().and_then(|text| {
            text.lines().find_map(|line| line.strip_prefix("VmHWM:").map(str::trim).map(str::to_owned))
        });
        println!(
            "{count} samples without a period, WLS: {:.2} s, of which processing {processed:.2} s; most memory so far {}",
            began.elapsed().as_secs_f64(),
            memory.unwrap_or_else(|| "unknown".to_owned())
        );
    }
}
