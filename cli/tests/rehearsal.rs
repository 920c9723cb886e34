//! A rehearsal without noise, identified as a log without periods: what remains is the motion above the cut-off.

mod support;

use support::{armid, json, temporary, write};

/// The share of the torque that the model leaves in the equations that are used.
fn share(folder: &std::path::Path, log: &str, cutoff_hz: &str) -> f64 {
    let out = folder.join("E.json");
    // The motion alone, without standstill and ramps.
    let part = ["--from", "3.5", "--until", "23", "--held-out", "none", "--bandwidth-hz", "20"];
    let arguments = [
        "identify",
        log,
        "--robot",
        "crs-a460",
        "--cutoff-hz",
        cutoff_hz,
        "--json",
        "-o",
        out.to_str().expect("as it was written"),
    ];
    let found = json(&armid(arguments.iter().chain(&part)));
    found["residual"]["used_rows"]["total"].as_f64().unwrap_or_else(|| panic!("{found}"))
}

/// The servo answers each reversal of friction with a transient of 10 to 100 Hz, which a low pass of positions takes out of the
/// regressor and leaves in the torque: the doc comment of `signal::aperiodic` has the figures.
#[test]
fn the_residual_of_a_motion_without_noise_falls_with_the_cutoff() {
    let folder = temporary();
    let text = "robot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = 1\nrate_hz = 500\n[sensing]\nencoders = false\n\
                current_noise = false\nconverters = false\n";
    let experiment = write(folder.path(), "x.toml", text);
    let log = folder.path().join("R.csv").to_str().unwrap().to_owned();
    armid(["run", &experiment, "-o", &log]).success();
    let [low, middle, high] = ["10", "40", "160"].map(|cutoff| share(folder.path(), &log, cutoff));
    assert!((0.004..0.02).contains(&low), "{low}");
    assert!(middle < 0.5 * low && high < 0.1 * low, "{low} {middle} {high}");
}
