//! All links, motors and torque terms of a robot whose number of joints is known when this is compiled.

use armid::dynamics::TorqueTerms;
use armid::dynamics::chain::{Link, Links};
use armid::model::{Columns, Robot, StandardParameters};

use super::forces::Forces;

/// A robot of N joints with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Chain<const N: usize> {
    pub(crate) links: [Link; N],
    /// As in [`Links`].
    pub(crate) lift: [f64; 3],
    /// Inertia of the rotors.
    pub(crate) rotors: [[f64; N]; N],
    pub(crate) forces: Forces<N>,
}

impl<const N: usize> Chain<N> {
    /// `N` must be the robot's number of joints.
    pub(crate) fn new(robot: &Robot, parameters: &StandardParameters) -> Self {
        let Links { links, lift } = Links::new(robot, &parameters.links);
        let rotors = TorqueTerms::new(robot, Columns::RIGID_ROTOR).inertia(parameters);
        Self {
            links: std::array::from_fn(|i| links[i]),
            lift,
            rotors: std::array::from_fn(|i| std::array::from_fn(|j| rotors[(i, j)])),
            forces: Forces::new(robot, parameters),
        }
    }
}
