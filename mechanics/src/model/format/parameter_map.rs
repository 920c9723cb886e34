//! A map of parameter name → value, as TOML or JSON.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use toml::Spanned;

use super::error::FormatError;
use super::reading::Check;
use super::shape_parameters::{self, laws};
use crate::model::columns::Columns;
use crate::model::drive::Drive;
use crate::model::parameter_id::ParameterId;
use crate::model::parameters::{DriveParameters, StandardParameters};
use crate::model::robot::Robot;
use crate::model::term::{ShapeParameter, Term};

/// Reads a map of parameter name → value, such as `mcx2 = 0.1` in TOML or `{"mcx2": 0.1}` in JSON, and the robot with the numbers of its laws of
/// friction that the map states, such as `coulomb_velocity_rad_s2 = 0.05`.
///
/// A text whose first character is `{` is JSON. Parameters that the map does not hold are zero.
///
/// # Errors
/// [`FormatError`] with line and column: a name that the robot does not have (with those most like it), one that is
/// there twice, a value that is no finite number.
pub fn parse_parameter_map(text: &str, robot: &Robot) -> Result<(StandardParameters, Robot), FormatError> {
    let ids = Term::ALL.iter().fold(Columns::RIGID, |columns, &term| columns.with_term(term)).parameters(robot);
    let named: Vec<(String, ParameterId)> = ids.into_iter().map(|id| (id.to_string(), id)).collect();
    let mut parameters = StandardParameters::zero(robot.dof());
    let mut drives: Vec<Drive> = robot.joints().iter().map(|joint| joint.drive.clone()).collect();
    let check = Check::new(text);
    let mut set = |name: &str, value: f64, at: std::ops::Range<usize>| {
        let mut laws = shape_parameters::all();
        if let Some((shape, joint)) = laws.find_map(|shape| Some((shape, name.strip_prefix(shape.key)?)))
            && let Some(drive) = joint.parse::<usize>().ok().and_then(|joint| drives.get_mut(joint.wrapping_sub(1)))
        {
            if !(value.is_finite() && value >= 0.0) {
                return check.fault(at, format!("{name} is {value}, expected a number not below zero"));
            }
            drive.set_shape(&shape, value);
            return Ok(());
        }
        let Some((_, id)) = named.iter().find(|(known, _)| known == name) else {
            let known: Vec<&str> = named.iter().map(|(known, _)| known.as_str()).collect();
            let similar = most_similar(name, &known).join(", ");
            let message = format!("parameter \"{name}\" is not one of this robot's, expected a name such as {similar}");
            return check.fault(at, message);
        };
        if !value.is_finite() {
            return check.fault(at, format!("{name} is {value}, expected a finite number"));
        }
        parameters.set(*id, value);
        Ok(())
    };
    if text.trim_start().starts_with('{') {
        let entries: Entries<f64> = serde_json::from_str(text).map_err(|fault| FormatError::of_json(&fault))?;
        // JSON keys carry no position: they are found again in the order in which they were read.
        let mut from = 0;
        let mut seen: Vec<&str> = Vec::new();
        for (name, value) in &entries.0 {
            let key = serde_json::to_string(name).unwrap_or_default();
            let at = text[from..].find(&key).map_or(from..from, |i| from + i..from + i + key.len());
            from = at.end;
            if seen.contains(&name.as_str()) {
                return check.fault(at, format!("parameter \"{name}\" is there twice, expected it once"));
            }
            seen.push(name);
            set(name, *value, at)?;
        }
    } else {
        let entries: Entries<Spanned<f64>> =
            toml::from_str(text).map_err(|fault| FormatError::of_toml(text, &fault))?;
        for (name, value) in &entries.0 {
            set(name, *value.get_ref(), value.span())?;
        }
    }
    Ok((parameters, robot.clone().with_drives(drives)))
}

