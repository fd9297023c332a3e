//! Invalid values in a study: line, key, finding and remedy of each.

use super::parse;
use crate::support::cases;

/// A valid study, one value per line.
const GOOD: &str = "\
schema: 1
name: good
seed: 5
model:
  kind: ball_balancer
  parameters:
    table_mass_kg: 0.3
    stiffness_n_m: 1.0e4
    ring_radius_m: 0.0115
    balls: 2
    ball_mass_kg: 1.0e-4
    friction_coefficient: 2.75e-3
    speed_rad_s: -200
  friction: coulomb
  normal_force: lagrange
sweep:
  - grid:
      speed_rad_s: [-160, -200]
  - zip:
      speed_rad_s: [-160, -200]
      damping_n_s_m: [1.0, 2.0]
uncertain:
  imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}}
initial_conditions:
  box:
    x: [-0.05, 0.05]
  design:
    stratified: {parts_per_axis: 2, samples_per_cell: 3}
simulation:
  method: switch
  band: 1.0e-4
  end_time_s: 16.5
  tolerance: {relative: 1.0e-8, absolute: 1.0e-10}
expect:
  - point: {speed_rad_s: -160}
    equilibrium_fraction: [0.5, 1.0]
";

/// What is replaced, by what, the line of the message, its key, what it found, and what it allows.
const WRONG: &str = r#"# Unknown keys come with the nearest.
seed: 5 ¦ sed: 5 ¦ 3 ¦ sed ¦ sed ¦ seed (did you mean this?)
  kind: ¦   kindd: ¦ 5 ¦ model.kindd ¦ kindd ¦ kind (did you mean this?)
  band ¦   bnd ¦ 31 ¦ simulation.bnd ¦ bnd ¦ band (did you mean this?)
  box ¦   bx ¦ 25 ¦ initial_conditions.bx ¦ bx ¦ box (did you mean this?), design
    x: ¦     xdot: ¦ 26 ¦ initial_conditions.box.xdot ¦ xdot ¦ x_dot (did you mean this?)
