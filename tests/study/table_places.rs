//! Allowed locations of tables: the study file's directory, and those that the user names.

use std::fs;
use std::path::{Path, PathBuf};

use stickslip::study::{Study, StudyError};
use tempfile::TempDir;

use super::text_with_design;

/// A directory with a folder `inside` for the study, and one `outside` with a table.
struct Place(TempDir);

impl Place {
    fn new() -> Place {
        let place = Place(TempDir::new().unwrap());
        fs::create_dir_all(place.path("inside/deeper")).unwrap();
        fs::create_dir_all(place.path("outside/deeper")).unwrap();
        for name in ["inside/a.csv", "inside/deeper/a.csv", "outside/a.csv", "outside/deeper/a.csv"]
        {
            fs::write(place.path(name), "speed_rad_s\n-160\n").unwrap();
        }
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn load(&self, table: &str, tables: &[&str]) -> Result<Study, StudyError> {
        let design = text_with_design("{monte_carlo: {samples: 10}}");
        let study = self.path("inside/study.yaml");
        fs::write(&study, format!("{design}sweep: [{{table: {table:?}}}]\n")).unwrap();
        let tables: Vec<PathBuf> = tables.iter().map(|name| self.path(name)).collect();
        Study::load_with_tables(&study, &tables)
    }

    #[track_caller]
    fn refused(&self, table: &str, problem: &str, found: &str) {
        let error = self.load(table, &[]).expect_err("refused");
        assert!(error.file().ends_with("inside/study.yaml"), "{error}");
        assert_eq!((error.line(), error.key()), (Some(7), "sweep[0].table"), "{error}");
        assert!(error.problem().contains(problem), "{error}");
        assert!(error.found().unwrap_or_default().contains(found), "{error}");
    }

    #[track_caller]
    fn outside(&self, table: &str) {
        self.refused(table, "outside the study file's directory", table);
        let error = self.load(table, &[]).unwrap_err();
        assert!(error.allowed().unwrap().contains("the option --tables DIR"), "{error}");
    }
}

#[test]
fn paths_inside_are_followed() {
    let place = Place::new();
    let study = place.load("a.csv", &[]).unwrap();
    for table in ["./a.csv", "deeper/a.csv", "deeper/../a.csv", "deeper/../deeper/./a.csv"] {
        assert_eq!(place.load(table, &[]).unwrap().resolved_yaml(), study.resolved_yaml());
    }
}

#[test]
fn paths_that_lead_out_are_refused_whether_or_not_there_is_anything() {
    let place = Place::new();
    for table in
        ["../outside/a.csv", "../nothing.csv", "deeper/../../outside/a.csv", "../inside/a.csv"]
    {
        place.outside(table);
    }
    place.outside(place.path("outside/a.csv").to_str().unwrap());
    place.outside(place.path("inside/a.csv").to_str().unwrap());
    place.outside("/dev/zero");
    place.outside("/");
}

#[test]
fn directories_after_tables_allow_what_lies_in_them_and_change_nothing_else() {
    let place = Place::new();
    let inside = place.load("a.csv", &[]).unwrap();
    let absolute = place.path("outside/a.csv");
    for table in ["../outside/a.csv", "../outside/deeper/a.csv", absolute.to_str().unwrap()] {
        for tables in [["outside"].as_slice(), &["inside/deeper", "outside"], &["."]] {
            let study = place.load(table, tables).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(study.resolved_yaml(), inside.resolved_yaml());
            assert_eq!(study.hash(), inside.hash());
        }
        let error = place.load(table, &["inside/deeper"]).unwrap_err();
        assert!(error.problem().contains("the directories given with --tables"), "{error}");
    }
    // Allowed directories are not searched: a name means the file beside the study.
    fs::write(place.path("outside/b.csv"), "speed_rad_s\n-1\n").unwrap();
    let error = place.load("b.csv", &["outside"]).unwrap_err();
    assert!(error.problem().contains("No such file"), "{error}");
    fs::write(place.path("outside/a.csv"), "speed_rad_s\n-1\n").unwrap();
    let study = place.load("a.csv", &["outside"]).unwrap();
    assert_eq!(study.resolved_yaml(), inside.resolved_yaml());
    // A path that is not a directory.
    for name in ["nothing", "inside/a.csv"] {
        let error = place.load("a.csv", &[name]).unwrap_err();
        assert!(error.file().ends_with(name), "{error}");
        assert!(error.allowed().unwrap().contains("directory after --tables"), "{error}");
    }
}

#[test]
fn directories_and_names_of_other_kinds_are_refused() {
    let place = Place::new();
    place.refused("deeper", "a directory", "deeper");
    place.refused("", "a directory", "");
    place.refused("a.csv/", "Not a directory", "a.csv/");
    place.refused("a\0.csv", "", "a");
    for name in ["secret", "a.txt", "a.csv.bak", ".csv"] {
        fs::write(place.path("inside").join(name), "token 12345").unwrap();
        place.refused(name, "ends in neither .csv nor .parquet", name);
    }
    fs::write(place.path("inside/a.CSV"), "speed_rad_s\n-160\n").unwrap();
    assert!(place.load("a.CSV", &[]).is_ok());
}

#[cfg(unix)]
mod links {
    use std::os::unix::fs::symlink;
    use std::process::Command;

