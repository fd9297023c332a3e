//! The program opens no network connection: it succeeds under a filter that kills any process that
//! tries.
//!
//! A seccomp filter on a thread is inherited by the processes that the thread starts. Unlike a
//! network namespace or a tracer, it needs no privileges and no tools, also in a container.
//! `deny.toml` excludes network packages.

#![cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64")))]

use std::net::{TcpListener, TcpStream, UdpSocket};
use std::os::unix::process::ExitStatusExt;
use std::process::{ExitStatus, Output};
use std::thread;

use seccompiler::{BpfProgram, SeccompAction, SeccompFilter, apply_filter};

use super::support::{AT_ONCE, Scratch, study_text};

/// All system calls for networks: creating and using sockets, and io_uring, whose operations bypass
/// system-call filters.
const NETWORK: [i64; 10] = [
    libc::SYS_socket,
    libc::SYS_connect,
    libc::SYS_bind,
    libc::SYS_listen,
    libc::SYS_accept,
    libc::SYS_accept4,
    libc::SYS_sendto,
    libc::SYS_sendmsg,
    libc::SYS_sendmmsg,
    libc::SYS_io_uring_setup,
];

/// Runs a closure on a thread with a filter, inherited by child processes, that applies an action
/// to these system calls.
fn without<T: Send>(calls: &[i64], action: SeccompAction, work: impl FnOnce() -> T + Send) -> T {
    let rules = calls.iter().map(|call| (*call, Vec::new())).collect();
    let here = std::env::consts::ARCH.try_into().unwrap();
    let filter = SeccompFilter::new(rules, SeccompAction::Allow, action, here).unwrap();
    let program: BpfProgram = filter.try_into().unwrap();
    let filtered = || {
        apply_filter(&program).unwrap();
        work()
    };
    thread::scope(|scope| scope.spawn(filtered).join().unwrap())
}

/// Runs the program under a filter that kills.
fn killing(scratch: &Scratch, calls: &[i64], arguments: &str) -> Output {
    let run = || scratch.command(arguments).output().unwrap();
    without(calls, SeccompAction::KillProcess, run)
}

/// Returns whether a process was killed by a filter.
fn killed(status: ExitStatus) -> bool {
    status.signal() == Some(libc::SIGSYS)
}

fn scratch() -> Scratch {
    let expect = "expect: [{point: {}, undecided_fraction: [1, 1]}]\n";
    Scratch::with(study_text("a", "{monte_carlo: {samples: 20}}", AT_ONCE, expect))
}

#[test]
fn no_command_opens_a_connection() {
    let scratch = scratch();
    for arguments in [
        "run a.yaml --out out --threads 2",
        "run a.yaml --out out",
        "run a.yaml --out part --shard 1/2",
        "verify a.yaml",
        "run a.yaml --out begun --max-seconds 0",
        "resume begun",
        "run a.yaml --shard 1/2 --out part-1",
        "run a.yaml --shard 2/2 --out part-2",
        "merge part-1 part-2 --out whole",
        "check a.yaml --existence",
        "expand a.yaml",
        "expand a.yaml --out cases.parquet",
        "equilibria a.yaml --grid 16 --out sets",
        "schema",
        "new study.yaml",
        "completions bash",
        "--help",
    ] {
        let output = killing(&scratch, &NETWORK, arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!killed(output.status), "`stickslip {arguments}` used the network\n{said}");
        let expected = if arguments.contains("--max-seconds 0") { 130 } else { 0 };
        assert_eq!(output.status.code(), Some(expected), "`stickslip {arguments}`\n{said}");
    }
    assert_eq!(scratch.manifest("out")["runs_finished"], 20);
}

/// The filter stops every kind of connection, and applies to the program.
#[test]
fn the_filter_kills_connecting_programs() {
    let unlikely = libc::EXDEV;
    let refused = |errors: [Option<std::io::Error>; 4]| {
        errors.map(|error| error.and_then(|error| error.raw_os_error()) == Some(unlikely))
    };
    let tried = without(&NETWORK, SeccompAction::Errno(unlikely as u32), || {
        refused([
            TcpStream::connect("127.0.0.1:9").err(),
            TcpStream::connect("[::1]:9").err(),
            TcpListener::bind("127.0.0.1:0").err(),
            UdpSocket::bind("127.0.0.1:0").err(),
        ])
    });
    assert_eq!(tried, [true; 4]);
    // A system call that the program certainly makes.
    let output = killing(&scratch(), &[libc::SYS_fsync], "run a.yaml --out out");
    assert!(killed(output.status), "{:?}", output.status);
}
