//! Directories that the program makes: they outlive a loss of power, and what it makes inside of an output
//! directory is a directory and not a link, so that nothing is written outside.

use std::fs;
use std::io;
use std::path::Path;

/// Makes an output directory and what is missing above it. The output directory itself may be a link: its
/// path is the user's choice.
///
/// # Errors
/// Where it cannot be made.
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
            // A directory that may be written to but not read cannot be synced.
            Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Ok(()),
            synced => synced,
        },
        // Where a program was killed before it had synced the parent, that is made up for; the parent of a
        // directory that was there before need not be readable.
        Err(_) if directory.is_dir() => {
            let _ = sync(directory.parent().unwrap_or(Path::new("")));
            Ok(())
        }
        Err(error) => Err(error),
    }
}

/// Makes a directory inside of an output directory, if it is not there.
///
/// # Errors
/// Where it cannot be made, or where its name belongs to a link or to another thing.
pub fn make_inside(path: &Path) -> io::Result<()> {
    make_inside_with(path, &mut sync_directory)
}

fn make_inside_with(path: &Path, sync: &mut impl FnMut(&Path) -> io::Result<()>) -> io::Result<()> {
    if !is_inside(path)? {
        fs::create_dir(path)?;
    }
    sync(path.parent().unwrap_or(Path::new("")))
}

/// Whether there is a directory inside of an output directory.
///
/// # Errors
/// Where its name belongs to a link or to another thing.
pub fn is_inside(path: &Path) -> io::Result<bool> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => Ok(true),
        Ok(found) if found.is_symlink() => {
            let name = path.file_name().unwrap_or_default().display();
            Err(io::Error::other(format!("{name} is a link to somewhere else")))
        }
        Ok(_) => {
            let name = path.file_name().unwrap_or_default().display();
            Err(io::Error::other(format!("{name} is not a directory")))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Makes what has been made and renamed in a directory last through a power cut.
///
/// # Errors
/// Where it cannot be done. File systems that know of no such thing are left alone.
pub fn sync_directory(directory: &Path) -> io::Result<()> {
    // Elsewhere directories cannot be opened.
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

    /// Calls `make` and returns the directories that it has synced.
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
        // Whoever made it may have been killed before it was synced.
        let again = synced(|mut sync| make_inside_with(&deep.join("chunks"), &mut sync));
        assert_eq!(again, [deep.as_path()]);
        assert_eq!(synced(|mut sync| make_with(&deep, &mut sync)), [top.join("a/b")]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_no_directory_inside() {
        let scratch = tempdir().unwrap();
        let (elsewhere, link) = (scratch.path().join("elsewhere"), scratch.path().join("link"));
        for there in [false, true] {
            if there {
                fs::create_dir(&elsewhere).unwrap();
                fs::remove_file(&link).unwrap();
            }
            std::os::unix::fs::symlink(&elsewhere, &link).unwrap();
            let error = make_inside(&link).unwrap_err().to_string();
            assert_eq!(error, "link is a link to somewhere else");
            assert_eq!(elsewhere.exists(), there);
        }
        // The user may name a link as the output directory.
        make_directory(&link).unwrap();
    }
}
