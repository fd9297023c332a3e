//! A key path in a study file, at which faults are reported.

use crate::study::error::{Fault, Location, StudyError};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::yaml_tree::{Node, Source};

/// The path of a key or value in a study file, which need not be present there.
#[derive(Clone)]
pub(crate) struct SourcePath<'a> {
    source: &'a Source,
    path: KeyPath,
}

impl Source {
    /// Returns the path of the whole file.
    pub fn root_path(&self) -> SourcePath<'_> {
        SourcePath { source: self, path: KeyPath::default() }
    }

    /// Returns a path, such as `simulation.band`.
    pub fn path(&self, path: &str) -> SourcePath<'_> {
        SourcePath { source: self, path: KeyPath::of(path) }
    }
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
    pub fn node(&self) -> Option<&'a Node> {
        self.source.node(&self.path)
    }

    /// Creates the message for a faulty value.
    pub fn refuse_value(&self, fault: Fault) -> StudyError {
        self.source.refuse_at(self.place(false), &self.path, fault)
    }

    /// Creates the message for a faulty key.
    pub fn refuse_key(&self, fault: Fault) -> StudyError {
        self.source.refuse_at(self.place(true), &self.path, fault)
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
