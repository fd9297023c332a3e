//! The test functions for hostile bytes, one per kind of file; the fuzz targets in `fuzz/` also use them.
//!
//! A function may refuse any bytes, but must not panic or use unbounded memory or time, and accepted content must survive
//! a round trip.

use std::fs;
use std::path::{Component, Path};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use serde_json::Value;
use sha2::{Digest, Sha256};
use stickslip::analysis::PointDetail;
use stickslip::classification::MODEL_VERSION;
use stickslip::engine::{
    CHUNKS, Chunk, EngineOptions, ListedChunk, Progress, Shard, Sink, Store, run_study,
};
use stickslip::responses::Request;
use stickslip::study::{Study, StudyError};
use stickslip::table::{
    MANIFEST, Manifest, PointRow, Results, RunRecord, VERSION, WriteError, inspect,
};

/// Processes the bytes and returns whether they were usable. All inputs use one folder, which is empty at first.
pub type Target = fn(&Path, &[u8]) -> bool;

/// The kinds of file, by name.
pub const TARGETS: [(&str, Target); 6] = [
    ("study", study),
    ("csv_table", csv_table),
    ("parquet_table", parquet_table),
    ("requests", requests),
    ("manifest", manifest),
    ("finished_runs", finished_runs),
];

pub fn target(name: &str) -> Target {
    let found = TARGETS.iter().find(|(other, _)| *other == name);
    found.unwrap_or_else(|| panic!("no kind of file {name:?}")).1
}

/// The longest resolved study, in characters, that is read again.
const MOST_CHARACTERS: usize = 200_000;

fn study(folder: &Path, bytes: &[u8]) -> bool {
    let file = folder.join("study.yaml");
    // Some studies of the corpus refer to this table.
    let table = folder.join("table.csv");
    if !table.exists() {
        fs::write(table, "speed_rad_s\n-160\n-200\n").expect("a scratch folder");
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => check(Study::parse(&file, text.to_owned()), folder),
        Err(_) => {
            fs::write(&file, bytes).expect("a scratch folder");
            check(Study::load(&file), folder)
        }
    }
}

/// A CSV file, as a sweep, as start states and as designs.
fn csv_table(folder: &Path, bytes: &[u8]) -> bool {
    table(folder, "table.csv", bytes)
}

/// A Parquet file, as a sweep, as start states and as designs.
fn parquet_table(folder: &Path, bytes: &[u8]) -> bool {
    table(folder, "table.parquet", bytes)
}

fn table(folder: &Path, name: &str, bytes: &[u8]) -> bool {
    fs::write(folder.join(name), bytes).expect("a scratch folder");
    let head = "schema: 1\nname: a\nseed: 5\nmodel: {kind: ball_balancer}\ninitial_conditions:";
    let uses = [
        format!("{{design: {{monte_carlo: {{samples: 10}}}}}}\nsweep: [{{table: {name}}}]\n"),
        format!("{{design: {{table: {name}}}}}\n"),
    ];
    let read = uses.map(|rest| {
        check(Study::parse(&folder.join("study.yaml"), format!("{head} {rest}")), folder)
    });
    read.contains(&true) | designs(&folder.join(name))
}

/// Reads a table of designs and checks that each design can be applied.
fn designs(file: &Path) -> bool {
    match varied().designs(file) {
        Ok(designs) => {
            assert!(
                !designs.is_empty() && designs.iter().all(|values| varied().set(values).is_ok())
            );
            true
        }
        Err(error) => {
            assert_eq!(error.file(), file, "{error}");
            assert!(error.to_string().len() < 20_000);
            false
        }
    }
}

/// Requests of an optimiser, one per line. Each contains a valid design or gives an error of limited length.
fn requests(_: &Path, bytes: &[u8]) -> bool {
    let mut well = false;
    for line in bytes.split(|byte| *byte == b'\n') {
        let request = Request::read(varied(), line);
        // The identifier survives a round trip.
        let id = serde_json::to_string(&request.id).expect("plain values");
        assert_eq!(serde_json::from_str::<Value>(&id).expect("what was written"), request.id);
        match &request.design {
            Ok((values, set)) => {
                let again = varied().set(values).expect("values of a design");
                assert_eq!(set.planned_run(0), again.planned_run(0));
                well = true;
            }
            Err(refusal) => {
                let text = serde_json::to_string(refusal).expect("plain values");
                assert!(text.len() < 20_000, "a refusal of {} bytes", text.len());
            }
        }
    }
    well
}

