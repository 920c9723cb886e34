//! `armid run`, and what recordings are.

mod support;

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use support::{armid, experiment, json, stderr, stdout, temporary, write};

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().expect("a path in UTF-8").to_owned()
}

#[test]
fn an_experiment_is_recorded_whole() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 2);
    let recording = path(folder.path(), "sub/R.mcap");
    let done = json(&armid(["run", &experiment, "-o", &recording, "--json"]).success());
    for key in ["recording", "robot", "arm", "seed", "run", "ending", "samples", "rate_hz", "periods", "tracking"] {
        assert!(done.get(key).is_some(), "{key}");
    }
    assert_eq!((done["ending"].as_str(), done["recording"].as_str()), (Some("completed"), Some(recording.as_str())));
    // 1 s at rest, 2 s into the motion, one period of 10 s thrown away, two that count, 2 s out of it, at 1 kHz.
    assert_eq!(done["samples"], 35_000);
    assert_eq!(std::fs::read_dir(folder.path().join("sub")).unwrap().count(), 1);
    // The servo's bandwidth is 8 Hz, the motion's 0.5 Hz: it follows within 2°.
    assert!(done["tracking"]["peak_error"].as_array().unwrap().iter().all(|e| e.as_f64().unwrap() < 0.035));
    assert_eq!(done["tracking"]["not_followed"], serde_json::json!([]));
}

#[test]
fn a_joint_that_does_not_follow_is_named() {
    let folder = temporary();
    let robot = path(folder.path(), "robot.toml");
    armid(["robot", "planar-2r", "-o", &robot]).success();
    let text = std::fs::read_to_string(&robot).unwrap();
    // A servo a tenth as fast as the motion.
    let soft = text.replace("bandwidth_hz = 8", "bandwidth_hz = 0.05").replace("integral_hz = 0.5", "integral_hz = 0");
    assert_ne!(soft, text);
    write(folder.path(), "robot.toml", &soft);
    for name in ["nominal.toml", "truth.toml"] {
        let model = format!("{}/../models/planar-2r/{name}", env!("CARGO_MANIFEST_DIR"));
        write(folder.path(), name, &std::fs::read_to_string(model).unwrap());
    }
    let joint = |name: &str| format!("[[joint]]\nname = \"{name}\"\na = [0.6]\nb = [0.2]\nq0 = 0.0\n");
    let trajectory = format!("period_s = 2.0\nharmonics = 1\n{}{}", joint("shoulder"), joint("elbow"));
    write(folder.path(), "T.toml", &trajectory);
    let text = "robot = \"robot.toml\"\ntrajectory = \"T.toml\"\nperiods = 2\nrate_hz = 200\n";
    let experiment = write(folder.path(), "experiment.toml", text);
    let run = |more: &[&str]| {
        let recording = path(folder.path(), "R.csv");
        armid(["run", &experiment, "-o", &recording].iter().chain(more)).success()
    };
    let done = json(&run(&["--json"]));
    assert!(!done["tracking"]["not_followed"].as_array().unwrap().is_empty(), "{}", done["tracking"]);
    assert!(stdout(&run(&[])).contains("did not follow: its error is more than a tenth of its motion"));
}

#[test]
fn identity_equal_seed_equal_bytes_and_another_seed_others() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let record = |name: &str, seed: &str, run: &str| {
        let recording = path(folder.path(), name);
        armid(["run", &experiment, "--seed", seed, "--run", run, "-o", &recording]).success();
        std::fs::read(recording).unwrap()
    };
    let first = record("a.mcap", "5", "0");
    assert!(first == record("b.mcap", "5", "0"));
    assert!(first != record("c.mcap", "6", "0"));
    assert!(first != record("d.mcap", "5", "1"));
}

#[test]
fn identity_a_replayed_recording_holds_the_same_samples() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let (first, second) = (path(folder.path(), "R.mcap"), path(folder.path(), "again.csv"));
    armid(["run", &experiment, "-o", &first]).success();
    armid(["run", &experiment, "--arm", "replay", "--recording", &first, "-o", &second]).success();
    let direct = path(folder.path(), "direct.csv");
    armid(["run", &experiment, "-o", &direct]).success();
    assert!(std::fs::read(&direct).unwrap() == std::fs::read(&second).unwrap());
    let fault = stderr(&armid(["run", &experiment, "--arm", "replay"]).code(2));
    assert!(fault.contains("arm replay needs --recording"), "{fault}");
    let fault = stderr(&armid(["run", &experiment, "--arm", "replay", "--recording", &direct]).code(2));
    assert!(fault.contains("was not recorded by armid"), "{fault}");
}

