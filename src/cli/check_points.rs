//! The closed forms at the points of a sweep for `check`, as a table and as JSON.

use serde::Serialize;
use serde_json::Value;

use super::check_legend::legend;
use crate::analysis::Stability;
use crate::check::{
    BalancerFacts, BallPositions, ExaminedDesign, OwnFacts, RestFacts, SteadyStates, SteadyValues,
    points_to_examine,
};
use crate::model::DerivedQuantity;
use crate::numbers::short;
use crate::printed_table::{PrintedTable, as_text};
use crate::responses::{design_json, point_keys};
use crate::study::{Point, Study, short_name};

/// The closed forms at some points of a sweep, with uncertain parameters at their medians.
#[derive(Serialize)]
pub(super) struct ClosedForms<'a> {
    #[serde(skip)]
    study: &'a Study,
    points_examined: usize,
    /// Whether any parameter is uncertain.
    uncertain_at_medians: bool,
    points: Vec<PointClosedForms>,
    /// The design whose machine is described, as JSON and in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    design: Option<Value>,
    #[serde(skip)]
    design_in_words: Option<String>,
}

/// The closed forms at a point: those of a ball balancer, or those of a system of one's own.
#[derive(Serialize)]
struct PointClosedForms {
    #[serde(skip)]
    point: Point,
    /// The number of the point and its swept parameters.
    #[serde(flatten)]
    keys: Value,
    #[serde(flatten)]
    balancer: Option<BalancerFacts>,
    #[serde(flatten)]
    friction_range: Option<FrictionRange>,
    #[serde(flatten)]
    facts: Option<OwnFacts>,
}

/// The positions of rest with friction at its quantiles 0.025 and 0.975.
#[derive(Serialize)]
struct FrictionRange {
    rest_at_low_friction: RestFacts,
    rest_at_high_friction: RestFacts,
}

impl<'a> ClosedForms<'a> {
    /// Computes the closed forms at no more than `most` points, spread evenly over the sweep. Points at which the
    /// medians are impossible values are left out. A study with variables is that of the examined `design`.
    pub(super) fn of(study: &'a Study, design: Option<&ExaminedDesign>, most: u64) -> Self {
        let positions = BallPositions::new(study.numbers_of_balls());
        let facts = |point_id| PointClosedForms::of(study, point_id, &positions);
        let points = points_to_examine(study.point_count(), most);
        let points: Vec<PointClosedForms> = points.into_iter().filter_map(facts).collect();
        ClosedForms {
            study,
            points_examined: points.len(),
            uncertain_at_medians: !study.uncertain().is_empty(),
            points,
            design: design.map(|design| design_json(study, &design.values)),
            design_in_words: design.map(ExaminedDesign::words),
        }
    }

