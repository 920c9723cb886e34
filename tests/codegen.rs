//! Source code of the dynamics in base parameters, compiled by `cc` and `rustc`, against the recursion with all parameters.

use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use armid::base::{BaseReduction, Method, reduce};
use armid::codegen::{BaseModel, CodegenError, Language};
use armid::conformance::chains::{ChainRecipe, random_state};
use armid::dynamics::Dynamics;
use armid::model::format::{parse_nominal, parse_robot};
use armid::model::term::{LOAD_FRICTION, MOTOR_LOAD_FRICTION, OFFSET, ROTOR};
use armid::model::{Columns, Robot, StandardParameters, bundled};
use armid::seed::Seed;
use nalgebra::{DMatrix, DVector};

const STATES: usize = 20;

/// Bundled robots with their nominal parameters, and chains with sliding joints and coupled motors.
fn arms() -> Vec<(Robot, StandardParameters)> {
    let mut arms: Vec<(Robot, StandardParameters)> = bundled()
        .iter()
        .map(|entry| {
            let robot = parse_robot(entry.robot).expect("a bundled robot");
            let parameters = parse_nominal(entry.nominal, &robot).expect("its nominal parameters").parameters;
            (robot, parameters)
        })
        .collect();
    // Rotors that show only in a sum with their links count as links, and load their gears: their parts are not compared.
    for drive in arms.iter_mut().flat_map(|(_, parameters)| &mut parameters.drives) {
        (drive[LOAD_FRICTION], drive[MOTOR_LOAD_FRICTION]) = (0.0, 0.0);
    }
    let mut rng = Seed::new(91).stream("codegen", 0);
    for (dof, prismatic, coupled) in [(3, 0.5, false), (5, 0.0, true), (7, 0.2, false)] {
        let mut recipe = ChainRecipe::new(dof);
        (recipe.prismatic, recipe.coupled) = (prismatic, coupled);
        let (robot, mut parameters) = recipe.draw(&mut rng);
        // An offset that shows only in a sum with a weight counts as weight in the same way.
        for (index, drive) in parameters.drives.iter_mut().enumerate().filter(|_| prismatic == 0.0) {
            (drive[ROTOR], drive[LOAD_FRICTION]) = (0.0, 0.05);
            drive[MOTOR_LOAD_FRICTION] = if robot.is_coupled(index) { 0.04 } else { 0.0 };
        }
        arms.push((robot, parameters));
    }
    arms
}

fn columns() -> Columns {
    Columns::RIGID_ROTOR_FRICTION.with_term(LOAD_FRICTION).with_term(MOTOR_LOAD_FRICTION)
}

fn model(robot: &Robot, parameters: &StandardParameters) -> BaseModel {
    let columns = columns();
    let base = reduce(robot, columns, Method::Structural, Seed::new(0)).expect("a base");
    BaseModel::new(robot, &base, &base.beta(&parameters.vector(robot, columns))).expect("a model")
}

/// Torques of the states, and gravity and mass matrix at the first, one line each.
fn expected(
    robot: &Robot,
    parameters: &StandardParameters,
    states: &[[Vec<f64>; 3]],
    offset_in_weight: &[usize],
) -> Vec<f64> {
    let n = robot.dof();
    let mut out = Vec::new();
    let columns = columns();
    let mut with = parameters.clone();
    for drive in &mut with.drives {
        *drive = drive.only(|term| columns.has(term));
    }
    let mut tau = vec![0.0; n];
    let mut whole = Dynamics::new(robot, &with);
    for [q, qd, qdd] in states {
        whole.inverse(q, qd, qdd, &mut tau);
        out.extend(&tau);
    }
    // At rest, without friction: weight alone, then the change by one unit of each acceleration.
    let mut inert = with.clone();
    for drive in &mut inert.drives {
        *drive = drive.only(|term| Columns::RIGID_ROTOR.has(term));
    }
    let mut inert = Dynamics::new(robot, &inert);
    let (q, zero) = (&states[0][0], vec![0.0; n]);
    let mut weight = vec![0.0; n];
    inert.inverse(q, &zero, &zero, &mut weight);
    out.extend((0..n).map(|i| weight[i] + if offset_in_weight.contains(&i) { with.drives[i][OFFSET] } else { 0.0 }));
    let mut mass = vec![0.0; n * n];
    for j in 0..n {
        let mut unit = zero.clone();
        unit[j] = 1.0;
        inert.inverse(q, &zero, &unit, &mut tau);
        for i in 0..n {
            mass[i * n + j] = tau[i] - weight[i];
        }
    }
    out.extend(mass);
    out
}

