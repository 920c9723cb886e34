//! `armid robot` and what every command shares: exit codes, errors, JSON, output.

mod support;

use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use support::{armid, json, program, stderr, stdout, temporary};

#[test]
fn no_command_and_an_unknown_one_are_usage_errors() {
    armid::<&str>([]).code(2);
    armid(["identfy"]).code(2);
    armid(["robot", "--quiet", "--verbose"]).code(2);
}

#[test]
fn every_command_explains_itself() {
    let text = stdout(&armid(["--help"]).success());
    assert!(text.contains("Exit status"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    let listed = text.split("Commands:").nth(1).expect("commands").split("\n\n").next().expect("a list");
    let commands: Vec<&str> = listed
        .lines()
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|c| !c.is_empty())
        .collect();
    for command in
        ["robot", "reduce", "dynamics", "design", "run", "identify", "validate", "controller", "doctor", "completions"]
    {
        assert!(commands.contains(&command), "{command} not in {commands:?}");
    }
    for command in commands.into_iter().filter(|&command| command != "help") {
        let text = stdout(&armid([command, "--help"]).success());
        assert!(text.contains("Example"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}

#[test]
fn bundled_robots_are_listed_and_shown() {
    let list = json(&armid(["robot", "--json"]).success());
    let names: Vec<&str> = list.as_array().unwrap().iter().map(|robot| robot["name"].as_str().unwrap()).collect();
    assert!(names.contains(&"crs-a460"), "{names:?}");
    for name in names {
        let text = stdout(&armid(["robot", name]).success());
        assert!(text.starts_with(name) && text.contains(&format!("armid advise {name}\n")), "{text}");
        assert!(text.lines().count() <= 50, "{text}");
        let shown = json(&armid(["robot", name, "--json"]).success());
        for key in ["name", "dof", "gravity_m_s2", "effort", "joints", "nominal", "servo", "provenance"] {
            assert!(shown.get(key).is_some(), "{name}: {key}");
        }
        assert_eq!(shown["joints"].as_array().unwrap().len(), shown["dof"].as_u64().unwrap() as usize);
    }
}

/// Figures of the data sheet: `models/crs-a460/README.md` has the sources.
#[test]
fn published_figures_of_the_a460_are_shown() {
    let shown = json(&armid(["robot", "crs-a460", "--json"]).success());
    assert_eq!(shown["dof"], 6);
    assert_eq!(shown["joints"][0]["dh"]["d_m"], 0.3302);
    assert_eq!(shown["joints"][1]["limits"]["effort"], 66.08);
    assert_eq!(shown["joints"][3]["drive"]["counts_per_revolution"], 202_000.0);
    let text = stdout(&armid(["robot", "crs-a460"]).success());
    assert!(text.contains("-175 … 175") && text.contains("66.08 N·m"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
}

#[test]
fn a_wrong_name_is_answered_with_the_right_one() {
    let text = stderr(&armid(["robot", "crs-a640"]).code(2));
    assert!(text.contains("robot \"crs-a640\" is neither a bundled robot nor a file"), "{text}");
    assert!(text.contains("did you mean \"crs-a460\"?"), "{text}");
    let text = stderr(&armid(["robot", "nowhere/arm.urdf"]).code(2));
    assert!(text.contains("robot file not found: nowhere/arm.urdf"), "{text}");
}

#[test]
fn a_broken_robot_file_is_shown_with_line_and_column() {
    let folder = temporary();
    let good = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../models/crs-a460/robot.toml")).unwrap();
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, &good).unwrap();
    armid(["robot", path.to_str().unwrap()]).success();
    let line = good.lines().position(|line| line.starts_with("gear = ")).unwrap() + 1;
    for (from, to, wanted) in [
        ("\ngear = ", "\ngaer = ", format!("robot.toml:{line}:1: unknown field `gaer`")),
        ("\ngear = 100", "\ngear = -100", format!("robot.toml:{line}:8: ")),
        ("\ngear = 100", "\ngear = ", format!("robot.toml:{line}:8: ")),
    ] {
        std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let text = stderr(&armid(["robot", path.to_str().unwrap()]).code(2));
        assert!(text.contains(&wanted), "{wanted} not in {text}");
    }
    std::fs::write(&path, good.replacen("\ngear = ", "\ngaer = ", 1)).unwrap();
    let text = stderr(&armid(["robot", path.to_str().unwrap()]).code(2));
    assert!(text.contains("did you mean \"gear\"?"), "{text}");
    std::fs::write(&path, b"name = \"\xff\"\n").unwrap();
    let text = stderr(&armid(["robot", path.to_str().unwrap()]).code(2));
    assert!(text.contains("robot.toml:1: byte 8 is not UTF-8"), "{text}");
}

#[test]
fn a_chain_is_chosen_in_a_tree_only() {
    let text = stderr(&armid(["robot", "crs-a460", "--tip-link", "tool"]).code(2));
    assert!(text.contains("tip_link chooses a chain in a URDF or MJCF tree"), "{text}");
}

#[test]
fn output_goes_into_a_whole_file_and_nothing_is_left_beside_it() {
    let folder = temporary();
    let path = folder.path().join("new/folder/robot.json");
    let text = stdout(&armid(["robot", "crs-a460", "-o", path.to_str().unwrap()]).success());
    assert_eq!(text, "");
    let written = std::fs::read_to_string(&path).unwrap();
    assert_eq!(written, stdout(&armid(["robot", "crs-a460", "--json"]).success()));
    assert_eq!(std::fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    let blocked = path.join("below-a-file.json");
    let text = stderr(&armid(["robot", "-o", blocked.to_str().unwrap()]).code(2));
    assert!(text.contains("cannot be written"), "{text}");
}

#[test]
fn completions_are_made_for_each_shell() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = stdout(&armid(["completions", shell]).success());
        assert!(script.contains("armid") && script.contains("robot"), "{shell}");
    }
    armid(["completions", "tcsh"]).code(2);
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let mut child = Command::new(program())
        .args(["completions", "zsh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{output:?}");
    assert!(output.stderr.is_empty(), "{output:?}");
}

#[test]
fn a_controller_whose_middleware_has_ended_says_so() {
    // A process that is stopped and continued: RustDDS 0.15.1 takes the interrupted wait for the end.
    let arguments = ["controller", "planar-2r", "--domain", "231", "--rate", "10", "--duration", "60", "--quiet"];
    let mut controller = Command::new(program()).args(arguments).stderr(Stdio::piped()).spawn().unwrap();
    let id = controller.id().to_string();
    for _ in 0..5 {
        sleep(Duration::from_millis(500));
        for signal in ["-STOP", "-CONT"] {
            assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
            sleep(Duration::from_millis(200));
        }
        if controller.try_wait().unwrap().is_some() {
            break;
        }
    }
    let done = controller.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(!done.status.success() && said.contains("a thread of the middleware has ended"), "{done:?}");
}
