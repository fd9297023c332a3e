//! Templates of study files: commented studies to start from.
//!
//! Read `machine.yaml` first, which is a template, then `annotate`, which adds the comments, and this file last. A template
//! holds keys and values. The comments state meaning, unit, range and default of each key, from the JSON Schema and the
//! program's defaults.

mod annotate;

use std::path::Path;
use std::rc::Rc;

use crate::sanitize::shell_word;
use crate::study::StudyError;
use crate::study::file::resolved_yaml::write_text;
use crate::study::file::source::Source;
use crate::study::file::table_folders::TableFolders;
use crate::study::plan::planned_study::Study;
use crate::study::resolve::names::check_study_name;
use crate::study::schema::{defaults_of, json_schema};

/// A commented study to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Template {
    /// Name on the command line.
    pub name: &'static str,
    /// What the template is for, in one line.
    pub summary: &'static str,
    /// Keys and values, after a head of comments. `NAME` and `FILE` are placeholders.
    pub source: &'static str,
}

impl Template {
    /// All templates.
    pub const ALL: [Template; 8] = [
        Template {
            name: "machine",
            summary: "a ball balancer of your own, with all its parameters",
            source: include_str!("machine.yaml"),
        },
        Template {
            name: "thesis",
            summary: "the machine and the sweep of the thesis",
            source: include_str!("thesis.yaml"),
        },
        Template {
            name: "blocks",
            summary: "a block on a spring, on a belt or on rigid ground",
            source: include_str!("blocks.yaml"),
        },
        Template {
            name: "rotor",
            summary: "a ball balancer on a horizontal rotor with two bearings",
            source: include_str!("rotor.yaml"),
        },
        Template {
            name: "grinder",
            summary: "an angle grinder with a ball balancer that runs up",
            source: include_str!("grinder.yaml"),
        },
        Template {
            name: "system",
            summary: "a machine of your own with its equations",
            source: include_str!("system.yaml"),
        },
        Template {
            name: "monte-carlo",
            summary: "a ball balancer whose parameters are uncertain",
            source: include_str!("monte-carlo.yaml"),
        },
        Template {
            name: "optimize",
            summary: "variables, responses and the search for the best design",
            source: include_str!("optimize.yaml"),
        },
    ];

    /// Returns the template of a name.
    pub fn find(name: &str) -> Option<Template> {
        Template::ALL.into_iter().find(|template| template.name == name)
    }

    /// Returns a study of this name, whose head shows commands with this file.
    ///
    /// # Errors
    /// Returns an error if `name` is not the name of a study.
    pub fn text(&self, name: &str, file: &Path) -> Result<String, StudyError> {
        check_study_name(name).map_err(|fault| StudyError::about_file(file, fault))?;
        let mut written = String::new();
        write_text(name, &mut written);
        let source = self.source.replace("name: NAME", &format!("name: {written}"));
        let source = source.replace("FILE", &shell_word(file));
        let study = Study::parse(file, source.clone())?;
        let resolved = study.resolved_file();
        let kind = resolved.pointer("/model/kind").and_then(|kind| kind.as_str());
        let defaults = defaults_of(kind.unwrap_or_default());
        let folders = Rc::new(TableFolders::new(file, &[])?);
        Ok(annotate::annotate(&Source::new(file, source, folders)?, &json_schema(), &defaults))
    }
}
