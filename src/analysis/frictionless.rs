//! All equilibria without dry friction (thesis section 5.1, appendix D), for any number of balls.
//!
//! Without friction the tangential force on every ball vanishes: `Im(z_0 e^{-iβ}) = 0`. Either the
//! table rests balanced at `z_0 = 0`, or every ball lies on the line through `z_0`, on one side or
//! the other: `β = θ` or `θ + π`. With `S = Σ ±m` and `γ` the angle of `z_0` relative to the
//! imbalance that causes it, the line satisfies
//!
//! ```text
//! sin(θ - γ) = (S / m_I e) sin γ
//! ```
//!
//! which has two solutions, or none if `|S sin γ| > m_I e`. Without an imbalance, the line may have
//! any direction if `S sin γ = 0`, and there is no such line otherwise. For two identical balls these are the
//! thesis's A1+ and A1- (together), A2 (opposite each other) and B1 (balanced). Balls with contact lie in rows
//! ([`super::on_a_line`]).

use nalgebra::Complex;

use super::balance::Balance;
use super::frictionless_position::{FrictionlessKind, FrictionlessPosition};
use super::identical_balls::groups_of_identical;
use super::linearised::{SmallMotions, Stability};
use super::on_a_line::on_a_line;
use super::rest_form::RestForm;
use crate::model::{Machine, wrap_to_two_pi};

/// The `drag` argument of [`frictionless_equilibria`] that gives the stability of slow balls:
/// larger values do not change the result.
pub const HIGH_DRAG: f64 = 1e4;

/// An equilibrium without friction.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionlessEquilibrium {
    /// The kind.
    pub kind: FrictionlessKind,
    /// Angle of each ball from the imbalance, in [0, 2π), rad, ascending among identical balls. One
    /// position of a family; `None` if every position is an equilibrium.
    pub beta_rad: Option<Vec<f64>>,
    /// Where the table rests, in the turning frame, m.
    pub position_m: [f64; 2],
    /// Dimension of the family of equilibria that contains this one; 0 if it is isolated.
    pub family_dimension: usize,
    /// Stability against small disturbances.
    pub stability: Stability,
    /// All eigenvalues of the linearised equations, 1/s, the fastest growing first, including the
    /// zeros along a family.
    pub eigenvalues_per_s: Vec<Complex<f64>>,
}

impl FrictionlessEquilibrium {
    /// Amplitude of the table's vibration, m.
    pub fn amplitude_m(&self) -> f64 {
        self.position_m[0].hypot(self.position_m[1])
    }

    fn at(form: &RestForm, candidate: FrictionlessPosition, drag: f64) -> Self {
        let FrictionlessPosition { kind, beta, family_dimension } = candidate;
        let motions = SmallMotions::about(form, &beta, drag, family_dimension);
        let balanced = kind == FrictionlessKind::B1;
        let z = if balanced { Complex::from(0.0) } else { form.ring_centre(&beta) };
        let z = z - form.runout;
        let rate = form.natural_frequency_rad_s;
        FrictionlessEquilibrium {
            kind,
            beta_rad: Some(beta),
            position_m: [z.re * form.ring_radius_m, z.im * form.ring_radius_m],
            family_dimension,
            stability: motions.stability,
            eigenvalues_per_s: motions.eigenvalues.into_iter().map(|value| value * rate).collect(),
        }
    }
}

/// Returns all equilibria without friction, modulo 2π and modulo the exchange of identical balls.
/// For balanced positions of two different balls, both mirror images are returned.
///
/// Each ball has the viscous drag `C β̇`, with `C = drag` over `m ω_n`. `None` for an unsupported
/// number of balls.
pub fn frictionless_equilibria(
    machine: &Machine,
    drag: f64,
) -> Option<Vec<FrictionlessEquilibrium>> {
    let form = RestForm::new(machine)?;
    if form.speed == 0.0 {
        return Some(vec![FrictionlessEquilibrium {
            kind: FrictionlessKind::Everywhere,
            beta_rad: None,
            position_m: [0.0; 2],
            family_dimension: form.mass.len(),
            stability: Stability::Marginal,
            eigenvalues_per_s: Vec::new(),
        }]);
    }
    let candidates = equilibrium_positions(&form).into_iter();
    Some(candidates.map(|position| FrictionlessEquilibrium::at(&form, position, drag)).collect())
}

/// Returns all positions at a nonzero speed, ordered by kind.
pub(super) fn equilibrium_positions(form: &RestForm) -> Vec<FrictionlessPosition> {
    let mut all = on_a_line(form);
    let balanced = |beta, family_dimension| FrictionlessPosition {
        kind: FrictionlessKind::B1,
        beta,
        family_dimension,
    };
    match Balance::of(form) {
        Balance::Nowhere => {}
        Balance::Family { example, dimension } => all.push(balanced(example, dimension)),
        Balance::Position(beta) => {
            let axis = 2.0 * form.imbalance.arg();
            let mirrored: Vec<f64> = beta.iter().map(|beta| wrap_to_two_pi(axis - beta)).collect();
            let identical = groups_of_identical(&form.balls).len() == 1;
            all.push(balanced(beta, 0));
            if !identical {
                all.push(balanced(mirrored, 0));
            }
        }
    }
    all.sort_by_key(|candidate| candidate.kind);
    all
}
