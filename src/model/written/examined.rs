//! What the values of the parameters say about a system of a file: whether it is sound, its friction, and its start states.

use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use super::definition::{COEFFICIENT, SystemDefinition, WrittenDerived};
use super::evaluate::Bodies;
use super::formula::{Dimension, Formula, NONE, Valued, WHOLE};
use super::given_terms::GivenTerms;
use super::instance::Instance;
use super::numeric::{NamedValues, Scales};
use super::sizes::Sizes;
use super::state_units::StateUnits;
use super::system::WrittenSystem;
use super::velocities::{Rates, SpeedOf};
use crate::model::invalid_parameter::{invalid, not_negative};
use crate::model::{FRICTION_COEFFICIENT, FrictionLaw, ImpactLaw, InvalidParameter, SlidingSpeed};

/// A system with values of its parameters.
pub(super) struct ExaminedSystem {
    /// The system without dimensions.
    pub system: Arc<WrittenSystem>,
    /// The unit of the sliding speed of each contact, in SI units.
    pub speeds: Vec<f64>,
    /// The dimension of each output.
    pub outputs: Vec<Dimension>,
    /// The first value without physical meaning.
    pub sound: Result<(), InvalidParameter>,
    /// The system from a time, non-dimensional, on, if its equations do not depend on the time any more then.
    pub lasting: OnceLock<Option<(f64, Arc<WrittenSystem>)>>,
}

/// The inertia, without dimensions, below which a contact has a unit of force of its own.
const SMALL_INERTIA: f64 = 1.0 / 16.0;

/// Returns the unit of the forces of a contact from the inertia that slides: a power of two, so that conversion is exact.
fn unit_of_force(inertia: f64) -> f64 {
    let is_small = inertia > 0.0 && inertia < SMALL_INERTIA;
    if is_small { libm::ldexp(1.0, libm::round(libm::log2(inertia)) as i32) } else { 1.0 }
}

