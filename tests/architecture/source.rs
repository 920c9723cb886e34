//! Rust source as a list of words with line numbers: comments, texts and everything compiled only for tests left out.

/// A word, a number or a single punctuation mark, and the line it stands on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Word {
    pub(crate) text: String,
    pub(crate) line: usize,
}

/// What a file says to the compiler of the library itself.
pub(crate) struct Source {
    /// Its words, those under `#[cfg(test)]` left out.
    pub(crate) words: Vec<Word>,
    /// Modules in files of their own that exist only in tests: `#[cfg(test)] mod name;`.
    pub(crate) test_modules: Vec<String>,
}

impl Source {
    pub(crate) fn read(text: &str) -> Self {
        let mut source = Self { words: Vec::new(), test_modules: Vec::new() };
        let all = words(text);
        let mut at = 0;
        while at < all.len() {
            match attribute_end(&all, at) {
                Some(end) if is_test_only(&all[at..end]) => {
                    let item_end = item_end(&all, end);
                    let item = &all[end..item_end];
                    if item.last().is_some_and(|word| word.text == ";")
                        && let Some(module) = item.iter().position(|word| word.text == "mod")
                    {
                        source.test_modules.push(item[module + 1].text.clone());
                    }
                    at = item_end;
                }
                Some(end) => {
                    source.words.extend_from_slice(&all[at..end]);
                    at = end;
                }
                None => {
                    source.words.push(all[at].clone());
                    at += 1;
                }
            }
        }
        source
    }

    /// Does this sequence of words stand somewhere, and on which lines?
    pub(crate) fn lines_of(&self, sequence: &[&str]) -> Vec<usize> {
        self.words
            .windows(sequence.len())
            .filter(|window| window.iter().zip(sequence).all(|(word, wanted)| word.text == *wanted))
            .map(|window| window[0].line)
            .collect()
    }

    /// The first names below a root, as in `root::name` and `root::{name, other::deeper}`, with their lines.
    pub(crate) fn names_below(&self, root: &str) -> Vec<Word> {
        let mut names = Vec::new();
        for at in 0..self.words.len() {
            let is_root = self.words[at].text == root && (at == 0 || self.words[at - 1].text != ":" || root == "crate");
            if is_root && self.text(at + 1) == ":" && self.text(at + 2) == ":" {
                names.extend(self.group(at + 3));
            }
        }
        names
    }

    /// Paths of `super`s that are long enough to reach the root of the crate from a file `depth` modules below it.
    pub(crate) fn climbs_to_root(&self, depth: usize) -> Vec<usize> {
        let (mut lines, mut inline, mut braces) = (Vec::new(), Vec::new(), 0_usize);
        for at in 0..self.words.len() {
            match self.text(at) {
                "{" => {
                    if at >= 2 && self.text(at - 2) == "mod" {
                        inline.push(braces);
                    }
                    braces += 1;
                }
                "}" => {
                    braces = braces.saturating_sub(1);
                    if inline.last() == Some(&braces) {
                        inline.pop();
                    }
                }
                "super" if at < 3 || self.text(at - 3) != "super" => {
                    let climb = (0..).take_while(|k| self.text(at + 3 * k) == "super").count();
                    if climb >= depth + inline.len() {
                        lines.push(self.words[at].line);
                    }
                }
                _ => {}
            }
        }
        lines
    }

    fn text(&self, at: usize) -> &str {
        self.words.get(at).map_or("", |word| &word.text)
    }

    fn group(&self, at: usize) -> Vec<Word> {
        if self.text(at) != "{" {
            return self.words.get(at).cloned().into_iter().collect();
        }
        let (mut names, mut depth, mut fresh) = (Vec::new(), 0, false);
        for word in &self.words[at..] {
            match word.text.as_str() {
                "{" => {
                    depth += 1;
                    fresh = depth == 1;
                }
                "}" => {
                    depth -= 1;
                    if depth == 0 {
                        break;
                    }
                }
                "," => fresh = depth == 1,
                _ if fresh => {
                    names.push(word.clone());
                    fresh = false;
                }
                _ => {}
            }
        }
        names
    }
}

/// The end of the attribute `#[…]` or `#![…]` that begins here.
fn attribute_end(words: &[Word], at: usize) -> Option<usize> {
    let text = |k: usize| words.get(k).map_or("", |word| word.text.as_str());
    if text(at) != "#" {
        return None;
    }
    let open = if text(at + 1) == "!" { at + 2 } else { at + 1 };
    (text(open) == "[").then(|| closing(words, open) + 1)
}

