//! `runs.parquet`: one row per run, including failed runs; and the columns of planned runs.

use super::column::{Column, NON_DIMENSIONAL};
use super::run_record::RunRecord;
use crate::analysis::CycleClass;
use crate::classification::{Evidence, LyapunovExponent};
use crate::model::Coordinate;
use crate::study::{ParameterKind, ParameterValue, PlannedRun, Study, VariedParameter};

/// Returns the columns that identify a run and its start state; `planned` gets the planned run from
/// a row.
pub fn planned_columns<R: 'static>(
    study: &Study,
    planned: fn(&R) -> &PlannedRun,
) -> Vec<Column<R>> {
    let mut columns = vec![
        Column::count("run_id", "number of the run in the study, from 0", move |row| {
            Some(planned(row).run_id)
        }),
        Column::count("point_id", "number of the sweep's point, from 0", move |row| {
            Some(planned(row).point_id)
        }),
        Column::count("cell", "cell of the sampling design, from 0", move |row| {
            Some(planned(row).cell)
        }),
        Column::count("replicate", "number of the sample in its cell, from 0", move |row| {
            Some(planned(row).replicate)
        }),
    ];
    columns.extend(nominal_columns(study, move |row| &planned(row).swept));
    columns.extend(drawn_columns(study, move |row| &planned(row).uncertain));
    columns.extend(start_columns(study, planned));
    columns
}

/// Returns one column for each swept parameter in a table with one row per point; `values` gets the
/// values from a row.
pub fn swept_columns<R: 'static>(
    study: &Study,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let columns = study.swept().iter().enumerate();
    columns
        .map(|(index, swept)| swept_column(&swept.name, &swept.meaning, swept, index, values))
        .collect()
}

/// Returns one column for each swept parameter in a table with one row per run. If a parameter is
/// swept and multiplied by a random factor (`times`), its own name denotes the value of the run,
/// see [`drawn_columns`], and the swept value is called `nominal_<parameter>`.
pub fn nominal_columns<R: 'static>(
    study: &Study,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let column = |(index, swept): (usize, &VariedParameter)| {
        let VariedParameter { name, meaning, .. } = swept;
        if study.uncertain().iter().all(|drawn| drawn.name != *name) {
            return swept_column(name, meaning, swept, index, values);
        }
        let meaning = format!("{meaning}: the swept value, before the factor drawn for this run");
        swept_column(&format!("nominal_{name}"), &meaning, swept, index, values)
    };
    study.swept().iter().enumerate().map(column).collect()
}

/// Returns one column for each uncertain parameter, under its own name, with the value of the run.
pub fn drawn_columns<R: 'static>(
    study: &Study,
    values: impl Fn(&R) -> &[f64] + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let column = |(index, drawn): (usize, &VariedParameter)| {
        let meaning = format!("{} (drawn for this run)", drawn.meaning);
        Column::number(&drawn.name, drawn.unit, &meaning, move |row| {
            values(row).get(index).copied()
        })
    };
    study.uncertain().iter().enumerate().map(column).collect()
}

fn swept_column<R: 'static>(
    name: &str,
    meaning: &str,
    parameter: &VariedParameter,
    index: usize,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) -> Column<R> {
    match parameter.kind {
        ParameterKind::Number => {
            Column::number(name, parameter.unit, meaning, move |row| match values(row).get(index) {
                Some(ParameterValue::Number(number)) => Some(*number),
                _ => None,
            })
        }
        ParameterKind::Text => {
            Column::word(name, meaning, move |row| match values(row).get(index) {
                Some(ParameterValue::Text(text)) => text,
                _ => "",
            })
        }
    }
}

fn start_columns<R: 'static>(study: &Study, planned: fn(&R) -> &PlannedRun) -> Vec<Column<R>> {
    let coordinates = study.model().coordinates().into_iter().enumerate();
    coordinates
        .map(|(index, Coordinate { name, unit, meaning })| {
            let name = format!("initial_{name}");
            Column::number(&name, unit.unwrap_or(NON_DIMENSIONAL), meaning, move |row| {
                planned(row).start.0.get(index).copied()
            })
        })
        .collect()
}

