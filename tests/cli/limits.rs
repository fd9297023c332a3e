//! A limit of failures ends a study cleanly, and it continues without it.

use super::support::{Scratch, study_text, words};

/// With this normal force some runs lose contact.
fn failing() -> String {
    let rest = "model: {kind: ball_balancer, normal_force: newton, \
                parameters: {speed_rad_s: -160.8103}}\n";
    study_text("failing", "{monte_carlo: {samples: 60}}", 0.5, rest)
}

#[test]
fn failures_stop_a_study_that_says_so() {
    let scratch = Scratch::with(failing());
    scratch.ended("run a.yaml --out whole", 3);
    let labels = words(&scratch.table("whole", "runs"), "label");
    let failed = labels.iter().flatten().filter(|label| *label == "failed").count();
    assert!(failed > 8, "{failed}");
    for (option, most) in
        [("--on-failure stop", 0), ("--on-failure limit=3", 3), ("--max-failed 3", 3)]
    {
        let out = format!("out{most}{}", option.len());
        let said = [
            " runs have failed, more than --on-failure allows, after ",
            "--on-failure continue computes the others",
        ];
        scratch.tells(&format!("run a.yaml --out {out} --threads 1 {option}"), 1, &said);
        // Runs in progress, eight at a time, are finished.
        let labels = words(&scratch.table(&out, "runs"), "label");
        let stopped = labels.iter().flatten().filter(|label| *label == "failed").count();
        assert!((most + 1..=most + 20).contains(&stopped), "{option}: {stopped}");
        assert_eq!(scratch.manifest(&out)["complete"], labels.len() == 60);
        scratch.ended(&format!("resume {out}"), 3);
        assert_eq!(scratch.data(&out), scratch.data("whole"));
    }
    // A retry computes the same cases again; without changes it gives the same rows.
    let before = scratch.data("whole");
    let said = [format!("{} finished earlier, {failed} computed", 60 - failed)];
    scratch.tells("run a.yaml --out whole --retry-failed", 3, &said);
    assert_eq!(scratch.data("whole"), before);
    scratch.refuses(
        "run a.yaml --out new",
        r#"--on-failure explode ¦ found "explode", allowed: stop, continue, or limit=N
--on-failure limit=-1 ¦ found "limit=-1"
--max-seconds -1 ¦ found "-1", allowed: a number of seconds
--max-seconds nan ¦ found "nan", allowed: a number of seconds
--max-failed 1 --on-failure stop ¦ cannot be used with
--max-failed x ¦ found "x", allowed: the number of runs that may fail
--max-failed -1 ¦ found "-1", allowed: the number of runs that may fail"#,
    );
}
