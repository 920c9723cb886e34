//! `armid study` of one plan on several robots: each robot's own study, byte for byte, and all side by side.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod support;

use std::path::Path;

use serde_json::Value;
use support::{armid_in, files, stderr, summary, temporary};

/// A study of seconds: two planar arms, of which the first has a family of its own.
const PLAN: &str = r#"
name = "tiny"
question = "Does it hold on another arm?"
robots = ["planar-2r", "arms/bench.toml"]
seed = 3
runs = 2
conditions = [{}, { load-friction = "realistic" }]
condition_names = ["none", "load friction"]
compare_with = ["d-optimal"]

[experiment]
period_s = 2.0
harmonics = 3
rate_hz = 500.0
periods = 2
discarded_periods = 1

[identification]
columns = "rigid+rotor+friction"
derivatives = "fourier"
samples_per_period = 100
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
starts = 3
evaluations = 8

[[design]]
name = "d-optimal"
making = "optimised"
criterion = "d-optimal"
starts = 3
evaluations = 8

[[design]]
name = "random"
making = "random"
criterion = "condition"
robots = ["planar-2r"]
starts = 3
evaluations = 4
"#;

/// The place of its own of the family that the first robot alone has.
fn random_begins() -> usize {
    PLAN.find("\n[[design]]\nname = \"random\"").unwrap()
}

/// A folder with the plan, and the second arm: the first with another forearm.
fn with_plan() -> tempfile::TempDir {
    let folder = temporary();
    let arms = folder.path().join("arms");
    std::fs::create_dir(&arms).unwrap();
    let robot = include_str!("../../models/planar-2r/robot.toml");
    assert!(robot.contains("name = \"planar-2r\"") && robot.contains("a_m = 0.3,"));
    let bench = robot.replace("name = \"planar-2r\"", "name = \"bench\"").replace("a_m = 0.3,", "a_m = 0.2,");
    std::fs::write(arms.join("bench.toml"), bench).unwrap();
    std::fs::write(arms.join("nominal.toml"), include_str!("../../models/planar-2r/nominal.toml")).unwrap();
    std::fs::write(arms.join("truth.toml"), include_str!("../../models/planar-2r/truth.toml")).unwrap();
    std::fs::write(folder.path().join("study.toml"), PLAN).unwrap();
    folder
}

