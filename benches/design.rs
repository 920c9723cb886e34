//! Times whole designs on one core, every limit held: position, speed, acceleration, torque and current by uncertain
//! parameters, 2 cm of clearance, ramps included: `cargo bench -p armid --bench design [-- PART_OF_A_NAME]`. Eight starts of
//! 400 evaluations, and the random baseline with as many; prints seconds.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::time::Instant;

use armid::excitation::effort::{CONFIDENCE_95, ParameterSpread};
use armid::excitation::{CriterionKind, DesignLimits, DesignProblem, Margins, best_of, design, random_design};
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::{Columns, bundled};
use armid::seed::Seed;

fn main() {
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with("--")).unwrap_or_default();
    println!("{:<32} {:>10} {:>12} {:>10} {:>12}", "", "one start", "eight starts", "baseline", "value");
    for entry in bundled() {
        let robot = parse_robot(entry.robot).expect("a bundled robot is valid");
        let nominal = parse_nominal(entry.nominal, &robot).expect("bundled parameters are valid");
        for criterion in [CriterionKind::Condition, CriterionKind::DOptimal] {
            let name = format!("{}, {}", robot.name(), criterion.name());
            if !name.contains(&filter) {
                continue;
            }
            let mut problem =
                DesignProblem::new(robot.clone(), Columns::RIGID_ROTOR_FRICTION, criterion, DesignLimits::motion())
                    .expect("a bundled robot has a base");
            let shares = &nominal.relative_uncertainty;
            let spread = ParameterSpread::new(&robot, &nominal.parameters, shares, CONFIDENCE_95);
            let limits = DesignLimits {
                nominal: Some(nominal.parameters.clone()),
                spread: Some(spread),
                margins: Margins { torque: 1.0, ..Margins::default() },
                ramp_s: Some(2.0),
                clearance_m: Some(0.02),
                ..DesignLimits::motion()
            };
            problem.set_limits(limits).expect("the limits are possible, and those of the robot");
            let began = Instant::now();
            let mut designs = vec![design(&problem, Seed::new(1), 0).expect("the problem is possible")];
            let one = began.elapsed().as_secs_f64();
            designs.extend((1..8).map(|start| design(&problem, Seed::new(1), start).expect("the problem is possible")));
            let eight = began.elapsed().as_secs_f64();
            let began = Instant::now();
            random_design(&problem, Seed::new(1), 0).expect("the problem is possible");
            let baseline = began.elapsed().as_secs_f64();
            let value = best_of(&designs).map_or(f64::NAN, |best| best.value);
            println!("{name:<32} {one:>10.2} {eight:>12.2} {baseline:>10.2} {value:>12.3}");
        }
    }
}
