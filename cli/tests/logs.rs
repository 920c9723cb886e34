//! Logs that something else recorded: tables of every shape, uneven stamps, gaps, several files and several logs.

mod support;
#[path = "support/foreign_log.rs"]
mod foreign_log;

use std::path::Path;

use foreign_log::{Row, distance, identify, recorded, table};
use serde_json::Value;
use support::{armid, json, stderr, stdout, temporary, write};

const GEARS: [f64; 6] = [32.0, 32.0, 45.0, 48.0, 45.0, 32.0];
const GAINS: [f64; 6] = [35.24, 32.04, 23.94, 9.05, 15.5, 6.56];

#[test]
fn identity_a_table_of_any_shape_gives_what_the_plain_one_gives() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let plain = identify(&[folder.path().join("R.csv").to_str().unwrap()]);
    assert!(plain["held_out"]["all_rows"]["total"].as_f64().is_some());
    assert_eq!(plain["suspicions"], Value::from(Vec::<Value>::new()));
    let degrees = |row: &Row| row.1.iter().map(|q| q.to_degrees()).collect::<Vec<_>>();

    // Milliseconds, degrees, milliamperes, other columns, semicolons, decimal commas.
    let headings = "zeit_ms;a1_pos;a2_pos;a3_pos;a4_pos;a5_pos;a6_pos;mode;i1;i2;i3;i4;i5;i6";
    let text = table(headings, ";", &rows, |_, row| {
        let mut values = vec![1e3 * row.0];
        values.extend(degrees(row));
        values.push(7.0);
        values.extend(row.2.iter().map(|i| 1e3 * i));
        values
    });
    let file = write(folder.path(), "german.csv", &text.replace('.', ","));
    let map = "t=zeit_ms, q=a[1-6]_pos deg, current=i[1-6] mA";
    let found = identify(&[&file, "--map", map]);
    assert!(distance(&plain, &found) < 1e-6, "{}", distance(&plain, &found));
    assert_eq!(found["logs"][0]["skipped_columns"], Value::from(vec!["mode"]));
    assert_eq!(found["inputs"]["mapping"], map);
    assert_eq!(found["inputs"]["files"][0]["sha256"].as_str().unwrap().len(), 64);

    // No headings, no times, values at the motors in two files, a sign and an offset.
    let motors = |row: &Row| {
        let q = &row.1;
        (0..6).map(|k| GEARS[k] * (q[k] + if k == 5 { q[4] } else { 0.0 })).collect::<Vec<_>>()
    };
    let positions = table("", " ", &rows, |_, row| {
        motors(row).iter().enumerate().map(|(k, q)| if k == 3 { -q } else { *q }).collect()
    });
    let torques = table("", "\t", &rows, |_, row| (0..6).map(|k| row.2[k] * GAINS[k] / GEARS[k]).collect());
    write(folder.path(), "pos.txt", &positions);
    write(folder.path(), "trq.txt", &torques);
    let toml = "[log]\nfiles = [\"pos.txt\", \"trq.txt\"]\nrobot = \"staubli-tx40\"\nrate_hz = 500\n\
                q = \"pos:#[1-6] motor gear=32/32/45/-48/45/32\"\ntau = \"trq:#[1-6] motor\"\n";
    let file = write(folder.path(), "log.toml", toml);
    let found = json(&armid(["identify", &file, "--json"]).success());
    assert!(distance(&plain, &found) < 1e-6, "{}", distance(&plain, &found));
}

