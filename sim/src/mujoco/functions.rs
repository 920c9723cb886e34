//! The functions of MuJoCo that are used.
//!
//! Written by hand after `mujoco.h` of the versions in [`super::layout`], in which they are the same.
#![allow(unsafe_code, reason = "functions of a C library")]
#![allow(non_snake_case, reason = "they carry the names of mujoco.h")]

use std::ffi::{c_char, c_int, c_void};

/// `mjModel`, opaque.
#[repr(C)]
pub(super) struct RawModel {
    _opaque: [u8; 0],
}

/// `mjData`, opaque.
#[repr(C)]
pub(super) struct RawData {
    _opaque: [u8; 0],
}

/// `mjSpec`, opaque.
#[repr(C)]
pub(super) struct RawSpec {
    _opaque: [u8; 0],
}

/// Declares the table of functions and how it is filled.
macro_rules! functions {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $kind:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions that are used, by their own names.
        pub(super) struct Functions {
            $($(#[$doc])* pub(super) $name: unsafe extern "C" fn($($argument: $kind),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Looks every function up.
            ///
            /// # Errors
            /// The name of the first function that is missing.
            ///
            /// # Safety
            /// `library` must be MuJoCo of a version in [`super::layout`], and outlive what is returned.
            pub(super) unsafe fn of(library: &libloading::Library) -> Result<Self, &'static str> {
                Ok(Self {
                    $($name: {
                        // SAFETY: the signature is the one in the headers of the version that the caller has checked.
                        let found = unsafe { library.get::<unsafe extern "C" fn($($kind),*) $(-> $result)?>(stringify!($name)) };
                        *found.map_err(|_| stringify!($name))?
                    },)*
                })
            }
        }
    };
}

functions! {
    /// Reads MJCF; null and a text in `error` where it cannot.
    fn mj_parseXMLString(xml: *const c_char, files: *const c_void, error: *mut c_char, length: c_int) -> *mut RawSpec;
    /// Makes a model; null where it cannot, and `mjs_getError` says why.
    fn mj_compile(spec: *mut RawSpec, files: *const c_void) -> *mut RawModel;
    /// What was wrong with a specification.
    fn mjs_getError(spec: *mut RawSpec) -> *const c_char;
    /// Frees a specification.
    fn mj_deleteSpec(spec: *mut RawSpec);
    /// Copies a model; into a new one where `to` is null.
    fn mj_copyModel(to: *mut RawModel, from: *const RawModel) -> *mut RawModel;
    /// Frees a model.
    fn mj_deleteModel(model: *mut RawModel);
    /// Makes the state and workspace of a model.
    fn mj_makeData(model: *const RawModel) -> *mut RawData;
    /// Puts state and workspace to where they began.
    fn mj_resetData(model: *const RawModel, data: *mut RawData);
    /// Frees state and workspace.
    fn mj_deleteData(data: *mut RawData);
    /// Forward dynamics, all of it where `stage` is 0.
    fn mj_forwardSkip(model: *const RawModel, data: *mut RawData, stage: c_int, without_sensors: c_int);
    /// Inverse dynamics.
    fn mj_inverse(model: *const RawModel, data: *mut RawData);
    /// One step by the integrator that the model names.
    fn mj_step(model: *const RawModel, data: *mut RawData);
    /// The rest of a semi-implicit Euler step after forward dynamics.
    fn mj_Euler(model: *const RawModel, data: *mut RawData);
    /// The rest of a Runge–Kutta step of order `order` after forward dynamics.
    fn mj_RungeKutta(model: *const RawModel, data: *mut RawData, order: c_int);
    /// `x = M⁻¹ y` for `count` right-hand sides.
    fn mj_solveM(model: *const RawModel, data: *mut RawData, x: *mut f64, y: *const f64, count: c_int);
}
