//! Files that are complete or absent, because they have temporary names until they are complete, and directories that survive
//! a loss of power.
//!
//! A temporary name is the final name with six random characters and an extension that no other program
//! uses: `r.parquet.x4kT0b.stickslip-partial`. The name is created exclusively, belongs to one
//! process, and is removed when the value is dropped. The files of a killed process are recognised
//! by their names; in a locked directory, the next process removes them. Directories inside an output directory are never
//! links, so that nothing is written elsewhere.

use std::fs;
use std::io;
use std::path::Path;

use tempfile::{Builder, NamedTempFile, TempDir};

use super::file_entry::has_content;

/// The extension of all temporary names.
const EXTENSION: &str = ".stickslip-partial";
/// The number of random characters.
const RANDOM_CHARACTERS: usize = 6;

/// Returns the final name for a temporary name, or `None` for any other name.
pub(super) fn final_name(name: &str) -> Option<&str> {
    let (target, random) = name.strip_suffix(EXTENSION)?.rsplit_once('.')?;
    let usual = random.len() == RANDOM_CHARACTERS
        && random.bytes().all(|byte| byte.is_ascii_alphanumeric());
    (usual && !target.is_empty()).then_some(target)
}

/// Calls a function with a builder of temporary names beside `target`, and the directory.
fn beside<T>(
    target: &Path,
    make: impl FnOnce(&mut Builder<'_, '_>, &Path) -> io::Result<T>,
) -> io::Result<T> {
    let mut prefix = target.file_name().unwrap_or_default().to_owned();
    prefix.push(".");
    let mut builder = Builder::new();
    make(builder.prefix(&prefix).suffix(EXTENSION).rand_bytes(RANDOM_CHARACTERS), parent(target))
}

/// Returns the directory of a file.
pub(super) fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Creates a directory beside `target` for this process.
pub(super) fn temporary_directory(target: &Path) -> io::Result<TempDir> {
    beside(target, |builder, parent| builder.tempdir_in(parent))
}

/// Creates an empty file beside `target` for this process; other processes may read it after the
/// rename.
pub(crate) fn temporary_file(target: &Path) -> io::Result<NamedTempFile> {
    beside(target, |builder, parent| {
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(parent)
    })
}

/// Writes a file under a temporary name, syncs it and renames it.
///
/// # Errors
/// Returns an error if the file cannot be written or renamed; the temporary file is then removed.
pub fn write_atomically(path: &Path, content: &[u8]) -> io::Result<()> {
    use std::io::Write;
    let mut file = temporary_file(path)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    file.persist(path).map_err(|error| error.error)?;
    sync_directory(parent(path))
}

/// Writes a file that never replaces anything. An existing file with the same content is left
/// unchanged.
///
/// # Errors
/// Returns an error of the kind `AlreadyExists` if the name is taken, or another error if the file
/// cannot be written.
pub fn write_once(path: &Path, content: &[u8]) -> io::Result<()> {
    match has_content(path, content) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => write_atomically(path, content),
        Err(error) => Err(error),
        Ok(true) => Ok(()),
        Ok(false) => Err(taken()),
    }
}

/// Returns the error for a file whose name is taken.
pub(super) fn taken() -> io::Error {
    let problem = "another file has this name, and is not replaced";
    io::Error::new(io::ErrorKind::AlreadyExists, problem)
}

/// Returns whether a name is one of a command's own, or a temporary name of one of them.
pub(crate) fn is_own(name: &str, belongs: impl Fn(&str) -> bool) -> bool {
    belongs(final_name(name).unwrap_or(name))
}

/// Removes what killed processes have left of a command's own files in a locked directory. It removes
/// temporary names only.
///
/// # Errors
/// Returns an error if something cannot be removed.
pub fn clear_temporaries(directory: &Path, belongs: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in fs::read_dir(directory)? {
        let entry = entry?;
        let name = entry.file_name();
        if !name.to_str().and_then(final_name).is_some_and(&belongs) {
            continue;
        }
        // Removes a link itself, not its target.
        match entry.file_type()?.is_dir() {
            true => fs::remove_dir_all(entry.path())?,
            false => fs::remove_file(entry.path())?,
        }
    }
    Ok(())
}

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
        .expect("a folder for temporary files is writable");
        synced
    }

    #[test]
    fn every_new_directory_is_synced_into_its_parent() {
        let scratch = tempdir().expect("a folder for temporary files");
        let top = scratch.path();
        let deep = top.join("a/b/c");
        let made = synced(|mut sync| make_with(&deep, &mut sync));
        assert!(deep.is_dir());
        assert_eq!(made, [top, &top.join("a"), &top.join("a/b")]);
        let inside = synced(|mut sync| make_inside_with(&deep.join("chunks"), &mut sync));
        assert_eq!(inside, [deep.as_path()]);
        // An earlier program may have been killed before it synced the directory.
        let again = synced(|mut sync| make_inside_with(&deep.join("chunks"), &mut sync));
        assert_eq!(again, [deep.as_path()]);
        assert_eq!(synced(|mut sync| make_with(&deep, &mut sync)), [top.join("a/b")]);
    }
}
