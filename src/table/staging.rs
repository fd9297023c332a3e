//! Where a table's parts are until it is whole, and how it gets its name.
//!
//! All that is unfinished is in one directory beside the table, `NAME.partial`: in `table` the parts
//! that are being written, in `replaced` for an instant what had the name before. The name is given by
//! one renaming, so that it never belongs to a part of a table; a table that is one part is that file,
//! one of several is the directory. What an interrupted program leaves, the next one clears away, and
//! nothing else.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::directory::sync_directory;

/// In the directory: the parts.
const TABLE: &str = "table";
/// In the directory: what had the name before.
const REPLACED: &str = "replaced";

/// The directory of an unfinished table.
pub(super) struct Staging {
    target: PathBuf,
    directory: PathBuf,
}

/// The name of a part in the directory of its table; names sort like numbers up to 100,000 parts.
pub(super) fn part_name(number: usize) -> String {
    format!("part-{number:05}.parquet")
}

impl Staging {
    /// Makes the directory for the table `target`, without what an interrupted program left in it; one
    /// that holds anything else is not ours to clear away.
    pub(super) fn create(target: &Path) -> io::Result<Self> {
        let directory = target.with_added_extension("partial");
        if let Some(foreign) = foreign(&directory)? {
            return Err(io::Error::other(format!(
                "{} is in the way: it holds {foreign}, which is not part of a table",
                directory.display()
            )));
        }
        remove(&directory)?;
        fs::create_dir(&directory)?;
        let staging = Staging { target: target.to_owned(), directory };
        fs::create_dir(staging.table())?;
        Ok(staging)
    }

    /// Removes the directory with the parts.
    pub(super) fn clear(self) -> io::Result<()> {
        remove(&self.directory)
    }

    fn table(&self) -> PathBuf {
        self.directory.join(TABLE)
    }

    /// Where part `number` is to be written.
    pub(super) fn part(&self, number: usize) -> PathBuf {
        self.table().join(part_name(number))
    }

    /// Gives the table its name, in place of whatever had it; `parts` have been written and synced.
    /// Returns their names from the directory on that the table is in.
    pub(super) fn settle(self, parts: usize) -> io::Result<Vec<String>> {
        let source = if parts == 1 { self.part(0) } else { self.table() };
        sync_directory(&self.table())?;
        // A file gives way to a file in the renaming itself; a directory that is not empty to nothing.
        let old = fs::symlink_metadata(&self.target).ok();
        if old.is_some_and(|old| old.is_dir() || parts > 1) {
            fs::rename(&self.target, self.directory.join(REPLACED))?;
        }
        fs::rename(source, &self.target)?;
        sync_directory(parent(&self.target))?;
        remove(&self.directory)?;
        let name = self.target.file_name().unwrap_or_default().to_string_lossy();
        Ok(match parts {
            1 => vec![name.into_owned()],
            _ => (0..parts).map(|number| format!("{name}/{}", part_name(number))).collect(),
        })
    }
}

/// Something in a directory that is not left from an unfinished table; none where there is no such
/// directory.
fn foreign(directory: &Path) -> io::Result<Option<String>> {
    if !fs::symlink_metadata(directory).is_ok_and(|found| found.is_dir()) {
        return Ok(None);
    }
    for entry in fs::read_dir(directory)? {
        let name = entry?.file_name();
        if name != TABLE && name != REPLACED {
            return Ok(Some(name.to_string_lossy().into_owned()));
        }
    }
    Ok(None)
}

/// Removes a file, or a directory with all that is in it; does not follow links.
fn remove(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => fs::remove_dir_all(path),
        Ok(_) => fs::remove_file(path),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(error) => Err(error),
    }
}

fn parent(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use tempfile::tempdir;

    use super::{Staging, part_name};

    /// Writes a table of parts with these contents.
    fn write(target: &Path, parts: &[&str]) -> Vec<String> {
        let staging = Staging::create(target).unwrap();
        for (number, content) in parts.iter().enumerate() {
            fs::write(staging.part(number), content).unwrap();
        }
        staging.settle(parts.len()).unwrap()
    }

    /// The contents of a table's parts.
    fn read(target: &Path) -> Vec<String> {
        if target.is_file() {
            return vec![fs::read_to_string(target).unwrap()];
        }
        let parts = fs::read_dir(target).unwrap().count();
        (0..parts).map(|part| fs::read_to_string(target.join(part_name(part))).unwrap()).collect()
    }

    #[test]
    fn a_table_takes_the_place_of_any_other() {
        let tables: [&[&str]; 4] = [&["a"], &["b"], &["c", "d"], &["e", "f", "g"]];
        for before in tables {
            for after in tables {
                let scratch = tempdir().unwrap();
                let target = scratch.path().join("t.parquet");
                write(&target, before);
                let names = write(&target, after);
                assert_eq!(read(&target), after, "after {before:?}");
                let contents: Vec<String> = names
                    .iter()
                    .map(|name| fs::read_to_string(scratch.path().join(name)).unwrap())
                    .collect();
                assert_eq!(contents, after, "{names:?}");
                assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 1, "only the table");
            }
        }
    }

    #[test]
    fn the_name_belongs_to_the_old_table_until_the_new_one_is_whole() {
        let scratch = tempdir().unwrap();
        let target = scratch.path().join("t.parquet");
        write(&target, &["a", "b"]);
        let staging = Staging::create(&target).unwrap();
        fs::write(staging.part(0), "c").unwrap();
        assert_eq!(read(&target), ["a", "b"]);
        staging.settle(1).unwrap();
        assert_eq!(read(&target), ["c"]);
    }

    #[test]
    fn leftovers_of_an_interrupted_program_are_cleared_away() {
        let scratch = tempdir().unwrap();
        let target = scratch.path().join("t.parquet");
        let partial = scratch.path().join("t.parquet.partial");
        fs::write(&partial, "half a file").unwrap();
        write(&target, &["a"]);
        assert_eq!((read(&target), partial.exists()), (vec!["a".to_owned()], false));
        // Interrupted between the two renamings, with more parts than the next table has.
        fs::create_dir_all(partial.join("table")).unwrap();
        (0..3).for_each(|n| fs::write(partial.join("table").join(part_name(n)), "x").unwrap());
        fs::rename(&target, partial.join("replaced")).unwrap();
        write(&target, &["b", "c"]);
        assert_eq!((read(&target), partial.exists()), (vec!["b".into(), "c".into()], false));
    }

    #[test]
    fn a_foreign_directory_is_left_alone() {
        let scratch = tempdir().unwrap();
        let partial = scratch.path().join("t.parquet.partial");
        fs::create_dir(&partial).unwrap();
        fs::write(partial.join("thesis.tex"), "years of work").unwrap();
        let error = Staging::create(&scratch.path().join("t.parquet")).err().unwrap().to_string();
        assert!(error.contains("t.parquet.partial is in the way: it holds thesis.tex"), "{error}");
        assert_eq!(fs::read_to_string(partial.join("thesis.tex")).unwrap(), "years of work");
    }
}
