//! Whether this program keeps time on a machine that does other work.

use super::Console;

/// Linux's numbers of the policies first-in-first-out and round-robin: a process that has one of them does not wait for ordinary ones.
const REAL_TIME: [u32; 2] = [1, 2];

/// Warns where this program has no real-time priority: a machine that stands still for a moment looks
/// like a robot that does.
pub(crate) fn advise(console: &Console) {
    let policy = std::fs::read_to_string("/proc/self/stat").ok().and_then(|stat| policy(&stat));
    if policy.is_some_and(|policy| !REAL_TIME.contains(&policy)) {
        console.note("no real-time priority: where the machine does other work, `chrt --fifo 10 armid …` keeps time");
    }
}

/// The scheduling policy in Linux's words about a process: field 41; the second is its name, which may hold anything.
fn policy(stat: &str) -> Option<u32> {
    let (_, after_name) = stat.rsplit_once(')')?;
    after_name.split_whitespace().nth(41 - 3)?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_policy_is_the_field_after_any_name() {
        let fields: Vec<String> =
            (3..=52).map(|field| if field == 41 { "1".into() } else { field.to_string() }).collect();
        assert_eq!(policy(&format!("77 (a ) b (c) {}", fields.join(" "))), Some(1));
        assert_eq!(policy("77 (armid) S 1 2 3"), None);
        #[cfg(target_os = "linux")]
        assert!(policy(&std::fs::read_to_string("/proc/self/stat").unwrap()).is_some_and(|policy| policy < 8));
    }
}
