//! Tests the functions of `targets` with thousands of damaged inputs in limited memory and time.
//!
//! A child process with a limited allocator announces and tests each input. If the child dies or exceeds the time limit, the
//! parent process writes the input to a file and starts another child with the next input.
//!
//! - `cargo test --test fuzz` takes a few seconds. Names select targets:
//!   `cargo test --test fuzz -- csv_table`.
//! - `STICKSLIP_FUZZ_RUNS=1000000` tests more inputs for each kind of file, `STICKSLIP_FUZZ_SEED=7`
//!   different ones.
//! - `cargo test --test fuzz -- --input study FILE` tests one file.
//! - `cargo test --test fuzz -- --write-corpus` rewrites the binary files of `fuzz/corpus`.

mod corpus;
mod hostile;
mod mutate;
mod targets;

use std::env;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use cap::Cap;
use rayon::prelude::*;
use targets::{TARGETS, target};

/// An allocator that refuses more memory than its limit.
#[global_allocator]
static ALLOCATOR: Cap<std::alloc::System> = Cap::new(std::alloc::System, usize::MAX);

/// Memory limit for one input, bytes. An input has at most a quarter of a megabyte; a table of a million values, to which it
/// can decompress, takes about half of this limit.
const MEMORY: usize = 1 << 30;
/// Time limit for one input, with a wide margin for busy machines.
const TIME: Duration = Duration::from_secs(120);
/// Number of inputs for each target, and for the slow target.
const RUNS: u64 = 3000;
const SLOW_RUNS: u64 = 60;
const SLOW: &str = "finished_runs";
/// The child's message that an input was usable.
const READ: &str = "read";
/// Number of faults after which a target is abandoned.
const MOST_FAULTS: usize = 10;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words[..] {
        ["--child", name, seed, first, end] => {
            child(name, number(seed), number(first)..number(end));
            ExitCode::SUCCESS
        }
        ["--input", name, file] => {
            ALLOCATOR.set_limit(MEMORY).expect("a new process");
            let folder = tempfile::tempdir().unwrap();
            let read = target(name)(folder.path(), &fs::read(file).unwrap());
            println!("{}", if read { "read" } else { "refused" });
            ExitCode::SUCCESS
        }
        ["--write-corpus"] => {
            corpus::write();
            ExitCode::SUCCESS
        }
        _ if words.contains(&"--list") => {
            TARGETS.iter().for_each(|(name, _)| println!("fuzz::{name}: test"));
            println!("fuzz::hostile: test");
            println!("fuzz::net: test");
            ExitCode::SUCCESS
        }
        _ => parent(&words),
    }
}

fn number(text: &str) -> u64 {
    text.parse().unwrap_or_else(|_| panic!("not a number: {text}"))
}

type Check = Box<dyn Fn() -> (String, Vec<String>) + Sync>;

