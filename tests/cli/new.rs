//! `stickslip new`: templates, names and files that exist.

use serde_json::json;
use stickslip::study::Template;

use super::support::{Scratch, assert_has};

#[test]
fn every_template_can_be_checked() {
    let scratch = Scratch::new();
    for Template { name, summary, .. } in Template::ALL {
        let file = format!("of-{name}.yaml");
        assert_eq!(scratch.well(&format!("new {file} --template {name}")), "");
        let plan = scratch.json(&format!("check {file} --json"));
        assert_eq!((&plan["study"], &plan["warnings"]), (&json!(format!("of-{name}")), &json!([])));
        scratch.prints("new --list", &[format!("{name:<12} {summary}\n")]);
        scratch.prints("new --help", &[format!("{name}:"), summary.to_owned()]);
    }
    assert_eq!(scratch.well("new --list").lines().count(), Template::ALL.len());
}

/// Standard output has the template under its own name, and the default template is `machine`.
#[test]
fn to_standard_output() {
    let scratch = Scratch::new();
    let printed = scratch.prints("new -", &["\nname: machine\n", "#   stickslip run study.yaml\n"]);
    assert_eq!(printed, scratch.well("new - --template machine"));
    assert!(scratch.files().is_empty());
    let ended = scratch.stickslip("new machine.yaml");
    assert_eq!((ended.code, ended.out.as_str()), (Some(0), ""));
    assert_has(&ended.err, &["next: stickslip check machine.yaml"]);
    let written = scratch.text("machine.yaml");
    assert_eq!(written.replace("machine.yaml", "study.yaml"), printed);
}

#[test]
fn files_that_cannot_be_written_are_refused() {
    let scratch = Scratch::with("mine");
    let new = "allowed: the name of a new file";
    scratch.refused("new a.yaml", &["a.yaml: exists already", new]);
    scratch.refused("new none/b.yaml", &["none/b.yaml: ", new, "in a directory"]);
    scratch.refused("new ä.yaml", &["ä.yaml: not a name", "found:", "allowed: 1 to 100 letters"]);
    scratch.refused("new b.yaml --template masch", &["invalid value 'masch'", "machine"]);
    scratch.refused("new", &["<FILE>"]);
    scratch.refused("new b.yaml --list", &["cannot be used with"]);
}
