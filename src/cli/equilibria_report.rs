//! The result of `stickslip equilibria` as text and as JSON.

use std::path::Path;

use serde::Serialize;
use serde_json::{Value, json};

use super::points_table::MOST_LINES;
use crate::analysis::{FrictionlessEquilibrium, FrictionlessKind, Stability};
use crate::printed_table::{PrintedTable, as_text};
use crate::responses::{merged, point_keys};
use crate::study::Study;
use crate::table::SetSummaryRow;

/// The part of the result that is printed.
pub struct EquilibriaReport<'a> {
    study: &'a Study,
    points: Vec<(SetSummaryRow, Vec<&'static str>)>,
    more: u64,
    keep_all: bool,
    own_speeds: bool,
    kinds: Vec<KindCount>,
    /// The number of points at which the grid does not resolve all components of the set.
    pub too_coarse: u64,
}

/// Counts of the equilibria of one kind.
#[derive(Default, Serialize)]
struct KindCount {
    kind: &'static str,
    found: u64,
    stable: u64,
    /// The smallest and the largest speed at which an equilibrium of this kind is stable, rad/s.
    stable_from_rad_s: Option<f64>,
    stable_to_rad_s: Option<f64>,
}

impl<'a> EquilibriaReport<'a> {
    /// Creates an empty report; with `keep_all` it stores every point, not only the printed ones.
    pub fn new(study: &'a Study, keep_all: bool, own_speeds: bool) -> Self {
        let kinds = FrictionlessKind::ALL.iter();
        EquilibriaReport {
            study,
            points: Vec::new(),
            more: 0,
            keep_all,
            own_speeds,
            kinds: kinds
                .map(|kind| KindCount { kind: kind.name(), ..Default::default() })
                .collect(),
            too_coarse: 0,
        }
    }

    /// Adds a point of the sweep with its frictionless equilibria, if they are computed at the points.
    pub fn push_point(&mut self, row: &SetSummaryRow, frictionless: &[FrictionlessEquilibrium]) {
        self.too_coarse += u64::from(row.set.unseen > Some(0));
        if !self.keep_all && self.points.len() >= MOST_LINES {
            self.more += 1;
            return;
        }
        let stable = frictionless.iter().filter(|found| found.stability == Stability::Stable);
        self.points.push((row.clone(), stable.map(|found| found.kind.name()).collect()));
    }

    /// Counts a frictionless equilibrium.
    pub fn push_frictionless(&mut self, speed_rad_s: f64, found: &FrictionlessEquilibrium) {
        let Some(kind) = self.kinds.iter_mut().find(|count| count.kind == found.kind.name()) else {
            return;
        };
        kind.found += 1;
        if found.stability == Stability::Stable {
            kind.stable += 1;
            let (from, to) = (&mut kind.stable_from_rad_s, &mut kind.stable_to_rad_s);
            *from = Some(from.map_or(speed_rad_s, |from| from.min(speed_rad_s)));
            *to = Some(to.map_or(speed_rad_s, |to| to.max(speed_rad_s)));
        }
    }

    /// Returns the report as text: the points, and the frictionless equilibria of `--speeds`.
    pub fn text(&self) -> String {
        let rows = &self.points[..self.points.len().min(MOST_LINES)];
        let mut table = PrintedTable::new(rows, "");
        let shown: Vec<_> =
            rows.iter().map(|(row, _)| self.study.shown(&row.point.swept)).collect();
        table.add_point(|(row, _)| row.point.point_id, self.study.swept(), &shown);
        let fraction = |value: f64| format!("{value:.4}");
        table.add("fraction", |(row, _)| fraction(row.set.fraction));
        table.add_if_any("touching", |(row, _)| row.set.touching_fraction.map(fraction));
        table.add_if_any("95 % interval", |(row, _)| {
            row.set.fraction_interval.map(|(low, high)| format!("{low:.4} .. {high:.4}"))
        });
        if rows.iter().any(|(row, _)| row.set.fraction_interval.is_none()) {
            let count = |count: Option<u64>| count.map(|count| count.to_string());
            table.add_known("components", |(row, _)| count(row.set.components));
            table
                .add_known("modulo exchange", |(row, _)| count(row.set.components_modulo_exchange));
        }
        table.add("amplitude [m]", |(row, _)| {
            let range = row.set.amplitude_m.map(|(least, most)| [least, most].map(metres));
            range.map_or_else(|| "none".to_owned(), |range| range.join(" .. "))
        });
        table.add("balance", |(row, _)| row.set.balance.name().to_owned());
        if !self.own_speeds {
            table.add("stable without friction", |(_, stable)| match stable.is_empty() {
                true => "none".to_owned(),
                false => stable.join(" "),
            });
        }
        let mut text = as_text(&table.columns);
        if self.more > 0 {
            text +=
                &format!("... and {} more points in equilibrium_set_summary.parquet\n", self.more);
        }
        if self.own_speeds {
            text += &format!("\n{}", self.kinds_text());
        }
        text
    }

    fn kinds_text(&self) -> String {
        let found = self.kinds_found();
        let mut table = PrintedTable::new(&found, "nowhere");
        table.add("without friction", |row| row.kind.to_owned());
        table.add("found", |row| row.found.to_string());
        table.add("stable", |row| row.stable.to_string());
        table.add_known("stable at [rad/s]", |row| {
            Some(format!("{:.3} .. {:.3}", row.stable_from_rad_s?, row.stable_to_rad_s?))
        });
        as_text(&table.columns)
    }

    fn kinds_found(&self) -> Vec<&KindCount> {
        self.kinds.iter().filter(|kind| kind.found > 0).collect()
    }

    /// Returns the report as JSON.
    pub fn json(&self, options: &Value, directory: &Path) -> Value {
        let point = |(row, stable): &(SetSummaryRow, Vec<&str>)| {
            let SetSummaryRow { point, set, .. } = row;
            let keys = point_keys(point.point_id, self.study.swept(), &point.swept);
            let facts = json!({
                "grid_positions": set.positions,
                "fraction": set.fraction,
                "touching_fraction": set.touching_fraction,
                "fraction_low": set.fraction_interval.map(|(low, _)| low),
                "fraction_high": set.fraction_interval.map(|(_, high)| high),
                "components": set.components,
                "components_modulo_exchange": set.components_modulo_exchange,
                "unresolved_equilibria": set.unseen,
                "amplitude_min_m": set.amplitude_m.map(|(smallest, _)| smallest),
                "amplitude_max_m": set.amplitude_m.map(|(_, largest)| largest),
                "min_amplitude_beta_rad": set.min_amplitude_beta_rad,
                "balance": set.balance.name(),
                "balance_beta_rad": set.balance.position(),
                "stable_without_friction": (!self.own_speeds).then_some(stable),
            });
            merged(keys, facts)
        };
        json!({
            "study": self.study.name(),
            "out": directory.display().to_string(),
            "options": options,
            "points": self.points.iter().map(point).collect::<Vec<_>>(),
            "frictionless": self.kinds_found(),
        })
    }
}

fn metres(amplitude: f64) -> String {
    if amplitude == 0.0 { "0".to_owned() } else { format!("{amplitude:.3e}") }
}
