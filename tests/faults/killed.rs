//! Repeated `kill -9` at arbitrary moments until the study is finished.

use std::process::Child;
use std::thread::{sleep, yield_now};
use std::time::Duration;

use super::{CHUNKS, chunks, finished, stopped_at, study};
use crate::cli::support::{Scratch, assert_has};
use crate::support::TestRng;

/// Minimum number of kills.
const KILLS: u32 = 50;

/// Waits until the program has ended or `holds`. Returns whether it has ended.
fn until(child: &mut Child, mut holds: impl FnMut() -> bool) -> bool {
    loop {
        if child.try_wait().unwrap().is_some() {
            return true;
        }
        if holds() {
            return false;
        }
        yield_now();
    }
}

/// Kills at any time after the start (also before the directory exists) and after the next chunk is
/// finished (also while tables are written) lose no finished run; every attempt continues with
/// another number of threads, by `run` or `resume`.
#[test]
fn kills_lose_nothing() {
    let scratch = Scratch::with(study());
    scratch.well("run a.yaml --out whole");
    let out = scratch.path("out");
    let mut draws = TestRng::new(20_261_121);
    let (mut kills, mut kept) = (0, Vec::new());
    loop {
        let threads = 1 + draws.below(3);
        let command = match out.join("manifest.json").exists() && draws.below(2) == 0 {
            true => "resume out",
            false => "run a.yaml --out out",
        };
        let options = format!("{command} --quiet --chunk 64 --threads {threads}");
        let mut child = scratch.command(&options).spawn().unwrap();
        let early = kills % 3 == 0 && kills < 2 * KILLS;
        let ended = if early {
            sleep(Duration::from_micros(draws.below(12_000)));
            child.try_wait().unwrap().is_some()
        } else {
            let before = kept.len();
            let ended = until(&mut child, || finished(&out).len() > before);
            sleep(Duration::from_micros(draws.below(4_000)));
            ended || child.try_wait().unwrap().is_some()
        };
        if !ended {
            // SIGKILL.
            child.kill().unwrap();
            kills += 1;
        }
        let status = child.wait_with_output().unwrap();
        // A finished chunk remains finished and undamaged. The last line may be torn.
        let now = finished(&out);
        assert!(now.len() >= kept.len(), "{} finished chunks became {}", kept.len(), now.len());
        assert_eq!(now[..kept.len()], kept, "finished chunks have changed");
        kept = now;
        if ended {
            let said = String::from_utf8_lossy(&status.stderr).into_owned();
            assert_eq!(status.status.code(), Some(0), "{said}");
            break;
        }
    }
    assert!(kills >= KILLS, "finished after {kills} kills only");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
    let folder = chunks(&out).unwrap();
    let damaged = std::fs::read_dir(folder)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().ends_with("damaged"));
    assert_eq!(damaged.count(), 0);
    println!("{kills} kills survived, {} chunks of at least {CHUNKS}, 0 rows lost", kept.len());
}

/// A merge that ends at the file size limit is not computed by `resume`, which refers to `merge`.
#[test]
fn a_merge_that_was_stopped_is_merged() {
    let scratch = Scratch::with(study().replace("samples: 3200", "samples: 200"));
    scratch.well("run a.yaml --out whole");
    for part in ["1", "2"] {
        scratch.well(&format!("run a.yaml --shard {part}/2 --out part{part}"));
    }
    stopped_at(&scratch, 16, "merge part1 part2 --out out");
    assert_eq!(scratch.manifest("out")["complete"], false);
    let merge = "`stickslip merge part1 part2 --out out`, which continues it";
    scratch.refused("resume out", &["out: this directory holds an unfinished merge", merge]);
    let ended = scratch.ended("merge part1 part2 --out out", 0);
    assert_has(&ended.err, &["400 finished earlier, 0 computed"]);
    assert_eq!(scratch.data("out"), scratch.data("whole"));
    assert!(scratch.manifest("out")["merging"].is_null());
    // With an explicit request the runs are computed.
    stopped_at(&scratch, 16, "merge part1 part2 --out computed");
    stopped_at(&scratch, 16, "run a.yaml --out computed");
    scratch.well("resume computed");
    assert_eq!(scratch.data("computed"), scratch.data("whole"));
}
