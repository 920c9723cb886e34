//! A plant of one's own: the core's forward dynamics behind a Runge–Kutta method of order 4.

use armid::conformance::chains::planar_2r;
use armid::conformance::plant_laws::{self, PlantTolerance};
use armid::conformance::plant_term_laws::{self, TermTolerance};
use armid::dynamics::Dynamics;
use armid::experiment::{Plant, PlantError};
use armid::model::term::{OFFSET, ROTOR, Term, VISCOUS};
use armid::model::{DriveParameters, Robot, StandardParameters};
use armid::spatial::Inertia;
use nalgebra::{Matrix3, Vector3};

/// Slopes of positions and velocities.
type Slopes = (Vec<f64>, Vec<f64>);

struct Integrated {
    dynamics: Dynamics,
    q: Vec<f64>,
    qd: Vec<f64>,
}

impl Integrated {
    fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let zero = vec![0.0; robot.dof()];
        Self { dynamics: Dynamics::new(robot, parameters), q: zero.clone(), qd: zero }
    }

    /// `(q̇, q̈)` at the state ahead of the present one by `h` times a slope.
    fn slope(&mut self, (dq, dqd): &Slopes, h: f64, tau: &[f64]) -> Slopes {
        let ahead = |x: &[f64], d: &[f64]| x.iter().zip(d).map(|(x, d)| x + h * d).collect::<Vec<f64>>();
        let (q, qd) = (ahead(&self.q, dq), ahead(&self.qd, dqd));
        let mut qdd = vec![0.0; q.len()];
        self.dynamics.forward(&q, &qd, tau, &mut qdd);
        (qd, qdd)
    }
}

impl Plant for Integrated {
    fn dof(&self) -> usize {
        self.q.len()
    }

    fn state(&self) -> (&[f64], &[f64]) {
        (&self.q, &self.qd)
    }

    fn reset(&mut self, q: &[f64], qd: &[f64]) {
        self.q.copy_from_slice(q);
        self.qd.copy_from_slice(qd);
    }

    fn step(&mut self, tau: &[f64], dt: f64) -> Result<(), PlantError> {
        let none = (vec![0.0; self.dof()], vec![0.0; self.dof()]);
        let k1 = self.slope(&none, 0.0, tau);
        let k2 = self.slope(&k1, 0.5 * dt, tau);
        let k3 = self.slope(&k2, 0.5 * dt, tau);
        let k4 = self.slope(&k3, dt, tau);
        let sum = |i: usize, of: fn(&Slopes) -> &Vec<f64>| {
            dt / 6.0 * (of(&k1)[i] + 2.0 * of(&k2)[i] + 2.0 * of(&k3)[i] + of(&k4)[i])
        };
        for i in 0..self.dof() {
            self.q[i] += sum(i, |k| &k.0);
            self.qd[i] += sum(i, |k| &k.1);
        }
        PlantError::of_state(&self.q, &self.qd).map_or(Ok(()), Err)
    }
}

#[test]
fn a_plant_from_outside_obeys_the_laws() {
    let mut parameters = StandardParameters::zero(2);
    for link in &mut parameters.links {
        *link = Inertia::from_com(2.0, Vector3::new(-0.15, 0.01, 0.0), Matrix3::from_diagonal_element(0.02));
    }
    parameters.drives.fill(DriveParameters::from_iter([(ROTOR, 0.2), (VISCOUS, 1.0), (OFFSET, 0.3)]));
    plant_laws::check(&planar_2r(), &parameters, &PlantTolerance::FOURTH_ORDER, Integrated::new).unwrap();
}

#[test]
fn a_plant_from_outside_has_every_term_and_one_that_lacks_them_is_found() {
    for &term in Term::ALL {
        plant_term_laws::check(term, &TermTolerance::FOURTH_ORDER, Integrated::new)
            .unwrap_or_else(|broken| panic!("{}: {broken}", term.symbol()));
        let bare = |robot: &Robot, parameters: &StandardParameters| Integrated::new(robot, &parameters.links_alone());
        // What is no term of the motion is the servo's, with any plant.
        let lacks = plant_term_laws::check(term, &TermTolerance::FOURTH_ORDER, bare).is_err();
        assert_eq!(lacks, term.entry().needs.is_motion(), "{}", term.symbol());
    }
}
