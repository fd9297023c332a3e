//! The printed output of a replay: the log of all switches for a pipe or a file, and a summary with the first switches
//! for a terminal.

use std::path::Path;

use crate::classification::{Outcome, RecordedRun, StageOutcome, Switch, Touch, TouchingOutcome};
use crate::model::{DiscMotion, Model, SlidingSpeed};
use crate::numbers::counted;
use crate::printed_table::{fact_table, text_table};
use crate::report::{three_digits, time_text};
use crate::study::ShownUnits;
use crate::table::phase_name;

/// The number of switches that are printed to a terminal.
const MOST_ON_TERMINAL: usize = 20;

/// Returns the first `most` switches as a table; for contacts with gaps, the first `most` of switches and touches in the
/// order of time.
pub fn switch_log(model: &Model, recording: &RecordedRun, most: usize) -> String {
    let units = model.units();
    let mut header = vec![
        "time_s",
        model.kind().body,
        "from",
        "to",
        "friction_n",
        "friction_limit_n",
        "normal_n",
    ];
    let has_gaps = model.system().is_some_and(|system| system.touching().is_some());
    if has_gaps {
        header.extend(match model.kind().sliding_speed {
            SlidingSpeed::RadS => ["opening_before_rad_s", "opening_after_rad_s"],
            SlidingSpeed::MS => ["opening_before_m_s", "opening_after_m_s"],
        });
    }
    let columns = header.len();
    let switch = |Switch { time, contact, before, after }: &Switch| {
        let newtons = |force| format!("{:.6e}", units.newtons(*contact, force).unwrap_or(f64::NAN));
        let mut row = vec![
            format!("{:.9}", units.seconds(*time)),
            format!("{}", contact + 1),
            phase_name(before.phase).to_owned(),
            phase_name(after.phase).to_owned(),
            newtons(before.friction),
            newtons(before.limit),
            newtons(before.normal),
        ];
        row.resize(columns, "-".to_owned());
        row
    };
    let touch = |Touch { time, before, after, .. }: &Touch| {
        let [behind, ahead] = after.contacts.map(|contact| contact + 1);
        let mut row = vec![
            format!("{:.9}", units.seconds(*time)),
            format!("{behind}-{ahead}"),
            phase_name(before.phase).to_owned(),
            phase_name(after.phase).to_owned(),
        ];
        row.resize(columns - 2, "-".to_owned());
        row.extend([before, after].map(|gap| format!("{:.6e}", units.opening_speed(gap))));
        row
    };
    let switches = recording.switches.iter().map(|change| (change.time, switch(change)));
    let mut timed: Vec<(f64, Vec<String>)> = switches.take(most).collect();
    timed.extend(recording.touches.iter().take(most).map(|impact| (impact.time, touch(impact))));
    timed.sort_by(|(left, _), (right, _)| left.total_cmp(right));
    let header = header.into_iter().map(String::from).collect();
    let rows = timed.into_iter().take(most).map(|(_, row)| row);
    let rows: Vec<Vec<String>> = std::iter::once(header).chain(rows).collect();
    text_table(&rows, &[2, 3])
}

/// Returns the label of a run, its evidence and its end time in words.
pub fn ending(outcome: &Outcome) -> String {
    let (label, evidence) = (outcome.label().name(), outcome.evidence.name());
    let end = outcome.end_time_s.map(|end| format!(" at {end:.4} s")).unwrap_or_default();
    format!("{label} ({evidence}){end}")
}

