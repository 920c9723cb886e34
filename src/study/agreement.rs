//! Whether several robots say the same of two families of designs.

/// Whether several robots say the same of two families of designs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// On every robot the same family is better.
    Same,
    /// On one robot the one family is better, on another the other.
    Reversed,
    /// One family is better on some robots; on the others it is undecided.
    InPart,
    /// Neither is better on any robot.
    Undecided,
    /// One robot alone has both families.
    OneRobot,
}

impl Agreement {
    /// Every one, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Same, Self::InPart, Self::Reversed, Self::Undecided, Self::OneRobot];

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Same => "the same on every robot",
            Self::Reversed => "turned round",
            Self::InPart => "decided on some robots",
            Self::Undecided => "undecided on every robot",
            Self::OneRobot => "compared on one robot alone",
        }
    }

    /// What the robots that have both families say: the better one on each, `None` where it is undecided.
    #[must_use]
    pub fn of(better: &[Option<&str>]) -> Self {
        if better.len() < 2 {
            return Self::OneRobot;
        }
        let decided: Vec<&str> = better.iter().copied().flatten().collect();
        match decided.first() {
            None => Self::Undecided,
            Some(first) if decided.iter().any(|family| family != first) => Self::Reversed,
            Some(_) if decided.len() < better.len() => Self::InPart,
            Some(_) => Self::Same,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Agreement;

    #[test]
    fn analytic_what_robots_say_of_two_families() {
        let (a, b, open) = (Some("a"), Some("b"), None);
        for (better, expected) in [
            (&[a, a][..], Agreement::Same),
            (&[b, b, b], Agreement::Same),
            (&[a, b], Agreement::Reversed),
            (&[a, open, b], Agreement::Reversed),
            (&[open, b], Agreement::InPart),
            (&[a, open, a], Agreement::InPart),
            (&[open, open], Agreement::Undecided),
            (&[a], Agreement::OneRobot),
            (&[open], Agreement::OneRobot),
            (&[], Agreement::OneRobot),
        ] {
            assert_eq!(Agreement::of(better), expected, "{better:?}");
        }
    }
}
