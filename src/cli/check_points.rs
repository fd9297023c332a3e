//! The closed forms at the points of a sweep for `check`, as a table and as JSON.

use serde_json::{Value, json};

use super::check_legend::legend;
use super::point_keys::point_keys;
use crate::analysis::{Balance, Stability};
use crate::check::{
    BalancerFacts, BallPositions, BlockFacts, ExaminedDesign, RestFacts, points_to_examine, short,
};
use crate::study::{DesignValue, Point, Study, Units, Variable, VariedParameter};
use crate::text_table::text_table;

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
    Block(BlockFacts),
    /// The facts, and the positions of rest with friction at its quantiles 0.025 and 0.975 if friction is uncertain.
    Balancer(Box<BalancerFacts>, Option<[RestFacts; 2]>),
    /// A model without closed forms.
    Other {
        natural_frequency_rad_s: f64,
    },
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
            let model = study.median_model(point_id).ok()?;
            let facts = if let Some(machine) = model.ball_balancer() {
                let facts = BalancerFacts::of(machine, &positions)?;
                Facts::Balancer(Box::new(facts), friction_range(study, point_id, &positions))
            } else if let Some(block) = model.block() {
                Facts::Block(BlockFacts::of(block))
            } else {
                Facts::Other { natural_frequency_rad_s: model.natural_frequency_rad_s() }
            };
            Some((study.point(point_id), facts))
        };
        let points = points_to_examine(study.point_count(), most);
        let at: Vec<(Point, Facts)> = points.into_iter().filter_map(facts).collect();
        ClosedForms {
            swept: study.swept().to_vec(),
            units: study.units().clone(),
            points: study.point_count(),
            uncertain: !study.uncertain().is_empty(),
            design: design.map(|design| (design.words(), design_json(design))),
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
        if balancers.is_empty() {
            let is_block = |(_, facts): &(Point, Facts)| matches!(facts, Facts::Block(_));
            let all = if self.at.iter().all(is_block) { 3 } else { 1 };
            let of_block = [("natural", SPEED), ("static reach", REACH), ("belt", BELT)];
            let column = |(words, name): &(&str, &str)| {
                format!("{words} [{}]", self.units.shown(name).symbol)
            };
            return text + &self.table(&of_block[..all].iter().map(column).collect::<Vec<_>>());
        }
        let mut text = text
            + &self.table(&balancer_columns(&self.units))
            + &legend(&balancers, &self.units.speed());
        if self
            .at
            .iter()
            .any(|(_, facts)| facts.cells(&self.units).iter().any(|cell| cell.contains(RANGE)))
        {
            text += "(a .. b): the values at the quantiles 2.5 % (a) and 97.5 % (b) of uncertain friction\n";
        }
        text
    }

    fn table(&self, columns: &[String]) -> String {
        let mut head = vec!["point".to_owned()];
        head.extend(self.swept.iter().map(VariedParameter::shown_name));
        head.extend(columns.iter().cloned());
        let rows = self.at.iter().zip(&self.shown).map(|((point, facts), shown)| {
            let mut row = vec![point.point_id.to_string()];
            row.extend(shown.iter().cloned());
            row.extend(facts.cells(&self.units));
            row
        });
        text_table(&[head].into_iter().chain(rows).collect::<Vec<_>>(), &[])
    }

    /// Returns the facts as JSON.
    pub(super) fn json(&self) -> Value {
        let point = |(point, facts): &(Point, Facts)| {
            let mut object = point_keys(point.point_id, &self.swept, &point.swept);
            for (key, value) in facts.entries() {
                object[key] = value;
            }
            object
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

/// Returns the values of a design by the names of the variables.
fn design_json(design: &ExaminedDesign) -> Value {
    let value = |value: &DesignValue, variable: &Variable| match value {
        DesignValue::Number(number) => json!(number),
        DesignValue::Choice(_) => json!(variable.describe(*value)),
    };
    let each = design.study.variables().iter().zip(&design.values);
    let entries = each.map(|(variable, one)| (variable.name().to_owned(), value(one, variable)));
    Value::Object(entries.collect())
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
        Facts::Block(_) | Facts::Other { .. } => None,
    }
}

/// The separator of the two values in parentheses.
const RANGE: &str = " .. ";

/// Names with the units of a speed of rotation, a length and a speed.
const SPEED: &str = "speed_rad_s";
const REACH: &str = "static_reach_m";
const BELT: &str = "belt_speed_m_s";

/// Returns the names of the columns of a balancer.
fn balancer_columns(units: &Units) -> Vec<String> {
    let [speed, vibration, imbalance] = [units.speed(), units.vibration(), units.imbalance()];
    vec![
        format!("natural [{}]", speed.symbol),
        "speed/natural".to_owned(),
        format!("capacity [{}]", imbalance.symbol),
        "/imbalance".to_owned(),
        "set".to_owned(),
        format!("worst rest [{}]", vibration.symbol),
        format!("no balls [{}]", vibration.symbol),
        "overlap".to_owned(),
        "balance".to_owned(),
    ]
}

impl Facts {
    /// Returns the cells of a row of the table.
    fn cells(&self, units: &Units) -> Vec<String> {
        match self {
            Facts::Other { natural_frequency_rad_s } => {
                vec![format!("{:.2}", units.speed().of(*natural_frequency_rad_s))]
            }
            Facts::Block(facts) => vec![
                format!("{:.2}", units.speed().of(facts.natural_frequency_rad_s)),
                short(units.shown(REACH).of(facts.static_reach_m)),
                facts.belt_speed_m_s.map_or_else(none, |one| short(units.shown(BELT).of(one))),
            ],
            Facts::Balancer(facts, range) => {
                let rest = |value: &dyn Fn(&RestFacts) -> Option<f64>| {
                    let nominal = facts.rest.as_ref().and_then(value).map_or_else(none, short);
                    let ends = range.as_ref().map(|[low, high]| [value(low), value(high)]);
                    match ends.map(|ends| ends.map(|end| end.map_or_else(none, short))) {
                        Some([low, high]) if low != nominal || high != nominal => {
                            format!("{nominal} ({low}{RANGE}{high})")
                        }
                        _ => nominal,
                    }
                };
                vec![
                    format!("{:.2}", units.speed().of(facts.natural_frequency_rad_s)),
                    format!("{:.3}", facts.speed_ratio),
                    short(units.imbalance().of(facts.capacity_kg_m)),
                    short(facts.capacity_ratio()),
                    rest(&|rest| Some(rounded(rest.set_fraction))),
                    rest(&|rest| rest.max_amplitude_m.map(|one| units.vibration().of(one))),
                    facts
                        .amplitude_without_balls_m
                        .map_or_else(none, |one| short(units.vibration().of(one))),
                    rest(&|rest| rest.overlapping_fraction.map(rounded)),
                    balance(facts),
                ]
            }
        }
    }

    /// Returns the keys and values of a point's JSON object.
    fn entries(&self) -> Vec<(&'static str, Value)> {
        match self {
            Facts::Other { natural_frequency_rad_s } => {
                vec![("natural_frequency_rad_s", json!(natural_frequency_rad_s))]
            }
            Facts::Block(facts) => vec![
                ("natural_frequency_rad_s", json!(facts.natural_frequency_rad_s)),
                ("static_reach_m", json!(facts.static_reach_m)),
                ("belt_speed_m_s", json!(facts.belt_speed_m_s)),
            ],
            Facts::Balancer(facts, range) => {
                let stability = facts.balance_stability.map(Stability::name);
                let mut entries = vec![
                    ("natural_frequency_rad_s", json!(facts.natural_frequency_rad_s)),
                    ("speed_over_natural_frequency", json!(facts.speed_ratio)),
                    ("capacity_g_mm", json!(facts.capacity_kg_m * GRAM_MILLIMETRES)),
                    ("imbalance_g_mm", json!(facts.imbalance_kg_m * GRAM_MILLIMETRES)),
                    ("capacity_over_imbalance", json!(facts.capacity_ratio())),
                    ("gravity_over_friction", json!(facts.gravity_over_friction)),
                    ("amplitude_without_balls_m", json!(facts.amplitude_without_balls_m)),
                    ("balance", json!(facts.balance.name())),
                    ("balance_stability", json!(stability)),
                    ("rest", facts.rest.as_ref().map_or(Value::Null, rest_json)),
                ];
                if let Some([low, high]) = range {
                    entries.push(("rest_at_low_friction", rest_json(low)));
                    entries.push(("rest_at_high_friction", rest_json(high)));
                }
                entries
            }
        }
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
fn balance(facts: &BalancerFacts) -> String {
    match (&facts.balance, facts.balance_stability) {
        (Balance::Nowhere, _) => "nowhere".to_owned(),
        (_, stability) => stability.map_or_else(none, |stability| stability.name().to_owned()),
    }
}

fn rest_json(rest: &RestFacts) -> Value {
    json!({
        "set_fraction": rest.set_fraction,
        "max_amplitude_m": rest.max_amplitude_m,
        "overlapping_fraction": rest.overlapping_fraction,
    })
}
