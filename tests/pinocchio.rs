//! Dynamics and regressor against Pinocchio on fixtures made by `tests/pinocchio/generate.py`.

use armid::dynamics::Dynamics;
use armid::model::format::{parse_nominal, parse_parameters, parse_robot};
use armid::model::term::ROTOR;
use armid::model::{
    Columns, DhConvention, DhRow, Drive, Joint, JointKind, Limits, Robot, RobotSpec, StandardParameters,
};
use armid::regressor::JointTorqueRegressor;
use armid::spatial::{Inertia, Placement};
use nalgebra::Vector3;

/// Rounding of two programs that sum some hundred terms in another order is 1e-14 to 1e-13; the fixtures are
/// rounded to 1e-11.
const RELATIVE: f64 = 1e-10;

/// The generator of states that `generate.py` has.
struct Generator(u64);

impl Generator {
    fn uniform(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn state(&mut self, dof: usize) -> [Vec<f64>; 3] {
        [3.0, 2.0, 10.0].map(|bound| (0..dof).map(|_| self.uniform(-bound, bound)).collect())
    }
}

/// One line of a fixture.
struct Answer<'a> {
    what: &'a str,
    state: usize,
    numbers: Vec<f64>,
}

/// The answers about one robot.
fn answers<'a>(text: &'a str, robot: &'a str) -> impl Iterator<Item = Answer<'a>> {
    let mut lines =
        text.lines().map(|line| line.split(',').collect::<Vec<_>>()).skip_while(move |l| l != &["robot", robot]);
    lines.next().unwrap_or_else(|| panic!("no answers about {robot}"));
    lines.take_while(|line| line[0] != "robot").map(|line| Answer {
        what: line[0],
        state: line[1].parse().expect("the number of a state"),
        numbers: line[2..].iter().map(|x| x.parse().expect("a number")).collect(),
    })
}

/// Rigid links and rotors alone: what Pinocchio computes.
fn without_friction(parameters: &StandardParameters) -> StandardParameters {
    let mut bare = parameters.clone();
    for drive in &mut bare.drives {
        *drive = drive.only(|term| term == ROTOR);
    }
    bare
}

fn assert_equal(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= RELATIVE * size, "{what}: {found}, Pinocchio {expected}");
    }
}

/// Compares every answer about one robot; returns how many there were of each quantity.
fn compare(robot: &Robot, parameters: &StandardParameters, seed: u64, text: &str) -> [usize; 4] {
    let n = robot.dof();
    let mut dynamics = Dynamics::new(robot, parameters);
    let regressor = JointTorqueRegressor::new(robot, Columns::RIGID).expect("columns of motion");
    let mut generator = Generator(seed);
    let (mut drawn, mut state) = (0, generator.state(n));
    let mut counts = [0; 4];
    for answer in answers(text, robot.name()) {
        while drawn < answer.state {
            state = generator.state(n);
            drawn += 1;
        }
        let [q, qd, qdd] = &state;
        let label = format!("{} of {} at state {drawn}", answer.what, robot.name());
        let mut out = vec![0.0; n];
        match answer.what {
            "torque" => {
                dynamics.inverse(q, qd, qdd, &mut out);
                assert_equal(&out, &answer.numbers, &label);
                counts[0] += 1;
            }
            "acceleration" => {
                let effort: Vec<f64> = qd.iter().map(|v| 5.0 * v).collect();
                dynamics.forward_composite(q, qd, &effort, &mut out);
                assert_equal(&out, &answer.numbers, &label);
                dynamics.forward_articulated(q, qd, &effort, &mut out);
                assert_equal(&out, &answer.numbers, &label);
                counts[1] += 1;
            }
            "mass-matrix" => {
                let mass = dynamics.mass_matrix(q);
                let lower: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|ij| mass[ij]).collect();
                assert_equal(&lower, &answer.numbers, &label);
                counts[2] += 1;
            }
            "regressor" => {
                let mut y = vec![0.0; n * regressor.cols()];
                regressor.evaluate(q, qd, qdd, &mut y);
                assert_equal(&y, &answer.numbers, &label);
                counts[3] += 1;
            }
            other => panic!("found the quantity {other}"),
        }
    }
    counts
}

