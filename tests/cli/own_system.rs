//! A program with a kind of model of its own, `examples/spring_block_chain`: its studies have all properties of others,
//! and two blocks move as in closed form.

use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use super::support::{Ended, Scratch, assert_has, counts, numbers, words};
use crate::support::TwoBlocks;

const STUDIES: [(&str, u64); 3] = [("two-blocks", 24), ("three-blocks", 24), ("eight-blocks", 16)];

/// Returns the folder of the example's source.
fn example() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "examples", "spring_block_chain"].iter().collect()
}

/// Returns the program, which cargo builds beside the tests, with these arguments.
fn command(scratch: &Scratch, arguments: &str) -> Command {
    let tests = std::env::current_exe().expect("the tests have a path");
    let profile = tests.ancestors().nth(2).expect("the tests are in <profile>/deps");
    let program = profile
        .join("examples")
        .join(format!("spring_block_chain{}", std::env::consts::EXE_SUFFIX));
    assert!(program.exists(), "run `cargo build --example spring_block_chain` first");
    let mut command = Command::new(program);
    command.args(arguments.split_whitespace()).current_dir(scratch.path("."));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(scratch: &Scratch, arguments: &str) -> Ended {
    Ended::of(command(scratch, arguments).output().expect("the program starts"))
}

#[track_caller]
fn well(scratch: &Scratch, arguments: &str) -> Ended {
    let ended = run(scratch, arguments);
    assert_eq!(ended.code, Some(0), "{arguments}\n{}{}", ended.out, ended.err);
    ended
}

/// Returns a folder with the studies of the example, and their texts.
fn studies() -> (Scratch, Vec<(&'static str, u64, String)>) {
    let scratch = Scratch::new();
    let copied = STUDIES.map(|(name, runs)| {
        let file = format!("{name}.yaml");
        let text = std::fs::read_to_string(example().join(&file)).expect("a study");
        scratch.write(&file, &text);
        (name, runs, text)
    });
    (scratch, copied.into())
}

/// Kills at any time, interruptions, and shards lose nothing and change no byte.
#[test]
fn killed_and_resumed_and_merged_runs_are_the_same() {
    let (scratch, studies) = studies();
    for (name, runs, _) in studies {
        well(&scratch, &format!("run {name}.yaml --out {name}"));
        let rows = scratch.table(name, "runs");
        assert_eq!(rows.num_rows() as u64, runs, "{name}");
        assert!(words(&rows, "error").iter().all(Option::is_none), "{name}");
        assert!(counts(&rows, "switches").iter().any(|switches| *switches > 10), "{name}");

        let killed = format!("{name}-killed");
        let (mut kills, mut wait) = (0, Duration::from_millis(1));
        loop {
            let options = format!("run {name}.yaml --out {killed} --quiet --chunk 2 --threads 1");
            let mut child = command(&scratch, &options).spawn().expect("the program starts");
            sleep(wait);
            if child.try_wait().expect("the state of a child").is_some() {
                break;
            }
            // SIGKILL.
            child.kill().expect("it is killed");
            child.wait().expect("it has ended");
            (kills, wait) = (kills + 1, wait.mul_f64(1.5));
        }
        assert!(kills > 0, "{name}");
        assert_eq!(scratch.data(&killed), scratch.data(name), "{name}");

        let stopped = format!("{name}-stopped");
        let ended = run(&scratch, &format!("run {name}.yaml --out {stopped} --max-seconds 0"));
        assert_eq!(ended.code, Some(130), "{}", ended.err);
        well(&scratch, &format!("resume {stopped} --threads 2"));
        assert_eq!(scratch.data(&stopped), scratch.data(name), "{name}");

        for shard in [1, 2] {
            well(&scratch, &format!("run {name}.yaml --shard {shard}/2 --out {name}-{shard}"));
        }
        well(&scratch, &format!("merge {name}-2 {name}-1 --out {name}-merged"));
        assert_eq!(scratch.data(&format!("{name}-merged")), scratch.data(name), "{name}");
        well(&scratch, &format!("report {name}"));
    }
}

/// A replay gives the row of its run, and its last positions are those of the row, bit for bit.
#[test]
fn replays_are_their_rows() {
    let (scratch, studies) = studies();
    for (name, runs, _) in studies {
        well(&scratch, &format!("run {name}.yaml --out {name}"));
        let rows = scratch.table(name, "runs");
        for run_id in [0, runs - 1] {
            let out = format!("{name}-{run_id}");
            let ended = well(&scratch, &format!("replay {name} {run_id} --out {out} --json"));
            assert_has(&ended.err, &["equal to its row in all "]);
            let report: Value = serde_json::from_str(&ended.out).expect("JSON");
            assert_eq!(report["same_as_row"], true);
            let switches = scratch.table(&out, "switches");
            assert_eq!(counts(&rows, "switches")[run_id as usize], switches.num_rows() as u64);
            let trajectory = scratch.table(&out, "trajectory");
            let last = |column: &str| numbers(&trajectory, column).last().copied().flatten();
            for block in 1.. {
                let column = format!("position_{block}_m");
                if rows.column_by_name(&column).is_none() {
                    break;
                }
                let row = numbers(&rows, &column)[run_id as usize].map(f64::to_bits);
                assert_eq!(last(&column).map(f64::to_bits), row, "{name} {run_id} {column}");
            }
        }
    }
}

/// The program finds limit cycles of a chain, so that more time decides its runs.
#[test]
fn more_time_decides_runs_of_a_chain() {
    let (scratch, studies) = studies();
    let short = studies[0].2.replace("end_time_s: 200", "end_time_s: 1.0e-3");
    assert_ne!(short, studies[0].2);
    scratch.write("short.yaml", short);
    let printed = well(&scratch, "run short.yaml --out short").out;
    let line = "24 of 24 runs are undecided; a larger simulation.end_time_s or simulation.extend decides more, but no \
                quasi-periodic motion.\n";
    assert_has(&printed, &[line]);
}

/// Two blocks that stick and slip on a belt have limit cycles, the same ones for both methods and finer tolerances.
#[test]
fn blocks_have_the_limit_cycles_of_their_closed_form() {
    let (scratch, studies) = studies();
    let text = &studies[0].2;
    let simulations = [
        "{end_time_s: 200}",
        "{end_time_s: 200, method: event}",
        "{end_time_s: 200, tolerance: {relative: 1.0e-10, absolute: 1.0e-12}}",
    ];
    let found = simulations.map(|simulation| {
        scratch.write("cycles.yaml", text.replace("{end_time_s: 200}", simulation));
        well(&scratch, "run cycles.yaml --out cycles --recompute");
        let rows = scratch.table("cycles", "runs");
        (words(&rows, "label"), numbers(&rows, "period_s"))
    });
    let [(labels, periods), others @ ..] = &found;
    assert!(labels.iter().all(|label| label.as_deref() == Some("limit_cycle")), "{labels:?}");
    for (other_labels, other_periods) in others {
        assert_eq!(other_labels, labels);
        for (one, other) in periods.iter().zip(other_periods) {
            let [one, other] = [one, other].map(|period| period.expect("a cycle has a period"));
            assert!((one - other).abs() <= 1e-6 * one, "{one} {other}");
        }
    }
}

/// Parameters, whole numbers and coordinates of the kind are keys like those of the built-in kinds: errors name them.
#[test]
fn errors_name_the_keys_of_the_kind() {
    let (scratch, studies) = studies();
    let text = &studies[0].2;
    let cases = [
        ("blocks: 2", "bloks: 2", "model.parameters.bloks", "blocks (did you mean this?)"),
        ("blocks: 2", "blocks: 2.5", "model.parameters.blocks", "a whole number from 1 to 32"),
        ("blocks: 2", "blocks: 33", "model.parameters.blocks", "a whole number from 1 to 32"),
        (
            "belt_speed: 0.1 m/s",
            "belt_speed_m_s: -1",
            "belt_speed_m_s",
            "a positive, finite number",
        ),
        ("belt_speed: 0.1 m/s", "belt_speed: 2 kg", "model.parameters.belt_speed", "m/s"),
        ("blocks: 2", "balls: 2", "model.parameters.balls", "kind: ball_balancer"),
        ("coupling_stiffness_n_m: [", "coupling: [", "sweep[0].grid.coupling", "coupling_stiff"),
        ("coupling_stiffness_n_m: [", "blocks: [", "sweep[0].grid.blocks", "one study per number"),
        ("velocity_2_m_s", "velocity_3_m_s", "box.velocity_3_m_s", "velocity_2_m_s"),
        ("spring_block_chain\n", "spring_block_chian\n", "model.kind", "spring_block_chain"),
    ];
    for (from, to, key, remedy) in cases {
        assert!(text.contains(from), "{from}");
        scratch.write("a.yaml", text.replacen(from, to, 1));
        let ended = run(&scratch, "check a.yaml");
        assert_eq!(ended.code, Some(2), "{to}\n{}", ended.out);
        assert_has(&ended.err, &["a.yaml:", key, "allowed:", remedy]);
    }
    // The built-in program does not know the kind.
    scratch.refused("check two-blocks.yaml", &["two-blocks.yaml:8:", "`model.kind`"]);
}

/// The schema has the kind, and `check` shows its parameters.
#[test]
fn schema_and_check_have_the_kind() {
    let (scratch, studies) = studies();
    let schema: Value = serde_json::from_str(&well(&scratch, "schema").out).expect("JSON");
    let validator = jsonschema::validator_for(&schema).expect("a schema");
    for (name, runs, text) in &studies {
        let study: Value = serde_saphyr::from_str(text).expect("YAML");
        let found: Vec<String> = validator.iter_errors(&study).map(|one| one.to_string()).collect();
        assert!(found.is_empty(), "{name}: {found:?}");
        for (from, to) in [("blocks:", "blox:"), ("kind: spring", "kind: sprung")] {
            let wrong: Value = serde_saphyr::from_str(&text.replacen(from, to, 1)).expect("YAML");
            assert!(!validator.is_valid(&wrong), "{name}: {to}");
        }
        let report = well(&scratch, &format!("check {name}.yaml --json")).out;
        let report: Value = serde_json::from_str(&report).expect("JSON");
        assert_eq!(
            (&report["runs"], &report["model"]),
            (&(*runs).into(), &"spring_block_chain".into())
        );
        let machine = report["machine"].to_string();
        assert_has(&machine, &["\"blocks\"", "leaf_stiffness_n_m", "\"N/m\""]);
        assert_has(&well(&scratch, &format!("check {name}.yaml")).out, &[" blocks, "]);
    }
}

/// Positions, speeds and switches of two blocks that stick and slip are those of the closed form.
#[test]
fn two_blocks_move_as_in_closed_form() {
    let scratch = Scratch::new();
    for (number, (method, coupling, belt_speed, tolerance)) in
        [("event", 0.5, 0.1, 1e-10), ("event", 1.7, 0.25, 1e-10), ("switch", 0.5, 0.1, 1e-6)]
            .into_iter()
            .enumerate()
    {
        // With 1 kg, 100 N/m and 10 N: the units are 0.1 m, 0.1 s and 1 m/s.
        let text = format!(
            "schema: 1\nname: a\nseed: 1\nmodel:\n  kind: spring_block_chain\n  \
             parameters: {{coupling_stiffness_n_m: {}, belt_speed_m_s: {belt_speed}}}\n  \
             friction: {{stribeck: {{static_friction_coefficient: 0.2, stribeck_speed_m_s: 0}}}}\n\
             initial_conditions:\n  box: {{position_1_m: [0.012, 0.012], position_2_m: [-0.03, -0.03], \
             velocity_1_m_s: [0.3, 0.3], velocity_2_m_s: [-0.1, -0.1]}}\n  \
             design: {{monte_carlo: {{samples: 1}}}}\n\
             simulation: {{end_time_s: 6, method: {method}, \
             tolerance: {{relative: 1.0e-11, absolute: 1.0e-12}}}}\n",
            100.0 * coupling
        );
        scratch.write("a.yaml", text);
        let out = format!("out-{number}");
        well(&scratch, &format!("run a.yaml --out {out}"));
        well(&scratch, &format!("replay {out} 0 --times 0:5.9:591 --out {out}-replay"));
        let table = scratch.table(&format!("{out}-replay"), "switches");
        let all = (words(&table, "to"), numbers(&table, "time"), counts(&table, "block"));
        // In the band of the switch model, a block passes through a transition on its way.
        let is_end = |to: &Option<String>| !to.as_deref().unwrap_or("").starts_with("transition");
        let mut switches = (0..table.num_rows()).filter(|&row| is_end(&all.0[row])).peekable();
        let trajectory = scratch.table(&format!("{out}-replay"), "trajectory");
        let times = numbers(&trajectory, "time");
        let of = |name: &str| [1, 2].map(|block| numbers(&trajectory, &format!("{name}_{block}")));
        let (positions, speeds) = (of("position"), of("sliding_speed"));

        let mut exact = TwoBlocks {
            coupling,
            belt_speed,
            kinetic_coefficient: 0.1,
            static_coefficient: 0.2,
            since: 0.0,
            x: [0.12, -0.3],
            u: [0.3, -0.1],
            phases: [(0.3 - belt_speed).signum(), -1.0],
        };
        let (mut sticks, mut slips) = (0, 0);
        for (row, time) in times.iter().map(|time| time.expect("a time")).enumerate() {
            while let Some(block) = exact.next_switch(time) {
                let row = switches.next().expect("a switch");
                let (to, at) = (all.0[row].as_deref(), all.1[row].expect("a time"));
                let phase = match exact.phases[block] {
                    0.0 => "stick",
                    1.0 => "slip_forward",
                    _ => "slip_backward",
                };
                assert_eq!((to, all.2[row]), (Some(phase), block as u64 + 1), "{method} at {at}");
                assert!((at - exact.since).abs() < tolerance, "{at}: {}", at - exact.since);
                if phase == "stick" { sticks += 1 } else { slips += 1 }
            }
            let (x, u) = exact.at(time - exact.since);
            for block in 0..2 {
                let [position, speed] =
                    [&positions, &speeds].map(|of| of[block][row].expect("a number"));
                let errors = [position - x[block], speed + belt_speed - u[block]];
                let most = errors[0].abs().max(errors[1].abs());
                assert!(most < tolerance, "{method}, block {block} at {time}: {errors:?}");
            }
        }
        assert!(sticks > 5 && slips > 5, "{sticks} sticks, {slips} slips");
    }
}