    use super::*;

    fn link(place: &Place, to: &Path, name: &str) {
        symlink(to, place.path("inside").join(name)).unwrap();
    }

    #[test]
    fn links_are_followed_inside_only() {
        let place = Place::new();
        link(&place, Path::new("deeper/a.csv"), "in.csv");
        link(&place, &place.path("inside/a.csv"), "absolute.csv");
        link(&place, Path::new("deeper"), "folder");
        for table in ["in.csv", "absolute.csv", "folder/a.csv"] {
            assert!(place.load(table, &[]).is_ok(), "{table}");
        }
        link(&place, Path::new("../outside/a.csv"), "out.csv");
        link(&place, &place.path("outside"), "elsewhere");
        link(&place, Path::new("/dev/zero"), "zero.csv");
        link(&place, Path::new("/proc/self/environ"), "environ.csv");
        for table in ["out.csv", "elsewhere/a.csv", "elsewhere/../outside/a.csv", "zero.csv"] {
            place.outside(table);
            place.refused(table, "outside", "a link to /");
        }
        if Path::new("/proc/self/environ").exists() {
            place.outside("environ.csv");
        }
        for table in ["out.csv", "elsewhere/a.csv"] {
            assert!(place.load(table, &["outside"]).is_ok(), "{table}");
        }
        // A link to itself, and a dangling one.
        link(&place, Path::new("loop.csv"), "loop.csv");
        place.refused("loop.csv", "the table cannot be read", "loop.csv");
        link(&place, Path::new("nothing.csv"), "dangling.csv");
        place.refused("dangling.csv", "No such file", "dangling.csv");
    }

    #[test]
    fn special_files_are_refused_also_where_they_are_allowed_to_lie() {
        let place = Place::new();
        let made = Command::new("mkfifo").arg(place.path("inside/pipe.csv")).status().unwrap();
        assert!(made.success());
        place.refused("pipe.csv", "not a regular file", "pipe.csv");
        let error = place.load("/dev/zero", &["/dev"]).unwrap_err();
        assert!(error.problem().contains("not a regular file"), "{error}");
    }
}

#[test]
fn tables_of_a_study_are_bounded_together() {
    let place = Place::new();
    // A row of three bytes, three hundred thousand times.
    let large = format!("speed_rad_s\n{}", "-1\n".repeat(300_000));
    fs::write(place.path("inside/large.csv"), large).unwrap();
    let load = |tables: &[&str]| {
        let blocks: Vec<String> = tables.iter().map(|name| format!("- table: {name}\n")).collect();
        let design = text_with_design("{monte_carlo: {samples: 1}}");
        let study = place.path("inside/study.yaml");
        fs::write(&study, format!("{design}sweep:\n{}", blocks.concat())).unwrap();
        Study::load(&study)
    };
    assert_eq!(load(&["large.csv"; 3]).unwrap().point_count(), 900_000);
    let error = load(&["large.csv"; 4]).unwrap_err();
    assert_eq!((error.line(), error.key()), (Some(11), "sweep[3].table"), "{error}");
    assert!(error.problem().contains("too many values"), "{error}");
    let error = load(&["a.csv"; 1001]).unwrap_err();
    assert_eq!(error.key(), "sweep[1000].table", "{error}");
    assert!(error.problem().contains("too many tables"), "{error}");
    // Comments are not values, but must be read.
    let comments = format!("speed_rad_s\n-1\n{}", "#\n".repeat(20_000_000));
    fs::write(place.path("inside/comments.csv"), comments).unwrap();
    let error = load(&["comments.csv", "comments.csv"]).unwrap_err();
    assert_eq!(error.key(), "sweep[1].table", "{error}");
    assert!(error.problem().contains("the tables are too large"), "{error}");
    let too_many = format!("speed_rad_s\n{}", "-1\n".repeat(1_000_001));
    fs::write(place.path("inside/rows.csv"), too_many).unwrap();
    let error = load(&["rows.csv"]).unwrap_err();
    assert_eq!((error.line(), error.key()), (Some(1_000_002), "row 1000001"), "{error}");
}