#[test]
fn identity_a_replayed_recording_gives_the_same_estimate_to_the_last_bit() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 2);
    let (first, second) = (path(folder.path(), "R.mcap"), path(folder.path(), "again.mcap"));
    armid(["run", &experiment, "-o", &first]).success();
    armid(["run", &experiment, "--arm", "replay", "--recording", &first, "-o", &second]).success();
    // But for the file that it came from.
    let estimate = |recording: &str| {
        let mut estimate = json(&armid(["identify", recording, "--json"]).success());
        for key in ["inputs", "logs"] {
            let origin = estimate.as_object_mut().unwrap().remove(key);
            assert!(origin.is_some_and(|origin| origin.to_string().contains(recording)), "{key}");
        }
        let log = estimate["figures"]["log"].take();
        assert!(log.as_str().is_some_and(|name| recording.ends_with(name)), "{log}");
        estimate.to_string()
    };
    let (first, second) = (estimate(&first), estimate(&second));
    assert!(first == second, "the estimates differ");
}

#[test]
fn motor_voltages_come_back_as_they_were() {
    let folder = temporary();
    let robot = path(folder.path(), "robot.toml");
    let text = include_str!("../../models/planar-2r/robot.toml");
    // A motor's circuit in both drives.
    let text = text.replace("coulomb_velocity", "resistance_ohm = 1.5\nsupply_v = 70\ncoulomb_velocity");
    std::fs::write(&robot, text).unwrap();
    for name in ["nominal.toml", "truth.toml"] {
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/planar-2r");
        std::fs::copy(models.join(name), folder.path().join(name)).unwrap();
    }
    let experiment = short(folder.path(), "robot.toml", 2, "[sensing]\nvoltage = true\n");
    let [direct, first, again] = ["direct.csv", "R.mcap", "again.csv"].map(|name| path(folder.path(), name));
    armid(["run", &experiment, "-o", &direct]).success();
    armid(["run", &experiment, "-o", &first]).success();
    armid(["run", &experiment, "--arm", "replay", "--recording", &first, "-o", &again]).success();
    let text = std::fs::read_to_string(&direct).unwrap();
    assert!(text.starts_with("t,q1,q2,tau1,tau2,voltage1,voltage2\n"), "{}", &text[..60]);
    assert_eq!(text, std::fs::read_to_string(&again).unwrap());
}

#[test]
fn a_recording_that_was_cut_off_is_named_and_its_chunks_are_used_on_request() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 2);
    let whole = path(folder.path(), "R.mcap");
    armid(["run", &experiment, "-o", &whole]).success();
    let bytes = std::fs::read(&whole).unwrap();
    // Two thirds hold the first of the two periods that count, and a part of the second.
    let cut = path(folder.path(), "cut.mcap");
    std::fs::write(&cut, &bytes[..bytes.len() * 4 / 5]).unwrap();
    let fault = stderr(&armid(["identify", &cut]).code(2));
    assert!(fault.contains("cut.mcap is cut off: it ends after 2") && fault.contains(".mcap.part"), "{fault}");
    std::fs::rename(&cut, path(folder.path(), "cut.mcap.part")).unwrap();
    let estimate = json(&armid(["identify", &path(folder.path(), "cut.mcap.part"), "--json"]).success());
    assert_eq!(estimate["periods"], 1);

    let other = write(folder.path(), "text.mcap", "t,q1,tau1\n0,1,2\n");
    let fault = stderr(&armid(["identify", &other]).code(2));
    assert!(fault.contains("text.mcap does not begin as an MCAP file does"), "{fault}");
    let mut damaged = bytes.clone();
    let at = bytes.len() / 2;
    damaged[at] ^= 0xff;
    let path = path(folder.path(), "damaged.mcap");
    std::fs::write(&path, &damaged).unwrap();
    let fault = stderr(&armid(["identify", &path]).code(2));
    assert!(fault.contains("damaged.mcap cannot be read as MCAP"), "{fault}");
}

