//! The ball balancer as a kind of model: its parameters, the coordinates of its start states, and its units.

use std::f64::consts::TAU;

use super::{
    Ball, Capabilities, ContactUnits, Coordinate, DefaultModel, Field, Machine, ModelKind,
    ParameterDescriptor, SlidingSpeed, Units,
};

/// The automatic ball balancer.
pub static BALL_BALANCER: ModelKind = ModelKind {
    name: "ball_balancer",
    meaning: "An automatic ball balancer: a table on springs, a rotating disc with an imbalance, and balls in a ring.",
    parameters: &PARAMETERS,
    body: "ball",
    sliding_speed: SlidingSpeed::RadS,
    offers: Capabilities { vibration: true, equilibrium_set: true },
    default: DefaultModel::BallBalancer(|| Machine {
        balls: vec![Ball::default()],
        ..Machine::default()
    }),
};

/// A parameter: its name in a study file, its unit, its meaning and the field with the number.
macro_rules! parameter {
    ($name:literal, $unit:literal, $meaning:literal, $field:expr) => {
        ParameterDescriptor { name: $name, unit: $unit, meaning: $meaning, field: $field }
    };
}

/// The parameters of a speed profile.
pub(super) const PROFILE_PARAMETERS: [ParameterDescriptor; 4] = [
    parameter! { "start_speed_rad_s", "rad/s", "speed of the disc at the start",
    Field::Profile(|profile| &mut profile.start_speed_rad_s) },
    parameter! { "ramp_to_rad_s", "rad/s", "speed of the disc at the end",
    Field::Ramp(|ramp| ramp.to_rad_s.as_mut()) },
    parameter! { "ramp_over_s", "s", "duration",
    Field::Ramp(|ramp| Some(&mut ramp.over_s)) },
    parameter! { "hold_s", "s", "duration",
    Field::Hold },
];

const PARAMETERS: [ParameterDescriptor; 24] = [
    parameter! { "table_mass_kg", "kg", "mass of table, motor, ring and disc, without imbalance and balls",
    Field::Machine(|machine| &mut machine.table_mass_kg) },
    parameter! { "stiffness_n_m", "N/m", "stiffness of the suspension per direction",
    Field::Machine(|machine| &mut machine.stiffness_n_m) },
    parameter! { "damping_n_s_m", "N s/m", "viscous damping of the suspension per direction",
    Field::Machine(|machine| &mut machine.damping_n_s_m) },
    parameter! { "ring_radius_m", "m", "distance from the ring's centre to the balls' centres",
    Field::Machine(|machine| &mut machine.ring_radius_m) },
    parameter! { "imbalance_mass_kg", "kg", "mass of the imbalance",
    Field::Machine(|machine| &mut machine.imbalance_mass_kg) },
    parameter! { "imbalance_radius_m", "m", "distance of the imbalance from the disc's centre",
    Field::Machine(|machine| &mut machine.imbalance_radius_m) },
    parameter! { "imbalance_kg_m", "kg m", "product of mass and radius of the imbalance, in place of its mass",
    Field::OfMachine {
        number: |machine| &mut machine.imbalance_kg_m,
        following: |machine| machine.imbalance_mass_kg * machine.imbalance_radius_m,
        determines: "imbalance_mass_kg",
    } },
    parameter! { "ring_runout_m", "m", "runout: distance of the ring's centre from the disc's centre",
    Field::Machine(|machine| &mut machine.ring_runout_m) },
    parameter! { "ring_runout_angle_rad", "rad", "direction of the runout, an angle from the imbalance",
    Field::Machine(|machine| &mut machine.ring_runout_angle_rad) },
    parameter! { "ball_mass_kg", "kg", "mass",
    Field::Ball(|ball| &mut ball.mass_kg) },
    parameter! { "ball_diameter_m", "m", "diameter",
    Field::Ball(|ball| &mut ball.diameter_m) },
    parameter! { "ball_density_kg_m3", "kg/m3", "density, in place of the mass",
    Field::OfBall {
        number: |ball| &mut ball.density_kg_m3,
        following: |ball| ball.mass_kg / ball.volume_m3(),
        determines: "ball_mass_kg",
    } },
    parameter! { "friction_coefficient", "1", "coefficient of friction",
    Field::Ball(|ball| &mut ball.friction_coefficient) },
    parameter! { "contact_restitution", "1", "speed of separation over speed of approach of two balls",
    Field::Contact(|contact| &mut contact.restitution) },
    parameter! { "contact_friction_coefficient", "1", "coefficient of friction between two balls",
    Field::Contact(|contact| &mut contact.friction_coefficient) },
    parameter! { "speed_rad_s", "rad/s", "speed of the disc, the last one of its profile",
    Field::Machine(|machine| &mut machine.speed_rad_s) },
    PROFILE_PARAMETERS[0],
    PROFILE_PARAMETERS[1],
    PROFILE_PARAMETERS[2],
    PROFILE_PARAMETERS[3],
    parameter! { "kick_at_s", "s", "time",
    Field::Kick(|kick| &mut kick.at_s) },
    parameter! { "kick_speed_m_s", "m/s", "change of the table's velocity",
    Field::Kick(|kick| &mut kick.speed_m_s) },
    parameter! { "kick_direction_rad", "rad", "direction in space",
    Field::Kick(|kick| &mut kick.direction_rad) },
    parameter! { "normal_force", "", "how the normal force is derived",
    Field::NormalForce },
];

