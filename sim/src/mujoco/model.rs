//! A robot inside MuJoCo: its model and its state, and what MuJoCo computes from them.

#![allow(unsafe_code, reason = "calls a C library")]

use std::ffi::{CStr, CString, c_char, c_int};
use std::ptr::{self, NonNull};
use std::slice;
use std::sync::{Mutex, PoisonError};

use armid::model::{Robot, StandardParameters};

use super::MujocoError;
use super::functions::{RawData, RawModel};
use super::layout::{INTEGRATOR_EULER, INTEGRATOR_RK4, model_offset};
use super::library::Library;
use super::mjcf::mjcf;

/// MuJoCo's own ways of taking a step; generalised forces are held over it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MujocoStepper {
    /// Semi-implicit Euler, order 1.
    Euler,
    /// Runge–Kutta, order 4.
    RungeKutta,
}

/// Links and rotors of a robot in MuJoCo: no friction, no offset. [`MujocoPlant`](super::MujocoPlant) adds those.
///
/// ```
/// use armid::conformance::chains;
/// use armid::model::StandardParameters;
/// use armid::spatial::Inertia;
/// use armid_sim::MujocoModel;
/// use nalgebra::{Matrix3, Vector3};
/// // Balls of 1 kg at the ends of both links, 0.4 m and 0.7 m from the shoulder, held horizontally.
/// let mut balls = StandardParameters::zero(2);
/// for link in &mut balls.links {
///     *link = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::from_diagonal_element(0.01));
/// }
/// let mut model = MujocoModel::new(&chains::planar_2r(), &balls).unwrap_or_else(|fault| panic!("{fault}"));
/// let mut tau = [0.0; 2];
/// model.inverse(&[0.0; 2], &[0.0; 2], &[0.0; 2], &mut tau);
/// assert!((tau[0] - 9.81 * (0.4 + 0.7)).abs() < 1e-12 && (tau[1] - 9.81 * 0.3).abs() < 1e-12);
/// ```
pub struct MujocoModel {
    library: &'static Library,
    model: NonNull<RawModel>,
    data: NonNull<RawData>,
    dof: usize,
    /// Vectors of length `dof` inside `data`.
    positions: NonNull<f64>,
    velocities: NonNull<f64>,
    applied: NonNull<f64>,
    accelerations: NonNull<f64>,
    inverse: NonNull<f64>,
    /// How often a mass matrix was singular, inside `data`.
    singular: NonNull<c_int>,
}

// SAFETY: model and data are owned and reached through this value alone; MuJoCo keeps no state per thread in them.
unsafe impl Send for MujocoModel {}
// SAFETY: what takes `&self` reads memory that only `&mut self` writes.
unsafe impl Sync for MujocoModel {}

/// The compiler of models reports errors through state of its own.
static COMPILING: Mutex<()> = Mutex::new(());

impl MujocoModel {
    /// A robot's links and rotors, by way of [`mjcf`]; at rest at zero.
    ///
    /// # Errors
    /// [`MujocoError`] where there is no library, or where MuJoCo cannot simulate these parameters.
    pub fn new(robot: &Robot, parameters: &StandardParameters) -> Result<Self, MujocoError> {
        let text = mjcf(robot, parameters)?;
        Self::compile(&text, robot.dof())
    }

    /// A model of `dof` joints with one coordinate each, from MJCF.
    pub(super) fn compile(text: &str, dof: usize) -> Result<Self, MujocoError> {
        let library = Library::get()?;
        let model = compile(library, text)?;
        Self::with_data(library, model, dof)
    }

