//! Closed forms of the motion of a block on a spring, the reference for computed motions.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::support::{Block, Ground};

/// How a block comes to rest, by [`Block::stopping`].
#[derive(Clone, Debug, PartialEq)]
pub struct Stopping {
    /// The positions at which the block stands still, m; the last one is final.
    pub turning_points_m: Vec<f64>,
    /// Time of the final stop, s.
    pub time_s: f64,
}

/// The limit cycle of a block on a belt, by [`Block::stick_slip_cycle`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickSlipCycle {
    /// Time of a whole cycle, s.
    pub period_s: f64,
    /// Where it breaks away, m.
    pub break_away_m: f64,
    /// Half of the distance between its least and its greatest position, m.
    pub amplitude_m: f64,
}

/// Returns static and kinetic friction over spring stiffness, `μ_s F_n / k` and `μ F_n / k`, m, and the drag, N s/m;
/// `None` if the friction otherwise depends on speed.
fn reaches_m(block: &Block) -> Option<([f64; 2], f64)> {
    let kinetic = block.friction_coefficient;
    let (fixed, drag) = match (block.friction.name(), block.friction.values()) {
        ("coulomb", _) => (kinetic, 0.0),
        ("stribeck", &[static_friction_coefficient, 0.0]) => (static_friction_coefficient, 0.0),
        ("coulomb_viscous", &[drag]) => (kinetic, drag),
        _ => return None,
    };
    Some(([fixed, kinetic].map(|coefficient| coefficient * block.unit_length_m()), drag))
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

impl Block {
    /// How the block comes to rest on rigid ground (thesis figure 4.2).
    ///
    /// While it slides in the direction `σ`, `y = x + σ μ F_n / k` is an oscillation `m ÿ + c ẏ + k y = 0`, with the drag `c`,
    /// `δ = c / (2 m)` and `ν² = k / m - δ²`. From `(y, v)` it stands still after the time
    /// `t = atan2(ν |v|, σ (y k / m + δ v)) / ν` at `y = σ hypot(y, (v + δ y) / ν) e^{-δ t} ν / ω_n`, and from rest after `π / ν` at
    /// `-y e^{-δ π / ν}`. It stays at the first turning point with
    /// `|x| ≤ μ_s F_n / k`, because there is no drag at rest.
    ///
    /// None on a belt, without an oscillation (`ν² ≤ 0`) and without friction, or if the friction depends on speed otherwise.
    pub fn stopping(&self, position_m: f64, velocity_m_s: f64) -> Option<Stopping> {
        let ([hold, slide], drag) = reaches_m(self)?;
        let square = self.stiffness_n_m / self.mass_kg;
        let decay = 0.5 * drag / self.mass_kg;
        let frequency = (square - decay * decay).sqrt();
        if self.ground != Ground::Fixed || slide <= 0.0 || frequency.is_nan() || frequency == 0.0 {
            return None;
        }
        let (mut x, mut v, mut time_s) = (position_m, velocity_m_s, 0.0);
        let mut turning_points_m = Vec::new();
        loop {
            if v == 0.0 {
                turning_points_m.push(x);
                if x.abs() <= hold {
                    return Some(Stopping { turning_points_m, time_s });
                }
            }
            let direction = if v == 0.0 { -x.signum() } else { v.signum() };
            let y = x + direction * slide;
            let (half_swing, end) = if v == 0.0 {
                let half_swing = PI / frequency;
                (half_swing, -y * libm::exp(-decay * half_swing))
            } else {
                let across = direction * (square * y + decay * v);
                let part = libm::atan2(frequency * v.abs(), across) / frequency;
                let radius = libm::hypot(y, (v + decay * y) / frequency);
                let left = libm::exp(-decay * part) * frequency / square.sqrt();
                (part, direction * radius * left)
            };
            x = end - direction * slide;
            (v, time_s) = (0.0, time_s + half_swing);
        }
    }

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
    pub fn stick_slip_cycle(&self) -> Option<StickSlipCycle> {
        let ([hold, slide], _) = reaches_m(self)?;
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

    /// Position, m, and velocity, m/s, of a block with viscous friction after a time: the damped
    /// oscillation `m ẍ + c (ẋ - v_b) + k x = 0` about `c v_b / k`. None with another law.
    pub fn damped_oscillation(
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

    /// Where a block with the smooth law has crept to after a time, m: without inertia,
    /// `μ F_n (2/π) atan(ẋ / v_0) = -k x`, so that with `ℓ = μ F_n / k`
    /// `ẋ = -v_0 tan(π x / (2 ℓ))` and `sin(π x / (2 ℓ))` decays as `e^{-π v_0 t / (2 ℓ)}`.
    ///
    /// None with another law, on a belt, and outside `|x| < ℓ`, where no friction could hold it.
    pub fn creep_position_m(&self, position_m: f64, time_s: f64) -> Option<f64> {
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
