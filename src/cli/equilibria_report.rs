//! The result of `stickslip equilibria` as text and as JSON.

use std::path::Path;

use serde_json::{Value, json};

use super::points_table::MOST_LINES;
use crate::analysis::{FrictionlessEquilibrium, FrictionlessKind, Stability};
use crate::printed_table::{PrintedTable, as_text};
use crate::responses::{merged, point_keys};
use crate::study::{Study, VariedParameter};
use crate::table::SetSummaryRow;

/// The part of the result that is printed.
pub struct Report {
    study: String,
    swept: Vec<VariedParameter>,
    points: Vec<(SetSummaryRow, Vec<&'static str>)>,
    /// The values of the swept parameters of each of these points.
    shown: Vec<Vec<String>>,
    more: u64,
    keep_all: bool,
    own_speeds: bool,
    kinds: [KindCount; FrictionlessKind::ALL.len()],
    /// The number of points at which the grid does not resolve all components of the set.
    pub too_coarse: u64,
}

/// Counts of the equilibria of one kind.
#[derive(Clone, Copy, Default)]
struct KindCount {
    found: u64,
    stable: u64,
    /// The smallest and the largest speed at which an equilibrium of this kind is stable, rad/s.
    stable_rad_s: Option<(f64, f64)>,
}

impl Report {
    /// Creates an empty report; with `keep_all` it stores every point, not only the printed ones.
    pub fn new(study: &Study, keep_all: bool, own_speeds: bool) -> Self {
        Report {
            study: study.name().to_owned(),
            swept: study.swept().to_vec(),
            points: Vec::new(),
            shown: Vec::new(),
            more: 0,
            keep_all,
            own_speeds,
            kinds: Default::default(),
            too_coarse: 0,
        }
    }

    /// Adds a point of the sweep with its frictionless equilibria, if they are computed at the points.
    pub fn push_point(
        &mut self,
        study: &Study,
        row: &SetSummaryRow,
        frictionless: &[FrictionlessEquilibrium],
    ) {
        self.too_coarse += u64::from(row.set.unseen > Some(0));
        if !self.keep_all && self.points.len() >= MOST_LINES {
            self.more += 1;
            return;
        }
        let stable = frictionless.iter().filter(|one| one.stability == Stability::Stable);
        self.shown.push(study.shown(&row.point.swept));
        self.points.push((row.clone(), stable.map(|one| one.kind.name()).collect()));
    }

    /// Counts a frictionless equilibrium.
    pub fn push_frictionless(&mut self, speed_rad_s: f64, found: &FrictionlessEquilibrium) {
        let kinds = FrictionlessKind::ALL.iter().zip(&mut self.kinds);
        for (_, kind) in kinds.filter(|(kind, _)| **kind == found.kind) {
            kind.found += 1;
            if found.stability == Stability::Stable {
                kind.stable += 1;
                let (low, high) = kind.stable_rad_s.unwrap_or((speed_rad_s, speed_rad_s));
                kind.stable_rad_s = Some((low.min(speed_rad_s), high.max(speed_rad_s)));
            }
        }
    }

    /// Returns the report as text: the points, and the frictionless equilibria of `--speeds`.
    pub fn text(&self) -> String {
        let rows = &self.points[..self.points.len().min(MOST_LINES)];
        let mut table = PrintedTable::new(rows, "");
        table.add_point(|(row, _)| row.point.point_id, &self.swept, &self.shown);
        let fraction = |one: f64| format!("{one:.4}");
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
        let found = FrictionlessKind::ALL.iter().zip(&self.kinds);
        let found: Vec<_> = found.filter(|(_, counts)| counts.found > 0).collect();
        let mut table = PrintedTable::new(&found, "nowhere");
        table.add("without friction", |(kind, _)| kind.name().to_owned());
        table.add("found", |(_, counts)| counts.found.to_string());
        table.add("stable", |(_, counts)| counts.stable.to_string());
        table.add_known("stable at [rad/s]", |(_, counts)| {
            counts.stable_rad_s.map(|(low, high)| format!("{low:.3} .. {high:.3}"))
        });
        as_text(&table.columns)
    }

    /// Returns the report as JSON.
    pub fn json(&self, options: &Value, directory: &Path) -> Value {
        let point = |(row, stable): &(SetSummaryRow, Vec<&str>)| {
            let SetSummaryRow { point, set, .. } = row;
            let keys = point_keys(point.point_id, &self.swept, &point.swept);
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
        let kinds = FrictionlessKind::ALL.iter().zip(&self.kinds);
        let kinds = kinds.filter(|(_, counts)| counts.found > 0).map(|(kind, counts)| {
            json!({
                "kind": kind.name(),
                "found": counts.found,
                "stable": counts.stable,
                "stable_from_rad_s": counts.stable_rad_s.map(|(low, _)| low),
                "stable_to_rad_s": counts.stable_rad_s.map(|(_, high)| high),
            })
        });
        json!({
            "study": self.study,
            "out": directory.display().to_string(),
            "options": options,
            "points": self.points.iter().map(point).collect::<Vec<_>>(),
            "frictionless": kinds.collect::<Vec<_>>(),
        })
    }
}

fn metres(amplitude: f64) -> String {
    if amplitude == 0.0 { "0".to_owned() } else { format!("{amplitude:.3e}") }
}
