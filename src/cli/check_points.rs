//! The closed forms at the points of a sweep for `check`, as a table and as JSON.

use serde_json::{Value, json};

use super::check_legend::legend;
use crate::analysis::{Balance, Stability};
use crate::check::{
    BalancerFacts, BallPositions, ExaminedDesign, OwnFacts, RestFacts, SteadySliding, SteadyStates,
    points_to_examine,
};
use crate::model::{DerivedQuantity, NaturalFrequencies};
use crate::numbers::short;
use crate::printed_table::{PrintedTable, as_text};
use crate::responses::{design_json, merged, point_keys};
use crate::study::{Point, Study, Units, VariedParameter, short_name};

/// The closed forms at some points of a sweep, with uncertain parameters at their medians.
pub(super) struct ClosedForms {
    swept: Vec<VariedParameter>,
    units: Units,
    /// The number of points of the sweep.
    points: u64,
    /// Whether any parameter is uncertain.
    uncertain: bool,
    /// The design whose machine is described, in words and as JSON.
    design: Option<(String, Value)>,
    at: Vec<(Point, Facts)>,
    /// The values of the swept parameters of each of these points.
    shown: Vec<Vec<String>>,
}

enum Facts {
    /// The facts, and the positions of rest with friction at its quantiles 0.025 and 0.975 if friction is uncertain.
    Balancer(Box<BalancerFacts>, Option<[RestFacts; 2]>),
    Own(Box<OwnFacts>),
}

/// Returns whether a parameter of this name is a friction coefficient.
fn is_friction(name: &str) -> bool {
    name.contains("friction_coefficient")
}

impl ClosedForms {
    /// Computes the closed forms at no more than `most` points, spread evenly over the sweep. Points at which the
    /// medians are impossible values are left out.
    /// Of a study with variables, the machine is that of `design`.
    pub(super) fn of(study: &Study, design: Option<&ExaminedDesign>, most: u64) -> Self {
        let study = design.map_or(study, |design| &design.study);
        let positions = BallPositions::new(study.numbers_of_balls());
        let facts = |point_id: u64| {
            let (point, model) = (study.point(point_id), study.median_model(point_id).ok()?);
            let facts = if let Some(machine) = model.ball_balancer() {
                let facts = BalancerFacts::of(machine, &positions)?;
                Facts::Balancer(Box::new(facts), friction_range(study, point_id, &positions))
            } else {
                Facts::Own(Box::new(OwnFacts::of(&model, &point.start_ranges)?))
            };
            Some((point, facts))
        };
        let points = points_to_examine(study.point_count(), most);
        let at: Vec<(Point, Facts)> = points.into_iter().filter_map(facts).collect();
        ClosedForms {
            swept: study.swept().to_vec(),
            units: study.units().clone(),
            points: study.point_count(),
            uncertain: !study.uncertain().is_empty(),
            design: design
                .map(|design| (design.words(), design_json(&design.study, &design.values))),
            shown: at.iter().map(|(point, _)| study.shown(&point.swept)).collect(),
            at,
        }
    }

