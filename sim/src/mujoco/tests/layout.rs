//! Where the fields stand, by the headers and by the library's own access functions.

#![allow(unsafe_code, reason = "calls functions that only this test needs")]

use std::ffi::c_int;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

use super::robots::{bundled_robots, chains};
use crate::mujoco::MujocoModel;
use crate::mujoco::functions::{RawData, RawModel};
use crate::mujoco::layout::{DataLayout, INTEGRATOR_EULER, INTEGRATOR_RK4, LAYOUTS, model_offset};

#[test]
fn published_offsets_are_what_a_c_compiler_makes_of_the_headers_of_each_version() {
    let third_party = Path::new(env!("CARGO_MANIFEST_DIR")).join("../third_party");
    for layout in &LAYOUTS {
        let folder = if *layout == LAYOUTS[0] { "mujoco".to_owned() } else { format!("mujoco-{}", layout.version) };
        let include = third_party.join(&folder).join("include");
        assert!(include.is_dir(), "no headers in {}; run scripts/get-mujoco {}", include.display(), layout.version);
        check_headers(layout, &include);
    }
}

/// Compiles assertions on every offset.
fn check_headers(layout: &DataLayout, include: &Path) {
    let expected = [
        ("offsetof(mjModel, nq)", model_offset::NQ),
        ("offsetof(mjModel, nv)", model_offset::NV),
        ("offsetof(mjModel, opt.timestep)", model_offset::TIMESTEP),
        ("offsetof(mjModel, opt.integrator)", model_offset::INTEGRATOR),
        ("offsetof(mjData, warning)", layout.warning),
        ("offsetof(mjData, qpos)", layout.qpos),
        ("offsetof(mjData, qvel)", layout.qvel),
        ("offsetof(mjData, qfrc_applied)", layout.qfrc_applied),
        ("offsetof(mjData, qacc)", layout.qacc),
        ("offsetof(mjData, qfrc_inverse)", layout.qfrc_inverse),
        ("offsetof(mjWarningStat, number)", size_of::<c_int>()),
        ("sizeof(mjWarningStat)", 2 * size_of::<c_int>()),
        ("sizeof(mjtSize)", size_of::<i64>()),
        ("sizeof(mjtNum)", size_of::<f64>()),
        ("sizeof(((mjData*)0)->qpos)", size_of::<*mut f64>()),
        ("mjWARN_INERTIA", 0),
        ("mjSTAGE_NONE", 0),
        ("mjINT_EULER", usize::try_from(INTEGRATOR_EULER).unwrap()),
        ("mjINT_RK4", usize::try_from(INTEGRATOR_RK4).unwrap()),
        ("mjVERSION_HEADER", usize::try_from(layout.number).unwrap()),
    ];
    let mut source = String::from("#include <stddef.h>\n#include <mujoco/mujoco.h>\n");
    for (what, value) in &expected {
        writeln!(source, "_Static_assert(({what}) == {value}, \"{what} is not {value}\");").unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("layout.c");
    std::fs::write(&file, source).unwrap();
    let output = Command::new("cc").arg("-std=c11").arg("-fsyntax-only").arg("-I").arg(include).arg(&file).output();
    let output = output.expect("a C compiler called cc, which links Rust programs too");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

type GetState = unsafe extern "C" fn(*const RawModel, *const RawData, *mut f64, c_int);
type StateSize = unsafe extern "C" fn(*const RawModel, c_int) -> c_int;

/// A part of the state, by `mj_getState`; `part` is a bit of `mjtState`.
fn state(model: &MujocoModel, part: c_int) -> Vec<f64> {
    let (library, m, d) = model.raw();
    // SAFETY: signatures as in mujoco.h; the vector has the length that `mj_stateSize` asks for.
    unsafe {
        let count = (library.handle().get::<StateSize>("mj_stateSize").unwrap())(m, part);
        let mut out = vec![0.0; usize::try_from(count).unwrap()];
        (library.handle().get::<GetState>("mj_getState").unwrap())(m, d, out.as_mut_ptr(), part);
        out
    }
}

#[test]
fn mujoco_access_functions_find_what_is_written_to_the_fields() {
    // Bits of `mjtState`.
    let (time, positions, velocities, applied) = (1, 2, 4, 1 << 7);
    for (robot, parameters) in bundled_robots().into_iter().chain(chains(7)) {
        let n = robot.dof();
        let mut model = MujocoModel::new(&robot, &parameters).unwrap_or_else(|fault| panic!("{fault}"));
        let values = |first: f64| (0..n).map(|i| first + 0.01 * i as f64).collect::<Vec<f64>>();
        let (q, qd, tau) = (values(0.1), values(0.2), values(0.3));
        model.set_state(&q, &qd);
        model.apply(&tau);
        assert_eq!((state(&model, positions), state(&model, velocities), state(&model, applied)), (q, qd, tau));
        model.step(crate::MujocoStepper::RungeKutta, 0.0125);
        assert_eq!(state(&model, time), [0.0125]);
        assert_eq!(model.state(), (&state(&model, positions)[..], &state(&model, velocities)[..]));
        assert_eq!(model.singular(), 0);
    }
}

#[test]
fn threads_share_nothing() {
    // Eight models at once, made and run, give the bits of one alone.
    let run = || {
        let (robot, parameters) = bundled_robots().swap_remove(0);
        let mut model = MujocoModel::new(&robot, &parameters).unwrap_or_else(|fault| panic!("{fault}"));
        model.set_state(&vec![0.3; robot.dof()], &vec![0.5; robot.dof()]);
        (0..200).for_each(|_| model.step(crate::MujocoStepper::RungeKutta, 1e-3));
        let (q, qd) = model.state();
        q.iter().chain(qd).map(|x| x.to_bits()).collect::<Vec<u64>>()
    };
    let alone = run();
    let threads: Vec<_> = (0..8).map(|_| std::thread::spawn(run)).collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
}