#[test]
fn uneven_stamps_gaps_resets_and_faults_of_channels_are_found_counted_and_said() {
    let folder = temporary();
    let mut rows = recorded(folder.path());
    let plain = identify(&[folder.path().join("R.csv").to_str().unwrap(), "--held-out", "none"]);
    // Samples are missing, never more than two in a row: steps of 2, 4 and 6 ms.
    let mut number = 0_usize;
    rows.retain(|_| {
        number += 1;
        ![0, 3, 4].contains(&(number % 11))
    });
    // A second is missing in the middle, a stamp occurs twice, the clock begins anew, a value is missing.
    let mut seen = rows.clone();
    seen.retain(|row| !(5.0..6.0).contains(&row.0));
    seen[100].0 = seen[99].0;
    for row in seen.iter_mut().filter(|row| row.0 > 8.0) {
        row.0 -= 7.0;
    }
    let headings = "t,q1,q2,q3,q4,q5,q6,current1,current2,current3,current4,current5,current6";
    let text = table(headings, ",", &seen, |_, row| [vec![row.0], row.1.clone(), row.2.clone()].concat());
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[200] = lines[200].rsplit_once(',').unwrap().0.to_owned() + ",";
    let file = write(folder.path(), "gaps.csv", &lines.join("\n"));
    let found = identify(&[&file, "--held-out", "none"]);
    let timing = &found["logs"][0]["timing"];
    assert_eq!(
        (timing["gaps"].as_u64(), timing["resets"].as_u64(), timing["duplicates"].as_u64()),
        (Some(1), Some(1), Some(1)),
        "{timing}"
    );
    assert_eq!((timing["incomplete_rows"].as_u64(), timing["even"].as_bool()), (Some(1), Some(false)));
    let text = stdout(&armid(["identify", &file, "--robot", "staubli-tx40"]));
    for said in [
        "brought onto",
        "1 gaps, together",
        "the clock goes back 1 times",
        "with the stamp of the row before",
        "a value is missing",
    ] {
        assert!(text.contains(said), "{said} not in {text}");
    }
    // Friction at the larger joints is that of the even log.
    let value = |estimate: &Value, name: &str| {
        let base = estimate["base"].as_array().unwrap();
        base.iter().find(|parameter| parameter["name"] == name).unwrap()["value"].as_f64().unwrap()
    };
    for name in ["Fv1", "Fc1", "Fv2", "Fc2", "Fc3"] {
        let ratio = value(&found, name) / value(&plain, name);
        assert!((ratio - 1.0).abs() < 0.05, "{name}: {ratio}");
    }

    // The current of the first joint runs into its end, the position of the second stands still and jumps.
    let mut clipped = recorded(folder.path());
    let most = clipped.iter().map(|row| row.2[0].abs()).fold(0.0, f64::max);
    for row in &mut clipped {
        row.2[0] = row.2[0].clamp(-0.5 * most, 0.5 * most);
    }
    let held = clipped[2000].1[1];
    for row in &mut clipped[2000..2080] {
        row.1[1] = held;
    }
    let text = table(headings, ",", &clipped, |_, row| [vec![row.0], row.1.clone(), row.2.clone()].concat());
    let found = identify(&[&write(folder.path(), "clipped.csv", &text)]);
    let states: Vec<(u64, &str)> = found["logs"][0]["channels"]
        .as_array()
        .unwrap()
        .iter()
        .map(|fault| (fault["joint"].as_u64().unwrap(), fault["state"].as_str().unwrap()))
        .collect();
    assert!(states.contains(&(1, "saturated")) && states.contains(&(2, "frozen-position")), "{states:?}");
    assert_eq!(states.len(), 2, "{states:?}");
}

