//! A study file: its text, its tree and its name, and the paths in it at which faults are reported.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde_saphyr::options::DuplicateKeyPolicy;

use crate::study::error::{Fault, Location, StudyError};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::table_folders::TableFolders;
use crate::study::file::yaml_fault::reader_error;
use crate::study::file::yaml_tree::{Content, YamlNode, parsed};

/// The keys of a study file and their places.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    /// The name of the file.
    pub file: PathBuf,
    /// The whole file without lists of values, which may be long.
    pub root: YamlNode,
}

/// The text of a study file, its tree and its name, which a message needs.
pub(crate) struct Source {
    /// The name of the file.
    pub file: PathBuf,
    /// The text of the file.
    pub text: String,
    /// The whole file.
    pub root: YamlNode,
    /// The first unit of each key with a unit: the key without its unit, the unit as it is written, and the SI unit.
    pub units: Vec<(String, String, &'static str)>,
    /// Where the tables of the file may be.
    pub folders: Rc<TableFolders>,
}

impl Source {
    /// Parses a text into a tree.
    ///
    /// # Errors
    /// Returns an error if the text is empty, is not YAML, contains more than one document, is too
    /// deep or too large, repeats a key, or contains a number that is not finite.
    pub fn new(file: &Path, text: String, folders: Rc<TableFolders>) -> Result<Source, StudyError> {
        match parsed(&text, DuplicateKeyPolicy::Error) {
            Ok(root) => {
                let file = file.to_path_buf();
                let source = Source { file, text, root, units: Vec::new(), folders };
                source.check_top()?;
                source.check_finite()?;
                Ok(source)
            }
            Err(error) => Err(reader_error(file, &text, error.without_snippet())),
        }
    }

    fn check_top(&self) -> Result<(), StudyError> {
        let beginning = "keys and values, starting with `schema: 1`";
        match self.root.content {
            Content::Map(_) => Ok(()),
            Content::Nothing => {
                let fault = Fault::new("the file is empty", "no keys", beginning);
                Err(StudyError::about_file(&self.file, fault))
            }
            _ => {
                let fault = Fault::new("not a study", self.root.describe(), beginning);
                Err(self.refuse_at(self.root.place, &KeyPath::default(), fault))
            }
        }
    }

    fn check_finite(&self) -> Result<(), StudyError> {
        let is_not_finite = |node: &YamlNode| matches!(node.content, Content::Number(number) if !number.is_finite());
        let Some((path, node)) = self.root.find(&is_not_finite) else { return Ok(()) };
        let fault = Fault::new("not a finite number", node.describe(), "a finite number");
        Err(self.refuse_at(node.place, &path, fault))
    }

    /// Returns the keys and their places.
    pub fn outline(&self) -> Outline {
        Outline { file: self.file.clone(), root: self.root.outline() }
    }

    /// Creates the message for a fault at a known place.
    pub fn refuse_at(&self, place: Location, path: &KeyPath, fault: Fault) -> StudyError {
        let line = self.text.lines().nth(place.line.saturating_sub(1));
        let path = self.root.as_written(path).to_string();
        StudyError::new(&self.file, Some(place), path, fault, line)
    }

    /// Returns a path, such as `simulation.band`.
    pub fn path(&self, path: &str) -> SourcePath<'_> {
        self.at(KeyPath::of(path))
    }

    /// Returns the place of a path.
    pub fn at(&self, path: KeyPath) -> SourcePath<'_> {
        SourcePath { source: self, path }
    }
}

/// The path of a key or value in a study file, which need not be present there.
#[derive(Clone)]
pub(crate) struct SourcePath<'a> {
    source: &'a Source,
    path: KeyPath,
}

impl<'a> SourcePath<'a> {
    /// Returns the path of a key below this one.
    pub fn key(&self, name: &str) -> SourcePath<'a> {
        self.below(Segment::Key(name.to_owned()))
    }

    /// Returns the path of an item of the list at this path.
    pub fn item(&self, index: usize) -> SourcePath<'a> {
        self.below(Segment::Item(index))
    }

    fn below(&self, step: Segment) -> SourcePath<'a> {
        let mut below = self.clone();
        below.path.0.push(step);
        below
    }

    /// Returns the value, if the file contains it.
    pub fn node(&self) -> Option<&'a YamlNode> {
        self.source.root.at(&self.path)
    }

    /// Returns where the tables of the file may be.
    pub fn folders(&self) -> &'a TableFolders {
        &self.source.folders
    }

    /// Returns the path of the choice at this path: of the only key of a map, or of a word.
    pub fn chosen(&self) -> SourcePath<'a> {
        let name = self.node().map_or("", |node| match &node.content {
            Content::Map(entries) => entries.first().map_or("", |(key, _)| key.name()),
            _ => node.name(),
        });
        self.key(name)
    }

    /// Creates the message for a fault at a known place.
    pub fn refuse_at(&self, place: Location, fault: Fault) -> StudyError {
        self.source.refuse_at(place, &self.path, fault)
    }

    /// Creates the message for a faulty value.
    pub fn refuse_value(&self, fault: Fault) -> StudyError {
        self.refuse_at(self.place(false), fault)
    }

    /// Creates the message for a faulty key.
    pub fn refuse_key(&self, fault: Fault) -> StudyError {
        self.refuse_at(self.place(true), fault)
    }

    /// Creates the message for a value: the problem, what was found, and what is allowed.
    pub(crate) fn wrong_value(
        &self,
        problem: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> StudyError {
        self.refuse_value(Fault::new(problem, found, allowed))
    }

    /// Creates the message for a key: the problem, what was found, and what is allowed.
    pub(crate) fn wrong_key(
        &self,
        problem: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> StudyError {
        self.refuse_key(Fault::new(problem, found, allowed))
    }

    /// Returns the place of the value or of its key, or of the deepest part of the path that the file contains.
    fn place(&self, of_key: bool) -> Location {
        let mut node = &self.source.root;
        let mut place = node.place;
        for step in &self.path.0 {
            let Some((key, value)) = node.below(step) else { return place };
            place = if of_key { key.place } else { value.place };
            node = value;
        }
        place
    }
}
