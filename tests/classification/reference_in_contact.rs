//! Runs with contact between balls, run by run, against an independent integration by time stepping
//! (`scripts/reference`, Moreau and Jean).

use std::f64::consts::TAU;

use stickslip::analysis::{Z_95, wilson};
use stickslip::classification::{Label, Outcome};
use stickslip::model::{BallContact, Case, Machine, Simulation, Start};

use super::reference::{Row, references, rows};
use super::simulate_all::simulate_all;
use crate::support::angular_distance;

/// A run of the independent program.
struct Recorded {
    rests: bool,
    touching: bool,
    end_beta: [f64; 2],
}

fn recorded(speed: &str, law: &str) -> Vec<Recorded> {
    let of = |row: Row| Recorded {
        rests: row.text("label") == "equilibrium",
        touching: !row.text("touching").is_empty(),
        end_beta: row.numbers(["beta_1_rad", "beta_2_rad"]),
    };
    rows(&format!("contact_{speed}_{law}")).map(of).collect()
}

/// Returns the start state with the second ball's distance ahead of the first scaled to the room that both leave.
fn apart(machine: &Machine, start: &Start) -> Start {
    let touching = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
    let mut apart = start.clone();
    let ahead = (start.0[3] - start.0[2]).rem_euclid(TAU);
    apart.0[3] = (start.0[2] + ahead * (1.0 - 2.0 * touching / TAU) + touching).rem_euclid(TAU);
    apart
}

fn computed(speed: &str, contact: BallContact) -> Vec<Outcome> {
    let speed_rad_s = -speed.parse::<f64>().expect("a speed");
    let machine = Machine { speed_rad_s, contact: Some(contact), ..Machine::default() };
    let case = |start: &Start| Case {
        model: machine.clone().into(),
        start: apart(&machine, start),
        simulation: Simulation::default(),
    };
    let starts = references(speed);
    simulate_all(&starts.iter().map(|run| case(&run.start)).collect::<Vec<_>>())
}

const LAWS: [(&str, BallContact); 2] = [
    ("e0.5_mu0", BallContact { restitution: 0.5, friction_coefficient: 0.0 }),
    ("e0.36_mu0.1", BallContact { restitution: 0.36, friction_coefficient: 0.1 }),
];

/// Below the natural frequency all runs come to rest, at angles that differ by less than 3e-3 rad in half of the runs and
/// by less than 3e-2 rad in 90 % of them.
#[test]
fn subcritical_runs_end_at_the_same_angles() {
    for (law, contact) in LAWS {
        for speed in ["160.8103", "173.1803"] {
            let (recorded, computed) = (recorded(speed, law), computed(speed, contact));
            let mut errors = Vec::new();
            let mut other_contact = 0;
            for (reference, outcome) in recorded.iter().zip(&computed) {
                assert!(reference.rests);
                assert_eq!(outcome.label(), Label::Equilibrium);
                let beta = outcome.position.as_deref().expect("angles");
                let error = |ball: usize| angular_distance(beta[ball], reference.end_beta[ball]);
                errors.push(error(0).max(error(1)));
                let touching = outcome.touching.expect("contact").at_end;
                other_contact += i32::from(touching != reference.touching);
            }
            errors.sort_by(f64::total_cmp);
            let at = |percent: usize| errors[(errors.len() * percent / 100).min(errors.len() - 1)];
            let ends = [50, 90, 100].map(at);
            println!("-{speed} {law}: {ends:?}, {other_contact} with another contact");
            assert!(ends[0] < 3e-3 && ends[1] < 3e-2, "-{speed} {law}: {ends:?}");
            assert!(other_contact <= 8, "-{speed} {law}: {other_contact}");
        }
    }
}

/// At -216.3772 rad/s the fraction of runs at rest is that of the reference, within its 95 % interval; the others end as
/// a pair that runs in touch.
#[test]
fn as_many_supercritical_runs_come_to_rest() {
    for (law, contact) in LAWS {
        let (recorded, computed) = (recorded("216.3772", law), computed("216.3772", contact));
        let expected = recorded.iter().filter(|run| run.rests).count() as u64;
        let found = computed.iter().filter(|run| run.label() == Label::Equilibrium).count() as f64;
        let all = recorded.len() as u64;
        let (low, high) = wilson(expected, all, Z_95);
        let cycles = computed.iter().filter(|run| run.evidence.name() == "closed_orbit").count();
        println!("{law}: {found} at rest, {expected} in the reference, {cycles} cycles");
        assert!((low..=high).contains(&(found / all as f64)), "{law}: {found}, not {expected}");
        let speed = |outcome: &&Outcome| {
            let speeds = outcome.mean_speed.as_deref().expect("speeds");
            (speeds[0] - speeds[1]).abs() < 0.01
        };
        let moving = computed.iter().filter(|run| run.label() != Label::Equilibrium);
        let together = moving.clone().filter(speed).count();
        assert!(together * 10 >= moving.count() * 9, "{law}: {together}");
    }
}
