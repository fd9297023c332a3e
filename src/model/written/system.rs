//! A system of a file as one that the program computes: its record, its inputs and its rates.

use std::any::{Any, TypeId};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::{Arc, OnceLock};

use super::definition::{WrittenMotion, WrittenNormal};
use super::formula::{Valued, WHOLE};
use super::given_terms::GivenTerms;
use super::instance::Instance;
use super::measured::MeasuredQuantities;
use super::numeric::{NamedValues, Scalar, Scales};
use super::state_units::StateUnits;
use super::velocities::{Rates, SpeedOf};
use crate::model::{
    Components, ContactMode, Expression, Friction, Graph, ImpactLaw, Mechanism, MechanismContact,
    MechanismNormal, Number, Recorder, StageMotion, Structure, System, SystemEquations,
    add_mechanism_inputs, stiff_rate,
};

/// The times from which on equations may last: powers of the square root of 2, non-dimensional.
const HALF_POWERS: std::ops::Range<i32> = -20..80;
/// The time at which equations that last are evaluated, over that from which on they last.
const MUCH_LATER: f64 = 1e3;

/// A system of a file with values of its parameters, without dimensions.
#[derive(Clone, Debug)]
pub(super) struct WrittenSystem {
    pub instance: Arc<Instance<'static>>,
    /// A number for each definition of the process.
    pub number: usize,
    pub scales: Scales,
    /// The units of the state over those of the formulas.
    pub units: StateUnits,
    /// The values of the parameters, in the units of `scales`.
    pub values: Vec<f64>,
    pub friction: Vec<Friction>,
    pub impacts: Vec<ImpactLaw>,
    /// How the sliding speed of each contact is computed.
    pub speeds: Vec<SpeedOf>,
    /// Which of these velocities have integrals that are positions.
    pub integrals: Vec<SpeedOf>,
    /// The coordinates as functions of the positions, and their rates of change as functions of the velocities.
    pub coordinates: [Rates<f64>; 2],
    /// The period after which the equations repeat, if they depend on the time.
    pub period: Option<f64>,
    /// The time at which the equations are evaluated, in a stage in which they no longer depend on it.
    pub lasting: Option<f64>,
    /// How the part that turns and the given motions move in a stage.
    pub stage: GivenTerms<f64>,
    /// The highest frequency, and the largest rate of damping, of motions without friction.
    pub rates: [f64; 2],
    pub largest_force: f64,
    /// The unit of the forces of each contact, a power of two: the inertia that slides if it is far below 1, otherwise 1.
    pub force_units: Vec<f64>,
    /// Whether stick and slip are surely decided in one way in all states.
    pub has_one_solution: bool,
    /// What the file measures, once it is recorded; nothing if a formula has a fault.
    pub measured: OnceLock<Option<Arc<MeasuredQuantities>>>,
}

