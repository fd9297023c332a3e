//! One state in which nothing moves but along translations that no equation notices: Newton's method finds it, and its eigenvalues
//! say whether small motions about it decay.

use indexmap::IndexMap;
use nalgebra::{Complex, Dyn, SVD};
use serde::Serialize;

use crate::analysis::{SmallMotions, Stability};
use crate::model::{Model, Translations, Units, wrap_to_two_pi};
use crate::motion::{Direction, Evaluator, Phase, Phases, ReducedEquations};

/// The most steps of Newton's method, and the size of the last of them, over 1 and the largest component.
const MOST_STEPS: usize = 30;
const THERE: f64 = 1e-10;
/// The most iterations of a decomposition.
const MOST_ITERATIONS: usize = 10_000;
/// Steady states nearer to each other than this, non-dimensional, are one.
pub(super) const SAME: f64 = 1e-6;
/// Real parts of eigenvalues up to this, over the norm of the matrix, are rounding.
const ROUNDING: f64 = 1e-9;
/// Singular values up to this, over the largest one, are rounding.
const SINGULAR: f64 = 1e-13;
/// Contacts that slide more slowly than this, non-dimensional, while no coordinate moves, stick.
const STILL: f64 = 1e-12;

/// A steady state in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteadyValues {
    /// The value of each coordinate, or the speed at which it moves on, by its name with the unit.
    pub coordinates: IndexMap<String, f64>,
    /// The dimension of the continuous family of states that it belongs to; 0 if it is isolated.
    pub family_dimension: usize,
    /// The largest real part of the eigenvalues of small motions, 1/s.
    pub largest_real_part_1_s: f64,
    /// The stability against small disturbances, without those along the family.
    pub stability: Stability,
    /// The eigenvalues of small motions, 1/s, with descending real parts.
    #[serde(skip)]
    pub eigenvalues_1_s: Vec<Complex<f64>>,
}

/// A state in which nothing moves but along translations that no equation notices.
pub(super) struct SteadyState<'e> {
    evaluator: &'e Evaluator,
    reduced: ReducedEquations<'e>,
    state: Vec<f64>,
}

impl<'e> SteadyState<'e> {
    /// Returns `None` if a contact may stick whose sliding speed is no component of the state, or if a component, such as the
    /// time, moves by itself.
    pub(super) fn new(
        evaluator: &'e Evaluator,
        translations: &Translations,
        state: Vec<f64>,
    ) -> Option<Self> {
        let system = evaluator.system();
        let phase = |(contact, speed): (usize, &f64)| match speed.abs() <= STILL {
            _ if !system.friction(contact).can_stick() => Phase::Free,
            true => Phase::Stick,
            false => Phase::Slip(Direction::of(*speed)),
        };
        let phases: Phases = evaluator.speeds(&state).iter().enumerate().map(phase).collect();
        SteadyState::of(evaluator, translations, state, &phases)
    }

    /// Returns a state of the system without dry friction; `None` if a component, such as the time, moves by itself.
    pub(super) fn without_dry_friction(
        evaluator: &'e Evaluator,
        translations: &Translations,
        state: Vec<f64>,
    ) -> Option<Self> {
        let mut phases = evaluator.no_phases();
        phases.fill(Phase::Free);
        SteadyState::of(evaluator, translations, state, &phases)
    }

    fn of(
        evaluator: &'e Evaluator,
        translations: &Translations,
        state: Vec<f64>,
        phases: &[Phase],
    ) -> Option<Self> {
        let graph = evaluator.graph();
        let has_speed =
            |(contact, phase)| phase != &Phase::Stick || graph.speed_component(contact).is_some();
        let rates = evaluator.rates(phases, &state);
        let velocities = || graph.layout.velocities.iter().flatten();
        let runs = |place: usize| {
            graph.is_clock(place) && rates[place] != 0.0 && !velocities().any(|one| *one == place)
        };
        if !phases.iter().enumerate().all(has_speed)
            || (0..state.len()).any(|place| runs(place) && !translations.displace(place))
        {
            return None;
        }
        let reduced = ReducedEquations::new(evaluator, phases, translations);
        Some(SteadyState { evaluator, reduced, state })
    }

    /// Returns whether a contact sticks.
    pub(super) fn sticks(&self) -> bool {
        self.reduced.phases.contains(&Phase::Stick)
    }

    /// Changes the variables to where their rates vanish; returns whether there is such a place.
    pub(super) fn settles(&mut self) -> bool {
        let (mut is_there, mut steepness) = (self.reduced.variables.is_empty(), 1.0_f64);
        for _ in 0..MOST_STEPS {
            if is_there {
                break;
            }
            // In a family of equilibria, the shortest step is taken.
            let Some(slopes) = self.decomposed() else { return false };
            steepness = slopes.singular_values.amax().max(1.0);
            let rates = -self.reduced.rates(&self.state);
            let Ok(step) = slopes.solve(&rates, SINGULAR * steepness) else { return false };
            if !step.iter().all(|entry| entry.is_finite()) {
                return false;
            }
            self.reduced.displace(&mut self.state, &step);
            let variables = self.reduced.variables.iter();
            let largest = variables.fold(1.0_f64, |most, of| most.max(self.state[*of].abs()));
            is_there = step.amax() <= THERE * largest;
        }
        // A component that only time moves is no steady state.
        let rates = self.reduced.all_rates(&self.state);
        let vanishes = |(place, rate): (usize, &f64)| {
            let is_variable = self.reduced.variables.contains(&place);
            rate.abs() <= if is_variable { THERE * steepness } else { THERE }
        };
        is_there && rates.iter().enumerate().all(vanishes)
    }

