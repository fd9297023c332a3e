//! The automatic ball balancer in SI units, with the parameters of a study file.
//!
//! Default values are the thesis's machine (TU Eindhoven, "Modeling and Analysis of an Automatic
//! Balancing Unit with Dry Friction", table 3.2; the powers of ten that its scan lost are restored
//! so that the natural frequency, the balancing angles and the amplitudes it prints come out).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::invalid_parameter::{InvalidParameter, finite, invalid, not_negative, positive};
use super::parameter_name::member_name;
use super::{BallContact, Friction, FrictionLaw, SlidingSpeed, SpeedProfile};
use crate::named::named;

/// The largest number of balls that one machine may have.
pub const MAX_BALLS: usize = 8;

/// One ball in the ring: a homogeneous sphere that rolls with dry friction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Ball {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Diameter, m.
    pub diameter_m: f64,
    /// Coefficient of friction between ball and ring (rolling resistance), dimensionless; the
    /// kinetic one if the law also has a static one. Not used by the viscous law.
    pub friction_coefficient: f64,
    /// Density of the homogeneous sphere, kg/m³, if it determines the mass (see [`Machine::derive`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density_kg_m3: Option<f64>,
}

/// Derivations of the normal force.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "NormalForceKind")]
pub enum NormalForce {
    /// From Lagrange's equations with the rolling constraint inserted, as in the thesis.
    // The normal force then contains `2 J d ω β̇ - 4 J β̇²` (its equation 3.5).
    Lagrange,
    /// From Newton's second law for the centre of the ball.
    Newton,
}

named!(NormalForce { Lagrange: "lagrange", Newton: "newton" });

impl NormalForce {
    /// Returns the form with this name.
    pub fn named(name: &str) -> Option<NormalForce> {
        NormalForce::ALL.iter().copied().find(|force| force.name() == name)
    }
}

/// A machine: table on springs, turning disc with an imbalance, and balls in a ring.
///
/// Fields may have any finite value; [`Machine::validate`] checks that the machine is physically
/// valid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Mass of table, motor, ring and disc, without imbalance and balls, kg.
    pub table_mass_kg: f64,
    /// Spring stiffness of the suspension per direction, N/m.
    pub stiffness_n_m: f64,
    /// Viscous damping of the suspension per direction, N s/m.
    pub damping_n_s_m: f64,
    /// Distance from the ring's centre to the balls' centres, m.
    pub ring_radius_m: f64,
    /// Mass of the imbalance, kg; 0 for a balanced rotor.
    pub imbalance_mass_kg: f64,
    /// Distance of the imbalance from the disc's centre, m.
    pub imbalance_radius_m: f64,
    /// Product of mass and radius of the imbalance, kg m, if it determines the mass (see [`Machine::derive`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub imbalance_kg_m: Option<f64>,
    /// Distance of the ring's centre from the disc's centre, m.
    pub ring_runout_m: f64,
    /// Direction of the ring's centre from the disc's centre, an angle from the imbalance, rad.
    pub ring_runout_angle_rad: f64,
    /// Prescribed speed of the disc, rad/s, or the last one of the speed profile; negative turns clockwise.
    pub speed_rad_s: f64,
    /// The balls, one to [`MAX_BALLS`].
    pub balls: Vec<Ball>,
    /// How the normal force is derived.
    pub normal_force: NormalForce,
    /// The law of the friction between balls and ring.
    pub friction: FrictionLaw,
    /// The contact between balls; `None` for balls that pass through each other.
    pub contact: Option<BallContact>,
    /// How the speed changes until it is `speed_rad_s`; `None` for a constant speed.
    pub speed_profile: Option<SpeedProfile>,
    /// The kicks of the table.
    pub kicks: Vec<Kick>,
}

impl Default for Ball {
    /// A steel ball of 3 mm, as in the thesis (table 3.2).
    fn default() -> Self {
        Ball {
            mass_kg: 1.4e-4,
            diameter_m: 3.0e-3,
            friction_coefficient: 2.75e-3,
            density_kg_m3: None,
        }
    }
}

impl Default for Machine {
    /// The thesis's machine (table 3.2) with two balls at -216.3772 rad/s.
    fn default() -> Self {
        Machine {
            table_mass_kg: 3.24e-1,
            stiffness_n_m: 1.07e4,
            damping_n_s_m: 1.28,
            ring_radius_m: 1.15e-2,
            imbalance_mass_kg: 5.6e-5,
            imbalance_radius_m: 3.7e-2,
            imbalance_kg_m: None,
            ring_runout_m: 0.0,
            ring_runout_angle_rad: 0.0,
            speed_rad_s: -216.3772,
            balls: vec![Ball::default(); 2],
            normal_force: NormalForce::Lagrange,
            friction: FrictionLaw::COULOMB,
            contact: None,
            speed_profile: None,
            kicks: Vec::new(),
        }
    }
}

impl Ball {
    /// Returns the volume, m³.
    pub fn volume_m3(&self) -> f64 {
        std::f64::consts::PI / 6.0 * self.diameter_m.powi(3)
    }

    /// Sets the mass to that of the density, if there is one.
    pub fn derive(&mut self) {
        if let Some(density_kg_m3) = self.density_kg_m3 {
            self.mass_kg = density_kg_m3 * self.volume_m3();
        }
    }
}

