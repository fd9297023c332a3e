//! Closed forms of the motion of a block on a spring, the reference for computed motions.
//!
//! With dry friction that does not depend on speed, each phase of slip is a circle in the plane of
//! position and velocity over `ω_n`, about the place where the spring balances kinetic friction:
//! `-μ F_n / k` for a block that slides towards positive positions relative to its ground, and
//! `+μ F_n / k` for one that slides the other way.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::support::{Block, Ground};

/// Relative rounding tolerance, in half swings, for a turning point on the edge of the rest set.
const EDGE: f64 = 1e-12;

/// How a block on rigid ground comes to rest, by [`ClosedForms::stopping`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stopping {
    /// First turning point, m: the block stays there or begins the first whole half swing.
    pub first_turning_point_m: f64,
    /// Number of whole half swings after that.
    pub half_swings: u64,
    /// Difference between the distances at the start and at the end of a half swing, m.
    pub loss_per_half_swing_m: f64,
    /// Time of the final stop, s.
    pub time_s: f64,
    /// Position of the final stop, m.
    pub position_m: f64,
}

impl Stopping {
    /// Returns the position at the end of a half swing, counted from 1; 0 is the first turning
    /// point.
    fn turning_point_m(self, swing: u64) -> f64 {
        let first = self.first_turning_point_m;
        let left = first.abs() - swing as f64 * self.loss_per_half_swing_m;
        let side = if swing.is_multiple_of(2) { 1.0 } else { -1.0 };
        side * first.signum() * left
    }
}

/// How a block with Coulomb friction and viscous drag comes to rest, by [`ClosedForms::damped_stopping`].
#[derive(Clone, Debug, PartialEq)]
pub struct DampedStopping {
    /// The positions at which the block stands still, m; the last one is final.
    pub turning_points_m: Vec<f64>,
    /// Time of the final stop, s.
    pub time_s: f64,
}

/// The limit cycle of a block on a belt, by [`ClosedForms::stick_slip_cycle`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSlipCycle {
    /// Time of a whole cycle, s.
    pub period_s: f64,
    /// Where it breaks away, m.
    pub break_away_m: f64,
    /// Half of the distance between its least and its greatest position, m.
    pub amplitude_m: f64,
}

/// Closed-form motions of a block.
pub trait ClosedForms {
    /// How the block comes to rest on rigid ground (thesis figure 4.2).
    ///
    /// From `(x_0, v_0)` it slides along the circle of radius
    /// `R = sqrt((x_0 ± μ F_n / k)² + (v_0 / ω_n)²)` to its first turning point. From a turning
    /// point at the distance `A` from where the spring is free, it swings about `μ F_n / k` on the
    /// same side to the distance `A - 2 μ F_n / k` on the other, in the time `π / ω_n`. It stays at
    /// the first turning point with `A ≤ μ_s F_n / k`, that is after the least whole number of half
    /// swings that is not below `(A - μ_s F_n / k) / (2 μ F_n / k)`. A block that turns exactly on
    /// the edge of that interval stays there.
    ///
    /// None on a belt, without friction, and with friction that depends on speed.
    fn stopping(&self, position_m: f64, velocity_m_s: f64) -> Option<Stopping>;

    /// How a block with Coulomb friction and viscous drag comes to rest on rigid ground.
    ///
    /// While it slides in the direction `σ`, `y = x + σ μ F_n / k` is a damped oscillation
    /// `m ÿ + c ẏ + k y = 0` with `δ = c / (2 m)` and `ν² = k / m - δ²`. From `(y, v)` it stands still after the time
    /// `atan2(ν |v|, σ (y k / m + δ v)) / ν`, and after `π / ν` from rest. It stays at the first turning point with
    /// `|x| ≤ μ F_n / k`, because there is no drag at rest.
    ///
    /// None with another law, on a belt, and without an oscillation (`ν² ≤ 0`).
    fn damped_stopping(&self, position_m: f64, velocity_m_s: f64) -> Option<DampedStopping>;