    /// Returns the singular values of the derivatives of the rates; `None` without a variable, or if an entry is not finite.
    fn decomposed(&self) -> Option<SVD<f64, Dyn, Dyn>> {
        let slopes = self.reduced.slopes(&self.state);
        let is_sound = !slopes.is_empty() && slopes.iter().all(|entry| entry.is_finite());
        is_sound.then(|| SVD::try_new(slopes, true, true, f64::EPSILON, MOST_ITERATIONS)).flatten()
    }

    /// Returns whether all contacts are pressed together and slide as assumed.
    pub(super) fn holds(&self) -> bool {
        let forces = self.evaluator.forces(&self.reduced.phases, &self.state);
        forces.iter().zip(&self.reduced.phases).all(|(force, phase)| {
            // A sliding speed that contains positions may have another direction here.
            let slides_so = match phase {
                Phase::Slip(direction) => *direction * force.speed > STILL,
                Phase::Stick => force.speed.abs() <= STILL,
                _ => true,
            };
            force.normal > 0.0 && slides_so
        })
    }

    /// Returns the smallest unused fraction of the friction limit of a contact that sticks, or `None` if a contact is not pressed
    /// together, slides in another way than assumed, or has no limit.
    pub(super) fn friction_margin(&self) -> Option<f64> {
        let phases = &self.reduced.phases;
        let stuck: Vec<usize> =
            (0..phases.len()).filter(|contact| phases[*contact] == Phase::Stick).collect();
        let margin = self.evaluator.friction_margin(phases, &self.state, &stuck);
        (self.holds() && margin.is_finite()).then_some(margin)
    }

    /// Returns the coordinates in SI units; angles are within one turn.
    pub(super) fn coordinates(&self, units: &Units) -> Vec<f64> {
        let count = self.evaluator.graph().layout.velocities.iter().flatten().count();
        let outputs = self.evaluator.system().outputs(&self.state).into_iter().take(count);
        let in_units = outputs.zip(&units.outputs).map(|(value, units)| match units.angular {
            true => within_a_turn(value) * units.size,
            false => value * units.size,
        });
        in_units.collect()
    }

    /// Returns the numbers and values of the outputs that do not change, non-dimensional: of a coordinate that a translation displaces
    /// its rate of change, otherwise the coordinate. Angles that go round and round are within one turn.
    fn constants(&self, units: &Units) -> Vec<(usize, f64)> {
        let outputs = |state: &[f64]| self.evaluator.system().outputs(state);
        let now = outputs(&self.state);
        // A kind in Rust may have no outputs.
        let count =
            now.len().min(self.evaluator.graph().layout.velocities.iter().flatten().count());
        let displaced = self.reduced.translations.changed(&self.state, outputs);
        let constant = |number: usize| match displaced[number] {
            true => {
                let rate = count + number;
                (rate, now.get(rate).copied().unwrap_or_default())
            }
            false if units.outputs.get(number).is_some_and(|units| units.angular) => {
                (number, within_a_turn(now[number]))
            }
            false => (number, now[number]),
        };
        // Newton's method leaves a rounding error of zeros.
        let exact = |(number, value): (usize, f64)| {
            (number, if value.abs() < f64::EPSILON { 0.0 } else { value })
        };
        (0..count).map(constant).map(exact).collect()
    }

    /// Returns the values of the state, and numbers that are equal in equal states. Of motions that go on, only speeds are known;
    /// those with equal speeds differ in their stability.
    pub(super) fn values(&self, model: &Model, units: &Units) -> Option<(SteadyValues, Vec<f64>)> {
        let slopes = self.reduced.slopes(&self.state);
        let singular = self.decomposed()?.singular_values;
        let vanishes = |value: &&f64| **value <= SINGULAR * singular.amax();
        let family_dimension = singular.iter().filter(vanishes).count();
        let SmallMotions { eigenvalues, stability } =
            SmallMotions::of(&slopes, ROUNDING * slopes.norm(), family_dimension);
        let constants = self.constants(units);
        let names = model.output_names();
        let named = |(number, value): &(usize, f64)| {
            let (output, units) = (names.get(*number)?, units.outputs.get(*number)?);
            Some((output.name.clone(), value * units.size))
        };
        let values = SteadyValues {
            coordinates: constants.iter().filter_map(named).collect(),
            family_dimension,
            largest_real_part_1_s: eigenvalues.first()?.re * units.natural_rad_s,
            stability,
            eigenvalues_1_s: eigenvalues.iter().map(|value| value * units.natural_rad_s).collect(),
        };
        let place = match family_dimension {
            0 => {
                let goes_on = self.reduced.translations != Translations::default();
                let rate = goes_on.then_some(values.largest_real_part_1_s);
                constants.iter().map(|(_, value)| *value).chain(rate).collect()
            }
            // Of a family, one state is reported.
            dimension => vec![dimension as f64, stability as u8 as f64],
        };
        Some((values, place))
    }
}

/// Returns an angle in [0, 2π), where an angle that is 2π but for rounding is 0.
fn within_a_turn(angle: f64) -> f64 {
    let angle = wrap_to_two_pi(angle);
    if std::f64::consts::TAU - angle < SAME { 0.0 } else { angle }
}
