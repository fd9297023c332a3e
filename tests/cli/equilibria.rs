//! `equilibria`: its tables, its messages, and its errors.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use arrow::array::AsArray;
use parquet::file::reader::{FileReader, SerializedFileReader};

use super::support::{
    AT_ONCE, Scratch, assert_has, column, counts, names, numbers, study_text, words,
};
use crate::support::shipped;
use crate::table::contract::listed;

const SWEEP: &str = "sweep:\n\
                     \x20 - grid: {speed_rad_s: [-160.0, -216.3772], normal_force: [lagrange]}\n\
                     \x20 - zip: {friction_coefficient: [2.75e-4]}\n";

fn study(rest: &str) -> String {
    study_text("a", "{monte_carlo: {samples: 4}}", AT_ONCE, rest)
}

fn scratch() -> Scratch {
    let scratch = Scratch::with(study(SWEEP));
    for (name, balls) in [("one", 1), ("three", 3)] {
        let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n");
        scratch.write(&format!("{name}.yaml"), study(&model));
    }
    scratch
}

#[test]
fn tables_agree_with_one_another() {
    let scratch = scratch();
    let text = scratch.well("equilibria a.yaml --grid 128 --out out");
    let header = "point  speed_rad_s  normal_force  friction_coefficient  fraction  components";
    assert_has(&text, &[header, "a1_plus", "b1", "0 .. 5.514e-5", "6                4"]);
    assert_eq!(text.lines().count(), 4);
    let expected = [
        "files.json",
        "frictionless_equilibria.parquet",
        "equilibrium_positions.parquet",
        "equilibrium_set_summary.parquet",
    ];
    let expected = expected.map(String::from);
    assert_eq!(scratch.names("out"), expected.into_iter().collect());

    let set = scratch.table("out", "equilibrium_positions");
    let key = listed("point_id, speed_rad_s, normal_force, friction_coefficient");
    let position = listed(
        "beta_1_rad, beta_2_rad, amplitude_m, required_friction_coefficient, friction_margin, \
         in_set",
    );
    assert_eq!(names(&set), [key.as_slice(), &position].concat());
    let sets = scratch.table("out", "equilibrium_set_summary");
    let summary = listed(
        "grid_positions, fraction, fraction_low, fraction_high, touching_fraction, components, \
         components_modulo_exchange, unresolved_equilibria, amplitude_min_m, amplitude_max_m, \
         amplitude_without_balls_m, min_amplitude_beta_1_rad, min_amplitude_beta_2_rad, balance, \
         balance_beta_1_rad, balance_beta_2_rad",
    );
    assert_eq!(names(&sets), [key, summary].concat());
    assert_eq!(counts(&sets, "grid_positions"), [128 * 128; 3]);
    assert_eq!(counts(&sets, "components"), [1, 1, 6]);
    assert_eq!(counts(&sets, "components_modulo_exchange"), [1, 1, 4]);
    assert_eq!(numbers(&sets, "fraction_low"), [None; 3]);

    // Row by row: a position is in the set if its margin is not negative, which is equivalent to
    // the friction being at least the required one; the number of such rows agrees with the
    // fraction; no amplitude exceeds the largest.
    let points = counts(&set, "point_id");
    let inside: Vec<bool> = column(&set, "in_set").as_boolean().iter().flatten().collect();
    let number = |name| -> Vec<f64> { numbers(&set, name).into_iter().flatten().collect() };
    let [amplitude, required, margin, friction] =
        ["amplitude_m", "required_friction_coefficient", "friction_margin", "friction_coefficient"]
            .map(number);
    assert_eq!((inside.len(), margin.len(), required.len()), (3 << 14, 3 << 14, 3 << 14));
    for row in 0..inside.len() {
        assert_eq!(inside[row], margin[row] >= 0.0);
        assert!((margin[row] - (1.0 - required[row] / friction[row])).abs() < 1e-9);
    }
    for point in 0..3 {
        let rows = (0..inside.len()).filter(|&row| points[row] == point && inside[row]);
        let fraction = rows.clone().count() as f64 / f64::from(1 << 14);
        assert_eq!(numbers(&sets, "fraction")[point as usize], Some(fraction));
        let largest = rows.map(|row| amplitude[row]).fold(0.0, f64::max);
        // The largest amplitude in the set is at a grid point or between two of them.
        let found = numbers(&sets, "amplitude_max_m")[point as usize].unwrap();
        assert!((0.0..5e-3).contains(&(found / largest - 1.0)), "{found} {largest}");
    }
}

