//! Resolution of the blocks of a sweep.

use indexmap::IndexMap;

use crate::model::{MAX_BALLS, Model, NormalForce};
use crate::study::error::{Fault, StudyError, describe_number, list_names, shorten};
use crate::study::file::key_units::list_keys;
use crate::study::file::parameters_file::BALLS;
use crate::study::file::source::SourcePath;
use crate::study::file::study_file::BlockFile;
use crate::study::file::table_input::Rows;
use crate::study::file::values::{Entry, InlineTable, TableKey};
use crate::study::plan::base::Base;
use crate::study::plan::parameter::{Parameter, ParameterValue, check_number_of_balls};
use crate::study::plan::sweep::Listing;
use crate::study::resolve::model::find_count;

/// A swept parameter with its values.
pub(crate) type SweptColumn = (Parameter, Vec<ParameterValue>);

/// The swept parameters and values of a block, and the block in the form of a self-contained study
/// file.
pub(crate) struct ResolvedBlock {
    /// How the points are listed.
    pub listing: Listing,
    /// Parameters with their values.
    pub columns: Vec<SweptColumn>,
    /// The block with inline tables, without its design.
    pub file: BlockFile,
}

/// Validates a block.
///
/// # Errors
/// Returns an error unless the block has exactly one of `grid`, `zip` and `table`; also if a
/// parameter is unknown, a value is impossible, a list is empty, the lists of a zip differ in
/// length, or the table is invalid.
pub(crate) fn resolve_block(
    path: &SourcePath<'_>,
    written: &BlockFile,
    base: &Base,
) -> Result<ResolvedBlock, StudyError> {
    match (&written.grid, &written.zip, &written.table) {
        (Some(lists), None, None) => {
            let columns = resolve_lists(&path.key("grid"), lists, base)?;
            let file = BlockFile { grid: Some(lists.clone()), ..BlockFile::default() };
            Ok(ResolvedBlock { listing: Listing::Grid, columns, file })
        }
        (None, Some(lists), None) => {
            let path = path.key("zip");
            let columns = resolve_lists(&path, lists, base)?;
            check_equal_lengths(&path, lists)?;
            let file = BlockFile { zip: Some(lists.clone()), ..BlockFile::default() };
            Ok(ResolvedBlock { listing: Listing::Zip, columns, file })
        }
        (None, None, Some(table)) => resolve_table(&path.key("table"), table, base),
        (grid, zip, table) => {
            let given = [("grid", grid.is_some()), ("zip", zip.is_some())];
            let given = given.into_iter().chain([("table", table.is_some())]);
            let names: Vec<&str> =
                given.filter_map(|(name, given)| given.then_some(name)).collect();
            let found = if names.is_empty() { "none of them".into() } else { names.join(", ") };
            let allowed = "exactly one of grid, zip, table";
            Err(path.wrong_value("not a block of a sweep", found, allowed))
        }
    }
}

fn resolve_lists(
    path: &SourcePath<'_>,
    lists: &IndexMap<String, Vec<Entry>>,
    base: &Base,
) -> Result<Vec<SweptColumn>, StudyError> {
    if lists.is_empty() {
        return Err(path.wrong_value("nothing is swept", "no parameter", "at least one parameter"));
    }
    let base = &with_listed_balls(base, lists.get(BALLS).into_iter().flatten());
    let column = |(name, list): (&String, &Vec<Entry>)| {
        let path = path.key(name);
        let refuse = |index: Option<usize>, fault| match index {
            Some(index) => path.item(index).refuse_value(fault),
            None => path.refuse_key(fault),
        };
        let column = resolve_column(name, list.iter(), base, refuse)?;
        if list.is_empty() {
            let (found, allowed) = ("an empty list", "at least one value");
            return Err(path.wrong_value("no values to sweep", found, allowed));
        }
        Ok(column)
    };
    lists.iter().map(column).collect()
}

/// Returns the parameter of this name with its values; `refuse` creates the message for the name, or for the value at an index.
fn resolve_column<'a>(
    name: &str,
    entries: impl Iterator<Item = &'a Entry>,
    base: &Base,
    refuse: impl Fn(Option<usize>, Fault) -> StudyError,
) -> Result<SweptColumn, StudyError> {
    let parameter = find_swept(name, base).map_err(|fault| refuse(None, fault))?;
    let value = |(index, entry)| {
        resolve_value(parameter, entry, &base.model).map_err(|fault| refuse(Some(index), fault))
    };
    Ok((parameter, entries.enumerate().map(value).collect::<Result<_, _>>()?))
}

/// Returns the base with the largest number of balls in a list. Other values have their own errors.
fn with_listed_balls<'a>(base: &Base, listed: impl Iterator<Item = &'a Entry>) -> Base {
    let number = |entry: &Entry| match entry {
        Entry::Number(number) => check_number_of_balls(*number).ok().map(|()| *number as usize),
        Entry::Text(_) => None,
    };
    let most = listed.filter_map(number).max();
    most.map_or_else(|| base.clone(), |most| base.with_balls([most; 2]))
}

