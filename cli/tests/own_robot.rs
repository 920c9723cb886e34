//! A robot of one's own: a robot file over a URDF, a folder to begin with, and the lines of the READMEs.

mod support;
#[path = "support/own_robot.rs"]
mod own_robot;

use std::path::Path;

use assert_cmd::assert::Assert;
use support::{armid, json, stderr, stdout, temporary, write};

/// The commands of the first block of shell lines below a heading of a Markdown text.
fn shell_lines<'a>(markdown: &'a str, heading: &str) -> Vec<&'a str> {
    let section = markdown.split_once(heading).unwrap_or_else(|| panic!("{heading} not in {markdown}")).1;
    let block = section.split("```sh\n").nth(1).expect("a block of shell lines").split("```").next().expect("its end");
    block.lines().filter(|line| !line.trim().is_empty()).collect()
}

/// Runs one line of shell in a folder: `armid`, words in quotes, a comment at the end.
fn run(line: &str, folder: &Path) -> Assert {
    let (mut words, mut word, mut quoted) = (Vec::new(), String::new(), false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            '#' if !quoted && word.is_empty() => break,
            ' ' if !quoted => {
                if !word.is_empty() {
                    words.push(std::mem::take(&mut word));
                }
            }
            c => word.push(c),
        }
    }
    words.extend((!word.is_empty()).then_some(word));
    assert_eq!(words[0], "armid", "{line}");
    let mut command = assert_cmd::Command::new(support::program());
    command.current_dir(folder).args(&words[1..]).assert()
}

#[test]
fn every_line_of_ones_own_robot_in_ten_minutes_is_executed() {
    let folder = temporary();
    write(folder.path(), "arm.urdf", &own_robot::urdf());
    own_robot::log(folder.path(), "arm.urdf", "log.csv", 0.0);
    own_robot::log(folder.path(), "arm.urdf", "other.csv", 0.9);
    let readme = include_str!("../../README.md");
    let lines = shell_lines(readme, "## Your robot in ten minutes");
    assert!(lines.len() >= 6, "{lines:?}");
    for line in lines {
        let done = run(line, folder.path());
        assert_eq!(done.get_output().status.code(), Some(0), "{line}\n{}{}", stdout(&done), stderr(&done));
    }
    // The log tells what the URDF does not: rotors of the first joints, within three standard deviations.
    let estimate: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("E.json")).unwrap()).unwrap();
    assert!(estimate["held_out"]["used_rows"]["total"].as_f64().unwrap() < 0.1, "{}", estimate["held_out"]);
    assert!(folder.path().join("identified.urdf").is_file() && folder.path().join("report/report.html").is_file());

    // The right angles of the URDF are written 1.5708, and what that changes is said.
    let export = "armid export E.json --to urdf -o again.urdf";
    let done = json(&run(&format!("{export} --json"), folder.path()).success());
    let (snapped, torque) = (&done["snapped"], &done["snapped"]["torque"]);
    let names: Vec<&str> =
        snapped["joints"].as_array().unwrap().iter().map(|joint| joint["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["joint_2", "joint_4"]);
    assert!(
        (snapped["largest_angle_rad"].as_f64().unwrap()
            - ("1.5708".parse::<f64>().unwrap() - std::f64::consts::FRAC_PI_2))
            .abs()
            < 1e-15
    );
    for key in ["rms", "largest", "relative_rms"] {
        let of_each: Vec<f64> = torque[key].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        // Millionths of a radian are no more than about as many parts of the torque.
        assert!(of_each.len() == 6 && of_each.iter().all(|x| (1e-9..1e-2).contains(x)), "{key}: {of_each:?}");
    }
    let text = stdout(&run(&export.replace("again", "once-more"), folder.path()).success());
    assert!(
        text.contains("up to 3.7e-6 rad off right ones (joint_2,") && text.contains("of a joint's torque"),
        "{text}"
    );
}

#[test]
fn a_folder_to_begin_with_runs_as_its_own_readme_says() {
    let folder = temporary();
    let urdf = write(folder.path(), "arm.urdf", &own_robot::urdf());
    let lab = folder.path().join("lab");
    let made = json(&armid(["init", &urdf, "-o", lab.to_str().unwrap(), "--json"]).success());
    assert_eq!(made["files"].as_array().unwrap().len(), 6);
    // One step after the other: a bare URDF asks for a folder, its robot file for a motion or a log.
    assert!(stdout(&armid(["robot", &urdf]).success()).contains(&format!("next: armid init {urdf}\n")));
    let robot = lab.join("robot.toml").display().to_string();
    let text = stdout(&armid(["robot", &robot]).success());
    assert!(text.contains(&format!("armid advise {robot}\n")) && text.contains("armid identify LOG "), "{text}");
    let readme = std::fs::read_to_string(lab.join("README.md")).unwrap();
    for heading in ["The next three commands", "Afterwards:"] {
        for line in shell_lines(&readme, heading) {
            let done = run(line, &lab);
            assert_eq!(done.get_output().status.code(), Some(0), "{line}\n{}{}", stdout(&done), stderr(&done));
        }
    }
    // Without a word about periods: those of the motion are found, and friction is that of the URDF.
    let estimate: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(lab.join("E.json")).unwrap()).unwrap();
    let remarks = estimate["logs"][0]["remarks"].to_string();
    // The motion repeats from 3 s, the end of the ramp, to 63 s; five whole periods leave the first out.
    let from = remarks.split("10.0 s period found, 5 of them from ").nth(1).and_then(|rest| rest.split(" s").next());
    assert!(from.is_some_and(|from| (3.0..=13.0).contains(&from.parse().unwrap())), "{remarks}");
    for parameter in estimate["base"].as_array().unwrap() {
        let (name, value) = (parameter["name"].as_str().unwrap(), parameter["value"].as_f64().unwrap());
        let expected = name[2..].parse::<f64>().ok().and_then(|n| match &name[..2] {
            "Fv" => Some(8.0 / n),
            "Fc" => Some(5.0 / n),
            _ => None,
        });
        assert!(expected.is_none_or(|expected| (value / expected - 1.0).abs() < 0.02), "{name}: {value}");
    }
    // Nothing is written over, and nothing is written where one file is there.
    let robot = std::fs::read_to_string(lab.join("robot.toml")).unwrap();
    let text = stderr(&armid(["init", &urdf, "-o", lab.to_str().unwrap()]).code(2));
    assert!(text.contains("is there already") && text.contains("-o chooses another folder"), "{text}");
    assert_eq!(std::fs::read_to_string(lab.join("robot.toml")).unwrap(), robot);
    let begun = folder.path().join("begun");
    std::fs::create_dir(&begun).unwrap();
    write(&begun, "log.toml", "mine");
    armid(["init", &urdf, "-o", begun.to_str().unwrap()]).code(2);
    assert_eq!(std::fs::read_dir(&begun).unwrap().count(), 1);
    // Beside the URDF itself.
    armid(["init", &urdf, "-o", folder.path().to_str().unwrap()]).success();
    assert_eq!(std::fs::read_to_string(&urdf).unwrap(), own_robot::urdf());
    armid(["robot", folder.path().join("robot.toml").to_str().unwrap()]).success();
}