    /// Takes the model over.
    fn with_data(library: &'static Library, model: NonNull<RawModel>, dof: usize) -> Result<Self, MujocoError> {
        let (f, layout) = (&library.functions, library.layout);
        // SAFETY: offsets are those of the version that `library` is; both fields are 64-bit integers.
        let sizes = unsafe {
            let size = |offset| model.as_ptr().cast::<i64>().byte_add(offset).read();
            [size(model_offset::NQ), size(model_offset::NV)]
        };
        // SAFETY: `model` came from `mj_compile` or `mj_copyModel`.
        let data = NonNull::new(unsafe { (f.mj_makeData)(model.as_ptr()) });
        let (Some(data), true) = (data, sizes.iter().all(|&size| usize::try_from(size) == Ok(dof))) else {
            // SAFETY: nothing refers to either of them any more; MuJoCo takes null for data.
            unsafe {
                (f.mj_deleteData)(data.map_or(ptr::null_mut(), NonNull::as_ptr));
                (f.mj_deleteModel)(model.as_ptr());
            }
            let reason = format!("found {} coordinates and {} speeds, expected {dof} each", sizes[0], sizes[1]);
            return Err(MujocoError::Refused { reason });
        };
        let vector = |offset| {
            // SAFETY: at these offsets `mjData` of this version holds `mjtNum*`, set once by `mj_makeData`.
            let found = unsafe { data.as_ptr().cast::<*mut f64>().byte_add(offset).read() };
            // A model with joints has all these vectors.
            NonNull::new(found).expect("mj_makeData allocates every vector of length nv")
        };
        // SAFETY: the offset lies inside `mjData`; `mjWarningStat` is two ints, the second of which counts.
        let singular = unsafe { data.cast::<c_int>().byte_add(layout.warning).add(1) };
        Ok(Self {
            library,
            model,
            data,
            dof,
            positions: vector(layout.qpos),
            velocities: vector(layout.qvel),
            applied: vector(layout.qfrc_applied),
            accelerations: vector(layout.qacc),
            inverse: vector(layout.qfrc_inverse),
            singular,
        })
    }

    /// Number of joints n.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// Joint coordinates and velocities now, n each.
    pub fn state(&self) -> (&[f64], &[f64]) {
        (self.read(self.positions), self.read(self.velocities))
    }

    /// Puts coordinates and velocities, n each.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn set_state(&mut self, q: &[f64], qd: &[f64]) {
        self.write(self.positions, q);
        self.write(self.velocities, qd);
    }

    /// Resets everything: time, forces, accelerations, counts of warnings. At rest at zero.
    pub fn reset(&mut self) {
        // SAFETY: model and data belong together.
        unsafe { (self.library.functions.mj_resetData)(self.model.as_ptr(), self.data.as_ptr()) }
    }

    /// Sets the generalised forces that act until they are set again; N·m or N, n of them.
    ///
    /// # Panics
    /// If the slice has another length than n.
    pub fn apply(&mut self, tau: &[f64]) {
        self.write(self.applied, tau);
    }

    /// Forward dynamics in the present state under the applied forces: accelerations, n.
    pub fn forward(&mut self) -> &[f64] {
        // SAFETY: model and data belong together; stage 0 computes everything.
        unsafe { (self.library.functions.mj_forwardSkip)(self.model.as_ptr(), self.data.as_ptr(), 0, 1) }
        self.acceleration()
    }

    /// The accelerations that the last forward dynamics found, n.
    pub fn acceleration(&self) -> &[f64] {
        self.read(self.accelerations)
    }

    /// Generalised forces that produce the accelerations `qdd`, by `mj_inverse`: links and rotors, no friction; n each.
    /// Leaves the state as it was.
    ///
    /// # Panics
    /// If a slice has another length than n.
    pub fn inverse(&mut self, q: &[f64], qd: &[f64], qdd: &[f64], tau: &mut [f64]) {
        let (old_q, old_qd) = self.state();
        let (old_q, old_qd) = (old_q.to_vec(), old_qd.to_vec());
        self.set_state(q, qd);
        self.write(self.accelerations, qdd);
        // SAFETY: model and data belong together.
        unsafe { (self.library.functions.mj_inverse)(self.model.as_ptr(), self.data.as_ptr()) }
        tau.copy_from_slice(self.read(self.inverse));
        self.set_state(&old_q, &old_qd);
    }

    /// MuJoCo's own step of `dt` seconds, `mj_step`, under the applied forces.
    pub fn step(&mut self, stepper: MujocoStepper, dt: f64) {
        let integrator = match stepper {
            MujocoStepper::Euler => INTEGRATOR_EULER,
            MujocoStepper::RungeKutta => INTEGRATOR_RK4,
        };
        self.set_time_step(dt);
        // SAFETY: the offset is that of an int in `mjModel`, which this value owns; model and data belong together.
        unsafe {
            self.model.as_ptr().cast::<c_int>().byte_add(model_offset::INTEGRATOR).write(integrator);
            (self.library.functions.mj_step)(self.model.as_ptr(), self.data.as_ptr());
        }
    }

    /// The rest of such a step after [`forward`](Self::forward).
    pub(super) fn advance(&mut self, stepper: MujocoStepper, dt: f64) {
        let f = &self.library.functions;
        self.set_time_step(dt);
        // SAFETY: model and data belong together, and forward dynamics were computed for the present state.
        unsafe {
            match stepper {
                MujocoStepper::Euler => (f.mj_Euler)(self.model.as_ptr(), self.data.as_ptr()),
                MujocoStepper::RungeKutta => (f.mj_RungeKutta)(self.model.as_ptr(), self.data.as_ptr(), 4),
            }
        }
    }

    fn set_time_step(&mut self, dt: f64) {
        // SAFETY: the offset is that of an `mjtNum` in `mjModel`, which this value owns.
        unsafe { self.model.as_ptr().cast::<f64>().byte_add(model_offset::TIMESTEP).write(dt) }
    }

    /// `x = M⁻¹ y` for as many right-hand sides as fit, with the mass matrix of the last forward dynamics.
    pub(super) fn solve_mass(&mut self, y: &[f64], x: &mut [f64]) {
        assert!(x.len() == y.len() && x.len().is_multiple_of(self.dof), "whole right-hand sides, as many solutions");
        let count = c_int::try_from(x.len() / self.dof).expect("as many right-hand sides as joints");
        // SAFETY: both slices hold `count` vectors of nv numbers.
        unsafe {
            (self.library.functions.mj_solveM)(
                self.model.as_ptr(),
                self.data.as_ptr(),
                x.as_mut_ptr(),
                y.as_ptr(),
                count,
            );
        }
    }

    /// How often since the last reset the mass matrix was found singular.
    pub(super) fn singular(&self) -> i32 {
        // SAFETY: points into `mjData`, which lives as long as this value.
        unsafe { self.singular.as_ptr().read() }
    }

    fn read(&self, vector: NonNull<f64>) -> &[f64] {
        // SAFETY: `vector` is one of the vectors of `dof` numbers inside `data`, which is written through `&mut self`
        // alone and freed when this value is dropped.
        unsafe { slice::from_raw_parts(vector.as_ptr(), self.dof) }
    }

    fn write(&mut self, vector: NonNull<f64>, values: &[f64]) {
        // SAFETY: as in `read`; `&mut self` makes this the only reference.
        unsafe { slice::from_raw_parts_mut(vector.as_ptr(), self.dof) }.copy_from_slice(values);
    }

    /// What only tests need of the library.
    #[cfg(test)]
    pub(super) fn raw(&self) -> (&'static Library, *mut RawModel, *mut RawData) {
        (self.library, self.model.as_ptr(), self.data.as_ptr())
    }
}

