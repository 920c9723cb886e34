//! No text makes a reader panic: the bundled files and small imports, damaged at random.

use rand::RngExt;

use super::{ChainEnds, parse_mjcf, parse_nominal, parse_parameter_map, parse_parameters, parse_robot, parse_urdf};
use crate::model::bundled;
use crate::seed::{Seed, Stream};

/// Removes, doubles or replaces a few pieces of a text.
fn damage(text: &str, rng: &mut Stream) -> String {
    let mut characters: Vec<char> = text.chars().collect();
    for _ in 0..rng.random_range(1..4) {
        if characters.is_empty() {
            break;
        }
        let at = rng.random_range(0..characters.len());
        let end = (at + rng.random_range(1..12_usize)).min(characters.len());
        match rng.random_range(0..4) {
            0 => drop(characters.drain(at..end)),
            1 => {
                let piece: Vec<char> = characters[at..end].to_vec();
                characters.splice(at..at, piece);
            }
            2 => characters[at] = ['"', '[', ']', '=', '\n', '<', '>', '-', 'é', '9', '.'][rng.random_range(0..11)],
            _ => characters.truncate(at),
        }
    }
    characters.into_iter().collect()
}

/// Reads damaged versions of a text; a fault must stand inside the text.
fn survives<T>(text: &str, rng: &mut Stream, parse: impl Fn(&str) -> Result<T, super::FormatError>) {
    let mut refused = 0;
    for _ in 0..200 {
        let damaged = damage(text, rng);
        if let Err(fault) = parse(&damaged) {
            refused += 1;
            assert!(fault.line >= 1 && fault.line <= damaged.matches('\n').count() + 2, "{fault}");
            assert!(fault.column >= 1 && !fault.message.is_empty(), "{fault}");
        }
    }
    assert!(refused > 20, "only {refused} of 200 damaged texts were refused");
}

#[test]
fn identity_no_text_makes_a_reader_panic() {
    let mut rng = Seed::new(11).stream("damage", 0);
    let ends = ChainEnds::default();
    for entry in bundled() {
        let robot = parse_robot(entry.robot).unwrap();
        survives(entry.robot, &mut rng, parse_robot);
        survives(entry.nominal, &mut rng, |text| parse_nominal(text, &robot));
        let links = &entry.nominal[entry.nominal.find("[[link]]").unwrap()..];
        survives(links, &mut rng, |text| parse_parameters(text, &robot, true));
        survives("m1 = 1.5\nIyy2 = 0.1\nFc1 = -3e-1\n", &mut rng, |text| parse_parameter_map(text, &robot));
        survives(r#"{"m1": 1.5, "Iyy2": 0.1, "Fc1": -3e-1}"#, &mut rng, |text| parse_parameter_map(text, &robot));
    }
    survives(super::urdf_tests::TREE, &mut rng, |text| parse_urdf(text, &ends));
    survives(super::mjcf_tests::MIXED, &mut rng, |text| parse_mjcf(text, &ends));
}

#[test]
fn identity_deep_nesting_is_refused_not_followed() {
    let ends = ChainEnds::default();
    let nested = |open: &str, close: &str| format!("{}{}", open.repeat(5_000), close.repeat(5_000));
    let bodies = format!("<mujoco><worldbody>{}</worldbody></mujoco>", nested("<body>", "</body>"));
    assert!(parse_mjcf(&bodies, &ends).is_err());
    let classes = format!("<mujoco>{}</mujoco>", nested("<default class=\"a\">", "</default>"));
    assert!(parse_mjcf(&classes, &ends).is_err());
    assert!(parse_robot(&format!("name = {}", nested("[", "]"))).is_err());
}