#[test]
fn joints_whose_friction_is_far_above_their_inertia_follow_in_a_rehearsal() {
    // As in URDFs of light arms: 6 N·m·s/rad on a wrist, and 2 N·m of dry friction on a flange of 2e-4 kg·m².
    let folder = temporary();
    let mut urdf = own_robot::urdf();
    for (n, wrist) in [(5_u8, "damping=\"6\" friction=\"0.5\""), (6, "damping=\"0\" friction=\"2\"")] {
        let (damping, friction) = (8.0 / f64::from(n), 5.0 / f64::from(n));
        let written = format!("damping=\"{damping}\" friction=\"{friction}\"");
        assert!(urdf.contains(&written), "{urdf}");
        urdf = urdf.replace(&written, wrist);
    }
    let urdf = urdf.replace("mass value=\"0.5\"", "mass value=\"0.05\"").replace("\"0.001\"", "\"0.0001\"");
    let urdf = write(folder.path(), "arm.urdf", &urdf);
    let lab = folder.path().join("lab");
    armid(["init", &urdf, "-o", lab.to_str().unwrap()]).success();
    let mut motion = "period_s = 10.0\nharmonics = 2\n".to_owned();
    for n in 1..=6 {
        let phase = 1.9 * f64::from(n);
        let [a, b] = [0.9 * phase.cos(), 0.9 * phase.sin()];
        motion += &format!("\n[[joint]]\nname = \"joint_{n}\"\na = [{a:?}, 0.2]\nb = [{b:?}, -0.3]\nq0 = 0.1\n");
    }
    write(&lab, "trajectory.toml", &motion);
    let not_followed = |log: &str| {
        let line = ["run", "experiment.toml", "-o", log, "--periods", "1", "--json"];
        let done = assert_cmd::Command::new(support::program()).current_dir(&lab).args(line).assert().success();
        json(&done)["tracking"]["not_followed"].clone()
    };
    assert_eq!(not_followed("log.csv"), serde_json::json!([]));
    // A servo that knows of inertia alone leaves them behind.
    let robot = std::fs::read_to_string(lab.join("robot.toml")).unwrap();
    assert!(robot.contains("\nfriction = true "), "{robot}");
    write(&lab, "robot.toml", &robot.replace("\nfriction = true ", "\nfriction = false "));
    let behind = not_followed("other.csv");
    assert!(behind.as_array().unwrap().iter().any(|joint| joint == "joint_6"), "{behind}");
}

