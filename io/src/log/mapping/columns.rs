//! The columns that a pattern names.

use std::ops::RangeInclusive;

/// Joints at most: a slip in a range is not to name a million columns.
const MOST_JOINTS: u32 = 64;

/// The names that a pattern stands for: `a_[1-3]_b` is `a_1_b`, `a_2_b`, `a_3_b`; downwards too. Without brackets the name
/// itself. A range whose ends have zeros in front has numbers of as many digits: `[01-12]`. Brackets that hold no range are part
/// of the name: `pos [deg]`.
///
/// # Errors
/// A sentence where a range holds too many numbers.
pub(crate) fn expand(pattern: &str) -> Result<Vec<String>, String> {
    for (open, _) in pattern.match_indices('[') {
        let Some(length) = pattern[open..].find(']') else { break };
        let inner = &pattern[open + 1..open + length];
        let Some((first, last, digits)) = range(inner) else { continue };
        let (front, back) = (&pattern[..open], &pattern[open + length + 1..]);
        let numbers: Vec<u32> = if first <= last {
            RangeInclusive::new(first, last).take(MOST_JOINTS as usize + 1).collect()
        } else {
            RangeInclusive::new(last, first).rev().take(MOST_JOINTS as usize + 1).collect()
        };
        if numbers.len() > MOST_JOINTS as usize {
            return Err(format!("[{inner}] names more than {MOST_JOINTS} columns, expected one for each joint"));
        }
        return Ok(numbers.iter().map(|number| format!("{front}{number:0digits$}{back}")).collect());
    }
    Ok(vec![pattern.to_owned()])
}

/// `1-6` as its ends, and the digits of each number where one has zeros in front.
fn range(text: &str) -> Option<(u32, u32, usize)> {
    let (first, last) = text.split_once('-')?;
    let ends = [first.trim(), last.trim()];
    let padded = ends.iter().filter(|end| end.len() > 1 && end.starts_with('0')).map(|end| end.len());
    Some((ends[0].parse().ok()?, ends[1].parse().ok()?, padded.max().unwrap_or(0)))
}

/// The names that a text stands for, of those that `has` knows: those of a pattern, or of several patterns with `/` between
/// them: `#1/#3/#2`, `base/shoulder/elbow`. Names may hold a `/` themselves: what is a name as a whole is that name, and in a
/// list the longest part that is one. Where nothing is known, the names of the text as one pattern.
///
/// # Errors
/// As [`expand`].
pub(crate) fn listed(text: &str, has: impl Fn(&str) -> bool) -> Result<Vec<String>, String> {
    let whole = expand(text)?;
    if has(text) {
        return Ok(vec![text.to_owned()]);
    }
    let parts: Vec<&str> = text.split('/').collect();
    if parts.len() == 1 || whole.iter().any(|name| has(name)) {
        return Ok(whole);
    }
    let (mut names, mut at, mut known) = (Vec::new(), 0, false);
    while at < parts.len() {
        let (mut end, mut next) = (at + 1, None);
        for last in (at + 1..=parts.len()).rev() {
            let found = expand(&parts[at..last].join("/"))?;
            if found.iter().any(|name| has(name)) {
                (end, next) = (last, Some(found));
                break;
            }
        }
        known |= next.is_some();
        names.extend(match next {
            Some(found) => found,
            None => expand(parts[at])?,
        });
        at = end;
    }
    Ok(if known { names } else { whole })
}

#[cfg(test)]
mod tests {
    use super::{expand, listed};

    #[test]
    fn ranges_become_names() {
        assert_eq!(expand("j_[1-3]_pos").unwrap(), ["j_1_pos", "j_2_pos", "j_3_pos"]);
        assert_eq!(expand("#[3-2]").unwrap(), ["#3", "#2"]);
        assert_eq!(expand("time").unwrap(), ["time"]);
        assert_eq!(expand("pos [deg]").unwrap(), ["pos [deg]"]);
        assert_eq!(expand("pos [deg] [0-1]").unwrap(), ["pos [deg] 0", "pos [deg] 1"]);
        assert!(expand("q[1-4000000000]").unwrap_err().contains("more than 64"));
        assert_eq!(expand("j[08-10]").unwrap(), ["j08", "j09", "j10"]);
        assert_eq!(expand("j[02-01]").unwrap(), ["j02", "j01"]);
        assert_eq!(expand("j[0-1]").unwrap(), ["j0", "j1"]);
    }

    #[test]
    fn lists_become_names_and_names_may_hold_the_sign_between_them() {
        let of = |known: &[&str], text: &str| listed(text, |name| known.contains(&name)).unwrap();
        assert_eq!(of(&["#1", "#2", "#3"], "#1/#3/#2"), ["#1", "#3", "#2"]);
        assert_eq!(of(&["base", "elbow"], "elbow/base"), ["elbow", "base"]);
        assert_eq!(of(&["a1", "a2", "b"], "b/a[2-1]"), ["b", "a2", "a1"]);
        // Headings as plotting tools write them.
        let topics = ["/js/j1/q", "/js/j2/q", "/js/j3/q", "rad/s", "rad", "s"];
        assert_eq!(of(&topics, "/js/j[1-3]/q"), ["/js/j1/q", "/js/j2/q", "/js/j3/q"]);
        assert_eq!(of(&topics, "/js/j3/q//js/j1/q"), ["/js/j3/q", "/js/j1/q"]);
        assert_eq!(of(&topics, "rad/s"), ["rad/s"]);
        assert_eq!(of(&topics, "rad/s/s"), ["rad/s", "s"]);
        // What is missing is said by its own name.
        assert_eq!(of(&["base", "elbow"], "base/elbov"), ["base", "elbov"]);
        assert_eq!(of(&["base"], "/js/j[1-2]/p"), ["/js/j1/p", "/js/j2/p"]);
    }
}
