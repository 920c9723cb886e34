//! A function that is written in Python, and what it raised.

use std::fmt;
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

/// A method that is asked for: one of the list, or a name and a callable.
#[derive(FromPyObject)]
pub(crate) enum Method {
    Listed(String),
    Own(String, Py<PyAny>),
}

/// A callable with the name that results have.
pub(crate) struct Callable {
    pub(crate) name: String,
    pub(crate) function: Py<PyAny>,
    /// What it raised, until somebody takes it.
    raised: Mutex<Option<PyErr>>,
}

impl Callable {
    pub(crate) fn new(name: String, function: Py<PyAny>) -> Self {
        Self { name, function, raised: Mutex::new(None) }
    }

    /// Keeps the first exception, which the caller of the whole work gets.
    pub(crate) fn keep(&self, raised: PyErr) {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(raised);
    }

    pub(crate) fn has_raised(&self) -> bool {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// The exception that it raised.
    pub(crate) fn raised(&self) -> Option<PyErr> {
        self.raised.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

impl fmt::Debug for Callable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Callable").field(&self.name).finish()
    }
}

/// Double precision, as NumPy makes it of anything.
pub(crate) fn numbers<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    value.py().import("numpy")?.call_method1("asarray", (value, "float64"))
}
