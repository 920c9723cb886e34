//! Which chain of a tree is the arm, where nobody says it.

use super::error::FormatError;
use super::tree::{Body, Connection, Tree};

/// Chains and links that a message names at most.
const LISTED: usize = 6;

/// Where an arm ends.
pub(super) struct Arm {
    pub(super) tip: usize,
    /// What the reader must know of the choice.
    pub(super) remark: Option<String>,
}

/// The arm that stands on `base`.
///
/// Chains are the moving joints from the base outwards, without a gripper's at the end: those that follow another joint
/// and those that lead one. Where there is one chain, it is the arm. Where they part after a common beginning and each goes
/// on with at most half as many joints as that has, the beginning is the arm and what follows is its gripper.
pub(super) fn arm_of(tree: &Tree<'_>, base: usize) -> Result<Arm, FormatError> {
    let is_leaf = |b: &usize| !tree.bodies.iter().any(|body| body.parent == Some(*b));
    let leaves = (0..tree.bodies.len()).filter(is_leaf).filter(|&b| tree.path(b).contains(&base));
    let all: Vec<(usize, Vec<usize>)> =
        leaves.map(|leaf| (leaf, without_gripper(tree, tree.moving(base, leaf)))).collect();
    let mut chains: Vec<&(usize, Vec<usize>)> = Vec::new();
    for one in &all {
        let goes_on = |other: &Vec<usize>| other.len() > one.1.len() && other.starts_with(&one.1);
        if !all.iter().any(|(_, other)| goes_on(other)) && !chains.iter().any(|(_, other)| *other == one.1) {
            chains.push(one);
        }
    }
    let Some((first_leaf, first)) = chains.first() else { return Ok(Arm { tip: base, remark: None }) };
    if chains.len() == 1 {
        return Ok(Arm { tip: first.last().copied().unwrap_or(*first_leaf), remark: None });
    }
    let common = (0..first.len()).take_while(|&k| chains.iter().all(|(_, chain)| chain.get(k) == first.get(k))).count();
    let longest = chains.iter().map(|(_, chain)| chain.len()).max().unwrap_or(0);
    if common > 0 && 2 * (longest - common) <= common {
        let tip = first[common - 1];
        let remark = format!(
            "the chain ends at \"{}\", where a gripper of {} branches begins; a tip link chooses another",
            tree.bodies[tip].name,
            chains.len()
        );
        return Ok(Arm { tip, remark: Some(remark) });
    }
    chains.sort_by_key(|(_, chain)| std::cmp::Reverse(chain.len()));
    let choices = listed(&chains, |(leaf, chain)| {
        let plural = if chain.len() == 1 { "" } else { "s" };
        format!("\"{}\" ({} joint{plural})", tree.bodies[*leaf].name, chain.len())
    });
    let message = format!("the robot is a tree, expected a tip link to choose the chain, one of {choices}");
    tree.check.fault(tree.at.clone(), message)
}

/// A chain up to the last joint that neither follows another nor leads one; all of it where there is none.
fn without_gripper(tree: &Tree<'_>, chain: Vec<usize>) -> Vec<usize> {
    let follows = |joint: &str| {
        let led = |body: &Body| matches!(&body.connection, Connection::Follows { leader, .. } if leader == joint);
        tree.bodies.iter().any(led)
    };
    let of_gripper = |&b: &usize| match &tree.bodies[b].connection {
        Connection::Follows { .. } => true,
        Connection::Moving(joint) => follows(&joint.name),
        Connection::Fixed | Connection::Unsupported(..) => false,
    };
    let last = chain.iter().rposition(|b| !of_gripper(b));
    last.map_or(&chain[..], |last| &chain[..=last]).to_vec()
}

/// The first few of many, and how many more there are.
pub(super) fn listed<T>(all: &[T], word: impl Fn(&T) -> String) -> String {
    let mut text = all.iter().take(LISTED).map(word).collect::<Vec<_>>().join(", ");
    if all.len() > LISTED {
        text.push_str(&format!(" and {} more", all.len() - LISTED));
    }
    text
}

/// A name in quotes.
pub(super) fn quoted_one(name: &&str) -> String {
    format!("\"{name}\"")
}