/// Returns the summary for a terminal: the ending, the final positions, the vibration, how balls touched, and the first
/// switches and touches; `file` is the table of all switches.
pub fn terminal_text(
    (model, units): (&Model, &ShownUnits),
    outcome: &Outcome,
    recording: &RecordedRun,
    file: &Path,
) -> String {
    let mut rows = vec![("ending", ending(outcome))];
    if let (Some(speed), Some(last)) = (model.disc_motion(), outcome.stages.last()) {
        rows.extend(stage_rows(&speed, units, outcome, last));
    }
    if let Some(positions) = &outcome.position {
        let angles = model.kind().sliding_speed == SlidingSpeed::RadS;
        let name = match (angles, positions.len()) {
            (false, 1) => "final position",
            (false, _) => "final positions",
            (true, 1) => "final angle",
            (true, _) => "final angles",
        };
        let shown = positions.iter().map(|position| match angles {
            false => format!("{position:.6} m"),
            true => format!("{:.1}°", position.to_degrees()),
        });
        rows.push((name, shown.collect::<Vec<_>>().join(", ")));
    }
    rows.extend(outcome.amplitude_m.map(|metres| ("vibration", vibration(units, metres))));
    let all = recording.switches.len();
    rows.push(("switches", counted(all as u64, "change") + " between stick and slip"));
    rows.extend(outcome.touching.map(|touching| ("contact", touching_words(model, touching))));
    let all = all + recording.touches.len();
    let mut text = fact_table(rows);
    if all > 0 {
        text += "\n";
        text += &switch_log(model, recording, MOST_ON_TERMINAL);
    }
    let more = all.saturating_sub(MOST_ON_TERMINAL);
    if more > 0 {
        let touches = if recording.touches.is_empty() { "" } else { " and touches.parquet" };
        let files = format!("{}{touches}", file.display());
        text += &format!("... and {more} more; pipe the output or see {files}\n");
    }
    text
}

/// Returns the rows on the stages of a run: the last one, since when the balls rest, and the largest vibration of all.
fn stage_rows(
    speed: &DiscMotion,
    units: &ShownUnits,
    outcome: &Outcome,
    last: &StageOutcome,
) -> Vec<(&'static str, String)> {
    let begin_s = last.time_s[0];
    let unit = units.speed();
    let shown = |time_s: f64| unit.of(speed.speed_rad_s(time_s));
    let at = |time_s: f64| format!("{time_s:.4} s, at {:.4} {}", shown(time_s), unit.symbol);
    let stages = outcome.stages.len();
    // A run that fails may not reach the last stage.
    let is_last = last.is_last;
    let name = if is_last { "last stage" } else { "stage" };
    let mut rows = vec![(name, format!("number {stages}, from {}", at(begin_s)))];
    let since_s = outcome.evidence.rest().and_then(|rest| rest.since_s);
    rows.extend(since_s.zip(outcome.time_to_rest_s()).map(|(since_s, after_s)| {
        let when = match since_s < begin_s {
            true => "before the last stage begins".to_owned(),
            false => format!("{after_s:.4} s after the begin of the last stage"),
        };
        ("rest since", format!("{since_s:.4} s, {when}"))
    }));
    rows.extend(outcome.peak.map(|peak| {
        let words = format!("{} at {}", vibration(units, peak.amplitude_m), at(peak.time_s));
        ("largest vibration", words)
    }));
    rows
}

fn vibration(units: &ShownUnits, metres: f64) -> String {
    let unit = units.vibration();
    format!("{} {}", three_digits(unit.of(metres)), unit.symbol)
}

