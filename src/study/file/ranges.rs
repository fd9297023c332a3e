//! Ranges of swept values, such as `{from: 1000 rpm, to: 6000 rpm, count: 6}`: each becomes a list before the file is
//! decoded.

use crate::study::error::{Fault, StudyError, describe_number, from_to, list_names, shorten};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::quantity::split_number;
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::table_folders::MAX_VALUES;
use crate::study::file::yaml_tree::{Content, YamlNode};

const KEYS: [&str; 5] = ["from", "to", "count", "step", "spacing"];
const FORMS: &str = "{from: 1, to: 5, count: 9}, {from: 1, to: 5, step: 0.5}, \
                     {from: 1, to: 100, count: 5, spacing: logarithmic}, or a list";

/// Replaces the ranges under `grid` and `zip` by lists.
pub(in crate::study) fn expand_ranges(source: &mut Source) -> Result<(), StudyError> {
    let mut left = MAX_VALUES;
    for path in ranges(&source.root) {
        let range = source.at(path.clone());
        let Some(node) = range.node() else { continue };
        let values = WrittenRange::read(&range, node)?.values(&range, node, left)?;
        left -= values.len();
        if let Some(node) = source.root.at_mut(&path.0) {
            node.content = Content::List(values);
        }
    }
    Ok(())
}

/// Returns the paths of the ranges under `grid` and `zip`.
fn ranges(root: &YamlNode) -> Vec<KeyPath> {
    let Some(Content::List(blocks)) = root.get("sweep").map(|sweep| &sweep.content) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for (index, block) in blocks.iter().enumerate() {
        let Content::Map(parts) = &block.content else { continue };
        for (part, lists) in parts.iter().filter(|(part, _)| ["grid", "zip"].contains(&part.name()))
        {
            let Content::Map(lists) = &lists.content else { continue };
            let ranges = lists.iter().filter(|(_, list)| matches!(list.content, Content::Map(_)));
            all.extend(ranges.map(|(parameter, _)| {
                let [sweep, part, parameter] = ["sweep", part.name(), parameter.name()]
                    .map(|name| Segment::Key(name.to_owned()));
                KeyPath(vec![sweep, Segment::Item(index), part, parameter])
            }));
        }
    }
    all
}

/// A range as it is written; its numbers are in its unit.
struct WrittenRange {
    from: f64,
    to: f64,
    steps: Steps,
    /// The unit of all numbers, empty for plain numbers.
    unit: String,
}

enum Steps {
    Linear(usize),
    Logarithmic(usize),
    By(f64),
}

impl WrittenRange {
    fn read(path: &SourcePath<'_>, node: &YamlNode) -> Result<WrittenRange, StudyError> {
        if let Content::Map(entries) = &node.content
            && let Some((key, _)) = entries.iter().find(|(key, _)| !KEYS.contains(&key.name()))
        {
            let allowed = list_names(key.name(), &KEYS);
            let fault = Fault::new("unknown key of a range", shorten(key.name()), allowed);
            return Err(path.refuse_at(key.place, fault));
        }
        let missing = |key| path.key(key).wrong_value("missing key", "no such key", FORMS);
        let number = |key| {
            let node = node.get(key).ok_or_else(|| missing(key))?;
            let wrong = || path.key(key).wrong_value("wrong type", node.describe(), "a number");
            number(node).ok_or_else(wrong)
        };
        let (from, unit) = number("from")?;
        let (to, unit_of_to) = number("to")?;
        let same_unit = |key, other: String| {
            if other == unit {
                return Ok(());
            }
            let [found, allowed] = [&other, &unit].map(|unit| match unit.as_str() {
                "" => "a number without a unit".to_owned(),
                unit => format!("a value in {}", shorten(unit)),
            });
            let problem = "another unit than that of `from`";
            Err(path.key(key).wrong_value(problem, found, allowed))
        };
        same_unit("to", unit_of_to)?;
        let logarithmic = match node.get("spacing") {
            None => false,
            Some(spacing) => match spacing.name() {
                "linear" => false,
                "logarithmic" => true,
                _ => {
                    let (found, allowed) = (spacing.describe(), "linear, logarithmic");
                    return Err(path.key("spacing").wrong_value("unknown choice", found, allowed));
                }
            },
        };
        let step_path = path.key("step");
        let steps = match (node.get("count"), node.get("step")) {
            (None, None) => return Err(missing("count")),
            (Some(_), Some(_)) => {
                let problem = "both `count` and `step`";
                return Err(step_path.wrong_value(problem, "both keys", "one of the two"));
            }
            (Some(count), None) => {
                let number = match count.content {
                    Content::Natural(count) if count >= 2 => usize::try_from(count).ok(),
                    _ => None,
                };
                let number = number.ok_or_else(|| {
                    let allowed = format!("a whole number from 2 to {MAX_VALUES}");
                    let found = count.describe();
                    path.key("count").wrong_value("not a number of values", found, allowed)
                })?;
                if logarithmic { Steps::Logarithmic(number) } else { Steps::Linear(number) }
            }
            (None, Some(_)) if logarithmic => {
                let problem = "a step between logarithmic values";
                let allowed = "`count` with `spacing: logarithmic`";
                return Err(step_path.wrong_value(problem, "`step`", allowed));
            }
            (None, Some(_)) => {
                let (step, unit_of_step) = number("step")?;
                same_unit("step", unit_of_step)?;
                if (to - from) * step <= 0.0 || step == 0.0 {
                    let found = format!("step {} {}", describe_number(step), from_to(from, to));
                    let allowed = "a step that leads from `from` to `to`: positive upwards, negative downwards";
                    return Err(step_path.wrong_value(
                        "a step that does not arrive",
                        found,
                        allowed,
                    ));
                }
                Steps::By(step)
            }
        };
        if logarithmic && from * to <= 0.0 {
            let problem = "logarithmic values through 0";
            let allowed = "`from` and `to` both above 0, or both below 0";
            return Err(path.key("spacing").wrong_value(problem, from_to(from, to), allowed));
        }
        Ok(WrittenRange { from, to, steps, unit })
    }

