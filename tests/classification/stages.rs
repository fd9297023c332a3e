//! Runs with stages: a disc that starts, and a table that is kicked.

use std::f64::consts::TAU;

use stickslip::classification::{Instants, Label, Outcome, simulate};
use stickslip::model::{
    Balancer, Ball, BallContact, Case, Kick, Machine, Model, ProfilePart, Ramp, RampShape,
    Simulation, SpeedProfile, Start,
};

use super::recorder::recorded;

fn started(machine: &Machine, over_s: f64, kicks: Vec<Kick>) -> Machine {
    let ramp = Ramp { shape: RampShape::Linear, to_rad_s: None, over_s };
    let profile = SpeedProfile { start_speed_rad_s: -10.0, parts: vec![ProfilePart::Ramp(ramp)] };
    Machine { speed_profile: Some(profile), kicks, ..machine.clone() }
}

fn case(machine: &Machine, beta: [f64; 2], end_time_s: f64) -> Case {
    let start = Start::of_balancer([0.0; 2], &beta, [0.0; 2], &[0.0; 2]);
    let simulation = Simulation { end_time_s, ..Simulation::default() };
    Case { model: Model::from(machine.clone()), start, simulation }
}

fn with_contact(speed_rad_s: f64) -> Machine {
    let contact = Some(BallContact { restitution: 0.5, friction_coefficient: 0.0 });
    Machine { speed_rad_s, contact, ..Machine::default() }
}

/// From the thesis's machine at rest, plain ramps to -173.2 rad/s end at rest in touch, and those to -216.3772 rad/s in
/// the cycle of the touching pair (Moreau's time stepping).
#[test]
fn a_machine_that_starts_ends_like_the_time_stepping() {
    let (mut in_touch, mut pairs, mut number) = (0, 0, 0);
    for over_s in [0.5, 2.0, 6.0] {
        for beta in [[0.5, 3.0], [2.0, 5.5]] {
            number += 1;
            let ended = |speed_rad_s: f64| {
                let machine = started(&with_contact(speed_rad_s), over_s, vec![]);
                simulate(&case(&machine, beta, over_s + 15.0))
            };
            let rests = ended(-173.2);
            assert_eq!(rests.label(), Label::Equilibrium, "{over_s} {beta:?}");
            in_touch += i32::from(rests.touching.expect("contact").at_end);
            assert!(rests.stages.len() == 2 && rests.stages[1].is_at_rest == Some(true));
            let since = rests.evidence.rest().and_then(|rest| rest.since_s).expect("rests");
            assert_eq!(rests.time_to_rest_s(), Some((since - over_s).max(0.0)));
            let runs = ended(-216.3772);
            let is_pair = |speed: &f64| (speed.abs() - 41.46).abs() < 0.05;
            let touches = runs.touching.expect("contact").at_end;
            let speeds = runs.mean_speed.expect("speeds");
            pairs += i32::from(touches && speeds.iter().all(is_pair));
        }
    }
    assert!(pairs == number && 3 * in_touch >= 2 * number, "{pairs} {in_touch} {number}");
}

/// A table with a row in every instant of a ramp gives the motion of the ramp. The cost is proportional to the rows: with their
/// square, this test takes a minute.
#[test]
fn a_table_of_many_rows() {
    let ball = Ball { friction_coefficient: 0.1, ..Ball::default() };
    let machine = Machine { balls: vec![ball; 2], ..Machine::default() };
    let (last, rows) = (machine.speed_rad_s, 30_000);
    let row = |row: i32| {
        let share = f64::from(row) / f64::from(rows);
        [2.0 * share, if row == rows { last } else { -10.0 + share * (last + 10.0) }]
    };
    let table = ProfilePart::Table((0..=rows).map(row).collect());
    let profile = SpeedProfile { start_speed_rad_s: -10.0, parts: vec![table] };
    let tabled = Machine { speed_profile: Some(profile), ..machine.clone() };
    let ended = |machine: &Machine| simulate(&case(machine, [1.0, 4.0], 2.5));
    let (found, expected) = (ended(&tabled), ended(&started(&machine, 2.0, vec![])));
    assert_eq!((found.stages.len(), expected.stages.len()), (30_001, 2));
    assert_eq!(found.label(), expected.label());
    let [found, expected] = [found, expected].map(|outcome| outcome.peak.expect("stages"));
    assert!(
        (found.amplitude_m / expected.amplitude_m - 1.0).abs() < 1e-6,
        "{found:?} {expected:?}"
    );
}