#[test]
fn frictionless_equilibria_at_points_and_at_speeds_of_their_own() {
    let scratch = scratch();
    scratch.well("equilibria a.yaml --grid 8 --out out");
    let table = scratch.table("out", "frictionless_equilibria");
    let mut expected = listed(
        "point_id, speed_rad_s, normal_force, friction_coefficient, kind, beta_1_rad, beta_2_rad, \
         x_m, y_m, amplitude_m, family_dimension, stability",
    );
    for index in 1..=8 {
        expected.push(format!("eigenvalue_{index}_real_per_s"));
        expected.push(format!("eigenvalue_{index}_imag_rad_s"));
    }
    assert_eq!(names(&table), expected);
    assert_eq!(counts(&table, "point_id"), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]);

    let arguments = "equilibria a.yaml --no-set --grid 8 --speeds -150:-300:151";
    let said = ["a1_plus    147      30  -179.000 .. -150.000"];
    let text = scratch.prints(&format!("{arguments} --out speeds"), &said);
    assert_has(&text, &["b1    151     119  -300.000 .. -182.000"]);
    assert!(!scratch.names("speeds").contains("equilibrium_positions.parquet"));
    let table = scratch.table("speeds", "frictionless_equilibria");
    expected.drain(..4);
    expected.insert(0, "speed_rad_s".to_owned());
    assert_eq!(names(&table), expected);
    let speeds = numbers(&table, "speed_rad_s");
    assert_eq!((speeds[0], speeds[speeds.len() - 1]), (Some(-150.0), Some(-300.0)));
    let stable = words(&table, "stability").into_iter().zip(words(&table, "kind"));
    let stable = stable.filter(|(stability, _)| stability.as_deref() == Some("stable"));
    let kinds: BTreeSet<String> = stable.filter_map(|(_, kind)| kind).collect();
    assert_eq!(kinds, BTreeSet::from(["a1_plus", "b1"].map(String::from)));
}

/// A set of small components on a coarse grid: the output says that there are more components than
/// counted.
#[test]
fn a_grid_that_is_too_coarse_is_said_to_be() {
    let scratch = scratch();
    let coarse = scratch.stickslip("equilibria a.yaml --grid 16 --out coarse");
    assert_has(
        &coarse.err,
        &["warning: at 1 of them the set has components that are smaller than the grid's"],
    );
    let unseen =
        counts(&scratch.table("coarse", "equilibrium_set_summary"), "unresolved_equilibria");
    assert!(unseen[0] == 0 && unseen[1] == 0 && unseen[2] > 0, "{unseen:?}");
    let fine = scratch.stickslip("equilibria a.yaml --grid 128 --out fine");
    assert!(!fine.err.contains("warning"), "{}", fine.err);
}

#[test]
fn one_ball_and_three() {
    let scratch = scratch();
    scratch.well("equilibria one.yaml --out one");
    assert_eq!(scratch.table("one", "equilibrium_positions").num_rows(), 512);
    let said = ["95 % interval", "family", "b1"];
    scratch.prints("equilibria three.yaml --samples 1024 --out three", &said);
    let set = scratch.table("three", "equilibrium_positions");
    assert_eq!((set.num_rows(), names(&set)[3].as_str()), (1024, "beta_3_rad"));
    let sets = scratch.table("three", "equilibrium_set_summary");
    let [low, fraction, high] =
        ["fraction_low", "fraction", "fraction_high"].map(|name| numbers(&sets, name)[0].unwrap());
    assert!(0.0 < low && low < fraction && fraction < high && high < 1.0);
    assert_eq!(words(&sets, "balance"), [Some("family".to_owned())]);
    assert_eq!(numbers(&sets, "balance_beta_1_rad"), [None]);
}

#[test]
fn json_and_provenance_say_what_was_asked_for() {
    let scratch = scratch();
    let report = scratch.json("equilibria a.yaml --grid 64 --json --quiet --out out");
    assert_eq!(report["points"][2]["components_modulo_exchange"], 4);
    assert_eq!(report["points"][2]["balance"], "position");
    assert_eq!(report["points"][0]["stable_without_friction"][0], "a1_plus");
    assert_eq!(report["frictionless"][0]["kind"], "a1_plus");
    assert_eq!(report["frictionless"][0]["found"], 3);
    for name in ["equilibrium_positions", "equilibrium_set_summary", "frictionless_equilibria"] {
        let path = scratch.path("out").join(format!("{name}.parquet"));
        let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
        let pairs = reader.metadata().file_metadata().key_value_metadata().unwrap().clone();
        let ours = pairs.into_iter().find(|pair| pair.key == "stickslip").unwrap();
        let facts: serde_json::Value = serde_json::from_str(&ours.value.unwrap()).unwrap();
        assert_eq!((&facts["table"], &facts["study"]), (&name.into(), &"a".into()));
        assert_eq!(facts["options"]["grid"], 64);
        assert_eq!(facts["options"]["ball_damping"], 1e4);
        assert_eq!(facts["options"], report["options"]);
    }
}