impl ExaminedSystem {
    /// Examines a system with these values of its parameters, in SI units, and the law of friction of the study; `number` is
    /// that of its definition.
    pub fn new(
        instance: Arc<Instance<'static>>,
        number: usize,
        values: &[f64],
        of_study: &FrictionLaw,
    ) -> Valued<Self> {
        let definition = instance.definition;
        let period = instance.period_s(values)?;
        let sizes = instance.sizes(values, period)?;
        let scales = sizes.scales;
        let parameters = definition.parameters.iter().zip(values);
        let scaled: Vec<f64> =
            parameters.map(|(given, value)| value / scales.unit(given.unit.dimension)).collect();
        let named = instance.parameters(&scaled, scales, 0.0);
        let numeric = NamedValues { scales, parameters: &named, coordinates: &[], time: 0.0 };
        let speed_of = instance.choose_velocities(numeric)?;
        let moving = instance.rates(&speed_of, numeric)?;
        let integrals = instance.choose_positions(&speed_of, numeric)?;
        let chosen = (&moving, &speed_of[..], &integrals[..]);
        let units = StateUnits::new((&instance, values, &sizes), chosen)?;
        let unit_of_speed = |number: usize| {
            let unit = scales.unit(instance.speed_dimension(number).map_err(|(_, fault)| fault)?);
            let unit = unit * units.contacts[number];
            let multiple = instance.multiple((number, speed_of[number]), &moving, numeric)?;
            Ok(unit * multiple.unwrap_or(1.0))
        };
        let speeds = (0..instance.contacts.len()).map(unit_of_speed);
        let speeds = speeds.collect::<Result<Vec<_>, _>>()?;
        let outputs = (0..instance.outputs.len()).map(|number| {
            let (output, bodies) = instance.output(number);
            instance.dimension(&output.formula, bodies)
        });
        let outputs = outputs.collect::<Result<Vec<_>, _>>()?;
        let Sizes { middle, reach, is_finite, without_energy, rates, .. } = sizes;
        let second = scales.unit([0, 0, WHOLE]) * units.time;
        let (mut friction, mut impacts, mut sound) = (Vec::new(), Vec::new(), Ok(()));
        let (largest_force, force_units) =
            instance.sizes_of_forces(&scaled, (scales, &units), &middle, (&moving, &speed_of))?;
        for (number, &speed) in speeds.iter().enumerate() {
            let (law, coefficient) = instance.law(number, values, of_study)?;
            let impact = instance.impact_law(number, values)?;
            let checked =
                check_contact(&law, coefficient, impact).map_err(|invalid| InvalidParameter {
                    name: format!(
                        "{} of contact {}",
                        invalid.name,
                        instance.contact_definition(number).name
                    ),
                    ..invalid
                });
            sound = sound.and(checked);
            let power = scales.unit([WHOLE, 2 * WHOLE, -3 * WHOLE]) * units.power;
            let drag = force_units[number] * power / (speed * speed);
            friction.push(law.contact(coefficient, speed, drag));
            impacts.push(impact);
        }
        if !is_finite {
            let found = "not finite in the middle of the start ranges";
            sound = Err(invalid("a mass or a force", found, "a finite number there"));
        } else if let Some(number) = without_energy {
            let coordinate = &instance.coordinate(number).name;
            let found = format!(
                "not positive definite in the middle of the start ranges, in the row of {coordinate}"
            );
            let allowed = "a symmetric matrix with positive kinetic energies";
            sound = Err(invalid("mass", &found, allowed));
        }
        if let Some(period) = period.filter(|period| !(period.is_finite() && *period > 0.0)) {
            sound = Err(invalid("period", &period.to_string(), "a positive, finite time"));
        }
        let aside = |part: f64| {
            let each = middle.iter().zip(&reach);
            let moved = |(middle, reach): (&[f64; 2], &[f64; 2])| {
                [0, 1].map(|which| {
                    middle[which] + part * if reach[which] > 0.0 { reach[which] } else { 1.0 }
                })
            };
            each.map(moved).collect::<Vec<_>>()
        };
        let states = [middle.clone(), aside(0.29), aside(-0.37)];
        if let (Some(period), true) = (period, sound.is_ok())
            && !instance.repeats(values, &states, (period, None))?
        {
            sound = Err(match (&definition.period, &definition.turning) {
                (None, Some(turning)) => {
                    let found = format!(
                        "{}, but not all formulas are the same after a turn",
                        turning.angle
                    );
                    let allowed =
                        "the angle in sines and cosines, without the time t, or the key `period`";
                    invalid("turning", &found, allowed)
                }
                _ => invalid(
                    "period",
                    &period.to_string(),
                    "the time after which all formulas repeat",
                ),
            });
        }
        for number in 0..instance.coordinates.len() {
            let coordinate = instance.coordinate(number);
            if coordinate.periodic && !instance.repeats(values, &states, (1.0, Some(number)))? {
                let found = "periodic, but not all formulas are the same after a turn";
                sound = Err(invalid(&coordinate.name, found, "a coordinate without `periodic`"));
            }
        }
        for WrittenDerived { quantity, within, .. } in &definition.derived {
            let Some([low, high]) = within else { continue };
            let value = instance.constant(&quantity.formula, values)?;
            let [low, high] = [instance.constant(low, values)?, instance.constant(high, values)?];
            if !(low..=high).contains(&value) {
                let meaning = &quantity.meaning;
                let found = format!("{value}, which is not between {low} and {high} ({meaning})");
                let allowed = "parameters with which this quantity is within its range";
                sound = Err(invalid(&quantity.name, &found, allowed));
            }
        }
        let coordinates = [instance.rates(&integrals, numeric)?.without_constants(), moving];
        let mut system = WrittenSystem {
            lasting: None,
            has_one_solution: false,
            measured: OnceLock::new(),
            number,
            friction,
            impacts,
            period: period.map(|period| period / second),
            stage: GivenTerms::at_rest(instance.definition, scales),
            speeds: speed_of,
            integrals,
            coordinates,
            rates: rates.map(|rate| rate * second),
            largest_force,
            force_units,
            values: scaled,
            scales,
            units,
            instance,
        };
        system.has_one_solution = sound.is_ok() && system.always_decides_in_one_way();
        let (system, lasting) = (Arc::new(system), OnceLock::new());
        Ok(ExaminedSystem { system, speeds, outputs, sound, lasting })
    }

