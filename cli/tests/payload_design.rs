//! `armid design --payload`: in closed loop, the load's parameters are known better than by a design for the whole arm.

mod support;

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;
use support::{armid, json, stderr, temporary, write};

/// The load that experiments put on: `measurement/src/experiment/effects/tool.rs`, 1 kg at (0.02, 0, 0.06) m.
const LOAD: [&str; 4] = ["--payload", "1.5", "--payload-centre", "0.02,0,0.06"];

/// Seven revolute joints, each axis across the last, with the limits of a light arm.
fn seven_axes() -> String {
    let mut text = "<robot name=\"seven\"><link name=\"world\"/>\n".to_owned();
    let places = ["0 0 0.3", "0 0 0", "0 0 0.3", "0.08 0 0", "-0.08 0 0.35", "0 0 0", "0.09 0 0.1"];
    for (k, place) in places.into_iter().enumerate() {
        let (n, parent) = (k + 1, if k == 0 { "world".to_owned() } else { format!("link_{k}") });
        let axis = if k % 2 == 0 { "0 0 1" } else { "0 1 0" };
        let mass = 4.0 / n as f64;
        let moment = 0.01 * mass;
        let _ = write!(
            text,
            "<link name=\"link_{n}\"><inertial><origin xyz=\"0.02 0.01 0.1\"/><mass value=\"{mass}\"/><inertia \
             ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"{moment}\"/></inertial></link>\n\
             <joint name=\"joint_{n}\" type=\"revolute\"><origin xyz=\"{place}\"/><parent link=\"{parent}\"/><child \
             link=\"link_{n}\"/><axis xyz=\"{axis}\"/><limit lower=\"-2.6\" upper=\"2.6\" velocity=\"2\" effort=\"{}\"/>\
             <dynamics damping=\"{}\"/></joint>\n",
            if n < 5 { 90.0 } else { 15.0 },
            4.0 / n as f64,
        );
    }
    text + "</robot>\n"
}

/// The standard deviation of each of the ten by logs with and without the load along one trajectory, mean of three pairs of logs: what one
/// pair shows of a discrepancy is chance.
fn deviations(folder: &Path, robot: &str, trajectory: &str) -> Vec<f64> {
    let recorded = |name: &str, run: usize, tool: &str| {
        let text = format!(
            "robot = \"{robot}\"\ntrajectory = \"{trajectory}\"\nperiods = 5\nrate_hz = 500\nrun = {run}\n[effects]\n\
             torque-noise = 0.2\n{tool}"
        );
        let experiment = write(folder, "x.toml", &text);
        let out = folder.join(name).to_str().expect("a path in UTF-8").to_owned();
        let _ = std::fs::remove_file(&out);
        armid(["run", &experiment, "-o", &out]).success();
        out
    };
    let mut sums = vec![0.0; 10];
    for pair in 0..3 {
        for (sum, deviation) in sums.iter_mut().zip(deviations_of_pair(&recorded, pair)) {
            *sum += deviation / 3.0;
        }
    }
    sums
}

fn deviations_of_pair(recorded: &dyn Fn(&str, usize, &str) -> String, pair: usize) -> Vec<f64> {
    let (without, with) = (recorded("A.mcap", 2 * pair, ""), recorded("B.mcap", 2 * pair + 1, "tool = 1.0\n"));
    let found = armid(["identify", "--payload", "--without", &without, "--with", &with, "--json"]);
    let found = json(&found);
    let parameters = found["parameters"].as_array().expect("ten parameters");
    let mass = &parameters[0]["shown"];
    let off = (mass["value"].as_f64().expect("as it was written") - 1.0).abs();
    assert!(off < 5.0 * mass["std"].as_f64().expect("as it was written"), "{mass}");
    parameters.iter().map(|parameter| parameter["shown"]["std"].as_f64().expect("all ten are shown")).collect()
}

