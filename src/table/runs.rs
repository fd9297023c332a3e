//! `runs.parquet`: one row per run, including failed runs; and the columns of planned runs.

use super::column::{Column, Columns, NON_DIMENSIONAL};
use super::run_record::RunRecord;
use crate::analysis::CycleClass;
use crate::classification::{Evidence, LyapunovExponent};
use crate::model::{Graph, Model, OutputName, OutputValue};
use crate::study::{ParameterKind, ParameterValue, PlannedRun, Study, VariedParameter};

/// Returns the columns that identify a run and its start state; `planned` gets the planned run from
/// a row.
pub fn planned_columns<R: 'static>(
    study: &Study,
    planned: fn(&R) -> &PlannedRun,
) -> Vec<Column<R>> {
    let mut list = Columns::new();
    list.count("run_id", move |row| planned(row).run_id)
        .meaning("number of the run in the study, from 0");
    list.point_id(move |row| planned(row).point_id);
    list.count("cell", move |row| planned(row).cell).meaning("cell of the sampling design, from 0");
    list.count("replicate", move |row| planned(row).replicate)
        .meaning("number of the sample in its cell, from 0");
    add_nominal(&mut list, study, move |row| &planned(row).swept);
    add_drawn(&mut list, study, move |row| &planned(row).uncertain);
    let coordinates = study.model().coordinates();
    let all = coordinates.len();
    for (index, coordinate) in coordinates.into_iter().enumerate() {
        let name = format!("initial_{}", coordinate.name);
        list.number(name, coordinate.unit.unwrap_or(NON_DIMENSIONAL), move |row| {
            let start = &planned(row).start.0;
            start.get(place_in_start(index, all, start.len())?).copied()
        })
        .meaning(coordinate.meaning);
    }
    list.finish()
}

/// Returns the place of a coordinate of the model with the most balls, which has `all` coordinates, in a start state with
/// `of_run` coordinates; `None` if that is a coordinate of a ball that the run does not have. Positions come first, and then
/// the velocities in the same order, with the balls at the end.
fn place_in_start(index: usize, all: usize, of_run: usize) -> Option<usize> {
    if all == of_run {
        return Some(index);
    }
    let (half, half_of_run) = (all / 2, of_run / 2);
    let (is_velocity, place) = (index >= half, index % half.max(1));
    let before = if is_velocity { half_of_run } else { 0 };
    (place < half_of_run).then_some(before + place)
}

/// Adds one column for each swept parameter to a table with one row per point; `values` gets the
/// values from a row.
pub fn add_swept<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) {
    for (index, swept) in study.swept().iter().enumerate() {
        add_parameter(list, &swept.name, swept, index, values).meaning(&*swept.meaning);
    }
}

/// Adds one column for each swept parameter to a table with one row per run. If a parameter is
/// swept and multiplied by a random factor (`times`), its own name denotes the value of the run,
/// see [`add_drawn`], and the swept value is called `nominal_<parameter>`.
pub fn add_nominal<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) {
    for (index, swept) in study.swept().iter().enumerate() {
        let VariedParameter { name, meaning, .. } = swept;
        if study.uncertain().iter().all(|drawn| drawn.name != *name) {
            add_parameter(list, name, swept, index, values).meaning(&**meaning);
        } else {
            add_parameter(list, &format!("nominal_{name}"), swept, index, values).meaning(format!(
                "{meaning}: the swept value, before the factor drawn for this run"
            ));
        }
    }
}

/// Adds one column for each uncertain parameter, under its own name, with the value of the run.
pub fn add_drawn<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    values: impl Fn(&R) -> &[f64] + Copy + Send + Sync + 'static,
) {
    for (index, drawn) in study.uncertain().iter().enumerate() {
        list.number(&*drawn.name, drawn.unit, move |row| values(row).get(index).copied())
            .meaning(format!("{} (drawn for this run)", drawn.meaning));
    }
}

