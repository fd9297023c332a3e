//! Why a text is not the YAML of a study, with the line at fault and the remedy.
//!
//! The parser names the place where it can read no further, in its own terms. The faults that occur most are found here
//! in the lines around this place: a tab in the indentation, a missing space after a colon, and wrong indentation.

use std::path::Path;

use serde_saphyr::options::DuplicateKeyPolicy;

use super::key_path::{KeyPath, Segment};
use super::yaml_tree::{Content, MAX_DEPTH, MAX_NODES, YamlNode, parsed};
use crate::study::error::{Fault, Location, StudyError, shorten};

/// Creates the message for a text that cannot be parsed.
pub(super) fn reader_error(file: &Path, text: &str, error: &serde_saphyr::Error) -> StudyError {
    use serde_saphyr::Error;
    let mut place = error.location().map(|location| Location {
        line: usize::try_from(location.line()).unwrap_or(1).max(1),
        column: usize::try_from(location.column()).unwrap_or(1).max(1),
    });
    let mut key = String::new();
    let said = error.to_string();
    let said = shorten(said.split(" at line ").next().unwrap_or_default());
    let fault = match error {
        Error::DuplicateMappingKey { key: name, .. } => {
            let name = name.as_deref().unwrap_or_default();
            let twice = place.and_then(|place| first_of_two(text, place, name));
            let first = twice.as_ref().map(|(_, line)| format!("; the first is in line {line}"));
            key = twice.map_or_else(|| shorten(name), |(path, _)| path.to_string());
            let found = format!("a second value for the same key{}", first.unwrap_or_default());
            Fault::new("the key is given twice", found, "each key once")
        }
        Error::MultipleDocuments { .. } => {
            Fault::new("more than one YAML document", "a further document", "one study per file")
        }
        Error::MergeKeyNotAllowed { .. } => {
            Fault::new("merge keys are not supported", "<<", "every key written out")
        }
        _ if ["budget", "recursion limit", "alias replay", "alias expansion"]
            .iter()
            .any(|limit| said.contains(limit)) =>
        {
            let allowed = format!(
                "at most {MAX_NODES} values, {MAX_DEPTH} levels of nesting and few, small aliases"
            );
            Fault::new("too large or too deep a file, or too many aliases", said, allowed)
        }
        _ => {
            let cause = place.and_then(|place| cause(text, place.line, &said));
            let usual = || Fault::new("not valid YAML", said, "a study in YAML");
            let (at, fault) =
                cause.map_or_else(|| (place, usual()), |(at, fault)| (Some(at), fault));
            place = at;
            fault
        }
    };
    let line = place.and_then(|place| text.lines().nth(place.line - 1));
    StudyError::new(file, place, key, fault, line)
}

/// Returns the path of a key that is given twice, and the line where it is given first. `place` is that of the second
/// key.
fn first_of_two(text: &str, place: Location, name: &str) -> Option<(KeyPath, usize)> {
    // With another name, the second key has a place in the tree, beside the first key.
    let line_start: usize = text.split_inclusive('\n').take(place.line - 1).map(str::len).sum();
    let line = text.get(line_start..)?;
    let column = line.char_indices().nth(place.column - 1)?.0;
    let end = line_start + column + line.get(column..)?.find(name)? + name.len();
    let other_name = format!("{name}-given-twice");
    let renamed = format!("{}-given-twice{}", text.get(..end)?, text.get(end..)?);
    let root = parsed(&renamed, DuplicateKeyPolicy::FirstWins).ok()?;
    let (mut path, _) = root.find(&|node: &YamlNode| node.name() == other_name)?;
    path.0.pop();
    let mut map = &root;
    for step in &path.0 {
        map = map.below(step)?.1;
    }
    let Content::Map(entries) = &map.content else { return None };
    let (first, _) = entries.iter().find(|(key, _)| key.name() == name)?;
    path.0.push(Segment::Key(name.to_owned()));
    Some((path, first.place.line))
}

/// Finds the cause of a fault that the parser has met in a line, and its place.
fn cause(text: &str, line: usize, said: &str) -> Option<(Location, Fault)> {
    let all: Vec<&str> = text.lines().skip(line.saturating_sub(2)).take(4).collect();
    let first = line.saturating_sub(1).max(1);
    let numbered = || (first..).zip(all.iter().copied());
    let tabs = || numbered().find_map(|(line, text)| Some((line, tab(text)?)));
    if said.contains("tab")
        && let Some((line, column)) = tabs()
    {
        let allowed = "spaces for indentation; replace the tab by spaces";
        let fault = Fault::new("not valid YAML: a tab in the indentation", "a tab", allowed);
        return Some((Location { line, column }, fault));
    }
    let (_, here) = numbered().find(|(number, _)| *number == line)?;
    let before = text.lines().take(line - 1).filter(|text| is_content(text)).last();
    let lacks_space = numbered()
        .take_while(|(number, _)| *number <= line)
        .find_map(|(number, text)| Some((number, text, space_after_colon(text)?)));
    if let Some((line, text, remedy)) = lacks_space {
        let place = Location { line, column: indentation(text) + 1 };
        let problem = "not valid YAML: a space is missing after the colon";
        return Some((place, Fault::new(problem, shorten(text.trim()), shorten(&remedy))));
    }
    let place = Location { line, column: indentation(here) + 1 };
    let of_keys = ["did not find expected key", "mapping values are not allowed"];
    if !of_keys.iter().any(|words| said.contains(words)) {
        return None;
    }
    let before = before?;
    let (spaces, earlier) = (indentation(here), indentation(before));
    if spaces != earlier && here.matches(": ").count() < 2 {
        let found = format!("{spaces} spaces before the key, and {earlier} in the line before");
        let allowed =
            "the same indentation for all keys of a map, and more below a key that ends in a colon";
        return Some((place, Fault::new("not valid YAML: wrong indentation", found, allowed)));
    }
    let (_, value) = here.split_once(": ")?;
    value.contains(": ").then(|| {
        let allowed =
            "quotes around a text that contains `: `, or braces around keys, as in `{a: 1}`";
        let fault = Fault::new("not valid YAML: a second colon", shorten(value), allowed);
        (place, fault)
    })
}

/// Returns the column of the first tab in the indentation of a line.
fn tab(line: &str) -> Option<usize> {
    let mut blanks = line.chars().take_while(|character| character.is_whitespace());
    blanks.position(|character| character == '\t').map(|index| index + 1)
}

fn indentation(line: &str) -> usize {
    line.chars().take_while(|character| *character == ' ').count()
}

fn is_content(line: &str) -> bool {
    let line = line.trim_start();
    !line.is_empty() && !line.starts_with('#')
}

/// Returns the line with a space after its colon, if it is a key whose value follows the colon at once.
fn space_after_colon(line: &str) -> Option<String> {
    let line = line.trim();
    let (key, value) = line.split_once(':')?;
    let word = key.strip_prefix("- ").unwrap_or(key).trim_start();
    let is_key = word.starts_with(|character: char| character.is_ascii_alphabetic())
        && word.chars().all(|character| character.is_ascii_alphanumeric() || character == '_');
    let follows = value.starts_with(|next: char| !next.is_whitespace() && !":/".contains(next));
    (is_key && follows).then(|| format!("{key}: {value}"))
}