#[test]
fn several_logs_make_one_fit_and_a_part_or_another_log_is_kept_aside() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let headings = "t,q1,q2,q3,q4,q5,q6,current1,current2,current3,current4,current5,current6";
    let part = |name: &str, rows: &[Row]| {
        let text = table(headings, ",", rows, |_, row| [vec![row.0], row.1.clone(), row.2.clone()].concat());
        write(folder.path(), name, &text)
    };
    let (a, b) = (part("a.csv", &rows[..3000]), part("b.csv", &rows[3000..]));
    let both = identify(&[&a, &b, "--held-out", "none"]);
    assert_eq!((both["logs"].as_array().unwrap().len(), &both["held_out"]), (2, &Value::Null));
    let whole = identify(&[&part("whole.csv", &rows), "--held-out", "none"]);
    // The filter sees two ends more: the farthest of 60 parameters moves by two standard deviations.
    assert!(distance(&whole, &both) < 3.0, "{}", distance(&whole, &both));

    // The same in two files for each log: by the names that they share, and where they share none, by a table for each.
    let side = |name: &str, rows: &[Row], headings: &str, of: fn(&Row) -> &Vec<f64>| {
        write(folder.path(), name, &table(headings, ",", rows, |_, row| [vec![row.0], of(row).clone()].concat()))
    };
    let pair = |log: &str, rows: &[Row]| {
        [
            side(&format!("q_{log}.csv"), rows, "t,q1,q2,q3,q4,q5,q6", |row| &row.1),
            side(&format!("i_{log}.csv"), rows, "t,i1,i2,i3,i4,i5,i6", |row| &row.2),
        ]
    };
    let ([q_a, i_a], [q_b, i_b]) = (pair("a", &rows[..3000]), pair("b", &rows[3000..]));
    let files = [q_a.as_str(), &i_a, &q_b, &i_b, "--held-out", "none", "--map"];
    let starred = identify(&[&files[..], &["t=t, q=q_*:q[1-6], current=i_*:i[1-6]"][..]].concat());
    assert_eq!((&starred["base"], starred["logs"].as_array().unwrap().len()), (&both["base"], 2));
    let one = "t=t, q=q_a:q[1-6], current=i_a:i[1-6]";
    let of_one = ["identify", "--robot", "staubli-tx40"].into_iter().chain(files).chain([one]);
    let fault = stderr(&armid(of_one).code(2));
    assert!(fault.contains("files = [\"q_b.csv\", \"i_b.csv\"]") && fault.contains("current=i_*:i[1-6]"), "{fault}");
    let toml = "[log]\nfiles = [\"q_b.csv\", \"i_b.csv\"]\nt = \"t\"\nq = \"q_b:q[1-6]\"\ncurrent = \"i_b:i[1-6]\"\n";
    let toml = write(folder.path(), "b.toml", toml);
    let mixed = identify(&[&a, &toml, "--held-out", "none", "--map", "t=t, q=q[1-6], current=current[1-6]"]);
    assert_eq!(mixed["base"], both["base"]);

    // Motor 6 adds to the torque of joint 5: without its current neither is known.
    let without = identify(&[&a, "--map", "t=t, q=q[1-6], current=current[1-5]/-"]);
    let equations = without["logs"][0]["equations"].as_array().unwrap();
    assert!(
        equations[..4].iter().all(|count| count != 0) && equations[4..].iter().all(|count| count == 0),
        "{equations:?}"
    );

    let other = identify(&[&a, "--held-out", &b]);
    assert!(other["held_out"]["used_rows"]["total"].as_f64().unwrap() < 0.2);
    let cut = identify(&[&part("whole.csv", &rows), "--from", "1", "--until", "7", "--held-out", "50%"]);
    assert_eq!((cut["logs"][0]["used_s"].as_f64(), cut["logs"][0]["held_out_s"].as_f64()), (Some(3.0), Some(3.0)));

    let estimate = folder.path().join("E.json");
    let estimate = estimate.to_str().unwrap();
    armid(["identify", &a, "--robot", "staubli-tx40", "-o", estimate]);
    // Robot and processing are those of the estimate.
    let verdict = json(&armid(["validate", estimate, &b, "--json", "--limit", "0.5"]).success());
    assert_eq!(verdict["residual"]["bandwidth_hz"], 20.0);
    let text = stdout(&armid(["validate", estimate, &b, "--limit", "0.5"]).success());
    assert!(text.contains("total") && text.contains("below 20 Hz") && text.contains("on all rows"), "{text}");
    // Both commands name the rows that a fit leaves out by one sentence.
    let of_fit = stdout(&armid(["identify", &a, "--robot", "staubli-tx40"]));
    for text in [&text, &of_fit] {
        assert!(text.contains("  rows of the fit: all but "), "{text}");
    }
    armid(["export", estimate, "--to", "json", "-o", folder.path().join("x.json").to_str().unwrap()]);
}

