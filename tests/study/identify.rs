//! The key `identify`, and tables of measured runs.

use std::path::{Path, PathBuf};

use stickslip::study::{MeasuredRun, PriorSpacing, Study};

use super::{parse, says, study};
use crate::support::{assert_has, cases, rows};

const STUDY: &str = "\
schema: 1
name: good
seed: 5
model:
  kind: ball_balancer
sweep:
  - grid: {speed_rad_s: [-160.8103, -200]}
uncertain:
  imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}
initial_conditions:
  design: {monte_carlo: {samples: 4}}
identify:
  parameters:
    friction_coefficient: {from: 1.0e-3, to: 6.0e-3, spacing: logarithmic}
    ring_radius: {from: 11 mm, to: 12 mm}
";

/// Parameters become the variables of the inference's designs, with units, and the runs stay those of the study.
#[test]
fn parameters_and_effort() {
    let study = study(STUDY);
    let (designs, identification) = study.for_identification().expect("identify");
    let names: Vec<&str> = designs.variables().iter().map(|variable| variable.name()).collect();
    assert_eq!(names, ["friction_coefficient", "ring_radius_m"]);
    assert_eq!(identification.parameters[1].range(), Some([0.011, 0.012]));
    assert_eq!(identification.spacings, [PriorSpacing::Logarithmic, PriorSpacing::Linear]);
    assert_eq!((identification.start_designs, identification.designs), (1000, 1250));
    assert_eq!(identification.posterior_samples, 4000);
    let without = parse(STUDY.split("identify:").next().expect("a study")).expect("a study");
    assert_eq!(without.hash(), designs.hash());
    assert!(without.for_identification().is_none());
    let again = parse(&study.resolved_yaml()).expect("the resolved study");
    assert_eq!(again.for_identification().expect("identify").1, identification);
}

/// Places in the unit cube and values belong to each other, on both scales.
#[test]
fn places_and_values() {
    let (_, identification) = study(STUDY).for_identification().expect("identify");
    let values = identification.values_at(&[0.5, 0.25]);
    assert!((values[0] - 6e-6_f64.sqrt()).abs() < 1e-12, "{values:?}");
    assert!((values[1] - 0.01125).abs() < 1e-12, "{values:?}");
    let place = identification.place_of(&values);
    assert!((place[0] - 0.5).abs() < 1e-12 && (place[1] - 0.25).abs() < 1e-12, "{place:?}");
}

#[test]
fn wrong_keys() {
    for [old, new, key, found, allowed] in cases(
        r"from: 1.0e-3, to ¦ from: 7.0e-3, to ¦ identify.parameters.friction_coefficient ¦ from 0.007 to 0.006 ¦ `from` below
from: 1.0e-3, to ¦ from: 0, to ¦ identify.parameters.friction_coefficient.from ¦ from 0 ¦ spacing: linear
ring_radius: {from: 11 mm, to: 12 mm} ¦ ring_size: {from: 0.011, to: 0.012} ¦ identify.parameters.ring_size ¦ ring_size ¦ ring_radius
ring_radius: {from: 11 mm, to: 12 mm} ¦ balls: {from: 1, to: 2} ¦ identify.parameters.balls ¦ balls ¦ a numeric parameter
ring_radius: {from: 11 mm, to: 12 mm} ¦ speed_rad_s: {from: -200, to: -100} ¦ identify.parameters.speed_rad_s ¦ in `sweep` ¦
ring_radius: {from: 11 mm, to: 12 mm} ¦ imbalance_mass_kg: {from: 1e-5, to: 1e-4} ¦ identify.parameters.imbalance_mass_kg ¦ in `uncertain` ¦
identify:\n ¦ identify:\n  designs: 4\n ¦ identify.designs ¦ 4 ¦ from 8 to 4000
identify:\n ¦ identify:\n  designs: 20\n  start_designs: 30\n ¦ identify.start_designs ¦ 30 of 20 ¦ at most
identify:\n ¦ identify:\n  samples: 20\n ¦ identify.samples ¦ samples ¦ posterior_samples",
    ) {
        assert!(STUDY.contains(&old), "{old}");
        let error = parse(&STUDY.replacen(&old, &new, 1)).expect_err(&new);
        assert_eq!(error.key(), key, "{error}");
        says(&error, &found, &allowed);
    }
}

