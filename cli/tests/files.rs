//! What the command writes and reads: only where a file may be, whole or absent, and no more than was meant.

mod support;

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use support::{armid, json, stderr, stdout, temporary, write};

/// The smallest study that there is.
const STUDY: &str = include_str!("../../fuzz/study.toml");

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// A text with one line replaced by another, found by its key.
fn with(text: &str, key: &str, value: &str) -> String {
    let keyed = |line: &str| line.split('=').next().is_some_and(|found| found.trim() == key);
    assert!(text.lines().any(keyed), "{key}");
    text.lines().map(|line| if keyed(line) { format!("{key} = {value}\n") } else { format!("{line}\n") }).collect()
}

/// Two joints, one second at 200 Hz.
fn experiment(folder: &Path, more: &str) -> String {
    let joint = |name: &str| format!("[[joint]]\nname = \"{name}\"\na = [0.3]\nb = [0.1]\nq0 = 0.2\n");
    write(folder, "T.toml", &format!("period_s = 1.0\nharmonics = 1\n{}{}", joint("shoulder"), joint("elbow")));
    let text = format!("robot = \"planar-2r\"\ntrajectory = \"T.toml\"\nramp_s = 1.0\nperiods = 3\n{more}");
    write(folder, "experiment.toml", &text)
}

/// Refused with exit status 2, a short sentence, and at once.
fn refused<A: AsRef<std::ffi::OsStr>>(arguments: &[A]) -> String {
    let began = Instant::now();
    let text = stderr(&armid(arguments).code(2));
    assert!(text.len() < 5_000, "{} bytes", text.len());
    assert!(began.elapsed() < Duration::from_secs(20), "{:?}", began.elapsed());
    // The reader of errors breaks lines.
    text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(unix)]
