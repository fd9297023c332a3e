//! Reads the pictures of a system file.

use super::system::Reader;
use crate::model::{DrawnForm, Formula, WrittenShape, WrittenView};
use crate::study::error::{Fault, StudyError};
use crate::study::file::system_file::{PointEntry, ShapeEntry, SystemFile, ViewEntry};

/// The forms of shapes.
const FORMS: &str = "one of `circle`, `line`, `polygon`, `spring` and `mark`";

impl Reader<'_> {
    /// Reads a picture.
    pub(super) fn view(
        &self,
        name: &str,
        entry: &ViewEntry,
        file: &SystemFile,
    ) -> Result<WrittenView, StudyError> {
        if entry.turns && file.turning.is_empty() {
            let allowed = "the key `turning`, which names the angle of the part that turns";
            let problem = "a picture that turns without a part that turns";
            return Err(self.path(&["draw", name, "turns"]).wrong_value(problem, "true", allowed));
        }
        if entry.shapes.is_empty() {
            let fault = Fault::new("an empty picture", "no shapes", "at least one shape");
            return Err(self.path(&["draw", name, "shapes"]).refuse_value(fault));
        }
        let shapes = entry.shapes.iter().map(|(key, shape)| self.shape((name, key), shape, file));
        let shapes = shapes.collect::<Result<Vec<_>, StudyError>>()?;
        Ok(WrittenView { name: name.to_owned(), turns: entry.turns, shapes })
    }

    fn shape(
        &self,
        (view, key): (&str, &str),
        entry: &ShapeEntry,
        file: &SystemFile,
    ) -> Result<WrittenShape, StudyError> {
        let keys = ["draw", view, "shapes", key];
        let path = self.path(&keys);
        let (name, index) = self.indexed(&path, key, file)?;
        let ShapeEntry { circle, radius, line, polygon, spring, mark, contact } = entry;
        let point = |point: &Option<PointEntry>| point.iter().cloned().collect::<Vec<_>>();
        let points = |points: &Option<Vec<PointEntry>>| points.clone().unwrap_or_default();
        let given = [
            (DrawnForm::Circle, circle.is_some(), point(circle)),
            (DrawnForm::Line, line.is_some(), points(line)),
            (DrawnForm::Polygon, polygon.is_some(), points(polygon)),
            (DrawnForm::Spring, spring.is_some(), points(spring)),
            (DrawnForm::Mark, mark.is_some(), point(mark)),
        ];
        let given: Vec<_> = given.into_iter().filter(|(_, is_given, _)| *is_given).collect();
        let refuse = |problem: &str, found: String, allowed: &str| {
            Err(path.wrong_key(problem, &found, allowed))
        };
        let [(form, _, points)] = &given[..] else {
            return refuse("not one form of a shape", format!("{} forms", given.len()), FORMS);
        };
        let form = *form;
        if radius.is_some() != (form == DrawnForm::Circle) {
            let found = if radius.is_some() { "`radius` of another shape" } else { "no `radius`" };
            return refuse("a circle has a radius", found.to_owned(), "`circle` with `radius`");
        }
        let (number, allowed) = match form {
            DrawnForm::Line => (2..=usize::MAX, "at least 2 points"),
            DrawnForm::Polygon => (3..=usize::MAX, "at least 3 points"),
            DrawnForm::Spring => (2..=2, "2 points"),
            DrawnForm::Circle | DrawnForm::Mark => (1..=1, "1 point"),
        };
        if !number.contains(&points.len()) {
            return refuse("another number of points", points.len().to_string(), allowed);
        }
        if let Some(PointEntry(other)) = points.iter().find(|point| point.0.len() != 2) {
            let allowed = "[x, y]; a formula with a comma, [ or { needs quotation marks";
            return refuse("not a point", format!("{} values", other.len()), allowed);
        }
        if form == DrawnForm::Mark && contact.is_none() {
            let allowed = "`contact: ...`, which the mark shows";
            return refuse("a mark without a contact", "no `contact`".to_owned(), allowed);
        }
        let mut shape = WrittenShape { name, index, form, values: Vec::new(), contact: None };
        let texts = points.iter().flat_map(|point| &point.0).chain(radius);
        let values = texts.enumerate().map(|(number, text)| {
            let inner = shape.keys_of(number);
            let keys = keys.into_iter().chain(inner.iter().map(String::as_str));
            self.formula(&keys.collect::<Vec<_>>(), text)
        });
        shape.values = values.collect::<Result<Vec<Formula>, StudyError>>()?;
        let at_contact = [&keys[..], &["contact"]].concat();
        let contact = contact.as_ref().map(|text| self.place(&at_contact, text));
        shape.contact = contact.transpose()?;
        Ok(shape)
    }
}
