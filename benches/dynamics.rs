//! Times one evaluation of the equations of motion and of the regressor on the CRS A460 at random states:
//! `cargo bench -p armid --bench dynamics [-- PART_OF_A_NAME]`. Prints the best of several batches, ns per evaluation. With
//! `--source FILE` it writes the links of the same arm as C instead, for `benches/peers/exported.cpp`.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

use armid::base::{Method, reduce};
use armid::codegen::{BaseModel, Language};
use armid::conformance::chains;
use armid::dynamics::{Dynamics, States};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, bundled};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;
use nalgebra::{DMatrix, DVector};

const STATES: usize = 256;

/// Best of many short batches: what the machine does when nothing else runs on it.
fn time(name: &str, per_call: usize, mut run: impl FnMut(usize)) {
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with("--"));
    if filter.is_some_and(|filter| !name.contains(&filter)) {
        return;
    }
    let calls = STATES.div_ceil(per_call);
    let best = (0..2000)
        .map(|_| {
            let start = Instant::now();
            for k in 0..calls {
                run(k);
            }
            start.elapsed().as_secs_f64() / (calls * per_call) as f64
        })
        .fold(f64::INFINITY, f64::min);
    println!("{name:<52} {:>8.1} ns", best * 1e9);
}

fn main() {
    let entry = bundled().iter().find(|entry| entry.name == "crs-a460").expect("a bundled robot");
    let robot = parse_robot(entry.robot).expect("a bundled robot is valid");
    let mut arguments = std::env::args().skip_while(|argument| argument != "--source").skip(1);
    if let Some(file) = arguments.next() {
        let base =
            reduce(&robot, Columns::RIGID, Method::Structural, Seed::new(0)).expect("a bundled robot has a base");
        // None is zero, which would save operations.
        let beta = DVector::from_fn(base.rank(), |k, _| 0.1 + 0.01 * k as f64);
        let source = BaseModel::new(&robot, &base, &beta).expect("links alone").source(Language::C, entry.name);
        return std::fs::write(file, source).expect("a file that can be written");
    }
    let parameters = parse_nominal(entry.nominal, &robot).expect("bundled parameters are valid").parameters;
    let mut rng = Seed::new(1).stream("bench", 0);
    let mut states = States::new(6);
    for _ in 0..STATES {
        let (q, qd, qdd) = chains::random_state(&mut rng, 6);
        states.push(&q, &qd, &qdd);
    }
    let mut dynamics = Dynamics::new(&robot, &parameters);
    let mut out = [0.0; 6];
    time("inverse dynamics", 1, |k| {
        dynamics.inverse(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    time("forward dynamics, mass matrix", 1, |k| {
        dynamics.forward_composite(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    time("forward dynamics, articulated bodies", 1, |k| {
        dynamics.forward_articulated(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    // Columns whose distance is no multiple of 4096 bytes: such ones take each other's places in the first cache.
    let mut few = States::new(6);
    for k in 0..250 {
        few.push(states.q(k), states.qd(k), states.qdd(k));
    }
    // What Pinocchio's computes: without friction and rotors.
    let mut links = parameters.clone();
    for drive in &mut links.drives {
        *drive = drive.only(|_| false);
    }
    let mut links = Dynamics::new(&robot, &links);
    time("inverse dynamics, links alone", 1, |k| {
        links.inverse(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    time("forward dynamics, mass matrix, links alone", 1, |k| {
        links.forward_composite(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    time("forward dynamics, articulated bodies, links alone", 1, |k| {
        links.forward_articulated(states.q(k), states.qd(k), states.qdd(k), &mut out);
        black_box(&out);
    });
    for columns in Columns::ALL {
        let regressor = JointTorqueRegressor::new(&robot, columns).expect("columns of motion");
        let mut y = vec![0.0; regressor.rows() * regressor.cols()];
        time(&format!("regressor, {columns}"), 1, |k| {
            regressor.evaluate(states.q(k), states.qd(k), states.qdd(k), &mut y);
            black_box(&y);
        });
        time(&format!("stack, {columns}, per sample"), STATES, |_| {
            black_box(regressor.stack(&states));
        });
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).expect("a bundled robot has a base");
        let mut w = DMatrix::zeros(6 * few.len(), base.rank());
        time(&format!("stack in one place, base of {columns}, per sample"), few.len(), |_| {
            regressor.stack_means_into(&few, &base.kept, 1, &mut w);
            black_box(&w);
        });
        time(&format!("stack in parts, base of {columns}, per sample"), STATES, |_| {
            regressor.stack_in_parts(&states, &base.kept, 1, |part| {
                black_box(part.entries(0, 0));
            });
        });
    }
    let regressor = JointTorqueRegressor::new(&robot, Columns::RIGID_ROTOR_FRICTION).expect("columns of motion");
    let g: Vec<f64> = (0..regressor.rows() * regressor.cols()).map(|k| (k % 7) as f64 - 3.0).collect();
    let (mut dq, mut dqd, mut dqdd) = ([0.0; 6], [0.0; 6], [0.0; 6]);
    time("regressor, adjoint", 1, |k| {
        regressor.adjoint(states.sample(k), &g, [&mut dq, &mut dqd, &mut dqdd]);
        black_box((&dq, &dqd, &dqdd));
    });
}
