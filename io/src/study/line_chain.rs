//! Lines of JSON with checksums of themselves and of those before them.
//!
//! ```text
//! {"sha256":"d_k","entry":e_k}        d_k = SHA-256(d_{k−1} e_k),  d_0 empty
//! ```
//! in hexadecimal digits, over the bytes of the entry as they stand. A line that was altered, moved, left out or added does
//! not fit behind the one before it.

use armid::provenance::sha256;

const OPENING: &str = "{\"sha256\":\"";
const MIDDLE: &str = "\",\"entry\":";
const CLOSING: &str = "}\n";
/// Hexadecimal digits of a digest.
const DIGITS: usize = 64;

/// The digest of the last line of a chain; at first there is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LineChain(String);

/// Why a line is no next one of a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Broken {
    /// It is not written as such a line is.
    Form,
    /// It was altered, or does not stand where it was written.
    Checksum,
}

impl LineChain {
    /// The next line for an entry, which is JSON in one line.
    pub fn line(&mut self, entry: &str) -> String {
        self.0 = sha256(&format!("{}{entry}", self.0));
        format!("{OPENING}{}{MIDDLE}{entry}{CLOSING}", self.0)
    }

    /// The entry of the next line, newline and all.
    pub(super) fn entry<'a>(&mut self, line: &'a [u8]) -> Result<&'a str, Broken> {
        let (digest, entry) = parts_of(line)?;
        if sha256(&format!("{}{entry}", self.0)) != digest {
            return Err(Broken::Checksum);
        }
        digest.clone_into(&mut self.0);
        Ok(entry)
    }
}

/// The entry of a line, newline and all, whose checksum was looked at before.
pub(super) fn entry_of(line: &[u8]) -> Result<&str, Broken> {
    Ok(parts_of(line)?.1)
}

/// Digest and entry of a line.
fn parts_of(line: &[u8]) -> Result<(&str, &str), Broken> {
    let line = std::str::from_utf8(line).map_err(|_| Broken::Form)?;
    let rest = line.strip_prefix(OPENING).ok_or(Broken::Form)?;
    let (digest, rest) = rest.split_at_checked(DIGITS).ok_or(Broken::Form)?;
    let entry = rest.strip_prefix(MIDDLE).and_then(|rest| rest.strip_suffix(CLOSING)).ok_or(Broken::Form)?;
    Ok((digest, entry))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identity_entries_come_back_and_every_line_is_json() {
        let entries = ["{\"run\":1}", "[]", "\"ö \\\" } x\"", "{\"run\":1}"];
        let (mut write, mut read) = (LineChain::default(), LineChain::default());
        for entry in entries {
            let line = write.line(entry);
            let json: serde_json::Value = serde_json::from_str(&line).unwrap();
            assert_eq!(json["entry"], serde_json::from_str::<serde_json::Value>(entry).unwrap());
            assert_eq!(read.entry(line.as_bytes()), Ok(entry));
        }
        assert_eq!(read, write);
    }

    #[test]
    fn no_byte_of_a_line_can_change_and_no_line_can_move() {
        let mut chain = LineChain::default();
        let lines = ["{\"run\":1}", "{\"run\":2}", "{\"run\":3}"].map(|entry| chain.line(entry));
        let mut first = LineChain::default();
        first.entry(lines[0].as_bytes()).unwrap();
        for at in 0..lines[1].len() {
            for bit in 0..8 {
                let mut altered = lines[1].clone().into_bytes();
                altered[at] ^= 1 << bit;
                assert!(first.clone().entry(&altered).is_err(), "bit {bit} of byte {at}");
            }
        }
        for moved in [&lines[0], &lines[2]] {
            assert_eq!(first.clone().entry(moved.as_bytes()), Err(Broken::Checksum));
        }
        for cut in 0..lines[1].len() {
            assert!(first.clone().entry(&lines[1].as_bytes()[..cut]).is_err());
        }
    }
}
