//! Joint states of ROS 2 as other tools record them: by mapping, prefix, part of an arm, topic and clock.

mod support;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use armid_cdr::{JointState, Time};
use mcap::records::MessageHeader;
use serde_json::Value;
use support::{armid, json, stderr, temporary, write};

/// One row: time, positions, torques.
type Row = (f64, [f64; 2], [f64; 2]);

/// A message: topic, when it was recorded, what it holds.
type Sent = (&'static str, i64, JointState);

const JOINTS: [&str; 2] = ["shoulder", "elbow"];

/// A motion of the planar arm of 10 s at 250 Hz, and the table of it.
fn recorded(folder: &Path) -> (Vec<Row>, String) {
    let joint = |name: &str, a: &str, b: &str| format!("\n[[joint]]\nname = \"{name}\"\na = {a}\nb = {b}\nq0 = 0.1\n");
    let motion = "period_s = 4.0\nharmonics = 2\n".to_owned()
        + &joint("shoulder", "[0.5, 0.3]", "[0.2, -0.3]")
        + &joint("elbow", "[-0.3, 0.4]", "[0.5, 0.3]");
    write(folder, "T.toml", &motion);
    let experiment = "robot = \"planar-2r\"\ntrajectory = \"T.toml\"\nperiods = 1\nrate_hz = 250\nramp_s = 1\n";
    let experiment = write(folder, "x.toml", experiment);
    let table = folder.join("R.csv").to_str().expect("a path in UTF-8").to_owned();
    armid(["run", &experiment, "-o", &table]).success();
    let text = std::fs::read_to_string(&table).expect("the recording");
    assert!(text.starts_with("t,q1,q2,tau1,tau2\n"), "{}", &text[..40]);
    let rows = text.lines().skip(1).map(|line| {
        let row: Vec<f64> = line.split(',').map(|value| value.parse().expect("a number")).collect();
        (row[0], [row[1], row[2]], [row[3], row[4]])
    });
    (rows.collect(), table)
}

fn ns(t: f64) -> i64 {
    1_700_000_000_000_000_000 + (t * 1e9).round() as i64
}

/// A joint state of some joints at a time.
fn state(t_ns: i64, names: &[&str], q: &[f64], effort: &[f64]) -> JointState {
    JointState {
        stamp: Time::from_ns(t_ns).expect("a time"),
        name: names.iter().map(|&name| name.to_owned()).collect(),
        position: q.to_vec(),
        effort: effort.to_vec(),
        ..JointState::default()
    }
}

/// Messages of every row with both joints, called so.
fn whole(rows: &[Row], topic: &'static str, names: [&str; 2]) -> Vec<Sent> {
    rows.iter().map(|(t, q, tau)| (topic, ns(*t), state(ns(*t), &names, q, tau))).collect()
}

/// Writes messages into an MCAP file, a channel for each topic.
fn bag(folder: &Path, name: &str, mut messages: Vec<Sent>) -> String {
    messages.sort_by_key(|message| message.1);
    let path = folder.join(name);
    let file = BufWriter::new(File::create(&path).expect("a file"));
    let mut writer = mcap::WriteOptions::new().create(file).expect("a writer");
    let schema = writer.add_schema(JointState::NAME, "ros2msg", JointState::DEFINITION.as_bytes()).expect("a schema");
    let mut channels = BTreeMap::new();
    for (k, (topic, time, state)) in messages.iter().enumerate() {
        let channel_id = *channels
            .entry(*topic)
            .or_insert_with(|| writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel"));
        let time = u64::try_from(*time).expect("a time after 1970");
        let header = MessageHeader { channel_id, sequence: k as u32, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &state.encode().expect("bytes")).expect("a message");
    }
    writer.finish().expect("the end of the file");
    path.to_str().expect("a path in UTF-8").to_owned()
}

fn identify(arguments: &[&str]) -> Value {
    let all = ["identify"].into_iter().chain(arguments.iter().copied()).chain(["--robot", "planar-2r", "--json"]);
    let done = armid(all);
    let code = done.get_output().status.code();
    assert!(matches!(code, Some(0 | 1)), "{}", stderr(&done));
    json(&done)
}

fn refused(arguments: &[&str]) -> String {
    stderr(&armid(["identify", "--robot", "planar-2r"].iter().chain(arguments)).code(2))
}

/// Largest difference between the base parameters of two estimates, in standard deviations of the first.
fn distance(a: &Value, b: &Value) -> f64 {
    let list = |of: &Value| of["base"].as_array().expect("a list of parameters").clone();
    let (a, b) = (list(a), list(b));
    assert_eq!(a.len(), b.len());
    let number = |of: &Value, key: &str| of[key].as_f64().expect("a number");
    let differs = |(a, b): (&Value, &Value)| (number(a, "value") - number(b, "value")) / number(a, "std");
    a.iter().zip(&b).map(differs).fold(0.0, |worst, x| worst.max(x.abs()))
}

/// What was remarked of the first log.
fn remarks(estimate: &Value) -> String {
    estimate["logs"][0]["remarks"].to_string()
}

#[test]
fn identity_a_mapping_of_joint_states_gives_what_the_plain_table_gives() {
    let folder = temporary();
    let (rows, table) = recorded(folder.path());
    let plain = identify(&[&table]);
    let same = |found: &Value| assert!(distance(&plain, found) < 1e-6, "{}", distance(&plain, found));
    let file = bag(folder.path(), "plain.mcap", whole(&rows, "/joint_states", JOINTS));
    same(&identify(&[&file]));

    // Degrees, a sign, an offset, torques at the motors, exchanged names.
    let other = rows.iter().map(|(t, q, tau)| {
        let q = [q[1].to_degrees() - 90.0, -q[0].to_degrees()];
        (*t, q, [tau[1] / 50.0, tau[0] / -100.0])
    });
    let other: Vec<Row> = other.collect();
    let other = bag(folder.path(), "other.mcap", whole(&other, "/joint_states", JOINTS));
    let map = "q=elbow/shoulder deg sign=-+ offset_deg=0/90, tau=elbow/shoulder motor gear=-100/50";
    let found = identify(&[&other, "--map", map]);
    same(&found);
    assert_eq!(found["inputs"]["mapping"], map);
    assert_eq!(found["logs"][0]["columns"][0], "q from elbow shoulder in deg");
    // The estimate remembers it for another log of the kind.
    let estimate = folder.path().join("E.json");
    let estimate = estimate.to_str().expect("a path in UTF-8");
    armid(["identify", &other, "--robot", "planar-2r", "--map", map, "-o", estimate]);
    let verdict = json(&armid(["validate", estimate, &other, "--limit", "0.5", "--json"]).success());
    assert!(verdict["remarks"].to_string().contains("is the log of the fit"), "{verdict}");
}

#[test]
fn what_a_mapping_of_joint_states_cannot_say_is_refused() {
    let folder = temporary();
    let (rows, _) = recorded(folder.path());
    let file = bag(folder.path(), "plain.mcap", whole(&rows, "/joint_states", JOINTS));
    for (arguments, wanted) in [
        (["--map", "q=nonsense[1-2], tau=shoulder/elbow"], "holds no joint \"nonsense1\", found elbow, shoulder"),
        (["--map", "t=time, q=shoulder/elbow, tau=shoulder/elbow"], "the stamps of its messages"),
        (["--map", "q=shoulder/elbow, tau=shoulder"], "tau names 1 joints, expected 2"),
        (["--map", "q=a:shoulder/elbow, tau=shoulder/elbow"], "found the file \"a\""),
        (["--map", "q=shoulder/elbow motor gear=1/2/3, tau=shoulder/elbow"], "gear has 3 values"),
        (["--map", "topic=/nowhere"], "no joint states on /nowhere, found /joint_states"),
        (["--rate", "3"], "has the stamps of its messages, found a rate of 3 Hz"),
    ] {
        let fault = refused(&[&[file.as_str()][..], &arguments[..]].concat());
        assert!(fault.contains(wanted), "{wanted} not in {fault}");
    }
    // A recording of armid's own states all of it.
    let own = folder.path().join("R.mcap").to_str().expect("a path in UTF-8").to_owned();
    let experiment = folder.path().join("x.toml");
    armid(["run", experiment.to_str().expect("a path in UTF-8"), "-o", &own]).success();
    assert!(refused(&[&own, "--map", "q=shoulder/elbow, tau=shoulder/elbow"]).contains("found --map"));
    assert!(refused(&[&own, "--rate", "3"]).contains("found --rate"));
}

#[test]
fn messages_of_other_things_and_names_with_a_prefix_are_no_hindrance() {
    let folder = temporary();
    let (rows, table) = recorded(folder.path());
    let plain = identify(&[&table]);
    // A gripper without efforts on the same topic, the first of all.
    let mut messages = whole(&rows, "/joint_states", JOINTS);
    let first = messages[0].1;
    messages.extend((0..50).map(|k| {
        let time = first - 1 + 20_000_000 * k;
        ("/joint_states", time, state(time, &["finger"], &[0.1], &[]))
    }));
    let found = identify(&[&bag(folder.path(), "gripper.mcap", messages)]);
    assert!(distance(&plain, &found) < 1e-6);
    assert!(remarks(&found).contains("50 of"), "{}", remarks(&found));
    assert!(remarks(&found).contains("hold none of the joints"), "{}", remarks(&found));

    let names = ["arm1/shoulder", "arm1/elbow"];
    let found = identify(&[&bag(folder.path(), "prefix.mcap", whole(&rows, "/joint_states", names))]);
    assert!(distance(&plain, &found) < 1e-6);
    assert!(remarks(&found).contains("the prefix \\\"arm1/\\\""), "{}", remarks(&found));
    // Two arms: one has to be chosen, as the error says.
    let mut both = whole(&rows, "/joint_states", names);
    both.extend(whole(&rows, "/joint_states", ["arm2/shoulder", "arm2/elbow"]));
    let both = bag(folder.path(), "two.mcap", both);
    assert!(refused(&[&both]).contains("several prefixes, arm1/, arm2/"));
    let map = "q=arm1/shoulder/arm1/elbow, tau=arm1/shoulder/arm1/elbow";
    assert!(distance(&plain, &identify(&[&both, "--map", map])) < 1e-6);
}

#[test]
fn an_arm_in_two_parts_is_joined_where_both_are_of_the_same_times() {
    let folder = temporary();
    let (rows, table) = recorded(folder.path());
    let plain = identify(&[&table]);
    let parts = |late_ns: i64| -> Vec<Sent> {
        let of = |(t, q, tau): &Row| {
            let (first, second) = (ns(*t), ns(*t) + late_ns);
            [
                ("/joint_states", first, state(first, &["shoulder"], &q[..1], &tau[..1])),
                ("/joint_states", second, state(second, &["elbow"], &q[1..], &tau[1..])),
            ]
        };
        rows.iter().flat_map(of).collect()
    };
    let found = identify(&[&bag(folder.path(), "parts.mcap", parts(200_000))]);
    assert!(distance(&plain, &found) < 1e-6, "{}", distance(&plain, &found));
    assert!(remarks(&found).contains("at most 0.200 ms away"), "{}", remarks(&found));
    let fault = refused(&[&bag(folder.path(), "apart.mcap", parts(3_600_000_000_000))]);
    assert!(fault.contains("are of other times than those of the other joints"), "{fault}");
}

#[test]
fn stamps_that_stand_still_give_way_to_the_times_of_the_recorder_and_a_topic_is_chosen() {
    let folder = temporary();
    let (rows, table) = recorded(folder.path());
    let plain = identify(&[&table]);
    let mut messages = whole(&rows, "/joint_states", JOINTS);
    for message in &mut messages {
        message.2.stamp = Time::default();
    }
    let found = identify(&[&bag(folder.path(), "still.mcap", messages)]);
    assert!(distance(&plain, &found) < 1e-6);
    assert!(remarks(&found).contains("at which they were recorded are taken"), "{}", remarks(&found));

    let mut messages = whole(&rows, "/arm/joint_states", JOINTS);
    messages.extend(whole(&rows[..500], "/hand/joint_states", ["thumb", "finger"]));
    let file = bag(folder.path(), "topics.mcap", messages);
    let fault = refused(&[&file]);
    assert!(fault.contains("/arm/joint_states, /hand/joint_states"), "{fault}");
    assert!(fault.contains("--map \"topic=/arm/joint_states\""), "{fault}");
    let found = identify(&[&file, "--map", "topic=/arm/joint_states"]);
    assert!(distance(&plain, &found) < 1e-6);
    assert_eq!(found["inputs"]["mapping"], "topic=/arm/joint_states");
}

#[test]
fn what_is_advised_for_currents_without_constants_can_be_typed() {
    let folder = temporary();
    let (rows, table) = recorded(folder.path());
    // An arm over a URDF has neither gears nor constants.
    let urdf = folder.path().join("arm.urdf").to_str().expect("a path in UTF-8").to_owned();
    let joint = |name: &str, parent: &str, child: &str, xyz: &str| {
        format!(
            "<link name=\"{child}\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" \
             ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial></link><joint name=\"{name}\" type=\"revolute\">\
             <origin xyz=\"{xyz}\"/><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 1 0\"/><limit \
             lower=\"-3\" upper=\"3\" velocity=\"3\" effort=\"50\"/></joint>"
        )
    };
    let text = "<robot name=\"two\"><link name=\"world\"/>".to_owned()
        + &joint("shoulder", "world", "upper", "0 0 0")
        + &joint("elbow", "upper", "lower", "0.4 0 0")
        + "</robot>";
    std::fs::write(&urdf, text).expect("a file");
    let file = bag(folder.path(), "plain.mcap", whole(&rows, "/joint_states", JOINTS));
    for log in [&file, &table] {
        let asked = ["identify", log, "--robot", &urdf, "--effort", "current"];
        let fault = stderr(&armid(asked).code(2));
        let advised = fault.split("--map \"").nth(1).and_then(|rest| rest.split('"').next());
        let map = advised.unwrap_or_else(|| panic!("no --map in {fault}"));
        let done = armid(asked.iter().chain(&["--map", map, "--json"]));
        assert!(matches!(done.get_output().status.code(), Some(0 | 1)), "{map}: {}", stderr(&done));
        assert_eq!(json(&done)["units"][0], "N·m");
    }
}