/// What went wrong, on one line.
fn fault(assert: &assert_cmd::assert::Assert) -> String {
    stderr(assert).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn succeeds(folder: &Path, arguments: &[&str]) {
    armid_in(folder, arguments).success();
}

/// The comparison in a robot's own summary, turned so that d-optimal is second: difference, interval, better.
fn own(summary: &Value, condition: usize, row: &Value) -> Option<(f64, [f64; 2], Value)> {
    let all = summary["conditions"][condition]["findings"]["comparisons"].as_array().unwrap();
    let found = all.iter().find(|c| {
        c["metric"] == row["metric"]
            && c["estimator"] == row["estimator"]
            && [&c["first"], &c["second"]].contains(&&row["first"])
    })?;
    let (value, better) = (found["difference"].as_f64().unwrap(), found["better"].clone());
    let ends = ["low", "high"].map(|end| found["interval"][end].as_f64().unwrap_or(f64::NAN));
    let is_turned = found["first"] == row["second"];
    Some(match (is_turned, row["metric"] == "log-volume") {
        (false, _) => (value, ends, better),
        (true, true) => (-value, [-ends[1], -ends[0]], better),
        (true, false) => (1.0 / value, [1.0 / ends[1], 1.0 / ends[0]], better),
    })
}

#[test]
fn identity_each_robot_has_the_study_of_a_plan_with_it_alone_and_all_stand_side_by_side() {
    let folder = with_plan();
    let at = folder.path();
    succeeds(at, &["study", "study.toml", "-o", "both"]);
    let both = files(&at.join("both"));

    // Each robot's folder: the plan with that robot alone, which the second has without the family of the first.
    let first = PLAN.replace("robots = [\"planar-2r\", \"arms/bench.toml\"]", "robot = \"planar-2r\"");
    let second =
        PLAN[..random_begins()].replace("robots = [\"planar-2r\", \"arms/bench.toml\"]", "robot = \"arms/bench.toml\"");
    for (text, robot) in [(first, "planar-2r"), (second, "arms-bench.toml")] {
        std::fs::write(at.join("one.toml"), text).unwrap();
        succeeds(at, &["study", "one.toml", "-o", &format!("alone/{robot}")]);
        assert!(files(&at.join("alone").join(robot)) == files(&at.join("both").join(robot)), "{robot}");
    }
    let designs = |robot: &str| both.keys().filter(|name| name.starts_with(&format!("{robot}/designs/random"))).count();
    assert_eq!((designs("planar-2r"), designs("arms-bench.toml")), (3, 0));

    // Side by side: every number is that of the robot's own summary.
    let all = summary(&at.join("both"));
    let own_summaries = ["planar-2r", "arms-bench.toml"].map(|robot| summary(&at.join("both").join(robot)));
    let rows = all["comparisons"].as_array().unwrap();
    assert_eq!(
        rows.iter().filter(|row| row["first"] == "random").count() * 2,
        rows.len(),
        "one pair is the first's alone"
    );
    for row in rows {
        assert_eq!(row["second"], "d-optimal");
        let condition = ["none", "load friction"].iter().position(|name| row["condition"] == *name).unwrap();
        let mut better = Vec::new();
        for (stored, own_summary) in row["robots"].as_array().unwrap().iter().zip(&own_summaries) {
            let Some((value, ends, verdict)) = own(own_summary, condition, row) else {
                assert!(stored.is_null(), "{row}");
                continue;
            };
            assert!((stored["difference"].as_f64().unwrap() - value).abs() <= 1e-12 * value.abs(), "{row}");
            for (end, expected) in ["low", "high"].iter().zip(ends) {
                let found = stored["interval"][end].as_f64();
                assert!(found.is_none_or(|found| (found - expected).abs() <= 1e-12 * expected.abs()), "{row}");
                assert_eq!(found.is_none(), expected.is_nan(), "{row}");
            }
            assert_eq!(stored["better"], verdict);
            better.push(verdict);
        }
        let expected = match &better[..] {
            [_] => "one-robot",
            [a, b] if a.is_null() && b.is_null() => "undecided",
            [a, b] if a.is_null() || b.is_null() => "in-part",
            [a, b] if a == b => "same",
            _ => "reversed",
        };
        assert_eq!(row["agreement"], expected, "{row}");
    }
    for counts in all["agreements"].as_array().unwrap() {
        let of = |agreement: &str| {
            let all = rows.iter().filter(|row| {
                row["metric"] == counts["metric"]
                    && row["estimator"] == counts["estimator"]
                    && row["agreement"] == agreement
            });
            Value::from(all.count())
        };
        for (key, agreement) in
            [("same", "same"), ("in_part", "in-part"), ("reversed", "reversed"), ("undecided", "undecided")]
        {
            assert_eq!(counts[key], of(agreement), "{counts}");
        }
        assert_eq!(counts["holds"], Value::from(of("in-part") == 0 && of("reversed") == 0));
    }

    // The page leads to those of the robots, and is drawn again from what is stored.
    let page = String::from_utf8(both["report/report.html"].clone()).unwrap();
    for robot in ["planar-2r", "arms-bench.toml"] {
        assert!(page.contains(&format!("href=\"../{robot}/report/report.html\"")), "{robot}");
        assert!(both.contains_key(&format!("{robot}/report/report.html")));
    }
    assert!(both.contains_key("report/robots-condition-over-d-optimal.svg"));
    succeeds(at, &["report", "both", "-o", "again"]);
    assert!(std::fs::read(at.join("again/report.html")).unwrap() == both["report/report.html"]);

    // The figure over both, from the studies and again from the numbers beside it, which are those of the page.
    succeeds(at, &["report", "both/planar-2r", "both/arms-bench.toml", "--figure", "criteria", "-o", "figure"]);
    succeeds(at, &["report", "figure/criteria.json", "--figure", "criteria", "-o", "redrawn"]);
    assert!(files(&at.join("figure")) == files(&at.join("redrawn")));
    let robots: Value = serde_json::from_slice(&std::fs::read(at.join("figure/criteria.json")).unwrap()).unwrap();
    for (condition, name) in ["none", "load friction"].iter().enumerate() {
        let is_row =
            |row: &&Value| row["condition"] == *name && row["first"] == "condition" && row["metric"] == "prediction";
        let row = rows.iter().filter(is_row).find(|row| row["estimator"] == "wls").unwrap();
        for (robot, expected) in row["robots"].as_array().unwrap().iter().enumerate() {
            assert_eq!(robots[robot]["ratios"][condition]["error"], *expected);
        }
    }
    // One size of an effect is no series.
    let none = fault(&armid_in(at, ["report", "both/planar-2r", "--figure", "levels", "-o", "wrong"]).code(2));
    assert!(none.contains("two sizes"), "{none}");
    let wrong = armid_in(at, ["report", "study.toml", "--figure", "criteria", "-o", "wrong"]).code(2);
    assert!(
        fault(&wrong).contains("study.toml:2:") && fault(&wrong).contains("--figure criteria"),
        "{}",
        fault(&wrong)
    );

    // Robot by robot, one of them in parts, and then side by side without performing anything again.
    succeeds(at, &["study", "study.toml", "--robot", "planar-2r", "-o", "split/planar-2r"]);
    for k in ["1/2", "2/2"] {
        let part = format!("part-{}", &k[..1]);
        succeeds(at, &["study", "study.toml", "--robot", "arms/bench.toml", "--shard", k, "-o", &part]);
    }
    // Relative paths of a merge begin at its first part.
    std::fs::create_dir(at.join("part-1/arms")).unwrap();
    for name in ["bench.toml", "nominal.toml", "truth.toml"] {
        std::fs::copy(at.join("arms").join(name), at.join("part-1/arms").join(name)).unwrap();
    }
    succeeds(at, &["study", "merge", "part-1", "part-2", "-o", "split/arms-bench.toml"]);
    let timing = || {
        ["planar-2r", "arms-bench.toml"]
            .map(|r| std::fs::read(at.join("split").join(r).join("timing.parquet")).unwrap())
    };
    let before = timing();
    succeeds(at, &["study", "study.toml", "--resume", "-o", "split"]);
    assert!(timing() == before, "a robot was performed again");
    assert!(files(&at.join("split")) == both, "robot by robot differs from all at once");

    // A robot that is missing is performed; one of another plan too.
    std::fs::remove_dir_all(at.join("split/planar-2r")).unwrap();
    succeeds(at, &["study", "study.toml", "--resume", "-o", "split"]);
    assert!(files(&at.join("split")) == both && timing()[1] == before[1]);

    // What asks for one study says which there are.
    let plan =
        armid_in(at, ["study", "plan", "both", "--until", "ratio(condition, d-optimal).prediction < 5 %"]).code(2);
    let text = fault(&plan);
    assert!(text.contains("holds a study on several robots") && text.contains("both/planar-2r"), "{text}");
    let over = armid_in(at, ["study", "study.toml", "-o", "alone/planar-2r"]).code(2);
    assert!(fault(&over).contains("holds a study on one robot"), "{}", fault(&over));
}

#[test]
fn frozen_the_front_figures_are_drawn_from_the_numbers_beside_them() {
    let gallery = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/gallery/readme");
    let folder = temporary();
    for figure in ["criteria", "levels"] {
        let stored = gallery.join(figure).with_extension("json");
        succeeds(folder.path(), &["report", stored.to_str().unwrap(), "--figure", figure, "-o", "."]);
    }
    assert!(files(folder.path()) == files(&gallery));

    // On paper: 88 mm wide, and a PDF beside the SVG; a legend that is too wide gets a second row.
    let levels = gallery.join("levels.json");
    let on_paper = ["report", levels.to_str().unwrap(), "--figure", "levels", "--paper", "column", "-o", "paper"];
    succeeds(folder.path(), &on_paper);
    let figure = folder.path().join("paper/levels-crs-a460-load-friction.svg");
    let text = std::fs::read_to_string(&figure).unwrap();
    assert!(text.contains("88.00mm") && text.contains("I-optimal") && text.contains("logarithmic"), "{text}");
    assert!(std::fs::read(figure.with_extension("pdf")).unwrap().starts_with(b"%PDF-1.4"));
}

#[test]
fn parts_and_an_early_end_ask_for_one_robot_and_name_the_next_command() {
    let folder = with_plan();
    let at = folder.path();
    for (arguments, next) in [
        (&["--shard", "1/2"][..], "`armid study study.toml --shard 1/2 --robot planar-2r`"),
        (&["--stage", "designs"], "`armid study study.toml --stage designs --robot planar-2r`"),
        (&["--until", "ratio(condition, d-optimal).si < 5 %"], "--robot planar-2r`"),
    ] {
        let refused = armid_in(at, [&["study", "study.toml", "-o", "x"], arguments].concat()).code(2);
        let text = fault(&refused);
        assert!(text.contains("study on the robots planar-2r, arms/bench.toml") && text.contains(next), "{text}");
    }
    let text = fault(&armid_in(at, ["study", "submit", "study.toml", "--engine", "slurm", "-o", "x"]).code(2));
    assert!(text.contains("`armid study submit study.toml --engine slurm --robot planar-2r`"), "{text}");
    let nobody = fault(&armid_in(at, ["study", "study.toml", "--robot", "puma-560"]).code(2));
    assert!(nobody.contains("--robot is \"puma-560\"") && nobody.contains("planar-2r, arms/bench.toml"), "{nobody}");
}

#[test]
fn faults_of_a_list_of_robots_name_line_found_and_expected() {
    let folder = with_plan();
    let list = "robots = [\"planar-2r\", \"arms/bench.toml\"]";
    for (from, to, words) in [
        (list, "robots = [\"planar-2r\", \"planer-2r\"]", &["study.toml:4:24", "planer-2r", "crs-a460, puma-560"][..]),
        (list, "robots = [\"planar-2r\", \"arms/none.toml\"]", &["study.toml:4:24", "robot file not found"]),
        (list, "robots = [\"planar-2r\", \"planar-2r\"]", &["study.toml:4:12", "twice"]),
        (list, "robot = \"planar-2r\"\nrobots = [\"planar-2r\"]", &["study.toml:5:12", "one of the two keys"]),
        (list, "robots = [\"..\"]", &["study.toml:4", "at least one letter or digit"]),
        (list, "", &["robot is absent", "robots = ["]),
        (
            "robots = [\"planar-2r\"]",
            "robots = [\"puma-560\"]",
            &["study.toml:53:12", "puma-560", "planar-2r, arms/bench.toml"],
        ),
        (
            "compare_with = [\"d-optimal\"]",
            "compare_with = [\"random\"]",
            &["study.toml:9:18", "on arms/bench.toml", "condition, d-optimal"],
        ),
    ] {
        assert_eq!(PLAN.matches(from).count(), 1, "{from}");
        std::fs::write(folder.path().join("study.toml"), PLAN.replace(from, to)).unwrap();
        let text = fault(&armid_in(folder.path(), ["study", "study.toml", "-o", "x"]).code(2));
        assert!(words.iter().all(|word| text.contains(word)), "{to}: {text}");
    }
}
