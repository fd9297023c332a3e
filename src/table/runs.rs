//! `runs.parquet`: one row per run, failures included. And the columns of planned cases.

use super::column::{Column, NON_DIMENSIONAL};
use super::cycles::class_meaning;
use super::record::RunRecord;
use crate::analysis::CycleClass;
use crate::classification::{Evidence, LyapunovExponent};
use crate::model::Coordinate;
use crate::study::{ParameterKind, ParameterValue, PlannedRun, Study, VariedParameter};

/// The columns that say which run it is and where it starts; `planned` finds that in a row.
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

/// One column for each swept parameter in a table with one row per point; `values` finds their values in a row.
pub fn swept_columns<R: 'static>(
    study: &Study,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) -> Vec<Column<R>> {
    let columns = study.swept().iter().enumerate();
    columns
        .map(|(index, swept)| swept_column(&swept.name, &swept.meaning, swept, index, values))
        .collect()
}

/// One column for each swept parameter in a table with one row per run. A parameter that is drawn for each
/// run as well (a factor of what is swept, `times`) leaves its own name to the value that the run was
/// computed with, see [`drawn_columns`]: the swept value is called `nominal_<parameter>` there.
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

/// One column for each parameter that is drawn for each run, under its own name: the value that the run was
/// computed with.
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

/// Where each contact is at the end: a ball's angle, a block's position; `value` finds it in a row.
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

/// The columns of `runs.parquet`.
pub fn run_columns(study: &Study) -> Vec<Column<RunRecord>> {
    let mut columns = planned_columns::<RunRecord>(study, |row| &row.planned);
    columns.extend([
        Column::word("label", "how the run ended", |row: &RunRecord| row.outcome.label().name()),
        Column::word("evidence", "why it has that label, or what failed", |row: &RunRecord| {
            row.outcome.evidence.name()
        }),
    ]);
    if study.model().balls() > 0 {
        columns.push(Column::small_count(
            "balls_running",
            "balls that go round the ring",
            |row: &RunRecord| row.outcome.balls_running,
        ));
    }
    columns.extend([
        Column::number(
            "time_to_rest_s",
            "s",
            "when the last ball, or the block, came to rest for good; null while moving",
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
            "least part of the friction limit left at rest, 0 on the edge of the equilibrium set, where balls creep",
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
            "mean speed of the ball relative to the ring, positive where its angle grows, over the \
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
        Column::count("rejected_steps", "steps tried and not taken: by error control, or in looking for a switch", |row: &RunRecord| {
            Some(row.outcome.effort.rejected_steps)
        }),
        Column::count(
            "switches",
            "changes between stick, transition and slip",
            |row: &RunRecord| Some(row.outcome.effort.switches),
        ),
        Column::text("error", "what went wrong, in words", |row: &RunRecord| {
            row.outcome.error.clone()
        }),
        Column::optional_word(
            "audit_label",
            "how the run ended when it was computed again, by the other method with a tenth of both \
             tolerances; null where it was not",
            |row: &RunRecord| row.audit.map(|evidence| evidence.label().name()),
        ),
        Column::optional_word(
            "audit_evidence",
            "why it has that label, or what failed; null where it was not computed again",
            |row: &RunRecord| row.audit.map(Evidence::name),
        ),
    ]);
    columns
}

/// How fast neighbouring motions separate.
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
            "largest finite-time Lyapunov exponent over the window, of runs still moving at the end \
             time: the mean rate at which neighbouring motions separate",
            |exponent| exponent.exponent_1_s,
        ),
        column(
            "lyapunov_exponent_low_per_s",
            "1/s",
            "lower end of its 95 % interval (Student, from parts of the window)",
            |exponent| exponent.interval_1_s[0],
        ),
        column(
            "lyapunov_exponent_high_per_s",
            "1/s",
            "upper end of its 95 % interval",
            |exponent| exponent.interval_1_s[1],
        ),
        column(
            "lyapunov_window_s",
            "s",
            "length of the window: the last three quarters of the time, or less than half of that \
             where neighbouring motions only drew together",
            |exponent| exponent.window_s,
        ),
    ]
}

/// What limit cycle it is.
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
            "largest modulus of the Floquet multipliers off the neutral directions, of the limit cycle \
             or of the unstable orbit that the run is near",
            |row: &RunRecord| row.outcome.cycle.as_ref()?.multipliers.first().copied(),
        ),
        Column::small_count(
            "neutral_directions",
            "dimension of the continuous family that the limit cycle belongs to: resting balls may \
             rest elsewhere",
            |row: &RunRecord| Some(row.outcome.cycle.as_ref()?.neutral_directions),
        ),
    ]
}

fn amplitude_meaning(study: &Study) -> &'static str {
    if study.model().balls() > 0 {
        "amplitude of the table's vibration: at rest, or root mean square over the cycle or the \
         last tenth of the time"
    } else {
        "half of the way between the block's extreme positions over the cycle or the last tenth \
         of the time; 0 at rest"
    }
}
