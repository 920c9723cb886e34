//! Where a file or a folder may be.

use std::fs::{self, FileType};
use std::io;
use std::path::{Path, PathBuf};

use armid::remedy::{Remedy, Setting};

use crate::error::Error;

/// So many links are followed: as many as Linux does.
const LINKS: usize = 40;

/// The regular file that a path names, links followed; it need not be there yet.
///
/// # Errors
/// [`Error`] where something is there that is no regular file: a folder, a device, a pipe, a socket.
pub fn regular_file(path: &Path) -> Result<PathBuf, Error> {
    if path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return Err(Error::new(format!("{} ends as a folder, expected the name of a file", path.display())));
    }
    match fs::metadata(path) {
        Ok(there) if !there.is_file() => {
            let message =
                format!("{} is {}, expected a regular file or a new one", path.display(), kind(there.file_type()));
            let help = Remedy::set(Setting::Output, "-").say(" writes to standard output, where one text is written");
            Err(Error::new(message).help(help))
        }
        Ok(_) => followed(path),
        // A link may lead to a file that is to be made.
        Err(error) if error.kind() == io::ErrorKind::NotFound => followed(path),
        Err(error) => Err(Error::unwritable(path, &error)),
    }
}

/// The folder that a path names; it need not be there yet.
///
/// # Errors
/// [`Error`] where it exists and is not a folder.
pub fn folder(path: &Path) -> Result<PathBuf, Error> {
    match fs::metadata(path) {
        Ok(there) if !there.is_dir() => {
            let message = format!("{} is {}, expected a folder or a new one", path.display(), kind(there.file_type()));
            Err(Error::new(message))
        }
        Ok(_) => Ok(path.to_path_buf()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => followed(path),
        Err(error) => Err(Error::unwritable(path, &error)),
    }
}

/// The end of a chain of links, whether or not anything is there.
fn followed(path: &Path) -> Result<PathBuf, Error> {
    let mut place = path.to_path_buf();
    for _ in 0..LINKS {
        match fs::read_link(&place) {
            // A relative link begins at its own folder.
            Ok(target) => place = place.parent().map_or_else(|| target.clone(), |folder| folder.join(&target)),
            Err(_) => return Ok(place),
        }
    }
    Err(Error::new(format!("{} is a link without a target, expected one to a file", path.display())))
}

fn kind(found: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if found.is_char_device() || found.is_block_device() {
            return "a device";
        }
        if found.is_fifo() {
            return "a pipe";
        }
        if found.is_socket() {
            return "a socket";
        }
    }
    if found.is_dir() {
        "a folder"
    } else if found.is_file() {
        "a file"
    } else {
        "no regular file"
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::os::unix::net::UnixListener;

    use super::*;
    use crate::output::write_text;

    #[test]
    fn a_link_is_written_through_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("far")).unwrap();
        fs::write(at("far/there.json"), "old").unwrap();
        fs::set_permissions(at("far/there.json"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink("far/there.json", at("link.json")).unwrap();
        symlink("link.json", at("second.json")).unwrap();
        symlink("far/new.json", at("dangling.json")).unwrap();
        for (link, target) in [("second.json", "far/there.json"), ("dangling.json", "far/new.json")] {
            write_text(&at(link), link).unwrap();
            assert!(fs::symlink_metadata(at(link)).unwrap().is_symlink(), "{link}");
            assert_eq!(fs::read_to_string(at(target)).unwrap(), link);
        }
        // Who may read a file does not change when it is written again.
        assert_eq!(fs::metadata(at("far/there.json")).unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(fs::read_dir(at("far")).unwrap().count(), 2);
        symlink("turn.json", at("turn.json")).unwrap();
        assert!(write_text(&at("turn.json"), "").is_err());
    }

    #[test]
    fn what_is_no_file_is_refused_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let _listener = UnixListener::bind(at("socket")).unwrap();
        fs::create_dir(at("folder")).unwrap();
        symlink("/dev/null", at("device")).unwrap();
        for (name, kind) in [("socket", "a socket"), ("folder", "a folder"), ("device", "a device")] {
            let before = fs::metadata(at(name)).unwrap().file_type();
            let fault = write_text(&at(name), "x").unwrap_err().to_string();
            assert!(fault.contains(&format!("is {kind}, expected a regular file")), "{fault}");
            assert_eq!(fs::metadata(at(name)).unwrap().file_type(), before);
        }
        assert!(write_text(&at("new/"), "x").unwrap_err().to_string().contains("ends as a folder"));
        fs::write(at("file"), "").unwrap();
        assert!(super::folder(&at("file")).unwrap_err().to_string().contains("is a file, expected a folder"));
        assert_eq!(super::folder(&at("folder")).unwrap(), at("folder"));
    }
}