/// Designs of equal duration and effort of search, one for the arm and one for the load.
fn compare(folder: &Path, robot: &str) -> [Vec<f64>; 2] {
    let design = |name: &str, aim: &[&str]| -> Value {
        let out = folder.join(name).to_str().expect("a path in UTF-8").to_owned();
        let robot = folder.join(robot);
        let robot =
            if robot.is_file() { robot.to_str().expect("as it was written").to_owned() } else { "crs-a460".to_owned() };
        let usual = ["--starts", "8", "--evaluations", "400", "--no-baseline", "--json", "-o", &out];
        json(&armid(["design", &robot].iter().chain(aim).chain(&usual)).success())
    };
    let weighted: &[&str] = if robot == "crs-a460" { &["--weighted"] } else { &[] };
    let general: Vec<&str> = ["--criterion", "d-optimal"].iter().chain(weighted).copied().collect();
    design("general.toml", &general);
    let made = design("load.toml", &LOAD);
    assert_eq!((made["criterion"].as_str(), made["payload"]["mass_kg"].as_f64()), (Some("payload"), Some(1.5)));
    // With the load more torque is asked for than without, and the limits hold with both.
    let used = made["payload"]["worst_limit_use"]["torque"].as_f64().expect("nominal parameters");
    assert!(used <= 1.0, "{used}");
    ["general.toml", "load.toml"].map(|trajectory| deviations(folder, robot, trajectory))
}

fn mean_ratio([general, made]: &[Vec<f64>; 2]) -> f64 {
    let logarithms = made.iter().zip(general).map(|(made, general)| (made / general).ln());
    (logarithms.sum::<f64>() / 10.0).exp()
}

#[test]
fn a_design_for_a_load_on_the_a460_narrows_its_intervals() {
    let folder = temporary();
    let found = compare(folder.path(), "crs-a460");
    let narrower = found[0].iter().zip(&found[1]).filter(|(general, made)| made < general).count();
    let widest = found[0].iter().zip(&found[1]).map(|(general, made)| made / general).fold(0.0, f64::max);
    // By seed of the search the mean ratio is 0.86 to 1.00, and that of the mass, the widest, 1.07 to 1.26 (docs/payload.md).
    assert!(mean_ratio(&found) < 0.95 && narrower >= 8 && widest < 1.26, "{} {found:?}", mean_ratio(&found));
}

#[test]
fn a_design_for_a_load_on_seven_axes_of_a_urdf_narrows_its_intervals() {
    let folder = temporary();
    write(folder.path(), "seven.urdf", &seven_axes());
    // What a URDF has no place for: rotors, and friction that a simulator can integrate.
    let joint = |n: usize| {
        format!(
            "[[joint]]\nname = \"joint_{n}\"\n[joint.drive]\ncoulomb_velocity_rad_s = 0.01\n[joint.terms]\nrotor_kg_m2 = \
             {}\ncoulomb_nm = {}\n",
            0.5 / n as f64,
            2.0 / n as f64
        )
    };
    let joints: String = (1..=7).map(joint).collect();
    write(folder.path(), "seven.toml", &format!("urdf = \"seven.urdf\"\n{joints}"));
    let found = compare(folder.path(), "seven.toml");
    let narrower = found[0].iter().zip(&found[1]).filter(|(general, made)| made < general).count();
    // What a recording shows of a discrepancy is chance here: it may widen one interval, by a few hundredths.
    let widest = found[0].iter().zip(&found[1]).map(|(general, made)| made / general).fold(0.0, f64::max);
    assert!(mean_ratio(&found) < 0.85 && narrower >= 9 && widest < 1.1, "{} {found:?}", mean_ratio(&found));
}

#[test]
fn what_is_no_load_is_refused() {
    for (more, wanted) in [
        (&["--payload", "0"][..], "expected a finite mass above zero"),
        (&["--payload", "1", "--payload-centre", "0,1"], "expected three numbers"),
        (&["--payload", "1", "--criterion", "d-optimal"], "--criterion"),
        (&["--payload-centre", "0,0,1"], "--payload"),
        (&[], "--criterion"),
    ] {
        let fault = stderr(&armid(["design", "crs-a460"].iter().chain(more)).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
    // Nothing is held that this load would need.
    let folder = temporary();
    let out = folder.path().join("T.toml");
    let heavy =
        ["design", "crs-a460", "--payload", "60", "--payload-centre", "0,0,0.3", "--starts", "1", "--evaluations", "8"];
    let text = support::stdout(&armid(heavy.iter().chain(&["--no-baseline", "-o", out.to_str().unwrap()])).code(1));
    assert!(text.contains("no trajectory within the limits") && text.contains("at most 60 kg"), "{text}");
}
