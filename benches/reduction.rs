//! Times the three base reductions on one core against the number of joints: `cargo bench --bench reduction [-- MOST_JOINTS]`.
//! Random chains of turning and sliding joints, all columns; prints seconds and the number of base parameters, and what `armid reduce`
//! does besides for an arm without a table of lengths, as from a URDF: its base parameters as texts.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::hint::black_box;
use std::time::Instant;

use armid::base::{Method, reduce};
use armid::conformance::chains;
use armid::model::Columns;
use armid::seed::Seed;

fn main() {
    let most = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(80);
    println!(
        "{:>8} {:>14} {:>10} {:>10} {:>10} {:>10}",
        "joints", "radkhah2007", "qr", "structural", "texts", "parameters"
    );
    for dof in [3, 6, 12, 20, 40, 80].into_iter().filter(|&dof| dof <= most) {
        let (robot, _) = chains::random_robot(&mut Seed::new(1).stream("reduction bench", 0), dof);
        let robot = robot.with_joints(|joint| joint.dh = None).expect("the same joints");
        let mut found = None;
        let [paper, qr, structural] = [Method::Radkhah2007, Method::Qr, Method::Structural].map(|method| {
            let began = Instant::now();
            let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, method, Seed::new(1)).expect("a finite geometry");
            found = Some(base);
            began.elapsed().as_secs_f64()
        });
        let base = found.expect("three methods");
        let began = Instant::now();
        black_box(base.expressions(&robot));
        let (texts, rank) = (began.elapsed().as_secs_f64(), base.rank());
        println!("{dof:>8} {paper:>14.3} {qr:>10.3} {structural:>10.3} {texts:>10.3} {rank:>10}");
    }
}
