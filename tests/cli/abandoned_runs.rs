//! Very long runs: an interruption takes effect within a run, and abandoned runs are computed again
//! to the same bytes.

#![cfg(target_os = "linux")]

use std::process::Stdio;
use std::time::{Duration, Instant};

use super::interrupt::{catches, send, ticks, wait_until};
use super::support::{Ended, Scratch, study_text};

/// A generous limit for the one second that a run may continue after an interruption.
const SOON: Duration = Duration::from_secs(20);

/// A disc so fast that a run takes many steps, friction so steep at rest that an explicit method takes millions, and a table of
/// many speeds. There are more runs than any machine computes within the time limit.
const STUDIES: [(&str, &str); 3] = [
    ("fast", "parameters: {speed_rad_s: -1.8e6, friction_coefficient: 1.0e-5}"),
    ("steep", "friction: {smooth: {smoothing_speed_rad_s: 1.0e-6}}"),
    ("table", "speed_profile: [{table: table.csv}]"),
];

#[test]
fn a_stop_abandons_long_runs() {
    let scratch = Scratch::new();
    let row = |row: u32| format!("{row}e-5,{}\n", -100.0 - 1e-3 * f64::from(row));
    let rows: String = (0..100_000).map(row).collect();
    scratch.write("table.csv", format!("time_s,speed_rad_s\n{rows}"));
    for (name, model) in STUDIES {
        let model = format!("model: {{kind: ball_balancer, {model}}}\n");
        let text = study_text(name, "{monte_carlo: {samples: 4000}}", 1.0, &model);
        scratch.write(&format!("{name}.yaml"), text);
        let command = format!("run {name}.yaml --threads 1 --out {name}");
        let child = scratch.command(&command).spawn().unwrap();
        wait_until("the program catches signals", || catches(&child, 15));
        wait_until("it computes", || ticks(&child) >= 20);
        send(&child, "TERM");
        let sent = Instant::now();
        let ended = Ended::of(child.wait_with_output().unwrap());
        assert!(sent.elapsed() < SOON, "{name}: {:?}", sent.elapsed());
        assert_eq!(ended.code, Some(130), "{name}: {}", ended.err);
    }
}

/// A run that ends immediately beside one that takes several times longer than the time limit and its grace of one second.
#[test]
fn what_was_given_up_is_computed_again_to_the_same_bytes() {
    let scratch = Scratch::new();
    let text = study_text(
        "mixed",
        "{monte_carlo: {samples: 1}}",
        1.5e4,
        "sweep: [{grid: {friction_coefficient: [1.0e-2, 0.0]}}]\n\
         model: {kind: ball_balancer, parameters: {speed_rad_s: -216.0}}\n",
    );
    scratch.write("mixed.yaml", text);
    let said = ["out of time (--max-seconds) after 1 of 2 runs; ", " in progress w"];
    scratch.tells("run mixed.yaml --out out --threads 1 --max-seconds 0.5", 130, &said);
    assert_eq!(scratch.table("out", "runs").num_rows(), 1);
    assert_eq!(scratch.manifest("out")["runs_finished"], 1);
    scratch.well("resume out");
    scratch.well("run mixed.yaml --out whole --threads 1");
    assert_eq!(scratch.data("out"), scratch.data("whole"));
}

/// Ctrl-C also ends a server that computes a long request.
#[test]
fn ctrl_c_ends_a_server_amid_a_long_request() {
    let scratch = Scratch::new();
    let text = study_text(
        "slow",
        "{monte_carlo: {samples: 8}}",
        1.0e5,
        "design: {friction_coefficient: {from: 0, to: 1}}\nresponses: {mean: {amplitude_mean: {}}}\n",
    );
    scratch.write("slow.yaml", text);
    let mut command = scratch.command("evaluate slow.yaml --designs - --threads 1");
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    std::io::Write::write_all(&mut stdin, b"{\"friction_coefficient\": 0}\n").unwrap();
    wait_until("the program catches signals", || catches(&child, 2));
    wait_until("it computes", || ticks(&child) >= 20);
    send(&child, "INT");
    let sent = Instant::now();
    let ended = Ended::of(child.wait_with_output().unwrap());
    assert!(sent.elapsed() < SOON, "{:?}", sent.elapsed());
    assert_eq!((ended.code, ended.out.as_str()), (Some(130), ""), "{}", ended.err);
}

/// A server whose answers are not read waits for its client, but can be interrupted.
#[test]
fn ctrl_c_ends_a_server_whose_answers_nobody_reads() {
    let scratch = super::evaluate::scratch();
    let mut child = super::evaluate::server(&scratch, "evaluate balls.yaml --designs -");
    let mut stdin = child.stdin.take().unwrap();
    wait_until("the program catches signals", || catches(&child, 2));
    // More than pipes and buffers hold; writing fails when the server ends.
    let asking =
        std::thread::spawn(
            move || {
                while std::io::Write::write_all(&mut stdin, b"no request\n").is_ok() {}
            },
        );
    let written = || {
        let text = std::fs::read_to_string(format!("/proc/{}/io", child.id())).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("wchar: ")).map(str::to_owned);
        line.and_then(|bytes| bytes.parse::<u64>().ok()).unwrap_or(0)
    };
    wait_until("it waits for its reader", || {
        let before = written();
        std::thread::sleep(Duration::from_millis(300));
        before > 30_000 && written() == before
    });
    send(&child, "INT");
    // Its standard output stays open and unread until it has ended.
    let sent = Instant::now();
    wait_until("it has ended", || {
        std::fs::read_to_string(format!("/proc/{}/stat", child.id()))
            .is_ok_and(|stat| stat.contains(") Z "))
    });
    assert!(sent.elapsed() < SOON, "{:?}", sent.elapsed());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    asking.join().unwrap();
}