    /// Returns the facts as lines of text.
    pub(super) fn text(&self) -> String {
        let mut text = "without simulation".to_owned();
        if self.uncertain_at_medians {
            text += ", with uncertain parameters at their medians";
        }
        let (examined, points) = (self.points_examined, self.study.point_count());
        if (examined as u64) < points {
            text += &format!(", at {examined} of {points} points");
        }
        text += "\n";
        if let Some(words) = &self.design_in_words {
            text += &format!("the design is {words}\n");
        }
        let (study, units) = (self.study, self.study.units());
        let facts = self.points.iter();
        let balancers: Vec<(u64, &BalancerFacts)> =
            facts.filter_map(|row| Some((row.point.point_id, row.balancer.as_ref()?))).collect();
        let shown: Vec<_> = self.points.iter().map(|row| study.shown(&row.point.swept)).collect();
        let mut table = PrintedTable::new(&self.points, MISSING);
        table.add_point(|row| row.point.point_id, study.swept(), &shown);
        let speed = units.speed();
        let in_unit = |all: &[f64]| {
            let shown = all.iter().map(|value| format!("{:.2}", speed.of(*value)));
            (!all.is_empty()).then(|| shown.collect::<Vec<_>>().join(", "))
        };
        let symbol = &speed.symbol;
        let has_two = self.points.iter().any(|row| row.has_two_kinds_of_frequencies());
        let held = if has_two { "held, natural" } else { "natural" };
        table.add_if_any(format!("{held} [{symbol}]"), |row| in_unit(row.natural_rad_s()));
        if has_two {
            table.add_known(format!("sliding, natural [{symbol}]"), |row| {
                in_unit(row.facts.as_ref()?.natural_frequencies.free_rad_s.as_ref()?)
            });
        }
        table.add_if_any(format!("critical [{symbol}]"), |row| {
            in_unit(&row.facts.as_ref()?.critical_speeds_rad_s)
        });
        let derived = self.points.iter().find_map(|row| Some(&row.facts.as_ref()?.derived));
        let shown = derived.into_iter().flatten().enumerate().filter(|(_, value)| value.is_shown);
        for (place, DerivedQuantity { name, .. }) in shown {
            let unit = units.shown(&name.name);
            let stem = short_name(&name.name, &name.unit);
            let header = match unit.symbol.as_str() {
                "" => stem,
                symbol => format!("{stem} [{symbol}]"),
            };
            table.add_known(header, |row| {
                let value = row.facts.as_ref()?.derived.get(place)?.value;
                (!value.is_nan()).then(|| short(unit.of(value)))
            });
        }
        if !balancers.is_empty() {
            self.add_balancer(&mut table);
        }
        let has_steady = self.points.iter().any(|row| row.steady().is_some());
        if has_steady {
            table.add_known("held", |row| Some(short(rounded(row.steady()?.held_fraction?))));
            table.add_known("steady sliding", |row| in_words(&row.steady()?.sliding));
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

    fn add_balancer(&self, table: &mut PrintedTable<'_, PointClosedForms>) {
        let units = self.study.units();
        let [vibration, imbalance] = [units.vibration(), units.imbalance()];
        table.add_known("speed/natural", |row| {
            Some(format!("{:.3}", row.balancer.as_ref()?.speed_ratio))
        });
        table.add_known(format!("capacity [{}]", imbalance.symbol), |row| {
            Some(short(imbalance.of(row.balancer.as_ref()?.capacity_kg_m)))
        });
        table.add_known("/imbalance", |row| Some(short(row.balancer.as_ref()?.capacity_ratio)));
        table.add_known("set", |row| row.rest(|rest| Some(rounded(rest.set_fraction))));
        table.add_known(format!("worst rest [{}]", vibration.symbol), |row| {
            row.rest(|rest| rest.max_amplitude_m.map(|amplitude| vibration.of(amplitude)))
        });
        table.add_known(format!("no balls [{}]", vibration.symbol), |row| {
            Some(short(vibration.of(row.balancer.as_ref()?.amplitude_without_balls_m?)))
        });
        table.add_known("overlap", |row| row.rest(|rest| rest.overlapping_fraction.map(rounded)));
        table.add_known("balance", |row| {
            let BalancerFacts { balance, balance_stability, .. } = row.balancer.as_ref()?;
            Some(balance_stability.map_or(balance.name(), Stability::name).to_owned())
        });
    }
}

const STEADY: &str = "held: fraction of the start positions, with all speeds zero, at which friction holds the contacts; steady \
                      sliding:\nwhere all contacts slide and coordinates keep their values or speeds, and whether small motions about it decay\n";

/// Returns steady states in words; `None` without one.
pub(super) fn in_words(sliding: &[SteadyValues]) -> Option<String> {
    let words = |state: &SteadyValues| {
        let place = state.coordinates.iter().take(MOST_NAMED);
        let place: Vec<String> =
            place.map(|(name, value)| format!("{name} {}", short(*value))).collect();
        format!("{} at {}", state.stability.name(), place.join(", "))
    };
    let all: Vec<String> = sliding.iter().map(words).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The most coordinates that are named in a table.
const MOST_NAMED: usize = 3;

/// The cell of a missing value.
const MISSING: &str = "-";

/// The separator of the two values in parentheses.
const RANGE: &str = " .. ";

impl PointClosedForms {
    /// Returns `None` where the medians are impossible values, or for an unsupported number of balls.
    fn of(study: &Study, point_id: u64, positions: &BallPositions) -> Option<Self> {
        let (point, model) = (study.point(point_id), study.median_model(point_id).ok()?);
        let machine = model.ball_balancer();
        let balancer = machine.and_then(|machine| BalancerFacts::of(machine, positions));
        let facts = OwnFacts::of(&model, &point.start_ranges);
        (balancer.is_some() || facts.is_some()).then(|| PointClosedForms {
            keys: point_keys(point_id, study.swept(), &point.swept),
            friction_range: machine.and_then(|_| FrictionRange::of(study, point_id, positions)),
            point,
            balancer,
            facts,
        })
    }

    /// Returns the natural frequencies while contacts hold or, without such ones, those without friction.
    fn natural_rad_s(&self) -> &[f64] {
        match (&self.facts, &self.balancer) {
            (Some(facts), _) => facts.natural_frequencies.first_rad_s(),
            (None, Some(facts)) => std::slice::from_ref(&facts.natural_frequency_rad_s),
            (None, None) => &[],
        }
    }

    /// Returns whether a system has natural frequencies while its contacts hold, and others while they slide.
    fn has_two_kinds_of_frequencies(&self) -> bool {
        let frequencies = self.facts.as_ref().map(|facts| &facts.natural_frequencies);
        frequencies.is_some_and(|both| both.held_rad_s.is_some() && both.free_rad_s.is_some())
    }

    fn steady(&self) -> Option<&SteadyStates> {
        self.facts.as_ref()?.steady_states.as_ref()
    }

    /// Returns a value of the positions of rest, with its values for small and large friction if these differ.
    fn rest(&self, value: impl Fn(&RestFacts) -> Option<f64>) -> Option<String> {
        let words = |rest: Option<&RestFacts>| {
            rest.and_then(&value).map_or_else(|| MISSING.to_owned(), short)
        };
        let nominal = words(self.balancer.as_ref()?.rest.as_ref());
        let Some(range) = &self.friction_range else { return Some(nominal) };
        let ends = [&range.rest_at_low_friction, &range.rest_at_high_friction];
        let [low, high] = ends.map(|rest| words(Some(rest)));
        let is_same = low == nominal && high == nominal;
        Some(if is_same { nominal } else { format!("{nominal} ({low}{RANGE}{high})") })
    }
}

impl FrictionRange {
    /// Returns `None` if friction is certain, or holds no ball.
    fn of(study: &Study, point_id: u64, positions: &BallPositions) -> Option<Self> {
        let is_friction = |name: &str| name.contains("friction_coefficient");
        study.uncertain().iter().find(|column| is_friction(&column.name))?;
        let at = |fraction: f64| {
            let of = |name: &str| if is_friction(name) { fraction } else { 0.5 };
            let model = study.model_at_quantiles(point_id, of).ok()?;
            RestFacts::of(model.ball_balancer()?, positions)
        };
        Some(FrictionRange { rest_at_low_friction: at(0.025)?, rest_at_high_friction: at(0.975)? })
    }
}

/// Rounds an estimated fraction to three decimals.
fn rounded(fraction: f64) -> f64 {
    (fraction * 1e3).round() / 1e3
}
