//! Times the three base reductions on one core against the number of joints: `cargo bench --bench reduction [-- MOST_JOINTS]`.
//! Random chains of turning and sliding joints, all columns; prints seconds and the number of base parameters.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::time::Instant;

use armid::base::{Method, reduce};
use armid::conformance::chains;
use armid::model::Columns;
use armid::seed::Seed;

fn main() {
    let most = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(40);
    println!("{:>8} {:>14} {:>10} {:>10} {:>10}", "joints", "radkhah2007", "qr", "structural", "parameters");
    for dof in [3, 6, 12, 20, 40].into_iter().filter(|&dof| dof <= most) {
        let (robot, _) = chains::random_robot(&mut Seed::new(1).stream("reduction bench", 0), dof);
        let mut rank = 0;
        let [paper, qr, structural] = [Method::Radkhah2007, Method::Qr, Method::Structural].map(|method| {
            let began = Instant::now();
            let base = reduce(&robot, Columns::RIGID_ROTOR_FRICTION, method, Seed::new(1)).expect("a finite geometry");
            rank = base.rank();
            began.elapsed().as_secs_f64()
        });
        println!("{dof:>8} {paper:>14.3} {qr:>10.3} {structural:>10.3} {rank:>10}");
    }
}
