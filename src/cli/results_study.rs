//! The study whose results a directory holds.

use std::path::Path;

use super::exit::CliError;
use crate::classification::MODEL_VERSION;
use crate::foreign::shell_word;
use crate::study::Study;
use crate::table::{Manifest, ResultsError, VERSION, manifest_of};

const STUDY: &str = "study.yaml";

/// The study and the manifest of a directory with results, finished or not, to be shown: the study is the file
/// that was written.
///
/// # Errors
/// Where there are none, where they are another version's, or where the study has been edited since.
pub fn results_study(directory: &Path) -> Result<(Study, Manifest), CliError> {
    let (study, manifest) = begun_study(directory)?;
    manifest.check_file(directory, STUDY)?;
    Ok((study, manifest))
}

/// The study and the manifest of a directory with results to go on with; all that does not decide the runs may have been
/// edited since.
///
/// # Errors
/// Where there are none, where they are another version's, or where other runs are planned.
pub fn begun_study(directory: &Path) -> Result<(Study, Manifest), CliError> {
    let occupied = |reason: &str, found: String, allowed: String| ResultsError::Occupied {
        path: directory.to_owned(),
        reason: reason.to_owned(),
        found,
        allowed,
    };
    let Some(manifest) = manifest_of(directory)? else {
        let reason = "this directory holds no study";
        let found = "no manifest.json".to_owned();
        let allowed = "a directory that `stickslip run` has begun to fill";
        return Err(occupied(reason, found, allowed.to_owned()).into());
    };
    if manifest.model_version != MODEL_VERSION {
        let found = format!(
            "stickslip {}, version {} of the model (this is {VERSION} with version {MODEL_VERSION})",
            manifest.version, manifest.model_version,
        );
        let allowed = format!(
            "that version of the program; or all anew, with `stickslip run {} --out DIR`",
            shell_word(&directory.join(STUDY))
        );
        let reason = "these runs were computed by another version";
        return Err(occupied(reason, found, allowed).into());
    }
    let study = Study::load(&directory.join(STUDY))?;
    if study.hash() != manifest.study_hash {
        let found = format!("a study.yaml whose runs are not those of study {}", manifest.study);
        let allowed = format!(
            "the study.yaml that was written; or `stickslip run {} --out {}{}`, which \
             computes what is new in it",
            shell_word(&directory.join(STUDY)),
            shell_word(directory),
            match manifest.shard.as_str() {
                "1/1" => String::new(),
                shard => format!(" --shard {shard}"),
            }
        );
        return Err(occupied("the study has been edited since", found, allowed).into());
    }
    Ok((study, manifest))
}
