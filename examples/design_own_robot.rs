//! Design a trajectory that reveals the parameters of a robot of one's own, and store it for `armid run`:
//! `cargo run --bin design-own-robot -- T.toml`.
#![allow(clippy::print_stdout, reason = "a program that shows something")]

use std::error::Error;
use std::path::Path;

use armid::excitation::{CriterionKind, DesignLimits, DesignProblem, LimitSettings, design};
use armid::model::Columns;
use armid::model::format::parse_robot;
use armid::seed::Seed;

/// A robot file holds what anyone can read off the arm: geometry, limits, drives.
const ROBOT: &str = r#"
name = "swing"
convention = "standard"
gravity_m_s2 = [0.0, 0.0, -9.81]
effort = "torque"

[base]
roll_pitch_yaw_deg = [90, 0, 0]

[[joint]]
name = "shoulder"
kind = "revolute"
dh = { offset_deg = 0, d_m = 0, a_m = 0.5, alpha_deg = 0 }
[joint.limits]
position_deg = [-120, 120]
velocity_deg_s = 120
acceleration_rad_s2 = 15
torque_nm = 80
[joint.drive]
gear = 1
counts_per_revolution = 400000
current_noise_a = 0.1
coulomb_velocity_rad_s = 0.01

[[joint]]
name = "elbow"
kind = "revolute"
dh = { offset_deg = 0, d_m = 0, a_m = 0.3, alpha_deg = 0 }
[joint.limits]
position_deg = [-150, 150]
velocity_deg_s = 180
acceleration_rad_s2 = 25
torque_nm = 30
[joint.drive]
gear = 1
counts_per_revolution = 400000
current_noise_a = 0.05
coulomb_velocity_rad_s = 0.01
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let robot = parse_robot(ROBOT)?;
    // Without a guess of the robot's masses torque cannot be limited.
    let limits = DesignLimits::for_robot(&robot, None, None, &LimitSettings::default())?;
    let problem = DesignProblem::new(robot, Columns::RIGID_ROTOR_FRICTION, CriterionKind::DOptimal, limits)?;
    let design = design(&problem, Seed::new(1), 0)?;

    println!("{} after {} evaluations: {}", design.criterion, design.evaluations, design.value);
    println!("ended by: {}", design.termination.name());
    if let Some(path) = std::env::args().nth(1) {
        armid_io::output::write_text(Path::new(&path), &design.trajectory.to_toml())?;
    }
    Ok(())
}