    /// Returns the facts as lines of text.
    pub(super) fn text(&self) -> String {
        let mut text = "without simulation".to_owned();
        if self.uncertain {
            text += ", with uncertain parameters at their medians";
        }
        if (self.at.len() as u64) < self.points {
            text += &format!(", at {} of {} points", self.at.len(), self.points);
        }
        text += "\n";
        if let Some((words, _)) = &self.design {
            text += &format!("the design is {words}\n");
        }
        let balancers: Vec<(u64, &BalancerFacts)> = self.at.iter().filter_map(balancer).collect();
        let mut table = PrintedTable::new(&self.at, "-");
        table.add_point(|(point, _)| point.point_id, &self.swept, &self.shown);
        let speed = self.units.speed();
        let in_unit = |all: &[f64]| {
            let shown = all.iter().map(|one| format!("{:.2}", speed.of(*one)));
            (!all.is_empty()).then(|| shown.collect::<Vec<_>>().join(", "))
        };
        let symbol = &speed.symbol;
        let has_two = self.at.iter().any(|(_, facts)| facts.has_two_kinds_of_frequencies());
        let held = if has_two { "held, natural" } else { "natural" };
        table.add_if_any(format!("{held} [{symbol}]"), |(_, facts)| {
            in_unit(facts.natural_frequencies().first_rad_s())
        });
        if has_two {
            table.add_known(format!("sliding, natural [{symbol}]"), |(_, facts)| {
                in_unit(facts.natural_frequencies().free_rad_s.as_ref()?)
            });
        }
        table.add_if_any(format!("critical [{symbol}]"), |(_, facts)| {
            in_unit(&facts.own()?.critical_speeds_rad_s)
        });
        let derived = self.at.iter().find_map(|(_, facts)| Some(&facts.own()?.derived));
        let shown = derived.into_iter().flatten().enumerate().filter(|(_, one)| one.is_shown);
        for (place, DerivedQuantity { name, .. }) in shown {
            let unit = self.units.shown(&name.name);
            let stem = short_name(&name.name, &name.unit);
            let header = match unit.symbol.as_str() {
                "" => stem,
                symbol => format!("{stem} [{symbol}]"),
            };
            table.add_known(header, |(_, facts)| {
                let value = facts.own()?.derived.get(place)?.value;
                (!value.is_nan()).then(|| short(unit.of(value)))
            });
        }
        if !balancers.is_empty() {
            self.add_balancer(&mut table);
        }
        let has_steady = self.at.iter().any(|(_, facts)| facts.steady().is_some());
        if has_steady {
            let held = |facts: &Facts| Some(short(rounded(facts.steady()?.held_fraction?)));
            table.add_known("held", |(_, facts)| held(facts));
            table.add_known("steady sliding", |(_, facts)| in_words(&facts.steady()?.sliding));
        }
        text += &as_text(&table.columns);
        text += if has_steady { STEADY } else { "" };
        if !balancers.is_empty() {
            text += &legend(&balancers, &speed);
        }
        if table.columns.iter().flat_map(|column| &column.cells).any(|cell| cell.contains(RANGE)) {
            text += "(a .. b): the values at the quantiles 2.5 % (a) and 97.5 % (b) of uncertain friction\n";
        }
        text
    }

    fn add_balancer(&self, table: &mut PrintedTable<'_, (Point, Facts)>) {
        let [vibration, imbalance] = [self.units.vibration(), self.units.imbalance()];
        let mut add = |name: &str, cell: &dyn Fn(&Facts) -> Option<String>| {
            table.add_known(name, |(_, facts)| cell(facts));
        };
        let of = |facts: &Facts, value: &dyn Fn(&BalancerFacts) -> Option<String>| match facts {
            Facts::Balancer(facts, _) => value(facts),
            Facts::Own(..) => None,
        };
        add("speed/natural", &|one| of(one, &|facts| Some(format!("{:.3}", facts.speed_ratio))));
        add(&format!("capacity [{}]", imbalance.symbol), &|one| {
            of(one, &|facts| Some(short(imbalance.of(facts.capacity_kg_m))))
        });
        add("/imbalance", &|one| of(one, &|facts| Some(short(facts.capacity_ratio()))));
        add("set", &|one| one.rest(|rest| Some(rounded(rest.set_fraction))));
        add(&format!("worst rest [{}]", vibration.symbol), &|one| {
            one.rest(|rest| rest.max_amplitude_m.map(|one| vibration.of(one)))
        });
        add(&format!("no balls [{}]", vibration.symbol), &|one| {
            of(one, &|facts| facts.amplitude_without_balls_m.map(|one| short(vibration.of(one))))
        });
        add("overlap", &|one| one.rest(|rest| rest.overlapping_fraction.map(rounded)));
        add("balance", &|one| of(one, &balance));
    }

    /// Returns the facts as JSON.
    pub(super) fn json(&self) -> Value {
        let point = |(point, facts): &(Point, Facts)| {
            merged(point_keys(point.point_id, &self.swept, &point.swept), facts.json())
        };
        let mut object = json!({
            "points_examined": self.at.len(),
            "uncertain_at_medians": self.uncertain,
            "points": self.at.iter().map(point).collect::<Vec<_>>(),
        });
        if let Some((_, design)) = &self.design {
            object["design"] = design.clone();
        }
        object
    }
}

/// Returns the positions of rest with friction at its quantiles 0.025 and 0.975, if friction is uncertain.
fn friction_range(
    study: &Study,
    point_id: u64,
    positions: &BallPositions,
) -> Option<[RestFacts; 2]> {
    study.uncertain().iter().find(|column| is_friction(&column.name))?;
    let at = |fraction: f64| {
        let of = |name: &str| if is_friction(name) { fraction } else { 0.5 };
        let model = study.model_at_quantiles(point_id, of).ok()?;
        RestFacts::of(model.ball_balancer()?, positions)
    };
    Some([at(0.025)?, at(0.975)?])
}