fn check_equal_lengths(
    path: &SourcePath<'_>,
    lists: &IndexMap<String, Vec<Entry>>,
) -> Result<(), StudyError> {
    let Some((_, first)) = lists.first() else { return Ok(()) };
    match lists.iter().find(|(_, list)| list.len() != first.len()) {
        None => Ok(()),
        Some((name, _)) => {
            let lengths: Vec<String> =
                lists.iter().map(|(name, list)| format!("{name} {}", list.len())).collect();
            let found = format!("numbers of values: {}", lengths.join(", "));
            let allowed =
                "equally many values for every parameter (or `grid` for all combinations)";
            Err(path.key(name).wrong_value("unequal lengths in a zip", found, allowed))
        }
    }
}

fn resolve_table(
    path: &SourcePath<'_>,
    table: &TableKey,
    base: &Base,
) -> Result<ResolvedBlock, StudyError> {
    let read = Rows::read(path, table, &names_of_columns(base))?;
    let place = read.column(BALLS);
    let listed = read.rows.iter().filter_map(|row| row.get(place?));
    let base = &with_listed_balls(base, listed);
    let column = |(column, name): (usize, &String)| {
        let entries = read.rows.iter().filter_map(|row| row.get(column));
        resolve_column(name, entries, base, |row, fault| read.refuse(row, Some(column), fault))
    };
    let columns = read.columns.iter().enumerate().map(column).collect::<Result<_, _>>()?;
    let inline = InlineTable { columns: read.columns, rows: read.rows };
    let file = BlockFile { table: Some(TableKey::Inline(inline)), ..BlockFile::default() };
    Ok(ResolvedBlock { listing: Listing::Table, columns, file })
}

/// Returns the names that the columns of a table may have.
fn names_of_columns(base: &Base) -> Vec<String> {
    let has_balls = base.model.ball_balancer().is_some();
    // A table that sweeps the number of balls may have values of more balls than the study file.
    let widest = base.with_balls([MAX_BALLS; 2]);
    let mut names: Vec<String> =
        Parameter::all(&widest.model).into_iter().map(Parameter::name).collect();
    names.extend(has_balls.then(|| BALLS.to_owned()));
    names
}

/// Returns the parameter of this name, if it may be swept.
fn find_swept(name: &str, base: &Base) -> Result<Parameter, Fault> {
    let has_balls = base.model.ball_balancer().is_some();
    if name == BALLS && has_balls {
        return base.check_number_varies().map(|()| Parameter::BALLS);
    }
    let further = if has_balls { &[BALLS][..] } else { &[] };
    let parameter = Parameter::find(name, &base.model)
        .ok_or_else(|| unknown_parameter(name, &base.model, further))?;
    base.check_varied(parameter)?;
    Ok(parameter)
}

/// Returns the parameter of this name.
pub(crate) fn find_parameter(name: &str, model: &Model) -> Result<Parameter, Fault> {
    Parameter::find(name, model).ok_or_else(|| unknown_parameter(name, model, &[]))
}

/// Returns the fault of a name that is neither that of a parameter of the model nor one of `further`.
fn unknown_parameter(name: &str, model: &Model, further: &[&str]) -> Fault {
    if find_count(model.kind(), name).is_some() {
        let allowed = "one study per number (start box and columns depend on the number)";
        return Fault::new("the same for all runs of a study", name, allowed);
    }
    let mut names: Vec<String> = Parameter::all(model).into_iter().map(Parameter::name).collect();
    names.extend(further.iter().map(|name| (*name).to_owned()));
    let kind = model.kind().name;
    let problem = format!("not a parameter of {kind} with {} friction", model.friction().name());
    Fault::new(problem, shorten(name), list_keys(name, &names))
}

/// Returns the validated value of a parameter.
pub(crate) fn resolve_value(
    parameter: Parameter,
    entry: &Entry,
    form: &Model,
) -> Result<ParameterValue, Fault> {
    let names = || NormalForce::ALL.iter().map(|force| force.name()).collect::<Vec<_>>();
    match (entry, parameter.is_number()) {
        (Entry::Number(number), true) => {
            parameter.check(*number, form).map(|()| ParameterValue::Number(*number))
        }
        (Entry::Text(text), true) => {
            Err(Fault::new("not a number", format!("text {:?}", shorten(text)), "a number"))
        }
        (Entry::Text(text), false) => match names().into_iter().find(|name| name == text) {
            Some(name) => Ok(ParameterValue::Text(name)),
            None => Err(Fault::new("unknown choice", shorten(text), list_names(text, &names()))),
        },
        (Entry::Number(number), false) => {
            Err(Fault::new("wrong type", describe_number(*number), names().join(", ")))
        }
    }
}
