//! Values of a machine that are probably written in another unit, such as mm, N/mm or g, and a ball with the mass of
//! a template but another diameter.

use std::f64::consts::TAU;
use std::path::Path;
use std::sync::LazyLock;

use super::ball_fit::density_kg_m3;
use super::facts::GRAVITY_M_S2;
use crate::model::{Ball, Machine};
use crate::numbers::short;
use crate::study::{Study, Template};

/// A quantity of a machine, and a limit that no usual machine exceeds.
pub(super) struct UsualLimit {
    /// Name of the kind of warning.
    pub kind: &'static str,
    /// The parameters that determine the quantity; the warning is about the first one that the study gives.
    pub parameters: &'static [&'static str],
    /// Whether the quantity exceeds the limit.
    pub is_exceeded: bool,
    /// What is unusual.
    pub problem: &'static str,
    /// The quantity in words.
    pub found: String,
    /// The limit in words.
    pub remedy: &'static str,
    /// A remark on the unit, for a study that writes none.
    pub remark: &'static str,
}

/// The kind of warning of balls that are heavier than the table.
pub(super) const HEAVY_BALLS: &str = "heavy_balls";

const LENGTHS: &str = "; lengths are in m, not in mm";

/// Returns the limits of a machine; `said` returns the value of a parameter with its unit. The deflection of a suspension by
/// the weight that it carries measures its softness, whatever the direction of the springs; 0.7 times the radius of the ring
/// is that of a washing machine on suspension rods.
pub(super) fn limits(machine: &Machine, said: impl Fn(&str, f64) -> String) -> [UsualLimit; 6] {
    let Machine { ring_radius_m, imbalance_radius_m, table_mass_kg, .. } = *machine;
    let Machine { stiffness_n_m, damping_n_s_m, .. } = *machine;
    let (total_kg, natural_rad_s) = (machine.total_mass_kg(), machine.natural_frequency_rad_s());
    let balls_kg = machine.balls.iter().map(|ball| ball.mass_kg).sum();
    let deflection_m = GRAVITY_M_S2 * total_kg / stiffness_n_m;
    let critical_n_s_m = 2.0 * (stiffness_n_m * total_kg).sqrt();
    let radius = said("ring_radius_m", ring_radius_m);
    let deflection = said("ring_radius_m", deflection_m);
    let natural_hz = short(natural_rad_s / TAU);
    let stiffness = said("stiffness_n_m", stiffness_n_m);
    let [table, total] = [table_mass_kg, total_kg].map(|mass| said("table_mass_kg", mass));
    let balls = said("ball_mass_kg", balls_kg);
    let damping = said("damping_n_s_m", damping_n_s_m);
    let damping_ratio = short(damping_n_s_m / critical_n_s_m);
    [
        UsualLimit {
            kind: "length",
            parameters: &["ring_radius_m"],
            is_exceeded: ring_radius_m > 2.0,
            problem: "a ring that is larger than usual",
            found: format!("a radius of {radius}"),
            remedy: "at most 2 m",
            remark: LENGTHS,
        },
        UsualLimit {
            kind: "length",
            parameters: &["imbalance_radius_m"],
            is_exceeded: imbalance_radius_m > 2.0,
            problem: "an imbalance that is farther from the axis than usual",
            found: said("imbalance_radius_m", imbalance_radius_m),
            remedy: "at most 2 m",
            remark: LENGTHS,
        },
        UsualLimit {
            kind: "soft_suspension",
            parameters: &["stiffness_n_m", "table_mass_kg"],
            is_exceeded: deflection_m > 2.0 * ring_radius_m,
            problem: "the suspension is unusually soft for the mass that it carries",
            found: format!(
                "{stiffness} and {total}, whose weight would deflect it by {deflection}"
            ),
            remedy: "a deflection of at most twice the radius of the ring",
            remark: "; the stiffness is in N/m, not in N/mm, and masses are in kg, not in g",
        },
        UsualLimit {
            kind: "stiff_suspension",
            parameters: &["stiffness_n_m", "table_mass_kg"],
            is_exceeded: natural_rad_s > STIFFEST_RAD_S,
            problem: "the suspension is unusually stiff for the mass that it carries",
            found: format!("{stiffness} and {total}, a natural frequency of {natural_hz} Hz"),
            remedy: "a natural frequency of at most 5000 Hz",
            remark: "; the stiffness is in N/m, and masses are in kg, not in t",
        },
        UsualLimit {
            kind: HEAVY_BALLS,
            parameters: &["ball_mass_kg", "table_mass_kg"],
            is_exceeded: balls_kg > table_mass_kg,
            problem: "the balls together are heavier than the table",
            found: format!("balls with a total mass of {balls} on a table of {table}"),
            remedy: "balls that are lighter than the table",
            remark: "; masses are in kg, not in g",
        },
        UsualLimit {
            kind: "overdamped_suspension",
            parameters: &["damping_n_s_m"],
            is_exceeded: damping_n_s_m > 2.0 * critical_n_s_m,
            problem: "the suspension is damped so strongly that the table cannot oscillate",
            found: format!("{damping}, {damping_ratio} times the critical damping"),
            remedy: "at most twice the critical damping 2 sqrt(k M)",
            remark: "; the damping is in N s/m, not in g/s",
        },
    ]
}

/// The highest usual natural frequency, rad/s.
const STIFFEST_RAD_S: f64 = 5000.0 * TAU;

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
