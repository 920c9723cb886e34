//! Whether several robots agree on two criteria.

/// Whether several robots agree on two criteria.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// On every robot the same criterion is better.
    Same,
    /// On one robot one criterion is better, on another the other.
    Reversed,
    /// One criterion is better on some robots; on the others the difference is not significant.
    InPart,
    /// Neither is better on any robot.
    Undecided,
    /// Only one robot has both criteria.
    OneRobot,
}

crate::input::named! { Agreement as words {
    Same: "the same on every robot", InPart: "significant on some robots", Reversed: "reversed",
    Undecided: "not significant on any robot", OneRobot: "on one robot only"
} }

impl Agreement {
    /// The agreement of robots that have both families, by the better one on each: `None` if not significant.
    pub fn from_better(better: &[Option<&str>]) -> Self {
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
            assert_eq!(Agreement::from_better(better), expected, "{better:?}");
        }
    }
}