#[test]
fn nothing_but_a_file_is_written_to() {
    use std::os::unix::fs::FileTypeExt;
    use std::os::unix::net::UnixListener;

    let folder = temporary();
    let at = |name: &str| path(folder.path(), name);
    assert!(Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
    let _listener = UnixListener::bind(at("socket")).unwrap();
    std::fs::create_dir(at("folder")).unwrap();
    let experiment = experiment(folder.path(), "rate_hz = 200\n");
    let study = write(folder.path(), "study.toml", STUDY);
    for (place, kind) in [("/dev/null", "a device"), ("pipe", "a pipe"), ("socket", "a socket"), ("folder", "a folder")]
    {
        let place = if place.starts_with('/') { place.to_owned() } else { at(place) };
        for command in [&["robot", "planar-2r"][..], &["reduce", "planar-2r"], &["run", &experiment]] {
            let text = refused(&[command, &["-o", &place]].concat());
            assert!(text.contains(&format!("is {kind}, expected a regular file or a new one")), "{text}");
        }
        let design = ["design", "planar-2r", "--criterion", "condition", "-o", &place];
        assert!(refused(&design).contains(&format!("is {kind}")));
    }
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    assert!(std::fs::metadata(at("pipe")).unwrap().file_type().is_fifo());
    for place in ["/dev/null", &experiment] {
        assert!(refused(&["study", &study, "-o", place]).contains("expected a folder or a new one"));
    }
    assert!(refused(&["run", &experiment, "-o", "-"]).contains("-o is -, expected a file"));
    assert!(refused(&["study", &study, "-o", "-"]).contains("-o is -, expected a path"));
}

#[cfg(unix)]
#[test]
fn links_are_written_through_and_stay() {
    let folder = temporary();
    let at = |name: &str| path(folder.path(), name);
    std::fs::create_dir(at("far")).unwrap();
    let experiment = experiment(folder.path(), "rate_hz = 200\n");
    for (link, target, command) in [
        ("robot.json", "far/robot.json", &["robot", "planar-2r"][..]),
        ("R.mcap", "far/recorded.mcap", &["run", &experiment]),
    ] {
        std::os::unix::fs::symlink(target, at(link)).unwrap();
        armid(command.iter().copied().chain(["-o", &at(link)])).success();
        assert!(std::fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
        assert!(std::fs::metadata(at(target)).unwrap().len() > 100, "{target}");
    }
}

#[test]
fn a_dash_is_standard_output() {
    let folder = temporary();
    let run = |arguments: &[&str]| {
        let mut command = assert_cmd::Command::new(support::program());
        let assert = command.args(arguments).current_dir(folder.path()).assert().success();
        (stdout(&assert), stderr(&assert))
    };
    let (text, _) = run(&["robot", "planar-2r", "-o", "-"]);
    assert_eq!(text, run(&["robot", "planar-2r"]).0);
    let (text, _) = run(&["robot", "planar-2r", "--json", "-o", "-"]);
    assert_eq!(text, run(&["robot", "planar-2r", "--json"]).0);
    let design = ["design", "planar-2r", "--criterion", "condition", "--evaluations", "20", "--starts", "1"];
    let (text, _) = run(&[&design[..], &["-o", "-"]].concat());
    assert!(text.contains("\nperiod_s = ") && text.contains("[certificate]"), "{text}");
    run(&[&design[..], &["-o", "T.toml"]].concat());
    assert_eq!(text, std::fs::read_to_string(folder.path().join("T.toml")).unwrap());
    assert!(!folder.path().join("-").exists());
    let both = refused(&[&design[..], &["--json", "-o", "-"]].concat());
    assert!(both.contains("-o - and --json both use standard output"), "{both}");
}

#[test]
fn what_was_left_of_a_recording_is_never_written_over() {
    let folder = temporary();
    let experiment = experiment(folder.path(), "rate_hz = 200\n");
    for name in ["R.mcap", "R.csv", "R-50.mcap"] {
        let part = write(folder.path(), &format!("{name}.part"), "hours of work");
        let more = if name == "R-50.mcap" { &["--first-run"][..] } else { &[] };
        let place = path(folder.path(), if name == "R-50.mcap" { "R.mcap" } else { name });
        if name == "R-50.mcap" {
            std::fs::remove_file(path(folder.path(), "R.mcap.part")).unwrap();
        }
        let text = refused(&[&["run", &experiment, "-o", &place], more].concat());
        assert!(text.contains(".part is there") && text.contains("--resume continues it"), "{text}");
        assert_eq!(std::fs::read_to_string(&part).unwrap(), "hours of work");
        assert!(!folder.path().join("R-10.mcap").exists(), "a step was performed before the next had its place");
    }
}

#[test]
fn names_stay_inside_their_folder() {
    let folder = temporary();
    let experiment = experiment(folder.path(), "rate_hz = 200\nname = \"../../x\"\n");
    let text = refused(&["run", &experiment]);
    assert!(text.contains("experiment.toml:6:8: name is \"../../x\", expected a name that a file can have"), "{text}");
    let study = write(folder.path(), "study.toml", &STUDY.replace("name = \"fuzz\"", "name = \"../../x\""));
    assert!(refused(&["study", &study]).contains("study.toml:2:9: name is \"../../x\""));
    let study = write(folder.path(), "study.toml", &STUDY.replace("name = \"random\"", "name = \"../../x\""));
    assert!(refused(&["study", &study, "-o", &path(folder.path(), "out")]).contains("design.name is \"../../x\""));
    // A robot's name is its own matter, unless it is to be a folder.
    let urdf = r#"<robot name="../../x"><link name="world"/><link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/></inertial></link>
        <joint name="swing" type="continuous"><parent link="world"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"#;
    let robot = write(folder.path(), "robot.urdf", urdf);
    armid(["robot", &robot]).success();
    let text = refused(&["agree", &robot]);
    assert!(
        text.contains("name of the robot is \"../../x-agreement\"") && text.contains("-o chooses the place"),
        "{text}"
    );
}

#[test]
fn more_than_is_allowed_is_refused_at_once_with_the_limit() {
    let folder = temporary();
    for (key, value, words) in [
        (
            "runs",
            "1000000000000",
            "runs of all designs under all conditions is 2000000000000, expected at most 1000000",
        ),
        ("period_s", "1e9", "experiment.period_s is 1000000000 s, expected at most 100000 s"),
        ("harmonics", "100000", "experiment.harmonics is 100000, expected at most 200"),
        ("rate_hz", "1e9", "experiment.rate_hz is 1000000000 Hz, expected at most 100000 Hz"),
        ("estimators", "[]", "identification.estimators is [], expected at least one name"),
    ] {
        let study = write(folder.path(), "study.toml", &with(STUDY, key, value));
        let text = refused(&["study", &study, "-o", &path(folder.path(), "out")]);
        let line = 1 + with(STUDY, key, value).lines().position(|line| line.starts_with(key)).unwrap();
        assert!(text.contains(words) && text.contains(&format!("study.toml:{line}:")), "{text}");
    }
    let slow = experiment(folder.path(), "rate_hz = 1e9\n");
    let text = refused(&["run", &slow, "-o", &path(folder.path(), "R.mcap")]);
    assert!(text.contains("rate_hz is 1000000000 Hz, expected at most 100000 Hz: no joint controller"), "{text}");
    let text = refused(&["run", &slow, "--periods", "18446744073709551615"]);
    assert!(text.contains("expected at most"), "{text}");
    for (option, value) in [("--harmonics", "100000"), ("--period", "1e9"), ("--starts", "1000000000000")] {
        let text = refused(&["design", "planar-2r", "--criterion", "condition", option, value]);
        assert!(text.contains(&format!("{option} is ")) && text.contains("expected at most"), "{text}");
    }

    // A joint too many.
    let joint = |k: usize| {
        format!(
            "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{k}\"/></joint>",
            k - 1
        )
    };
    let chain: String = (1..=101).map(joint).collect();
    let robot = write(folder.path(), "long.urdf", &format!("<robot name=\"long\"><link name=\"l0\"/>{chain}</robot>"));
    let text = refused(&["reduce", &robot]);
    assert!(text.contains("number of joints is 101, expected at most 100"), "{text}");

    // One line of 50 MB, as headings and as a row.
    for (head, what) in [("", "log.csv:1:1"), ("t,q1,q2,tau1,tau2\n", "log.csv:2:1")] {
        let log = write(folder.path(), "log.csv", &format!("{head}{}", "1,".repeat(25_000_000)));
        let text = refused(&["identify", &log, "--robot", "planar-2r"]);
        assert!(
            text.contains(what) && text.contains("length of the line is 50000000 bytes, expected at most 65536"),
            "{text}"
        );
    }
}

#[test]
fn an_empty_list_of_estimates_validates_nothing() {
    let folder = temporary();
    let experiment = experiment(folder.path(), "rate_hz = 200\n");
    let recording = path(folder.path(), "R.mcap");
    armid(["run", &experiment, "-o", &recording]).success();
    let list = write(folder.path(), "l.json", "[]");
    let text = refused(&["validate", &list, &recording]);
    assert!(text.contains("holds an empty list, expected at least one estimate"), "{text}");
    // Lists within it have lengths that belong together.
    let estimate = path(folder.path(), "E.json");
    armid(["identify", &recording, "--columns", "rigid", "-o", &estimate]).success();
    let mut json: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&estimate).unwrap()).unwrap();
    json["covariance"][0] = serde_json::json!([]);
    let cut = write(folder.path(), "cut.json", &json.to_string());
    let text = refused(&["validate", &cut, &recording]);
    assert!(text.contains("a row of covariance has 0 entries, expected"), "{text}");
}