/// Makes a model from MJCF.
fn compile(library: &'static Library, text: &str) -> Result<NonNull<RawModel>, MujocoError> {
    let f = &library.functions;
    let refused = |reason: &CStr| MujocoError::Refused { reason: reason.to_string_lossy().trim().to_owned() };
    let xml = CString::new(text).map_err(|error| MujocoError::Refused { reason: error.to_string() })?;
    let _one_at_a_time = COMPILING.lock().unwrap_or_else(PoisonError::into_inner);
    let mut message: [c_char; 1024] = [0; 1024];
    // SAFETY: the text ends with a zero; the buffer is as long as stated, and MuJoCo ends its message inside it.
    unsafe {
        let spec = (f.mj_parseXMLString)(xml.as_ptr(), ptr::null(), message.as_mut_ptr(), 1024);
        if spec.is_null() {
            message[1023] = 0;
            return Err(refused(CStr::from_ptr(message.as_ptr())));
        }
        let model = NonNull::new((f.mj_compile)(spec, ptr::null()));
        let result = model.ok_or_else(|| match (f.mjs_getError)(spec) {
            text if text.is_null() => refused(c"without a reason"),
            text => refused(CStr::from_ptr(text)),
        });
        (f.mj_deleteSpec)(spec);
        result
    }
}

impl Clone for MujocoModel {
    fn clone(&self) -> Self {
        // SAFETY: a null destination asks for a new model.
        let model = unsafe { (self.library.functions.mj_copyModel)(ptr::null_mut(), self.model.as_ptr()) };
        let model = NonNull::new(model).expect("memory for a model");
        let mut copy = Self::with_data(self.library, model, self.dof).expect("a copy has as many joints");
        let (q, qd) = self.state();
        copy.set_state(q, qd);
        copy.apply(self.read(self.applied));
        copy
    }
}

impl Drop for MujocoModel {
    fn drop(&mut self) {
        let f = &self.library.functions;
        // SAFETY: both are owned, and nothing can refer to them after this.
        unsafe {
            (f.mj_deleteData)(self.data.as_ptr());
            (f.mj_deleteModel)(self.model.as_ptr());
        }
    }
}

impl std::fmt::Debug for MujocoModel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (q, qd) = self.state();
        f.debug_struct("MujocoModel").field("dof", &self.dof).field("q", &q).field("qd", &qd).finish_non_exhaustive()
    }
}
