//! Run by run against an independent integration: another language, another form of the equations,
//! another integrator, the exact motion instead of the switch model (`scripts/reference`).

use std::collections::BTreeMap;
use std::path::Path;

use stickslip::classification::{Label, Outcome};
use stickslip::model::{Case, Machine, Simulation, Start};

use super::simulate_all::simulate_all;
use crate::support::angular_distance;

/// A run of the independent program.
pub struct Reference {
    pub start: Start,
    pub label: String,
    pub end_beta: [f64; 2],
}

/// A row of a table of the independent program.
pub struct Row(BTreeMap<String, String>);

impl Row {
    pub fn text(&self, name: &str) -> &str {
        &self.0[name]
    }

    pub fn numbers<const N: usize>(&self, names: [&str; N]) -> [f64; N] {
        names.map(|name| self.text(name).parse().expect("a number"))
    }
}

/// Returns the rows of a table of the independent program, with their columns.
pub fn rows(name: &str) -> impl Iterator<Item = Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/data/{name}.csv"));
    let reader = csv::Reader::from_path(path).expect("the reference data are there");
    reader.into_deserialize().map(|row| Row(row.expect("a row")))
}

/// Returns the runs of the independent program at a speed (its absolute value, as in the file's
/// name).
pub fn references(speed: &str) -> Vec<Reference> {
    let of = |row: Row| Reference {
        start: Start::of_balancer(
            row.numbers(["x", "y"]),
            &row.numbers(["beta_1", "beta_2"]),
            row.numbers(["x_dot", "y_dot"]),
            &row.numbers(["beta_dot_1", "beta_dot_2"]),
        ),
        label: row.text("label").to_owned(),
        end_beta: row.numbers(["end_beta_1", "end_beta_2"]),
    };
    rows(&format!("reference_{speed}")).map(of).collect()
}

/// Returns the same runs by this program.
pub fn run_all(speed: &str, references: &[Reference], simulation: Simulation) -> Vec<Outcome> {
    let speed_rad_s = -speed.parse::<f64>().expect("a speed");
    let case = |reference: &Reference| Case {
        model: Machine { speed_rad_s, ..Machine::default() }.into(),
        start: reference.start.clone(),
        simulation,
    };
    simulate_all(&references.iter().map(case).collect::<Vec<_>>())
}

pub fn label_agrees(reference: &Reference, outcome: &Outcome) -> bool {
    (reference.label == "equilibrium") == (outcome.label() == Label::Equilibrium)
}

/// Returns the distance of the final angles of a run that comes to rest from those of the independent program.
pub fn angle_error(reference: &Reference, outcome: &Outcome) -> f64 {
    let beta = outcome.position.as_deref().expect("an equilibrium has angles");
    let error = |ball: usize| angular_distance(beta[ball], reference.end_beta[ball]);
    error(0).max(error(1))
}

/// The switch model converges to the exact motion in proportion to its band: the median error of
/// the final angles decreases tenfold with the band, over four decades.
#[test]
fn final_angles_converge_with_the_band() {
    let speed = "160.8103";
    let references = references(speed);
    let median_error = |band: f64| {
        let outcomes = run_all(speed, &references, Simulation { band, ..Simulation::default() });
        let runs = references.iter().zip(&outcomes);
        let mut errors: Vec<f64> = runs.map(|(run, outcome)| angle_error(run, outcome)).collect();
        errors.sort_by(f64::total_cmp);
        errors[errors.len() / 2]
    };
    let errors = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8].map(median_error);
    println!("median errors of final angles, band 1e-4 to 1e-8: {errors:?} rad");
    for pair in errors.windows(2) {
        let factor = pair[0] / pair[1];
        assert!((7.0..14.0).contains(&factor), "{errors:?}");
    }
}
