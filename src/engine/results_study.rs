//! The study of a directory of results.

use std::path::Path;

use super::command_error::CommandError;
use crate::classification::MODEL_VERSION;
use crate::sanitize::{shell_word, shown_path};
use crate::study::Study;
use crate::table::{MANIFEST, Manifest, ResultsError, VERSION, manifest_of};

const STUDY: &str = "study.yaml";
/// Other commands with directories of their own: a file, the command that writes it, and what reads the directory.
const OTHER_COMMANDS: [(&str, &str, &str); 4] = [
    (
        "evaluations.parquet",
        "optimize",
        "`stickslip report DIR` writes a page of the search, and `stickslip optimize STUDY --out DIR` continues it",
    ),
    ("equilibrium_set_summary.parquet", "equilibria", FIGURES),
    ("trajectory.parquet", "replay", FIGURES),
    ("identification.json", "identify", FIGURES),
];
const FIGURES: &str = "the Python package's `stickslip-figures DIR` draws its tables";

/// Returns the study and the manifest of a directory of results, finished or not, whose study file is unchanged.
///
/// # Errors
/// Returns an error if there are no results, if another version computed them, or if the study file was edited.
pub fn results_study(directory: &Path) -> Result<(Study, Manifest), CommandError> {
    let (study, manifest) = begun_study(directory)?;
    manifest.check_file(directory, STUDY)?;
    Ok((study, manifest))
}

/// Returns the study and the manifest of a directory of results to be continued. Parts of the study that do not
/// affect the runs may have been edited.
///
/// # Errors
/// Returns an error if there are no results, if another version computed them, or if the study has other runs.
pub fn begun_study(directory: &Path) -> Result<(Study, Manifest), CommandError> {
    let occupied = |reason: &str, found: String, allowed: String| {
        ResultsError::occupied(directory, reason, found, allowed)
    };
    if directory.is_file() {
        return Err(not_a_directory(directory));
    }
    if !directory.as_os_str().is_empty() && !directory.exists() {
        let what = format!("{}: this directory does not exist", shown_path(directory));
        return Err(CommandError::refusal(what, "no such directory", allowed_directory()));
    }
    let Some(manifest) = manifest_of(directory)? else {
        let reason = "this directory holds no results of `stickslip run`";
        let (found, allowed) =
            match OTHER_COMMANDS.iter().find(|(file, ..)| directory.join(file).exists()) {
                Some((file, command, reader)) => (
                    format!("{file}, which `stickslip {command}` writes, and no {MANIFEST}"),
                    format!(
                        "results of `stickslip run`; {}",
                        reader.replace("DIR", &shell_word(directory))
                    ),
                ),
                None => (format!("no {MANIFEST}"), allowed_directory()),
            };
        return Err(occupied(reason, found, allowed).into());
    };
    if manifest.model_version != MODEL_VERSION {
        let found = format!(
            "stickslip {}, version {} of the model (this is {VERSION} with version {MODEL_VERSION})",
            manifest.version, manifest.model_version,
        );
        let allowed = format!(
            "that version of the program; or `stickslip run {} --out DIR`, which computes all runs",
            shell_word(&directory.join(STUDY))
        );
        let reason = "these runs were computed by another version";
        return Err(occupied(reason, found, allowed).into());
    }
    let study = Study::load(&directory.join(STUDY))?;
    if study.hash() != manifest.study_hash {
        let found = format!("a study.yaml whose runs are not those of study {}", manifest.study);
        let allowed = format!(
            "the original study.yaml; or `stickslip run {} --out {}{}`, which \
             computes the new runs",
            shell_word(&directory.join(STUDY)),
            shell_word(directory),
            match manifest.shard.as_str() {
                "1/1" => String::new(),
                shard => format!(" --shard {shard}"),
            }
        );
        return Err(occupied("the study has been edited since the run", found, allowed).into());
    }
    Ok((study, manifest))
}

fn allowed_directory() -> String {
    "a directory that `stickslip run` has written to".to_owned()
}

/// Returns the error for a file in place of a directory of results.
fn not_a_directory(file: &Path) -> CommandError {
    let what = format!("{}: this is a file, not a directory of results", shown_path(file));
    match Study::load(file) {
        Ok(study) => {
            let directory = Path::new("results").join(study.name());
            let allowed = format!(
                "a directory of results; `stickslip run {}` computes this study first and writes {}",
                shell_word(file),
                shell_word(&directory)
            );
            CommandError::refusal(what, format!("the study {}", study.name()), allowed)
        }
        Err(_) => CommandError::refusal(what, "a file", allowed_directory()),
    }
}
