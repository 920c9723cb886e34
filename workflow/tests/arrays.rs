//! Arrays of a caller, of any shape and with any numbers, are an answer or an error, never a panic.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use armid::model::Columns;
use armid::seed::Seed;
use armid::trajectory::States;
use armid_io::robot;
use armid_workflow::{Quantity, dynamics, parameters_of, regressor};
use rand::RngExt;

#[test]
fn identity_arrays_of_any_shape_are_an_answer_or_an_error() {
    let loaded = robot::find("planar-2r").unwrap();
    let (robot, columns) = (&loaded.robot, Columns::RIGID_ROTOR_FRICTION);
    let parameters = columns.parameters(robot).len();
    let mut rng = Seed::new(1).stream("arrays", 0);
    let (mut answers, mut errors) = (0, 0);
    for _ in 0..2000 {
        // Half of the draws fit.
        let mut array = |expected: usize| -> Vec<f64> {
            let length = if rng.random_bool(0.9) { expected } else { rng.random_range(0..2 * expected + 3) };
            let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, -0.0];
            let mut values: Vec<f64> = (0..length).map(|_| rng.random_range(-2.0..2.0)).collect();
            if length > 0 && rng.random_bool(0.05) {
                values[rng.random_range(0..length)] = odd[rng.random_range(0..odd.len())];
            }
            values
        };
        let rows = 3 * robot.dof();
        let (q, qd, qdd, phi) = (array(rows), array(rows), array(rows), array(parameters));
        let fits = [&q, &qd, &qdd].iter().all(|of| of.len() == rows) && phi.len() == parameters;
        let finite = [&q, &qd, &qdd, &phi].iter().all(|of| of.iter().all(|value| value.is_finite()));
        let states = States { dof: robot.dof(), q, qd, qdd };
        let set = parameters_of(robot, columns, &phi);
        let of_states = regressor(robot, columns, &states);
        let found = set.and_then(|set| {
            let found = Quantity::ALL.map(|quantity| dynamics(robot, &set, quantity, &states));
            found.into_iter().collect::<Result<Vec<_>, _>>()
        });
        if fits && finite {
            assert_eq!(of_states.unwrap().rows.len(), rows);
            assert_eq!(found.unwrap()[0].rows.len(), 3);
            answers += 1;
        } else if found.is_err() {
            errors += 1;
        }
    }
    assert!(answers > 500 && errors > 200, "{answers} answers, {errors} errors");
    // Of another number of joints, in arrays that belong together.
    let other = States { dof: 3, ..States::with_len(3, 2) };
    let set = parameters_of(robot, columns, &vec![0.1; parameters]).unwrap();
    let error = dynamics(robot, &set, Quantity::Torque, &other).unwrap_err();
    assert_eq!(error.to_string(), "found 6 positions of 3 joints, expected rows of 2");
    let error = parameters_of(robot, columns, &[0.1; 3]).unwrap_err();
    assert_eq!(error.to_string(), format!("found 3 parameters, expected {parameters}"));
}