#[test]
fn threads_change_no_byte() {
    let scratch = scratch();
    for (study, options) in [("a", "--speeds 100:200:40"), ("three", "--samples 1024")] {
        for threads in [1, 3] {
            let out = format!("--threads {threads} --out {study}-{threads}");
            scratch.well(&format!("equilibria {study}.yaml {options} {out} --quiet"));
        }
        let files = |threads: u32| -> Vec<(PathBuf, Vec<u8>)> {
            let directory = scratch.path(&format!("{study}-{threads}"));
            let below = |path: PathBuf| path.strip_prefix(&directory).map(Path::to_owned).ok();
            let all = scratch.files().into_iter();
            all.filter_map(|(path, content)| Some((below(path)?, content))).collect()
        };
        assert!(files(1).len() > 3 && files(1) == files(3), "{study}");
    }
}

#[test]
fn directories_are_filled_once() {
    let scratch = scratch();
    scratch.well("equilibria a.yaml --grid 8");
    let refused = [
        "results/a-equilibria: this directory is not empty",
        "found:   ",
        "allowed: another directory, with --out DIR",
    ];
    scratch.refused("equilibria a.yaml --grid 8", &refused);
    scratch.refused("equilibria a.yaml --out a.yaml", &["a.yaml: cannot be used", "allowed: "]);
}

#[test]
fn wrong_arguments_are_refused_before_anything_is_computed() {
    let scratch = scratch();
    let values =
        |first: u32| (0..400).map(|i| (first + i).to_string()).collect::<Vec<_>>().join(", ");
    let grid = format!("speed_rad_s: [{}], stiffness_n_m: [{}]", values(100), values(9000));
    let sweep = format!("sweep: [{{grid: {{{grid}}}}}]\n");
    scratch.write("many.yaml", study(&sweep));
    scratch.write("block.yaml", study("model: {kind: block_on_spring}\n"));
    scratch.refuses(
        "equilibria",
        r#"a.yaml --grid 1000000 ¦ 1000000 points per axis: 1000000000000 in all ¦ at most 8192
a.yaml --grid 99999999999 ¦ --grid is too fine ¦ 67108864 in all
one.yaml --grid 100000000 ¦ 100000000 in all for 1 ball\n ¦ 67108864
a.yaml --grid 8193 ¦ --grid is too fine ¦ at most 8192
a.yaml --grid 0 ¦ found "0" ¦ a whole number from 8
a.yaml --grid -5 ¦ found "-5" ¦ a whole number from 8
a.yaml --grid fine ¦ found "fine" ¦ a whole number from 8
a.yaml --samples 1024 ¦ --samples serves three balls or more ¦ --grid G
three.yaml --grid 64 ¦ --grid serves one ball or two ¦ a study with 3 balls
three.yaml --samples 1000 ¦ found "1000" ¦ a power of two from 1024 to 1048576
three.yaml --samples 2097152 ¦ found "2097152" ¦ 1048576
many.yaml ¦ 262144 positions at each of 160000 points ¦ use --no-set
a.yaml --speeds 1:2 ¦ found "1:2" ¦ FROM:TO:COUNT
a.yaml --speeds 1:2:3:4 ¦ found "1:2:3:4" ¦ FROM:TO:COUNT
a.yaml --speeds 1:2:0 ¦ the number of speeds "0" ¦ a whole number from 1 to 100000
a.yaml --speeds 1:2:-3 ¦ the number of speeds "-3" ¦ a whole number from 1
a.yaml --speeds 1:2:1000000 ¦ the number of speeds "1000000" ¦ to 100000
a.yaml --speeds 2:2:5 ¦ 5 speeds from 2 to 2 ¦ two or more speeds with different FROM and TO
a.yaml --speeds 1:2:1 ¦ 1 speeds from 1 to 2 ¦ two or more speeds with different FROM and TO
a.yaml --speeds slow:2:5 ¦ the speeds "slow" and "2" ¦ numbers up to
a.yaml --speeds nan:2:5 ¦ the speeds "nan" and "2" ¦ numbers up to
a.yaml --speeds 1:inf:5 ¦ the speeds "1" and "inf" ¦ numbers up to
a.yaml --ball-damping 0 ¦ found "0" ¦ a number above 0, up to 100000
a.yaml --ball-damping -1 ¦ found "-1" ¦ a number above 0
a.yaml --ball-damping nan ¦ found "nan" ¦ a number above 0
block.yaml --grid 64 ¦ --grid serves the ball balancer ¦ a study of kind block_on_spring ¦ --samples SAMPLES
block.yaml --speeds 1:2:3 ¦ --speeds serves the ball balancer
block.yaml --ball-damping 1 ¦ --ball-damping serves the ball balancer
a.yaml --threads 0 ¦ found "0" ¦ a whole number from 1
missing.yaml ¦ missing.yaml"#,
    );
}

