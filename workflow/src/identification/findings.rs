//! Findings of an estimate, grouped, the most important first, at most a screen of them.

use armid::estimation::Finding;
use armid::number::significant;

/// Findings of one kind.
pub(super) struct Group<'a> {
    rank: usize,
    finding: &'a Finding,
    of_kind: Vec<&'a Finding>,
}

/// Sentences of one kind that are shown one by one.
const SHOWN: usize = 3;

/// The last kind that belongs on the first screen.
const LAST_THAT_MATTERS: usize = 5;

/// How important a kind is; the least comes first.
const fn rank(finding: &Finding) -> usize {
    match finding {
        Finding::Unfinished { .. } => 0,
        Finding::NoNoise => 1,
        Finding::ResidualAboveNoise { .. } => 2,
        Finding::LackOfFit { .. } => 3,
        Finding::EffectShown { .. } => 4,
        Finding::Impossible { .. } | Finding::NegativeDrive { .. } => LAST_THAT_MATTERS,
        Finding::InconsistentLink { .. } => 6,
        Finding::LargeCondition { .. } => 7,
        Finding::PoorlyDetermined { .. } => 8,
        Finding::ResidualCorrelated { .. } => 9,
        Finding::FewPeriods { .. } => 10,
        Finding::NoiseFromResidual => 11,
        Finding::Outliers { .. } => 12,
        Finding::HeldBack { .. } => 13,
        Finding::NearlyDependent { .. } => 14,
        Finding::BeyondShape { .. } => 15,
        Finding::LeftOut { .. } => 16,
        Finding::MotionTakenAsExact => 17,
        Finding::DurbinWuHausman { .. } => 18,
        Finding::HiddenFromPositions { .. } => 19,
        Finding::MultipleShooting { .. } => 20,
    }
}

/// What many findings of a kind have in common, and what each is about.
fn summary(found: &[&Finding]) -> Option<String> {
    let count = found.len();
    let list = || found.iter().filter_map(|finding| subject(finding)).collect::<Vec<_>>().join(", ");
    Some(match found.first()? {
        Finding::PoorlyDetermined { .. } => {
            format!("{count} parameters have a standard deviation of more than a third of their value: {}", list())
        }
        Finding::NegativeDrive { .. } => format!("{count} drive parameters are negative: {}", list()),
        Finding::InconsistentLink { .. } => {
            format!("the completed parameters of links {} are physically inconsistent", list())
        }
        Finding::ResidualAboveNoise { .. } => format!("the residual is above what noise explains at joints {}", list()),
        Finding::LackOfFit { .. } => format!("torque that neither model nor noise explains, at joints {}", list()),
        Finding::ResidualCorrelated { .. } => format!("neighbouring residuals correlate at joints {}", list()),
        Finding::Outliers { .. } => format!("equations are beyond 5 robust standard deviations at joints {}", list()),
        Finding::LeftOut { .. } => format!("{count} parameters are left out: {}", list()),
        Finding::BeyondShape { .. } => format!("the nominal bodies of links {} reach beyond their shapes", list()),
        _ => return None,
    })
}

/// The parameter, link or joint that a finding is about, with its number; `None` of a kind that stands alone.
fn subject(finding: &Finding) -> Option<String> {
    Some(match finding {
        Finding::PoorlyDetermined { parameter, .. }
        | Finding::NegativeDrive { parameter, .. }
        | Finding::LeftOut { parameter, .. } => parameter.clone(),
        Finding::InconsistentLink { link, .. } | Finding::BeyondShape { link } => link.to_string(),
        Finding::ResidualAboveNoise { joint, ratio, .. } => format!("{joint} ({ratio:.1} times)"),
        Finding::ResidualCorrelated { joint, correlation, .. } => format!("{joint} ({correlation:.2})"),
        Finding::Outliers { joint, outliers, equations, .. } => format!("{joint} ({outliers} of {equations})"),
        Finding::LackOfFit { joint, beyond_noise_rms, torque_rms, unit, most, .. } => {
            let at = most.as_ref().map_or_else(String::new, |most| {
                let (variable, [from, to], of) = (most.against.name(), most.range, &most.range_unit);
                format!(", most at a {variable} of {from:.2} to {to:.2} {of}")
            });
            let share = 100.0 * beyond_noise_rms / torque_rms;
            let rms = significant(*beyond_noise_rms, 2);
            format!("{joint} ({rms} {unit}, {share:.2} % of its torque{at})")
        }
        _ => return None,
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
pub fn grouped(all: &[Finding]) -> Vec<(Vec<String>, String)> {
    groups(all).iter().map(Group::said).collect()
}