    /// The stick-slip limit cycle of a block on a belt whose friction drops at once from a static to
    /// a kinetic coefficient (R. I. Leine, D. H. van Campen, A. de Kraker, L. van den Steen,
    /// Nonlinear Dynamics 16 (1998) 41, doi:10.1023/A:1008289604683).
    ///
    /// The belt carries the block to `x = μ_s F_n / k`, where it breaks away with the belt's speed
    /// `v_b`. It slips along the circle about `μ F_n / k` with the radius
    /// `R = sqrt(d² + (v_b / ω_n)²)`, where `d = (μ_s - μ) F_n / k`, and is as fast as the belt again
    /// at the mirror image of that place, `x = μ F_n / k - d`, after the angle
    /// `π + 2 atan(v_b / (ω_n d))`. There it sticks for the time `2 d / v_b`.
    ///
    /// None on rigid ground, and unless the static coefficient is above the kinetic one and the
    /// friction does not depend on speed otherwise: with equal coefficients the circle touches the
    /// belt's speed in one point only.
    fn stick_slip_cycle(&self) -> Option<StickSlipCycle>;

    /// Position, m, and velocity, m/s, of a block with viscous friction after a time: the damped
    /// oscillation `m ẍ + c (ẋ - v_b) + k x = 0` about `c v_b / k`. None with another law.
    fn damped_oscillation(
        &self,
        position_m: f64,
        velocity_m_s: f64,
        time_s: f64,
    ) -> Option<[f64; 2]>;

    /// Where a block with the smooth law has crept to after a time, m: without inertia,
    /// `μ F_n (2/π) atan(ẋ / v_0) = -k x`, so that with `ℓ = μ F_n / k`
    /// `ẋ = -v_0 tan(π x / (2 ℓ))` and `sin(π x / (2 ℓ))` decays as `e^{-π v_0 t / (2 ℓ)}`.
    ///
    /// None with another law, on a belt, and outside `|x| < ℓ`, where no friction could hold it.
    fn creep_position_m(&self, position_m: f64, time_s: f64) -> Option<f64>;
}

/// Returns static and kinetic friction over spring stiffness, `μ_s F_n / k` and `μ F_n / k`, m;
/// `None` if the friction otherwise depends on speed.
fn reaches_m(block: &Block) -> Option<[f64; 2]> {
    let kinetic = block.friction_coefficient;
    let fixed = match (block.friction.name(), block.friction.values()) {
        ("coulomb", _) => kinetic,
        ("stribeck", &[static_friction_coefficient, 0.0]) => static_friction_coefficient,
        _ => return None,
    };
    Some([fixed, kinetic].map(|coefficient| coefficient * block.unit_length_m()))
}

/// Returns the solution of `m ẍ + c ẋ + k x = 0`, with the drag `c`, from a position and a velocity after a time.
fn oscillation(block: &Block, drag: f64, [x, v]: [f64; 2], time_s: f64) -> [f64; 2] {
    let decay = 0.5 * drag / block.mass_kg;
    let discriminant = block.stiffness_n_m / block.mass_kg - decay * decay;
    // x(t) = e^{-δt} (x C + (v + δx) S) with C, S = cos νt, sin νt / ν, their hyperbolic
    // counterparts, or 1 and t between the two.
    let root = discriminant.abs().sqrt();
    let (even, odd) = if discriminant > 0.0 {
        (libm::cos(root * time_s), libm::sin(root * time_s) / root)
    } else if discriminant < 0.0 {
        (libm::cosh(root * time_s), libm::sinh(root * time_s) / root)
    } else {
        (1.0, time_s)
    };
    let left = libm::exp(-decay * time_s);
    let pull = block.stiffness_n_m / block.mass_kg * x;
    [left * (x * even + (v + decay * x) * odd), left * (v * even - (pull + decay * v) * odd)]
}