#[test]
fn systems_without_equilibrium_sets_are_refused() {
    let scratch = Scratch::new();
    let study = format!("equilibria {}", shipped("woodpecker.yaml").display());
    let parts = ["does not examine such a system", "a system with contacts that open"];
    scratch.refused(&study, &[&parts[..], &["`stickslip run`"]].concat());
    assert!(scratch.names(".").is_empty(), "nothing is written");
}

/// With contact, positions at which balls overlap are outside the set, and the touching positions are counted on their own.
#[test]
fn a_study_with_contact_has_its_own_sets() {
    let scratch =
        Scratch::with(study("model: {kind: ball_balancer, contact: {restitution: 0.5}}\n"));
    scratch.prints("equilibria a.yaml --grid 128 --out out", &["fraction  touching  components"]);
    let sets = scratch.table("out", "equilibrium_set_summary");
    let table = scratch.table("out", "equilibrium_positions");
    let [first, second, margin] =
        ["beta_1_rad", "beta_2_rad", "friction_margin"].map(|name| numbers(&table, name));
    let inside = column(&table, "in_set").as_boolean();
    let mut possible = 0;
    for row in 0..table.num_rows() {
        let apart = (first[row].unwrap() - second[row].unwrap()).abs();
        let overlap = apart.min(std::f64::consts::TAU - apart) < 0.2616;
        assert_eq!(margin[row].is_none(), overlap, "{apart}");
        assert!(!(overlap && inside.value(row)), "{apart}");
        possible += u64::from(!overlap);
    }
    assert_eq!(table.num_rows(), 128 * 128);
    assert_eq!(counts(&sets, "grid_positions"), [possible]);
    let touching = numbers(&sets, "touching_fraction")[0].unwrap();
    assert!(touching > 0.0 && touching <= 1.0, "{touching}");
}

/// A block on a spring, whose friction differs from point to point.
#[test]
fn a_system_without_balls_has_positions_sets_and_states() {
    let scratch = Scratch::with(study(
        "model: {kind: block_on_belt, parameters: {belt_speed_m_s: 0.2}}\nsweep: [{grid: {friction_coefficient: [0, 0.1]}}]\n",
    ));
    scratch.write("held.yaml", study("model: {kind: block_on_spring}\n"));
    scratch.prints(
        "equilibria a.yaml --samples 1024 --out slides",
        &["steady sliding", "marginal at position_m 0.01"],
    );
    let sets = scratch.table("slides", "equilibrium_set_summary");
    assert_eq!(
        (counts(&sets, "examined_positions"), numbers(&sets, "fraction")),
        (vec![1024; 2], vec![None; 2])
    );
    assert_eq!(
        scratch.table("slides", "equilibrium_positions").num_rows(),
        0,
        "all contacts slide"
    );
    let states = scratch.table("slides", "steady_states");
    let kinds: Vec<_> = words(&states, "kind").into_iter().flatten().collect();
    assert_eq!(kinds, ["sliding", "without_dry_friction", "sliding", "without_dry_friction"]);
    let close = |found: Vec<Option<f64>>, expected: [f64; 4]| {
        let near = |(found, expected): (&Option<f64>, f64)| {
            found.is_some_and(|found| (found - expected).abs() < 1e-9)
        };
        found.iter().zip(expected).all(near)
    };
    assert!(close(numbers(&states, "position_m"), [0.0, 0.0, 0.01, 0.0]), "{states:?}");
    assert!(close(numbers(&states, "eigenvalue_1_imag_rad_s"), [10.0; 4]), "{states:?}");

    scratch.well("equilibria held.yaml --samples 1024 --no-set --out held");
    let sets = scratch.table("held", "equilibrium_set_summary");
    let fraction = numbers(&sets, "fraction")[0].expect("the block sticks");
    assert!((fraction - 0.1).abs() < 0.01, "{sets:?}");
    let names = ["equilibrium_set_summary.parquet", "files.json", "steady_states.parquet"];
    assert_eq!(scratch.names("held"), names.map(String::from).into_iter().collect());
}