    /// Returns the values, at most `most`, as nodes at the place of the range.
    fn values(
        &self,
        path: &SourcePath<'_>,
        node: &YamlNode,
        most: usize,
    ) -> Result<Vec<YamlNode>, StudyError> {
        let WrittenRange { from, to, .. } = *self;
        let (count, arrives) = match self.steps {
            Steps::Linear(count) | Steps::Logarithmic(count) => (count, true),
            Steps::By(step) => {
                let steps = (to - from) / step;
                // Rounding must not lose the last value.
                let arrives = (steps - steps.round()).abs() <= 1.0e-9 * steps;
                let whole = if arrives { steps.round() } else { steps.floor() };
                // A float as an index saturates.
                (whole as usize + usize::from(whole < usize::MAX as f64), arrives)
            }
        };
        if count > most {
            let allowed = format!("at most {MAX_VALUES} values in all ranges");
            return Err(path.wrong_value("too many values", format!("{count} values"), allowed));
        }
        let last = count - 1;
        let item = |index: usize| {
            let number = match self.steps {
                _ if index == 0 => from,
                _ if index == last && arrives => to,
                Steps::Logarithmic(_) => {
                    let part = index as f64 / last as f64;
                    let size = libm::pow(from.abs(), 1.0 - part) * libm::pow(to.abs(), part);
                    rounded(size.copysign(from))
                }
                Steps::By(step) if !arrives => rounded(from + step * index as f64),
                Steps::Linear(_) | Steps::By(_) => {
                    let part = index as f64 / last as f64;
                    rounded(from * (1.0 - part) + to * part)
                }
            };
            let content = match self.unit.as_str() {
                "" => Content::Number(number),
                unit => Content::Text(format!("{number:e} {unit}")),
            };
            YamlNode { place: node.place, content }
        };
        Ok((0..count).map(item).collect())
    }
}

/// Returns the number and the unit of a value.
fn number(node: &YamlNode) -> Option<(f64, String)> {
    match &node.content {
        Content::Natural(number) => Some((*number as f64, String::new())),
        Content::Number(number) => Some((*number, String::new())),
        Content::Text(text) => {
            let (number, unit) = split_number(text).filter(|(_, unit)| !unit.is_empty())?;
            let number = number.parse().ok().filter(|number: &f64| number.is_finite())?;
            Some((number, unit.to_owned()))
        }
        _ => None,
    }
}

/// Rounds to 15 digits, so that the values between 0 and 1 in steps of 0.1 are 0.3 and not 0.30000000000000004.
fn rounded(number: f64) -> f64 {
    format!("{number:.14e}").parse().unwrap_or(number)
}
