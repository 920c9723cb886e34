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
use armid::regressor::JointTorqueRegressor;
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
    model_and_regressor(robot, parameters).0
}

/// A model, and at a state the columns of its base from the regressor of all parameters, by rows.
fn model_and_regressor(
    robot: &Robot,
    parameters: &StandardParameters,
) -> (BaseModel, impl Fn(&[Vec<f64>; 3]) -> Vec<f64>) {
    let columns = columns();
    let base = reduce(robot, columns, Method::Structural, Seed::new(0)).expect("a base");
    let beta = base.beta(&parameters.vector(robot, columns));
    // Friction of the load is that of the torque of β alone.
    let mut in_places = StandardParameters::zero(robot.dof());
    for (&column, &value) in base.kept.iter().zip(&beta) {
        in_places.set(base.parameters[column], value);
    }
    let all = JointTorqueRegressor::with_load(robot, columns, &in_places);
    let model = BaseModel::new(robot, &base, &beta).expect("a model");
    let regressor = move |[q, qd, qdd]: &[Vec<f64>; 3]| {
        let mut y = vec![0.0; all.rows() * all.cols()];
        all.evaluate(q, qd, qdd, &mut y);
        y.chunks_exact(all.cols()).flat_map(|row| base.kept.iter().map(|&column| row[column])).collect()
    };
    (model, regressor)
}

/// Torques of the states, gravity and mass matrix at the first, and its torque again, one line each.
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
    out.extend_from_within(..n);
    out
}

