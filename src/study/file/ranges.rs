//! Ranges of swept values, such as `{from: 1000 rpm, to: 6000 rpm, count: 6}`: each becomes a list before the file is
//! decoded.

use crate::study::error::{Fault, Location, StudyError, list_names, shorten};
use crate::study::file::key_path::{KeyPath, Segment};
use crate::study::file::quantity::split_number;
use crate::study::file::source::Source;
use crate::study::file::table_folders::MAX_VALUES;
use crate::study::file::yaml_tree::{Content, YamlNode, describe_number};

const KEYS: [&str; 5] = ["from", "to", "count", "step", "spacing"];
const FORMS: &str = "{from: 1, to: 5, count: 9}, {from: 1, to: 5, step: 0.5}, \
                     {from: 1, to: 100, count: 5, spacing: logarithmic}, or a list";

/// Replaces the ranges under `grid` and `zip` by lists.
pub(in crate::study) fn expand_ranges(source: &mut Source) -> Result<(), StudyError> {
    let mut found: Result<(), (KeyPath, Wrong)> = Ok(());
    let mut left = MAX_VALUES;
    for (path, list) in lists(&mut source.root) {
        if let Content::Map(_) = list.content {
            match WrittenRange::read(list).and_then(|range| range.values(list, left)) {
                Err(wrong) => {
                    found = Err((path, wrong));
                    break;
                }
                Ok(values) => {
                    left -= values.len();
                    list.content = Content::List(values);
                }
            }
        }
    }
    found.map_err(|(mut path, (place, key, fault))| {
        path.0.extend(key.map(|key| Segment::Key(key.to_owned())));
        source.refuse_at(place, &path, fault)
    })
}

/// Returns the values of every parameter under `grid` and `zip`, with their paths.
fn lists(root: &mut YamlNode) -> Vec<(KeyPath, &mut YamlNode)> {
    let Some(Content::List(blocks)) = entry(root, "sweep").map(|sweep| &mut sweep.content) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for (index, block) in blocks.iter_mut().enumerate() {
        let Content::Map(parts) = &mut block.content else { continue };
        for (part, lists) in parts {
            let Content::Map(lists) = &mut lists.content else { continue };
            if !["grid", "zip"].contains(&part.name()) {
                continue;
            }
            for (parameter, list) in lists {
                let mut path = KeyPath::of("sweep");
                path.0.push(Segment::Item(index));
                path.0.push(Segment::Key(part.name().to_owned()));
                path.0.push(Segment::Key(parameter.name().to_owned()));
                all.push((path, list));
            }
        }
    }
    all
}

fn entry<'a>(node: &'a mut YamlNode, name: &str) -> Option<&'a mut YamlNode> {
    let Content::Map(entries) = &mut node.content else { return None };
    entries.iter_mut().find(|(key, _)| key.name() == name).map(|(_, value)| value)
}

/// A fault with its place and its key in the range.
type Wrong = (Location, Option<&'static str>, Fault);

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
    fn read(node: &YamlNode) -> Result<WrittenRange, Wrong> {
        let refuse = |key: Option<&'static str>, fault| {
            let place = key.and_then(|key| node.get(key)).map_or(node.place, |node| node.place);
            (place, key, fault)
        };
        if let Content::Map(entries) = &node.content
            && let Some((key, _)) = entries.iter().find(|(key, _)| !KEYS.contains(&key.name()))
        {
            let allowed = list_names(key.name(), &KEYS);
            let fault = Fault::new("unknown key of a range", shorten(key.name()), allowed);
            return Err((key.place, None, fault));
        }
        let missing = |key| refuse(Some(key), Fault::new("missing key", "no such key", FORMS));
        let number = |key| {
            let node = node.get(key).ok_or_else(|| missing(key))?;
            number(node).ok_or_else(|| {
                let fault = Fault::new("wrong type", node.describe(), "a number");
                refuse(Some(key), fault)
            })
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
            Err(refuse(Some(key), Fault::new(problem, found, allowed)))
        };
        same_unit("to", unit_of_to)?;
        let spacing = node.get("spacing").map(|spacing| match spacing.name() {
            "linear" => Ok(false),
            "logarithmic" => Ok(true),
            _ => {
                let fault = Fault::new("unknown choice", spacing.describe(), "linear, logarithmic");
                Err(refuse(Some("spacing"), fault))
            }
        });
        let logarithmic = spacing.transpose()?.unwrap_or(false);
        let steps = match (node.get("count"), node.get("step")) {
            (None, None) => return Err(missing("count")),
            (Some(_), Some(_)) => {
                let fault = Fault::new("both `count` and `step`", "both keys", "one of the two");
                return Err(refuse(Some("step"), fault));
            }
            (Some(count), None) => {
                let count = match count.content {
                    Content::Natural(count) if count >= 2 => usize::try_from(count).ok(),
                    _ => None,
                }
                .ok_or_else(|| {
                    let allowed = format!("a whole number from 2 to {MAX_VALUES}");
                    let fault = Fault::new("not a number of values", count.describe(), allowed);
                    refuse(Some("count"), fault)
                })?;
                if logarithmic { Steps::Logarithmic(count) } else { Steps::Linear(count) }
            }
            (None, Some(_)) if logarithmic => {
                let allowed = "`count` with `spacing: logarithmic`";
                let fault = Fault::new("a step between logarithmic values", "`step`", allowed);
                return Err(refuse(Some("step"), fault));
            }
            (None, Some(_)) => {
                let (step, unit_of_step) = number("step")?;
                same_unit("step", unit_of_step)?;
                if (to - from) * step <= 0.0 || step == 0.0 {
                    let found = format!(
                        "step {} from {} to {}",
                        describe_number(step),
                        describe_number(from),
                        describe_number(to)
                    );
                    let allowed = "a step that leads from `from` to `to`: positive upwards, negative downwards";
                    return Err(refuse(
                        Some("step"),
                        Fault::new("a step that does not arrive", found, allowed),
                    ));
                }
                Steps::By(step)
            }
        };
        if logarithmic && from * to <= 0.0 {
            let found = format!("from {} to {}", describe_number(from), describe_number(to));
            let allowed = "`from` and `to` both above 0, or both below 0";
            let fault = Fault::new("logarithmic values through 0", found, allowed);
            return Err(refuse(Some("spacing"), fault));
        }
        Ok(WrittenRange { from, to, steps, unit })
    }

    /// Returns the values, at most `most`, as nodes at the place of the range.
    fn values(&self, node: &YamlNode, most: usize) -> Result<Vec<YamlNode>, Wrong> {
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
            let found = format!("{count} values");
            let allowed = format!("at most {MAX_VALUES} values in all ranges");
            return Err((node.place, None, Fault::new("too many values", found, allowed)));
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
