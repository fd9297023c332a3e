//! What the parameters of a model say without simulation: closed forms of a ball balancer, and facts of any other system.

use serde::{Serialize, Serializer};

use super::SteadyStates;
use crate::analysis::{
    Balance, EquilibriumSet, HIGH_DRAG, Resolution, RestForm, SmallMotions, Stability,
    reference_amplitude,
};
use crate::check::BallPositions;
use crate::model::{CampbellDiagram, DerivedQuantity, Machine, Model, NaturalFrequencies};

/// What the closed forms say about a ball balancer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BalancerFacts {
    /// Natural frequency `sqrt(k / M)` of the whole vibrating mass, rad/s.
    pub natural_frequency_rad_s: f64,
    /// Absolute speed of the disc over the natural frequency.
    #[serde(rename = "speed_over_natural_frequency")]
    pub speed_ratio: f64,
    /// The largest imbalance that the balls can balance, `Σ m L`, kg m.
    #[serde(rename = "capacity_g_mm", serialize_with = "in_g_mm")]
    pub capacity_kg_m: f64,
    /// The imbalance, `m_I e`, kg m.
    #[serde(rename = "imbalance_g_mm", serialize_with = "in_g_mm")]
    pub imbalance_kg_m: f64,
    /// The balancing capacity over the imbalance.
    #[serde(rename = "capacity_over_imbalance")]
    pub capacity_ratio: f64,
    /// Gravity over the friction `μ ω² R` that holds a ball on a table at rest, with the largest coefficient of all balls;
    /// `None` if friction holds no ball. The axis is vertical; on a horizontal one, no ball stays at rest above 1.
    pub gravity_over_friction: Option<f64>,
    /// Amplitude of the machine without balls, m; `None` at the resonance of an undamped suspension.
    pub amplitude_without_balls_m: Option<f64>,
    /// Where the balls can balance the imbalance.
    #[serde(serialize_with = "by_name")]
    pub balance: Balance,
    /// Stability of the balancing position without dry friction; `None` if there is no such position. Of a family of
    /// positions, the stability of one of them.
    pub balance_stability: Option<Stability>,
    /// The positions of rest; `None` for a friction law that cannot hold a ball.
    pub rest: Option<RestFacts>,
}

fn in_g_mm<S: Serializer>(kg_m: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_f64(kg_m * 1e6)
}

fn by_name<S: Serializer>(balance: &Balance, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(balance.name())
}

/// The positions at which dry friction holds all balls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RestFacts {
    /// Fraction of all positions of the balls that are positions of rest.
    pub set_fraction: f64,
    /// The largest amplitude at a position of rest, m, as in [`EquilibriumSet::amplitude_m`].
    pub max_amplitude_m: Option<f64>,
    /// Fraction of the positions of rest in which balls overlap, if it could be estimated.
    pub overlapping_fraction: Option<f64>,
}

impl BalancerFacts {
    /// Returns the facts of a machine, or `None` for an unsupported number of balls. `positions` are those of its
    /// number of balls.
    pub fn of(machine: &Machine, positions: &BallPositions) -> Option<Self> {
        let form = RestForm::new(machine)?;
        let balance = Balance::of(&form);
        let dimension = machine.balls.len().saturating_sub(2);
        let stability =
            |beta: &[f64]| SmallMotions::about(&form, beta, HIGH_DRAG, dimension).stability;
        // At standstill no force acts, and every position is an equilibrium.
        let balance_stability = match balance.position() {
            Some(_) if form.speed == 0.0 => Some(Stability::Marginal),
            position => position.map(stability),
        };
        let capacity_kg_m = capacity_kg_m(machine);
        let imbalance_kg_m = machine.imbalance_mass_kg * machine.imbalance_radius_m;
        Some(BalancerFacts {
            natural_frequency_rad_s: machine.natural_frequency_rad_s(),
            speed_ratio: form.speed.abs(),
            capacity_kg_m,
            imbalance_kg_m,
            capacity_ratio: capacity_kg_m / imbalance_kg_m,
            gravity_over_friction: gravity_over_friction(machine),
            amplitude_without_balls_m: reference_amplitude(machine),
            balance,
            balance_stability,
            rest: RestFacts::of(machine, positions),
        })
    }

    /// Returns the absolute speed of the disc, rad/s.
    pub fn speed_rad_s(&self) -> f64 {
        self.speed_ratio * self.natural_frequency_rad_s
    }
}

/// Returns the largest imbalance that the balls of a machine can balance, `Σ m L`, kg m.
pub(super) fn capacity_kg_m(machine: &Machine) -> f64 {
    machine.balls.iter().map(|ball| ball.mass_kg).sum::<f64>() * machine.ring_radius_m
}

/// Standard gravity, m/s².
pub(super) const GRAVITY_M_S2: f64 = 9.806_65;

fn gravity_over_friction(machine: &Machine) -> Option<f64> {
    let coefficients = machine.balls.iter().map(|ball| ball.friction_coefficient);
    let most = coefficients.map(|value| machine.friction.largest_ratio(value)).fold(0.0, f64::max);
    let friction_m_s2 = most * machine.speed_rad_s.powi(2) * machine.ring_radius_m;
    let ratio = GRAVITY_M_S2 / friction_m_s2;
    (machine.friction.can_stick() && ratio.is_finite()).then_some(ratio)
}

impl RestFacts {
    /// Returns the facts, or `None` if friction cannot hold a ball, or for an unsupported number of balls.
    pub fn of(machine: &Machine, positions: &BallPositions) -> Option<Self> {
        if !machine.friction.can_stick() {
            return None;
        }
        let resolution = Resolution::choose(machine.balls.len(), None, None).ok()?;
        let set = EquilibriumSet::of(machine, resolution)?;
        Some(RestFacts {
            set_fraction: set.fraction,
            max_amplitude_m: set.amplitude_m.map(|(_, largest)| largest),
            overlapping_fraction: positions.overlapping_fraction(machine),
        })
    }
}

/// The facts of a system of one's own.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct OwnFacts {
    /// The natural frequencies.
    pub natural_frequencies: NaturalFrequencies,
    /// The speeds of the part that turns that equal a natural frequency, rad/s.
    pub critical_speeds_rad_s: Vec<f64>,
    /// The quantities that follow from the parameters alone.
    #[serde(serialize_with = "quantities_by_name")]
    pub derived: Vec<DerivedQuantity>,
    /// The steady states, if they are sought.
    pub steady_states: Option<SteadyStates>,
}

impl OwnFacts {
    /// Computes the facts of a model with these ranges of start states; `None` for a ball balancer.
    pub fn of(model: &Model, ranges: &[[f64; 2]]) -> Option<Self> {
        let Model::Own(own_model) = model else { return None };
        Some(OwnFacts {
            natural_frequencies: model.natural_frequencies(),
            critical_speeds_rad_s: CampbellDiagram::of(model)
                .map_or_else(Vec::new, |diagram| diagram.critical_rad_s),
            derived: own_model.derived(),
            steady_states: SteadyStates::of(model, ranges),
        })
    }
}

/// Writes values by name; a value that is not finite is null.
fn quantities_by_name<S: Serializer>(
    all: &[DerivedQuantity],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(all.iter().map(|quantity| (&quantity.name.name, quantity.value)))
}