fn balancer((point, facts): &(Point, Facts)) -> Option<(u64, &BalancerFacts)> {
    match facts {
        Facts::Balancer(facts, _) => Some((point.point_id, facts)),
        Facts::Own(..) => None,
    }
}

const STEADY: &str = "held: fraction of the start positions, with all speeds zero, at which friction holds the contacts; steady \
                      sliding:\nwhere all contacts slide and no coordinate moves, and whether small motions about it decay\n";

/// Returns states of steady sliding in words; `None` without one.
fn in_words(sliding: &[SteadySliding]) -> Option<String> {
    let one = |state: &SteadySliding| {
        let place = state.coordinates.iter().take(MOST_NAMED);
        let place: Vec<String> =
            place.map(|(name, value)| format!("{name} {}", short(*value))).collect();
        format!("{} at {}", state.stability, place.join(", "))
    };
    let all: Vec<String> = sliding.iter().map(one).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The most coordinates that are named in a table.
const MOST_NAMED: usize = 3;

/// The separator of the two values in parentheses.
const RANGE: &str = " .. ";

impl Facts {
    fn natural_frequencies(&self) -> NaturalFrequencies {
        match self {
            Facts::Balancer(facts, _) => NaturalFrequencies {
                held_rad_s: None,
                free_rad_s: Some(vec![facts.natural_frequency_rad_s]),
            },
            Facts::Own(facts) => facts.natural_frequencies.clone(),
        }
    }

    /// Returns whether a system has natural frequencies while its contacts hold, and others while they slide.
    fn has_two_kinds_of_frequencies(&self) -> bool {
        let NaturalFrequencies { held_rad_s, free_rad_s } = self.natural_frequencies();
        held_rad_s.is_some() && free_rad_s.is_some()
    }

    fn own(&self) -> Option<&OwnFacts> {
        match self {
            Facts::Own(facts) => Some(facts),
            Facts::Balancer(..) => None,
        }
    }

    fn steady(&self) -> Option<&SteadyStates> {
        self.own()?.steady_states.as_ref()
    }

    /// Returns a value of the positions of rest, with its values for small and large friction if these differ.
    fn rest(&self, value: impl Fn(&RestFacts) -> Option<f64>) -> Option<String> {
        let Facts::Balancer(facts, range) = self else { return None };
        let value = |rest: &RestFacts| value(rest).map(short);
        let nominal = facts.rest.as_ref().and_then(&value);
        let ends = range.as_ref().map(|ends| ends.each_ref().map(&value));
        let Some(ends) = ends.filter(|ends| ends.iter().any(|end| *end != nominal)) else {
            return nominal;
        };
        let [low, high] = ends.map(|end| end.unwrap_or_else(none));
        Some(format!("{} ({low}{RANGE}{high})", nominal.unwrap_or_else(none)))
    }

    /// Returns the facts as a JSON object.
    fn json(&self) -> Value {
        let (facts, range) = match self {
            Facts::Own(facts) => return json!(facts),
            Facts::Balancer(facts, range) => (facts, range),
        };
        let mut object = json!({
            "natural_frequency_rad_s": facts.natural_frequency_rad_s,
            "speed_over_natural_frequency": facts.speed_ratio,
            "capacity_g_mm": facts.capacity_kg_m * GRAM_MILLIMETRES,
            "imbalance_g_mm": facts.imbalance_kg_m * GRAM_MILLIMETRES,
            "capacity_over_imbalance": facts.capacity_ratio(),
            "gravity_over_friction": facts.gravity_over_friction,
            "amplitude_without_balls_m": facts.amplitude_without_balls_m,
            "balance": facts.balance.name(),
            "balance_stability": facts.balance_stability.map(Stability::name),
            "rest": facts.rest,
        });
        if let Some([low, high]) = range {
            object["rest_at_low_friction"] = json!(low);
            object["rest_at_high_friction"] = json!(high);
        }
        object
    }
}

/// g mm in one kg m.
const GRAM_MILLIMETRES: f64 = 1e6;

fn none() -> String {
    "-".to_owned()
}

/// Rounds an estimated fraction to three decimals.
fn rounded(fraction: f64) -> f64 {
    (fraction * 1e3).round() / 1e3
}

/// Returns whether the balancing position exists and is stable, in a word.
fn balance(facts: &BalancerFacts) -> Option<String> {
    match &facts.balance {
        Balance::Nowhere => Some("nowhere".to_owned()),
        _ => facts.balance_stability.map(|stability| stability.name().to_owned()),
    }
}
