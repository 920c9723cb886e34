//! Which file of a module or of a crate names which other, and where they name each other in a circle.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{NamedPath, Source};

/// The files of one module by their paths inside it without `.rs`, `"criterion/kind"`; a `mod.rs` is its folder, `""` at
/// the top. The module without a name is the whole crate.
pub(crate) struct FileGraph<'a> {
    module: &'a str,
    files: BTreeMap<String, &'a Source>,
    /// Names that a folder's `mod.rs` hands on, with the file or folder that holds each.
    exports: BTreeMap<(String, String), String>,
    folders: BTreeSet<String>,
}

impl<'a> FileGraph<'a> {
    /// The graph of `module`, whose files are given by their paths inside it.
    pub(crate) fn new(module: &'a str, sources: impl IntoIterator<Item = (String, &'a Source)>) -> Self {
        let mut graph =
            Self { module, files: BTreeMap::new(), exports: BTreeMap::new(), folders: BTreeSet::from([String::new()]) };
        for (path, source) in sources {
            match path.strip_suffix("mod").map(|folder| folder.trim_end_matches('/')) {
                Some(folder) if path == "mod" || path.ends_with("/mod") => {
                    graph.folders.insert(folder.to_owned());
                    for (path, name) in &source.exports {
                        if let [child, ..] = path.as_slice() {
                            graph.exports.insert((folder.to_owned(), name.clone()), child_of(folder, child));
                        }
                    }
                }
                _ => {
                    graph.files.insert(path, source);
                }
            }
        }
        graph
    }

    /// Names that files take from a `mod.rs` above them, where another file holds them: file, line, and that other file.
    pub(crate) fn taken_from_above(&self) -> Vec<(String, usize, String)> {
        let mut found = Vec::new();
        for (file, source) in &self.files {
            for path in source.paths.iter().filter(|path| path.inline == 0) {
                let Some((folder, rest)) = self.start(file, path) else { continue };
                if let [name] = rest
                    && (folder.is_empty() || file.starts_with(&format!("{folder}/")))
                    && let Some(holder) = self.exports.get(&(folder, name.clone()))
                    && holder != file
                    && !file.starts_with(&format!("{holder}/"))
                {
                    found.push((file.clone(), path.line, holder.clone()));
                }
            }
        }
        found
    }

    /// The folder in which a path named in `file` begins, and what follows; `None` where that is outside of this module.
    fn start<'p>(&self, file: &str, path: &'p NamedPath) -> Option<(String, &'p [String])> {
        let parent = |folder: &str| folder.rsplit_once('/').map_or(String::new(), |(parent, _)| parent.to_owned());
        let supers = path.segments.iter().take_while(|segment| *segment == "super").count();
        match path.segments.as_slice() {
            [root, rest @ ..] if root == "crate" && self.module.is_empty() => Some((String::new(), rest)),
            [root, module, rest @ ..] if root == "crate" && module == self.module => Some((String::new(), rest)),
            _ if supers > path.inline => {
                // The first `super` leaves the file for its folder, each further one that folder.
                let climbed = (path.inline + 1..supers).fold(parent(file), |folder, _| parent(&folder));
                Some((climbed, &path.segments[supers..]))
            }
            _ => None,
        }
    }

    /// The file that a path named in `file` leads to, if it is another one of this module.
    fn target(&self, file: &str, path: &NamedPath) -> Option<String> {
        let (mut at, rest) = self.start(file, path)?;
        for segment in rest {
            let child = child_of(&at, segment);
            at = if self.files.contains_key(&child) || self.folders.contains(&child) {
                child
            } else {
                let mut holder = at.clone();
                while let Some(next) = self.exports.get(&(holder.clone(), segment.clone())) {
                    holder = next.clone();
                }
                holder
            };
            if self.files.contains_key(&at) {
                return (at != file).then_some(at);
            }
        }
        None
    }

    /// Every set of files that name each other in a circle.
    pub(crate) fn circles(&self) -> Vec<BTreeSet<String>> {
        let edges: BTreeMap<&str, BTreeSet<String>> = self
            .files
            .iter()
            .map(|(file, source)| {
                let targets = source.paths.iter().filter_map(|path| self.target(file, path)).collect();
                (file.as_str(), targets)
            })
            .collect();
        let reached: BTreeMap<&str, BTreeSet<&str>> = edges.keys().map(|&file| (file, reach(file, &edges))).collect();
        let mut circles = BTreeSet::new();
        for (file, others) in &reached {
            let circle: BTreeSet<String> =
                others.iter().filter(|other| reached[*other].contains(file)).map(|&other| other.to_owned()).collect();
            if !circle.is_empty() {
                circles.insert(circle);
            }
        }
        circles.into_iter().collect()
    }
}

fn child_of(folder: &str, child: &str) -> String {
    if folder.is_empty() { child.to_owned() } else { format!("{folder}/{child}") }
}

/// Every file that one leads to.
fn reach<'a>(from: &'a str, edges: &'a BTreeMap<&str, BTreeSet<String>>) -> BTreeSet<&'a str> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        for next in &edges[file] {
            if reached.insert(next.as_str()) {
                open.push(next);
            }
        }
    }
    reached
}
