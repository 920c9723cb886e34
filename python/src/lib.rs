//! The extension module under the Python package `armid`: what crosses from NumPy and Python into the libraries, and back.
//!
//! Every call checks what it was given before any work, and does the work without the interpreter's lock. The classes that people
//! use are Python, in `python/armid/`; they make arrays contiguous and words out of answers. No mathematics is here.

mod arrays;
mod callable;
mod criterion;
mod designs;
mod dynamics;
mod estimates;
mod estimator;
mod fault;
mod identification;
mod log;
mod reduction;
mod robot;
mod simulation;
mod studies;
mod watch;
mod words;

use pyo3::prelude::*;

/// What the package calls.
#[pymodule]
mod _armid {
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        armid::remedy::set_wording(&crate::words::Keywords);
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }

    #[pymodule_export]
    use crate::designs::{design, sample};
    #[pymodule_export]
    use crate::dynamics::{forward_dynamics, gram, inverse_dynamics, mass_matrix, regressor};
    #[pymodule_export]
    use crate::estimates::{draw, export, payload, predict, report, student, torque, validate, write_mcap};
    #[pymodule_export]
    use crate::identification::identify;
    #[pymodule_export]
    use crate::log::{Log, is_table};
    #[pymodule_export]
    use crate::reduction::reduce;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::simulation::simulate;
    #[pymodule_export]
    use crate::studies::study;
}
