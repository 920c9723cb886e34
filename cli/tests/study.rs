//! `armid study` from plan to report: equal bytes for any number of threads, in parts, and after an interruption.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;
use std::process::Output;

use parquet::file::reader::{FileReader, SerializedFileReader};
use support::{files, summary};

/// A study of seconds: a planar arm, two families, two designs each, three runs.
const PLAN: &str = r#"
name = "tiny"
question = "Does the chain hold together?"
robot = "planar-2r"
seed = 3
runs = 3
engines = ["analytic", "rapier", "mujoco"]
conditions = [{}, { backlash = "severe", clock-jitter = 100 }]

[experiment]
period_s = 2.0
harmonics = 3
rate_hz = 1000.0
periods = 3
discarded_periods = 1

[identification]
columns = "rigid+rotor+friction"
derivatives = "fourier"
samples_per_period = 200
estimators = ["ols", "wls"]

[validation]
trajectories = 2
samples = 50

[reference]
mass_kg = 0.1
first_moment_kg_m = 0.02
inertia_kg_m2 = 0.01
viscous_nm_s_rad = 0.1
torque_nm = 0.1

[[design]]
name = "condition"
making = "optimised"
criterion = "condition"
starts = 2
evaluations = 20

[[design]]
name = "random"
making = "random"
criterion = "condition"
starts = 2
evaluations = 5
"#;

/// The plan in one engine, without effects.
fn alone() -> String {
    let lines = PLAN.lines().filter(|line| !line.starts_with("engines") && !line.starts_with("conditions"));
    lines.map(|line| format!("{line}\n")).collect()
}