/// Returns the final position of each contact: the angle of a ball or the position of a block;
/// `value` gets the position from a row.
pub fn position_columns<R: 'static>(
    study: &Study,
    meaning: &str,
    value: impl Fn(&R) -> Option<&Vec<f64>> + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let of_contact = move |row: &R, contact: usize| value(row)?.get(contact).copied();
    if study.model().balls() == 0 {
        let meaning = "position of the block at the end, from where the spring is free";
        return vec![Column::number("position_m", "m", meaning, move |row| of_contact(row, 0))];
    }
    let column = |ball: usize| {
        let name = format!("beta_{}_rad", ball + 1);
        Column::number(&name, "rad", meaning, move |row| of_contact(row, ball))
    };
    (0..study.model().balls()).map(column).collect()
}

/// Returns the columns of `runs.parquet`.
pub fn run_columns(study: &Study) -> Vec<Column<RunRecord>> {
    let mut columns = planned_columns::<RunRecord>(study, |row| &row.planned);
    columns.extend([
        Column::word("label", "how the run ended", |row: &RunRecord| row.outcome.label().name()),
        Column::word(
            "evidence",
            "evidence for the label, or the kind of \
             failure",
            |row: &RunRecord| row.outcome.evidence.name(),
        ),
    ]);
    if study.model().balls() > 0 {
        columns.push(Column::small_count(
            "balls_running",
            "balls that circulate in the ring",
            |row: &RunRecord| row.outcome.balls_running,
        ));
    }
    columns.extend([
        Column::number(
            "time_to_rest_s",
            "s",
            "time at which the last ball, or the block, stopped for good; null if it did \
             not",
            |row: &RunRecord| row.outcome.time_to_rest_s,
        ),
        Column::number(
            "end_time_s",
            "s",
            "simulated time at which the run was stopped",
            |row: &RunRecord| row.outcome.end_time_s,
        ),
        Column::truth(
            "extended",
            "whether the run was continued past the study's end time (simulation.extend)",
            |row: &RunRecord| Some(row.outcome.extended),
        ),
    ]);
    columns.extend(position_columns(
        study,
        "angle of the ball from the imbalance at the end, in [0, 2π)",
        |row: &RunRecord| row.outcome.position.as_ref(),
    ));
    columns.extend([
        Column::number("amplitude_m", "m", amplitude_meaning(study), |row: &RunRecord| {
            row.outcome.amplitude_m
        }),
        Column::number(
            "friction_margin",
            "1",
            "smallest unused fraction of the friction limit at rest; 0 on the boundary of the \
             equilibrium set, where balls creep",
            |row: &RunRecord| row.outcome.friction_margin,
        ),
        Column::number("period_s", "s", "period of the limit cycle", |row: &RunRecord| {
            row.outcome.period_s
        }),
    ]);
    columns.extend(cycle_columns(study));
    for ball in 0..study.model().balls() {
        columns.push(Column::number(
            &format!("ball_speed_{}_rad_s", ball + 1),
            "rad/s",
            "mean speed of the ball relative to the ring, positive for a growing angle, over the \
             cycle or the last tenth of the time; 0 at rest",
            move |row: &RunRecord| row.outcome.mean_speed.as_ref()?.get(ball).copied(),
        ));
    }
    if study.model().balls() > 0 {
        columns.extend(lyapunov_columns());
    }
    columns.extend([
        Column::count("steps", "accepted integration steps", |row: &RunRecord| {
            Some(row.outcome.effort.steps)
        }),
        Column::count(
            "rejected_steps",
            "integration steps rejected by error control or by event \
             location",
            |row: &RunRecord| Some(row.outcome.effort.rejected_steps),
        ),
        Column::count(
            "switches",
            "changes between stick, transition and slip",
            |row: &RunRecord| Some(row.outcome.effort.switches),
        ),
        Column::text("error", "description of the failure", |row: &RunRecord| {
            row.outcome.error.clone()
        }),
        Column::optional_word(
            "audit_label",
            "label of the audit: the run recomputed by the other method with a tenth of both \
             tolerances; null if the run was not audited",
            |row: &RunRecord| row.audit.map(|evidence| evidence.label().name()),
        ),
        Column::optional_word(
            "audit_evidence",
            "evidence for that label, or the kind of failure; null if the run was not audited",
            |row: &RunRecord| row.audit.map(Evidence::name),
        ),
    ]);
    columns
}

