//! Which joints of a log are those of a robot, by their names.

use std::collections::BTreeSet;

use armid::model::{EffortInterface, Robot};
use armid::remedy::{Remedy, Setting};

use super::arrangement;
use crate::error::Error;

/// What the joints of a robot are called in a log: by their own names, or by those behind one prefix, `arm1/elbow` or
/// `arm1_elbow`. The names in the order of the robot's joints, and the prefix where there is one. `name` is that of the log.
///
/// # Errors
/// [`Error`] where a joint is missing, or several prefixes are possible.
pub(super) fn names_in_log(
    name: &str,
    robot: &Robot,
    found: &BTreeSet<&str>,
) -> Result<(Vec<String>, Option<String>), Error> {
    let wanted: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    let with = |prefix: &str| -> Option<Vec<String>> {
        let names = wanted.iter().map(|joint| format!("{prefix}{joint}"));
        names.map(|joint| found.contains(joint.as_str()).then_some(joint)).collect()
    };
    if let Some(names) = with("") {
        return Ok((names, None));
    }
    let prefixes: BTreeSet<&str> = found
        .iter()
        .filter_map(|joint| joint.strip_suffix(*wanted.first()?))
        .filter(|prefix| prefix.ends_with(|c: char| !c.is_alphanumeric()) && with(prefix).is_some())
        .collect();
    let list = |names: &mut dyn Iterator<Item = &str>| names.collect::<Vec<_>>().join(", ");
    match prefixes.first().and_then(|prefix| with(prefix).map(|names| (prefix, names))) {
        Some((prefix, names)) if prefixes.len() == 1 => Ok((names, Some((*prefix).to_owned()))),
        Some((prefix, names)) => {
            let message = format!(
                "{name} holds the joints of robot \"{}\" with several prefixes, {}, expected one",
                robot.name(),
                list(&mut prefixes.iter().copied())
            );
            let names = names.join("/");
            let help = Remedy::from(format!("those with {prefix} are chosen by "))
                .assign(Setting::Map, format!("q={names}, tau={names}"));
            Err(Error::mismatch(message).help(help))
        }
        None => {
            let help = paired(&wanted, found).map(|(names, by_name)| {
                let (names, key) =
                    (names.join("/"), if robot.effort() == EffortInterface::Current { "current" } else { "tau" });
                let how =
                    if by_name { "which end as the robot's do" } else { "as many, in this order as far as is known" };
                Remedy::set(Setting::Map, format!("q={names}, {key}={names}"))
                    .say(format!(" takes those of the log, {how}"))
            });
            let (found, wanted) = (list(&mut found.iter().copied()), wanted.join(", "));
            let message = format!("{name} holds the joints {found}, expected {wanted} of robot \"{}\"", robot.name());
            Err(Error::mismatch(message).help(help.unwrap_or_else(arrangement::help)))
        }
    }
}

/// The joints of a log that may be those of a robot: for each the one whose name ends most alike, or where that is not clear and there are
/// as many, all of them in the order of their names and numbers. Whether the names say it.
fn paired<'a>(wanted: &[&str], found: &BTreeSet<&'a str>) -> Option<(Vec<&'a str>, bool)> {
    let alike = |a: &str, b: &str| a.chars().rev().zip(b.chars().rev()).take_while(|(a, b)| a == b).count();
    let nearest = |joint: &&str| {
        let most = found.iter().map(|name| alike(name, joint)).max().filter(|most| *most > 0)?;
        let mut at_most = found.iter().filter(|name| alike(name, joint) == most);
        at_most.next().filter(|_| at_most.next().is_none()).copied()
    };
    let by_name: Option<Vec<&str>> = wanted.iter().map(nearest).collect();
    if let Some(names) = by_name.filter(|names| names.iter().collect::<BTreeSet<_>>().len() == wanted.len()) {
        return Some((names, true));
    }
    // "joint10" comes behind "joint9".
    let order = |name: &&str| {
        let front = name.trim_end_matches(|c: char| c.is_ascii_digit());
        (front.to_owned(), name[front.len()..].parse::<u64>().unwrap_or(0))
    };
    let mut names: Vec<&str> = found.iter().copied().collect();
    names.sort_by_key(order);
    (names.len() == wanted.len()).then_some((names, false))
}

#[cfg(test)]
mod tests {
    use super::names_in_log;
    use crate::robot;

    #[test]
    fn joints_are_found_by_their_names_or_behind_one_prefix() {
        let robot = robot::find("planar-2r").unwrap().robot;
        let joints: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
        let of = |prefixes: &[&str]| {
            let names: Vec<String> =
                prefixes.iter().flat_map(|prefix| joints.iter().map(move |joint| format!("{prefix}{joint}"))).collect();
            names_in_log("bag", &robot, &names.iter().map(String::as_str).chain(["finger"]).collect())
        };
        assert_eq!(of(&[""]).unwrap(), (joints.iter().map(|&name| name.to_owned()).collect(), None));
        // Its own names come first.
        assert_eq!(of(&["left/", ""]).unwrap().1, None);
        let (names, prefix) = of(&["left/"]).unwrap();
        assert_eq!((names[1].clone(), prefix.as_deref()), (format!("left/{}", joints[1]), Some("left/")));
        let fault = of(&["left_", "right_"]).unwrap_err();
        assert!(fault.message().contains("several prefixes, left_, right_"), "{fault}");
        assert!(fault.hint().unwrap().contains(&format!("q=left_{}/left_{}", joints[0], joints[1])));
        // Other names: those that end alike, or all of them.
        let hint =
            |names: &[&str]| names_in_log("bag", &robot, &names.iter().copied().collect()).unwrap_err().hint().unwrap();
        let [a, b] = [joints[0], joints[1]].map(|joint| format!("my{joint}"));
        let wanted = format!("q={a}/{b}, tau={a}/{b}\" takes those of the log, which end");
        assert!(hint(&[&b, &a, "finger"]).contains(&wanted), "{}", hint(&[&b, &a, "finger"]));
        assert!(hint(&["x10", "x9"]).contains("q=x9/x10, tau=x9/x10"), "{}", hint(&["x10", "x9"]));
        // No word of its own, so that it is part of another name.
        assert!(of(&["left"]).unwrap_err().message().contains("bag holds the joints finger, left"));
    }
}
