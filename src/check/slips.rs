//! Values of a machine that are probably written in another unit, such as mm, N/mm or g, and a ball with the mass of
//! a template but another diameter.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::LazyLock;

use super::ball_fit::density_kg_m3;
use super::closed_form::GRAVITY_M_S2;
use crate::model::{Ball, Machine};
use crate::numbers::short;
use crate::study::{Study, Template};

/// A quantity that exceeds its limit in no usual machine.
pub(super) struct Limit {
    /// Name of the kind of warning.
    pub kind: &'static str,
    /// The parameters that determine the quantity; the warning is about the first one that the study gives.
    pub parameters: &'static [&'static str],
    /// Whether the quantity of a machine exceeds the limit.
    pub is_exceeded: fn(&Machine) -> bool,
    /// What is unusual.
    pub problem: &'static str,
    /// The quantity in words.
    pub found: fn(&Machine, Said<'_>) -> String,
    /// The limit in words.
    pub remedy: &'static str,
    /// A remark on the unit, for a study that writes none.
    pub remark: &'static str,
}

/// Returns the value of a parameter with its unit.
pub(super) type Said<'a> = &'a dyn Fn(&str, f64) -> String;

/// The kind of warning of balls that are heavier than the table.
pub(super) const HEAVY_BALLS: &str = "heavy_balls";

const LENGTHS: &str = "; lengths are in m, not in mm";

/// The limits. The deflection of a suspension by the weight that it carries measures its softness, whatever the direction of
/// the springs; 0.7 times the radius of the ring is that of a washing machine on suspension rods.
pub(super) const LIMITS: [Limit; 6] = [
    Limit {
        kind: "length",
        parameters: &["ring_radius_m"],
        is_exceeded: |machine| machine.ring_radius_m > 2.0,
        problem: "a ring that is larger than usual",
        found: |machine, said| {
            format!("a radius of {}", said("ring_radius_m", machine.ring_radius_m))
        },
        remedy: "at most 2 m",
        remark: LENGTHS,
    },
    Limit {
        kind: "length",
        parameters: &["imbalance_radius_m"],
        is_exceeded: |machine| machine.imbalance_radius_m > 2.0,
        problem: "an imbalance that is farther from the axis than usual",
        found: |machine, said| said("imbalance_radius_m", machine.imbalance_radius_m),
        remedy: "at most 2 m",
        remark: LENGTHS,
    },
    Limit {
        kind: "soft_suspension",
        parameters: &["stiffness_n_m", "table_mass_kg"],
        is_exceeded: |machine| deflection_m(machine) > 2.0 * machine.ring_radius_m,
        problem: "the suspension is unusually soft for the mass that it carries",
        found: |machine, said| {
            format!(
                "{} and {}, whose weight would deflect it by {}",
                said("stiffness_n_m", machine.stiffness_n_m),
                said("table_mass_kg", machine.total_mass_kg()),
                said("ring_radius_m", deflection_m(machine))
            )
        },
        remedy: "a deflection of at most twice the radius of the ring",
        remark: "; the stiffness is in N/m, not in N/mm, and masses are in kg, not in g",
    },
    Limit {
        kind: "stiff_suspension",
        parameters: &["stiffness_n_m", "table_mass_kg"],
        is_exceeded: |machine| machine.natural_frequency_rad_s() > STIFFEST_RAD_S,
        problem: "the suspension is unusually stiff for the mass that it carries",
        found: |machine, said| {
            format!(
                "{} and {}, a natural frequency of {} Hz",
                said("stiffness_n_m", machine.stiffness_n_m),
                said("table_mass_kg", machine.total_mass_kg()),
                short(machine.natural_frequency_rad_s() / TAU)
            )
        },
        remedy: "a natural frequency of at most 5000 Hz",
        remark: "; the stiffness is in N/m, and masses are in kg, not in t",
    },
    Limit {
        kind: HEAVY_BALLS,
        parameters: &["ball_mass_kg", "table_mass_kg"],
        is_exceeded: |machine| balls_kg(machine) > machine.table_mass_kg,
        problem: "the balls together are heavier than the table",
        found: |machine, said| {
            format!(
                "balls with a total mass of {} on a table of {}",
                said("ball_mass_kg", balls_kg(machine)),
                said("table_mass_kg", machine.table_mass_kg)
            )
        },
        remedy: "balls that are lighter than the table",
        remark: "; masses are in kg, not in g",
    },
    Limit {
        kind: "overdamped_suspension",
        parameters: &["damping_n_s_m"],
        is_exceeded: |machine| machine.damping_n_s_m > 2.0 * critical_damping_n_s_m(machine),
        problem: "the suspension is damped so strongly that the table cannot oscillate",
        found: |machine, said| {
            format!(
                "{}, {} times the critical damping",
                said("damping_n_s_m", machine.damping_n_s_m),
                short(machine.damping_n_s_m / critical_damping_n_s_m(machine))
            )
        },
        remedy: "at most twice the critical damping 2 sqrt(k M)",
        remark: "; the damping is in N s/m, not in g/s",
    },
];

/// The highest usual natural frequency, rad/s.
const STIFFEST_RAD_S: f64 = 5000.0 * TAU;

fn balls_kg(machine: &Machine) -> f64 {
    machine.balls.iter().map(|ball| ball.mass_kg).sum()
}

fn deflection_m(machine: &Machine) -> f64 {
    GRAVITY_M_S2 * machine.total_mass_kg() / machine.stiffness_n_m
}

fn critical_damping_n_s_m(machine: &Machine) -> f64 {
    2.0 * (machine.stiffness_n_m * machine.total_mass_kg()).sqrt()
}

/// The balls of the templates; that of `thesis` is the ball of the default machine.
static BALLS_OF_TEMPLATES: LazyLock<Vec<Ball>> = LazyLock::new(|| {
    let ball = |template: &Template| {
        let study = Study::parse(Path::new(template.name), template.source.to_owned()).ok()?;
        study.model().ball_balancer()?.balls.first().copied()
    };
    Template::ALL.iter().filter_map(ball).collect()
});

/// The fraction by which the density of a ball differs at least from that of the template.
const OTHER_DENSITY: f64 = 0.2;

/// Returns whether a ball has the mass of a template, but such another diameter that its density is another one.
pub(super) fn has_mass_of_template(ball: &Ball) -> bool {
    let density = density_kg_m3(ball);
    BALLS_OF_TEMPLATES.iter().any(|known| {
        let other = (density / density_kg_m3(known) - 1.0).abs() > OTHER_DENSITY;
        ball.mass_kg == known.mass_kg && other
    })
}