fn add_parameter<'a, R: 'static>(
    list: &'a mut Columns<R>,
    name: &str,
    parameter: &VariedParameter,
    index: usize,
    values: impl Fn(&R) -> &[ParameterValue] + Copy + Send + Sync + 'static,
) -> &'a mut Column<R> {
    match parameter.kind {
        ParameterKind::Number => {
            list.number(name, parameter.unit, move |row| match values(row).get(index) {
                Some(ParameterValue::Number(number)) => Some(*number),
                _ => None,
            })
        }
        ParameterKind::Text => list.word(name, move |row| match values(row).get(index) {
            Some(ParameterValue::Text(text)) => *text,
            _ => "",
        }),
    }
}

/// Adds the final angle of each ball; `value` gets the angles from a row.
pub fn add_angles<R: 'static>(
    list: &mut Columns<R>,
    study: &Study,
    meaning: &str,
    value: impl Fn(&R) -> Option<&Vec<f64>> + Copy + Send + Sync + 'static,
) {
    let model = study.model();
    for ball in 0..model.balls() {
        let (name, unit) = model.position_column(ball);
        list.number(name, unit, move |row| value(row)?.get(ball).copied()).meaning(meaning);
    }
}

/// Returns the columns of `runs.parquet`.
pub fn run_columns(study: &Study) -> Vec<Column<RunRecord>> {
    let model = study.model();
    let balls = model.balls();
    let mut list = Columns::<RunRecord>::new();
    list.extend(planned_columns(study, |row: &RunRecord| &row.planned));
    list.word("label", |row| row.outcome.label().name()).meaning("how the run ended");
    list.word("evidence", |row| row.outcome.evidence.name())
        .meaning("evidence for the label, or the kind of failure");
    if balls > 0 {
        list.small_count("balls_running", |row| row.outcome.balls_running)
            .meaning("balls that circulate in the ring");
    }
    list.number("time_to_rest_s", "s", |row| row.outcome.time_to_rest_s()).meaning(
        if study.has_stages() {
            "time from the begin of the last stage until the last ball stopped for good; null if it did not"
        } else {
            "time at which the last ball, or the block, stopped for good; null if it did not"
        },
    );
    if study.has_stages() {
        add_stages(&mut list, study);
    }
    list.number("end_time_s", "s", |row| row.outcome.end_time_s)
        .meaning("simulated time at which the run was stopped");
    list.boolean("extended", |row| row.outcome.extended)
        .meaning("whether the run was continued past the study's end time (simulation.extend)");
    let meaning = "angle of the ball from the imbalance at the end, in [0, 2π)";
    add_angles(&mut list, study, meaning, |row: &RunRecord| row.outcome.position.as_ref());
    add_outputs(&mut list, model);
    list.number("amplitude_m", "m", |row| row.outcome.amplitude_m).meaning(
        match model.ball_balancer() {
            Some(_) => {
                "amplitude of the table's vibration: at rest, or the root mean square over the \
                 cycle or the last tenth of the time"
            }
            None => {
                "amplitude over the cycle or the last tenth of the time: the largest half distance \
                 between the extreme values of a coordinate in m; 0 at rest"
            }
        },
    );
    if model.kind().offers.vibration {
        list.number("relative_amplitude", "1", RunRecord::relative_amplitude).meaning(
            "amplitude_m divided by the amplitude of the run's own machine without balls; null if \
             that machine does not vibrate",
        );
    }
    list.number("friction_margin", "1", |row| row.outcome.evidence.friction_margin()).meaning(
        "smallest unused fraction of the friction limit at rest; 0 on the boundary of the \
         equilibrium set, where balls creep",
    );
    list.number("period_s", "s", |row| row.outcome.evidence.period_s())
        .meaning("period of the limit cycle, or of the forcing of a system that creeps");
    list.text("cycle_class", |RunRecord { planned, outcome, .. }| {
        let case = planned.case.as_ref().ok()?;
        Some(CycleClass::of(&case.model, outcome)?.name)
    })
    .meaning(class_meaning(model));
    list.number("largest_multiplier", "1", |row| {
        row.outcome.evidence.cycle()?.multipliers.first().copied()
    })
    .meaning(
        "largest modulus of the Floquet multipliers, without those of neutral directions, of the \
         limit cycle or of the unstable orbit near the run",
    );
    list.small_count("neutral_directions", |row| {
        row.outcome.evidence.cycle().map(|cycle| cycle.neutral_directions)
    })
    .meaning(
        "dimension of the continuous family to which the limit cycle belongs; its members differ \
         in the positions of the resting balls",
    );
    for ball in 0..balls {
        list.number(format!("ball_speed_{}_rad_s", ball + 1), "rad/s", move |row| {
            row.outcome.mean_speed.as_ref()?.get(ball).copied()
        })
        .meaning(
            "mean speed of the ball relative to the ring, positive for a growing angle, over the \
             cycle or the last tenth of the time; 0 at rest",
        );
    }
    if let Model::Own(_) = model {
        add_stick_fractions(&mut list, model);
    }
    // Nothing separates if position and speed of one contact are the whole state.
    let components = model.system().map_or(0, |system| Graph::of(system.as_ref()).derivative.len());
    if components > 2 {
        add_lyapunov(&mut list);
    }
    if model.ball_balancer().is_some_and(|machine| machine.contact.is_some()) {
        add_touching(&mut list);
    }
    list.count("steps", |row| row.outcome.effort.steps).meaning("accepted integration steps");
    list.count("rejected_steps", |row| row.outcome.effort.rejected_steps)
        .meaning("integration steps rejected by error control or by event location");
    list.count("switches", |row| row.outcome.effort.switches)
        .meaning("changes between stick, transition and slip");
    list.text("error", |row| row.outcome.evidence.error()).meaning("description of the failure");
    list.word("audit_label", |row| row.audit.as_ref().map(|evidence| evidence.label().name()))
        .meaning(
            "label of the audit: the run recomputed by the other method with a tenth of both \
         tolerances; null if the run was not audited",
        );
    list.word("audit_evidence", |row| row.audit.as_ref().map(Evidence::name)).meaning(
        "evidence for that label, or the kind of failure; null if the run was not audited",
    );
    list.finish()
}

