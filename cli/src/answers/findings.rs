//! Findings of an estimate, grouped, the most important first, at most a screen of them.

use armid::estimation::Finding;

use crate::terminal::{Align, Table};

/// Findings of one kind.
struct Group<'a> {
    rank: usize,
    finding: &'a Finding,
    of_kind: Vec<&'a Finding>,
}

/// Sentences of one kind that are shown one by one.
const SHOWN: usize = 3;

/// How important a kind is; the least comes first.
const fn rank(finding: &Finding) -> usize {
    match finding {
        Finding::Unfinished { .. } => 0,
        Finding::ResidualAboveNoise { .. } => 1,
        Finding::LackOfFit { .. } => 2,
        Finding::NegativeDrive { .. } => 3,
        Finding::InconsistentLink { .. } => 4,
        Finding::LargeCondition { .. } => 5,
        Finding::PoorlyDetermined { .. } => 6,
        Finding::ResidualCorrelated { .. } => 7,
        Finding::FewPeriods { .. } => 8,
        Finding::NoiseFromResidual => 9,
        Finding::Outliers { .. } => 10,
        Finding::HeldBack { .. } => 11,
        Finding::NearlyDependent { .. } => 12,
        Finding::BeyondShape { .. } => 13,
        Finding::LeftOut { .. } => 14,
        Finding::MotionTakenAsExact => 15,
        Finding::DurbinWuHausman { .. } => 16,
        Finding::HiddenFromPositions { .. } => 17,
        Finding::MultipleShooting { .. } => 18,
    }
}

/// What many findings of a kind have in common, and what each is about.
fn summary(found: &[&Finding]) -> Option<String> {
    let list = |names: Vec<String>| names.join(", ");
    let count = found.len();
    Some(match found.first()? {
        Finding::PoorlyDetermined { .. } => {
            let names = found.iter().filter_map(|finding| match finding {
                Finding::PoorlyDetermined { parameter, .. } => Some(parameter.clone()),
                _ => None,
            });
            let names = list(names.collect());
            format!("{count} parameters have a standard deviation of more than a third of their value: {names}")
        }
        Finding::NegativeDrive { .. } => {
            let names = found.iter().filter_map(|finding| match finding {
                Finding::NegativeDrive { parameter, .. } => Some(parameter.clone()),
                _ => None,
            });
            format!("{count} drive parameters are negative: {}", list(names.collect()))
        }
        Finding::InconsistentLink { .. } => {
            let links = found.iter().filter_map(|finding| match finding {
                Finding::InconsistentLink { link, .. } => Some(link.to_string()),
                _ => None,
            });
            format!("the completed parameters of links {} are physically inconsistent", list(links.collect()))
        }
        Finding::ResidualAboveNoise { .. } => {
            let joints = found.iter().filter_map(|finding| match finding {
                Finding::ResidualAboveNoise { joint, ratio, .. } => Some(format!("{joint} ({ratio:.1} times)")),
                _ => None,
            });
            format!("the residual is above what noise explains at joints {}", list(joints.collect()))
        }
        Finding::LackOfFit { .. } => {
            let joints = found.iter().filter_map(|finding| match finding {
                Finding::LackOfFit { joint, beyond_noise_rms, torque_rms, unit, most, .. } => {
                    let at = most.as_ref().map(|most| {
                        let (variable, [from, to], of) = (most.against.name(), most.range, &most.range_unit);
                        format!(", most at a {variable} of {from:.2} to {to:.2} {of}")
                    });
                    let share = 100.0 * beyond_noise_rms / torque_rms;
                    let at = at.unwrap_or_default();
                    Some(format!("{joint} ({beyond_noise_rms:.1e} {unit}, {share:.2} % of its torque{at})"))
                }
                _ => None,
            });
            format!("own fits leave torque beyond noise at joints {}", list(joints.collect()))
        }
        Finding::ResidualCorrelated { .. } => {
            let joints = found.iter().filter_map(|finding| match finding {
                Finding::ResidualCorrelated { joint, correlation, .. } => Some(format!("{joint} ({correlation:.2})")),
                _ => None,
            });
            format!("neighbouring residuals correlate at joints {}", list(joints.collect()))
        }
        Finding::Outliers { .. } => {
            let joints = found.iter().filter_map(|finding| match finding {
                Finding::Outliers { joint, outliers, equations, .. } => {
                    Some(format!("{joint} ({outliers} of {equations})"))
                }
                _ => None,
            });
            format!("equations are beyond 5 robust standard deviations at joints {}", list(joints.collect()))
        }
        Finding::LeftOut { .. } => {
            let names = found.iter().filter_map(|finding| match finding {
                Finding::LeftOut { parameter, .. } => Some(parameter.clone()),
                _ => None,
            });
            format!("{count} parameters are left out: {}", list(names.collect()))
        }
        Finding::BeyondShape { .. } => {
            let links = found.iter().filter_map(|finding| match finding {
                Finding::BeyondShape { link } => Some(link.to_string()),
                _ => None,
            });
            format!("the nominal bodies of links {} reach beyond their shapes", list(links.collect()))
        }
        Finding::LargeCondition { .. }
        | Finding::HeldBack { .. }
        | Finding::FewPeriods { .. }
        | Finding::NoiseFromResidual
        | Finding::NearlyDependent { .. }
        | Finding::MotionTakenAsExact
        | Finding::DurbinWuHausman { .. }
        | Finding::HiddenFromPositions { .. }
        | Finding::MultipleShooting { .. }
        | Finding::Unfinished { .. } => return None,
    })
}

