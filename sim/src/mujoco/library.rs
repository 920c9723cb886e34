//! The library, loaded once per process.

#![allow(unsafe_code, reason = "loads and calls a C library")]

use std::ffi::{c_char, c_int};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock, PoisonError};

use super::MujocoError;
use super::functions::Functions;
use super::layout::DataLayout;
use super::places::{Surroundings, files};
use super::shared_object::{Contents, contents};

/// MuJoCo, of a version whose layout is known.
pub(super) struct Library {
    path: PathBuf,
    pub(super) layout: &'static DataLayout,
    pub(super) functions: Functions,
    /// Keeps the functions where they are.
    _handle: libloading::Library,
}

/// The one that this process uses.
static LIBRARY: OnceLock<Library> = OnceLock::new();
/// Held while it is looked for.
static LOOKING: Mutex<()> = Mutex::new(());

/// MuJoCo's own handler prints and writes a log file into the current folder; what it warns of is counted in the data.
unsafe extern "C" fn keep_quiet(_: *const c_char) {}

impl Library {
    /// The library, which is looked for until it is found once.
    ///
    /// # Errors
    /// [`MujocoError`] where it is nowhere, or where the first file with its name is not the library.
    pub(super) fn get() -> Result<&'static Self, MujocoError> {
        if let Some(library) = LIBRARY.get() {
            return Ok(library);
        }
        let _one_at_a_time = LOOKING.lock().unwrap_or_else(PoisonError::into_inner);
        if LIBRARY.get().is_none() {
            let library = Self::find(&Surroundings::now())?;
            // Only the holder of the lock sets it.
            let _ = LIBRARY.set(library);
        }
        Ok(LIBRARY.get().expect("set above"))
    }

    /// Looks for the library and loads it.
    pub(super) fn find(around: &Surroundings) -> Result<Self, MujocoError> {
        if let Some(path) = around.named() {
            return Self::open(&path);
        }
        let (searched, names) = (around.folders(), files());
        let mut places = names.iter().flat_map(|name| searched.iter().map(move |folder| folder.join(name)));
        if let Some(path) = places.find(|path| path.exists()) {
            return Self::open(&path);
        }
        // A bare name is what the system's loader looks for in its own places.
        for name in names.iter().map(Path::new) {
            if let Ok(handle) = load(name) {
                return Self::check(name, handle);
            }
        }
        Err(MujocoError::NotFound { searched })
    }

    /// Loads the library from a file.
    ///
    /// # Errors
    /// [`MujocoError`]: the file is unreadable, cut short, no library of this machine, or of another version.
    pub(super) fn open(path: &Path) -> Result<Self, MujocoError> {
        let unreadable =
            |error: std::io::Error| MujocoError::Unreadable { path: path.to_path_buf(), reason: error.to_string() };
        match contents(path).map_err(unreadable)? {
            Contents::Library { found, expected } if found < expected => {
                return Err(MujocoError::Truncated { path: path.to_path_buf(), found, expected });
            }
            Contents::Library { .. } => {}
            Contents::Other => return Err(unloadable(path, "found a file that is not a shared library")),
        }
        // A relative path without a slash would be looked up by the system's loader.
        let whole = path.canonicalize().map_err(unreadable)?;
        let handle = load(&whole).map_err(|error| unloadable(path, &error.to_string()))?;
        Self::check(path, handle)
    }

    /// Checks the version before anything else is asked for.
    fn check(path: &Path, handle: libloading::Library) -> Result<Self, MujocoError> {
        // SAFETY: whatever the version, `int mj_version(void)` is its signature, and a library without it is refused.
        let version = match unsafe { handle.get::<unsafe extern "C" fn() -> c_int>("mj_version") } {
            // SAFETY: it takes nothing and reads a constant.
            Ok(version) => unsafe { version() },
            Err(_) => return Err(unloadable(path, "found a library without mj_version")),
        };
        let Some(layout) = DataLayout::of_number(version) else {
            return Err(MujocoError::Version { path: path.to_path_buf(), found: dotted(version) });
        };
        // SAFETY: the version is one that the table was written for, and the handle is kept beside it.
        let functions = unsafe { Functions::of(&handle) }
            .map_err(|name| unloadable(path, &format!("found a library without {name}")))?;
        // SAFETY: `mju_user_warning` is a global `void (*)(const char*)`; it is set before any other function runs, by
        // the one thread that loads the library.
        unsafe {
            match handle.get::<*mut Option<unsafe extern "C" fn(*const c_char)>>("mju_user_warning") {
                Ok(handler) => **handler = Some(keep_quiet),
                Err(_) => return Err(unloadable(path, "found a library without mju_user_warning")),
            }
        }
        Ok(Self { path: path.to_path_buf(), layout, functions, _handle: handle })
    }

    /// Its file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Its version.
    pub(super) fn version(&self) -> &'static str {
        self.layout.version
    }

    /// The loaded file, to look up what only tests need.
    #[cfg(test)]
    pub(super) fn handle(&self) -> &libloading::Library {
        &self._handle
    }
}

fn load(path: &Path) -> Result<libloading::Library, libloading::Error> {
    // SAFETY: loading runs the library's initialisers. The file is whole, and it is the one that the user installed or
    // named as MuJoCo, whose initialisers register names and touch nothing of ours.
    unsafe { libloading::Library::new(path) }
}

fn unloadable(path: &Path, reason: &str) -> MujocoError {
    MujocoError::Unloadable { path: path.to_path_buf(), reason: reason.to_owned() }
}

/// `3.17.0` from 3017000, and `3.3.7` from 337 as versions before 3.10 counted.
fn dotted(version: c_int) -> String {
    if version >= 1_000_000 {
        format!("{}.{}.{}", version / 1_000_000, version / 1000 % 1000, version % 1000)
    } else {
        format!("{}.{}.{}", version / 100, version / 10 % 10, version % 10)
    }
}
