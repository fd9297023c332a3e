//! `replay`: the run behind a row equals the row, and differences are reported.

use std::fs;
use std::sync::Arc;

use arrow::array::{ArrayRef, UInt64Array};

use super::foreign::{texts, with};
use super::summary::{kill, rewrite, without};
use super::support::{Scratch, assert_has, column, counts, numbers, study_text, words};
use crate::support::cases;

/// Balls with contact on a table that is kicked twice, with balls that rest at the first kick.
const KICKED: &str = "model: {kind: ball_balancer, contact: {}, \
    speed_profile: [{ramp: {from_rad_s: -216, over_s: 0.1}}], \
    disturbances: [{kick: {at_s: 0.05, speed_m_s: 0.1}}, {kick: {at_s: 1.5, speed_m_s: 0.2, direction_rad: 1}}]}\n";

/// Studies of all kinds, with the runs to replay: both methods, one ball and three, a law without
/// stick, audited and continued runs, failures, physically invalid samples, blocks, a disc that starts, a table that is
/// kicked.
const STUDIES: &str = r"two ¦ sweep: [{grid: {speed_rad_s: [-179.2671, -216.3772]}}]\naudit: {fraction: 0.5}\n ¦ 3.0 ¦ 8
one ¦ model: {kind: ball_balancer, parameters: {balls: 1}}\n ¦ 1.0 ¦ 3
three ¦ model: {kind: ball_balancer, parameters: {balls: 3}}\n ¦ 1.0 ¦ 3
smooth ¦ model: {kind: ball_balancer, friction: {smooth: {smoothing_speed_rad_s: 2}}}\n ¦ 0.2 ¦ 3
failing ¦ model: {kind: ball_balancer, parameters: {table_mass_kg: 2.0e-2, ball_mass_kg: 1.5e-1, speed_rad_s: -60, friction_coefficient: 3}}\n ¦ 1.0 ¦ 4
drawn ¦ uncertain: {ball_mass_2_kg: {normal: {mean: 1.0e-4, std_dev: 2.0e-4}}}\n ¦ 0.1 ¦ 4
starts ¦ model: {kind: ball_balancer, speed_profile: [{ramp: {from_rad_s: -100, to_rad_s: -150, over_s: 0.3}}, {hold_s: 0.2}, {smooth_ramp: {over_s: 0.5}}]}\naudit: {fraction: 0.5}\n ¦ 2.0 ¦ 4
kicked ¦ KICKED ¦ 2.0 ¦ 4
spring ¦ model: {kind: block_on_spring}\n ¦ 5.0 ¦ 4
belt ¦ model: {kind: block_on_belt, friction: {stribeck: {static_friction_coefficient: 0.2, stribeck_speed_m_s: 0}}}\n ¦ 5.0 ¦ 4";

#[test]
fn runs_of_all_kinds_are_their_rows() {
    let scratch = Scratch::new();
    let mut labels = std::collections::BTreeSet::new();
    for [name, rest, end_time, runs] in cases(STUDIES) {
        let rest = rest.replace("KICKED", KICKED);
        let (end_time_s, runs): (_, u64) =
            (end_time.parse().expect("a time"), runs.parse().expect("a number"));
        let file = format!("{name}.yaml");
        scratch.write(&file, study_text(&name, "{monte_carlo: {samples: 4}}", end_time_s, &rest));
        let ended = scratch.stickslip(&format!("run {file} --out {name}"));
        assert!([Some(0), Some(3)].contains(&ended.code), "{}", ended.err);
        let rows = scratch.table(&name, "runs");
        for run in 0..runs {
            let ended = scratch.stickslip(&format!("replay {name} {run} --json"));
            assert_eq!(ended.code, Some(0), "{name} {run}\n{}", ended.err);
            assert_has(&ended.err, &["equal to its row in all "]);
            let report = ended.json();
            assert_eq!(report["same_as_row"], true);
            let switches = counts(&rows, "switches")[run as usize];
            assert_eq!(report["switches"], switches);
            let out = format!("{name}-replay-{run}");
            assert_eq!(scratch.table(&out, "switches").num_rows() as u64, switches);
            let trajectory = scratch.table(&out, "trajectory");
            assert_eq!(report["rows"], trajectory.num_rows());
            labels.extend(words(&rows, "label")[run as usize].clone());
        }
    }
    for label in ["equilibrium", "limit_cycle", "undecided", "failed"] {
        assert!(labels.contains(label), "{label} not in {labels:?}");
    }
}