/// A state that is being recorded, with the values of all names as functions of it.
pub(super) struct RecordedState<'a, 'r> {
    positions: Vec<Expression<'r>>,
    speeds: Vec<Expression<'r>>,
    /// The time or the phase of a periodic force, and its rate of change.
    clock: Option<[Expression<'r>; 2]>,
    /// The coordinates, and their rates of change.
    coordinates: [Vec<Expression<'r>>; 2],
    rates: Rates<Expression<'r>>,
    /// The values of names without those of the coordinates.
    base: NamedValues<'a, Expression<'r>>,
    /// The values of all names.
    values: NamedValues<'a, Expression<'r>>,
}

impl WrittenSystem {
    /// Records a state, and computes with it.
    pub(super) fn in_recorded_state<'r, R>(
        &self,
        recorder: &'r Recorder,
        compute: impl FnOnce(RecordedState<'_, 'r>) -> Valued<R>,
    ) -> Valued<R> {
        let (instance, n) = (&self.instance, self.instance.coordinates.len());
        let positions: Vec<_> = (0..n).map(|_| recorder.state()).collect();
        let speeds: Vec<_> = (0..n).map(|_| recorder.state()).collect();
        let clock = self.has_clock().then(|| recorder.state());
        let (zero, one) = (Expression::constant(0.0), Expression::constant(1.0));
        // A parameter that is 0 often removes whole terms.
        let parameters = instance.definition.parameters.iter().zip(&self.values);
        let values = parameters.map(|(parameter, value)| {
            let input = recorder.parameter(&parameter.name);
            if *value == 0.0 { zero } else { input }
        });
        let values: Vec<_> = values.collect();
        let [time, rate] = match (clock, self.period) {
            (Some(phase), Some(_)) => {
                let [unit, rate] = ["per_radian", "frequency"].map(|name| recorder.parameter(name));
                [phase * unit, rate]
            }
            (Some(time), None) => [time, one],
            (None, _) => [self.lasting.map_or(zero, |_| recorder.parameter("lasting")), zero],
        };
        let time = time.in_unit(self.units.time);
        let stage = self.stage.map(|_| recorder.parameter("stage"));
        let parameters = instance.parameters_in_stage(&values, &stage, time);
        let at_rest = instance.named(|_| [zero; 2]);
        let base = NamedValues {
            scales: self.scales,
            parameters: &parameters,
            coordinates: &at_rest,
            time,
        };
        let rates = instance.rates(&self.speeds, base)?;
        let moving = rates.at(&self.units.velocities_of(&speeds));
        let shapes = instance.rates(&self.integrals, base)?.without_constants();
        let shapes = shapes.at(&self.units.positions_of(&positions));
        let named = instance.named(|number| [shapes[number], moving[number]]);
        let values = NamedValues { coordinates: &named, ..base };
        let (clock, coordinates) = (clock.map(|clock| [clock, rate]), [shapes, moving]);
        compute(RecordedState { positions, speeds, clock, coordinates, rates, base, values })
    }

    /// Records the coordinates, their rates of change and the outputs of the file.
    fn measured_quantities<'r>(&self, recorder: &'r Recorder) -> Valued<Vec<Expression<'r>>> {
        self.in_recorded_state(recorder, |state| {
            let RecordedState { mut coordinates, mut values, .. } = state;
            self.units.convert_coordinates(&mut coordinates);
            let mut quantities = coordinates.concat();
            for number in 0..self.instance.outputs.len() {
                let (output, mut bodies) = self.instance.output(number);
                quantities.push(bodies.evaluate(&output.formula, &mut values)?);
            }
            Ok(quantities)
        })
    }

    /// Returns what the file measures; nothing if a formula has a fault.
    fn measured(&self) -> Option<&MeasuredQuantities> {
        let record = || MeasuredQuantities::of(|recorder| self.measured_quantities(recorder));
        self.measured.get_or_init(|| record().map(Arc::new).ok()).as_deref()
    }

    fn mechanism<'r>(
        &self,
        recorder: &'r Recorder,
        state: RecordedState<'_, 'r>,
    ) -> Valued<Mechanism<'r>> {
        let RecordedState { positions, speeds, clock, coordinates, rates, base, mut values } =
            state;
        let instance = &self.instance;
        let (zero, one) = (Expression::constant(0.0), Expression::constant(1.0));
        let [_, mut advancing] = coordinates;
        for (number, integral) in self.integrals.iter().enumerate() {
            if let SpeedOf::Velocity(place) = integral
                && let Some(speed) = instance.linear(number, base)?
            {
                let speed_there = speeds[*place].in_unit(self.units.velocities[*place]);
                advancing[*place] = speed_there - speed.constant;
            }
        }
        self.units.convert_rates(&mut advancing);
        // The factors of accelerations in normal forces are derivatives by these inputs, which are 0.
        let accelerations: Vec<_> = positions
            .iter()
            .filter(|_| instance.definition.uses_accelerations)
            .map(|_| recorder.parameter("acceleration"))
            .collect();
        let mut accelerated = values.coordinates.to_vec();
        for ((.., values), acceleration) in accelerated.iter_mut().zip(&accelerations) {
            values[2] = *acceleration;
        }
        let (mass, forces) = instance.mass_and_forces(&mut values)?;
        let (mut mass, mut forces) = (rates.between(&mass), rates.across(&forces));
        self.units.convert_inertia(&mut mass);
        self.units.convert_forces(&mut forces);
        let mut contacts = Vec::new();
        for (number, friction) in self.friction.iter().enumerate() {
            let (contact, mut bodies) = instance.contact(number);
            let formula = contact.normal.entry().1;
            // A sliding speed in a larger unit means forces in a smaller one.
            let factor = instance.multiple((number, self.speeds[number]), &rates, base)?;
            let unit = self.units.force_factor(number);
            let in_unit = |force| factor.map_or(force, |factor| factor * force).in_unit(unit);
            let normal = bodies.evaluate(formula, &mut values)?;
            let place = self.position(number);
            contacts.push(MechanismContact {
                position: (positions[place], instance.is_periodic(place)),
                sliding_speed: match (self.speeds[number], &contact.sliding) {
                    (
                        SpeedOf::Velocity(place) | SpeedOf::Same(place) | SpeedOf::Multiple(place),
                        _,
                    ) => speeds[place],
                    (SpeedOf::Formula, Some(sliding)) => {
                        let speed = bodies.evaluate(sliding, &mut values)?;
                        speed.in_unit(1.0 / self.units.contacts[number])
                    }
                    (SpeedOf::Formula, None) => zero,
                },
                normal: match contact.normal {
                    WrittenNormal::Given(_) if accelerations.is_empty() => {
                        MechanismNormal::Given(in_unit(normal))
                    }
                    WrittenNormal::Given(_) => {
                        let mut moving = NamedValues { coordinates: &accelerated, ..values };
                        let force = in_unit(bodies.evaluate(formula, &mut moving)?);
                        let factor =
                            |of: &Expression<'r>| recorder.rate_of_change(force, &[(*of, one)]);
                        let factors: Vec<_> = accelerations.iter().map(factor).collect();
                        let mut factors = rates.across(&factors);
                        self.units.convert_accelerations(&mut factors);
                        MechanismNormal::Reaction(in_unit(normal), factors)
                    }
                    WrittenNormal::Gap(_) => {
                        let unit = self.units.contacts[number] * self.units.time;
                        MechanismNormal::Gap(normal.in_unit(1.0 / unit))
                    }
                },
                friction: *friction,
                force_unit: self.force_units[number],
            });
        }
        let has_contact =
            |place: &usize| (0..contacts.len()).any(|number| self.position(number) == *place);
        let angles = (0..positions.len())
            .filter(|place| instance.is_periodic(*place) && !has_contact(place))
            .map(|place| positions[place])
            .collect();
        Ok(Mechanism {
            angles,
            coordinates: positions
                .into_iter()
                .zip(speeds)
                .map(|(position, speed)| [position, speed])
                .collect(),
            rates: advancing,
            others: clock.into_iter().collect(),
            mass,
            forces,
            contacts,
            forcing: clock.filter(|_| self.period.is_some()).map(|[phase, _]| (phase, TAU)),
        })
    }
}

