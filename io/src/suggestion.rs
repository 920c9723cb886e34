//! "Did you mean …?"

/// The name that was probably meant.
pub fn nearest<'a>(found: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let found = found.to_lowercase();
    names
        .into_iter()
        .map(|name| {
            let lower = name.to_lowercase();
            let parts = lower.contains(&found) || found.contains(&lower);
            let distance = strsim::damerau_levenshtein(&found, &lower);
            (if parts && found.len() > 2 { distance.min(2) } else { distance }, name)
        })
        .filter(|(distance, name)| *distance <= (name.chars().count() / 3).max(2))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// `expected one of …` with, where one is near, `did you mean …?`.
pub fn help(found: &str, names: &[&str]) -> String {
    let list = names.join(", ");
    match nearest(found, names.iter().copied()) {
        Some(name) => format!("did you mean \"{name}\"? Expected one of: {list}"),
        None => format!("expected one of: {list}"),
    }
}

/// The name that was probably meant, from a reader's "unknown field `x`, expected one of `y`, `z`".
pub(crate) fn from_list_in(message: &str) -> Option<String> {
    if !message.starts_with("unknown ") {
        return None;
    }
    let mut quoted = message.split('`').skip(1).step_by(2);
    let found = quoted.next()?;
    nearest(found, quoted).map(|name| format!("did you mean \"{name}\"?"))
}

#[cfg(test)]
mod tests {
    use super::{from_list_in, nearest};

    #[test]
    fn a_list_of_expected_names_is_read() {
        let message = "unknown field `gaer`, expected one of `torque_constant`, `gear`, `sign`";
        assert_eq!(from_list_in(message).as_deref(), Some("did you mean \"gear\"?"));
        assert_eq!(from_list_in("missing field `gear`"), None);
    }

    #[test]
    fn the_nearest_name_is_proposed_and_a_far_one_is_not() {
        let names = ["crs-a460", "puma-560", "staubli-tx40", "planar-2r"];
        assert_eq!(nearest("crs-a640", names), Some("crs-a460"));
        assert_eq!(nearest("a460", names), Some("crs-a460"));
        assert_eq!(nearest("TX40", names), Some("staubli-tx40"));
        assert_eq!(nearest("panda", names), None);
    }
}
