//! Dependencies comply with `deny.toml` (licences, versions, sources, no network packages), and files with the order of the
//! rooms.
//!
//! `deny.toml` is also the configuration of cargo-deny, which takes longer to compile than this
//! project; `scripts/policy` runs it if it is installed. Advisories need its database and are
//! checked only there. The built packages come from `cargo tree`, because `cargo metadata` also
//! lists optional dependencies that no feature enables.

mod imports;
mod rules;

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use serde::Deserialize;

use self::rules::{Built, Locked, Policy};

fn read(name: &str) -> String {
    fs::read_to_string(format!("{}/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn policy() -> Policy {
    Policy::parse(&read("deny.toml"))
}

/// Returns all packages of `Cargo.lock`.
fn locked() -> Vec<Locked> {
    #[derive(Deserialize)]
    struct Lock {
        package: Vec<Locked>,
    }
    basic_toml::from_str::<Lock>(&read("Cargo.lock")).unwrap().package
}

/// Returns all packages that are built for the program, its tests and its benches: on this platform
/// or, if `STICKSLIP_ALL_PLATFORMS` is set and all packages have been fetched, on those of
/// `deny.toml`, including the Python package.
fn built() -> BTreeSet<Built> {
    match std::env::var_os("STICKSLIP_ALL_PLATFORMS") {
        None => built_with(&[]),
        Some(_) => {
            let all = |target: &String| built_with(&["--workspace", "--target", target]);
            policy().targets().iter().flat_map(all).collect()
        }
    }
}

fn built_with(target: &[&str]) -> BTreeSet<Built> {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(env!("CARGO_MANIFEST_DIR"));
    cargo.args(["tree", "--locked", "--offline", "--all-features", "--edges", "normal,build,dev"]);
    let output = cargo.args(["--prefix", "none", "--format", "{p}|{l}"]).args(target).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().filter(|line| !line.is_empty()).map(package).collect()
}

/// Parses a line of `cargo tree`: `name v1.2.3 (more)|licence (*)`.
fn package(line: &str) -> Built {
    let (place, license) = line.split_once('|').unwrap();
    let mut words = place.split(' ');
    let name = words.next().unwrap().to_owned();
    let version = words.next().unwrap().trim_start_matches('v').to_owned();
    Built { name, version, license: license.trim_end_matches("(*)").trim().to_owned() }
}

#[track_caller]
fn none(found: &[String]) {
    assert!(found.is_empty(), "violations of deny.toml:\n{}", found.join("\n"));
}

#[test]
fn licences_are_allowed() {
    let built = built();
    assert!(built.len() > 50 && built.iter().any(|package| package.name == "stickslip"));
    none(&policy().licences(&built));
}

#[test]
fn no_package_is_built_twice() {
    none(&policy().duplicates(&built()));
    none(&policy().needless(&locked()));
}

#[test]
fn packages_come_from_the_registry() {
    let locked = locked();
    assert!(locked.iter().filter(|package| package.source.is_some()).count() > 50);
    none(&policy().sources(&locked));
}

#[test]
fn no_package_is_for_networks() {
    none(&policy().denied(&locked()));
}

#[test]
fn violations_of_the_rules_are_found() {
    let built = |line: &str| package(line);
    let locked = |name: &str, version: &str, source: &str| Locked {
        name: name.to_owned(),
        version: version.to_owned(),
        source: (!source.is_empty()).then(|| source.to_owned()),
    };
    let policy = policy();
    let found = policy.licences(&BTreeSet::from([
        built("good v1.0.0|MIT OR Apache-2.0"),
        built("old v1.0.0 (proc-macro)|MIT/Apache-2.0 (*)"),
        built("either v1.0.0|GPL-3.0-only OR MIT"),
        built("copyleft v1.0.0|GPL-3.0-only"),
        built("also v1.0.0|MIT AND GPL-3.0-only (*)"),
        built("silent v1.0.0|"),
        built("own v1.0.0|My own words"),
    ]));
    let names: Vec<&str> = found.iter().map(|line| line.split(' ').next().unwrap()).collect();
    assert_eq!(names, ["also", "copyleft", "own", "silent"]);

    let twice =
        BTreeSet::from([built("a v1.0.0|MIT"), built("a v2.0.0|MIT"), built("b v1.0.0|MIT")]);
    assert_eq!(policy.duplicates(&twice), ["a: in versions 1.0.0 and 2.0.0; one, or [bans] skip"]);

    let crates_io = "registry+https://github.com/rust-lang/crates.io-index";
    let packages = [
        locked("stickslip", "0.1.0", ""),
        locked("good", "1.0.0", crates_io),
        locked("hyper", "1.0.0", crates_io),
        locked("fork", "1.0.0", "git+https://example.org/fork?branch=main#0123"),
        locked("elsewhere", "1.0.0", "registry+https://example.org/index"),
    ];
    assert_eq!(policy.denied(&packages), ["hyper 1.0.0: denied, network"]);
    let foreign: Vec<String> = policy.sources(&packages);
    assert_eq!(foreign.len(), 2, "{foreign:?}");
    assert!(foreign[0].starts_with("fork") && foreign[1].starts_with("elsewhere"));
    assert!(policy.needless(&packages).iter().any(|line| line.contains("getrandom")));
}