/// Returns how the balls of a run touched.
fn touching_words(model: &Model, touching: TouchingOutcome) -> String {
    let TouchingOutcome { impacts, lifted_off, time_s, at_end, .. } = touching;
    let bodies = format!("{}s", model.kind().body);
    let mut words = counted(impacts, "impact");
    if time_s > 0.0 {
        words += &format!(", {bodies} touch for {}", time_text(time_s));
    }
    words += &match (at_end, time_s > 0.0) {
        (true, true) => ", also at the end".to_owned(),
        (true, false) => format!(", {bodies} touch at the end"),
        (false, _) => ", no contact at the end".to_owned(),
    };
    if lifted_off > 0 {
        words += &format!("; impacts lift {} off the ring", counted(lifted_off, model.kind().body));
    }
    words
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{switch_log, terminal_text, touching_words};
    use crate::classification::{Outcome, RecordedRun, TouchingOutcome};
    use crate::engine::record;
    use crate::study::Study;

    /// Returns the study of two balls with these keys of the model, its first run and the motion of that.
    fn first_run(model: &str) -> (Study, Outcome, RecordedRun) {
        let text = format!(
            "schema: 1\nname: a\nseed: 5\nmodel: {{kind: ball_balancer{model}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 2}}}}}}\nsimulation: {{end_time_s: 4.5}}\n"
        );
        let study = Study::parse(Path::new("a.yaml"), text).expect("a valid study");
        let (record, recording) = record(&study, 0, None);
        (study, record.outcome, recording)
    }

    fn shown(study: &Study, outcome: &Outcome, recording: &RecordedRun) -> String {
        let file = Path::new("b/switches.parquet");
        terminal_text((study.model(), study.units()), outcome, recording, file)
    }

    #[test]
    fn a_terminal_shows_the_first_switches() {
        let (study, outcome, mut recording) = first_run("");
        let switch = recording.switches[0].clone();
        recording.switches.resize(25, switch);
        let text = shown(&study, &outcome, &recording);
        let ending = format!("ending        {}", outcome.label().name());
        for part in [&*ending, "\nfinal angles  ", "\nvibration     ", " µm\n", "25 changes"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let more = "\n... and 5 more; pipe the output or see b/switches.parquet\n";
        assert!(text.ends_with(more), "{text}");
        let log = switch_log(study.model(), &recording, 20);
        assert!(log.lines().count() == 21 && text.contains(&log), "{text}");
        recording.switches.truncate(1);
        let text = shown(&study, &outcome, &recording);
        assert!(text.contains(" 1 change between") && !text.contains("more"), "{text}");
    }

    #[test]
    fn a_terminal_shows_the_stages() {
        // With strong friction the balls never move.
        for (friction, moves) in [("0.005", true), ("0.05", false)] {
            let (study, outcome, recording) = first_run(&format!(
                ", parameters: {{friction_coefficient: {friction}}}, \
                 speed_profile: [{{ramp: {{from_rad_s: -100, over_s: 0.5}}}}, {{hold_s: 4}}]"
            ));
            let text = shown(&study, &outcome, &recording);
            let stage = "\nlast stage         number 2, from 0.5000 s, at -216.3772 rad/s\n";
            assert!(text.contains(stage), "{text}");
            let since = outcome
                .evidence
                .rest()
                .and_then(|rest| rest.since_s)
                .expect("a run that comes to rest");
            let rest = match moves {
                true => format!("{since:.4} s, {:.4} s after the begin of", since - 0.5),
                false => "0.0000 s, before the last stage begins".to_owned(),
            };
            assert!(text.contains(&format!("\nrest since         {rest}")), "{text}");
            let peak = outcome.peak.expect("a largest amplitude");
            let words = format!(" µm at {:.4} s, at -", peak.time_s);
            assert!(text.contains("\nlargest vibration  ") && text.contains(&words), "{text}");
        }
    }

    #[test]
    fn a_terminal_shows_contact() {
        let (study, outcome, recording) =
            first_run(", contact: {}, parameters: {speed_rad_s: -173.1803}");
        let touching = outcome.touching.expect("contact");
        let rows = recording.switches.len() + recording.touches.len();
        let text = shown(&study, &outcome, &recording);
        let words = format!("\ncontact       {} impacts, balls touch for ", touching.impacts);
        assert!(touching.impacts > 1 && touching.time_s > 0.0 && text.contains(&words), "{text}");
        let end = if touching.at_end { "also at the end\n" } else { "no contact at the end\n" };
        assert!(text.contains(end), "{text}");
        let more = format!(
            "\n... and {} more; pipe the output or see b/switches.parquet and touches.parquet\n",
            rows - 20
        );
        assert!(text.ends_with(&more), "{text}");
        let once = TouchingOutcome {
            impacts: 1,
            lifted_off: 2,
            time_s: 0.0,
            at_end: false,
            force_n: None,
        };
        let words = touching_words(study.model(), once);
        assert_eq!(words, "1 impact, no contact at the end; impacts lift 2 balls off the ring");
    }
}
