//! A torque term of one's own: in the law suite, in the columns of a regressor, and in what a fit estimates.

use armid::base::{Method, reduce};
use armid::conformance::{chains, term_laws};
use armid::dynamics::{Dynamics, States};
use armid::linalg::LeastSquares;
use armid::model::Columns;
use armid::model::term::{
    ByJoint, Dimension, Dissipation, Number, Prior, PriorOf, Structure, Term, TermEntry, TermInput, TermLaw,
    ViscousFriction,
};
use armid::regressor::JointTorqueRegressor;
use armid::seed::Seed;

/// Drag of the air, `g = v |v|`.
#[derive(Debug)]
struct Drag;

impl TermLaw for Drag {
    const ENTRY: TermEntry = TermEntry {
        symbol: "Fa",
        name: "drag",
        meaning: "drag of the air",
        group: "drag",
        dimension: Dimension { effort: 0, coordinate: 2, per_time: 2 },
        unit: ByJoint { revolute: "N·m·s²/rad²", prismatic: "N·s²/m²" },
        key: ByJoint { revolute: "drag_nm_s2_rad2", prismatic: "drag_n_s2_m2" },
        dissipation: Dissipation::Always,
        structure: Structure::Function { family: "v |v|", odd: true },
        prior: Prior { key: "drag", of: PriorOf::Value, default: Some(0.5) },
        ..ViscousFriction::ENTRY
    };

    fn law<R: Number>(&self, x: &TermInput<R>) -> R {
        x.qd * x.qd.magnitude()
    }
}

const DRAG: Term = Term::new(&Drag);

#[test]
fn a_term_from_outside_obeys_the_laws() {
    term_laws::check(DRAG).unwrap();
}

#[test]
fn a_term_from_outside_is_estimated_beside_those_of_the_list() {
    let columns = Columns::parse_among("rigid+rotor+friction+drag", &[Term::ALL, &[DRAG]].concat()).unwrap();
    assert_eq!(columns.to_string(), "rigid+rotor+friction+drag");
    let mut rng = Seed::new(5).stream("drag", 0);
    let (robot, mut truth) = chains::random_robot(&mut rng, 3);
    truth.drives[1][DRAG] = 0.7;
    let mut dynamics = Dynamics::new(&robot, &truth);
    let (mut states, mut torque) = (States::new(3), Vec::new());
    for _ in 0..200 {
        let (q, qd, qdd) = chains::random_state(&mut rng, 3);
        let mut tau = [0.0; 3];
        dynamics.inverse(&q, &qd, &qdd, &mut tau);
        torque.extend(tau);
        states.push(&q, &qd, &qdd);
    }
    let base = reduce(&robot, columns, Method::Structural, Seed::new(1)).unwrap();
    let w = base.select_columns(&JointTorqueRegressor::new(&robot, columns).expect("columns of motion").stack(&states));
    let beta = LeastSquares::solve(&w, &torque.into()).unwrap().solution().clone();
    let at = base.names().iter().position(|name| name == "Fa2").expect("drag of joint 2 is a base parameter");
    // Exact torques: what is left is rounding times the condition number.
    assert!((beta[at] - 0.7).abs() < 1e-9, "{}", beta[at]);
}