#[test]
fn the_tables_of_a_motion() {
    let study = study_text("a", "{monte_carlo: {samples: 2}}", 2.0, "");
    let scratch = Scratch::with(study);
    scratch.well("run a.yaml --out a");
    let text = scratch.well("replay a 1");
    let switches = scratch.table("a-replay-1", "switches");
    assert_eq!(text.lines().count(), switches.num_rows() + 1);
    assert_has(&text, &["time_s", "friction_limit_n", "slip_"]);
    scratch.well("replay a 1 --times 0.1:0.3:201 --out b");
    let at = scratch.table("b", "trajectory");
    let times: Vec<f64> = numbers(&at, "time_s").into_iter().flatten().collect();
    assert_eq!(times.len(), 201);
    let natural = 181.633;
    for (index, time) in times.iter().enumerate() {
        assert!((time - (0.1 + 0.001 * index as f64)).abs() < 1e-12);
        let plain = numbers(&at, "time")[index].unwrap();
        assert!((plain / time / natural - 1.0).abs() < 1e-5);
    }
    // The table in space from that in the turning frame, and its velocity from differences.
    let of = |name: &str| numbers(&at, name).into_iter().flatten().collect::<Vec<f64>>();
    let speed = -216.3772;
    let (x, y, there, across) = (of("x_m"), of("y_m"), of("x_inertial_m"), of("y_inertial_m"));
    for index in 0..201 {
        let (sine, cosine) = (speed * times[index]).sin_cos();
        assert!((cosine * x[index] - sine * y[index] - there[index]).abs() < 1e-15);
        assert!((sine * x[index] + cosine * y[index] - across[index]).abs() < 1e-15);
    }
    let velocity = of("x_dot_inertial_m_s");
    let largest = velocity.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
    for index in 1..200 {
        let difference = (there[index + 1] - there[index - 1]) / 0.002;
        assert!((difference - velocity[index]).abs() < 0.02 * largest, "{index}");
    }
    // Angles, speeds and forces.
    let unwrapped = of("beta_unwrapped_2_rad");
    for (wrapped, unwrapped) in of("beta_2_rad").into_iter().zip(unwrapped) {
        assert!((0.0..std::f64::consts::TAU).contains(&wrapped));
        let part = ((wrapped - unwrapped) / std::f64::consts::TAU).fract().abs();
        assert!(!(1e-9..=1.0 - 1e-9).contains(&part), "{part}");
    }
    // m ω_n² L with the thesis's ball and ring.
    let (normal, plain) = (of("normal_1_n"), of("normal_1"));
    let limit = of("friction_limit_1_n");
    for index in 0..201 {
        assert!((limit[index] - 2.75e-3 * normal[index]).abs() < 1e-12);
        assert!((normal[index] / plain[index] / (normal[0] / plain[0]) - 1.0).abs() < 1e-12);
    }
    scratch.well("replay a 1 --times 0.1:0.3:201 --out c");
    for file in ["trajectory.parquet", "switches.parquet"] {
        let [first, again] = ["b", "c"].map(|folder| scratch.bytes(&format!("{folder}/{file}")));
        assert!(first == again, "{file}");
    }
}