#[test]
fn negative_masses_are_refused_and_impossible_bodies_are_named() {
    let folder = temporary();
    let urdf = |mass: &str, ixx: &str| {
        format!(
            "<robot name=\"x\"><link name=\"world\"/><link name=\"rod\"><inertial><mass value=\"{mass}\"/>\n<inertia ixx=\"{ixx}\" \
             ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link><joint name=\"swing\" \
             type=\"continuous\"><parent link=\"world\"/><child link=\"rod\"/></joint></robot>"
        )
    };
    let robot = write(folder.path(), "x.urdf", &urdf("-1", "0.1"));
    assert!(refused(&["robot", &robot]).contains("value is -1, expected a number not below zero"));
    let mjcf = "<mujoco><worldbody><body><joint/><inertial pos=\"0 0 0\" mass=\"-1\" diaginertia=\"1 1 1\"/></body></worldbody></mujoco>";
    let robot = write(folder.path(), "x.xml", mjcf);
    assert!(refused(&["robot", &robot]).contains("mass is -1, expected a number not below zero"));
    for (ixx, impossible) in [("0.1", false), ("0.2", false), ("0.3", true), ("-0.1", true)] {
        let robot = write(folder.path(), "x.urdf", &urdf("1", ixx));
        let remarks = json(&armid(["robot", &robot, "--json"]).success())["remarks"].to_string();
        assert_eq!(remarks.contains("is physically inconsistent"), impossible, "{ixx}: {remarks}");
    }
}

