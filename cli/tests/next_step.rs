//! Every error names a command that helps on, and it is one that there is.

mod support;

use support::{armid, experiment, stderr, stdout, temporary, write};

/// The commands that a text names between backquotes.
fn named(text: &str) -> Vec<&str> {
    text.split("`armid ").skip(1).filter_map(|rest| rest.split([' ', '`']).next()).collect()
}

#[test]
fn every_error_names_a_command_that_helps_on() {
    let listed = stdout(&armid(["--help"]).success());
    let listed: Vec<&str> = listed.lines().filter_map(|line| line.trim_start().split(' ').next()).collect();
    let folder = temporary();
    let at = |name: &str, text: &str| write(folder.path(), name, text);
    let empty = at("empty.csv", "");
    let words = at("words.csv", "t,q1\n0,left\n");
    let cut = at("cut.toml", "name = \"cut\"\n[[joint]\n");
    let robot = at("robot.toml", "name = \"arm\"\nkinematics = \"none\"\n");
    let urdf = at("arm.urdf", "<robot name=\"arm\"><link name=\"a\"/>");
    let recording = at("R.mcap", "not a recording");
    let estimate = at("E.json", "{\"estimator\": \"wls\"}");
    let states = at("S.csv", "q1,q2\n0,0\n");
    let study = at("study.toml", "name = \"s\"\nruns = -1\n");
    let plan = experiment(folder.path(), 0);
    let missing = folder.path().join("nothing.json").display().to_string();
    let output = folder.path().display().to_string();
    let asked: &[&[&str]] = &[
        &["robot", "crs"],
        &["robot", &cut],
        &["robot", &robot],
        &["robot", &urdf],
        &["init", &missing],
        &["init", &urdf],
        &["agree", "none"],
        &["agree", "crs-a460", "--trajectory", &cut],
        &["reduce", &robot],
        &["reduce", "crs-a460", "--columns", "rigid+speed"],
        &["dynamics", "planar-2r", "--states", &states, "--quantity", "torque"],
        &["dynamics", "planar-2r", "--states", &missing, "--quantity", "torque"],
        &["design", "crs-a460", "--criterion", "d-optimal", "--starts", "0"],
        &["design", "crs-a460", "--criterion", "d-optimal", "--from", &cut],
        &["design", "crs-a460", "--criterion", "d-optimal", "-o", &output],
        &["run", &cut],
        &["run", &plan],
        &["run", "none"],
        &["calibrate", "friction", "crs-a460", "--joint", "9"],
        &["calibrate", "torque-constant", "crs-a460", "--joint", "waist", "--recording", &recording],
        &["monitor", "none"],
        &["identify", &empty, "--robot", "crs-a460"],
        &["identify", &words, "--robot", "crs-a460"],
        &["identify", &recording],
        &["identify", &missing],
        &["identify", &words],
        &["identify", &words, "--robot", "crs-a460", "--held-out", "200%"],
        &["identify", "--payload", "--without", &estimate, "--with", &words],
        &["validate", &missing, &recording],
        &["validate", &estimate, &recording],
        &["export", &estimate, "--to", "urdf"],
        &["export", &cut, "--to", "toml"],
        &["study", "none"],
        &["study", &study],
        &["study", "plan", &output],
        &["study", "merge", &output],
        &["study", "status", &output],
        &["report", &missing],
        &["report", &output],
        &["controller", "none"],
    ];
    for arguments in asked {
        let fault = stderr(&armid(*arguments).code(2));
        let commands = named(&fault);
        // A fault of the command line itself is the parser's, which names the help of the command that was asked.
        assert!(!commands.is_empty() || fault.contains("try '--help'"), "armid {}: {fault}", arguments.join(" "));
        assert!(commands.iter().all(|command| listed.contains(command)), "armid {}: {fault}", arguments.join(" "));
    }
}
