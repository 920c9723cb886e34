//! The columns that a pattern names.

use std::ops::RangeInclusive;

/// Joints at most: a slip in a range is not to name a million columns.
const MOST_JOINTS: u32 = 64;

/// The names that a pattern stands for: `a_[1-3]_b` is `a_1_b`, `a_2_b`, `a_3_b`; downwards too. Without brackets the name
/// itself. Brackets that hold no range are part of the name: `pos [deg]`.
///
/// # Errors
/// A sentence where a range holds too many numbers.
pub(crate) fn expand(pattern: &str) -> Result<Vec<String>, String> {
    for (open, _) in pattern.match_indices('[') {
        let Some(length) = pattern[open..].find(']') else { break };
        let inner = &pattern[open + 1..open + length];
        let Some((first, last)) = range(inner) else { continue };
        let (front, back) = (&pattern[..open], &pattern[open + length + 1..]);
        let numbers: Vec<u32> = if first <= last {
            RangeInclusive::new(first, last).take(MOST_JOINTS as usize + 1).collect()
        } else {
            RangeInclusive::new(last, first).rev().take(MOST_JOINTS as usize + 1).collect()
        };
        if numbers.len() > MOST_JOINTS as usize {
            return Err(format!("[{inner}] names more than {MOST_JOINTS} columns, expected one for each joint"));
        }
        return Ok(numbers.iter().map(|number| format!("{front}{number}{back}")).collect());
    }
    Ok(vec![pattern.to_owned()])
}

/// `1-6` as its ends.
fn range(text: &str) -> Option<(u32, u32)> {
    let (first, last) = text.split_once('-')?;
    Some((first.trim().parse().ok()?, last.trim().parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::expand;

    #[test]
    fn ranges_become_names() {
        assert_eq!(expand("j_[1-3]_pos").unwrap(), ["j_1_pos", "j_2_pos", "j_3_pos"]);
        assert_eq!(expand("#[3-2]").unwrap(), ["#3", "#2"]);
        assert_eq!(expand("time").unwrap(), ["time"]);
        assert_eq!(expand("pos [deg]").unwrap(), ["pos [deg]"]);
        assert_eq!(expand("pos [deg] [0-1]").unwrap(), ["pos [deg] 0", "pos [deg] 1"]);
        assert!(expand("q[1-4000000000]").unwrap_err().contains("more than 64"));
    }
}
