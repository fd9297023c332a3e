//! Operating conditions under which balls cannot balance a machine, such as a disc below the natural frequency, and
//! warnings of those that hold at all points.

use super::designs::{ExaminedDesign, ExtremeDesign, extreme_designs, points_to_examine};
use super::facts::capacity_kg_m;
use super::values::RPM;
use super::warning::Finding;
use crate::analysis::set_fraction;
use crate::model::{Machine, Model};
use crate::numbers::short;
use crate::optimize::Space;
use crate::study::{ParameterValue, Plan, Study};

/// The largest number of points whose values are examined.
const MOST_POINTS: u64 = 50;
/// The fraction of all positions above which friction holds the balls in practically every position. The estimated
/// fraction of three or more balls has an error of 0.005.
const HELD_EVERYWHERE: f64 = 0.99;
/// The number of further designs that are examined before friction counts as too large for all of them.
const DESIGNS: u32 = 8;

/// Returns the models at the examined points, with uncertain parameters at their medians, without impossible models.
pub(super) fn models(plan: &Plan) -> Vec<(u64, Model)> {
    let points = points_to_examine(plan.point_count(), MOST_POINTS);
    let model = |point| Some((point, plan.median_model(point).ok()?));
    points.into_iter().filter_map(model).collect()
}

/// Returns whether friction holds the balls in practically every position, if this fraction of all positions is in the
/// equilibrium set.
pub fn is_held_everywhere(set_fraction: f64) -> bool {
    set_fraction > HELD_EVERYWHERE
}

fn speed_ratio(machine: &Machine) -> f64 {
    machine.speed_rad_s.abs() / machine.natural_frequency_rad_s()
}

/// Returns the largest ratio of speed to natural frequency at the examined points; `None` if there is no disc.
fn fastest(plan: &Plan) -> Option<f64> {
    let models = models(plan);
    let ratios: Option<Vec<f64>> =
        models.iter().map(|(_, model)| model.ball_balancer().map(speed_ratio)).collect();
    ratios?.into_iter().reduce(f64::max)
}

/// Warns of a disc that is slower than the natural frequency at all points: of the study, or of some of its designs.
pub(super) fn subcritical(study: &Study, design: Option<&ExaminedDesign>) -> Option<Finding> {
    let (machines, found) = match design {
        None => {
            let most = fastest(study)?;
            let (_, model) = models(study).into_iter().next()?;
            let natural = model.natural_frequency_rad_s();
            let found =
                format!("at most {most:.3} times the natural frequency of {natural:.1} rad/s");
            (most < 1.0).then_some(("the disc is", found))?
        }
        Some(design) => {
            let [slow, fast] = extreme_designs(study, &design.values, fastest)?;
            let at = |ExtremeDesign { value, words }: &ExtremeDesign| match words.as_str() {
                "" => format!("{value:.3} times the natural frequency"),
                words => format!("{value:.3} times the natural frequency with {words}"),
            };
            match (slow.value < 1.0, fast.value < 1.0) {
                (_, true) => ("the disc of all designs is", format!("at most {}", at(&fast))),
                (true, false) => {
                    let found = format!("{}; {}", at(&slow), at(&fast));
                    ("the disc of some designs is", found)
                }
                (false, false) => return None,
            }
        }
    };
    let key = study.key_of("speed_rad_s", None, 0);
    let rpm = if study.key_with_unit(&key).is_some() { "" } else { RPM };
    Some(Finding {
        kind: "subcritical_speed",
        key,
        problem: format!(
            "{machines} slower than the natural frequency, where the balancing position of the balls is not stable"
        ),
        found,
        remedy: format!("a speed above the natural frequency, or a softer suspension{rpm}"),
    })
}

/// Warns of friction that holds the balls in every position, at all points and for all examined designs. A disc that
/// is slower than the natural frequency has a warning of its own.
pub(super) fn held_everywhere(study: &Study, design: Option<&ExaminedDesign>) -> Option<Finding> {
    let examined = design.map_or(study, |design| &design.study);
    // The balancing position of a slow disc is not stable, whatever the friction is.
    if fastest(examined)? < 1.0 {
        return None;
    }
    let held = machines_held_everywhere(examined)?;
    let space = Space::new(study);
    let mut others =
        (0..DESIGNS).filter_map(|index| study.set(&space.space_filling(index, 0)).ok());
    if design.is_some() && others.any(|other| machines_held_everywhere(&other).is_none()) {
        return None;
    }
    // Without an imbalance and with balls of hardly any mass, no coefficient is small enough.
    let all = largest_coefficient(&held, HELD_EVERYWHERE)?;
    let half = largest_coefficient(&held, 0.5).map_or_else(String::new, |half| {
        format!(", and below {half} to hold the balls in less than half of all positions")
    });
    let name = held.first()?.friction.limiting_coefficient();
    let points = match held.len() {
        1 => String::new(),
        points => format!(" at all {points} points"),
    };
    let of_design = design.map_or_else(String::new, |_| ", for all examined designs".to_owned());
    let coefficient = match coefficients(&held) {
        [low, high] if low == high => short(low),
        [low, high] => format!("{} to {}", short(low), short(high)),
    };
    Some(Finding {
        kind: "balls_held_everywhere",
        key: study.key_of(name, Some(1).filter(|_| name == "friction_coefficient"), 0),
        problem: "friction holds the balls in every position, so that no force moves them to the balancing position"
            .to_owned(),
        found: format!(
            "{coefficient}, where more than {:.0} % of all positions are positions of rest{points}{of_design}",
            100.0 * HELD_EVERYWHERE
        ),
        remedy: format!(
            "{name} below {all}{half}; heavier balls and a speed nearer to the natural frequency also help"
        ),
    })
}

