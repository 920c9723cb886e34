//! Is the file of a library complete? The system's loader maps a truncated file and the program is then killed.
//!
//! ELF (64 bits, little endian): the section headers and every segment must lie inside the file. Mach-O (64 bits, thin
//! or fat): every segment must. Nothing else is looked at; the loader judges the rest.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// What a file's own table of contents says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contents {
    /// The file must be at least `expected` bytes long.
    Library { found: u64, expected: u64 },
    /// It begins like no library.
    Other,
}

/// Tables of contents lie within this many bytes of the beginning.
const HEAD: u64 = 1 << 16;

/// Reads the head of a file.
pub(super) fn contents(path: &Path) -> io::Result<Contents> {
    let file = File::open(path)?;
    let found = file.metadata()?.len();
    let mut head = Vec::new();
    file.take(HEAD).read_to_end(&mut head)?;
    Ok(expected_length(&head).map_or(Contents::Other, |expected| Contents::Library { found, expected }))
}

/// The least length of the file that begins with `head`; `None` if it is no library.
fn expected_length(head: &[u8]) -> Option<u64> {
    match head.get(..4)? {
        [0x7f, b'E', b'L', b'F'] => Some(elf(head).unwrap_or(64)),
        [0xcf, 0xfa, 0xed, 0xfe] => Some(mach(head).unwrap_or(32)),
        [0xca, 0xfe, 0xba, 0xbe] => Some(fat(head).unwrap_or(8)),
        _ => None,
    }
}

/// `N` bytes from `at`.
fn bytes<const N: usize>(head: &[u8], at: u64) -> Option<[u8; N]> {
    let at = usize::try_from(at).ok()?;
    head.get(at..at.checked_add(N)?)?.try_into().ok()
}

fn u16_at(head: &[u8], at: u64) -> Option<u64> {
    bytes(head, at).map(|b| u64::from(u16::from_le_bytes(b)))
}

fn u32_at(head: &[u8], at: u64) -> Option<u64> {
    bytes(head, at).map(|b| u64::from(u32::from_le_bytes(b)))
}

fn u64_at(head: &[u8], at: u64) -> Option<u64> {
    bytes(head, at).map(u64::from_le_bytes)
}

fn elf(head: &[u8]) -> Option<u64> {
    let (segments, sections) = (u64_at(head, 0x20)?, u64_at(head, 0x28)?);
    let (segment, count) = (u16_at(head, 0x36)?, u16_at(head, 0x38)?);
    let mut end = sections.saturating_add(u16_at(head, 0x3a)? * u16_at(head, 0x3c)?);
    for index in 0..count {
        let header = segments.saturating_add(index * segment);
        end = end.max(match (u64_at(head, header.saturating_add(8)), u64_at(head, header.saturating_add(0x20))) {
            (Some(offset), Some(length)) => offset.saturating_add(length),
            _ => header.saturating_add(segment),
        });
    }
    Some(end)
}

fn mach(head: &[u8]) -> Option<u64> {
    const SEGMENT: u64 = 0x19;
    let mut end = 32 + u32_at(head, 20)?;
    let mut at = 32;
    for _ in 0..u32_at(head, 16)? {
        let (Some(command), Some(length)) = (u32_at(head, at), u32_at(head, at + 4)) else { break };
        if command == SEGMENT
            && let (Some(offset), Some(size)) = (u64_at(head, at + 40), u64_at(head, at + 48))
        {
            end = end.max(offset.saturating_add(size));
        }
        // A length of zero would stand still.
        at += length.max(8);
    }
    Some(end)
}

fn fat(head: &[u8]) -> Option<u64> {
    let big = |at| bytes(head, at).map(|b| u64::from(u32::from_be_bytes(b)));
    let mut end = 8;
    for index in 0..big(4)? {
        let at = 8 + 20 * index;
        let (Some(offset), Some(size)) = (big(at + 8), big(at + 12)) else { break };
        end = end.max(offset + size);
    }
    Some(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_program_is_whole_and_its_head_alone_is_not() {
        let program = std::env::current_exe().unwrap();
        let Contents::Library { found, expected } = contents(&program).unwrap() else { panic!("a program") };
        assert!(expected <= found && expected > found / 2, "{found} bytes, {expected} expected");
        let folder = tempfile::tempdir().unwrap();
        let cut = folder.path().join("cut");
        for length in [64, 1000, 100_000] {
            let mut head = Vec::new();
            File::open(&program).unwrap().take(length).read_to_end(&mut head).unwrap();
            std::fs::write(&cut, &head).unwrap();
            let Contents::Library { found, expected } = contents(&cut).unwrap() else { panic!("a program") };
            assert!(found == length && expected > found, "{found} bytes, {expected} expected");
        }
    }

    #[test]
    fn analytic_heads_of_other_formats() {
        // One Mach-O segment of 0x100 bytes at 0x4000, behind a header and a command of 72 bytes.
        let mut mach = vec![0; 32 + 72];
        mach[..4].copy_from_slice(&[0xcf, 0xfa, 0xed, 0xfe]);
        (mach[16], mach[20], mach[32], mach[36]) = (1, 72, 0x19, 72);
        (mach[32 + 41], mach[32 + 49]) = (0x40, 0x01);
        assert_eq!(expected_length(&mach), Some(0x4100));
        // One part of a fat file, of 0x20 bytes at 0x1000.
        let mut fat = vec![0; 28];
        fat[..4].copy_from_slice(&[0xca, 0xfe, 0xba, 0xbe]);
        (fat[7], fat[8 + 10], fat[8 + 15]) = (1, 0x10, 0x20);
        assert_eq!(expected_length(&fat), Some(0x1020));
        assert_eq!(expected_length(b"#!/bin/sh"), None);
        assert_eq!(expected_length(b""), None);
        assert_eq!(expected_length(&[0x7f, b'E', b'L', b'F']), Some(64));
    }
}
