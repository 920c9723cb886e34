//! Tables as something else records them, of a motion of the TX40.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use super::support::{armid, json, stderr, write};

/// One row: time, positions, currents.
pub(crate) type Row = (f64, Vec<f64>, Vec<f64>);

/// A motion of the TX40, whose wrist is coupled, of 1 + 1 + 4 + 4 + 1 s at 500 Hz, without periods as far as the log says.
pub(crate) fn recorded(folder: &Path) -> Vec<Row> {
    let mut text = "period_s = 4.0\nharmonics = 2\n".to_owned();
    for (k, name) in ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"].iter().enumerate() {
        // Phases of their own: joints that turn round together do not show whose friction it is.
        let phase = 1.9 * k as f64;
        let ([a, b], [c, d]) =
            ([0.7 * phase.cos(), 0.7 * phase.sin()], [0.6 * (2.3 * phase).sin(), 0.6 * (2.3 * phase).cos()]);
        text += &format!("\n[[joint]]\nname = \"{name}\"\na = [{a:?}, {c:?}]\nb = [{b:?}, {d:?}]\nq0 = 0.1\n");
    }
    write(folder, "T.toml", &text);
    let experiment = "robot = \"staubli-tx40\"\ntrajectory = \"T.toml\"\nperiods = 1\nrate_hz = 500\nramp_s = 1\n";
    let experiment = write(folder, "x.toml", experiment);
    let out = folder.join("R.csv");
    armid(["run", &experiment, "-o", out.to_str().expect("a path in UTF-8")]).success();
    let text = std::fs::read_to_string(out).expect("the recording");
    assert!(text.starts_with("t,q1,q2,q3,q4,q5,q6,current1"), "{}", &text[..60]);
    text.lines()
        .skip(1)
        .map(|line| {
            let row: Vec<f64> = line.split(',').map(|value| value.parse().expect("a number")).collect();
            (row[0], row[1..7].to_vec(), row[7..13].to_vec())
        })
        .collect()
}

pub(crate) fn table(headings: &str, separator: &str, rows: &[Row], values: impl Fn(usize, &Row) -> Vec<f64>) -> String {
    let mut text = String::new();
    if !headings.is_empty() {
        let _ = writeln!(text, "{headings}");
    }
    for (k, row) in rows.iter().enumerate() {
        let values: Vec<String> = values(k, row).iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", values.join(separator));
    }
    text
}

pub(crate) fn identify(arguments: &[&str]) -> Value {
    let all = ["identify"].into_iter().chain(arguments.iter().copied()).chain(["--robot", "staubli-tx40", "--json"]);
    let done = armid(all);
    let code = done.get_output().status.code();
    assert!(matches!(code, Some(0 | 1)), "{}", stderr(&done));
    json(&done)
}

/// Largest difference between the base parameters of two estimates, in standard deviations of the first.
pub(crate) fn distance(a: &Value, b: &Value) -> f64 {
    let (a, b) =
        (a["base"].as_array().expect("a list of parameters"), b["base"].as_array().expect("a list of parameters"));
    assert_eq!(a.len(), b.len());
    let differs = |(a, b): (&Value, &Value)| {
        (a["value"].as_f64().expect("a number") - b["value"].as_f64().expect("a number"))
            / a["std"].as_f64().expect("a number")
    };
    a.iter().zip(b).map(differs).fold(0.0, |worst, x| worst.max(x.abs()))
}