/// Returns a study with variables of each kind.
fn varied() -> &'static Study {
    static VARIED: OnceLock<Study> = OnceLock::new();
    VARIED.get_or_init(|| {
        let text = "schema: 1\nname: a\nseed: 5\nmodel: {kind: ball_balancer}\n\
                    initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
                    design:\n  speed_rad_s: {from: -260, to: -140}\n  balls: {from: 1, to: 3}\n\
                    \x20 material:\n    choices:\n      steel: {ball_mass_kg: 1.4e-4}\n\
                    \x20     ceramic: {ball_mass_kg: 5.8e-5}\n";
        Study::parse(Path::new("varied.yaml"), text.to_owned()).expect("a study")
    })
}

/// Checks that the error of a refused study names a file, and that an accepted study can be planned, written and read
/// again.
fn check(study: Result<Study, StudyError>, folder: &Path) -> bool {
    let study = match study {
        Ok(study) => study,
        Err(error) => {
            assert!(error.file().starts_with(folder), "{error}");
            let message = error.to_string();
            assert!(message.len() < 20_000, "a message of {} bytes", message.len());
            return false;
        }
    };
    let last = study.run_count() - 1;
    for run in [0, last / 3, last] {
        let planned = study.planned_run(run);
        assert!(planned.uncertain.iter().all(|value| !value.is_nan()));
        assert!(planned.start.0.iter().all(|value| value.is_finite()));
    }
    let point = study.point(study.point_count() - 1);
    assert_eq!(point.point_id, study.point_count() - 1);
    let resolved = study.resolved_yaml();
    if resolved.len() > MOST_CHARACTERS {
        return true;
    }
    let again = Study::parse(Path::new("resolved.yaml"), resolved.clone())
        .unwrap_or_else(|error| panic!("{error}\n{resolved}"));
    assert_eq!(again.hash(), study.hash(), "{resolved}");
    assert_eq!(again.resolved_yaml(), resolved);
    true
}

/// The manifest of a results directory. The correct values replace `STUDY-HASH` and `VERSION` in it.
fn manifest(folder: &Path, bytes: &[u8]) -> bool {
    let bytes = match std::str::from_utf8(bytes) {
        Ok(text) => {
            text.replace("STUDY-HASH", &short().hash()).replace("VERSION", VERSION).into_bytes()
        }
        Err(_) => bytes.to_vec(),
    };
    fs::write(folder.join(MANIFEST), bytes).expect("a scratch folder");
    let read = Manifest::read(folder);
    let well = read.is_ok();
    if let Ok(Some(manifest)) = read {
        for name in manifest.files.keys() {
            // The parts of a table are files in a directory with the table's name.
            let inside = |part: Component<'_>| matches!(part, Component::Normal(_));
            assert!(!name.is_empty() && Path::new(name).components().all(inside), "{name}");
        }
        manifest.write(folder).expect("a scratch folder");
        assert_eq!(Manifest::read(folder).expect("what was written"), Some(manifest));
    }
    if let Err(error) = inspect(folder, short(), "1/1", &[CHUNKS]) {
        assert!(error.to_string().len() < 20_000);
    }
    well
}

/// Returns a study of four runs that end immediately.
fn short() -> &'static Study {
    static SHORT: OnceLock<Study> = OnceLock::new();
    SHORT.get_or_init(|| {
        let text = "schema: 1\nname: a\nseed: 5\nmodel: {kind: ball_balancer}\n\
                    sweep: [{grid: {speed_rad_s: [-160, -200]}}]\n\
                    initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
                    simulation: {end_time_s: 1.0e-5}\n";
        Study::parse(Path::new("short.yaml"), text.to_owned()).expect("a study")
    })
}

/// Finished runs on disk. The first byte selects whether the rest is a whole chunk, the list of chunks, or the outcomes in a
/// chunk.
fn finished_runs(folder: &Path, bytes: &[u8]) -> bool {
    let Some((first, rest)) = bytes.split_first() else { return false };
    match first % 3 {
        0 => whole_chunk(rest),
        1 => computed_from(folder, &genuine(folder), Some(rest)),
        _ => computed_from(folder, &outcomes(&genuine(folder), rest), None),
    }
}

fn whole_chunk(bytes: &[u8]) -> bool {
    let Ok(chunk) = Chunk::parse(bytes.to_vec()) else { return false };
    let ids: Vec<u64> = chunk.run_ids().collect();
    assert!(ids.is_sorted() && chunk.size() >= bytes.len());
    true
}