fn parent(words: &[&str]) -> ExitCode {
    let names: Vec<&str> = words.iter().copied().filter(|word| !word.starts_with('-')).collect();
    let wanted = |name: &str| {
        names.is_empty() || names.iter().any(|word| format!("fuzz::{name}").contains(word))
    };
    let setting = |name: &str| env::var(name).ok().map(|text| number(&text));
    let seed = setting("STICKSLIP_FUZZ_SEED").unwrap_or(1);
    let targets: Vec<&str> = TARGETS.iter().map(|(name, _)| *name).filter(|n| wanted(n)).collect();
    let mut checks: Vec<Check> = Vec::new();
    if wanted("net") {
        checks.push(Box::new(|| {
            let names = BAD.par_iter().map(|(name, _)| *name);
            let holes: Vec<&str> = names.filter(|name| !caught(name)).collect();
            ("net".to_owned(), holes.into_iter().map(str::to_owned).collect())
        }));
    }
    if wanted("hostile") {
        checks.push(Box::new(|| {
            let names = hostile::FILES.par_iter().map(|(name, ..)| *name);
            ("hostile".to_owned(), names.filter_map(not_refused).collect())
        }));
    }
    for name in targets {
        let least = if name == SLOW { SLOW_RUNS } else { RUNS };
        let end = setting("STICKSLIP_FUZZ_RUNS").unwrap_or(least);
        checks.push(Box::new(move || {
            let (read, faults) = faults(name, seed, end);
            (format!("{name}, {end} inputs ... {read} read, the others refused"), faults)
        }));
    }
    let faults: Vec<String> = checks
        .par_iter()
        .with_max_len(1)
        .flat_map_iter(|check| {
            let (what, faults) = check();
            println!("test fuzz::{what} ... {}", if faults.is_empty() { "ok" } else { "FAILED" });
            faults
        })
        .collect();
    faults.iter().for_each(|fault| println!("{fault}"));
    if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Faults that the parent must detect; each occurs at the second input.
const BAD: [(&str, fn()); 4] = [
    ("panics", || panic!("as it should")),
    ("overflows", || assert_ne!(deeper(u64::MAX), 1)),
    ("takes memory", || drop(std::hint::black_box(Vec::<u8>::with_capacity(2 * MEMORY)))),
    ("takes time", || thread::sleep(Duration::from_secs(600))),
];

/// Recurses far deeper than the stack allows.
fn deeper(times: u64) -> u64 {
    let room = std::hint::black_box([times; 512]);
    if times == 0 { 0 } else { deeper(times - 1).wrapping_add(room[511]) }
}

/// Returns whether the parent detects the fault of a bad target at the second input.
fn caught(name: &str) -> bool {
    let (read, died) = one_child(name, 0, 0, 3, Duration::from_secs(5));
    died.is_some_and(|(number, _)| number == 1) && read == 1
}

/// Returns the fault of a hostile table that is not refused with its message.
fn not_refused(name: &str) -> Option<String> {
    one_child(name, 0, 0, 1, TIME).1.map(|(_, what)| format!("{name}: {what}"))
}

/// Runs children until all inputs have been tested. Returns the number of usable inputs, and the
/// faults.
fn faults(name: &str, seed: u64, end: u64) -> (u64, Vec<String>) {
    let mut faults = Vec::new();
    let (mut first, mut all_read) = (0, 0);
    while first < end && faults.len() < MOST_FAULTS {
        let (read, died) = one_child(name, seed, first, end, TIME);
        all_read += read;
        let Some((number, what)) = died else { break };
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{seed}-{number}"));
        fs::write(&file, mutate::input(&corpus::read(name), seed, number)).unwrap();
        faults.push(format!("{name}, input {number} of seed {seed}, {}:\n{what}", file.display()));
        first = number + 1;
    }
    if all_read == 0 {
        faults.push(format!("{name}: the corpus is out of date: none of its files is usable"));
    }
    (all_read, faults)
}

/// Runs one child. Returns the number of usable inputs and, if the child died, the input and its
/// last output.
fn one_child(
    name: &str,
    seed: u64,
    first: u64,
    end: u64,
    time: Duration,
) -> (u64, Option<(u64, String)>) {
    let said = tempfile::NamedTempFile::new().unwrap();
    let mut child = Command::new(env::current_exe().unwrap())
        .args(["--child", name, &seed.to_string(), &first.to_string(), &end.to_string()])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(File::create(said.path()).unwrap())
        .spawn()
        .unwrap();
    let output = BufReader::new(child.stdout.take().unwrap());
    let (sender, receiver) = mpsc::channel();
    let reader = thread::spawn(move || {
        for line in output.lines() {
            if line.is_err() || sender.send(line.unwrap_or_default()).is_err() {
                return;
            }
        }
    });
    let (mut current, mut read) = (first, 0);
    let late = loop {
        match receiver.recv_timeout(time) {
            Ok(line) if line == READ => read += 1,
            Ok(line) => current = line.parse().unwrap_or(current),
            Err(mpsc::RecvTimeoutError::Disconnected) => break false,
            Err(mpsc::RecvTimeoutError::Timeout) => break true,
        }
    };
    if late {
        child.kill().unwrap();
    }
    let status = child.wait().unwrap();
    reader.join().unwrap();
    if status.success() && !late {
        return (read, None);
    }
    let words = fs::read(said.path()).unwrap_or_default();
    let words = String::from_utf8_lossy(&words[words.len().saturating_sub(2000)..]).into_owned();
    let how = if late { format!("more than {time:?}") } else { status.to_string() };
    (read, Some((current, format!("{how}\n{words}"))))
}

/// Tests inputs and announces each one.
fn child(name: &str, seed: u64, numbers: std::ops::Range<u64>) {
    if let Some((_, bad)) = BAD.iter().find(|(other, _)| *other == name) {
        ALLOCATOR.set_limit(ALLOCATOR.allocated() + MEMORY).unwrap();
        println!("0\n{READ}\n1");
        return bad();
    }
    if let Some((_, hostile, message)) = hostile::FILES.iter().find(|(other, ..)| *other == name) {
        let (folder, file) = (tempfile::tempdir().expect("a folder"), hostile());
        let limit = ALLOCATOR.allocated() + hostile::MEMORY;
        ALLOCATOR.set_limit(limit).expect("a limit above what is allocated");
        println!("0");
        let found = hostile::message(folder.path(), &file);
        return assert!(found.contains(message), "{found}");
    }
    let (target, corpus) = (target(name), corpus::read(name));
    let folder = tempfile::tempdir().unwrap();
    let folder: PathBuf = folder.path().canonicalize().unwrap();
    let mut output = std::io::stdout().lock();
    for number in numbers {
        let input = mutate::input(&corpus, seed, number);
        writeln!(output, "{number}").unwrap();
        output.flush().unwrap();
        // The process's own memory, such as its arguments and the corpus, does not count.
        ALLOCATOR.set_limit(ALLOCATOR.allocated() + MEMORY).unwrap();
        if target(&folder, &input) {
            writeln!(output, "{READ}").unwrap();
        }
    }
    fs::remove_dir_all(folder).unwrap();
}