/// Returns the smallest and the largest coefficient that limits friction.
fn coefficients(machines: &[Machine]) -> [f64; 2] {
    let of = |machine: &Machine| {
        let balls = machine.balls.iter().map(|ball| ball.friction_coefficient);
        let law = machine.friction;
        balls.map(move |kinetic| law.largest_ratio(kinetic)).collect::<Vec<f64>>()
    };
    let all: Vec<f64> = machines.iter().flat_map(of).collect();
    [all.iter().copied().fold(f64::INFINITY, f64::min), all.into_iter().fold(0.0, f64::max)]
}

/// Returns a coefficient with two digits, below those of all balls, such that with any smaller one friction holds the
/// balls of each machine in at most this fraction of all positions; `None` if none is small enough.
fn largest_coefficient(machines: &[Machine], fraction: f64) -> Option<ParameterValue> {
    let at_most = |coefficient: f64| {
        let of = |machine: &Machine| set_fraction(&with_coefficient(machine, coefficient));
        machines.iter().all(|machine| of(machine).is_some_and(|held| held <= fraction))
    };
    // The fraction rises with the coefficient.
    let [mut high, _] = coefficients(machines);
    let mut low = 1e-9 * high;
    if !at_most(low) {
        return None;
    }
    for _ in 0..16 {
        let middle = (low * high).sqrt();
        *(if at_most(middle) { &mut low } else { &mut high }) = middle;
    }
    let digit = 10.0_f64.powf(low.log10().floor() - 1.0);
    // A formatted number can always be parsed.
    let down = format!("{:.1e}", digit * (low / digit).floor()).parse().unwrap_or(low);
    Some(ParameterValue::Number(down))
}

/// Returns a machine with another coefficient that limits friction, equal for all balls.
fn with_coefficient(machine: &Machine, coefficient: f64) -> Machine {
    let mut machine = machine.clone();
    let name = machine.friction.limiting_coefficient();
    machine.friction.value_mut(name).into_iter().for_each(|value| *value = coefficient);
    for ball in &mut machine.balls {
        ball.friction_coefficient = coefficient;
    }
    machine
}

/// Returns the machines at the examined points, or `None` if friction leaves positions without rest at one of them.
fn machines_held_everywhere(plan: &Plan) -> Option<Vec<Machine>> {
    let models = models(plan);
    let held = |(_, model): &(u64, Model)| {
        let machine = model.ball_balancer()?;
        let held = machine.friction.can_stick()
            && machine.speed_rad_s != 0.0
            && is_held_everywhere(set_fraction(machine)?);
        held.then(|| machine.clone())
    };
    let machines: Option<Vec<Machine>> = models.iter().map(held).collect();
    machines.filter(|machines| !machines.is_empty())
}

/// A reason why balls do not balance a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// The disc is slower than the natural frequency, where the balancing position is not stable.
    SlowDisc,
    /// The balls are too light to balance the imbalance in any position.
    LightBalls,
    /// Friction holds the balls in every position.
    HeldBalls,
}

impl Obstacle {
    /// All obstacles, in the order in which they are examined.
    pub const ALL: [Self; 3] = [Self::SlowDisc, Self::LightBalls, Self::HeldBalls];

    /// Returns the first obstacle of a machine whose equilibrium set is this fraction of all positions; `None` if closed
    /// forms show none.
    pub fn of(machine: &Machine, set_fraction: Option<f64>) -> Option<Self> {
        let imbalance_kg_m = machine.imbalance_mass_kg * machine.imbalance_radius_m;
        let is_there = |obstacle: &Self| match obstacle {
            Self::SlowDisc => machine.speed_rad_s.abs() < machine.natural_frequency_rad_s(),
            Self::LightBalls => capacity_kg_m(machine) < imbalance_kg_m,
            Self::HeldBalls => set_fraction.is_some_and(is_held_everywhere),
        };
        Self::ALL.into_iter().find(is_there)
    }
}