/// The numbers of a robot's laws of friction with which the parameters act, by the names that [`parse_parameter_map`] reads.
pub fn law_map(robot: &Robot, parameters: &StandardParameters) -> BTreeMap<String, f64> {
    let of = |(index, drive): (usize, &DriveParameters)| {
        let value = move |shape: &ShapeParameter| robot.joints()[index].drive.shape(shape);
        laws(drive).into_iter().map(move |shape| (format!("{}{}", shape.key, index + 1), value(&shape)))
    };
    parameters.drives.iter().enumerate().flat_map(of).collect()
}

/// The entries of a map in the order of the text.
struct Entries<T>(Vec<(String, T)>);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EntriesVisitor<T>(std::marker::PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for EntriesVisitor<T> {
            type Value = Entries<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map of parameter name to value")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(EntriesVisitor(std::marker::PhantomData))
    }
}

/// The five names that are nearest to a misspelt one.
fn most_similar<'a>(name: &str, known: &[&'a str]) -> Vec<&'a str> {
    let mut ranked: Vec<(usize, &str)> =
        known.iter().map(|&k| (edit_distance(&name.to_lowercase(), &k.to_lowercase()), k)).collect();
    ranked.sort_by_key(|&(distance, _)| distance);
    ranked.into_iter().take(5).map(|(_, name)| name).collect()
}

/// Levenshtein distance: insertions, deletions and replacements from `a` to `b`.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, &to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            let nearest = replaced.min(row[j] + 1).min(row[j + 1] + 1);
            diagonal = std::mem::replace(&mut row[j + 1], nearest);
        }
    }
    row[b.len()]
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a number of the text is read to its last bit")]
mod tests {
    use super::*;
    use crate::model::format::fault_tests::{TWO_JOINTS, expect_fault};
    use crate::model::format::parse_robot;
    use crate::model::term::OFFSET;

    #[test]
    fn analytic_toml_and_json_give_the_same_set() {
        let robot = parse_robot(TWO_JOINTS).unwrap();
        let text = "# guess\nmcx2 = 0.1\nIyy1 = 2\nFo1 = -3e-1\nFc2 = 1\ncoulomb_velocity_rad_s2 = 0.07\n";
        let (toml, moved) = parse_parameter_map(text, &robot).unwrap();
        let text = " {\"Iyy1\": 2, \"mcx2\": 1e-1,\n \"Fo1\": -0.3, \"Fc2\": 1, \"coulomb_velocity_rad_s2\": 7e-2}";
        assert_eq!((toml.clone(), moved.clone()), parse_parameter_map(text, &robot).unwrap());
        assert_eq!(moved.joints()[1].drive.coulomb_velocity, 0.07);
        assert_eq!(law_map(&moved, &toml), BTreeMap::from([("coulomb_velocity_rad_s2".to_owned(), 0.07)]));
        assert_eq!(toml.links[1].first_moment.x, 0.1);
        assert_eq!(toml.links[0].rotational[(1, 1)], 2.0);
        assert_eq!(toml.drives[0][OFFSET], -0.3);
    }

    #[test]
    fn analytic_faults_say_where_and_what_else() {
        let robot = parse_robot(TWO_JOINTS).unwrap();
        let parse = |text: &str| parse_parameter_map(text, &robot);
        for (text, found) in [
            ("m1 = 1\nmxc2 = ¶0.1\n", "mcx2"),
            ("m1 = ¶nan\n", "finite"),
            ("coulomb_velocity_rad_s1 = ¶-1.0\n", "not below zero"),
            ("m1 = ¶\"one\"\n", "expected f64"),
            ("m1 = 1\n¶m1 = 2\n", "duplicate"),
            ("{\"m1\": 1,\n ¶\"m7\": 2}", "m1, m2"),
            ("{\"m1\": 1,\n ¶\"m1\": 2}", "twice"),
            ("{\"m1\": \"one¶\"}", "expected f64"),
        ] {
            expect_fault(parse, text, found);
        }
    }

    #[test]
    fn published_edit_distance_of_kitten_and_sitting() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
    }
}
