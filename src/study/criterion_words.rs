//! Names of groups of designs, as sentences write them.

/// The name of a group of designs in prose: `condition` is the condition number.
pub fn criterion_in_words(name: &str) -> String {
    match name {
        "condition" => "condition number".to_owned(),
        "condition-scaled" => "column-normalised condition number".to_owned(),
        _ if name.ends_with("-optimal") || name.ends_with("-optimal, equal speed") => capitalised(name),
        _ => name.to_owned(),
    }
}

/// Two groups of designs that are compared.
pub fn criterion_pair_in_words(first: &str, second: &str) -> String {
    format!("{} against {}", capitalised(&criterion_in_words(first)), criterion_in_words(second))
}

/// `text` with a capital at its beginning.
pub fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().into_iter().flat_map(char::to_uppercase).chain(rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_words() {
        for (name, words) in [
            ("condition", "condition number"),
            ("condition-scaled", "column-normalised condition number"),
            ("d-optimal", "D-optimal"),
            ("d-optimal, equal speed", "D-optimal, equal speed"),
            ("random", "random"),
        ] {
            assert_eq!(criterion_in_words(name), words);
        }
        assert_eq!(criterion_pair_in_words("condition", "d-optimal"), "Condition number against D-optimal");
    }
}