/// `#[cfg(test)]`, `#[cfg(all(test, …))]`, `#[test]`: what follows is not in the library.
fn is_test_only(attribute: &[Word]) -> bool {
    let inner: Vec<&str> = attribute.iter().map(|word| word.text.as_str()).collect();
    matches!(
        inner.as_slice(),
        ["#", "[", "test", "]"]
            | ["#", "[", "cfg", "(", "test", ")", "]"]
            | ["#", "[", "cfg", "(", "all", "(", "test", ..]
    )
}

/// One past the item that begins here, its further attributes included.
fn item_end(words: &[Word], mut at: usize) -> usize {
    while let Some(end) = attribute_end(words, at) {
        at = end;
    }
    let is_use = words[at..].iter().take(5).any(|word| word.text == "use");
    while at < words.len() {
        match words[at].text.as_str() {
            ";" => return at + 1,
            "{" if !is_use => return closing(words, at) + 1,
            "{" | "(" | "[" => at = closing(words, at) + 1,
            _ => at += 1,
        }
    }
    at
}

/// The bracket that closes the one at `open`.
fn closing(words: &[Word], open: usize) -> usize {
    let mut depth = 0;
    for (k, word) in words.iter().enumerate().skip(open) {
        match word.text.as_str() {
            "{" | "(" | "[" => depth += 1,
            "}" | ")" | "]" => {
                depth -= 1;
                if depth == 0 {
                    return k;
                }
            }
            _ => {}
        }
    }
    words.len() - 1
}

fn words(text: &str) -> Vec<Word> {
    let bytes: Vec<char> = text.chars().collect();
    let (mut words, mut at, mut line) = (Vec::new(), 0, 1);
    let starts = |at: usize, what: &str| what.chars().enumerate().all(|(k, c)| bytes.get(at + k) == Some(&c));
    while at < bytes.len() {
        let begin = at;
        let c = bytes[at];
        if starts(at, "//") {
            while at < bytes.len() && bytes[at] != '\n' {
                at += 1;
            }
        } else if starts(at, "/*") {
            let mut depth = 0;
            loop {
                if starts(at, "/*") {
                    depth += 1;
                    at += 2;
                } else if starts(at, "*/") {
                    depth -= 1;
                    at += 2;
                } else {
                    at += 1;
                }
                if depth == 0 || at >= bytes.len() {
                    break;
                }
            }
        } else if let Some(end) = raw_text_end(&bytes, at) {
            at = end;
        } else if c == '"' || starts(at, "b\"") || starts(at, "c\"") {
            at += if c == '"' { 1 } else { 2 };
            while at < bytes.len() && bytes[at] != '"' {
                at += if bytes[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
        } else if c == '\'' {
            // 'x' and '\n' are characters; 'a without a closing quote is a lifetime.
            if bytes.get(at + 1) == Some(&'\\') {
                at += 3;
                while at < bytes.len() && bytes[at] != '\'' {
                    at += 1;
                }
                at += 1;
            } else if bytes.get(at + 2) == Some(&'\'') {
                at += 3;
            } else {
                at += 1;
                while at < bytes.len() && (bytes[at].is_alphanumeric() || bytes[at] == '_') {
                    at += 1;
                }
            }
        } else if c.is_alphanumeric() || c == '_' {
            while at < bytes.len() && (bytes[at].is_alphanumeric() || bytes[at] == '_') {
                at += 1;
            }
            words.push(Word { text: bytes[begin..at].iter().collect(), line });
        } else {
            at += 1;
            if !c.is_whitespace() {
                words.push(Word { text: c.to_string(), line });
            }
        }
        line += bytes[begin..at.min(bytes.len())].iter().filter(|&&c| c == '\n').count();
    }
    words
}

/// One past `r"…"`, `r#"…"#`, `br#"…"#`, if one begins here.
fn raw_text_end(bytes: &[char], at: usize) -> Option<usize> {
    if at > 0 && (bytes[at - 1].is_alphanumeric() || bytes[at - 1] == '_') {
        return None;
    }
    let mut k = at + usize::from(bytes[at] == 'b' || bytes[at] == 'c');
    if bytes.get(k) != Some(&'r') {
        return None;
    }
    k += 1;
    let hashes = bytes[k..].iter().take_while(|&&c| c == '#').count();
    k += hashes;
    if bytes.get(k) != Some(&'"') {
        return None;
    }
    k += 1;
    while k < bytes.len() {
        if bytes[k] == '"' && bytes[k + 1..].iter().take(hashes).filter(|&&c| c == '#').count() == hashes {
            return Some(k + 1 + hashes);
        }
        k += 1;
    }
    Some(k)
}
