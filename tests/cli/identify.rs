//! `stickslip identify`: synthetic measurements with known truths, reproducibility, and errors.

use std::fmt::Write;

use stickslip::study::Study;

use super::support::{Scratch, numbers, words};

/// Two speeds at which all runs rest, with few runs and parameter sets.
fn identify(contact: &str, samples: u32) -> String {
    format!(
        "schema: 1\nname: small\nseed: 3\nmodel:\n  kind: ball_balancer\n  contact: {contact}\n\
         sweep: [{{grid: {{speed_rad_s: [-140, -160.8103]}}}}]\n\
         initial_conditions: {{design: {{monte_carlo: {{samples: {samples}}}}}}}\n\
         simulation: {{endings: rest}}\n\
         identify:\n  parameters: {{friction_coefficient: {{from: 1.0e-3, to: 6.0e-3, spacing: logarithmic}}}}\n\
         \x20 start_designs: 12\n  designs: 20\n  posterior_samples: 800\n"
    )
}

const TOUCHING: &str = "{restitution: 0.36, friction_coefficient: 0.1}";

/// The measurement error of an angle, rad: 0.1 times a number that depends on run and ball, with the standard deviation 1.
fn error(run: usize, ball: usize) -> f64 {
    let uniform = (0..12).map(|part| {
        let bits =
            (run as u64 * 31 + ball as u64 * 7 + part + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (bits >> 11) as f64 / (1_u64 << 53) as f64
    });
    0.1 * (uniform.sum::<f64>() - 6.0)
}

/// Simulates machines with friction coefficient 0.00275, and writes measurements of their rests.
fn measure(scratch: &Scratch, contact: &str) {
    let text =
        identify(contact, 60).replace("seed: 3", "seed: 99").replace("name: small", "name: truth");
    let text = text.split("identify:").next().expect("a study").to_owned();
    let text = text.replace("contact:", "parameters: {friction_coefficient: 2.75e-3}\n  contact:");
    scratch.write("truth.yaml", text);
    scratch.well("run truth.yaml --out truth -q");
    let runs = scratch.table("truth", "runs");
    let [speeds, of_first, of_second] =
        ["speed_rad_s", "beta_1_rad", "beta_2_rad"].map(|name| numbers(&runs, name));
    let mut table = "speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n".to_owned();
    for (run, label) in words(&runs, "label").iter().enumerate() {
        assert_eq!(label.as_deref(), Some("equilibrium"));
        let angle =
            |values: &Vec<Option<f64>>, ball| values[run].expect("an angle") + error(run, ball);
        let (first, second) = (angle(&of_first, 0), angle(&of_second, 1));
        // Balls are not told apart.
        let (first, second) = if run % 2 == 0 { (first, second) } else { (second, first) };
        let speed = speeds[run].expect("a speed");
        writeln!(table, "{speed},{first:.4},{second:.4},0.1").expect("text");
    }
    scratch.write("rests.csv", table);
}

/// The truth is inside the interval, the model with contact explains the measurements, and the one without does not. All
/// files have the same bytes on one thread and on two, after an interruption, and with the simulated runs of before; other
/// measurements are refused in the same directory.
#[test]
fn synthetic_measurements() {
    let scratch = Scratch::new();
    measure(&scratch, TOUCHING);
    scratch.write("small.yaml", identify(TOUCHING, 128));
    let found =
        scratch.json("identify small.yaml --measured rests.csv --out one --threads 1 --json -q");
    let parameter = &found["parameters"][0];
    let [low, high] = ["low", "high"].map(|key| parameter[key].as_f64().expect("a number"));
    assert!(low < 2.75e-3 && 2.75e-3 < high && high - low < 1.5e-3, "{parameter:#}");
    assert_eq!(parameter["identified"], true);
    assert_eq!(found["fit"]["rejected"], false, "{:#}", found["fit"]);

    // The runs of some parameter sets are lost, as if the command had been killed.
    scratch.well("identify small.yaml --measured rests.csv --out two --threads 2 -q");
    let sets = std::fs::read_dir(scratch.path("two/simulations")).expect("a folder");
    let sets: Vec<_> = sets.map(|entry| entry.expect("an entry").path()).collect();
    let lost =
        sets.iter().filter(|path| path.extension().is_some_and(|ending| ending == "parquet"));
    lost.step_by(3).for_each(|path| std::fs::remove_file(path).expect("removed"));
    std::fs::remove_file(scratch.path("two/posterior.parquet")).expect("removed");
    let words = scratch.well("identify small.yaml --measured rests.csv --out two --threads 2 -q");
    scratch.well(
        "identify small.yaml --measured rests.csv --out three --simulations one/simulations -q",
    );
    for name in [
        "posterior.parquet",
        "parameter_sets.parquet",
        "fit.parquet",
        "positions.parquet",
        "identification.json",
    ] {
        let bytes = |folder: &str| scratch.bytes(&format!("{folder}/{name}"));
        assert!(bytes("one") == bytes("two"), "{name}");
        assert!(bytes("one") == bytes("three"), "{name}");
    }
    for part in
        ["friction_coefficient  1", "The model explains the 120 measured runs", "predicted rests"]
    {
        assert!(words.contains(part), "no {part:?} in\n{words}");
    }
    let samples = scratch.table("one", "posterior");
    assert_eq!(numbers(&samples, "friction_coefficient").len(), 800);
    let origins = super::support::words(&scratch.table("one", "parameter_sets"), "origin");
    assert_eq!(origins.iter().filter(|origin| origin.as_deref() == Some("posterior")).count(), 8);

    let rows = scratch.text("rests.csv");
    scratch.write("fewer.csv", rows.lines().take(40).collect::<Vec<_>>().join("\n"));
    scratch.refused(
        "identify small.yaml --measured fewer.csv --out one",
        &["this directory holds another inference", "--simulations one/simulations"],
    );

    scratch.write("ghosts.yaml", identify("none", 128));
    let ghosts = scratch.well("identify ghosts.yaml --measured rests.csv --out ghosts -q");
    let verdict = "over all rows; level 0.05).\nThe simulated runs are too few for this verdict, too; see the warning.\n";
    assert!(ghosts.contains("The model does not explain the 120") && ghosts.contains(verdict));
    assert!(!words.contains("too few for this verdict"), "{words}");
}

/// A prior that leaves the truth out gives a warning with the key and a wider prior, at either end. An end that is the limit of
/// the physics, such as a runout of 0, does not.
#[test]
fn posteriors_that_lean_on_an_end() {
    let scratch = Scratch::new();
    measure(&scratch, "none");
    let friction = "friction_coefficient: {from: 1.0e-3, to: 6.0e-3, spacing: logarithmic}";
    for (prior, key) in [
        ("friction_coefficient: {from: 4.0e-3, to: 8.0e-3, spacing: logarithmic}", "from"),
        ("friction_coefficient: {from: 1.0e-3, to: 2.0e-3}", "to"),
        ("ring_runout_m: {from: 0, to: 1.0e-3}", "from"),
    ] {
        scratch.write("small.yaml", identify("none", 64).replace(friction, prior));
        let out = format!("{}-{key}", &prior[..4]);
        let ended = scratch.stickslip(&format!(
            "identify small.yaml --measured rests.csv --out {out} --simulations {out}-runs --json"
        ));
        let found = ended.json();
        assert_eq!(found["parameters"][0]["leans_on"], key, "{found:#}");
        let warning = format!(
            "small.yaml: identify.parameters.friction_coefficient.{key}: the posterior leans"
        );
        let is_free = prior.starts_with("friction");
        assert_eq!(ended.err.contains(&warning), is_free, "{}", ended.err);
        assert_eq!(
            found["warnings"].to_string().contains("leans on this end"),
            is_free,
            "{found:#}"
        );
        assert_eq!(ended.err.contains(&format!("a wider prior, such as {key}: ")), is_free);
    }
}

/// Progress counts each parameter set once, by one name, and swept values in the text have few digits.
#[test]
fn progress_and_text_are_short() {
    let scratch = Scratch::new();
    let study = identify("none", 8).replace("speed_rad_s: [-140, -160.8103]", "speed: [-1400 rpm]");
    scratch.write("small.yaml", study);
    let speed = -1400.0 * std::f64::consts::TAU / 60.0;
    let row = |row: i32| format!("{speed},{},-0.3,0.1\n", 0.2 * f64::from(row));
    let rows: String = (0..6).map(row).collect();
    scratch.write("rests.csv", format!("speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n{rows}"));
    let ended = scratch.ended("identify small.yaml --measured rests.csv --out out", 0);
    let numbers: Vec<String> =
        (1..=20).map(|number| format!("parameter set {number} of 20")).collect();
    let told: Vec<&str> =
        ended.err.lines().filter(|line| line.starts_with("parameter set")).collect();
    assert_eq!(told, numbers);
    let progress = ended.err.split("warning").next().unwrap_or_default();
    assert!(!progress.contains("designs") && !progress.contains("points"), "{}", ended.err);
    let found =
        "(an estimate that needs at least 30 sets); the interval may be too narrow or misplaced";
    assert!(ended.err.contains(found), "{}", ended.err);
    assert!(ended.out.contains("point  speed [rpm] "), "{}", ended.out);
    assert!(ended.out.contains("    0        -1400 "), "{}", ended.out);
}

#[test]
fn wrong_usage() {
    let scratch = Scratch::new();
    let good = identify("none", 8);
    scratch.write("rests.csv", "speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-140,1,2,0.1\n");
    let block = "schema: 1\nname: b\nseed: 1\nmodel: {kind: block_on_spring}\n\
                 initial_conditions: {design: {monte_carlo: {samples: 1}}}\n\
                 identify: {parameters: {stiffness_n_m: {from: 1, to: 2}}}\n";
    scratch.write("block.yaml", block);
    scratch.write("without.yaml", good.split("identify:").next().expect("text"));
    let precision = "precision: {equilibrium_fraction: 0.1, max_runs: 100}\n";
    scratch.write("precise.yaml", format!("{good}{precision}"));
    scratch.write("good.yaml", &good);
    std::fs::create_dir(scratch.path("full")).expect("a folder");
    scratch.write("full/thesis.txt", "mine");
    scratch.write("turned.csv", "speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-140,400,2,0.1\n");
    let staged = good.replace("contact: none", "protocol: startup");
    scratch.write("staged.yaml", &staged);
    Study::parse(std::path::Path::new("staged.yaml"), staged).expect("a study");
    scratch
        .write("ramp.csv", "speed_rad_s,stage,beta_1_rad,beta_2_rad,std_dev_rad\n-140,1,1,2,0.1\n");
    scratch.refuses(
        "identify",
        "without.yaml --measured rests.csv ¦ `identify` is missing ¦ friction_coefficient: {from
precise.yaml --measured rests.csv ¦ different numbers of runs ¦ without `precision`
block.yaml --measured rests.csv ¦ needs angles at which like bodies rest ¦ ball_balancer and rotor_balancer
good.yaml --measured none.csv ¦ none.csv
good.yaml --measured rests.csv --out full ¦ holds no inference ¦ thesis.txt
good.yaml --measured turned.csv --out full ¦ warning: turned.csv: a measured angle is beyond two turns ¦ found:  400 rad
staged.yaml --measured ramp.csv ¦ no stage of constant speed ¦ allowed: 2",
    );
}
