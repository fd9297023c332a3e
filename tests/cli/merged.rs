//! Merged shards of a study give the tables of a single run, byte for byte.

use std::fs;

use super::support::{Scratch, assert_has, study_text};

/// Balls that touch on a disc that starts, under a table that is hit twice in random directions.
const STAGES: &str = "model: {kind: ball_balancer, contact: {}, \
                      protocol: {startup_and_hammer: {over_s: 0.125, wait_s: 0.125, hits: 2}}}\n";

const PRECISE: &str = "precision: {equilibrium_fraction: 0.2, max_runs: 64}\n";

/// Points with different numbers of balls.
const BALLS: &str = "precision: {equilibrium_fraction: 0.15, max_runs: 60}\n\
                     sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772], balls: [2, 1]}}]\n";

fn study(rest: &str) -> String {
    let speeds = "sweep: [{grid: {speed_rad_s: [-160.0, -200.0, -216.0]}}]\n";
    let sweep = if rest.contains("sweep:") { "" } else { speeds };
    study_text("shards", "{monte_carlo: {samples: 32}}", 0.5, &format!("{sweep}{rest}"))
}

/// Computes all shards of `a.yaml` in `1`, `2`, ... and returns these names.
fn shards(scratch: &Scratch, number: usize) -> Vec<String> {
    let parts: Vec<String> = (1..=number).map(|part| part.to_string()).collect();
    for part in &parts {
        scratch.well(&format!("run a.yaml --shard {part}/{number} --out {part} --threads 1"));
    }
    parts
}

#[test]
fn merged_shards_are_the_single_run() {
    // Of six runs in seven shards, one shard has none.
    for (samples, rest, number) in [
        (32, "", 1),
        (32, "", 7),
        (2, "", 7),
        (32, PRECISE, 2),
        (32, PRECISE, 5),
        (32, BALLS, 3),
        (32, STAGES, 3),
    ] {
        let text = study(rest).replace("samples: 32", &format!("samples: {samples}"));
        let scratch = Scratch::with(text);
        scratch.well("run a.yaml --out whole --chunk 10");
        let mut parts = shards(&scratch, number);
        parts.reverse();
        scratch.tells(&format!("merge {} --out merged", parts.join(" ")), 0, &[" 0 computed"]);
        assert_eq!(scratch.data("merged"), scratch.data("whole"), "{number} shards, {rest}");
        let stages = |out: &str| fs::read(scratch.path(out).join("stages.parquet")).ok();
        assert_eq!(
            (stages("merged").is_some(), stages("merged")),
            (rest == STAGES, stages("whole"))
        );
        let planned = |out: &str| scratch.manifest(out)["runs_planned"].as_u64();
        let of_parts: Option<u64> = parts.iter().map(|part| planned(part)).sum();
        assert_eq!(of_parts, planned("whole"), "{number} shards, {rest}");
        // A merged directory is like any other.
        let again = scratch.stickslip("run a.yaml --out merged");
        assert_has(&again.err, &["nothing to do"]);
    }
}

#[test]
fn incompatible_shards_are_named() {
    let scratch = Scratch::with(study(""));
    shards(&scratch, 3);
    scratch.well("run a.yaml --shard 2/4 --out 2of4");
    scratch.write("b.yaml", study("").replace("seed: 5", "seed: 6"));
    scratch.well("run b.yaml --shard 2/3 --out other");
    scratch.ended("run a.yaml --shard 2/3 --out stopped --max-seconds 0", 130);
    scratch.refuses(
        "merge",
        r"1 3 --out merged ¦ shards are missing: 2 of 3 ¦ found:   no directory of 2/3 ¦ allowed:
1 3 2 3 --out merged ¦ 3: shard 3/3 is also in 3 ¦ allowed:
1 2of4 3 --out merged ¦ 2of4: shard 2/4, but 1 is shard 1/3 ¦ allowed:
1 other 3 --out merged ¦ other: a different study than in 1; it differs in\n    seed: 5 -> 6 ¦ allowed:
1 stopped 3 --out merged ¦ stopped: shard 2/3 is not finished ¦ `stickslip resume stopped`
1 2 3 --out 1 ¦ 1: this directory holds the results of another shard",
    );
}

/// A chunk without its final name is read, and a damaged one is computed again; a shard's own directory is not changed.
#[test]
fn chunks_of_shards_are_only_read() {
    let scratch = Scratch::with(study(""));
    scratch.well("run a.yaml --out whole");
    shards(&scratch, 2);
    let [renamed, damaged] = ["1", "2"].map(|shard| scratch.chunks(shard).join("000000.chunk"));
    fs::rename(&renamed, renamed.with_added_extension("partial")).expect("a chunk");
    fs::write(damaged, "nothing").expect("written");
    let of_shards = || {
        let mut files = scratch.files();
        files
            .retain(|path, _| ["1", "2"].iter().any(|shard| path.starts_with(scratch.path(shard))));
        files
    };
    let before = of_shards();
    let said = ["000000.chunk: 7 bytes", "48 finished earlier, 48 computed"];
    scratch.tells("merge 1 2 --out merged", 0, &said);
    assert_eq!(scratch.data("merged"), scratch.data("whole"));
    assert!(of_shards() == before, "files of shards have changed");
}
