use super::*;
use crate::computer::commander::Outcome;
use crate::computer::flywheels::{FlyWheels, nominal};
use crate::link::{JointMap, LinkSettings};
use crate::message::{JointState, JointTrajectory, TrajectoryPoint};

fn controller(fault: Option<&str>) -> RobotController<FlyWheels> {
    let robot = armid::conformance::chains::planar_2r();
    let plant = FlyWheels([0.2, -0.1], [0.0; 2]);
    let fault = fault.map(|text| Fault::parse(text).unwrap());
    RobotController::new(&robot, &nominal(), plant, &Sensing::ideal(), Seed::new(1), 0, 500.0, 7_000_000_000)
        .unwrap()
        .with_fault(fault)
}

/// Half a radian on the first joint in 1 s, and back, again and again.
fn motion(controller: &RobotController<FlyWheels>) -> Spline {
    let names: Vec<String> = controller.limits().iter().map(|joint| joint.name.clone()).collect();
    let point = |k: i32| TrajectoryPoint {
        positions: vec![if k % 2 == 0 { 0.2 } else { 0.7 }, -0.1],
        velocities: vec![0.0; 2],
        accelerations: vec![0.0; 2],
        effort: Vec::new(),
        time_from_start: Time { sec: k, nanosec: 0 },
    };
    let trajectory =
        JointTrajectory { joint_names: names.clone(), points: (0..=4).map(point).collect(), ..Default::default() };
    Spline::new(&trajectory, &JointMap::new(&names, &LinkSettings::default()).unwrap(), controller.limits()).unwrap()
}

struct Line {
    t: f64,
    doing: &'static str,
    command: Vec<f64>,
    current: Vec<f64>,
    q: Vec<f64>,
    event: String,
}

/// Steps until `to` s.
fn run(controller: &mut RobotController<FlyWheels>, to: f64) -> (Vec<Output>, Vec<Line>) {
    let (mut output, mut lines) = (Vec::new(), Vec::new());
    while controller.t() < to - 1e-9 {
        controller
            .step(&mut output, &mut |report| {
                lines.push(Line {
                    t: report.t,
                    doing: report.doing,
                    command: report.command.to_vec(),
                    current: report.current.to_vec(),
                    q: report.q.to_vec(),
                    event: report.event.to_owned(),
                });
            })
            .unwrap();
    }
    (output, lines)
}

fn states(output: &[Output]) -> Vec<&JointState> {
    output.iter().filter_map(|out| if let Output::State(state) = out { Some(state) } else { None }).collect()
}

#[test]
fn a_motion_is_performed_reported_and_ended() {
    let mut controller = controller(None);
    controller.follow(motion(&controller)).unwrap();
    assert_eq!(controller.state(), "enabled homed follow");
    let (output, lines) = run(&mut controller, 4.1);
    let states = states(&output);
    // 4.1 s at 500 Hz, stamps evenly spaced from the clock's beginning.
    assert_eq!(states.len(), 2050);
    for (k, state) in states.iter().enumerate() {
        assert_eq!(state.header.stamp.ns(), 7_000_000_000 + 2_000_000 * k as i64);
    }
    assert!(output.contains(&Output::Ended(Outcome::Succeeded, String::new())));
    let far = lines.iter().map(|line| (line.command[0] - line.q[0]).abs()).fold(0.0, f64::max);
    // Peak acceleration 5.8 × 0.5 rad/s² at 8 Hz: q̈/ω² = 1.1 mrad, and a little for the damping.
    assert!(far < 5e-3, "{far}");
    assert!((states[500].position[0] - 0.7).abs() < 5e-3);
}