fn row(x: &[f64]) -> String {
    x.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

/// A program around the source that prints what `expected` lists.
fn program(language: Language, n: usize, states: &[[Vec<f64>; 3]]) -> String {
    let mut out = String::new();
    let count = states.len();
    let tables: Vec<String> = (0..3)
        .map(|which| {
            let rows = states.iter().map(|state| match language {
                Language::C => format!("{{{}}}", row(&state[which])),
                Language::Rust => format!("[{}]", row(&state[which])),
            });
            rows.collect::<Vec<_>>().join(",\n")
        })
        .collect();
    match language {
        Language::C => {
            let _ = writeln!(out, "#include <stdio.h>");
            for (name, table) in ["Q", "V", "A"].iter().zip(&tables) {
                let _ = writeln!(out, "static const double {name}[{count}][{n}] = {{{table}}};");
            }
            let _ = writeln!(
                out,
                "int main(void) {{ double t[{n}], m[{}]; for (int k = 0; k < {count}; k++) {{ \
                 armid_inverse_dynamics(Q[k], V[k], A[k], t); for (int i = 0; i < {n}; i++) printf(\"%.17g\\n\", t[i]); }} \
                 armid_gravity(Q[0], t); for (int i = 0; i < {n}; i++) printf(\"%.17g\\n\", t[i]); \
                 armid_mass_matrix(Q[0], m); for (int i = 0; i < {}; i++) printf(\"%.17g\\n\", m[i]); return 0; }}",
                n * n,
                n * n
            );
        }
        Language::Rust => {
            for (name, table) in ["Q", "V", "A"].iter().zip(&tables) {
                let _ = writeln!(out, "const {name}: [[f64; {n}]; {count}] = [{table}];");
            }
            out.push_str(
                "fn main() { for k in 0..Q.len() { for t in inverse_dynamics(&Q[k], &V[k], &A[k]) { println!(\"{t:?}\"); } } \
                 for t in gravity(&Q[0]) { println!(\"{t:?}\"); } for m in mass_matrix(&Q[0]) { println!(\"{m:?}\"); } }",
            );
        }
    }
    out
}

/// Compiles without a warning, runs, and reads what was printed.
fn run(language: Language, text: &str, folder: &Path) -> Vec<f64> {
    let (file, out) = (folder.join(format!("arm.{}", language.extension())), folder.join(language.name()));
    std::fs::write(&file, text).expect("a file written");
    let mut compiler = match language {
        Language::C => {
            let mut cc = Command::new("cc");
            cc.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1"]).arg(&file).arg("-o").arg(&out).arg("-lm");
            cc
        }
        Language::Rust => {
            let mut rustc = Command::new("rustc");
            rustc.args(["--edition", "2021", "-D", "warnings", "-O"]).arg(&file).arg("-o").arg(&out);
            rustc
        }
    };
    let done = compiler.output().expect("a compiler");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let printed = Command::new(&out).output().expect("a program that runs").stdout;
    String::from_utf8_lossy(&printed).lines().map(|line| line.parse().expect("a number")).collect()
}

#[test]
fn identity_compiled_source_has_the_torque_of_all_parameters() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("codegen");
    std::fs::create_dir_all(&folder).expect("a folder");
    for (index, (robot, parameters)) in arms().iter().enumerate() {
        let model = model(robot, parameters);
        let mut rng = Seed::new(92).stream("states", index as u64);
        let states: Vec<[Vec<f64>; 3]> = (0..STATES)
            .map(|_| {
                let (q, qd, qdd) = random_state(&mut rng, robot.dof());
                [q, qd, qdd]
            })
            .collect();
        let expected = expected(robot, parameters, &states, &model.offset_in_weight);
        let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let mut evaluated = vec![0.0; robot.dof()];
        for ([q, qd, qdd], expected) in states.iter().zip(expected.chunks(robot.dof())) {
            model.inverse_dynamics(q, qd, qdd, &mut evaluated);
            for (found, expected) in evaluated.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-10 * size, "{}: {found} {expected}", robot.name());
            }
        }
        let mut rest = vec![0.0; expected.len() - STATES * robot.dof()];
        let (weight, mass) = rest.split_at_mut(robot.dof());
        model.gravity(&states[0][0], weight);
        model.mass_matrix(&states[0][0], mass);
        for (found, expected) in rest.iter().zip(&expected[STATES * robot.dof()..]) {
            assert!((found - expected).abs() < 1e-10 * size, "{}: {found} {expected}", robot.name());
        }
        for language in Language::ALL {
            let text = model.source(language, "an arm") + &program(language, robot.dof(), &states);
            let found = run(language, &text, &folder);
            assert_eq!(found.len(), expected.len());
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                assert!(
                    (found - expected).abs() < 1e-10 * size,
                    "{} {language:?} {k}: {found} {expected}",
                    robot.name()
                );
            }
        }
    }
}

#[test]
fn identity_base_parameters_need_fewer_operations_than_all() {
    // All parameters of the A460 in the same recursion: a base that keeps every column.
    let (robot, parameters) = &arms()[0];
    let columns = Columns::RIGID_ROTOR_FRICTION;
    let ids = columns.parameters(robot);
    let every = BaseReduction::from_stack(&ids, &DMatrix::identity(ids.len(), ids.len()), Method::Qr);
    let all = BaseModel::new(robot, &every, &parameters.vector(robot, columns)).expect("a model").operations();
    let few = model(robot, parameters).operations();
    assert!(few < all, "{few} operations against {all}");
}

#[test]
fn what_does_not_fit_is_refused() {
    let (robot, _) = &arms()[0];
    let base = reduce(robot, Columns::RIGID, Method::Structural, Seed::new(0)).expect("a base");
    let fault = BaseModel::new(robot, &base, &DVector::zeros(35)).expect_err("a number too few");
    assert_eq!(fault, CodegenError::Count { found: 35, expected: 36 });
    let (small, _) = &arms()[bundled().len()];
    let fault = BaseModel::new(small, &base, &DVector::zeros(36)).expect_err("another robot");
    assert!(matches!(fault, CodegenError::OtherRobot { dof: 3, .. }), "{fault}");
}