    /// Returns a start state in the components of the system: positions, velocities, and the time if the equations contain it.
    pub fn start_state(&self, start: &[f64]) -> Valued<Vec<f64>> {
        let WrittenSystem { instance, scales, units, values, speeds, integrals, .. } =
            &*self.system;
        let (positions, rates) = start.split_at(instance.coordinates.len().min(start.len()));
        let state: Vec<[f64; 2]> =
            positions.iter().zip(rates).map(|(position, rate)| [*position, *rate]).collect();
        let state = instance.scaled(*scales, &state);
        let parameters = instance.parameters(values, *scales, 0.0);
        let coordinates = instance.named(|number| state[number]);
        let mut numeric = NamedValues {
            scales: *scales,
            parameters: &parameters,
            coordinates: &coordinates,
            time: 0.0,
        };
        let mut places: Vec<f64> = state.iter().map(|[position, _]| *position).collect();
        let mut velocities: Vec<f64> = state.iter().map(|[_, rate]| *rate).collect();
        for (number, speed) in speeds.iter().enumerate() {
            if let SpeedOf::Velocity(place) = integrals[number]
                && let Some(form) = instance.linear(number, numeric)?
            {
                places[place] =
                    form.factors.iter().map(|(of, factor)| factor * state[*of][0]).sum();
            }
            let (contact, mut bodies) = instance.contact(number);
            if let (SpeedOf::Velocity(place), Some(sliding)) = (speed, &contact.sliding) {
                velocities[*place] = bodies.evaluate(sliding, &mut numeric)?;
            }
        }
        let clock = self.system.has_clock().then_some(0.0);
        let all = places.into_iter().chain(velocities);
        let in_units = all.zip(units.positions.iter().chain(&units.velocities));
        Ok(in_units.map(|(value, unit)| value / unit).chain(clock).collect())
    }
}

/// Checks the values of a contact.
fn check_contact(
    law: &FrictionLaw,
    coefficient: f64,
    impact: ImpactLaw,
) -> Result<(), InvalidParameter> {
    not_negative(COEFFICIENT, coefficient)?;
    law.validate(coefficient, SlidingSpeed::MS)?;
    let both = [impact.restitution, impact.tangential_restitution];
    match both.iter().find(|number| !(0.0..=1.0).contains(*number)) {
        Some(found) => Err(invalid("restitution", &found.to_string(), "a number from 0 to 1")),
        None => Ok(()),
    }
}