#[test]
fn after_a_fault_nothing_is_commanded_outside_the_limits() {
    for kind in FaultKind::ALL {
        let mut controller = controller(Some(&format!("{}@motion+0.6", kind.name())));
        run(&mut controller, 0.3);
        controller.follow(motion(&controller)).unwrap();
        let (output, lines) = run(&mut controller, 2.5);
        let struck = lines.iter().position(|line| line.event.starts_with("fault")).expect("a fault");
        assert!((lines[struck].t - 0.9).abs() < 2e-3, "{kind:?} at {}", lines[struck].t);
        let off = matches!(kind, FaultKind::Freeze | FaultKind::Jump | FaultKind::Estop);
        for line in &lines[struck..] {
            for (j, joint) in controller.limits().iter().enumerate() {
                assert!(line.current[j].abs() <= controller.robot().joints()[j].drive.current_limit);
                if off {
                    assert!(line.command.is_empty() && line.current[j] == 0.0, "{kind:?}: {}", line.doing);
                    assert_eq!(line.q, lines[struck].q, "{kind:?}: the brakes hold");
                } else {
                    assert!(line.command[j] >= joint.position.0 && line.command[j] <= joint.position.1);
                }
            }
        }
        let after: Vec<&JointState> =
            states(&output).into_iter().filter(|state| state.header.stamp.ns() >= 7_950_000_000).collect();
        match kind {
            FaultKind::Freeze => assert!(after.is_empty()),
            FaultKind::Drop => assert!(after.len() < 60 && !after.is_empty(), "{}", after.len()),
            FaultKind::Jitter => {
                assert!(after.windows(2).any(|pair| pair[0].header.stamp.ns() > pair[1].header.stamp.ns()));
            }
            FaultKind::Jump => assert!(controller.state().starts_with("fault")),
            FaultKind::Overcurrent => {
                assert!(after[0].effort[0] >= 1.5 * controller.robot().joints()[0].drive.current_limit);
            }
            FaultKind::Estop => assert_eq!(controller.state(), "estop"),
            FaultKind::Die => assert!(output.contains(&Output::Die)),
            FaultKind::Order => assert!(after[0].position[0] < 0.0 && after[0].position[1] > 0.2),
            FaultKind::Nan => assert!(after[0].position[0].is_nan() && after[0].position[1].is_finite()),
            FaultKind::StrangeState => assert_eq!(controller.state(), "EMERGENCY STOP pressed, unhomed"),
            FaultKind::Oscillation => {
                let most = controller.robot().joints()[0].drive.current_limit;
                assert!(after.windows(2).all(|pair| (pair[0].effort[0] - pair[1].effort[0]).abs() == most));
            }
            FaultKind::Clock => {
                let stamps: Vec<i64> = states(&output).iter().map(|state| state.header.stamp.ns()).collect();
                let back = stamps.windows(2).filter(|pair| pair[1] - pair[0] == -2_000_000_000 + 2_000_000).count();
                assert_eq!(back, 1);
            }
            FaultKind::Gripper => assert!(after[0].name[0] == "gripper" && after[0].position.len() == 3),
            // What is said of motions is the wire's, and how fast it lives is the pace's.
            FaultKind::LateAnswer
            | FaultKind::LostResult
            | FaultKind::Rate
            | FaultKind::LateExecution
            | FaultKind::LostGoal => assert!(after.len() > 700),
        }
        if off && kind != FaultKind::Freeze {
            assert!(output.iter().any(|out| matches!(out, Output::Ended(Outcome::Aborted, _))), "{kind:?}");
            assert!(controller.follow(motion(&controller)).is_err());
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let robot = armid::conformance::chains::planar_2r();
    let wrong = StandardParameters::zero(3);
    let plant = FlyWheels([0.0; 2], [0.0; 2]);
    let made = RobotController::new(&robot, &wrong, plant, &Sensing::ideal(), Seed::new(1), 0, 500.0, 0);
    assert!(matches!(made, Err(RobotControllerError::Servo(_))));
    for rate in [300.0, 2000.0, 0.0, f64::NAN] {
        let plant = FlyWheels([0.0; 2], [0.0; 2]);
        let made = RobotController::new(&robot, &nominal(), plant, &Sensing::ideal(), Seed::new(1), 0, rate, 0);
        assert!(matches!(made, Err(RobotControllerError::Rate { .. })), "{rate}");
    }
}

#[test]
fn an_arm_that_is_not_homed_says_so_and_stays() {
    let mut controller = controller(None).with_homed(false);
    assert_eq!(controller.follow(motion(&controller)), Err("the arm is not homed".to_owned()));
    assert!(!controller.set_point(&[0.1, 0.0]));
    let (output, _) = run(&mut controller, 0.5);
    assert_eq!(controller.state(), "enabled not homed hold");
    let states = states(&output);
    let stays = |state: &&JointState| state.position.iter().zip(&states[0].position).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(states.len() > 200 && states.iter().all(stays), "{:?}", states.last());
}

#[test]
fn requests_stop_the_arm() {
    let mut controller = controller(None);
    controller.follow(motion(&controller)).unwrap();
    run(&mut controller, 0.5);
    assert!(controller.cancel());
    let (output, _) = run(&mut controller, 1.5);
    assert!(output.contains(&Output::Ended(Outcome::Cancelled, String::new())));
    controller.disable("disabled: as requested");
    assert_eq!(controller.state(), "disabled: as requested");
    assert!(!controller.set_point(&[0.2, -0.1]));
}