/// Default half width of positions and table speeds. Like the ball speed below, it is
/// *reconstructed*: the thesis's box is illegible, and this box reproduces its six counts.
const HALF_WIDTH: f64 = 0.05;

/// Default largest ball speed divided by the natural frequency (reconstructed).
const BALL_SPEED: f64 = 1.0;

impl Machine {
    /// Returns the coordinates of a start state. By default, a machine whose disc starts has its table and its balls at rest on
    /// the disc.
    pub(super) fn coordinates(&self) -> Vec<Coordinate> {
        let [half_width, ball_speed] =
            if self.speed_profile.is_some() { [0.0; 2] } else { [HALF_WIDTH, BALL_SPEED] };
        let table = |name: &str, meaning, unit| {
            Coordinate::non_dimensional(name, meaning, unit, half_width)
        };
        let each = |stem: &'static str, of_one: &dyn Fn(String) -> Coordinate| -> Vec<Coordinate> {
            let of_ball = |ball: usize| Coordinate {
                of_every_body: Some(stem),
                ..of_one(format!("{stem}_{ball}"))
            };
            (1..=self.balls.len()).map(of_ball).collect()
        };
        let angle = |name: String| {
            let meaning = "start angle of the ball from the imbalance";
            let coordinate = Coordinate::new(name, "rad", meaning, [0.0, TAU]);
            Coordinate { default_in_words: Some("[0, 2π]"), ..coordinate }
        };
        let speed = |name: String| {
            let meaning = "start speed of the ball relative to the ring";
            let unit = "divided by the natural frequency";
            Coordinate::non_dimensional(name, meaning, unit, ball_speed)
        };
        const LENGTH: &str = "in ring radii";
        const VELOCITY: &str = "in ring radii, with time multiplied by the natural frequency";
        let across = "start position of the disc's centre at right angles to that";
        let mut all = vec![
            table("x", "start position of the disc's centre towards the imbalance", LENGTH),
            table("y", across, LENGTH),
        ];
        all.extend(each("beta", &angle));
        all.push(table("x_dot", "start velocity along x", VELOCITY));
        all.push(table("y_dot", "start velocity along y", VELOCITY));
        all.extend(each("beta_dot", &speed));
        all
    }

    /// Returns the units of the non-dimensional values.
    pub(super) fn units(&self) -> Units {
        let natural = self.natural_frequency_rad_s();
        let of_ball = |ball: &Ball| {
            ContactUnits::new(1.0, natural, ball.mass_kg * natural * natural * self.ring_radius_m)
        };
        Units {
            natural_rad_s: natural,
            length_m: self.ring_radius_m,
            contacts: self.balls.iter().map(of_ball).collect(),
            disc_rad_s: self.speed_rad_s,
            outputs: Vec::new(),
        }
    }
}