/// Adds the values of the outputs of a run.
fn add_outputs(list: &mut Columns<RunRecord>, model: &Model) {
    let may_creep =
        model.system().is_some_and(|system| Graph::of(system.as_ref()).layout.forcing.is_some());
    let positions: Vec<String> =
        (0..model.contacts()).map(|contact| model.position_column(contact).0).collect();
    for (place, output) in model.output_names().into_iter().enumerate() {
        let OutputName { name, unit, meaning } = output;
        let of = if meaning.is_empty() { &name } else { &meaning };
        let creeps = may_creep && positions.contains(&format!("end_{name}"));
        let values = OutputValue::COLUMNS.into_iter().chain(creeps.then_some(OutputValue::CREEP));
        for (before, value) in values {
            list.number(format!("{before}{name}"), &unit, move |row| {
                row.outcome.outputs.get(place)?.value(value)
            })
            .meaning(format!("{of}: {}", value.in_words()));
        }
    }
}

/// Adds the columns of runs with stages.
fn add_stages(list: &mut Columns<RunRecord>, study: &Study) {
    list.number("rest_since_s", "s", |row| row.outcome.evidence.rest()?.since_s)
        .meaning("time from the start of the run until the last ball stopped for good");
    list.number("last_stage_begin_s", "s", |row| Some(row.outcome.stages.last()?.time_s[0]))
        .meaning("begin of the last stage that the run reached");
    if !study.has_peaks() {
        return;
    }
    list.number("peak_amplitude_m", "m", |row| Some(row.outcome.peak?.amplitude_m))
        .meaning("largest displacement of the table in the run");
    list.number("peak_time_s", "s", |row| Some(row.outcome.peak?.time_s))
        .meaning("time of that, since the start of the run");
}

