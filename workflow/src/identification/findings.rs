//! Findings of an estimate, grouped, the most important first, at most a screen of them.

use armid::estimation::Finding;

/// Findings of one kind.
pub(super) struct Group<'a> {
    rank: usize,
    finding: &'a Finding,
    of_kind: Vec<&'a Finding>,
}

/// Sentences of one kind that are shown one by one.
const SHOWN: usize = 3;

/// The last kind that belongs on the first screen.
const LAST_THAT_MATTERS: usize = 4;

/// How important a kind is; the least comes first.
const fn rank(finding: &Finding) -> usize {
    match finding {
        Finding::Unfinished { .. } => 0,
        Finding::NoNoise => 1,
        Finding::ResidualAboveNoise { .. } => 2,
        Finding::LackOfFit { .. } => 3,
        Finding::Impossible { .. } | Finding::NegativeDrive { .. } => LAST_THAT_MATTERS,
        Finding::InconsistentLink { .. } => 5,
        Finding::LargeCondition { .. } => 6,
        Finding::PoorlyDetermined { .. } => 7,
        Finding::ResidualCorrelated { .. } => 8,
        Finding::FewPeriods { .. } => 9,
        Finding::NoiseFromResidual => 10,
        Finding::Outliers { .. } => 11,
        Finding::HeldBack { .. } => 12,
        Finding::NearlyDependent { .. } => 13,
        Finding::BeyondShape { .. } => 14,
        Finding::LeftOut { .. } => 15,
        Finding::MotionTakenAsExact => 16,
        Finding::DurbinWuHausman { .. } => 17,
        Finding::HiddenFromPositions { .. } => 18,
        Finding::MultipleShooting { .. } => 19,
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
        | Finding::Impossible { .. }
        | Finding::HeldBack { .. }
        | Finding::FewPeriods { .. }
        | Finding::NoNoise
        | Finding::NoiseFromResidual
        | Finding::NearlyDependent { .. }
        | Finding::MotionTakenAsExact
        | Finding::DurbinWuHausman { .. }
        | Finding::HiddenFromPositions { .. }
        | Finding::MultipleShooting { .. }
        | Finding::Unfinished { .. } => return None,
    })
}

impl Group<'_> {
    /// Whether it belongs on the first screen.
    pub(super) const fn matters(&self) -> bool {
        self.rank <= LAST_THAT_MATTERS
    }

    /// Its sentences, and its advice.
    pub(super) fn said(&self) -> (Vec<String>, String) {
        let sentences = match summary(&self.of_kind).filter(|_| self.of_kind.len() > SHOWN) {
            Some(summary) => vec![summary],
            None => self.of_kind.iter().map(|finding| finding.to_string()).collect(),
        };
        (sentences, self.finding.advice().to_owned())
    }
}

/// Findings by kind, the most important kind first.
pub(super) fn groups(all: &[Finding]) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for finding in all {
        let rank = rank(finding);
        match groups.iter_mut().find(|group| group.rank == rank) {
            Some(group) => group.of_kind.push(finding),
            None => groups.push(Group { rank, finding, of_kind: vec![finding] }),
        }
    }
    groups.sort_by_key(|group| group.rank);
    groups
}

/// Sentences of each kind of finding, the most important kind first, and its advice.
#[must_use]
pub fn grouped(all: &[Finding]) -> Vec<(Vec<String>, String)> {
    groups(all).iter().map(Group::said).collect()
}