fn row(x: &[f64]) -> String {
    x.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

/// Three numbers of each joint in each state, as tables Q, V and A.
fn tables(language: Language, n: usize, states: &[[Vec<f64>; 3]]) -> String {
    let (mut out, count) = (String::new(), states.len());
    for (which, name) in ["Q", "V", "A"].iter().enumerate() {
        let rows = states.iter().map(|state| match language {
            Language::C => format!("{{{}}}", row(&state[which])),
            Language::Rust => format!("[{}]", row(&state[which])),
        });
        let table = rows.collect::<Vec<_>>().join(",\n");
        let _ = match language {
            Language::C => writeln!(out, "static const double {name}[{count}][{n}] = {{{table}}};"),
            Language::Rust => writeln!(out, "const {name}: [[f64; {n}]; {count}] = [{table}];"),
        };
    }
    out
}

/// A program around the source that prints what `expected` lists.
fn program(language: Language, [n, b]: [usize; 2], states: &[[Vec<f64>; 3]]) -> String {
    let tables = tables(language, n, states);
    match language {
        Language::C => format!(
            "#include <stdio.h>\n{tables}\
             static void print(const double *x, int count) {{ for (int i = 0; i < count; i++) printf(\"%.17g\\n\", x[i]); }}\n\
             int main(void) {{ double t[{n}], m[{n} * {n}], y[{n} * {b}]; \
             for (int k = 0; k < {}; k++) {{ armid_inverse_dynamics(Q[k], V[k], A[k], t); print(t, {n}); }} \
             armid_gravity(Q[0], t); print(t, {n}); armid_mass_matrix(Q[0], m); print(m, {n} * {n}); \
             armid_regressor(Q[0], V[0], A[0], y); for (int i = 0; i < {n}; i++) {{ t[i] = 0.0; \
             for (int j = 0; j < {b}; j++) t[i] += y[{b} * i + j] * armid_base_parameters[j]; }} print(t, {n}); return 0; }}",
            states.len()
        ),
        Language::Rust => {
            tables
                + "fn print(x: &[f64]) { for x in x { println!(\"{x:?}\"); } }\n\
                   fn main() { for k in 0..Q.len() { print(&inverse_dynamics(&Q[k], &V[k], &A[k])); } \
                   print(&gravity(&Q[0])); print(&mass_matrix(&Q[0])); \
                   for row in regressor(&Q[0], &V[0], &A[0]).chunks(BASE_PARAMETERS.len()) { \
                   print(&[row.iter().zip(BASE_PARAMETERS).map(|(y, b)| y * b).sum::<f64>()]); } }"
        }
    }
}

/// A program that prints the accelerations of states whose third numbers are torques.
fn forward_program(language: Language, n: usize, states: &[[Vec<f64>; 3]]) -> String {
    let tables = tables(language, n, states);
    match language {
        Language::C => format!(
            "#include <stdio.h>\n{tables}int main(void) {{ double a[{n}]; for (int k = 0; k < {}; k++) {{ \
             armid_forward_dynamics(Q[k], V[k], A[k], a); \
             for (int i = 0; i < {n}; i++) printf(\"%.17g\\n\", a[i]); }} return 0; }}",
            states.len()
        ),
        Language::Rust => {
            tables
                + "fn main() { for k in 0..Q.len() { for a in forward_dynamics(&Q[k], &V[k], &A[k]) { println!(\"{a:?}\"); } } }"
        }
    }
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
            // A program need not call every function.
            rustc.args(["--edition", "2021", "-D", "warnings", "-A", "dead_code", "-O"]).arg(&file).arg("-o").arg(&out);
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
        let (model, regressor) = model_and_regressor(robot, parameters);
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
        for state @ [q, qd, qdd] in &states {
            let expected = regressor(state);
            let size = expected.iter().fold(0.0_f64, |size, y| size.max(y.abs()));
            let mut y = vec![0.0; expected.len()];
            model.regressor(q, qd, qdd, &mut y);
            for (found, expected) in y.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-12 * size, "{}: {found} {expected}", robot.name());
            }
        }
        let mut rest = vec![0.0; robot.dof() * (1 + robot.dof())];
        let (weight, mass) = rest.split_at_mut(robot.dof());
        model.gravity(&states[0][0], weight);
        model.mass_matrix(&states[0][0], mass);
        for (found, expected) in rest.iter().zip(&expected[STATES * robot.dof()..]) {
            assert!((found - expected).abs() < 1e-10 * size, "{}: {found} {expected}", robot.name());
        }
        for language in Language::ALL {
            let sizes = [robot.dof(), regressor(&states[0]).len() / robot.dof()];
            let text = model.source(language, "an arm") + &program(language, sizes, &states);
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
fn identity_compiled_forward_dynamics_have_the_accelerations_of_the_torque() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("codegen-forward");
    std::fs::create_dir_all(&folder).expect("a folder");
    for (index, (robot, mut parameters)) in arms().into_iter().enumerate() {
        let columns = Columns::RIGID_ROTOR_FRICTION;
        for drive in &mut parameters.drives {
            *drive = drive.only(|term| columns.has(term));
        }
        let base = reduce(&robot, columns, Method::Structural, Seed::new(0)).expect("a base");
        let beta = base.beta(&parameters.vector(&robot, columns));
        let model = BaseModel::new(&robot, &base, &beta).expect("a model");
        let (n, mut dynamics) = (robot.dof(), Dynamics::new(&robot, &parameters));
        let mut rng = Seed::new(93).stream("states", index as u64);
        let (mut states, mut expected) = (Vec::new(), Vec::new());
        for _ in 0..STATES {
            let (q, qd, qdd) = random_state(&mut rng, n);
            let mut tau = vec![0.0; n];
            dynamics.inverse(&q, &qd, &qdd, &mut tau);
            expected.extend(qdd);
            states.push([q, qd, tau]);
        }
        let size = expected.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
        let alike = |found: &[f64], whose: &str| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9 * size, "{} {whose}: {found} {expected}", robot.name());
            }
        };
        let mut evaluated = vec![0.0; expected.len()];
        for ([q, qd, tau], qdd) in states.iter().zip(evaluated.chunks_exact_mut(n)) {
            model.forward_dynamics(q, qd, tau, qdd);
        }
        alike(&evaluated, "evaluated");
        for language in Language::ALL {
            let text = model.source(language, "an arm") + &forward_program(language, n, &states);
            alike(&run(language, &text, &folder), language.name());
        }
    }
}

#[test]
fn friction_of_the_load_leaves_no_forward_dynamics() {
    let (robot, parameters) = &arms()[0];
    let model = model(robot, parameters);
    let mut qdd = [0.0; 6];
    model.forward_dynamics(&[0.0; 6], &[0.0; 6], &[0.0; 6], &mut qdd);
    assert!(!model.has_forward_dynamics() && qdd.iter().all(|qdd| qdd.is_nan()));
    assert!(!model.source(Language::C, "").contains("forward_dynamics"));
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
