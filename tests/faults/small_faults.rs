//! Few file handles, clock changes, single changed bytes.

use std::fs;

use super::{halfway, shell, study};
use crate::cli::support::Scratch;

/// About eighteen open files suffice, also to merge more shards than that.
#[test]
fn few_file_handles_are_enough() {
    let scratch = Scratch::with(study().replace("samples: 3200", "samples: 200"));
    scratch.well("run a.yaml --out whole");
    let ended = shell(
        &scratch,
        "set -e; ulimit -n 24; parts=; for k in $(seq 1 40); do $s run a.yaml --quiet --shard $k/40 \
         --out part$k --threads 2; parts=\"$parts part$k\"; done; $s merge $parts --out out --quiet",
    );
    assert_eq!(ended.code, Some(0), "{}", ended.err);
    assert_eq!(scratch.data("out"), scratch.data("whole"));
    // With too few handles the program reports the error and loses nothing.
    let code = shell(&scratch, "ulimit -n 7; $s resume part7").code;
    assert!([Some(0), Some(1), Some(2)].contains(&code), "{code:?}");
    scratch.well("resume part7");
}

/// Results do not depend on the clock: files from the future, a start in the past or in the future.
#[test]
fn results_do_not_depend_on_the_clock() {
    for (began, stamp) in [(0.0, "1970-01-02"), (4.0e10, "2170-01-01"), (-1.0, "2001-09-09")] {
        let scratch = Scratch::new();
        halfway(&scratch);
        let mut manifest = scratch.manifest("out");
        manifest["started_unix_s"] = began.into();
        scratch.write("out/manifest.json", manifest.to_string());
        let touched = shell(&scratch, &format!("find out -exec touch -d {stamp} {{}} +"));
        assert_eq!(touched.code, Some(0), "{}", touched.err);
        scratch.well("resume out");
        assert_eq!(scratch.data("out"), scratch.data("whole"));
        assert!(scratch.manifest("out")["runs_kept"].as_u64().unwrap() >= 20 * 64);
    }
}

/// With one byte of any file of an interrupted study changed, at the beginning, in the middle or at
/// the end, the program either refuses and names the file, or ends in the same bytes. Restoring the
/// file, or running the study itself, recovers everything.
#[test]
fn a_changed_byte_is_never_a_wrong_row() {
    let scratch = Scratch::new();
    halfway(&scratch);
    let out = scratch.path("out");
    let files: Vec<_> = scratch
        .files()
        .into_iter()
        .filter(|(path, content)| path.starts_with(&out) && !content.is_empty())
        .collect();
    let kinds = ["manifest.json", "study.yaml", "manifest.jsonl", "000003.chunk", "000017.chunk"];
    let (mut tried, mut refused) = (0, 0);
    for (path, content) in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if !kinds.contains(&name.as_str()) {
            continue;
        }
        for place in [0, content.len() / 2, content.len() - 1] {
            let copy = scratch.path("copy");
            assert_eq!(shell(&scratch, "cp -r out copy").code, Some(0));
            let mut changed = content.clone();
            changed[place] ^= 0x15;
            let in_copy = copy.join(path.strip_prefix(&out).unwrap());
            fs::write(&in_copy, changed).unwrap();
            let ended = scratch.stickslip("resume copy --quiet");
            tried += 1;
            if ended.code != Some(0) {
                refused += 1;
                assert_eq!(ended.code, Some(2), "{name} at {place}: {}", ended.err);
                let named = [name.as_str(), "shard", "study", "version"];
                assert!(named.iter().any(|part| ended.err.contains(part)), "{}", ended.err);
                fs::write(&in_copy, &content).unwrap();
                scratch.well("resume copy");
            }
            assert_eq!(scratch.data("copy"), scratch.data("whole"), "{name} at {place}");
            let kept = scratch.manifest("copy")["runs_kept"].as_u64().unwrap();
            assert!(kept >= 18 * 64, "{name} at {place}: {kept}");
            fs::remove_dir_all(copy).unwrap();
        }
    }
    assert_eq!(tried, 3 * kinds.len());
    assert!(refused > 0 && refused < tried, "{refused} of {tried}");
}
