//! All warnings about a study.

use indexmap::IndexMap;

use super::ball_fit::BallPositions;
use super::conditions::{held_everywhere, models, subcritical};
use super::designs::{ExaminedDesign, described, points_to_examine};
use super::values::{findings, has_room};
use super::warning::{Finding, Warning};
use crate::analysis::Measure;
use crate::model::{BALL_BALANCER, InvalidParameter, Machine, Model};
use crate::numbers::{describe_number, short};
use crate::optimize::Space;
use crate::study::{AmplitudeKind, ListedParameter, ParameterValue, Response, Study};

/// The number of points above which fewer designs are examined.
const MANY_POINTS: u64 = 50;
/// The number of runs whose draws are examined.
const DRAWS: u64 = 1000;
/// The smallest fraction of invalid draws that is a warning.
const INVALID_DRAWS: f64 = 0.01;
/// The number of designs whose geometry is examined, and of large sweeps.
const DESIGNS: [u32; 2] = [256, 16];

/// Returns the warnings about a study, in the order of their keys' importance. The values of uncertain parameters are
/// their medians. Of a large sweep, at most 50 points are examined. The values of a study with variables are those of
/// its [`ExaminedDesign`].
pub fn warnings(study: &Study) -> Vec<Warning> {
    let design = ExaminedDesign::of(study);
    let design = design.as_ref();
    let mut found = of_points(design.map_or(study, |design| &design.study), design);
    found.extend(subcritical(study, design));
    found.extend(held_everywhere(study, design));
    found.extend(of_designs(study));
    found.extend(overridden(study));
    found.extend(mostly_defaults(study));
    found.extend(invalid_draws(design.map_or(study, |design| &design.study)));
    found.extend(repeated_points(study));
    found.extend(distant_limits(study));
    found.into_iter().map(|finding| finding.in_file(study)).collect()
}

/// Returns the findings about the values at the points, one for each kind and key.
fn of_points(study: &Study, design: Option<&ExaminedDesign>) -> Vec<Finding> {
    let models = models(study);
    let positions = match study.model().balls() {
        0 | 1 => None,
        _ => Some(BallPositions::new(study.numbers_of_balls())),
    };
    let mut all: IndexMap<(&str, String), (Finding, usize)> = IndexMap::new();
    for (point_id, model) in &models {
        for finding in findings(study, *point_id, model, positions.as_ref()) {
            let known = (finding.kind, finding.key.clone());
            all.entry(known).or_insert((finding, 0)).1 += 1;
        }
    }
    let with_count = |(finding, count): (Finding, usize)| {
        let mut found = finding.found;
        if models.len() > 1 {
            found += &format!("; at {count} of {} points", models.len());
        }
        if let Some(design) = design {
            found += &format!("; at {}", design.name);
        }
        Finding { found, ..finding }
    };
    all.into_values().map(with_count).collect()
}

/// Warns of designs whose balls have no room in the ring.
fn of_designs(study: &Study) -> Option<Finding> {
    let variables = study.variables();
    if variables.is_empty() || study.model().ball_balancer().is_none() {
        return None;
    }
    let space = Space::new(study);
    let designs = DESIGNS[usize::from(study.point_count() > MANY_POINTS)];
    let (mut examined, mut without_room, mut example) = (0_u32, 0_u32, None);
    for index in 0..designs {
        let values = space.space_filling(index, 0);
        // A design with impossible values has an error of its own in `evaluate`.
        let Ok(design) = study.set(&values) else { continue };
        let Ok(model) = design.median_model(0) else { continue };
        let Some(machine) = model.ball_balancer() else { continue };
        examined += 1;
        if !has_room(machine) {
            without_room += 1;
            example.get_or_insert_with(|| described(study, &values));
        }
    }
    Some(Finding {
        kind: "designs_without_room",
        key: "design".to_owned(),
        problem: "the balls of some designs do not fit side by side into the ring".to_owned(),
        found: format!("{without_room} of {examined} designs, such as {}", example?),
        remedy: "fewer or smaller balls, or a larger ring_radius_m".to_owned(),
    })
}

/// Parameters of the body of a ball balancer. The number of balls, the speed and friction are its operating
/// conditions, which a study of the default machine may well change.
const BODY: [&str; 8] = [
    "table_mass_kg",
    "stiffness_n_m",
    "damping_n_s_m",
    "ring_radius_m",
    "imbalance_mass_kg",
    "imbalance_radius_m",
    "ball_mass_kg",
    "ball_diameter_m",
];

/// Warns of a machine that is a mixture: some values of its body are the study's own, but most are those of the
/// default machine.
fn mostly_defaults(study: &Study) -> Option<Finding> {
    let listed = study.parameters();
    let body = |wanted: bool| -> Vec<&ListedParameter> {
        let is_left = |entry: &ListedParameter| entry.is_default && !entry.is_varied();
        let named = listed.iter().filter(|entry| BODY.contains(&entry.name.as_str()));
        named.filter(|entry| is_left(entry) == wanted).collect()
    };
    let (left, given) = (body(true), body(false));
    let mut machine = Model::from(Machine::default());
    let mut default = |name: &str| {
        let parameter = BALL_BALANCER.parameters.iter().find(|parameter| parameter.name == name)?;
        let number = parameter.numbers(&mut machine, Some(1)).into_iter().next()?;
        Some(ParameterValue::Number(*number))
    };
    let differs =
        |entry: &&&ListedParameter| !entry.is_default && Some(entry.value) != default(&entry.name);
    let chosen: Vec<&str> = given.iter().filter(differs).map(|entry| entry.name.as_str()).collect();
    if chosen.is_empty() || 2 * left.len() <= BODY.len() {
        return None;
    }
    let names: Vec<&str> = left.iter().map(|entry| entry.name.as_str()).collect();
    Some(Finding {
        kind: "mostly_defaults",
        key: "model.parameters".to_owned(),
        problem:
            "the machine is a mixture of own values and of the default machine, a CD-ROM drive"
                .to_owned(),
        found: format!("own values of {}; defaults of {}", chosen.join(", "), names.join(", ")),
        remedy: "a value for each of these parameters; if a default is meant, write it down"
            .to_owned(),
    })
}