impl WrittenSystem {
    /// Returns whether the last component of a state is the time.
    pub fn has_clock(&self) -> bool {
        self.lasting.is_none() && (self.instance.definition.uses_time || self.stage.given_moves())
    }

    /// Returns the system in a stage of its run.
    pub fn in_stage(&self, stage: &StageMotion) -> Self {
        let second = self.scales.unit([0, 0, WHOLE]);
        let definition = self.instance.definition;
        let given = definition.motions.iter().map(|WrittenMotion { motion, unit, .. }| {
            let size = self.scales.unit(unit.dimension);
            let terms = motion.terms_from(stage.begins_s).into_iter();
            terms.zip(0..).map(|(term, power)| term * second.powi(power) / size).collect()
        });
        let given: Vec<Vec<f64>> = given.collect();
        let Some((before_rad, speed)) = &stage.turning else {
            let stage = GivenTerms { turned: Vec::new(), given };
            return self.with_stage(stage, self.rates, self.period);
        };
        let count = speed.terms.iter().rposition(|term| *term != 0.0).map_or(1, |last| last + 1);
        let end = speed.speed_rad_s(if speed.lasts_s.is_finite() { speed.lasts_s } else { 0.0 });
        let fastest_rad_s = speed.terms[0].abs().max(end.abs());
        let terms = &speed.terms[..count];
        let scaled = terms.iter().zip(1..).map(|(term, power)| term * second.powi(power));
        // The angle after which all formulas repeat.
        let repeats_rad = match (&definition.period, definition.speed_place(), self.period) {
            (Some(_), Some(place), Some(period)) => {
                period * self.units.time * self.values[place].abs()
            }
            _ => TAU,
        };
        let turned = std::iter::once(before_rad % repeats_rad).chain(scaled).collect();
        let is_constant = terms.len() == 1;
        let fastest = fastest_rad_s * second * self.units.time;
        let period = self.period.map(|_| repeats_rad / fastest);
        let rates = [self.rates[0].max(fastest), self.rates[1]];
        self.with_stage(GivenTerms { turned, given }, rates, period.filter(|_| is_constant))
    }