/// Columns of the Lyapunov exponent.
fn lyapunov_columns() -> [Column<RunRecord>; 4] {
    let column = |name: &str, unit: &str, meaning: &str, value: fn(&LyapunovExponent) -> f64| {
        Column::number(name, unit, meaning, move |row: &RunRecord| {
            row.outcome.lyapunov.as_ref().map(value)
        })
    };
    [
        column(
            "lyapunov_exponent_per_s",
            "1/s",
            "largest finite-time Lyapunov exponent over the window, for runs that still move at \
             the end time: the mean rate at which neighbouring motions separate",
            |exponent| exponent.exponent_1_s,
        ),
        column(
            "lyapunov_exponent_low_per_s",
            "1/s",
            "lower end of its 95 % confidence interval (Student, from parts of the window)",
            |exponent| exponent.interval_1_s[0],
        ),
        column(
            "lyapunov_exponent_high_per_s",
            "1/s",
            "upper end of its 95 % confidence interval",
            |exponent| exponent.interval_1_s[1],
        ),
        column(
            "lyapunov_window_s",
            "s",
            "length of the window: the last three quarters of the time, or less than half of that \
             if neighbouring motions only converged",
            |exponent| exponent.window_s,
        ),
    ]
}

/// Columns of the limit cycle.
fn cycle_columns(study: &Study) -> [Column<RunRecord>; 3] {
    [
        Column::text(
            "cycle_class",
            &class_meaning(study.model().balls()),
            |RunRecord { planned, outcome, .. }: &RunRecord| {
                let case = planned.case.as_ref().ok()?;
                Some(CycleClass::of(&case.model, outcome)?.name)
            },
        ),
        Column::number(
            "largest_multiplier",
            "1",
            "largest modulus of the Floquet multipliers off the neutral directions, of the limit \
             cycle or of the unstable orbit near the run",
            |row: &RunRecord| row.outcome.cycle.as_ref()?.multipliers.first().copied(),
        ),
        Column::small_count(
            "neutral_directions",
            "dimension of the continuous family of the limit cycle, in which resting balls have \
             other positions",
            |row: &RunRecord| Some(row.outcome.cycle.as_ref()?.neutral_directions),
        ),
    ]
}

fn amplitude_meaning(study: &Study) -> &'static str {
    if study.model().balls() > 0 {
        "amplitude of the table's vibration: at rest, or the root mean square over the cycle or \
         the last tenth of the time"
    } else {
        "half the distance between the extreme positions of the block over the cycle or the last \
         tenth of the time; 0 at rest"
    }
}

/// Returns the meaning of the text of a class.
pub(super) fn class_meaning(balls: usize) -> String {
    let parts = if balls > 0 {
        "for each ball, joined by |: rest, or turns per period (negative against the rotation of \
         the disc) and, after a colon, the sequence of its phases: S stick, F forward slip, B \
         backward slip (the n-th letters of all balls are simultaneous); identical balls are not \
         ordered"
    } else {
        "0, a colon and the sequence of the block's phases: S stick, F forward slip on the belt, B \
         backward slip"
    };
    format!("class of the limit cycle: {parts}; unknown if the orbit is only known to close")
}
