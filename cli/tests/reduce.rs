//! `armid reduce`

mod support;

use std::collections::BTreeMap;

use serde_json::Value;
use support::{armid, json, stderr, stdout, temporary};

fn counts(reduced: &Value) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for parameter in reduced["parameters"].as_array().expect("a list") {
        *counts.entry(parameter["category"].as_str().expect("a name").to_owned()).or_default() += 1;
    }
    counts
}

/// `radkhah2007` section IV.C: 9 unidentifiable, 15 in combinations, 36 in the base set.
#[test]
fn published_counts_of_the_a460_by_every_method() {
    let mut bases = Vec::new();
    for method in ["structural", "qr", "paper"] {
        let reduced = json(&armid(["reduce", "crs-a460", "--json", "--method", method]).success());
        assert_eq!(reduced["rank"], 36);
        let expected = [("unidentifiable", 9), ("identifiable", 21), ("representative", 15), ("combination", 15)];
        assert_eq!(counts(&reduced), expected.map(|(name, n)| (name.to_owned(), n)).into());
        let base = reduced["base"].as_array().unwrap();
        assert_eq!(base.len(), 36);
        let names: Vec<String> = base.iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect();
        bases.push(names);
    }
    assert_eq!(bases[0], bases[1]);
    assert_eq!(bases[0], bases[2]);
}

#[test]
fn every_base_parameter_has_a_formula_and_terms() {
    let reduced = json(&armid(["reduce", "crs-a460", "--json"]).success());
    let m2 = reduced["base"].as_array().unwrap().iter().find(|row| row["name"] == "m2").unwrap();
    assert_eq!(m2["expression"], "m2 − Izz2/a2² + m3 + m4 + m5 + m6");
    let terms: BTreeMap<&str, f64> = m2["terms"]
        .as_array()
        .unwrap()
        .iter()
        .map(|term| (term["parameter"].as_str().unwrap(), term["coefficient"].as_f64().unwrap()))
        .collect();
    // a2 of the Denavit–Hartenberg table is 0.3048 m.
    assert!((terms["Izz2"] + 1.0 / (0.3048 * 0.3048)).abs() < 1e-12);
    assert_eq!(terms["m6"], 1.0);
    assert_eq!(terms.len(), 6);
}

#[test]
fn published_ranks_with_rotors_with_friction_and_on_a_moving_base() {
    for (arguments, rank) in [
        (vec!["--columns", "rigid+rotor"], 40),
        (vec!["--columns", "rigid+rotor+friction"], 58),
        (vec!["--base", "moving"], 42),
        (vec!["--base", "moving", "--method", "qr"], 42),
        (vec!["--base", "moving", "--method", "paper"], 42),
        (vec!["--base", "planar"], 38),
    ] {
        let reduced = json(&armid(["reduce", "crs-a460", "--json"].iter().chain(&arguments)).success());
        assert_eq!(reduced["rank"], rank, "{arguments:?}");
    }
}

#[test]
fn a_trajectory_can_only_take_away() {
    let folder = temporary();
    let path = folder.path().join("one-joint.toml");
    let mut text = "period_s = 10.0\nharmonics = 1\n".to_owned();
    for (k, name) in ["waist", "shoulder", "elbow", "wrist_roll", "wrist_pitch", "tool_roll"].iter().enumerate() {
        let a = if k == 0 { 0.5 } else { 0.0 };
        text += &format!("\n[[joint]]\nname = \"{name}\"\na = [{a:?}]\nb = [0.0]\nq0 = 0.1\n");
    }
    std::fs::write(&path, &text).unwrap();
    let reduced = json(&armid(["reduce", "crs-a460", "--json", "--trajectory", path.to_str().unwrap()]).success());
    assert_eq!(reduced["method"], "paper");
    assert!(reduced["rank"].as_u64().unwrap() < 36);
    let reduced = json(&armid(["reduce", "crs-a460", "--json", "--trajectory", "table-one"]).success());
    assert_eq!(reduced["rank"], 36);

    std::fs::write(&path, text.replace("a = [0.5]", "a = [0.5, 1.0]")).unwrap();
    let fault = stderr(&armid(["reduce", "crs-a460", "--trajectory", path.to_str().unwrap()]).code(2));
    assert!(fault.contains("one-joint.toml:6:5: a of joint \"waist\" has 2 values, expected 1"), "{fault}");
    std::fs::write(&path, text.replace("harmonics = 1\n", "harmonics = \n")).unwrap();
    let fault = stderr(&armid(["reduce", "crs-a460", "--trajectory", path.to_str().unwrap()]).code(2));
    assert!(fault.contains("one-joint.toml:2:13: "), "{fault}");
    std::fs::write(&path, text.replace("waist", "hip")).unwrap();
    let fault = stderr(&armid(["reduce", "crs-a460", "--trajectory", path.to_str().unwrap()]).code(2));
    assert!(fault.contains("found the joints hip, shoulder"), "{fault}");
}

#[test]
fn what_does_not_go_together_is_refused() {
    for arguments in [
        vec!["--base", "moving", "--trajectory", "table-one"],
        vec!["--trajectory", "table-one", "--method", "structural"],
        vec!["--trajectory", "table-two"],
        vec!["--method", "guess"],
        vec!["--columns", "friction"],
    ] {
        armid(["reduce", "crs-a460"].iter().chain(&arguments)).code(2);
    }
}

#[test]
fn the_text_reads_at_a_hundred_columns() {
    for columns in ["rigid", "rigid+rotor+friction"] {
        let text = stdout(&armid(["reduce", "crs-a460", "--columns", columns]).success());
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}