#[test]
fn a_wrong_experiment_is_shown_with_line_and_column() {
    let folder = temporary();
    for (text, wanted) in [
        ("robot = \"crs-a460\"\ntrajectroy = \"T.toml\"\n", "x.toml:2:1: unknown field `trajectroy`"),
        ("robot = \"crs-a460\"\n", "missing field `trajectory`"),
        ("robot = \"crs-a640\"\ntrajectory = \"table-one\"\n", "did you mean \"crs-a460\""),
        ("robot = \"crs-a460\"\ntrajectory = \"table-two\"\n", "did you mean \"table-one\""),
        ("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = 0\n", "x.toml:3:11: periods is 0"),
        ("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nrate_hz = 333.33\n", "x.toml:3:11: a period of 10 s holds"),
        ("robot = \"crs-a460\"\ntrajectory = \"table-one\"\narm = \"analitic\"\n", "x.toml:3:7: arm is \"analitic\""),
        ("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nperiods = \n", "x.toml:3:11: "),
        (
            "robot = \"crs-a460\"\ntrajectory = \"table-one\"\n[sensing]\nposition_noise = [1, 2]\n",
            "x.toml:4:18: position_noise is [1.0, 2.0], expected 6 numbers",
        ),
        // The ramp of half a second asks for more acceleration than the joints may have.
        ("robot = \"crs-a460\"\ntrajectory = \"table-one\"\nramp_s = 0.05\n", "exceeds its limit"),
    ] {
        let file = write(folder.path(), "x.toml", text);
        let fault = stderr(&armid(["run", &file, "-o", &path(folder.path(), "R.mcap")]).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
        assert!(!folder.path().join("R.mcap.part").exists());
    }
    let fault = stderr(&armid(["run", "no-such-experiment"]).code(2));
    assert!(fault.contains("experiment \"no-such-experiment\" is neither a file"), "{fault}");
}

#[test]
fn the_default_place_is_reports_under_the_current_folder() {
    let folder = temporary();
    let experiment = experiment(folder.path(), 1);
    let output = Command::new(support::program()).args(["run", &experiment]).current_dir(folder.path()).output();
    assert!(output.unwrap().status.success());
    assert!(folder.path().join("reports/first/recording.mcap").is_file());
    let folder_itself = folder.path().to_str().unwrap();
    let again = stdout(&armid(["run", folder_itself, "-o", &path(folder.path(), "R.mcap")]).success());
    assert!(again.starts_with("first: completed"), "{again}");
}

/// An experiment of small periods: two joints, one second, 200 Hz.
fn short(folder: &Path, robot: &str, periods: usize, more: &str) -> String {
    let joint = |name: &str| format!("[[joint]]\nname = \"{name}\"\na = [0.3]\nb = [0.1]\nq0 = 0.2\n");
    let trajectory = format!("period_s = 1.0\nharmonics = 1\n{}{}", joint("shoulder"), joint("elbow"));
    write(folder, "T.toml", &trajectory);
    let text = format!(
        "robot = \"{robot}\"\ntrajectory = \"T.toml\"\nrate_hz = 200\nramp_s = 1.0\nperiods = {periods}\n{more}"
    );
    write(folder, "short.toml", &text)
}

/// Starts an experiment of a day, and waits until a part of it is in the file.
fn endless(folder: &Path, part: &str) -> Child {
    let child = Command::new(support::program())
        .args(["run", &experiment(folder, 8640), "-o", &path(folder, "R.mcap")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a program");
    // 13 s until the first period counts, 10 s of it, 300 kB a second.
    let enough = || std::fs::metadata(folder.join(part)).is_ok_and(|part| part.len() > 9_000_000);
    while !enough() {
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").args([name, &child.id().to_string()]).status().expect("kill");
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn an_interrupted_experiment_keeps_what_it_has() {
    let folder = temporary();
    let child = endless(folder.path(), "R.mcap.part");
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("stopped at t = ") && text.contains("R.mcap.part"), "{text}");
    assert!(!folder.path().join("R.mcap").exists());
    let estimate = json(&armid(["identify", &path(folder.path(), "R.mcap.part"), "--json"]).success());
    assert!(estimate["periods"].as_u64().unwrap() >= 1);
}

#[cfg(unix)]
#[test]
fn a_killed_experiment_leaves_its_chunks() {
    let folder = temporary();
    let child = endless(folder.path(), "R.mcap.part");
    signal(&child, "-KILL");
    child.wait_with_output().unwrap();
    let part = path(folder.path(), "R.mcap.part");
    let estimate = json(&armid(["identify", &part, "--json"]).success());
    assert!(estimate["periods"].as_u64().unwrap() >= 1);
    let text = stdout(&armid(["identify", &part]).success());
    assert!(text.contains("the recording is cut off"), "{text}");
}

#[cfg(unix)]
#[test]
fn identity_a_killed_experiment_goes_on_at_the_next_period() {
    let folder = temporary();
    let experiment = short(folder.path(), "planar-2r", 1_000_000, "");
    let (whole, part) = (path(folder.path(), "R.mcap"), path(folder.path(), "R.mcap.part"));
    let mut child = Command::new(support::program())
        .args(["run", &experiment, "-o", &whole])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("a program");
    // 40 kB a second: some 20 periods.
    while !std::fs::metadata(&part).is_ok_and(|part| part.len() > 1_000_000) {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let cut = json(&armid(["identify", &part, "--json"]).success());
    let kept = cut["periods"].as_u64().unwrap();
    assert!(kept >= 1);

    // Another seed is another experiment, and changes nothing.
    let before = std::fs::metadata(&part).unwrap().len();
    let resume = |more: &[&str]| {
        let periods = (kept + 2).to_string();
        let mut arguments = vec!["run", &experiment, "--resume", "--periods", &periods, "-o", &whole, "--json"];
        arguments.extend(more);
        armid(&arguments)
    };
    let fault = stderr(&resume(&["--seed", "9"]).code(2));
    assert!(fault.contains("seed is \"0\", expected \"9\""), "{fault}");
    assert_eq!(std::fs::metadata(&part).unwrap().len(), before);

    assert_eq!(json(&resume(&[]).success())["ending"], "completed");
    assert!(!Path::new(&part).exists());
    let joined = json(&armid(["identify", &whole, "--json"]).success());
    assert_eq!(joined["periods"].as_u64(), Some(kept + 2));
    let text = String::from_utf8_lossy(&std::fs::read(&whole).unwrap()).into_owned();
    let sessions = format!(
        "[{{\"first_period\":1,\"last_period\":{kept},\"run\":0}},{{\"first_period\":{},\"last_period\":{}",
        kept + 1,
        kept + 2
    );
    assert!(text.contains(&sessions), "{sessions}");
    assert_eq!(json(&resume(&[]).success())["already"], true);

    // The kept periods are those of an experiment that was not killed, and the new ones have noise of their own.
    let rows = |arguments: &[&str]| -> Vec<String> {
        let csv = path(folder.path(), "rows.csv");
        armid(arguments.iter().copied().chain(["-o", csv.as_str()])).success();
        std::fs::read_to_string(csv).unwrap().lines().skip(1).map(str::to_owned).collect()
    };
    let periods = (kept + 2).to_string();
    let alone = rows(&["run", &experiment, "--periods", &periods]);
    let resumed = rows(&["run", &experiment, "--periods", &periods, "--arm", "replay", "--recording", &whole]);
    assert_eq!(alone.len(), resumed.len());
    // 1 s at rest, 1 s of ramp, 1 discarded period, then the periods that count.
    let seam = 200 * (3 + kept as usize);
    assert_eq!(alone[..seam], resumed[..seam]);
    assert_ne!(alone[seam..seam + 200], resumed[seam..seam + 200]);
    let values = |row: &String| row.split(',').skip(1).map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    for (x, y) in alone[seam..].iter().zip(&resumed[seam..]) {
        // Another run has another encoder grid and other noise, and the same motion.
        assert!((values(x)[0] - values(y)[0]).abs() < 1e-3, "{x} against {y}");
    }
}

#[test]
fn a_first_run_goes_on_at_the_step_that_is_missing() {
    let folder = temporary();
    let experiment = short(folder.path(), "planar-2r", 1, "");
    let whole = path(folder.path(), "R.mcap");
    let first_run = |more: &[&str]| {
        let arguments = ["run", &experiment, "--first-run", "-o", &whole, "--json"];
        json(&armid(arguments.iter().chain(more)).success())
    };
    assert_eq!(first_run(&[])["steps"].as_array().unwrap().len(), 3);
    let full = std::fs::read(&whole).unwrap();
    std::fs::remove_file(&whole).unwrap();
    let resumed = first_run(&["--resume"]);
    assert_eq!((resumed["speed"].as_f64(), resumed["steps"].is_null()), (Some(1.0), true));
    assert!(std::fs::read(&whole).unwrap() == full);
    assert_eq!(first_run(&["--resume"])["already"], true);
}