/// The speed of the disc is that of the profile, and the disc has turned by its integral. A kick breaks balls loose that
/// rest, at its very time, which is a switch.
#[test]
fn the_motion_of_a_disc_that_starts() {
    let study = study_text("a", "{monte_carlo: {samples: 3}}", 2.0, KICKED);
    let scratch = Scratch::with(study);
    scratch.well("run a.yaml --out a");
    let mut broken_loose = 0;
    for run in 0..3 {
        scratch.well(&format!("replay a {run}"));
        let out = format!("a-replay-{run}");
        let all = scratch.table(&out, "trajectory");
        let of = |name: &str| numbers(&all, name).into_iter().flatten().collect::<Vec<f64>>();
        let (times, speeds) = (of("time_s"), of("speed_rad_s"));
        let last = -216.3772;
        for (time, speed) in times.iter().zip(&speeds) {
            let expected = -216.0 + (last + 216.0) * (time / 0.1).min(1.0);
            assert!((speed - expected).abs() < 1e-9, "{speed} {expected} at {time}");
        }
        let (x, y, there) = (of("x_m"), of("y_m"), of("x_inertial_m"));
        for (index, time) in times.iter().enumerate() {
            let ramp = time.min(0.1);
            let turned = -216.0 * ramp + 5.0 * (last + 216.0) * ramp * ramp + last * (time - ramp);
            let (sine, cosine) = turned.sin_cos();
            assert!((cosine * x[index] - sine * y[index] - there[index]).abs() < 1e-12, "{time}");
        }
        // The position is continuous at a kick, the velocity jumps by its speed.
        let [before, after] = [0, 1].map(|place| {
            let mut at = times.iter().enumerate().filter(|(_, time)| (**time - 1.5).abs() < 1e-9);
            at.nth(place).expect("two rows at the kick").0
        });
        assert_eq!((x[before], y[before]), (x[after], y[after]));
        let [along, across] = ["x_dot_inertial_m_s", "y_dot_inertial_m_s"].map(of);
        let jump = (along[after] - along[before]).hypot(across[after] - across[before]);
        // The impact of balls that touched before the kick moves the table by a few µm/s.
        assert!((jump - 0.2).abs() < 1e-5, "{jump} m/s");
        let direction = (across[after] - across[before]).atan2(along[after] - along[before]);
        assert!((direction - 1.0).abs() < 1e-4, "{direction} rad");
        // Only balls that rest change their phase, and each does.
        let switches = scratch.table(&out, "switches");
        let from = words(&switches, "from");
        let is_kick = |time: f64| (time - 0.05).abs() < 1e-9 || (time - 1.5).abs() < 1e-9;
        let switched = numbers(&switches, "time_s").into_iter().zip(from);
        let at_kick = switched.filter(|(time, from)| {
            is_kick(time.expect("each switch has a time")) && from.as_deref() == Some("stick")
        });
        broken_loose += at_kick.count();
        // Requested times have the motion after the kick.
        scratch.well(&format!("replay a {run} --times 1.5:1.5:1 --out b"));
        let at = scratch.table("b", "trajectory");
        let found = numbers(&at, "x_dot_inertial_m_s")[0].expect("a speed at the requested time");
        assert!((found - along[after]).abs() < 1e-12, "{found}");
        fs::remove_dir_all(scratch.path("b")).expect("a folder of this test");
    }
    assert!(broken_loose > 0, "no ball rests at the kick");
    // A disc with constant speed has no such column.
    scratch.write("c.yaml", study_text("c", "{monte_carlo: {samples: 1}}", 0.02, ""));
    scratch.well("run c.yaml --out c");
    scratch.well("replay c 0");
    let plain = scratch.table("c-replay-0", "trajectory");
    assert!(plain.column_by_name("speed_rad_s").is_none());
}

