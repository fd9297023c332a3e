//! Messages of the library reach the function that a program names. The library itself prints nothing.

use std::fs;
use std::path::Path;
use std::sync::Mutex;

use stickslip::engine::{CHUNKS, listed_runs, show_messages};
use stickslip::study::Study;
use tempfile::tempdir;

static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());

#[test]
fn a_program_hears_of_damaged_lists() {
    show_messages(|message| HEARD.lock().unwrap().push(message.to_owned()));
    let scratch = tempdir().unwrap();
    let text = "schema: 1\nname: a\nseed: 1\nmodel: {kind: ball_balancer}\n\
                initial_conditions: {design: {monte_carlo: {samples: 4}}}\n";
    let study = Study::parse(Path::new("a.yaml"), text.to_owned()).unwrap();
    let chunks = scratch.path().join(CHUNKS).join(&study.hash()[..16]);
    fs::create_dir_all(&chunks).unwrap();
    fs::write(chunks.join("manifest.jsonl"), "damaged\n").unwrap();
    assert_eq!(listed_runs(scratch.path(), &study).unwrap(), 0);
    let place = scratch.path().to_string_lossy().into_owned();
    let heard = HEARD.lock().unwrap();
    let here: Vec<_> = heard.iter().filter(|message| message.starts_with(&place)).collect();
    assert!(here.len() == 1 && here[0].contains("line 1 is damaged"), "{heard:?}");
}