/// Warns of values of `model.parameters` without effect, because the sweep sets others at all points, or a distribution in
/// all runs.
fn overridden(study: &Study) -> Vec<Finding> {
    let finding = |entry: ListedParameter| {
        let swept = entry.swept.filter(|swept| swept.overrides);
        let drawn = entry.uncertain.and_then(|drawn| Some((drawn.overridden?, drawn.range)));
        let (base, values, sets, place) = match (swept, drawn) {
            (Some(swept), _) => {
                (entry.value, swept.range, "sweep sets this parameter at every point", "sweep")
            }
            (None, Some((base, range))) => {
                (base, Some(range), "distribution sets this parameter in every run", "distribution")
            }
            (None, None) => return None,
        };
        let values = match values {
            Some([low, high]) if low < high => format!("{} to {}", short(low), short(high)),
            Some([only, _]) => short(only),
            None => "another word".to_owned(),
        };
        let value = match base {
            ParameterValue::Number(number) => short(number),
            ParameterValue::Text(word) => word.to_owned(),
        };
        let general = &entry.name;
        let key = ["model.parameters", "model"].map(|path| format!("{path}.{general}"));
        let key = key.into_iter().find(|key| study.has_key(key))?;
        Some(Finding {
            kind: "overridden_value",
            key,
            problem: format!("the value has no effect, because the {sets}"),
            found: format!("{value}; the {place} has {values}"),
            remedy: format!("this value in the {place}, or only one of both keys"),
        })
    };
    study.parameters().into_iter().filter_map(finding).collect()
}

/// Warns of distributions whose draws are often impossible values. The draws are those of the study's own runs.
fn invalid_draws(study: &Study) -> Option<Finding> {
    if study.uncertain().is_empty() {
        return None;
    }
    let runs = points_to_examine(study.run_count(), DRAWS);
    let invalid: Vec<InvalidParameter> =
        runs.iter().filter_map(|run| study.planned_run(*run).case.err()).collect();
    let first = invalid.first()?;
    if (invalid.len() as f64) < INVALID_DRAWS * runs.len() as f64 {
        return None;
    }
    let drawn = |name: &str| study.uncertain().iter().any(|column| column.name == name);
    // The validation names one ball; the distribution may be that of all balls.
    let parts = first.name.split('_').filter(|part| part.parse::<usize>().is_err());
    let general = parts.collect::<Vec<_>>().join("_");
    let name = [first.name.clone(), general].into_iter().find(|name| drawn(name));
    let key = name.map_or_else(|| "uncertain".to_owned(), |name| format!("uncertain.{name}"));
    Some(Finding {
        kind: "invalid_draws",
        key,
        problem: "many draws are impossible values, and their runs fail".to_owned(),
        found: format!(
            "{} of {} runs, such as {} {}",
            invalid.len(),
            runs.len(),
            first.name,
            first.found.parse().map_or_else(|_| first.found.clone(), short)
        ),
        remedy: format!(
            "a distribution within the possible values ({}), such as truncated_normal or lognormal",
            first.allowed
        ),
    })
}

/// Warns of an amplitude limit above the radius of the ring, for example a limit in µm that is written as a number.
fn distant_limits(study: &Study) -> Vec<Finding> {
    let Some(machine) = study.model().ball_balancer() else { return Vec::new() };
    let radius_m = machine.ring_radius_m;
    let (unit, radius) = (study.units().vibration(), study.units().shown("ring_radius_m"));
    let far = |response: &Response| match response.measure {
        Measure::Above(limit) if response.amplitude != AmplitudeKind::RelativeResidual => {
            (limit > radius_m).then(|| Finding {
                kind: "limit",
                key: format!("responses.{}.amplitude_above.limit", response.name),
                problem: "the limit of an amplitude is above the radius of the ring".to_owned(),
                found: format!(
                    "a limit of {} {}, and a ring with a radius of {} {}",
                    describe_number(unit.of(limit)),
                    unit.symbol,
                    short(radius.of(radius_m)),
                    radius.symbol
                ),
                remedy: "a limit in m, or with a unit, such as 20 µm".to_owned(),
            })
        }
        _ => None,
    };
    study.responses().iter().filter_map(far).collect()
}

/// Warns of points that the sweep lists twice.
fn repeated_points(study: &Study) -> Option<Finding> {
    let repeated = study.repeated_points()?;
    let [later, earlier] = repeated.first;
    let point = study.point(later);
    let values: Vec<String> = study
        .swept()
        .iter()
        .zip(&point.swept)
        .map(|(column, value)| format!("{} {value}", column.name))
        .collect();
    let times = match repeated.count {
        1 => String::new(),
        count => format!("; {count} points repeat an earlier one"),
    };
    Some(Finding {
        kind: "repeated_point",
        key: repeated.key,
        problem: "a point is given twice, with the same start states and draws".to_owned(),
        found: format!("point {later} equals point {earlier} ({}){times}", values.join(", ")),
        remedy: "each point once".to_owned(),
    })
}
