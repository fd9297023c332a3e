//! The ball balancer as a kind of model: its parameters.

use super::kind::{Capabilities, DefaultModel, Field, ModelKind, ParameterDescriptor};
use super::{Ball, Machine, Model, SlidingSpeed};

/// The automatic ball balancer.
pub static BALL_BALANCER: ModelKind = ModelKind {
    name: "ball_balancer",
    meaning: "An automatic ball balancer: a table on springs, a rotating disc with an imbalance, and balls in a ring.",
    parameters: &PARAMETERS,
    body: "ball",
    sliding_speed: SlidingSpeed::RadS,
    offers: Capabilities { vibration: true, equilibrium_set: true, animation: true },
    default: DefaultModel::BuiltIn(|| {
        Model::BallBalancer(Machine { balls: vec![Ball::default()], ..Machine::default() })
    }),
};

/// The parameters of a speed profile.
pub(super) const PROFILE_PARAMETERS: [ParameterDescriptor; 4] = [
    ParameterDescriptor {
        name: "start_speed_rad_s",
        unit: "rad/s",
        meaning: "speed of the disc at the start",
        field: Field::Profile(|profile| &mut profile.start_speed_rad_s),
    },
    ParameterDescriptor {
        name: "ramp_to_rad_s",
        unit: "rad/s",
        meaning: "speed of the disc at the end",
        field: Field::Ramp(|ramp| ramp.to_rad_s.as_mut()),
    },
    ParameterDescriptor {
        name: "ramp_over_s",
        unit: "s",
        meaning: "duration",
        field: Field::Ramp(|ramp| Some(&mut ramp.over_s)),
    },
    ParameterDescriptor { name: "hold_s", unit: "s", meaning: "duration", field: Field::Hold },
];

const PARAMETERS: [ParameterDescriptor; 24] = [
    ParameterDescriptor {
        name: "table_mass_kg",
        unit: "kg",
        meaning: "mass of table, motor, ring and disc, without imbalance and balls",
        field: Field::Machine(|machine| &mut machine.table_mass_kg),
    },
    ParameterDescriptor {
        name: "stiffness_n_m",
        unit: "N/m",
        meaning: "stiffness of the suspension per direction",
        field: Field::Machine(|machine| &mut machine.stiffness_n_m),
    },
    ParameterDescriptor {
        name: "damping_n_s_m",
        unit: "N s/m",
        meaning: "viscous damping of the suspension per direction",
        field: Field::Machine(|machine| &mut machine.damping_n_s_m),
    },
    ParameterDescriptor {
        name: "ring_radius_m",
        unit: "m",
        meaning: "distance from the ring's centre to the balls' centres",
        field: Field::Machine(|machine| &mut machine.ring_radius_m),
    },
    ParameterDescriptor {
        name: "imbalance_mass_kg",
        unit: "kg",
        meaning: "mass of the imbalance",
        field: Field::Machine(|machine| &mut machine.imbalance_mass_kg),
    },
    ParameterDescriptor {
        name: "imbalance_radius_m",
        unit: "m",
        meaning: "distance of the imbalance from the disc's centre",
        field: Field::Machine(|machine| &mut machine.imbalance_radius_m),
    },
    ParameterDescriptor {
        name: "imbalance_kg_m",
        unit: "kg m",
        meaning: "product of mass and radius of the imbalance, in place of its mass",
        field: Field::OfMachine {
            number: |machine| &mut machine.imbalance_kg_m,
            following: |machine| machine.imbalance_mass_kg * machine.imbalance_radius_m,
            determines: "imbalance_mass_kg",
        },
    },
    ParameterDescriptor {
        name: "ring_runout_m",
        unit: "m",
        meaning: "distance of the ring's centre from the disc's centre",
        field: Field::Machine(|machine| &mut machine.ring_runout_m),
    },
    ParameterDescriptor {
        name: "ring_runout_angle_rad",
        unit: "rad",
        meaning: "direction of the ring's centre from the disc's centre, an angle from the imbalance",
        field: Field::Machine(|machine| &mut machine.ring_runout_angle_rad),
    },
    ParameterDescriptor {
        name: "ball_mass_kg",
        unit: "kg",
        meaning: "mass",
        field: Field::Ball(|ball| &mut ball.mass_kg),
    },
    ParameterDescriptor {
        name: "ball_diameter_m",
        unit: "m",
        meaning: "diameter",
        field: Field::Ball(|ball| &mut ball.diameter_m),
    },
    ParameterDescriptor {
        name: "ball_density_kg_m3",
        unit: "kg/m3",
        meaning: "density, in place of the mass",
        field: Field::OfBall {
            number: |ball| &mut ball.density_kg_m3,
            following: |ball| ball.mass_kg / ball.volume_m3(),
            determines: "ball_mass_kg",
        },
    },
    ParameterDescriptor {
        name: "friction_coefficient",
        unit: "1",
        meaning: "coefficient of friction",
        field: Field::Ball(|ball| &mut ball.friction_coefficient),
    },
    ParameterDescriptor {
        name: "contact_restitution",
        unit: "1",
        meaning: "speed of separation over speed of approach of two balls",
        field: Field::Contact(|contact| &mut contact.restitution),
    },
    ParameterDescriptor {
        name: "contact_friction_coefficient",
        unit: "1",
        meaning: "coefficient of friction between two balls",
        field: Field::Contact(|contact| &mut contact.friction_coefficient),
    },
    ParameterDescriptor {
        name: "speed_rad_s",
        unit: "rad/s",
        meaning: "speed of the disc, the last one of its profile",
        field: Field::Machine(|machine| &mut machine.speed_rad_s),
    },
    PROFILE_PARAMETERS[0],
    PROFILE_PARAMETERS[1],
    PROFILE_PARAMETERS[2],
    PROFILE_PARAMETERS[3],
    ParameterDescriptor {
        name: "kick_at_s",
        unit: "s",
        meaning: "time",
        field: Field::Kick(|kick| &mut kick.at_s),
    },
    ParameterDescriptor {
        name: "kick_speed_m_s",
        unit: "m/s",
        meaning: "change of the table's velocity",
        field: Field::Kick(|kick| &mut kick.speed_m_s),
    },
    ParameterDescriptor {
        name: "kick_direction_rad",
        unit: "rad",
        meaning: "direction in space",
        field: Field::Kick(|kick| &mut kick.direction_rad),
    },
    ParameterDescriptor {
        name: "normal_force",
        unit: "",
        meaning: "how the normal force is derived",
        field: Field::NormalForce,
    },
];
