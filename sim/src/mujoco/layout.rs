//! Where the fields stand that are read, in each version of MuJoCo that is taken.
//!
//! Written by hand after `mjmodel.h` and `mjdata.h`: of some thousand fields ten are needed, so the two structures stay opaque and
//! only offsets are known. Tests compare every offset with what a C compiler makes of the headers of each version, and what is read
//! there with what the library's own access functions give.

use std::ffi::c_int;

/// Offsets in `mjModel`, bytes, where pointers have 64 bits; the same in every version that is taken.
pub(super) mod model_offset {
    /// `mjtSize nq`, 64 bits: number of coordinates.
    pub(in super::super) const NQ: usize = 0;
    /// `mjtSize nv`: number of degrees of freedom.
    pub(in super::super) const NV: usize = 8;
    /// `mjtNum opt.timestep`, s.
    pub(in super::super) const TIMESTEP: usize = 792;
    /// `int opt.integrator`.
    pub(in super::super) const INTEGRATOR: usize = 1040;
}

/// Offsets in `mjData`, bytes, where pointers have 64 bits; all but the first of `mjtNum*`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct DataLayout {
    /// The version, as its library's file is named.
    pub(super) version: &'static str,
    /// `mjVERSION_HEADER`, which `mj_version()` must give.
    pub(super) number: c_int,
    /// `mjWarningStat warning[]`; the first is `mjWARN_INERTIA`, and its second `int` counts.
    pub(super) warning: usize,
    /// `qpos`, nq.
    pub(super) qpos: usize,
    /// `qvel`, nv.
    pub(super) qvel: usize,
    /// `qfrc_applied`, nv.
    pub(super) qfrc_applied: usize,
    /// `qacc`, nv.
    pub(super) qacc: usize,
    /// `qfrc_inverse`, nv.
    pub(super) qfrc_inverse: usize,
}

/// The versions that are taken. The first is the one that is fetched, and looked for first.
pub(super) const LAYOUTS: [DataLayout; 2] = [
    DataLayout {
        version: "3.17.0",
        number: 3_017_000,
        warning: 160_264,
        qpos: 160_688,
        qvel: 160_696,
        qfrc_applied: 160_744,
        qacc: 160_784,
        qfrc_inverse: 161_440,
    },
    DataLayout {
        version: "4.0.0",
        number: 4_000_000,
        warning: 160_264,
        qpos: 160_688,
        qvel: 160_696,
        qfrc_applied: 160_752,
        qacc: 160_792,
        qfrc_inverse: 161_456,
    },
];

/// `mjINT_EULER` of `mjtIntegrator`.
pub(super) const INTEGRATOR_EULER: c_int = 0;
/// `mjINT_RK4` of `mjtIntegrator`.
pub(super) const INTEGRATOR_RK4: c_int = 1;

const _: () = assert!(
    cfg!(target_pointer_width = "64") && cfg!(target_endian = "little"),
    "the layout of MuJoCo is known for 64 bits, little endian"
);

impl DataLayout {
    /// The layout of a version by its number.
    pub(super) fn of_number(number: c_int) -> Option<&'static Self> {
        LAYOUTS.iter().find(|layout| layout.number == number)
    }
}

/// The versions that are taken, as in "3.17.0 or 4.0.0".
pub(super) fn versions() -> String {
    LAYOUTS.map(|layout| layout.version).join(" or ")
}
