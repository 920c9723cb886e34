//! Faults as exceptions of the package.

use armid_io::{Error, ErrorKind};
use pyo3::prelude::*;

/// The exception of the package that says what a fault says, with its place and what helps.
pub(crate) fn exception(fault: Error) -> PyErr {
    let class = match fault.kind() {
        ErrorKind::Unknown | ErrorKind::Unreadable(std::io::ErrorKind::NotFound) => "NotFoundError",
        _ => "ArmidError",
    };
    Python::attach(|py| {
        let made = py.import("armid._errors").and_then(|module| module.getattr(class));
        let made = made
            .and_then(|class| class.call1((fault.to_string(), fault.remedy().map(ToString::to_string), fault.place())));
        made.map_or_else(|failed| failed, PyErr::from_value)
    })
}

/// The exception for something that is not as expected, in words or in those of a library's error.
pub(crate) fn unexpected(message: impl std::fmt::Display) -> PyErr {
    exception(Error::new(message))
}