/// A kick changes the velocities as the closed form says, and sticking balls with enough friction stick.
#[test]
fn a_kick_is_an_impulse() {
    let ball = |friction_coefficient| Ball { friction_coefficient, ..Ball::default() };
    let machine = Machine { balls: vec![ball(0.1), ball(0.1)], ..Machine::default() };
    let natural = machine.natural_frequency_rad_s();
    let balancer = Balancer::<2>::new(&machine).expect("two balls");
    let at_s = 2.0;
    // The ball at the angle of the blow is pressed to the ring if the table moves away from it.
    let blow = 1.0 + machine.speed_rad_s * at_s;
    let kicked = |direction_rad: f64, beta: [f64; 2]| -> Outcome {
        let kick = Kick { at_s, speed_m_s: 0.05, direction_rad };
        simulate(&case(&Machine { kicks: vec![kick], ..machine.clone() }, beta, 2.0 + 1e-12))
    };
    for beta in [[1.0, 1.0 + 0.5 * TAU], [1.05, 2.6]] {
        let outcome = kicked(blow, beta);
        let [before, after] = [&outcome.stages[0], &outcome.stages[1]];
        let speed = 0.05 / (natural * machine.ring_radius_m);
        let mut lifted = 0;
        for i in 0..2 {
            let (s, c) = before.position[i].sin_cos();
            let (x, y) = (speed * 1_f64.cos(), speed * 1_f64.sin());
            let pressed = -c * x - s * y;
            lifted += u32::from(pressed < 0.0);
            let along = s * x - c * y;
            let friction = 0.1 * pressed.max(0.0);
            let slips = along.signum() * (along.abs() - friction).max(0.0);
            let expected = balancer.balls[i].mobility * slips * natural;
            let found = after.ball_speed_rad_s[i] - before.ball_speed_rad_s[i];
            assert!(
                (found - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                "{i} {found} {expected}"
            );
        }
        assert!(after.is_kicked && !before.is_kicked && after.lifted_off == lifted);
    }
}

/// The largest amplitude of a run is the largest of its stages, and that of a recorded motion.
#[test]
fn the_peak_is_the_largest_amplitude() {
    let machine = started(
        &Machine::default(),
        0.8,
        vec![Kick { at_s: 2.5, speed_m_s: 0.3, direction_rad: 0.0 }],
    );
    let case = case(&machine, [1.0, 4.0], 4.0);
    let (outcome, recording) = recorded(&case, Instants::EveryStep { inside: 20 });
    let natural = machine.natural_frequency_rad_s();
    let amplitude = |table: [f64; 4]| table[0].hypot(table[1]) * machine.ring_radius_m;
    let samples = recording.samples;
    for stage in &outcome.stages {
        let within = samples.iter().filter(|sample| {
            (stage.time_s[0]..=stage.time_s[1]).contains(&(sample.time / natural))
        });
        let largest =
            within.map(|sample| amplitude(sample.table.expect("a table"))).fold(0.0, f64::max);
        let found = stage.peak.amplitude_m;
        assert!(found >= largest * (1.0 - 1e-9) && found < largest * 1.01, "{found:e} {largest:e}");
        assert!((stage.time_s[0]..=stage.time_s[1]).contains(&stage.peak.time_s));
    }
    let largest = outcome.stages.iter().map(|stage| stage.peak.amplitude_m).fold(0.0, f64::max);
    assert_eq!(outcome.peak.expect("a peak").amplitude_m, largest);
}