speed_rad_s: [ ¦ speed_rads: [ ¦ 18 ¦ sweep[0].grid.speed_rads ¦ speed_rads ¦ speed_rad_s (did you mean this?)
imbalance_mass_kg ¦ imbalance_mas_kg ¦ 23 ¦ uncertain.imbalance_mas_kg ¦ mas_kg ¦ imbalance_mass_kg (did you
    stratified ¦     stratfied ¦ 28 ¦ initial_conditions.design ¦ stratfied ¦ stratified (did you mean this?)
parts_per_axis ¦ parts ¦ 28 ¦ initial_conditions.design.stratified.parts ¦ parts ¦ parts_per_axis (did you mean this?)
max: ¦ maxi: ¦ 23 ¦ uncertain.imbalance_mass_kg.uniform.maxi ¦ maxi ¦ max (did you mean this?)
equilibrium_f ¦ equilibriumf ¦ 36 ¦ expect[0].equilibriumfraction ¦  ¦ equilibrium_f
# A range too wide for a number is not called reversed.
{min: 5.0e-5, max: 6.0e-5} ¦ {min: -1e308, max: 1e308} ¦ 23 ¦ uncertain.imbalance_mass_kg.uniform.max ¦ min -1e308, max 1e308 ¦ max - min of at most 1.79e308
{min: 5.0e-5, max: 6.0e-5} ¦ {min: 6.0e-5, max: 5.0e-5} ¦ 23 ¦ uncertain.imbalance_mass_kg.uniform.max ¦ 5e-5 ¦ above min, which is 6e-5
# What is not in this version is an unknown choice.
ball_balancer ¦ pendulum ¦ 5 ¦ model.kind ¦ pendulum ¦ ball_balancer
coulomb ¦ {lugre: {a: 1}} ¦ 14 ¦ model.friction ¦ lugre ¦ coulomb
switch ¦ newmark ¦ 30 ¦ simulation.method ¦ newmark ¦ switch
: lagrange ¦ : euler ¦ 15 ¦ model.normal_force ¦ euler ¦ lagrange, newton
schema: 1 ¦ schema: 2 ¦ 1 ¦ schema ¦ 2 ¦ 1, the version
# Wrong types.
seed: 5 ¦ seed: five ¦ 3 ¦ seed ¦ text "five" ¦ a whole number
seed: 5 ¦ seed: -5 ¦ 3 ¦ seed ¦ -5 ¦ a whole number
seed: 5 ¦ seed: 1.5 ¦ 3 ¦ seed ¦ 1.5 ¦ a whole number
seed: 5 ¦ seed: 1.0 ¦ 3 ¦ seed ¦ 1.0 ¦ a whole number
name: good ¦ name: 12 ¦ 2 ¦ name ¦ 12 ¦ quote it
name: good ¦ name: ../up ¦ 2 ¦ name ¦ ../up ¦ letters, digits
0.3\n ¦ heavy\n ¦ 7 ¦ model.parameters.table_mass_kg ¦ text "heavy" ¦ a number
0.3\n ¦ "0.3"\n ¦ 7 ¦ model.parameters.table_mass_kg ¦ text "0.3" ¦ a number
0.3\n ¦ [1]\n ¦ 7 ¦ model.parameters.table_mass_kg ¦ a list ¦ a number
0.3\n ¦ \n ¦ 7 ¦ model.parameters.table_mass_kg ¦ nothing ¦ a number
0.3\n ¦ true\n ¦ 7 ¦ model.parameters.table_mass_kg ¦ true ¦ a number
balls: 2 ¦ balls: 2.5 ¦ 10 ¦ model.parameters.balls ¦ 2.5 ¦ from 1 to 8
[-160, -200] ¦ -160 ¦ 18 ¦ sweep[0].grid.speed_rad_s ¦ -160 ¦ a list
[-160, -200] ¦ [-160, a] ¦ 18 ¦ sweep[0].grid.speed_rad_s[1] ¦ "a" ¦ a number
stratified: {parts_per_axis: 2, samples_per_cell: 3} ¦ sobol ¦ 28 ¦ initial_conditions.design ¦ sobol ¦ {sobol: ...}
coulomb ¦ stribeck ¦ 14 ¦ model.friction ¦ stribeck ¦ static_friction_coefficient: ..., stribeck_speed_rad_s: ...
coulomb ¦ stribeck ¦ 14 ¦ model.friction ¦ stribeck ¦ such as {stribeck: {static_friction_coefficient: 0.2
stratified: {parts_per_axis: 2, samples_per_cell: 3} ¦ sobol: 5 ¦ 28 ¦ initial_conditions.design.sobol ¦ 5 ¦
# Boxes.
[-0.05, 0.05] ¦ [0.05, -0.05] ¦ 26 ¦ initial_conditions.box.x ¦ [0.05, -0.05] ¦ low not above high
[-0.05, 0.05] ¦ [0.05] ¦ 26 ¦ initial_conditions.box.x ¦ a list of 1 ¦ [low, high]
[-0.05, 0.05] ¦ [0, 1, 2] ¦ 26 ¦ initial_conditions.box.x ¦ a list of 3 ¦ [low, high]
[-0.05, 0.05] ¦ 0.05 ¦ 26 ¦ initial_conditions.box.x ¦ 0.05 ¦ [low, high]
    x: ¦     beta_3: ¦ 26 ¦ initial_conditions.box.beta_3 ¦ beta_3 ¦ beta_2 (did
# Counts; each block of the last study is within the limit, both together are not.
cell: 3 ¦ cell: 0 ¦ 28 ¦ initial_conditions.design.stratified.samples_per_cell ¦ 0 ¦ a whole number from 1 to 1e15
cell: 3 ¦ cell: -3 ¦ 28 ¦ initial_conditions.design.stratified.samples_per_cell ¦ -3 ¦ a whole number from 1 to 1e15
cell: 3 ¦ cell: 1.5 ¦ 28 ¦ initial_conditions.design.stratified.samples_per_cell ¦ 1.5 ¦ a whole number from 1 to 1e15
cell: 3 ¦ cell: 1e24 ¦ 28 ¦ initial_conditions.design.stratified.samples_per_cell ¦ 1e24 ¦ a whole number from 1 to 1e15
cell: 3 ¦ cell: 1000000000000000000000000 ¦ 28 ¦ initial_conditions.design.stratified.samples_per_cell ¦ 1e24 ¦ from 1 to 1e15
parts_per_axis: 2, samples_per_cell: 3 ¦ parts_per_axis: 1000, samples_per_cell: 1 ¦ 28 ¦ initial_conditions.design ¦ 2e24 runs (points: 2, samples at each: 1e24) ¦ at most 1e15
stratified: {parts_per_axis: 2, samples_per_cell: 3} ¦ sobol: {samples: 65537} ¦ 28 ¦ initial_conditions.design.sobol.samples ¦ 65537 ¦ from 1 to 65536
parts_per_axis: 2, samples_per_cell: 3 ¦ parts_per_axis: 1, samples_per_cell: 4e14 ¦ 28 ¦ initial_conditions.design ¦ 1.6e15 runs ¦ at most 1e15
# Expectations.
[0.5, 1.0] ¦ [1.0, 0.5] ¦ 36 ¦ expect[0].equilibrium_fraction ¦ [1, 0.5] ¦ low <= high
[0.5, 1.0] ¦ [0.5, 1.5] ¦ 36 ¦ expect[0].equilibrium_fraction ¦ [0.5, 1.5] ¦ <= 1
    equilibrium_fraction: [0.5, 1.0]\n ¦  ¦ 35 ¦ expect[0] ¦ no range ¦ at least one
{speed_rad_s: -160} ¦ {speed_rad_s: -161} ¦ 35 ¦ expect[0].point ¦ speed_rad_s -161 ¦ values
{speed_rad_s: -160} ¦ {ball_mass_kg: 1} ¦ 35 ¦ expect[0].point.ball_mass_kg ¦ ball_mass_kg ¦ speed_rad_s
# Uncertain parameters.
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ speed_rad_s: {normal: {mean: 1, std_dev: 1}} ¦ 23 ¦ uncertain.speed_rad_s ¦ in `sweep` ¦ either
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ normal_force: {normal: {mean: 1, std_dev: 1}} ¦ 23 ¦ uncertain.normal_force ¦  ¦ numeric parameter
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ balls: {normal: {mean: 1, std_dev: 1}} ¦ 23 ¦ uncertain.balls ¦ balls ¦ ball_mass_kg
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {gamma: {mean: 1}} ¦ 23 ¦ uncertain.ball_mass_kg ¦ gamma ¦ normal
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {normal: {mean: 1, std_dev: 0}} ¦ 23 ¦ uncertain.ball_mass_kg.normal.std_dev ¦ 0 ¦ a positive
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {lognormal: {mean: -1, std_dev: 1}} ¦ 23 ¦ uncertain.ball_mass_kg.lognormal.mean ¦ -1 ¦ a positive
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {uniform: {min: 2, max: 1}} ¦ 23 ¦ uncertain.ball_mass_kg.uniform.max ¦ 1 ¦ above min, which is 2
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {uniform: {min: -1, max: 1}} ¦ 23 ¦ uncertain.ball_mass_kg.uniform.min ¦ -1 ¦ a positive
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {triangular: {min: 1, mode: 4, max: 3}} ¦ 23 ¦ uncertain.ball_mass_kg.triangular.mode ¦ 4 ¦ from min to max
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {truncated_normal: {mean: 1, std_dev: 0.1, min: 3, max: 4}} ¦ 23 ¦ uncertain.ball_mass_kg.truncated_normal.max ¦ 4 ¦ 1e-12
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {choice: {values: []}} ¦ 23 ¦ uncertain.ball_mass_kg.choice.values ¦ an empty list ¦ values
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {choice: {values: [1, 0]}} ¦ 23 ¦ uncertain.ball_mass_kg.choice.values ¦ 0 ¦ a positive
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {choice: {values: [1, 2], weights: [1]}} ¦ 23 ¦ uncertain.ball_mass_kg.choice.weights ¦ 1 weights for 2 values ¦ one weight per value
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {choice: {values: [1, 2], weights: [1, -1]}} ¦ 23 ¦ uncertain.ball_mass_kg.choice.weights ¦ -1 ¦ zero or more
imbalance_mass_kg: {uniform: {min: 5.0e-5, max: 6.0e-5}} ¦ ball_mass_kg: {choice: {values: [1, 2], weights: [0, 0]}} ¦ 23 ¦ uncertain.ball_mass_kg.choice.weights ¦ 0 ¦ positive
# Numbers that are not finite.
-200] ¦ .inf] ¦ 18 ¦ sweep[0].grid.speed_rad_s[1] ¦ .inf ¦ a finite number
[-0.05 ¦ [-.inf ¦ 26 ¦ initial_conditions.box.x[0] ¦ -.inf ¦ a finite number
16.5 ¦ .nan ¦ 32 ¦ simulation.end_time_s ¦ .nan ¦ a finite number
0.3\n ¦ .NaN\n ¦ 7 ¦ model.parameters.table_mass_kg ¦  ¦ a finite number
0.3\n ¦ -1e999\n ¦ 7 ¦ model.parameters.table_mass_kg ¦  ¦ a finite number
max: 6.0e-5 ¦ max: 1e400 ¦ 23 ¦ uncertain.imbalance_mass_kg.uniform.max ¦ inf ¦ finite
# Sweeps.
[1.0, 2.0] ¦ [1.0, 2.0, 3.0] ¦ 21 ¦ sweep[1].zip.damping_n_s_m ¦ speed_rad_s 2, damping_n_s_m 3 ¦ equally many values
sweep:\n  - grid:\n      speed_rad_s: [-160, -200]\n  - zip:\n      speed_rad_s: [-160, -200]\n      damping_n_s_m: [1.0, 2.0]\n ¦ sweep: []\n ¦ 16 ¦ sweep ¦ an empty list ¦ no `sweep`
[1.0, 2.0] ¦ [] ¦ 21 ¦ sweep[1].zip.damping_n_s_m ¦ an empty list ¦ at least one value
      damping_n_s_m: [1.0, 2.0]\n ¦       balls: [1, 9]\n ¦ 21 ¦ sweep[1].zip.balls[1] ¦ 9 ¦ a whole number from 1 to 8
      damping_n_s_m: [1.0, 2.0]\n ¦       colour: [1, 2]\n ¦ 21 ¦ sweep[1].zip.colour ¦ colour ¦ normal_force
      damping_n_s_m: [1.0, 2.0]\n ¦       ball_mass_3_kg: [1, 2]\n ¦ 21 ¦ sweep[1].zip.ball_mass_3_kg ¦  ¦ ball_mass_
      damping_n_s_m: [1.0, 2.0]\n ¦       normal_force: [newton, neuton]\n ¦ 21 ¦ sweep[1].zip.normal_force[1] ¦ neuton ¦ newton (did you mean
      speed_rad_s: [-160, -200]\n  - zip: ¦       {}\n  - zip: ¦ 18 ¦ sweep[0].grid ¦ no parameter ¦ at least one
      speed_rad_s: [-160, -200]\n  - zip: ¦       speed_rad_s: [1]\n    zip: {speed_rad_s: [1]}\n  - zip: ¦ 17 ¦ sweep[0] ¦ grid, zip ¦ exactly one of grid, zip, table
# Extensions.
16.5 ¦ 16.5\n  extend: {factor: 1} ¦ 33 ¦ simulation.extend.factor ¦ 1 ¦ above 1 and at most 1000
16.5 ¦ 16.5\n  extend: {factor: -2} ¦ 33 ¦ simulation.extend.factor ¦ -2 ¦ above 1 and at most 1000
16.5 ¦ 16.5\n  extend: {factor: 1000.5} ¦ 33 ¦ simulation.extend.factor ¦ 1000.5 ¦ above 1 and at most 1000
16.5 ¦ 16.5\n  extend: {factor: .nan} ¦ 33 ¦ simulation.extend.factor ¦ .nan ¦ a finite number
16.5 ¦ 16.5\n  extend: {factor: two} ¦ 33 ¦ simulation.extend.factor ¦ text "two" ¦ a number
16.5 ¦ 16.5\n  extend: {labels: [undecided]} ¦ 33 ¦ simulation.extend.factor ¦ no such key ¦ a value for `factor`
16.5 ¦ 16.5\n  extend: {factor: 2, label: [undecided]} ¦ 33 ¦ simulation.extend.label ¦ label ¦ labels (did
16.5 ¦ 16.5\n  extend: {factor: 2, labels: []} ¦ 33 ¦ simulation.extend ¦ keys factor, labels ¦
16.5 ¦ 16.5\n  extend: {factor: 2, labels: undecided} ¦ 33 ¦ simulation.extend.labels ¦ undecided ¦ a list
16.5 ¦ 16.5\n  extend: {factor: 2, labels: [equilibrium]} ¦ 33 ¦ simulation.extend.labels[0] ¦ equilibrium ¦ irregular
16.5 ¦ 16.5\n  extend: {factor: 2, labels: [undecide]} ¦ 33 ¦ simulation.extend.labels[0] ¦ undecide ¦ irregular
16.5 ¦ 16.5\n  extend: {factor: 2, labels: [irregular, irregular]} ¦ 33 ¦ simulation.extend ¦ keys factor, labels ¦
16.5 ¦ 1e307\n  extend: {factor: 100} ¦ 33 ¦ simulation.extend.factor ¦ 100 ¦ a larger, finite number
# Missing keys.
schema: 1\n ¦  ¦ 1 ¦ schema ¦ no such key ¦ schema
seed: 5\n ¦  ¦ 1 ¦ seed ¦ no such key ¦ seed
  kind: ball_balancer\n ¦  ¦ 5 ¦ model.kind ¦ no such key ¦ kind
, max: 6.0e-5 ¦  ¦ 23 ¦ uncertain.imbalance_mass_kg.uniform.max ¦  ¦ max
  design:\n    stratified: {parts_per_axis: 2, samples_per_cell: 3}\n ¦  ¦ 25 ¦ initial_conditions.design ¦ no such key ¦ stratified, latin_hypercube
# Values without physical meaning.
table_mass_kg: 0.3 ¦ table_mass_kg: 0 ¦ 7 ¦ model.parameters.table_mass_kg ¦  ¦ a positive, finite number
stiffness_n_m: 1.0e4 ¦ stiffness_n_m: -0.0 ¦ 8 ¦ model.parameters.stiffness_n_m ¦  ¦ a positive, finite number
ring_radius_m: 0.0115 ¦ ring_radius_m: -1 ¦ 9 ¦ model.parameters.ring_radius_m ¦  ¦ a positive, finite number
ball_mass_kg: 1.0e-4 ¦ ball_mass_kg: 0 ¦ 11 ¦ model.parameters.ball_mass_kg ¦  ¦ a positive, finite number
band: 1.0e-4 ¦ band: 0 ¦ 31 ¦ simulation.band ¦ 0 ¦ above 0 and at most 0.01
end_time_s: 16.5 ¦ end_time_s: 0 ¦ 32 ¦ simulation.end_time_s ¦ 0 ¦ a number above 0
end_time_s: 16.5 ¦ end_time_s: -1 ¦ 32 ¦ simulation.end_time_s ¦ -1 ¦ a number above 0
relative: 1.0e-8 ¦ relative: 0 ¦ 33 ¦ simulation.tolerance.relative ¦ 0 ¦ a number above 0
absolute: 1.0e-10 ¦ absolute: -1 ¦ 33 ¦ simulation.tolerance.absolute ¦ -1 ¦ a number above 0
balls: 2 ¦ balls: 0 ¦ 10 ¦ model.parameters.balls ¦ 0 ¦ between 1 and 8
balls: 2 ¦ balls: 9 ¦ 10 ¦ model.parameters.balls ¦ 9 ¦ between 1 and 8
balls: 2 ¦ balls: 1000000000000 ¦ 10 ¦ model.parameters.balls ¦ 1000000000000 ¦ between 1 and 8
t: 2.75e-3 ¦ t: -1 ¦ 12 ¦ model.parameters.friction_coefficient ¦ -1 ¦ zero or more
band: 1.0e-4 ¦ band: 0.5 ¦ 31 ¦ simulation.band ¦ 0.5 ¦ at most 0.01
balls: 2 ¦ balls: [] ¦ 10 ¦ model.parameters.balls ¦ 0 ¦ between 1 and 8
balls: 2 ¦ balls: [{}, {mass_kg: 0}] ¦ 10 ¦ model.parameters.balls[1].mass_kg ¦ 0 ¦ a positive, finite number
[1.0, 2.0] ¦ [1.0, -2.0] ¦ 21 ¦ sweep[1].zip.damping_n_s_m[1] ¦ -2 ¦ zero or more"#;

/// Replaces one text by another and checks the message.
#[test]
fn wrong_values_are_refused() {
    for [old, new, line, key, found, allowed] in cases(WRONG) {
        assert!(GOOD.contains(&old), "{old}");
        let line = line.parse().expect("a line");
        super::refused(&GOOD.replacen(&old, &new, 1), line, &key, &found, &allowed);
    }
}

#[test]
fn the_good_study_is_good() {
    assert_eq!(parse(GOOD).expect("a valid study").run_count(), 4 * 768);
}

#[test]
fn missing_keys() {
    // All missing keys are in one message, at the place of the first.
    let two = GOOD.replace("schema: 1\nname: good\n", "").replace("  kind: ball_balancer\n", "");
    let error = parse(&two).unwrap_err();
    assert_eq!(
        (error.problem(), error.key(), error.line()),
        ("missing keys", "model.kind", Some(3))
    );
    assert_eq!(error.found(), Some("no `model.kind`, no `schema`, no `name`"));
    let allowed = "such as model: {kind: ball_balancer}; schema: 1; name: my-study";
    assert_eq!(error.allowed(), Some(allowed));
    let error = parse("schema: 1\n").unwrap_err();
    let found = "no `name`, no `seed`, no `model`, no `initial_conditions`";
    assert_eq!(error.found(), Some(found));
    let distribution = "{truncated_normal: {mean: 1}}";
    let text = GOOD.replace("{uniform: {min: 5.0e-5, max: 6.0e-5}}", distribution);
    let error = parse(&text).unwrap_err();
    let below = "uncertain.imbalance_mass_kg.truncated_normal";
    let found = format!("no `{below}.std_dev`, no `{below}.min`, no `{below}.max`");
    assert_eq!(error.found(), Some(found.as_str()));
}

/// A list of balls has no common value that a sweep could set.
#[test]
fn a_swept_value_of_all_balls_beside_their_own() {
    let listed = "balls: [{mass_kg: 1.0e-4}, {}]";
    let text = GOOD.replacen("balls: 2", listed, 1).replacen("damping_n_s_m", "ball_mass_kg", 1);
    super::refused(&text, 21, "sweep[1].zip.ball_mass_kg", "", "ball_mass_1_kg, ball_mass_2_kg");
}