#[test]
fn pinocchio_crs_a460() {
    let robot = parse_robot(include_str!("../models/crs-a460/robot.toml")).unwrap();
    let nominal = parse_nominal(include_str!("../models/crs-a460/nominal.toml"), &robot).unwrap().parameters;
    let counts = compare(&robot, &without_friction(&nominal), 1, include_str!("pinocchio/crs-a460.csv"));
    assert_eq!(counts, [1000, 10, 10, 2]);
}

#[test]
fn pinocchio_puma_560_with_published_parameters() {
    let robot = parse_robot(include_str!("../models/puma-560/robot.toml")).unwrap();
    // As published: link 1 without mass, link 3 not consistent.
    let file = parse_parameters(include_str!("../models/puma-560/published.toml"), &robot, false).unwrap();
    let counts = compare(&robot, &without_friction(&file.parameters), 1, include_str!("pinocchio/puma-560.csv"));
    assert_eq!(counts, [1000, 10, 10, 2]);
}

#[test]
fn pinocchio_staubli_tx40_with_its_coupled_wrist() {
    let robot = parse_robot(include_str!("../models/staubli-tx40/robot.toml")).unwrap();
    assert!(robot.coupling().is_some());
    let nominal = parse_nominal(include_str!("../models/staubli-tx40/nominal.toml"), &robot).unwrap().parameters;
    let counts = compare(&robot, &without_friction(&nominal), 1, include_str!("pinocchio/staubli-tx40.csv"));
    assert_eq!(counts, [100, 10, 10, 2]);
}

#[derive(serde::Deserialize)]
struct ChainJoint {
    kind: JointKind,
    convention: DhConvention,
    offset_deg: f64,
    d_m: f64,
    a_m: f64,
    alpha_deg: f64,
}

#[derive(serde::Deserialize)]
struct Chain {
    name: String,
    gravity_m_s2: [f64; 3],
    joints: Vec<ChainJoint>,
    links: Vec<[f64; 10]>,
    rotors_kg_m2: Vec<f64>,
}

impl Chain {
    fn robot(&self) -> (Robot, StandardParameters) {
        let joints = self.joints.iter().enumerate().map(|(index, joint)| {
            let ChainJoint { kind, convention, offset_deg, d_m: d, a_m: a, alpha_deg } = *joint;
            let row = DhRow { offset_deg, d, a, alpha_deg };
            let (before, after) = row.placements(convention);
            Joint {
                name: format!("joint{index}"),
                kind,
                before,
                after,
                dh: Some((convention, row)),
                limits: Limits { position: (-3.0, 3.0), ..Limits::NONE },
                drive: Drive::ideal(),
            }
        });
        let robot = Robot::new(RobotSpec {
            name: self.name.clone(),
            gravity: Vector3::from(self.gravity_m_s2),
            base: Placement::identity(),
            joints: joints.collect(),
            coupling: None,
            ..RobotSpec::default()
        })
        .expect("a chain that Robot accepts");
        let mut parameters = StandardParameters::zero(robot.dof());
        parameters.links = self.links.iter().map(Inertia::from_array).collect();
        for (drive, &rotor) in parameters.drives.iter_mut().zip(&self.rotors_kg_m2) {
            drive[ROTOR] = rotor;
        }
        (robot, parameters)
    }
}

#[test]
fn pinocchio_random_chains() {
    let chains: Vec<Chain> = serde_json::from_str(include_str!("pinocchio/chains.json")).unwrap();
    let text = include_str!("pinocchio/chains.csv");
    let mut total = [0; 4];
    for (chain, seed) in chains.iter().zip(1..) {
        let (robot, parameters) = chain.robot();
        let counts = compare(&robot, &parameters, seed, text);
        for (total, count) in total.iter_mut().zip(counts) {
            *total += count;
        }
    }
    assert_eq!(total, [1000, 20, 20, 4]);
}
