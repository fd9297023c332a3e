//! What the results say, at the top of a page: the sentences of the terminal, and what changes the answer most.

use super::html::{Html, escaped};
use crate::analysis::RankCorrelation;
use crate::numbers::significant;
use crate::report::conclusion::Conclusion;
use crate::report::data::{DrawnRuns, PointFacts, ReportData};
use crate::report::optimum::OptimumData;
use crate::study::Unit;

/// The conclusion names no rank correlation that is smaller in size.
const LEAST_CORRELATION: f64 = 0.2;

/// Adds the conclusion of a study; nothing if there is none.
pub fn conclusion(body: &mut Html, data: &ReportData<'_>) {
    let mut conclusion = Conclusion::new(data.study);
    data.points.iter().for_each(|point| conclusion.add(data.study, point));
    let mut sentences = conclusion.sentences();
    let unit = data.amplitude_unit();
    sentences.extend(range(data, "The median amplitude", &unit, &|point| point.amplitude_m[1]));
    for (index, response) in data.study.responses().iter().enumerate() {
        let unit = response.shown_unit(data.study.units());
        let meaning = response.meaning_in(&data.study.units().vibration());
        let name = format!("The response {} ({meaning})", response.name);
        let value = |point: &PointFacts| point.responses.get(index)?.value;
        sentences.extend(range(data, &name, &unit, &value));
        let [only] = &data.points[..] else { continue };
        let without = only.responses_without_balls.get(index).copied().flatten();
        sentences.extend(without.map(|value| {
            format!(
                "Without balls, the response {} is {} {}.",
                response.name,
                significant(unit.of(value)),
                unit.symbol
            )
        }));
    }
    let influence = |of: &dyn Fn(&DrawnRuns, usize) -> Option<RankCorrelation>, what: &str| {
        strongest(data, of).map(|(name, point, found)| {
            let RankCorrelation { value, low, high } = found;
            let (at, the) = match data.point_count {
                1 => (String::new(), "The"),
                _ => (format!("At {point}, "), "the"),
            };
            let [value, low, high] = [value, low, high].map(signed);
            format!(
                "{at}{the} {what} has its strongest rank correlation with the uncertain parameter {name}: {value} (95 % interval \
                 {low} to {high})."
            )
        })
    };
    sentences.extend(influence(&|runs, index| runs.with_amplitude(index), "amplitude"));
    sentences.extend(influence(&|runs, index| runs.with_time_to_rest(index), "time to rest"));
    add(body, &sentences);
}

fn add(body: &mut Html, sentences: &[String]) {
    if sentences.is_empty() {
        return;
    }
    body.line("<section class=\"conclusion\" aria-labelledby=\"conclusion\"><h2 id=\"conclusion\">Conclusion</h2>");
    for sentence in sentences {
        // Every second part is a command in backticks.
        let parts = sentence.split('`').map(escaped).enumerate();
        let parts = parts.map(|(place, part)| match place % 2 {
            0 => part,
            _ => format!("<code>{part}</code>"),
        });
        body.line(&format!("<p>{}</p>", parts.collect::<String>()));
    }
    body.line("</section>");
}

fn signed(value: f64) -> String {
    format!("{value:.2}").replace('-', "\u{2212}")
}

/// Returns a sentence on a value, or on its least and its largest one over all points.
fn range(
    data: &ReportData<'_>,
    name: &str,
    unit: &Unit,
    value: &dyn Fn(&PointFacts) -> Option<f64>,
) -> Option<String> {
    let known = || data.points.iter().filter_map(|point| Some((point, value(point)?)));
    let least = known().min_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let most = known().max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let text = |value: f64| match unit.symbol.as_str() {
        "ratio" => significant(value),
        symbol => format!("{} {symbol}", significant(unit.of(value))),
    };
    let at = |(point, value): (&PointFacts, f64)| format!("{} ({})", text(value), point.title);
    Some(match least.1 < most.1 {
        true => format!("{name} is between {} and {}.", at(least), at(most)),
        false => format!("{name} is {}.", text(least.1)),
    })
}

/// Returns the uncertain parameter with the strongest rank correlation, whose interval excludes 0, with the point.
fn strongest(
    data: &ReportData<'_>,
    of: &dyn Fn(&DrawnRuns, usize) -> Option<RankCorrelation>,
) -> Option<(String, String, RankCorrelation)> {
    let title = |id: u64| {
        let point = data.points.iter().find(|point| point.point_id == id);
        point.map_or_else(String::new, |point| point.title.clone())
    };
    let each = data.study.uncertain().iter().enumerate().flat_map(|(index, parameter)| {
        let points = data.drawn.points.iter();
        points.filter_map(move |(id, runs)| Some((parameter, *id, of(runs, index)?)))
    });
    let sure = each.filter(|(_, _, found)| {
        found.value.abs() >= LEAST_CORRELATION && (found.low > 0.0 || found.high < 0.0)
    });
    let (parameter, id, found) =
        sure.max_by(|(.., left), (.., right)| left.value.abs().total_cmp(&right.value.abs()))?;
    Some((parameter.short_name().replace('_', " "), title(id), found))
}

/// Adds the conclusion of a search: the best design, what it achieves, and the variable that matters most.
pub fn conclusion_of_search(body: &mut Html, data: &OptimumData) {
    let mut sentences = Vec::new();
    if let Some(best) = data.design("best") {
        let values = data.study.variables().iter().filter_map(|variable| {
            let value = &best["values"][variable.name()];
            let text = match value.as_f64() {
                Some(number) => significant(variable.shown_number(number)),
                None => value.as_str()?.to_owned(),
            };
            let name = variable.short_name().replace('_', " ");
            Some(format!("{name} {text} {}", variable.shown_unit()).trim_end().to_owned())
        });
        let values: Vec<String> = values.collect();
        sentences.push(format!("The best design has {}.", values.join(", ")));
        for objective in &data.optimization.objectives {
            let (name, unit) = data.response(objective.response);
            let estimate = &best["responses"][name];
            let number = |key: &str| Some(significant(unit.of(estimate[key].as_f64()?)));
            let Some(value) = number("value") else { continue };
            let interval = match (number("low"), number("high")) {
                (Some(low), Some(high)) => format!(" (95 % interval {low} to {high})"),
                _ => String::new(),
            };
            let symbol = &unit.symbol;
            let value = format!("{value} {symbol}");
            sentences.push(format!(
                "The objective {name} of this design is {}{interval}.",
                value.trim_end()
            ));
        }
    }
    for objective in &data.optimization.objectives {
        let (name, _) = data.response(objective.response);
        if let Some((variable, total)) = data.largest_total(name) {
            sentences.push(format!(
                "Over the whole range of designs, {variable} has the largest total Sobol' index of {name}: {variable} and its \
                 interactions cause {:.0} % of the variance of {name}.",
                100.0 * total.clamp(0.0, 1.0)
            ));
        }
    }
    add(body, &sentences);
}
