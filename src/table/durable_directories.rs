//! Creation of directories that survive a loss of power. Directories inside an output directory are
//! never links, so that nothing is written elsewhere.

use std::fs;
use std::io;
use std::path::Path;

/// Creates an output directory and its missing parents. The output directory itself may be a link,
/// because the user chooses its path.
///
/// # Errors
/// Returns an error if the directory cannot be created.
pub fn make_directory(directory: &Path) -> io::Result<()> {
    make_with(directory, &mut sync_directory)
}

fn make_with(directory: &Path, sync: &mut impl FnMut(&Path) -> io::Result<()>) -> io::Result<()> {
    let made = match fs::create_dir(directory) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let Some(parent) = directory.parent().filter(|parent| *parent != directory) else {
                return Err(error);
            };
            make_with(parent, sync)?;
            fs::create_dir(directory)
        }
        made => made,
    };
    match made {
        Ok(()) => match sync(directory.parent().unwrap_or(Path::new(""))) {
            // A directory may be writable but not readable, and then cannot be synced.
            Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Ok(()),
            synced => synced,
        },
        // If an earlier program was killed before it synced the parent, this repeats the sync. The
        // parent of an existing directory need not be readable.
        Err(_) if directory.is_dir() => {
            let _ = sync(directory.parent().unwrap_or(Path::new("")));
            Ok(())
        }
        Err(error) => Err(error),
    }
}

/// Creates a directory inside an output directory, unless it exists.
///
/// # Errors
/// Returns an error if the directory cannot be created, or if its name belongs to a link or a file.
pub fn make_inside(path: &Path) -> io::Result<()> {
    make_inside_with(path, &mut sync_directory)
}

fn make_inside_with(path: &Path, sync: &mut impl FnMut(&Path) -> io::Result<()>) -> io::Result<()> {
    if !is_inside(path)? {
        fs::create_dir(path)?;
    }
    sync(path.parent().unwrap_or(Path::new("")))
}

/// Returns whether there is a directory of this name inside an output directory.
///
/// # Errors
/// Returns an error if the name belongs to a link or a file.
pub fn is_inside(path: &Path) -> io::Result<bool> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => Ok(true),
        Ok(found) => {
            let name = path.file_name().unwrap_or_default().display();
            let is =
                if found.is_symlink() { "a link to somewhere else" } else { "not a directory" };
            Err(io::Error::other(format!("{name} is {is}")))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Syncs a directory, so that created and renamed files survive a loss of power.
///
/// # Errors
/// Returns an error if the sync fails. File systems without this operation are ignored.
pub fn sync_directory(directory: &Path) -> io::Result<()> {
    // Other systems cannot open directories.
    if !cfg!(unix) {
        return Ok(());
    }
    let here = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
    match fs::File::open(here)?.sync_all() {
        Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use tempfile::tempdir;

    use super::*;

    /// Calls `make` and returns the synced directories.
    fn synced(
        make: impl FnOnce(&mut dyn FnMut(&Path) -> io::Result<()>) -> io::Result<()>,
    ) -> Vec<PathBuf> {
        let mut synced = Vec::new();
        make(&mut |directory: &Path| {
            synced.push(directory.to_owned());
            Ok(())
        })
        .unwrap();
        synced
    }

    #[test]
    fn every_new_directory_is_synced_into_its_parent() {
        let scratch = tempdir().unwrap();
        let top = scratch.path();
        let deep = top.join("a/b/c");
        let made = synced(|mut sync| make_with(&deep, &mut sync));
        assert!(deep.is_dir());
        assert_eq!(made, [top.join("a").parent().unwrap(), &top.join("a"), &top.join("a/b")]);
        let inside = synced(|mut sync| make_inside_with(&deep.join("chunks"), &mut sync));
        assert_eq!(inside, [deep.as_path()]);
        // An earlier program may have been killed before it synced the directory.
        let again = synced(|mut sync| make_inside_with(&deep.join("chunks"), &mut sync));
        assert_eq!(again, [deep.as_path()]);
        assert_eq!(synced(|mut sync| make_with(&deep, &mut sync)), [top.join("a/b")]);
    }
}