impl ClosedForms for Block {
    fn stopping(&self, position_m: f64, velocity_m_s: f64) -> Option<Stopping> {
        let [hold, slide] = reaches_m(self)?;
        if self.ground != Ground::Fixed || slide <= 0.0 {
            return None;
        }
        let natural = self.natural_frequency_rad_s();
        let (first, first_time) = if velocity_m_s == 0.0 {
            (position_m, 0.0)
        } else {
            let forward = velocity_m_s.signum();
            let along = forward * position_m + slide;
            let across = velocity_m_s.abs() / natural;
            let radius = libm::hypot(along, across);
            (forward * (radius - slide), libm::atan2(across, along) / natural)
        };
        let to_go = (first.abs() - hold) / (2.0 * slide);
        let swings = (to_go - EDGE * to_go.max(1.0)).ceil().max(0.0);
        let mut stopping = Stopping {
            first_turning_point_m: first,
            half_swings: swings as u64,
            loss_per_half_swing_m: 2.0 * slide,
            time_s: first_time + swings * PI / natural,
            position_m: first,
        };
        stopping.position_m = stopping.turning_point_m(stopping.half_swings);
        Some(stopping)
    }

    fn damped_stopping(&self, position_m: f64, velocity_m_s: f64) -> Option<DampedStopping> {
        let drag = match (self.friction.name(), self.friction.values()) {
            ("coulomb_viscous", &[drag]) if self.ground == Ground::Fixed => drag,
            _ => return None,
        };
        let reach = self.friction_coefficient * self.unit_length_m();
        let square = self.stiffness_n_m / self.mass_kg;
        let decay = 0.5 * drag / self.mass_kg;
        let frequency = (square - decay * decay).sqrt();
        if frequency.is_nan() || frequency == 0.0 {
            return None;
        }
        let (mut x, mut v, mut time_s) = (position_m, velocity_m_s, 0.0);
        let mut turning_points_m = Vec::new();
        loop {
            if v == 0.0 {
                turning_points_m.push(x);
                if x.abs() <= reach {
                    return Some(DampedStopping { turning_points_m, time_s });
                }
            }
            let direction = if v == 0.0 { -x.signum() } else { v.signum() };
            let y = x + direction * reach;
            let half_swing = match v == 0.0 {
                true => PI / frequency,
                false => {
                    let across = direction * (square * y + decay * v);
                    libm::atan2(frequency * v.abs(), across) / frequency
                }
            };
            x = oscillation(self, drag, [y, v], half_swing)[0] - direction * reach;
            (v, time_s) = (0.0, time_s + half_swing);
        }
    }

    fn stick_slip_cycle(&self) -> Option<StickSlipCycle> {
        let [hold, slide] = reaches_m(self)?;
        let Ground::Belt { speed_m_s } = self.ground else { return None };
        let drop = hold - slide;
        if drop <= 0.0 {
            return None;
        }
        let natural = self.natural_frequency_rad_s();
        let amplitude_m = libm::hypot(drop, speed_m_s / natural);
        let stick_s = 2.0 * drop / speed_m_s;
        let slip_s = (PI + 2.0 * libm::atan2(speed_m_s / natural, drop)) / natural;
        Some(StickSlipCycle { period_s: stick_s + slip_s, break_away_m: hold, amplitude_m })
    }

    fn damped_oscillation(
        &self,
        position_m: f64,
        velocity_m_s: f64,
        time_s: f64,
    ) -> Option<[f64; 2]> {
        let drag = match (self.friction.name(), self.friction.values()) {
            ("viscous", &[drag]) => drag,
            _ => return None,
        };
        let belt = match self.ground {
            Ground::Fixed => 0.0,
            Ground::Belt { speed_m_s } => speed_m_s,
        };
        let centre = drag * belt / self.stiffness_n_m;
        let [x, v] = oscillation(self, drag, [position_m - centre, velocity_m_s], time_s);
        Some([centre + x, v])
    }

    fn creep_position_m(&self, position_m: f64, time_s: f64) -> Option<f64> {
        let smoothing_speed = self.friction.value("smoothing_speed_m_s")?;
        let reach = self.friction_coefficient * self.unit_length_m();
        if self.ground != Ground::Fixed || position_m.abs() >= reach {
            return None;
        }
        let sine = libm::sin(FRAC_PI_2 * position_m / reach);
        let left = libm::exp(-FRAC_PI_2 * smoothing_speed * time_s / reach);
        Some(libm::asin(sine * left) * reach / FRAC_PI_2)
    }
}
