//! The study files of the project.

use std::path::{Path, PathBuf};

use stickslip::study::Study;

/// Returns the path of a file in `studies`.
pub fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("studies").join(name)
}

/// Loads a study of `studies`.
#[track_caller]
pub fn shipped_study(name: &str) -> Study {
    Study::load(&shipped(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns the study files in a folder of the project.
pub fn study_files(folder: &str) -> impl Iterator<Item = PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = std::fs::read_dir(folder).expect("a folder of the project");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths.filter(|path| path.extension().is_some_and(|extension| extension == "yaml"))
}
