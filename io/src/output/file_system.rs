//! What writing a whole file asks of a file system, and the one of this machine.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use tempfile::NamedTempFile;

/// The operations by which a whole file comes to its place.
pub(super) trait FileSystem {
    /// A file without its name yet; it goes away where it never gets one.
    type Draft: Write;

    /// Is there such a folder?
    fn is_folder(&self, folder: &Path) -> bool;
    /// Makes a folder in one that is there.
    fn make_folder(&self, folder: &Path) -> io::Result<()>;
    /// Begins a file in a folder, with the permissions of the one that it is to replace, where there is one.
    fn draft(&self, folder: &Path, place: &Path) -> io::Result<Self::Draft>;
    /// Returns when the content is on the disk.
    fn sync(&self, draft: &Self::Draft) -> io::Result<()>;
    /// Gives a draft its name, in place of what has it.
    fn name(&self, draft: Self::Draft, place: &Path) -> io::Result<()>;
    /// Returns when the names in a folder are on the disk.
    fn sync_folder(&self, folder: &Path) -> io::Result<()>;
}

/// The file system of this machine.
pub(super) struct Disk;

impl FileSystem for Disk {
    type Draft = NamedTempFile;

    fn is_folder(&self, folder: &Path) -> bool {
        folder.is_dir()
    }

    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        fs::create_dir(folder)
    }

    fn draft(&self, folder: &Path, place: &Path) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".armid-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let draft = builder.tempfile_in(folder)?;
        if let Ok(before) = fs::metadata(place) {
            draft.as_file().set_permissions(before.permissions())?;
        }
        Ok(draft)
    }

    fn sync(&self, draft: &NamedTempFile) -> io::Result<()> {
        draft.as_file().sync_all()
    }

    fn name(&self, draft: NamedTempFile, place: &Path) -> io::Result<()> {
        draft.persist(place).map(|_| ()).map_err(|error| error.error)
    }

    #[cfg(unix)]
    fn sync_folder(&self, folder: &Path) -> io::Result<()> {
        match File::open(folder)?.sync_all() {
            // Some network file systems cannot synchronise folders, and say so.
            Err(error) if matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
            done => done,
        }
    }

    /// Elsewhere a rename is in the journal of the file system when it returns.
    #[cfg(not(unix))]
    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }
}

/// The folder of a place.
pub(super) fn folder_of(place: &Path) -> &Path {
    match place.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Synchronises the folder of a file that was made or lost its name.
pub(crate) fn sync_folder_of(place: &Path) -> io::Result<()> {
    Disk.sync_folder(folder_of(place))
}

/// Gives a file that is whole another name in its folder, through a power cut too.
pub(crate) fn name_file(file: &File, from: &Path, to: &Path) -> io::Result<()> {
    file.sync_all()?;
    fs::rename(from, to)?;
    sync_folder_of(to)
}