    fn with_stage(&self, stage: GivenTerms<f64>, rates: [f64; 2], period: Option<f64>) -> Self {
        let mut system = WrittenSystem {
            period: period.filter(|_| !stage.given_moves()),
            stage,
            rates,
            has_one_solution: false,
            measured: OnceLock::new(),
            ..self.clone()
        };
        system.has_one_solution = system.always_decides_in_one_way();
        system
    }

    /// Returns the time, non-dimensional, from which on the equations and the outputs no longer depend on it, and the system from then
    /// on; `None` if there is none, for a system with a period, and with motions that tables give.
    pub fn lasting(&self) -> Option<(f64, Self)> {
        let definition = self.instance.definition;
        let may_last = definition.uses_time
            && self.period.is_none()
            && definition.motions.is_empty()
            && self.stage.turned.is_empty();
        if !may_last {
            return None;
        }
        let (graph, measured) = (Graph::of(self), self.measured()?);
        let inputs = self.inputs(&vec![ContactMode::Apart; graph.contacts.len()]);
        let clock = 2 * self.instance.coordinates.len();
        let lasts = |time: f64| {
            graph.lasts_from(clock, time, &inputs) && measured.last_from(clock, time, &inputs)
        };
        let times: Vec<f64> = HALF_POWERS.map(|power| libm::exp2(0.5 * f64::from(power))).collect();
        let time = *times.get(times.partition_point(|time| !lasts(*time)))?;
        let mut system = self.with_stage(self.stage.clone(), self.rates, None);
        // What changes by rounding after this time has its last value.
        system.lasting = Some(MUCH_LATER * time);
        Some((time, system))
    }

    /// Returns the position that a contact moves.
    pub fn position(&self, contact: usize) -> usize {
        match self.integrals[contact] {
            SpeedOf::Velocity(place) | SpeedOf::Same(place) | SpeedOf::Multiple(place) => place,
            SpeedOf::Formula => self.instance.positions[contact],
        }
    }

    /// Returns whether no contact opens, and each has a sliding speed that is a velocity or a multiple of one; contacts with one
    /// velocity hold as one.
    pub fn does_not_open(&self) -> bool {
        self.speeds
            .iter()
            .enumerate()
            .all(|(number, speed)| !self.instance.has_gap(number) && *speed != SpeedOf::Formula)
    }
}