#[test]
fn a_robot_file_over_a_urdf_is_a_robot_everywhere() {
    let folder = temporary();
    let urdf = write(folder.path(), "arm.urdf", &own_robot::urdf());
    let file = folder.path().join("sub/robot.toml");
    let file = file.to_str().unwrap();
    let made = json(&armid(["robot", &urdf, "-o", file, "--json"]).success());
    assert!(made["gaps"].as_u64().unwrap() > 40, "{made}");
    let text = std::fs::read_to_string(file).unwrap();
    assert!(text.contains("urdf = \"../arm.urdf\"") && text.contains("# rotor_kg_m2 = ?"), "{text}");
    assert!(stderr(&armid(["robot", &urdf, "-o", file]).code(2)).contains("is there already"));

    // As it stands it is the URDF, friction smooth about rest aside.
    let [from_urdf, from_file] = [&urdf, file].map(|name| json(&armid(["robot", name, "--json"]).success()));
    for key in ["joints", "parameters", "gravity_m_s2", "effort"] {
        let mut expected = from_urdf[key].clone();
        if key == "joints" {
            for joint in expected.as_array_mut().unwrap() {
                joint["drive"]["coulomb_velocity_rad_s"] = 0.01.into();
            }
        }
        assert_eq!(from_file[key], expected, "{key}");
    }
    let reduced = |name: &str| stdout(&armid(["reduce", name, "--columns", "rigid+rotor+friction"]).success());
    assert_eq!(reduced(&urdf), reduced(file));

    // A change of either file is another robot.
    let sha = |name: &str| json(&armid(["robot", name, "--json"]).success())["provenance"]["robot_sha256"].clone();
    let before = sha(file);
    write(folder.path(), "arm.urdf", &own_robot::urdf().replace("mass value=\"6\"", "mass value=\"7\""));
    assert_ne!(sha(file), before);

    // Faults are shown in the file that has them.
    write(folder.path(), "arm.urdf", &own_robot::urdf().replace("type=\"revolute\"", "type=\"rotary\""));
    let fault = stderr(&armid(["robot", file]).code(2));
    assert!(fault.contains("arm.urdf:") && fault.contains("joint type is \"rotary\""), "{fault}");
    std::fs::remove_file(&urdf).unwrap();
    let fault = stderr(&armid(["robot", file]).code(2));
    assert!(fault.contains("URDF not found") && fault.contains("robot.toml:"), "{fault}");

    // A bundled robot is a beginning too.
    let copy = folder.path().join("mine.toml");
    armid(["robot", "planar-2r", "-o", copy.to_str().unwrap()]).success();
    armid(["reduce", copy.to_str().unwrap()]).success();
    let fault =
        stderr(&armid(["robot", copy.to_str().unwrap(), "-o", file.replace("robot", "other").as_str()]).code(2));
    assert!(fault.contains("is no URDF") && fault.contains("`armid robot` lists"), "{fault}");
}

#[test]
fn a_log_of_currents_asks_for_the_constants_of_the_joints_that_lack_them() {
    let folder = temporary();
    write(folder.path(), "arm.urdf", &own_robot::urdf());
    own_robot::log(folder.path(), "arm.urdf", "log.csv", 0.0);
    let log = folder.path().join("log.csv");
    let known: String = (1..=6)
        .map(|n| {
            let constant = if n == 5 { "" } else { "torque_constant_nm_a = 0.1\n" };
            format!("[[joint]]\nname = \"joint_{n}\"\n[joint.drive]\ngear = 100\n{constant}")
        })
        .collect();
    let robot = write(folder.path(), "robot.toml", &format!("urdf = \"arm.urdf\"\n{known}"));
    let map = "t=time_ms, q=pos_[1-6] deg, current=torque_[1-6]";
    let fault = stderr(&armid(["identify", log.to_str().unwrap(), "--robot", &robot, "--map", map]).code(2));
    assert!(fault.contains("no torque constant of the joints joint_5"), "{fault}");
    assert!(fault.contains("armid robot arm.urdf -o robot.toml"), "{fault}");
}