/// A stored study, and the journal of the same one before its end.
fn stored(folder: &Path) -> (String, String, Vec<String>) {
    let study = write(folder, "study.toml", STUDY);
    let (done, part) = (path(folder, "done"), path(folder, "part"));
    armid(["study", &study, "-o", &done]).success();
    armid(["study", &study, "--shard", "1/1", "-o", &part]).success();
    let journal = std::fs::read_to_string(folder.join("part/journal.jsonl")).expect("a journal");
    (study, done, journal.split_inclusive('\n').map(str::to_owned).collect())
}

#[test]
fn an_altered_journal_is_refused_with_its_line_and_no_work_is_lost() {
    let folder = temporary();
    let (study, done, lines) = stored(folder.path());
    // A header, two designs, two runs of each.
    assert_eq!(lines.len(), 7);
    let out = path(folder.path(), "out");
    let journal = folder.path().join("out/journal.jsonl");
    let resume = |text: &str| {
        let _ = std::fs::remove_dir_all(&out);
        std::fs::create_dir(&out).unwrap();
        std::fs::write(&journal, text).unwrap();
        armid(["study", &study, "--resume", "-o", &out])
    };
    let run = lines.iter().position(|line| line.contains("\"run\":1")).unwrap();
    let mut altered = lines.clone();
    altered[run] = altered[run].replace("\"run\":1", "\"run\":0");
    let mut missing = lines.clone();
    missing.remove(3);
    let mut moved = lines.clone();
    moved.swap(5, 6);
    let mut noise = lines.clone();
    noise[2] = "\0\0\0\n".to_owned();
    for (what, lines, line) in
        [("altered", altered, run + 1), ("missing", missing, 4), ("moved", moved, 6), ("noise", noise, 3)]
    {
        let text = stderr(&resume(&lines.concat()).code(2));
        assert!(text.contains(&format!("journal.jsonl:{line}: ")), "{what}: {text}");
        assert_eq!(std::fs::read_to_string(&journal).unwrap(), lines.concat(), "{what}");
    }
    // Cut anywhere behind the header it is gone on with, byte for byte.
    let expected = std::fs::read(folder.path().join("done/runs.parquet")).unwrap();
    let whole = lines.concat();
    for cut in [0, 30, lines[0].len(), lines[0].len() + 100, whole.len() - 1, whole.len()] {
        resume(&whole[..cut]).success();
        assert_eq!(std::fs::read(folder.path().join("out/runs.parquet")).unwrap(), expected, "cut at {cut}");
        assert_eq!(
            std::fs::read(folder.path().join("out/summary.json")).unwrap(),
            std::fs::read(Path::new(&done).join("summary.json")).unwrap()
        );
    }
    // One of an older armid says so, and is kept where it is begun anew, as is every one before.
    let old = "{\"armid\":\"0.1.0\",\"plan_sha256\":\"x\"}\n{\"run\":{}}\n";
    assert!(stderr(&resume(old).code(2)).contains("has no checksums: an older armid wrote it"));
    armid(["study", &study, "-o", &out]).success();
    std::fs::write(&journal, &whole).unwrap();
    armid(["study", &study, "-o", &out]).success();
    assert_eq!(std::fs::read_to_string(folder.path().join("out/journal-before.jsonl")).unwrap(), old);
    assert_eq!(std::fs::read_to_string(folder.path().join("out/journal-before-2.jsonl")).unwrap(), whole);
}