impl Instance<'_> {
    /// Returns the law of friction of a contact and its coefficient, in SI units.
    fn law(
        &self,
        number: usize,
        values: &[f64],
        of_study: &FrictionLaw,
    ) -> Valued<(FrictionLaw, f64)> {
        let (contact, bodies) = self.contact(number);
        if contact.has_law_of_study {
            let is_it = |(name, ..): &(&str, usize, f64)| *name == FRICTION_COEFFICIENT;
            let coefficient =
                self.parameters(values, Scales::default(), 0.0).into_iter().find(is_it);
            return Ok((*of_study, coefficient.map_or(0.0, |(.., value)| value)));
        }
        let Some(friction) = &contact.friction else {
            // No force, and no stick either.
            return Ok((FrictionLaw::viscous(0.0), 0.0));
        };
        let constant = |formula: &Formula| self.constant_of(&bodies, formula, values);
        let constants = friction.values.iter().map(constant).collect::<Result<Vec<_>, _>>()?;
        Ok((FrictionLaw::new(friction.law, &constants), constant(&friction.coefficient)?))
    }

    /// Returns the law of impact of a contact.
    fn impact_law(&self, number: usize, values: &[f64]) -> Valued<ImpactLaw> {
        let (contact, bodies) = self.contact(number);
        let [normal, tangential] = &contact.restitution;
        Ok(ImpactLaw {
            restitution: self.constant_of(&bodies, normal, values)?,
            tangential_restitution: self.constant_of(&bodies, tangential, values)?,
            ..ImpactLaw::default()
        })
    }

    /// Returns the largest force in the middle of the start ranges, without dimensions, and the unit of the forces of each
    /// contact. A contact of a small body has a unit of its own, because its forces are small against those on large bodies.
    fn sizes_of_forces(
        &self,
        scaled: &[f64],
        (scales, state_units): (Scales, &StateUnits),
        middle: &[[f64; 2]],
        (moving, speeds): (&Rates<f64>, &[SpeedOf]),
    ) -> Valued<(f64, Vec<f64>)> {
        let (parameters, middle) =
            (self.parameters(scaled, scales, 0.0), self.scaled(scales, middle));
        let coordinates = self.named(|number| middle[number]);
        let mut numeric =
            NamedValues { scales, parameters: &parameters, coordinates: &coordinates, time: 0.0 };
        let (mass, mut forces) = self.mass_and_forces(&mut numeric)?;
        let mut inertia = moving.between(&mass);
        state_units.convert_inertia(&mut inertia);
        state_units.convert_forces(&mut forces);
        let mut units = Vec::with_capacity(speeds.len());
        for (number, speed) in speeds.iter().enumerate() {
            let (contact, mut bodies) = self.contact(number);
            let ("normal", force) = contact.normal.entry() else {
                units.push(1.0);
                continue;
            };
            let unit = match speed {
                SpeedOf::Velocity(place) | SpeedOf::Same(place) | SpeedOf::Multiple(place) => {
                    unit_of_force(inertia[*place][*place])
                }
                SpeedOf::Formula => 1.0,
            };
            let force = bodies.evaluate(force, &mut numeric)? * state_units.force_factor(number);
            forces.push(force / unit);
            units.push(unit);
        }
        let sizes = forces.into_iter().map(f64::abs).filter(|size| size.is_finite());
        Ok((sizes.fold(0.0, f64::max), units))
    }

    /// Returns whether the equations at some states and times are the same after a time, or after a turn of a coordinate.
    fn repeats(
        &self,
        values: &[f64],
        states: &[Vec<[f64; 2]>],
        (period, turned): (f64, Option<usize>),
    ) -> Valued<bool> {
        let mut pairs: Vec<[Vec<f64>; 2]> = Vec::new();
        for state in states {
            for part in [0.1, 0.37, 0.83] {
                let time = part * period;
                let mut later = state.clone();
                let mut after = time + period;
                if let Some(coordinate) = turned {
                    later[coordinate][0] += TAU;
                    after = time;
                }
                pairs.push([
                    self.all_at(values, state, (time, part))?,
                    self.all_at(values, &later, (after, part))?,
                ]);
            }
        }
        let count = pairs.first().map_or(0, |[now, _]| now.len());
        Ok((0..count).all(|place| {
            let entries = || pairs.iter().map(|pair| [pair[0][place], pair[1][place]]);
            let size = entries().flatten().fold(0.0_f64, |size, entry| size.max(entry.abs()));
            entries().all(|[now, later]| (now - later).abs() <= 1e-9 * size || !size.is_finite())
        }))
    }

    /// Returns the values of all formulas of the equations at a time; given motions and their rates of change are so far from
    /// rest at their last values.
    pub fn all_at(
        &self,
        values: &[f64],
        state: &[[f64; 2]],
        (time, far): (f64, f64),
    ) -> Valued<Vec<f64>> {
        let mut parameters = self.parameters(values, Scales::default(), time);
        for (name, primes, value) in &mut parameters {
            if self.definition.motions.iter().any(|motion| motion.name == *name) {
                *value += far * (1.0 + *primes as f64);
            }
        }
        let mut coordinates = self.named(|number| state[number]);
        // Normal forces may contain accelerations.
        for (number, (.., values)) in coordinates.iter_mut().enumerate() {
            values[2] = 1.0 + 0.3 * number as f64;
        }
        let mut numeric = NamedValues {
            scales: Scales::default(),
            parameters: &parameters,
            coordinates: &coordinates,
            time,
        };
        let (mass, mut all) = self.mass_and_forces(&mut numeric)?;
        all.extend(mass.into_iter().flatten());
        for number in 0..self.contacts.len() {
            let (contact, mut bodies) = self.contact(number);
            for formula in contact.sliding.iter().chain([contact.normal.entry().1]) {
                all.push(bodies.evaluate(formula, &mut numeric)?);
            }
        }
        Ok(all)
    }

    /// Returns positions and rates in the units of the motion.
    fn scaled(&self, scales: Scales, state: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let members = self.coordinates.iter().zip(state);
        let scaled = members.map(|(member, [position, rate])| {
            let [mass, length, time] = self.definition.coordinates[member.of].unit.dimension;
            let rate_unit = scales.unit([mass, length, time - WHOLE]);
            [position / scales.unit([mass, length, time]), rate / rate_unit]
        });
        scaled.collect()
    }

    /// Returns the value of a formula of parameters.
    pub fn constant(&self, formula: &Formula, values: &[f64]) -> Valued<f64> {
        self.constant_of(&self.bodies, formula, values)
    }

    /// Returns the value of a formula of parameters for a body.
    fn constant_of(&self, bodies: &Bodies, formula: &Formula, values: &[f64]) -> Valued<f64> {
        let parameters = self.parameters(values, Scales::default(), 0.0);
        let mut numeric = NamedValues {
            scales: Scales::default(),
            parameters: &parameters,
            coordinates: &[],
            time: 0.0,
        };
        bodies.clone().evaluate(formula, &mut numeric)
    }
}

impl SystemDefinition {
    /// Returns whether a coordinate or a parameter has a unit, so that dimensions are checked.
    pub(super) fn has_units(&self) -> bool {
        let coordinates = self.coordinates.iter().map(|coordinate| &coordinate.unit);
        let mut units = coordinates.chain(self.parameters.iter().map(|parameter| &parameter.unit));
        units.any(|unit| unit.dimension != NONE)
    }
}
