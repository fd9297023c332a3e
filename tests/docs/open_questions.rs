//! The studies of docs/open-questions.md.

use std::fs;
use std::path::Path;

use stickslip::study::Study;

const STUDIES: &str = "studies/open-questions";

/// The studies of the questions load, resolve to themselves, have the names of their files, and
/// cover both normal forces.
#[test]
fn studies_of_the_open_questions() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = fs::read_dir(root.join(STUDIES)).expect("studies");
    let names =
        files.map(|entry| entry.expect("a file").file_name().into_string().expect("a plain name"));
    let mut found = 0;
    for name in names.filter(|name| name.ends_with(".yaml")) {
        let path = format!("{STUDIES}/{name}");
        let study = Study::load(&root.join(&path)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(name, format!("{}.yaml", study.name()));
        let again = Study::parse(Path::new("resolved.yaml"), study.resolved_yaml());
        assert_eq!(again.unwrap_or_else(|error| panic!("{error}")).hash(), study.hash());
        assert!(study.planned_run(study.run_count() - 1).case.is_ok(), "{path}");
        assert!(study.swept().iter().any(|one| one.name == "normal_force"), "{path}");
        found += 1;
    }
    assert!(found > 10, "{found} studies");
}