#[test]
fn work_that_does_not_fit_its_study_is_refused() {
    let folder = temporary();
    let (study, _, lines) = stored(folder.path());
    let entry = |line: &String| -> serde_json::Value {
        serde_json::from_str::<serde_json::Value>(line).unwrap()["entry"].clone()
    };
    let entries: Vec<serde_json::Value> = lines.iter().map(entry).collect();
    let run = entries.iter().position(|entry| entry["run"].is_object()).unwrap();
    let design = entries.iter().position(|entry| entry["design"].is_object()).unwrap();
    for (at, key, value, words) in [
        (run, "/run/outcome/design", serde_json::json!(999), "the design of a run is 999, expected less than 2"),
        (run, "/run/outcome/run", serde_json::json!(999), "the number of a run is 999, expected less than 2"),
        (run, "/run/outcome/condition", serde_json::json!(1), "the condition of run"),
        (run, "/run/outcome/estimates", serde_json::json!([]), "the number of estimates of run"),
        (run, "/run/outcome/estimates/0/beta", serde_json::json!([]), "the number of estimates by ols in run"),
        (design, "/design/index", serde_json::json!(999), "the number of a design is 999, expected less than 2"),
        (design, "/design/bound", serde_json::json!([]), "the number of bounds of design"),
    ] {
        let mut altered = entries.clone();
        *altered[at].pointer_mut(key).unwrap_or_else(|| panic!("{key}")) = value;
        // With checksums that fit.
        let mut chain = armid_io::study::LineChain::default();
        let text: String = altered.iter().map(|entry| chain.line(&entry.to_string())).collect();
        let out = path(folder.path(), "misfit");
        let _ = std::fs::remove_dir_all(&out);
        std::fs::create_dir(&out).unwrap();
        write(Path::new(&out), "journal.jsonl", &text);
        let text = refused(&["study", &study, "--resume", "-o", &out]);
        assert!(text.contains(words), "{key}: {text}");
    }
}

#[test]
fn a_summary_that_is_cut_or_altered_is_refused() {
    let folder = temporary();
    let (_, done, _) = stored(folder.path());
    let summary = folder.path().join("done/summary.json");
    let whole = std::fs::read_to_string(&summary).unwrap();
    for part in [1, 10, 50, 90, 99] {
        std::fs::write(&summary, &whole[..whole.len() * part / 100]).unwrap();
        let text = refused(&["report", &done]);
        assert!(text.contains("summary.json:"), "{text}");
    }
    let json: serde_json::Value = serde_json::from_str(&whole).unwrap();
    for (key, value, words) in [
        ("/conditions", serde_json::json!([]), "the number of conditions is 0, expected 1"),
        ("/designs/0/family", serde_json::json!(999), "the family of a design is 999, expected less than 1"),
        ("/bounds", serde_json::json!([]), "the number of lists of bounds is 0"),
        ("/parameters", serde_json::json!([]), "expected 0"),
        ("/plan/name", serde_json::json!("../../x"), "name is \"../../x\""),
        ("/conditions/0/findings/design_prediction", serde_json::json!([]), "the number of estimators is 0"),
        ("/conditions/0/findings/families/0/values", serde_json::json!([]), "the number of values of a family is 0"),
    ] {
        let mut altered = json.clone();
        *altered.pointer_mut(key).unwrap_or_else(|| panic!("{key}")) = value;
        std::fs::write(&summary, altered.to_string()).unwrap();
        let text = refused(&["report", &done]);
        assert!(text.contains(words), "{key}: {text}");
    }
    std::fs::write(&summary, &whole).unwrap();
    armid(["report", &done]).success();
}

#[cfg(unix)]
#[test]
fn work_that_keeps_nothing_ends_at_the_first_signal() {
    let folder = temporary();
    // Waits for an estimate that never comes.
    let pipe = path(folder.path(), "pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut child = Command::new(support::program()).args(["export", &pipe, "--to", "urdf"]).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if began.elapsed() > Duration::from_secs(10) {
            child.kill().unwrap();
            panic!("deaf to SIGTERM");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
