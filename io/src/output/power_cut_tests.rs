//! Files are whole or absent, whichever operation fails, and at whichever the power is cut.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::file_system::FileSystem;
use super::whole_file::write_on;

const PLACE: &str = "/out/new/E.json";
const OLD: &[u8] = b"what was there before";
const NEW: [&[u8]; 3] = [b"the first part, ", b"the second, ", b"the last"];

/// What happens at one of the operations.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    /// It fails, and those after it do not.
    Fails,
    /// The power is cut: neither it nor any after it happens.
    PowerCut,
}

/// A change of the names in a folder that is not on the disk for sure.
#[derive(Clone, Debug)]
enum Change {
    Add(PathBuf, usize),
    Rename(PathBuf, PathBuf),
    Remove(PathBuf),
}

#[derive(Clone, Default)]
struct State {
    /// Contents by their number: as programs see it, and as it is on the disk for sure.
    contents: Vec<(Vec<u8>, Option<Vec<u8>>)>,
    names: BTreeMap<PathBuf, usize>,
    folders: BTreeSet<PathBuf>,
    /// Names that are on the disk for sure.
    kept: BTreeMap<PathBuf, usize>,
    pending: Vec<Change>,
    done: Vec<&'static str>,
    fault: Option<(usize, Fault)>,
    dark: bool,
}

impl State {
    /// Counts an operation; whether it happens.
    fn step(&mut self, what: &'static str) -> io::Result<()> {
        let fault = self.fault.filter(|(at, _)| *at == self.done.len()).map(|(_, fault)| fault);
        self.dark |= fault == Some(Fault::PowerCut);
        self.done.push(what);
        if fault.is_some() || self.dark { Err(io::Error::other("injected")) } else { Ok(()) }
    }

    fn change(&mut self, change: Change) {
        apply(&mut self.names, &change);
        self.pending.push(change);
    }

    /// Everything that may be found at the place when the power comes back.
    fn after_a_power_cut(&self) -> BTreeSet<Option<Vec<u8>>> {
        let mut found = BTreeSet::new();
        for chosen in 0..1_u32 << self.pending.len() {
            let mut names = self.kept.clone();
            for (i, change) in self.pending.iter().enumerate() {
                if chosen & (1 << i) != 0 {
                    apply(&mut names, change);
                }
            }
            let Some(&content) = names.get(Path::new(PLACE)) else {
                found.insert(None);
                continue;
            };
            let (seen, kept) = &self.contents[content];
            match kept {
                Some(kept) if kept == seen => {
                    found.insert(Some(kept.clone()));
                }
                // What was not synchronised may be there to any length.
                _ => found.extend((0..=seen.len()).map(|length| Some(seen[..length].to_vec()))),
            }
        }
        found
    }
}

fn apply(names: &mut BTreeMap<PathBuf, usize>, change: &Change) {
    match change {
        Change::Add(path, content) => {
            names.insert(path.clone(), *content);
        }
        // A name that is not there yet on the disk cannot be moved: the journal of a file system keeps that order.
        Change::Rename(from, to) => {
            if let Some(content) = names.remove(from) {
                names.insert(to.clone(), content);
            }
        }
        Change::Remove(path) => {
            names.remove(path);
        }
    }
}

/// A disk in memory.
#[derive(Clone, Default)]
struct Model(Rc<RefCell<State>>);

struct Draft {
    model: Model,
    path: PathBuf,
    content: usize,
    named: bool,
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.model.0.borrow_mut();
        state.step("write")?;
        // Half of it at a time, as a full disk or a signal would have it.
        let length = bytes.len().div_ceil(2);
        state.contents[self.content].0.extend(&bytes[..length]);
        Ok(length)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        let mut state = self.model.0.borrow_mut();
        if !self.named && !state.dark {
            state.change(Change::Remove(self.path.clone()));
        }
    }
}

impl FileSystem for Model {
    type Draft = Draft;

    fn is_folder(&self, folder: &Path) -> bool {
        self.0.borrow().folders.contains(folder)
    }

    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        let mut state = self.0.borrow_mut();
        state.step("make folder")?;
        state.folders.insert(folder.to_path_buf());
        Ok(())
    }

    fn draft(&self, folder: &Path, _: &Path) -> io::Result<Draft> {
        let mut state = self.0.borrow_mut();
        state.step("draft")?;
        let (path, content) = (folder.join(".part"), state.contents.len());
        state.contents.push((Vec::new(), None));
        state.change(Change::Add(path.clone(), content));
        Ok(Draft { model: self.clone(), path, content, named: false })
    }

    fn sync(&self, draft: &Draft) -> io::Result<()> {
        let mut state = self.0.borrow_mut();
        state.step("sync")?;
        let (seen, kept) = &mut state.contents[draft.content];
        *kept = Some(seen.clone());
        Ok(())
    }

    fn name(&self, mut draft: Draft, place: &Path) -> io::Result<()> {
        let mut state = self.0.borrow_mut();
        let named = state.step("name");
        if named.is_ok() {
            state.change(Change::Rename(draft.path.clone(), place.to_path_buf()));
        }
        drop(state);
        draft.named = named.is_ok();
        named
    }

    fn sync_folder(&self, folder: &Path) -> io::Result<()> {
        let mut state = self.0.borrow_mut();
        state.step(if folder == Path::new("/out/new") { "sync folder" } else { "sync folder above" })?;
        state.kept = state.names.clone();
        state.pending.clear();
        Ok(())
    }
}