impl Machine {
    /// Sets the masses that other values determine: those of balls with a density, and that of an imbalance that is given
    /// as a product.
    pub fn derive(&mut self) {
        self.balls.iter_mut().for_each(Ball::derive);
        if let Some(imbalance_kg_m) = self.imbalance_kg_m {
            self.imbalance_mass_kg = imbalance_kg_m / self.imbalance_radius_m;
        }
    }

    /// Checks that all values have a physical meaning. Rejected are non-finite values, masses,
    /// lengths and stiffness that are not positive, a negative imbalance, damping or friction, and
    /// fewer than one or more than [`MAX_BALLS`] balls.
    ///
    /// # Errors
    /// The first invalid parameter, by the name it has in a study file.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        let balls = self.balls.len();
        if balls == 0 || balls > MAX_BALLS {
            return Err(invalid("balls", &balls.to_string(), "between 1 and 8"));
        }
        positive("table_mass_kg", self.table_mass_kg)?;
        positive("stiffness_n_m", self.stiffness_n_m)?;
        positive("ring_radius_m", self.ring_radius_m)?;
        positive("imbalance_radius_m", self.imbalance_radius_m)?;
        self.imbalance_kg_m.map_or(Ok(()), |product| not_negative("imbalance_kg_m", product))?;
        not_negative("imbalance_mass_kg", self.imbalance_mass_kg)?;
        not_negative("damping_n_s_m", self.damping_n_s_m)?;
        not_negative("ring_runout_m", self.ring_runout_m)?;
        finite("ring_runout_angle_rad", self.ring_runout_angle_rad)?;
        finite("speed_rad_s", self.speed_rad_s)?;
        for (number, ball) in (1..).zip(&self.balls) {
            // The names of a ball's parameters are composed for errors only.
            let of_ball = |unit: &'static str| {
                move |invalid: InvalidParameter| InvalidParameter {
                    name: member_name(&invalid.name, unit, number),
                    ..invalid
                }
            };
            if let Some(density_kg_m3) = ball.density_kg_m3 {
                positive("ball_density_kg_m3", density_kg_m3).map_err(of_ball("kg/m3"))?;
            }
            positive("ball_mass_kg", ball.mass_kg).map_err(of_ball("kg"))?;
            positive("ball_diameter_m", ball.diameter_m).map_err(of_ball("m"))?;
            not_negative("friction_coefficient", ball.friction_coefficient).map_err(of_ball(""))?;
        }
        if let Some(contact) = &self.contact {
            contact.validate()?;
        }
        self.validate_stages()?;
        self.balls.iter().try_for_each(|ball| {
            self.friction.validate(ball.friction_coefficient, SlidingSpeed::RadS)
        })
    }

    /// Checks the values of the speed profile and of the kicks.
    pub(super) fn validate_stages(&self) -> Result<(), InvalidParameter> {
        if let Some(profile) = &self.speed_profile {
            profile.validate(("speed_rad_s", self.speed_rad_s))?;
        }
        (1..).zip(&self.kicks).try_for_each(|(number, kick)| kick.validate(number))
    }

    /// The whole vibrating mass `M = M_T + m_I + Σ m_i`, kg.
    pub fn total_mass_kg(&self) -> f64 {
        let balls: f64 = self.balls.iter().map(|ball| ball.mass_kg).sum();
        self.table_mass_kg + self.imbalance_mass_kg + balls
    }

    /// Returns the angle between the centres of two balls that touch, rad; π for balls that touch wherever they are.
    ///
    /// The centres lie on the circle of the radius `L`, at the distance of the sum of both radii:
    /// `2 L sin(Δβ/2) = (d_1 + d_2) / 2`.
    pub fn contact_angle_rad(&self, ball: &Ball, other: &Ball) -> f64 {
        let half_chord = 0.25 * (ball.diameter_m + other.diameter_m);
        2.0 * libm::asin((half_chord / self.ring_radius_m).min(1.0))
    }

    /// The non-dimensional friction between a ball and the ring.
    pub(super) fn ball_friction(&self, ball: &Ball) -> Friction {
        let natural = self.natural_frequency_rad_s();
        self.friction.contact(ball.friction_coefficient, natural, ball.mass_kg * natural)
    }

    /// The natural frequency `ω_n = sqrt(k / M)`, rad/s (thesis section 3.4).
    pub fn natural_frequency_rad_s(&self) -> f64 {
        (self.stiffness_n_m / self.total_mass_kg()).sqrt()
    }
}

/// A kick: a jump of the table's velocity, as by a blow with a hammer, and the balls jump with it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kick {
    /// The time, s.
    pub at_s: f64,
    /// The change of the table's velocity, m/s.
    pub speed_m_s: f64,
    /// The direction of the change, an angle in the frame at rest, rad; the imbalance has the angle 0 at the start.
    pub direction_rad: f64,
}

impl Kick {
    /// Checks that all values of the kick with this number, from 1, have a physical meaning.
    fn validate(&self, number: usize) -> Result<(), InvalidParameter> {
        positive(&member_name("kick_at_s", "s", number), self.at_s)?;
        not_negative(&member_name("kick_speed_m_s", "m/s", number), self.speed_m_s)?;
        finite(&member_name("kick_direction_rad", "rad", number), self.direction_rad)
    }
}