#[test]
fn a_row_that_is_not_the_run_is_shown() {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 2}}", 0.05, ""));
    let steps = counts(&scratch.table("out", "runs"), "steps");
    let more: ArrayRef = Arc::new(steps.iter().map(|steps| steps + 1).collect::<UInt64Array>());
    rewrite(&scratch, "runs", |batch| with(&batch, "steps", more.clone()));
    let ended = scratch.ended("replay out 1 --json", 1);
    let line = format!("steps: {} stored, {} computed", steps[1] + 1, steps[1]);
    assert_has(&ended.err, &["NOT equal to its row in 1 of ", &line]);
    let report = ended.json();
    assert_eq!(report["same_as_row"], false);
    assert_eq!(report["differences"][0]["column"], "steps");

    let right = scratch.bytes("out/runs.parquet");
    rewrite(&scratch, "runs", |batch| without(batch, "steps"));
    let lacks = ["runs.parquet: this table of runs lacks a column", "no column steps", "allowed: "];
    scratch.refused("replay out 0", &lacks);
    rewrite(&scratch, "runs", |batch| with(&batch, "run_id", texts(2, "x")));
    let unreadable = "runs.parquet: this is not a readable table of runs";
    scratch.refused("replay out 0", &[unreadable, "run_id of type Utf8"]);
    scratch.write("out/runs.parquet", "PAR1 and no more PAR1");
    scratch.refused("replay out 0", &["runs.parquet: this is not the file that was written"]);
    scratch.list_again("out", "runs.parquet");
    scratch.refused("replay out 0", &[unreadable, "found: "]);
    // A short footer that announces 2^31 - 1 columns and a truncated footer are refused without allocating memory.
    let announced = [0x15, 2, 0x19, 0x1c, 0x48, 1, b'a', 0x15, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0, 0];
    let announced = [b"PAR1", &announced[..], &15_u32.to_le_bytes(), b"PAR1"].concat();
    let cut_off = [&right[..right.len() / 2], &right[right.len() - 8..]].concat();
    for hostile in [announced, cut_off] {
        scratch.write("out/runs.parquet", hostile);
        scratch.list_again("out", "runs.parquet");
        scratch.refused("replay out 0", &[unreadable, "a footer", "allowed: "]);
    }
}

/// In the results of an interrupted study, a missing run can be replayed, without a comparison. A killed study has no tables,
/// but its finished runs are in `chunks/`.
#[test]
fn runs_of_studies_that_did_not_end() {
    let scratch = Scratch::ran(study_text("a", "{monte_carlo: {samples: 9}}", 0.02, ""));
    kill(&scratch);
    let ended = scratch.tells("replay out 3 --json", 0, &["equal to its row in all "]);
    assert_eq!(ended.json()["same_as_row"], true);
    assert_eq!(scratch.stickslip("run a.yaml --out a --max-seconds 0").code, Some(130));
    let said = ["not compared, because a has not finished this run yet (the study has 9 runs)"];
    let ended = scratch.tells("replay a 3 --json", 0, &said);
    assert!(ended.json()["same_as_row"].is_null());
    assert!(column(&scratch.table("a-replay-3", "trajectory"), "x_m").len() > 3);
}

#[test]
fn what_cannot_be_replayed() {
    let scratch = Scratch::with(study_text("a", "{monte_carlo: {samples: 9}}", 0.02, ""));
    scratch.well("run a.yaml --out a");
    scratch.well("run a.yaml --out part --shard 1/3");
    let of_part = counts(&scratch.table("part", "runs"), "run_id");
    let other = (0..9).find(|run| !of_part.contains(run)).unwrap();
    let occupied = scratch.path("full");
    fs::create_dir(&occupied).unwrap();
    scratch.write("full/mine", "mine");
    fs::create_dir(scratch.path("empty")).unwrap();
    let table = r#"replay empty 0 ¦ empty: this directory holds no results ¦ no manifest.json
replay a 9 ¦ run 9 of a study with 9 runs ¦ run numbers from 0 to 8
replay a x ¦ RUN_ID ¦ found "x", allowed: a whole number from 0, as in 17
replay a -- -1 ¦ RUN_ID ¦ found "-1", allowed: a whole number from 0
replay part OTHER ¦ which is not among the 3 runs ¦ shard 1/3
replay a 0 --out full ¦ full: this directory is not empty ¦ --out DIR
replay a 0 --times 1:0:5 ¦ 5 times from 1 to 0 s ¦ as in 0:5:2001 (FROM:TO:N in s)
replay a 0 --times 0:1 ¦ found "0:1" ¦ as in 0:5:2001 (FROM:TO:N in s)
replay a 0 --times=-1:1:3 ¦ the times "-1" ¦ as in 0:5:2001 (FROM:TO:N in s)
replay a 0 --times 0:1:0 ¦ number of times "0" ¦ as in 0:5:2001 (FROM:TO:N in s)
replay a 0 --times 0:nan:2 ¦ the times ¦ as in 0:5:2001 (FROM:TO:N in s)
replay a 0 --times 0:1:3 --every-step ¦ cannot be used with ¦ --every-step"#;
    scratch.refuses("", &table.replace("OTHER", &other.to_string()));
}