#[test]
fn what_a_log_lacks_is_said_with_what_helps() {
    let folder = temporary();
    let file = write(folder.path(), "log.csv", "time_ms,j1,j2,i1,i2\n0,1,2,3,4\n1,1,2,3,4\n2,1,2,3,4\n");
    let bare = write(folder.path(), "bare.csv", "0,1,2,3,4\n1,1,2,3,4\n");
    for (arguments, wanted) in [
        (vec![file.as_str()], "heading \"q1\" is missing"),
        (vec![&bare], "5 columns without headings, expected headings or a mapping"),
        (vec![&file, "--map", "q=k[1-2], current=i[1-2]"], "heading \"k1\" is missing"),
        (vec![&file, "--map", "q=j[1-2], current=i[1-2]"], "has no column of times"),
        (vec![&file, "--map", "q=j[1-2], current=i1"], "current names 1 columns, expected 2"),
        (vec![&file, "--map", "q=j[1-2] motor gear=1/2/3, current=i[1-2]", "--rate", "5"], "gear has 3 values"),
        (vec![&file, "--map", "q=j[1-2], curent=i[1-2]"], "did you mean \"current\"?"),
        (vec![&file, &bare, "--map", "q=log:j[1-2], current=bare:#[4-5]", "--rate", "5"], "has 3 rows and"),
    ] {
        let all = ["identify", "--robot", "planar-2r"].into_iter().chain(arguments);
        let fault = stderr(&armid(all).code(2));
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
}

#[test]
fn the_correction_of_exchanged_columns_can_be_typed_as_it_is_printed() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let plain = identify(&[folder.path().join("R.csv").to_str().unwrap()]);
    let text = |headings: &str, separator: &str| {
        table(headings, separator, &rows, |_, row| {
            let (mut q, mut current) = (row.1.clone(), row.2.clone());
            q.swap(1, 2);
            current.swap(1, 2);
            [vec![row.0], q, current].concat()
        })
    };
    // Headings of one's own, some with a blank or a slash; and none.
    let headings = "t;base pos;arm/shoulder;elbow_pos;q4;q5;q6;i01;i02;i03;i04;i05;i06";
    let named = write(folder.path(), "named.csv", &text(headings, ";"));
    let bare = write(folder.path(), "bare.csv", &text("", ","));
    for (file, map, wanted) in [
        (
            &named,
            "q='base pos'/arm/shoulder/elbow_pos/q[4-6], current=i[01-06], t=t",
            "t=t, q=#2/elbow_pos/#3/q4/q5/q6, current=i01/i03/i02/i04/i05/i06",
        ),
        (&bare, "t=#1, q=#[2-7], current=#[8-13]", "t=#1, q=#2/#4/#3/#5/#6/#7, current=#8/#10/#9/#11/#12/#13"),
    ] {
        let found = identify(&[file, "--map", map]);
        let advice = found["suspicions"][0]["advice"].as_str().expect("a suspicion");
        let typed = advice.split("--map \"").nth(1).and_then(|rest| rest.split('"').next()).expect("a mapping");
        assert_eq!(typed, wanted, "{advice}");
        let corrected = identify(&[file, "--map", typed]);
        assert!(distance(&plain, &corrected) < 1e-6, "{}", distance(&plain, &corrected));
        assert_eq!(corrected["suspicions"], Value::from(Vec::<Value>::new()));
    }
}