/// Sentences of each kind of finding, the most important kind first, and its advice.
pub(crate) fn grouped(all: &[Finding]) -> Vec<(Vec<String>, String)> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for finding in all {
        let rank = rank(finding);
        match groups.iter_mut().find(|group| group.rank == rank) {
            Some(group) => group.of_kind.push(finding),
            None => groups.push(Group { rank, finding, of_kind: vec![finding] }),
        }
    }
    groups.sort_by_key(|group| group.rank);
    let sentences = |group: &Group<'_>| match summary(&group.of_kind).filter(|_| group.of_kind.len() > SHOWN) {
        Some(summary) => vec![summary],
        None => group.of_kind.iter().map(|finding| finding.to_string()).collect(),
    };
    groups.iter().map(|group| (sentences(group), group.finding.advice().to_string())).collect()
}

/// The findings as a text.
pub(crate) fn findings(all: &[Finding]) -> String {
    let mut text = String::new();
    for (sentences, advice) in grouped(all) {
        text.push('\n');
        for sentence in sentences {
            text.push_str(&paragraph(&sentence, 2));
        }
        text.push_str(&paragraph(&format!("→ {advice}"), 4));
    }
    text
}

/// A sentence, broken between words.
pub(crate) fn paragraph(sentence: &str, indent: usize) -> String {
    let mut table = Table::new(&[("", Align::Left)]);
    table.row([sentence]);
    table.render(indent).trim_start_matches('\n').to_owned()
}

#[cfg(test)]
mod tests {
    use super::findings;
    use armid::estimation::Finding;

    #[test]
    fn many_of_a_kind_become_one_sentence_behind_what_matters_more() {
        let mut all: Vec<Finding> = (0..33)
            .map(|k| Finding::PoorlyDetermined {
                parameter: format!("mcx{k}"),
                value: 1.0,
                std: 0.5,
                unit: "kg·m".into(),
            })
            .collect();
        all.push(Finding::NegativeDrive { parameter: "Fv2".into(), value: -1.0 });
        let text = findings(&all);
        assert!(text.lines().count() < 12, "{text}");
        let place = |word: &str| text.find(word).unwrap();
        assert!(place("Fv2 = ") < place("33 parameters have") && text.contains("mcx32"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}