impl System for WrittenSystem {
    /// # Panics
    /// Panics if the formulas have a fault: the kind refuses such a model before.
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let mechanism = self.in_recorded_state(recorder, |state| self.mechanism(recorder, state));
        mechanism.expect("the model has been checked").record(recorder)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mut inputs = self.values.clone();
        inputs.extend(self.period.iter().flat_map(|period| [period / TAU, TAU / period]));
        inputs.extend(self.lasting);
        inputs.extend(self.stage.all());
        if self.instance.definition.uses_accelerations {
            inputs.extend(self.instance.coordinates.iter().map(|_| 0.0));
        }
        for (number, mode) in modes.iter().enumerate() {
            let opens = self.instance.has_gap(number);
            add_mechanism_inputs(&mut inputs, *mode, &self.friction[number], opens);
        }
        inputs
    }

    fn structure(&self) -> Option<Structure> {
        let laws = self.friction.iter().map(Friction::law_name).collect();
        let numbers = [self.number, self.instance.coordinates.len()].into_iter();
        let counts = self.instance.bodies.counts.iter().map(|(_, count)| *count as usize);
        let units = self.scales.0.map(|exponent| exponent.cast_unsigned() as usize);
        let units = units.into_iter().chain(self.units.all().map(|unit| unit.to_bits() as usize));
        let form = [self.period.is_some(), self.lasting.is_some()].map(usize::from).into_iter();
        let form = form.chain([self.stage.turned.len()]);
        let form = form.chain(self.stage.given.iter().map(Vec::len));
        let force_units = self.force_units.iter().map(|unit| unit.to_bits() as usize);
        let zeros = self.values.iter().map(|value| usize::from(*value == 0.0));
        let speeds = self.speeds.iter().map(|speed| match speed {
            SpeedOf::Velocity(place) => 3 * place + 1,
            SpeedOf::Same(place) => 3 * place + 2,
            SpeedOf::Multiple(place) => 3 * place + 3,
            SpeedOf::Formula => 0,
        });
        Some((
            TypeId::of::<Self>(),
            laws,
            numbers
                .chain(counts)
                .chain(units)
                .chain(speeds)
                .chain(form)
                .chain(force_units)
                .chain(zeros)
                .collect(),
        ))
    }

    fn contacts(&self) -> usize {
        self.friction.len()
    }

    fn friction(&self, contact: usize) -> &Friction {
        &self.friction[contact]
    }

    fn impact_law(&self, contact: usize) -> ImpactLaw {
        self.impacts[contact]
    }

    /// A quarter of the shortest period.
    fn longest_step(&self) -> f64 {
        FRAC_PI_2 / self.rates[0].max(1.0)
    }

    fn fastest_rate(&self) -> f64 {
        let damping =
            self.friction.iter().map(|friction| friction.damping_rate(self.largest_force));
        self.rates[0].max(1.0) + stiff_rate(damping.fold(self.rates[1], f64::max))
    }

    fn surely_one_solution(&self) -> bool {
        self.has_one_solution
    }

    fn one_solution_at(&self, state: &[f64]) -> bool {
        self.has_one_solution
            || self.does_not_open() && self.decides_in_one_way(state).unwrap_or(false)
    }

    fn force_scale(&self) -> f64 {
        self.largest_force.max(1.0)
    }

    fn outputs(&self, state: &[f64]) -> Components {
        let measured = self.measured();
        measured.map_or_else(Components::new, |all| all.values(&self.inputs(&[]), state))
    }

    fn output(&self, number: usize, state: &dyn Fn(usize) -> f64) -> Option<f64> {
        self.measured()?.value(number, &self.inputs(&[]), state)
    }

    fn smallest_inertia(&self, state: &[f64]) -> f64 {
        self.inertia_in(state).unwrap_or(1.0)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