#[test]
fn a_joint_at_rest_is_a_finding_and_the_rest_is_identified() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let headings = "t,q1,q2,q3,q4,q5,q6,current1,current2,current3,current4,current5,current6";
    let still = table(headings, ",", &rows, |_, row| {
        let mut q = row.1.clone();
        q[0] = 0.4;
        [vec![row.0], q, row.2.clone()].concat()
    });
    let file = write(folder.path(), "still.csv", &still);
    let done = armid(["identify", &file, "--robot", "staubli-tx40", "--json"]).code(1);
    let found = json(&done);
    let suspicion = &found["suspicions"][0];
    assert_eq!((&suspicion["mistake"], &suspicion["joint"]), (&Value::from("at-rest"), &Value::from(1)), "{suspicion}");
    // What joint 1 alone shows is left out, and the others have their parameters.
    let names: Vec<&str> =
        found["base"].as_array().unwrap().iter().map(|parameter| parameter["name"].as_str().unwrap()).collect();
    assert!(!names.contains(&"Fv1") && !names.contains(&"Fc1"), "{names:?}");
    for name in ["Fv2", "Fc2", "Fv3", "Fc3", "Fv6", "Fc6"] {
        assert!(names.contains(&name), "{name} not in {names:?}");
    }
    let text = stdout(&armid(["identify", &file, "--robot", "staubli-tx40"]).code(1));
    assert!(text.contains("joint 1 is at rest") && text.contains("the motion of joint 1 excites"), "{text}");
}

#[test]
fn corrections_of_units_sides_and_signs_can_be_typed_as_they_are_printed() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let plain = identify(&[folder.path().join("R.csv").to_str().unwrap()]);
    let headings = "t,a1,a2,a3,a4,a5,a6,i1,i2,i3,i4,i5,i6";
    let map = "t=t, q=a[1-6], current=i[1-6]";
    let motors =
        |q: &[f64]| -> Vec<f64> { (0..6).map(|k| GEARS[k] * (q[k] + if k == 5 { q[4] } else { 0.0 })).collect() };
    type Written<'a> = (&'a str, &'a dyn Fn(&Row) -> (Vec<f64>, Vec<f64>), &'a str);
    let cases: [Written<'_>; 2] = [
        ("motors", &|row| (motors(&row.1), row.2.clone()), "t=t, q=a1/a2/a3/a4/a5/a6 motor, current=i1/i2/i3/i4/i5/i6"),
        (
            "milliampere",
            &|row| (row.1.clone(), row.2.iter().map(|i| 1e3 * i).collect()),
            "t=t, q=a1/a2/a3/a4/a5/a6, current=i1/i2/i3/i4/i5/i6 mA",
        ),
    ];
    for (name, written, wanted) in cases {
        let text = table(headings, ",", &rows, |_, row| {
            let (q, current) = written(row);
            [vec![row.0], q, current].concat()
        });
        let file = write(folder.path(), &format!("{name}.csv"), &text);
        let done = armid(["identify", &file, "--robot", "staubli-tx40", "--map", map, "--json"]).code(1);
        let found = json(&done);
        let advice = found["suspicions"][0]["advice"].as_str().expect("a suspicion");
        let typed = advice.split("so: --map \"").nth(1).and_then(|rest| rest.split('"').next()).expect(advice);
        assert_eq!(typed, wanted, "{advice}");
        let corrected = identify(&[&file, "--map", typed]);
        assert!(distance(&plain, &corrected) < 1e-6, "{}", distance(&plain, &corrected));
        assert_eq!(corrected["suspicions"], Value::from(Vec::<Value>::new()));
    }
}

#[test]
fn slow_logs_and_parts_beyond_a_log_are_refused_with_what_helps() {
    let folder = temporary();
    let rows = recorded(folder.path());
    let headings = "t,q1,q2,q3,q4,q5,q6,current1,current2,current3,current4,current5,current6";
    let part = |name: &str, step: usize| {
        let rows: Vec<Row> = rows.iter().step_by(step).cloned().collect();
        let text = table(headings, ",", &rows, |_, row| [vec![row.0], row.1.clone(), row.2.clone()].concat());
        write(folder.path(), name, &text)
    };
    // 500 Hz over 25.
    let slow = part("slow.csv", 25);
    let refused = |file: &str, more: &[&str]| {
        stderr(&armid(["identify", file, "--robot", "staubli-tx40"].iter().chain(more)).code(2))
    };
    let fault = refused(&slow, &["--cutoff-hz", "12"]);
    assert!(fault.contains("cut-off frequency is 12 Hz") && fault.contains("--cutoff-hz 8 "), "{fault}");
    assert!(identify(&[&slow, "--cutoff-hz", "8"])["base"].is_array());

    let whole = part("whole.csv", 1);
    let fault = refused(&whole, &["--from", "1000"]);
    assert!(fault.contains("--from 1000 leaves nothing of ") && fault.contains("which spans 0 to "), "{fault}");
    let fault = refused(&whole, &["--from", "1000", "--until", "1001"]);
    assert!(fault.contains("--from 1000 --until 1001 leaves nothing of "), "{fault}");
}