/// Adds the columns of balls with contact.
fn add_touching(list: &mut Columns<RunRecord>) {
    list.count("impacts", |row| Some(row.outcome.touching?.impacts))
        .meaning("impacts between two balls");
    list.number("touching_time_s", "s", |row| Some(row.outcome.touching?.time_s))
        .meaning("time in which any two balls touched");
    list.boolean("touching_at_end", |row| Some(row.outcome.touching?.at_end))
        .meaning("whether any two balls touched at the end of the run");
    list.number("contact_force_n", "N", |row| row.outcome.touching?.force_n).meaning(
        "force between balls that touch at rest: the smallest force with which friction holds them, 0 if each is held \
         alone, in the contact with the largest such force",
    );
    list.count("lifted_off", |row| Some(row.outcome.touching?.lifted_off)).meaning(
        "balls that an impact lifted off the ring, which the model does not follow: the friction between the balls \
         is too large for the run to be trusted",
    );
}

/// Adds for how long each contact of a system of one's own sticks in a limit cycle.
fn add_stick_fractions(list: &mut Columns<RunRecord>, model: &Model) {
    for contact in 0..model.contacts() {
        let suffix = model.contact_suffix(contact);
        list.number(format!("stick_fraction{suffix}"), "1", move |row| {
            row.outcome.evidence.cycle()?.stick_fraction.get(contact).copied()
        })
        .meaning("share of the period of the limit cycle for which the contact sticks");
    }
}

/// Adds the columns of the Lyapunov exponent.
fn add_lyapunov(list: &mut Columns<RunRecord>) {
    type Value = fn(&LyapunovExponent) -> Option<f64>;
    let mut number = |name: &str, unit: &str, value: Value, meaning: &str| {
        list.number(name, unit, move |row| row.outcome.lyapunov.as_ref().and_then(value))
            .meaning(meaning);
    };
    number(
        "lyapunov_exponent_per_s",
        "1/s",
        |exponent| Some(exponent.exponent_1_s),
        "largest finite-time Lyapunov exponent over the window, for runs that still move at the \
         end time: the mean rate at which neighbouring motions separate",
    );
    number(
        "lyapunov_exponent_low_per_s",
        "1/s",
        |exponent| Some(exponent.interval_1_s?[0]),
        "lower end of its 95 % confidence interval (Student, from the blocks of the window); null \
         with one block",
    );
    number(
        "lyapunov_exponent_high_per_s",
        "1/s",
        |exponent| Some(exponent.interval_1_s?[1]),
        "upper end of its 95 % confidence interval; null with one block",
    );
    number(
        "lyapunov_window_s",
        "s",
        |exponent| Some(exponent.window_s),
        "length of the window: the last three quarters of the time, or less than half of that if \
         neighbouring motions only converged",
    );
    list.count("lyapunov_blocks", |row| Some(u64::from(row.outcome.lyapunov?.blocks))).meaning(
        "number of blocks of the window, from 1 to 10, with at least seven turns and switches per \
         contact in each; fewer than 6 blocks leave the run undecided",
    );
}

/// Returns the meaning of the text of a class.
pub(super) fn class_meaning(model: &Model) -> String {
    let parts = if model.balls() > 0 {
        "for each ball, joined by |: rest, or turns per period (negative against the rotation of \
         the disc) and, after a colon, the sequence of its phases: S stick, F forward slip, B \
         backward slip (the n-th letters of all balls are simultaneous); identical balls are not \
         ordered"
    } else {
        "for each contact, joined by |: turns per period and, after a colon, the sequence of its phases: S stick, F \
         forward slip, B backward slip, A apart (the n-th letters of all contacts are simultaneous)"
    };
    format!("class of the limit cycle: {parts}; unknown if the orbit is only known to close")
}