fn armid(folder: &Path, arguments: &[&str]) -> Output {
    assert_cmd::Command::new(assert_cmd::cargo::cargo_bin!("armid"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// What went wrong, on one line.
fn one_line(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Is refused (exit 2) with all of these words.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let output = armid(folder, arguments);
    let text = one_line(&output);
    let told = words.iter().all(|word| text.contains(word));
    assert!(output.status.code() == Some(2) && told, "{arguments:?}: {text}");
}

fn succeeds(folder: &Path, arguments: &[&str]) {
    let output = armid(folder, arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Every interval of comparisons, scores and correlations with its own estimate, and what they are of.
fn stored_intervals(summary: &serde_json::Value) -> Vec<(String, f64, f64, f64)> {
    let mut found = Vec::new();
    let mut add = |words: &serde_json::Value, value: &serde_json::Value, interval: &serde_json::Value| {
        if let (Some(low), Some(high)) = (interval["low"].as_f64(), interval["high"].as_f64()) {
            found.push((words.to_string(), low, value.as_f64().unwrap(), high));
        }
    };
    for condition in summary["conditions"].as_array().unwrap() {
        let of = |list: &str| condition["findings"][list].as_array().cloned().unwrap_or_default();
        for one in of("comparisons") {
            add(&one, &one["difference"], &one["interval"]);
        }
        for one in of("estimator_comparisons").iter().chain(&of("over_truths")) {
            add(one, &one["ratio"], &one["interval"]);
        }
        for one in of("foretelling") {
            add(&one, &one["rank_correlation"], &one["interval"]);
        }
        for family in of("families") {
            let intervals = family["intervals"].as_array().unwrap();
            for (value, interval) in family["values"].as_array().unwrap().iter().zip(intervals) {
                add(&family["family"], value, interval);
            }
            for parameter in family["parameters"].as_array().unwrap() {
                add(parameter, &parameter["bias"], &parameter["bias_interval"]);
                add(parameter, &parameter["coverage"], &parameter["coverage_interval"]);
            }
        }
    }
    found
}

fn assert_intervals_hold_their_estimates(summary: &serde_json::Value) {
    let intervals = stored_intervals(summary);
    assert!(intervals.len() > 100, "{} intervals", intervals.len());
    for (words, low, value, high) in intervals {
        assert!(low <= value && value <= high, "{low} {value} {high}: {words}");
    }
}

fn with_plan() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("study.toml"), PLAN).unwrap();
    folder
}

#[test]
fn identity_threads_parts_and_resume_give_the_same_bytes() {
    let folder = with_plan();
    let at = folder.path();
    succeeds(at, &["study", "study.toml", "--jobs", "1", "-o", "one"]);
    succeeds(at, &["study", "study.toml", "--jobs", "2", "-o", "two"]);
    let one = files(&at.join("one"));
    assert!(
        ["runs.parquet", "parameters.parquet", "summary.json", "study.toml", "report/report.html"]
            .iter()
            .all(|f| one.contains_key(*f))
    );
    assert!(one == files(&at.join("two")), "one and two threads differ");
    assert_intervals_hold_their_estimates(&summary(&at.join("one")));

    succeeds(at, &["study", "study.toml", "--shard", "1/2", "-o", "part1"]);
    succeeds(at, &["study", "study.toml", "--shard", "2/2", "-o", "part2"]);
    refused(at, &["study", "merge", "part1", "-o", "half"], &["36 runs are in none of the folders"]);
    succeeds(at, &["study", "merge", "part1", "part2", "-o", "merged"]);
    assert!(one == files(&at.join("merged")), "the merged parts differ from the whole");

    // A journal cut in the middle of a line, as a kill leaves it.
    let journal = std::fs::read_to_string(at.join("part1/journal.jsonl")).unwrap();
    std::fs::create_dir(at.join("killed")).unwrap();
    std::fs::write(at.join("killed/journal.jsonl"), &journal[..journal.len() - 40]).unwrap();
    succeeds(at, &["study", "study.toml", "--resume", "-o", "killed"]);
    assert!(one == files(&at.join("killed")), "the resumed study differs from the whole");

    // And one cut within its very first line, in a part that is merged too.
    std::fs::create_dir(at.join("begun")).unwrap();
    std::fs::write(at.join("begun/journal.jsonl"), &journal[..30]).unwrap();
    std::fs::copy(at.join("part1/study.toml"), at.join("begun/study.toml")).unwrap();
    succeeds(at, &["study", "merge", "begun", "part1", "part2", "-o", "merged2"]);
    assert!(one == files(&at.join("merged2")), "the merged parts differ with one that was only begun");
    succeeds(at, &["study", "study.toml", "--resume", "-o", "begun"]);
    assert!(one == files(&at.join("begun")), "the resumed study differs from the whole");

    // No other process may write while a study does, and a new study loses none of an interrupted one's work.
    std::fs::create_dir(at.join("busy")).unwrap();
    let interrupted = at.join("busy/journal.jsonl");
    std::fs::write(&interrupted, &journal).unwrap();
    let writer = std::fs::File::open(&interrupted).unwrap();
    writer.lock().unwrap();
    refused(at, &["study", "study.toml", "--runs", "1", "-o", "busy"], &["is being written by another study"]);
    assert_eq!(std::fs::read_to_string(&interrupted).unwrap(), journal);
    drop(writer);
    succeeds(at, &["study", "study.toml", "--runs", "1", "-o", "busy"]);
    assert_eq!(std::fs::read_to_string(at.join("busy/journal-before.jsonl")).unwrap(), journal);

    // Designs once, for all runs.
    for k in ["1/2", "2/2"] {
        succeeds(
            at,
            &["study", "study.toml", "--stage", "designs", "--shard", k, "-o", &format!("designs/{}", &k[..1])],
        );
    }
    let early = ["study", "study.toml", "--stage", "runs", "--designs-from", "designs/1", "-o", "early"];
    refused(at, &early, &["2 of 4 designs are not there"]);
    for k in ["1/3", "2/3", "3/3"] {
        let output = format!("runs/{}", &k[..1]);
        succeeds(
            at,
            &["study", "study.toml", "--stage", "runs", "--designs-from", "designs", "--shard", k, "-o", &output],
        );
    }
    let parts = ["designs/1", "designs/2", "runs/1", "runs/2", "runs/3"];
    succeeds(at, &[&["study", "merge", "-o", "stages"], &parts[..]].concat());
    assert!(one == files(&at.join("stages")), "the merged stages differ from the whole");
    let double = ["study", "merge", "part1", "runs/1", "part2", "-o", "double"];
    refused(at, &double, &["expected parts that do not overlap"]);

    // The report can be drawn again from what is stored.
    succeeds(at, &["report", "one", "-o", "again"]);
    let page = std::fs::read(at.join("again/report.html")).unwrap();
    assert!(page == one["report/report.html"]);
}

#[test]
fn faults_of_a_plan_name_line_and_column() {
    let folder = with_plan();
    let at = folder.path();
    let (engines, effects) =
        ("[\"analytic\", \"rapier\", \"mujoco\"]", "{ backlash = \"severe\", clock-jitter = 100 }");
    for (from, to, words) in [
        ("\"ols\", \"wls\"", "\"ols\", \"wsl\"", &["broken.toml:21:23", "wsl", "wls"][..]),
        (engines, "[\"analytic\", \"bullet\"]", &["broken.toml:7", "engines", "bullet"]),
        (engines, "[\"rapier\", \"rapier\"]", &["broken.toml:7", "engines", "twice"]),
        (engines, "[]", &["broken.toml:7", "engines", "at least one name"]),
        (effects, "{ backlsh = \"severe\" }", &["broken.toml:8", "unknown effect `backlsh`"]),
        (effects, "{ backlash = \"mild\" }", &["broken.toml:8", "backlash is \"mild\""]),
        (effects, "{}", &["conditions has \"none\" twice"]),
    ] {
        assert!(PLAN.contains(from), "{from}");
        std::fs::write(at.join("broken.toml"), PLAN.replace(from, to)).unwrap();
        refused(at, &["study", "broken.toml"], words);
    }
    refused(at, &["study", "01-criterion"], &["01-criteria"]);

    // Stored work of another plan is not gone on with.
    succeeds(at, &["study", "study.toml", "--shard", "1/4", "-o", "out"]);
    refused(at, &["study", "study.toml", "--runs", "2", "--resume", "-o", "out"], &["another plan"]);
}

#[test]
fn runs_that_run_away_are_rows_with_a_status_and_are_counted() {
    // Gains for links of kilograms on links of grams, without friction: the servo shakes the arm apart.
    let folder = with_plan();
    let at = folder.path();
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/planar-2r");
    std::fs::create_dir(at.join("light")).unwrap();
    for file in ["robot.toml", "nominal.toml"] {
        std::fs::copy(models.join(file), at.join("light").join(file)).unwrap();
    }
    let truth: String = std::fs::read_to_string(models.join("truth.toml"))
        .unwrap()
        .lines()
        .map(|line| match line.split(" = ").next().unwrap() {
            "mass_kg" => "mass_kg = 0.003\n".to_owned(),
            "inertia_about_com_kg_m2" => {
                "inertia_about_com_kg_m2 = { xx = 1e-6, yy = 1e-6, zz = 1e-6, xy = 0.0, xz = 0.0, yz = 0.0 }\n"
                    .to_owned()
            }
            "rotor_kg_m2" => "rotor_kg_m2 = 1e-6\n".to_owned(),
            key @ ("viscous_nm_s_rad" | "coulomb_nm") => format!("{key} = 0.0\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    std::fs::write(at.join("light/truth.toml"), truth).unwrap();
    let plan = alone().replace("\"planar-2r\"", "\"light\"");
    std::fs::write(at.join("light.toml"), plan).unwrap();
    let output = armid(at, &["study", "light.toml", "-o", "out", "--json"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&answer["runs"], &answer["failed"]), (&12.into(), &12.into()));
    let statuses = &answer["conditions"][0]["statuses"];
    assert_eq!(statuses, &serde_json::json!([{ "status": "diverged-speed", "runs": 12 }]));
    let rows = SerializedFileReader::new(std::fs::File::open(at.join("out/runs.parquet")).unwrap()).unwrap();
    let mut count = 0;
    for row in rows.get_row_iter(None).unwrap() {
        let row: Vec<String> = row.unwrap().get_column_iter().map(|(_, field)| field.to_string()).collect();
        assert!(row.iter().any(|field| field.contains("diverged-speed")), "{row:?}");
        assert!(row.iter().any(|field| field.contains("exceeds ten times its limit")), "{row:?}");
        count += 1;
    }
    // Two estimators for each run.
    assert_eq!(count, 24);
}

#[test]
fn random_truths_are_the_same_for_every_design_and_number_of_threads() {
    let folder = with_plan();
    let at = folder.path();
    std::fs::write(at.join("truths.toml"), alone() + "\n[truths]\ncount = 3\n").unwrap();
    succeeds(at, &["study", "truths.toml", "--jobs", "1", "-o", "one"]);
    succeeds(at, &["study", "truths.toml", "--jobs", "2", "-o", "two"]);
    assert!(files(&at.join("one")) == files(&at.join("two")), "one and two threads differ");
    let summary = summary(&at.join("one"));
    assert_eq!(summary["drawn_truths"].as_array().unwrap().len(), 3);
    let over = &summary["conditions"][0]["findings"]["over_truths"];
    assert!(over.as_array().unwrap().iter().all(|c| c["truths"] == 3), "{over}");
    // A spread out of range is named with its place.
    let plan = std::fs::read_to_string(at.join("truths.toml")).unwrap() + "mass_spread = 3.0\n";
    std::fs::write(at.join("wide.toml"), plan).unwrap();
    refused(at, &["study", "wide.toml"], &["mass_spread is 3"]);
}

#[cfg(unix)]
#[test]
fn a_submission_hands_its_words_over_as_they_are() {
    use std::os::unix::fs::PermissionsExt;
    let folder = with_plan();
    let at = folder.path();
    // An sbatch that says its arguments, one a line.
    let sbatch = at.join("sbatch");
    std::fs::write(&sbatch, "#!/bin/sh\nprintf '%s\\n' \"$@\" >>\"${0%/*}/words\"\necho 7\n").unwrap();
    std::fs::set_permissions(&sbatch, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths(std::iter::once(at.to_path_buf()).chain(std::env::split_paths(&path))).unwrap();
    let odd = "a 50% $(touch pwned) 'b'";
    let submit = ["study", "submit", "study.toml", "--engine", "slurm", "--array", "2", "--runs", "1", "-o", odd];
    let mut command = assert_cmd::Command::new(assert_cmd::cargo::cargo_bin!("armid"));
    let output =
        command.current_dir(at).env("PATH", &path).args(submit).args(["--", "--comment=e f"]).output().unwrap();
    assert!(output.status.success(), "{}", one_line(&output));
    let words = std::fs::read_to_string(at.join("words")).unwrap();
    let logs = at.join("a 50%% $(touch pwned) 'b'/logs").display().to_string();
    let script = at.join(odd).join("slurm-study").display().to_string();
    for (stage, before) in [("designs", ""), ("runs", "--dependency=afterany:7\n--array=1-2\n")] {
        let line = format!("--output={logs}/{stage}-%A_%a.log\n{before}");
        assert!(words.contains(&line), "{line}: {words}");
    }
    let last = format!(
        "--dependency=afterany:7:7\n--comment=e f\n{script}\n--stage\nmerge\n1\n{}\n2\nstudy.toml\n--runs\n1\n--\n--comment=e f\n",
        at.join(odd).display()
    );
    assert!(words.ends_with(&last), "{words}");
    assert!(!at.join("pwned").exists() && at.join(odd).join("armid").exists());
}

#[test]
fn results_of_another_study_are_never_replaced() {
    let folder = with_plan();
    let at = folder.path();
    let few = with_starts().replace("starts = 8", "starts = 2");
    std::fs::write(at.join("study.toml"), &few).unwrap();
    succeeds(at, &["study", "study.toml", "-o", "out"]);
    let before = files(&at.join("out"));
    let refused = |arguments: &[&str], words: &str| refused(at, arguments, &[words]);
    // Another number of runs is another plan, and so is a plan of several robots.
    let another = "out holds the results of another study, expected a new folder or one of the same plan";
    refused(&["study", "study.toml", "--runs", "1", "-o", "out"], another);
    refused(&["study", "study.toml", "--runs", "1", "--resume", "-o", "out"], another);
    refused(&["study", "study.toml", "--runs", "1", "--shard", "1/2", "-o", "out"], another);
    assert!(before == files(&at.join("out")));
    // The same again replaces its own.
    succeeds(at, &["study", "study.toml", "-o", "out"]);
    assert!(before == files(&at.join("out")));

    // Results of nobody knows which plan, and the folder of the plan itself.
    std::fs::create_dir(at.join("foreign")).unwrap();
    std::fs::write(at.join("foreign/summary.json"), "{}").unwrap();
    refused(&["study", "study.toml", "-o", "foreign"], "foreign holds the results of another study");
    refused(&["study", "study.toml", "--runs", "1", "-o", "."], ". holds another plan, study.toml");
    assert_eq!(std::fs::read_to_string(at.join("study.toml")).unwrap(), few);

    // A part stays one where parts are put together.
    for k in ["1/2", "2/2"] {
        succeeds(at, &["study", "study.toml", "--shard", k, "-o", &format!("part{}", &k[..1])]);
    }
    let parts = [files(&at.join("part1")), files(&at.join("part2"))];
    refused(&["study", "merge", "part1", "part2", "-o", "./part1"], "the output folder part1 is one of the parts");
    refused(&["study", "merge", "part1", "part2", "-o", "foreign"], "foreign holds the results of another study");
    assert!(parts == [files(&at.join("part1")), files(&at.join("part2"))]);
    succeeds(at, &["study", "merge", "part1", "part2", "-o", "merged"]);
    assert!(before == files(&at.join("merged")));
}

/// The study of one engine with eight starts of each family, and less to do for each.
fn with_starts() -> String {
    alone()
        .replace("starts = 2", "starts = 8")
        .replace("runs = 3\n", "runs = 2\n")
        .replace("evaluations = 20", "evaluations = 8")
}

#[test]
fn identity_a_study_that_ends_early_is_the_study_of_its_starts() {
    let folder = with_plan();
    let at = folder.path();
    std::fs::write(at.join("starts.toml"), with_starts()).unwrap();
    // Any interval will do: the first look is the last.
    let rule = "ratio(condition, random).prediction < 100000 %";
    succeeds(at, &["study", "starts.toml", "--until", rule, "--jobs", "1", "-o", "one"]);
    succeeds(at, &["study", "starts.toml", "--until", rule, "--jobs", "2", "-o", "two"]);
    let one = files(&at.join("one"));
    assert!(one == files(&at.join("two")), "one and two threads differ");
    let looks: serde_json::Value = serde_json::from_slice(&one["looks.json"]).unwrap();
    assert_eq!(looks["termination"], "narrow-enough");
    assert_eq!(looks["looks"].as_array().unwrap().len(), 1);
    assert_eq!(looks["looks"][0]["starts"], 4);

    // The same again replaces its own, though what is stored is the plan of the first starts.
    succeeds(at, &["study", "starts.toml", "--until", rule, "-o", "one"]);
    assert!(one == files(&at.join("one")));

    // The plan as run says all of it.
    succeeds(at, &["study", "one/study.toml", "-o", "again"]);
    let mut again = files(&at.join("again"));
    again.insert("looks.json".to_owned(), one["looks.json"].clone());
    assert!(one == again, "the plan as run gives another study");

    // What no number of starts gives: all of them, and a negative verdict.
    let narrow = "ratio(condition, random).prediction < 0.001 %";
    let output = armid(at, &["study", "starts.toml", "--until", narrow, "-o", "all"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    succeeds(at, &["study", "starts.toml", "-o", "whole"]);
    let mut all = files(&at.join("all"));
    let looks: serde_json::Value = serde_json::from_slice(&all.remove("looks.json").unwrap()).unwrap();
    assert_eq!(looks["termination"], "all-starts");
    assert_eq!(looks["looks"].as_array().unwrap().len(), 3);
    assert!(all == files(&at.join("whole")), "the study of all starts differs from the whole");

    // The whole study as a pilot of the next one.
    let output =
        armid(at, &["study", "plan", "whole", "--until", "ratio(condition, random).prediction < 10 %", "--json"]);
    let shown: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(shown["pilot"]["size"], serde_json::json!({ "starts": 8, "truths": null, "runs": 2 }));
    assert!(shown["pilot"]["share"].as_f64().unwrap() > 0.0);
    assert_eq!(output.status.code(), Some(if shown["least"].is_null() { 1 } else { 0 }));

    for (rule, words) in [
        ("condition / random < 5 %", "expected as \"ratio(condition, d-optimal).prediction < 5 %\""),
        ("ratio(condition, nobody).si < 5 %", "--until is \"nobody\", expected one of the families"),
    ] {
        for arguments in
            [&["study", "starts.toml", "--until", rule, "-o", "x"][..], &["study", "plan", "whole", "--until", rule]]
        {
            refused(at, arguments, &[words]);
        }
    }
    assert!(!at.join("x").exists());
}

#[test]
fn antithetic_noise_falls_out_of_a_bias_and_runs_count_in_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // One design, so that runs are the units of a bias.
    let plan = alone().replace("runs = 3", "runs = 16").replace("starts = 2", "starts = 1");
    std::fs::write(at.join("own.toml"), &plan).unwrap();
    let paired = plan.replace("seed = 3", "seed = 3\nvariance_reduction = [\"antithetic-noise\"]");
    std::fs::write(at.join("antithetic.toml"), &paired).unwrap();
    let bias_widths = |name: &str| -> Vec<f64> {
        succeeds(at, &["study", &format!("{name}.toml"), "-o", name]);
        let summary = summary(&at.join(name));
        let score = &summary["conditions"][0]["findings"]["families"][0];
        assert_eq!(score["runs"], 16);
        let parameters = score["parameters"].as_array().unwrap();
        let width = |parameter: &serde_json::Value| {
            let end = |end: &str| parameter["bias_interval"][end].as_f64().unwrap();
            end("high") - end("low")
        };
        parameters.iter().map(width).collect()
    };
    let (own, antithetic) = (bias_widths("own"), bias_widths("antithetic"));
    // Estimates are linear in the noise of torque, and in that of the regressor to first order.
    let narrower = own.iter().zip(&antithetic).filter(|(own, antithetic)| **own > 3.0 * **antithetic).count();
    assert!(2 * narrower > own.len(), "{own:?} {antithetic:?}");

    let odd = paired.replace("runs = 16", "runs = 15");
    std::fs::write(at.join("odd.toml"), odd).unwrap();
    refused(at, &["study", "odd.toml"], &["15", "even number"]);

    // Pairs do not show how much runs scatter, which a pilot has to.
    let rule = "ratio(condition, random).prediction < 5 %";
    refused(at, &["study", "plan", "antithetic", "--until", rule], &["antithetic"]);
}

#[test]
fn one_family_under_several_conditions_is_compared_with_nothing_and_has_a_page() {
    let folder = with_plan();
    let (one, _) = PLAN.rsplit_once("[[design]]").unwrap();
    let one: String = one.lines().filter(|line| !line.starts_with("engines")).flat_map(|line| [line, "\n"]).collect();
    std::fs::write(folder.path().join("one.toml"), one).unwrap();
    succeeds(folder.path(), &["study", "one.toml", "--runs", "1", "-o", "out"]);
    assert!(folder.path().join("out/report/report.html").exists());
}

#[test]
fn designs_of_one_start_are_pairs_and_others_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let (first, _) =
        alone().rsplit_once("[[design]]").map(|(first, rest)| (first.to_owned(), rest.to_owned())).unwrap();
    let family = |name: &str, making: &str, starts: usize| {
        format!(
            "[[design]]\nname = \"{name}\"\nmaking = \"{making}\"\ncriterion = \"d-optimal\"\nstarts = {starts}\nevaluations = 3\n\n"
        )
    };
    let plan =
        first + &family("d-optimal", "optimised", 3) + &family("random", "random", 3) + &family("single", "random", 1);
    std::fs::write(folder.path().join("own.toml"), plan).unwrap();
    succeeds(folder.path(), &["study", "own.toml", "-o", "out"]);
    let summary = summary(&folder.path().join("out"));
    assert_intervals_hold_their_estimates(&summary);
    let comparisons = summary["conditions"][0]["findings"]["comparisons"].as_array().unwrap();
    let of = |first: &str, second: &str| {
        let found = |c: &&serde_json::Value| {
            c["metric"] == "prediction" && c["estimator"] == "wls" && c["first"] == first && c["second"] == second
        };
        comparisons.iter().find(found).unwrap()
    };
    // Two starts against three: the first two are pairs.
    assert_eq!(of("condition", "d-optimal")["unit"], "paired designs");
    assert_eq!(of("condition", "d-optimal")["degrees_of_freedom"], 1.0);
    assert_eq!(of("d-optimal", "random")["unit"], "designs");
    assert_eq!(of("d-optimal", "single")["unit"], "designs and runs");
    for c in comparisons.iter().filter(|c| c["metric"] == "prediction") {
        let (p, adjusted) = (c["p"].as_f64().unwrap(), c["p_adjusted"].as_f64().unwrap());
        assert!(p <= adjusted && adjusted <= 1.0 && (adjusted < 0.05) == c["better"].is_string(), "{c}");
    }
    let page = std::fs::read_to_string(folder.path().join("out/report/report.html")).unwrap();
    assert!(page.contains("paired designs") && page.contains("turn a correlation"));
}

#[test]
fn unselected_designs_of_one_run_each_show_what_values_foretell() {
    let folder = tempfile::tempdir().unwrap();
    let (_, random) = PLAN.rsplit_once("[[design]]").unwrap();
    let (before, _) =
        alone().split_once("[[design]]").map(|(first, rest)| (first.to_owned(), rest.to_owned())).unwrap();
    let random = random.replace("starts = 2", "starts = 30").replace("evaluations = 5", "evaluations = 1");
    let plan = format!("{before}[[design]]{random}").replace("runs = 3", "runs = 1");
    std::fs::write(folder.path().join("own.toml"), plan).unwrap();
    succeeds(folder.path(), &["study", "own.toml", "-o", "out"]);
    let summary = summary(&folder.path().join("out"));
    let findings = &summary["conditions"][0]["findings"];
    let found = findings["foretelling"].as_array().unwrap();
    // Seven values, two estimators, all metrics of single runs but what no arm measured.
    let metrics: std::collections::BTreeSet<&str> = found.iter().map(|c| c["metric"].as_str().unwrap()).collect();
    assert_eq!(found.len(), 7 * 2 * metrics.len());
    assert!(metrics.contains("si") && metrics.contains("reference") && !metrics.contains("measured"), "{metrics:?}");
    assert!(found.iter().all(|c| c["designs"] == 30 && c["interval"]["low"].is_number()));
    // One run of a design has no scatter to state.
    assert!(findings["families"][0]["parameters"][0]["std"].is_null());
    assert!(findings["comparisons"].as_array().unwrap().is_empty());
    let page = std::fs::read_to_string(folder.path().join("out/report/report.html")).unwrap();
    assert!(page.contains("none was selected") && !page.contains("turn a correlation"));
}