#[test]
fn paths_of_an_estimate_hold_beside_it_and_its_own_log_validates_nothing() {
    let folder = temporary();
    let home = folder.path().join("home");
    std::fs::create_dir(&home).expect("a folder");
    recorded(&home);
    let at = |place: &Path, arguments: &[&str]| {
        assert_cmd::Command::new(support::program()).current_dir(place).args(arguments).assert()
    };
    at(&home, &["robot", "staubli-tx40", "-o", "arm.toml"]).success();
    at(&home, &["identify", "R.csv", "--robot", "arm.toml", "--held-out", "none", "-o", "E.json"]);
    // From elsewhere: robot and log are beside the estimate.
    at(folder.path(), &["report", "home/E.json", "-o", "page"]).success();
    let verdict = json(&at(folder.path(), &["validate", "home/E.json", "home/R.csv", "--limit", "0.9", "--json"]));
    let remark = verdict["remarks"][0].as_str().expect("a remark");
    assert!(remark.contains("home/R.csv is the log of the fit"), "{remark}");
    assert_eq!((&verdict["verdict"], &verdict["log_of_fit"]), (&"not a validation".into(), &"home/R.csv".into()));
    let own = ["validate", "home/E.json", "home/R.csv", "--limit"];
    let text = stdout(&at(folder.path(), &[&own[..], &["0.9"]].concat()).success());
    assert!(text.contains(": not a validation (limit 90 %)") && !text.contains("passed"), "{text}");
    let text = stdout(&at(folder.path(), &[&own[..], &["1e-6"]].concat()).code(1));
    assert!(text.contains(": not a validation, and failed (limit 1.00e-4 %)"), "{text}");
    // Other times of the log are another matter.
    let part = ["identify", "R.csv", "--robot", "arm.toml", "--held-out", "none", "--until", "7", "-o", "P.json"];
    at(&home, &part);
    let rest = ["validate", "home/P.json", "home/R.csv", "--from", "7", "--until", "11", "--limit", "0.9", "--json"];
    assert_eq!(json(&at(folder.path(), &rest))["remarks"], Value::from(Vec::<Value>::new()));
    // A robot file that is nowhere.
    std::fs::rename(home.join("arm.toml"), home.join("moved.toml")).expect("another name");
    let fault = stderr(&at(folder.path(), &["report", "home/E.json", "--robot", "nowhere.toml"]).code(2));
    assert!(fault.contains("robot file not found: nowhere.toml") && fault.contains("`armid robot`"), "{fault}");
    for command in [&["validate", "home/E.json", "home/R.csv"][..], &["export", "home/E.json", "--to", "json"]] {
        let fault = stderr(&at(folder.path(), command).code(2));
        assert!(fault.contains("robot file not found") && fault.contains("--robot ROBOT"), "{fault}");
    }
    // It is where it is said to be now, as long as it is the same.
    let page = ["report", "home/E.json", "--robot", "home/moved.toml", "-o", "moved"];
    at(folder.path(), &page).success();
    assert!(folder.path().join("moved/report.html").is_file());
    let fault = stderr(&at(folder.path(), &["report", "home/E.json", "--robot", "crs-a460"]).code(2));
    assert!(fault.contains("staubli-tx40") || fault.contains("SHA-256"), "{fault}");
}
