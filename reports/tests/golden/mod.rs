//! Texts held against the files of `tests/small`.

use std::path::{Path, PathBuf};

use armid::provenance::sha256;
use armid_reports::Document;

/// Where the golden files are.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/small")
}

/// Holds a text against its golden file, or writes that where `WRITE` is set.
pub(crate) fn assert_golden(name: &str, found: &str) {
    let path = folder().join(name);
    if std::env::var_os("WRITE").is_some() {
        std::fs::write(&path, found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap_or_else(|_| panic!("{name} is missing: run with WRITE=1"));
    let place = found.lines().zip(expected.lines()).find(|(found, expected)| found != expected);
    assert!(found == expected, "{name} differs, found and expected: {place:?}; WRITE=1 writes it again");
}

/// The text of a page: cells and paragraphs between bars, and the SHA-256 of each figure.
pub(crate) fn text_of(document: &Document) -> String {
    let (mut page, mut text) = (document.html().unwrap(), String::new());
    for figure in document.figures() {
        page = page.replacen(&figure.svg, &format!("{}.svg {}", figure.name, sha256(&figure.svg)), 1);
    }
    let body = page.split_once("</style>").unwrap().1;
    let body = body.split_once("<script>").unwrap().0;
    for part in body.split('<') {
        let inner = part.split_once('>').map_or(part, |(_, inner)| inner);
        text.push_str(inner);
        if !inner.is_empty() && !inner.ends_with('\n') {
            text.push('|');
        }
    }
    text
}
