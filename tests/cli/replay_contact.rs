//! `replay` of balls that touch: gaps in the trajectory, the table of touches, the text and the animation.

use arrow::array::{AsArray, RecordBatch};
use serde_json::Value;

use super::support::{Scratch, assert_has, column, counts, numbers, study_text, words};
use crate::docs::named::columns_are_on_pages;
use crate::table::contract::{columns, listed};

const MODEL: &str =
    "model: {kind: ball_balancer, parameters: {speed_rad_s: -173.1803}, contact: {}}\n";

/// Returns a folder with the results `a` of four runs of two balls with contact.
fn results() -> Scratch {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 4}}", 3.0, MODEL));
    scratch.well("run a.yaml --out a");
    scratch
}

fn truths(table: &RecordBatch, name: &str) -> Vec<bool> {
    column(table, name).as_boolean().iter().map(Option::unwrap).collect()
}

fn known(table: &RecordBatch, name: &str) -> Vec<f64> {
    numbers(table, name).into_iter().map(Option::unwrap).collect()
}

/// Rows, touches and the JSON output agree with the row of the run.
#[test]
fn a_run_with_contact_has_its_touches() {
    let scratch = results();
    let runs = scratch.table("a", "runs");
    let mut impacts = 0;
    for run in 0..4 {
        let json = scratch.json(&format!("replay a {run} --json"));
        let out = format!("a-replay-{run}");
        let files = ["trajectory.parquet", "switches.parquet", "touches.parquet", "replay.html"];
        assert_eq!(json["files"].as_array().unwrap()[..4], files);
        let [trajectory, touches] = ["trajectory", "touches"].map(|name| scratch.table(&out, name));
        let row = run as usize;
        assert_eq!(json["same_as_row"], true);
        assert_eq!(json["impacts"], counts(&runs, "impacts")[row]);
        assert_eq!(json["touching_time_s"], known(&runs, "touching_time_s")[row]);
        assert_eq!(json["touching_at_end"], truths(&runs, "touching_at_end")[row]);
        assert_eq!(json["contact_force_n"].as_f64(), numbers(&runs, "contact_force_n")[row]);
        assert_eq!(json["lifted_off"], counts(&runs, "lifted_off")[row]);
        let from = words(&touches, "from");
        let hits = from.iter().filter(|phase| phase.as_deref() == Some("open")).count();
        assert_eq!(hits as u64, counts(&runs, "impacts")[row]);
        impacts += hits;

        // At the times of the touches, a gap of the trajectory is closed or just closing.
        let [gap, other] = ["gap_1_2_rad", "gap_2_1_rad"].map(|name| known(&trajectory, name));
        let [touching, also] =
            ["touching_1_2", "touching_2_1"].map(|name| truths(&trajectory, name));
        let times = known(&trajectory, "time_s");
        let behind = counts(&touches, "ball_behind");
        for (time, behind) in known(&touches, "time_s").into_iter().zip(behind) {
            let place = times.iter().position(|at| *at == time).expect("a row");
            let width = if behind == 1 { gap[place] } else { other[place] };
            assert!(width.abs() < 1e-8, "{time} {width}");
        }
        assert!(gap.iter().zip(&touching).all(|(gap, closed)| !closed || gap.abs() < 1e-8));
        assert!(other.iter().zip(&also).all(|(gap, closed)| !closed || gap.abs() < 1e-8));
        let last = touching.last().unwrap() | also.last().unwrap();
        assert_eq!(json["touching_at_end"], last);
        columns_are_on_pages(&scratch.path(&out));
    }
    assert!(impacts > 10, "{impacts}");
}

/// The columns of gaps and touches; the text, in which switches and touches have the order of time; and the animation, which
/// has the gaps, whether balls touch in each frame, and the times of the impacts in its interval.
#[test]
fn tables_text_and_animation_have_the_touches() {
    let scratch = results();
    let text = scratch.well("replay a 0");
    let [trajectory, touches, switches] =
        ["trajectory", "touches", "switches"].map(|name| scratch.table("a-replay-0", name));
    let named = columns(&trajectory);
    let gaps = ["gap_1_2_rad n rad", "touching_1_2 b -", "gap_2_1_rad n rad", "touching_2_1 b -"];
    let first = named.iter().position(|name| name == gaps[0]).expect("gaps");
    assert_eq!(named[first..first + 4], gaps);
    let expected = listed(
        "time_s n s, ball_behind c -, ball_ahead c -, from w -, to w -, beta_behind_rad n rad, \
         beta_ahead_rad n rad, opening_speed_before_rad_s n rad/s, \
         opening_speed_after_rad_s n rad/s, time n 1 (non-dimensional)",
    );
    assert_eq!(columns(&touches), expected);

    let (switches, touched) = (switches.num_rows(), touches.num_rows());
    assert!(switches > 0 && touched > 0, "{switches} {touched}");
    let mut lines = text.lines();
    assert_has(lines.next().unwrap(), &["opening_before_rad_s", "opening_after_rad_s"]);
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows.len(), switches + touched);
    let times: Vec<f64> = rows.iter().map(|row| row[0].parse().unwrap()).collect();
    assert!(times.is_sorted(), "{times:?}");
    let pairs = rows.iter().filter(|row| ["1-2", "2-1"].contains(&row[1]));
    assert_eq!(pairs.clone().count(), touched);
    for row in pairs {
        assert!(["open", "closed"].contains(&row[2]) && row[4..7] == ["-", "-", "-"], "{row:?}");
    }

    let all = known(&touches, "time_s");
    let half = all[all.len() / 2];
    scratch.well(&format!("replay a 0 --times 0:{half}:3 --out part"));
    let data = |directory: &str| -> Value {
        let page = scratch.text(&format!("{directory}/replay.html"));
        let begin = page.find("const data = ").unwrap() + "const data = ".len();
        let text = page[begin..].lines().next().unwrap().trim_end_matches(';');
        serde_json::from_str(text).unwrap()
    };
    let whole = data("a-replay-0");
    // Two balls, and then the gaps between them.
    let contacts = |data: &Value| data["contacts"].as_array().expect("contacts").clone();
    let names = contacts(&whole).into_iter().map(|contact| contact["name"].clone());
    let expected = ["ball 1", "ball 2", "balls 1 and 2", "balls 2 and 1"];
    assert_eq!(names.collect::<Vec<_>>(), expected);
    let frames = whole["frames"].as_u64().expect("a number") as usize;
    let phases = |contact: &Value| contact["phases"].as_str().expect("a text").len();
    assert!(contacts(&whole).iter().all(|contact| phases(contact) == frames));
    let closes = |contact: &Value| contact["closes"].as_array().expect("times").len() as u64;
    let impacts = |data: &Value| contacts(data).iter().map(closes).sum::<u64>();
    assert_eq!(impacts(&whole), counts(&scratch.table("a", "runs"), "impacts")[0]);
    assert!((1..impacts(&whole)).contains(&impacts(&data("part"))));

    // Without contact there is none of this.
    scratch.write("b.yaml", study_text("b", "{monte_carlo: {samples: 1}}", 0.2, ""));
    scratch.well("run b.yaml --out b");
    scratch.well("replay b 0");
    let plain = columns(&scratch.table("b-replay-0", "trajectory"));
    let without: Vec<String> =
        named.into_iter().filter(|name| !gaps.contains(&name.as_str())).collect();
    assert_eq!(plain, without);
    assert!(!scratch.path("b-replay-0/touches.parquet").exists());
    let plain = data("b-replay-0");
    assert_eq!(contacts(&plain).len(), 2);
}
