//! Progress output while runs are computed: lines for people, events for programs.

use serde_json::Value;

use super::support::{AT_ONCE, Scratch, assert_has, json_lines, study_text};

/// A study with this number of points and eight runs each.
fn scratch(points: u32) -> Scratch {
    let speeds: Vec<String> = (0..points).map(|n| format!("-{}.0", 160 + n)).collect();
    let sweep = format!(
        "sweep: [{{grid: {{speed_rad_s: [{}]}}}}]\n\
         uncertain: {{ball_mass_kg: {{normal: {{mean: 1.4e-4, std_dev: 1.4e-4}}}}}}\n",
        speeds.join(", ")
    );

    Scratch::with(study_text("a", "{monte_carlo: {samples: 8}}", AT_ONCE, &sweep))
}

#[test]
fn events_are_json_line_by_line() {
    let scratch = scratch(50);
    let ended = scratch.ended("run a.yaml --out out --quiet --json --progress json", 3);
    let report = ended.json();
    let events = json_lines(&ended.err);
    let names: Vec<&str> = events.iter().map(|event| event["event"].as_str().unwrap()).collect();
    let (begun, last) = (&events[0], &events[events.len() - 1]);
    assert_eq!((names[0], names[names.len() - 1]), ("begun", "ended"));
    let planned = ["study", "runs_planned", "points_planned", "runs_are_at_most"];
    let planned = planned.map(|key| begun[key].clone());
    assert_eq!(planned, ["a".into(), 400.into(), 50.into(), Value::from(false)]);
    // Every point, in order, with the values of its report.
    let points: Vec<&Value> = events.iter().filter(|event| event["event"] == "point").collect();
    let reported = report["points"].as_array().unwrap();
    assert_eq!((points.len(), reported.len()), (50, 50));
    for (point, reported) in points.iter().zip(reported) {
        for (key, value) in reported.as_object().unwrap() {
            assert_eq!(point[key], *value, "{key}");
        }
    }
    let failed: u64 = reported.iter().map(|point| point["failed_runs"].as_u64().unwrap()).sum();
    assert!(failed > 0);
    assert_eq!((&last["runs_finished"], &last["failed_runs"]), (&400.into(), &failed.into()));
    assert_eq!((&last["interrupted"], &last["runs_kept"]), (&false.into(), &0.into()));
    assert_eq!((&last["runs_planned"], &last["runs_left_at_most"]), (&400.into(), &0.into()));
    assert_eq!(last["equilibrium_fraction"], 0.0);
    assert!(last["ci_high"].as_f64().unwrap() > failed as f64 / 400.0);
    let times: Vec<f64> = events.iter().map(|event| event["elapsed_s"].as_f64().unwrap()).collect();
    assert!(times[0] == 0.0 && times[times.len() - 1] > 0.0);

    // Without --quiet, messages appear too; they are not objects.
    let ended = scratch.stickslip("run a.yaml --out more --progress json --max-seconds 0");
    let (objects, messages): (Vec<&str>, Vec<&str>) =
        ended.err.lines().partition(|line| line.starts_with('{'));
    let last: Value = serde_json::from_str(objects[objects.len() - 1]).unwrap();
    assert_eq!((&last["event"], &last["interrupted"]), (&"ended".into(), &true.into()));
    assert_eq!((&last["equilibrium_fraction"], &last["left_s"]), (&Value::Null, &Value::Null));
    assert_has(&messages.join("\n"), &["tables in more", "out of time"]);
}

/// In a study with a precision the planned number of runs stays the largest one; the remaining number decreases.
#[test]
fn planned_runs_have_one_meaning() {
    let precision = "precision: {equilibrium_fraction: 0.1, max_runs: 50}\n";
    let scratch =
        Scratch::with(study_text("a", "{monte_carlo: {samples: 15}}", AT_ONCE, precision));
    let ended = scratch.ended("run a.yaml --out out --quiet --progress json", 0);
    let events = json_lines(&ended.err);
    let (begun, last) = (&events[0], &events[events.len() - 1]);
    assert_eq!((&begun["runs_are_at_most"], &last["runs_left_at_most"]), (&true.into(), &0.into()));
    assert_eq!(begun["runs_planned"], last["runs_planned"]);
    assert_eq!(begun["runs_planned"], scratch.manifest("out")["runs_planned"]);
    assert!(last["runs_finished"].as_u64() < last["runs_planned"].as_u64());
}

#[test]
fn each_of_a_few_points_has_a_line() {
    let scratch = scratch(3);
    for arguments in ["run a.yaml --out auto", "run a.yaml --out lines --progress lines"] {
        let ended = scratch.stickslip(arguments);
        let lines: Vec<&str> =
            ended.err.lines().filter(|line| line.starts_with("point ")).collect();
        assert_eq!(lines.len(), 3, "{}", ended.err);
        assert_has(
            lines[1],
            &[
                "point 1 speed_rad_s=-161: 8 runs, vibration ",
                " without balls; ",
                "; 0.0 % at rest (0.0 .. ",
            ],
        );
        let failed = ended.out.lines().nth(3).unwrap().split_whitespace().last().unwrap();
        let said = if failed == "0" { " %)".to_owned() } else { format!(" %), {failed} failed") };
        assert!(lines[1].ends_with(&said), "{said}: {}", lines[1]);
    }
    for arguments in
        ["run a.yaml --out none --progress none", "run a.yaml --out bar --progress bar"]
    {
        let ended = scratch.stickslip(arguments);
        assert!(!ended.err.contains("point "), "{}", ended.err);
        assert_has(&ended.err, &["24 runs in "]);
    }
    // Progress that is requested explicitly is printed.
    let ended = scratch.stickslip("run a.yaml --out asked --progress lines --quiet");
    assert_eq!((ended.err.matches("point ").count(), ended.out.as_str()), (3, ""));
    scratch.refused("run a.yaml --progress dots", &["--progress", "dots", "auto", "json"]);
}

/// With many points at most one per second has a line, and the others are counted.
#[test]
fn many_points_share_lines() {
    let scratch = scratch(60);
    let ended = scratch.ended("run a.yaml --out out", 3);
    let mut told = 0;
    let mut lines = 0;
    for line in ended.err.lines() {
        let number = |before: &str, after: &str| -> u64 {
            let rest = match before {
                "" => line,
                before => line.rsplit_once(before).map_or("", |(_, rest)| rest),
            };
            rest.split_once(after).and_then(|(number, _)| number.parse().ok()).unwrap_or(0)
        };
        if line.starts_with("point ") {
            lines += 1;
            told += 1 + number("(", " earlier points not shown)");
        } else if line.ends_with(" more points finished") {
            told += number("", " more points");
        }
    }
    assert_eq!(told, 60, "{}", ended.err);
    assert!((1..=60).contains(&lines), "{}", ended.err);
}
