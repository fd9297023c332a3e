//! The study whose results a directory holds.

use std::path::Path;

use super::exit::CliError;
use crate::ending::MODEL_VERSION;
use crate::study::Study;
use crate::table::{Manifest, ResultsError, VERSION, manifest_of};

/// The study and the manifest of a directory with results, finished or not.
///
/// # Errors
/// Where there are none, where they are another version's, or where the study has been edited since.
pub fn results_study(directory: &Path) -> Result<(Study, Manifest), CliError> {
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
            "that version of the program; or all anew, with `stickslip run {}/study.yaml --out DIR`",
            directory.display()
        );
        let reason = "these runs were computed by another version";
        return Err(occupied(reason, found, allowed).into());
    }
    let study = Study::load(&directory.join("study.yaml"))?;
    if study.hash() != manifest.study_hash {
        let found = format!("a study.yaml whose runs are not those of study {}", manifest.study);
        let allowed = format!(
            "the study.yaml that was written; or `stickslip run {0}/study.yaml --out {0}{1}`, which \
             computes what is new in it",
            directory.display(),
            match manifest.shard.as_str() {
                "1/1" => String::new(),
                shard => format!(" --shard {shard}"),
            }
        );
        return Err(occupied("the study has been edited since", found, allowed).into());
    }
    Ok((study, manifest))
}