/// A disk with or without the old file.
fn disk(old: bool, fault: Option<(usize, Fault)>) -> Model {
    let mut state = State { fault, ..State::default() };
    state.folders.insert("/".into());
    if old {
        state.folders.extend(["/out".into(), "/out/new".into()]);
        state.contents.push((OLD.to_vec(), Some(OLD.to_vec())));
        state.names.insert(PLACE.into(), 0);
        state.kept = state.names.clone();
    }
    Model(Rc::new(RefCell::new(state)))
}

fn new() -> Vec<u8> {
    NEW.concat()
}

/// Three parts, each of which leaves the buffer by itself.
fn content(file: &mut dyn Write) -> io::Result<()> {
    for part in NEW {
        file.write_all(part)?;
        file.flush()?;
    }
    Ok(())
}

fn here(state: &State) -> Option<Vec<u8>> {
    state.names.get(Path::new(PLACE)).map(|&content| state.contents[content].0.clone())
}

#[test]
fn the_content_is_on_the_disk_before_it_has_its_name_and_the_name_before_the_end() {
    let model = disk(false, None);
    write_on(&model, Path::new(PLACE), content).unwrap();
    let state = model.0.borrow();
    let mut steps = state.done.clone();
    steps.dedup();
    let folders = ["make folder", "sync folder above", "make folder", "sync folder above"];
    let file = ["draft", "write", "sync", "name", "sync folder"];
    assert_eq!(steps, [&folders[..], &file[..]].concat());
    assert_eq!(state.after_a_power_cut(), BTreeSet::from([Some(new())]));
}

#[test]
fn a_file_is_whole_or_as_before_whichever_operation_fails_and_wherever_the_power_is_cut() {
    for old in [false, true] {
        let before = old.then(|| OLD.to_vec());
        let undisturbed = disk(old, None);
        write_on(&undisturbed, Path::new(PLACE), content).unwrap();
        let steps = undisturbed.0.borrow().done.len();
        assert!(steps > 10);
        for fault in [Fault::Fails, Fault::PowerCut] {
            for at in 0..steps {
                let model = disk(old, Some((at, fault)));
                let outcome = write_on(&model, Path::new(PLACE), content);
                let state = model.0.borrow();
                let what = state.done[at];
                assert!(outcome.is_err(), "{fault:?} at {at} ({what}) is not reported");
                let seen = here(&state);
                if what == "sync folder" {
                    assert_eq!(seen, Some(new()), "{fault:?} at {at} ({what})");
                } else {
                    assert_eq!(seen, before, "{fault:?} at {at} ({what})");
                }
                if fault == Fault::Fails {
                    let names: Vec<&PathBuf> = state.names.keys().collect();
                    assert!(names.iter().all(|name| *name == Path::new(PLACE)), "{what} leaves {names:?}");
                }
                for found in state.after_a_power_cut() {
                    assert!(found == before || found == Some(new()), "{fault:?} at {at} ({what}): {found:?}");
                }
            }
        }
    }
}

/// The model must see what it is there for.
#[test]
fn a_file_that_is_named_before_it_is_on_the_disk_may_be_torn() {
    let model = disk(true, None);
    let mut draft = model.draft(Path::new("/out/new"), Path::new(PLACE)).unwrap();
    content(&mut draft).unwrap();
    model.name(draft, Path::new(PLACE)).unwrap();
    let found = model.0.borrow().after_a_power_cut();
    assert!(found.iter().flatten().any(|content| *content != new() && content != OLD), "{found:?}");

    // Without its folder, the whole file may be missing after success.
    let model = disk(true, None);
    let mut draft = model.draft(Path::new("/out/new"), Path::new(PLACE)).unwrap();
    content(&mut draft).unwrap();
    model.sync(&draft).unwrap();
    model.name(draft, Path::new(PLACE)).unwrap();
    assert!(model.0.borrow().after_a_power_cut().contains(&Some(OLD.to_vec())));
}
