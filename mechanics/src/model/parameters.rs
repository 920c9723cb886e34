//! The order and the values of a robot's dynamic parameters φ.
//!
//! First the ten of each link in turn, then the coefficients of the [torque terms](super::term) of each joint in turn:
//!
//! ```text
//! φ = (m1, mcx1, mcy1, mcz1, Ixx1, Ixy1, Ixz1, Iyy1, Iyz1, Izz1, m2, …, Izz_n, Ia1, Fv1, Fc1, Fo1, Ia2, …)
//! ```

use std::fmt;
use std::ops::{Index, IndexMut};

use super::columns::Columns;
use super::parameter_id::{ParameterId, ParameterKind};
use super::robot::Robot;
use super::term::Term;
use crate::spatial::Inertia;

/// The coefficients of the torque terms of one joint or motor. One that was never set is zero.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::model::DriveParameters;
/// use armid::model::term::{COULOMB, ROTOR};
/// let mut drive = DriveParameters::from_iter([(ROTOR, 0.5)]);
/// drive[COULOMB] = 4.0;
/// assert_eq!((drive[ROTOR], drive[COULOMB]), (0.5, 4.0));
/// ```
#[derive(Clone, Default)]
pub struct DriveParameters {
    /// In the order of the terms, none twice.
    values: Vec<(Term, f64)>,
}

impl DriveParameters {
    /// The coefficients of `terms` alone, all others zero.
    #[must_use]
    pub fn only(&self, terms: impl Fn(Term) -> bool) -> Self {
        Self { values: self.values.iter().copied().filter(|&(term, _)| terms(term)).collect() }
    }

    /// Every coefficient that is not zero, in the order of the terms.
    pub fn iter(&self) -> impl Iterator<Item = (Term, f64)> + '_ {
        self.values.iter().copied().filter(|&(_, value)| value != 0.0)
    }
}

impl FromIterator<(Term, f64)> for DriveParameters {
    /// These coefficients, all others zero.
    fn from_iter<I: IntoIterator<Item = (Term, f64)>>(values: I) -> Self {
        let mut drive = Self::default();
        for (term, value) in values {
            drive[term] = value;
        }
        drive
    }
}

impl Index<Term> for DriveParameters {
    type Output = f64;

    fn index(&self, term: Term) -> &f64 {
        self.values.iter().find(|(own, _)| *own == term).map_or(&0.0, |(_, value)| value)
    }
}

impl IndexMut<Term> for DriveParameters {
    fn index_mut(&mut self, term: Term) -> &mut f64 {
        let at = match self.values.binary_search_by_key(&term, |&(own, _)| own) {
            Ok(at) => at,
            Err(at) => {
                self.values.insert(at, (term, 0.0));
                at
            }
        };
        &mut self.values[at].1
    }
}

impl PartialEq for DriveParameters {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl fmt::Debug for DriveParameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_map().entries(self.iter()).finish()
    }
}

/// A full set of values for the parameters of a robot: a guess, an estimate or the truth of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct StandardParameters {
    /// Inertia of each link in its own frame.
    pub links: Vec<Inertia>,
    /// Drive of each joint.
    pub drives: Vec<DriveParameters>,
}

impl StandardParameters {
    /// All zero, for a robot of `dof` joints.
    pub fn zero(dof: usize) -> Self {
        Self { links: vec![Inertia::zero(); dof], drives: vec![DriveParameters::default(); dof] }
    }

    /// The value of one parameter.
    pub fn get(&self, id: ParameterId) -> f64 {
        match id.kind {
            ParameterKind::Term(term) => self.drives[id.index][term],
            link => self.links[id.index].to_array()[place(link)],
        }
    }

    /// Sets one parameter.
    pub fn set(&mut self, id: ParameterId, value: f64) {
        match id.kind {
            ParameterKind::Term(term) => self.drives[id.index][term] = value,
            link => {
                let mut ten = self.links[id.index].to_array();
                ten[place(link)] = value;
                self.links[id.index] = Inertia::from_array(&ten);
            }
        }
    }

    /// The links without any term.
    #[must_use]
    pub fn links_alone(&self) -> Self {
        Self { links: self.links.clone(), drives: vec![DriveParameters::default(); self.drives.len()] }
    }

    /// The vector φ for these columns of a robot, length p.
    pub fn vector(&self, robot: &Robot, columns: Columns) -> nalgebra::DVector<f64> {
        columns.parameters(robot).into_iter().map(|id| self.get(id)).collect::<Vec<f64>>().into()
    }

    /// The parameters of a vector φ for these columns of a robot. Parameters that it does not hold are zero.
    ///
    /// # Panics
    /// If the vector's length is not the number of columns.
    pub fn from_vector(robot: &Robot, columns: Columns, phi: &[f64]) -> Self {
        let ids = columns.parameters(robot);
        assert_eq!(ids.len(), phi.len(), "one value per column");
        let mut set = Self::zero(robot.dof());
        for (id, &value) in ids.into_iter().zip(phi) {
            set.set(id, value);
        }
        set
    }
}

impl Columns {
    /// These columns and every term of which a set of parameters has a coefficient other than zero.
    #[must_use]
    pub fn with_terms_of(self, parameters: &StandardParameters) -> Self {
        let stated = parameters.drives.iter().flat_map(|drive| drive.iter().map(|(term, _)| term));
        stated.fold(self, Self::with_term)
    }
}

fn place(kind: ParameterKind) -> usize {
    kind.link_place().expect("what is no term is one of a link's ten")
}