/// Writes a table, and reads it as measured runs.
fn measured(study: &str, table: &str) -> Result<Vec<MeasuredRun>, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path: PathBuf = folder.path().join("rests.csv");
    std::fs::write(&path, table).expect("written");
    let study = Study::parse(Path::new("a.yaml"), study.to_owned()).expect("a study");
    study.measured(&path).map_err(|error| error.to_string())
}

/// Rows select points by the swept columns; rows without angles are runs that move.
#[test]
fn measured_runs() {
    let table = "speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-200,1.5,7,0.1\n-160.81,,,0.02\n";
    let runs = measured(STUDY, table).expect("measured runs");
    let expected = [
        MeasuredRun { point_id: 1, stage: None, rest: Some(vec![1.5, 7.0]), std_dev_rad: 0.1 },
        MeasuredRun { point_id: 0, stage: None, rest: None, std_dev_rad: 0.02 },
    ];
    assert_eq!(runs, expected);
}

#[test]
fn wrong_measured_runs() {
    let head = "speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n";
    for row in rows(
        r"speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-170,1,2,0.1\n ¦ rests.csv:2:1 ¦ no point of the sweep ¦ speed_rad_s -170
speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-200,1,,0.1\n ¦ row 1 ¦ angles of some balls only ¦ 1 of 2 angles
speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-200,1,2,0\n ¦ row 1, column std_dev_rad ¦ not an accuracy ¦ such as 0.1
speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-200,1,2,\n ¦ not an accuracy ¦ nothing
speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n-200,x,2,0.1\n ¦ column beta_1_rad ¦ not a number ¦ balls that move
speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n ¦ a table without rows
beta_1_rad,beta_2_rad,std_dev_rad\n1,2,0.1\n ¦ several points of the sweep
speed_rad_s,beta_1_rad,std_dev_rad\n-200,1,0.1\n ¦ no column beta_2_rad
stage,speed_rad_s,beta_1_rad,beta_2_rad,std_dev_rad\n1,-200,1,2,0.1\n ¦ unknown column ¦ stage",
    ) {
        assert_has(&measured(STUDY, &row[0]).expect_err(&row[0]), &row[1..]);
    }
    let staged = STUDY.replace("sweep:", "  protocol: startup\nsweep:");
    let table = format!("stage,{head}0,-200,1,2,0.1\n");
    let error = measured(&staged, &table).expect_err("stage 0");
    assert_has(&error, &["not a stage", "stages.parquet"]);
}

/// The balls of a rotor, which may touch, are bodies with angles; the positions of blocks are no angles.
#[test]
fn bodies_with_angles() {
    let of_kind = |model: &str, swept: &str| {
        format!(
            "schema: 1\nname: a\nseed: 1\nmodel: {model}\nsweep: [{{grid: {{{swept}}}}}]\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n"
        )
    };
    let touching = "{kind: rotor_balancer, parameters: {number_of_balls: 3, number_of_pairs: 3}}";
    let rotor = of_kind(touching, "speed_rad_s: [400, 500]");
    let table = "speed_rad_s,beta_1_rad,beta_2_rad,beta_3_rad,std_dev_rad\n500,1,2,3,0.1\n";
    let rest = Some(vec![1.0, 2.0, 3.0]);
    let expected = MeasuredRun { point_id: 1, stage: None, rest, std_dev_rad: 0.1 };
    assert_eq!(measured(&rotor, table).expect("measured runs"), [expected]);
    assert_eq!(study(&rotor).model().angle_contacts(), [0, 1, 2]);
    let block = of_kind("{kind: block_on_belt}", "friction_coefficient: [0.1]");
    assert!(study(&block).model().angle_contacts().is_empty());
}