/// Length of a chunk's header and of the header of each outcome.
pub const HEAD: usize = 16 + 4 + 4 + 64;
pub const RUN_HEAD: usize = 8 + 16 + 4;

/// Returns the chunk of the short study, as the program writes it.
pub fn genuine(folder: &Path) -> Vec<u8> {
    static GENUINE: OnceLock<Vec<u8>> = OnceLock::new();
    let make = || {
        let results = folder.join("genuine");
        run_in_scratch(&results, short());
        let chunk = results.join(CHUNKS).join(&short().hash()[..16]).join("000000.chunk");
        fs::read(chunk).expect("a chunk")
    };
    GENUINE.get_or_init(make).clone()
}

/// Returns a chunk in which the outcomes of the runs are pieces of these bytes, separated by two
/// bytes 255.
fn outcomes(chunk: &[u8], bytes: &[u8]) -> Vec<u8> {
    let mut pieces = Vec::new();
    let mut rest = bytes;
    while let Some(at) = rest.windows(2).position(|pair| pair == [255, 255]) {
        pieces.push(&rest[..at]);
        rest = &rest[at + 2..];
    }
    pieces.push(rest);
    let (head, mut runs) = chunk.split_at(HEAD);
    let mut made = head.to_vec();
    for number in 0.. {
        let Some(run_head) = runs.first_chunk::<RUN_HEAD>() else { return made };
        let length: [u8; 4] = run_head[24..].try_into().expect("four bytes");
        let piece = pieces[number % pieces.len()];
        made.extend(&run_head[..24]);
        made.extend((piece.len() as u32).to_le_bytes());
        made.extend(piece);
        runs = &runs[RUN_HEAD + u32::from_le_bytes(length) as usize..];
    }
    made
}

/// Runs the short study in a directory with this chunk and this list of chunks, by default the correct list. Returns whether
/// runs were reused.
fn computed_from(folder: &Path, chunk: &[u8], list: Option<&[u8]>) -> bool {
    assert!(chunk.len() > HEAD && chunk[20..24] == MODEL_VERSION.to_le_bytes());
    let results = folder.join("results");
    let chunks = results.join(CHUNKS).join(&short().hash()[..16]);
    // The directory may be missing.
    let _ = fs::remove_dir_all(&results);
    fs::create_dir_all(&chunks).expect("a scratch folder");
    fs::write(chunks.join("000000.chunk"), chunk).expect("a scratch folder");
    let digest = Sha256::digest(chunk).iter().map(|byte| format!("{byte:02x}")).collect();
    let right = ListedChunk {
        chunk: 0,
        model_version: MODEL_VERSION,
        first_run: 0,
        last_run: short().run_count() - 1,
        runs: short().run_count(),
        bytes: chunk.len() as u64,
        sha256: digest,
    };
    let right = serde_json::to_vec(&right).expect("plain values");
    let list = list.map_or(right.clone(), |list| match std::str::from_utf8(list) {
        Ok(text) => text.replace("RIGHT", &String::from_utf8_lossy(&right)).into_bytes(),
        Err(_) => list.to_vec(),
    });
    fs::write(chunks.join("manifest.jsonl"), list).expect("a scratch folder");
    run_in_scratch(&results, short()) > 0
}

/// Runs a study in a directory that may contain results. Returns the number of reused runs.
fn run_in_scratch(directory: &Path, study: &Study) -> u64 {
    let mut store = match Store::open(directory, study) {
        Ok(store) => store,
        Err(error) => {
            assert!(error.to_string().len() < 20_000);
            return 0;
        }
    };
    let results = Results::create(directory, study).expect("a scratch folder");
    let mut sink = Tables { results, runs: 0 };
    let progress = Progress::new(study.run_count(), true);
    let stop = AtomicBool::new(false);
    let store = Some(&mut store);
    let ended = run_study(study, EngineOptions::default(), &stop, &progress, store, &mut sink);
    progress.close();
    let totals = ended.expect("a scratch folder");
    assert_eq!(sink.runs, study.run_count());
    let begun = Manifest::begin(study, Shard::WHOLE);
    let manifest = begun.with_runs(totals.counts, &totals.failures);
    sink.results.finish(manifest).expect("a scratch folder");
    totals.reused
}

struct Tables {
    results: Results,
    runs: u64,
}

impl Sink for Tables {
    fn run(&mut self, record: RunRecord) -> Result<(), WriteError> {
        self.runs += 1;
        self.results.tables.run(record)
    }

    fn point(&mut self, point: PointRow, detail: PointDetail) -> Result<(), WriteError> {
        self.results.tables.point(point, detail)
    }
}
