//! The kind of model that a system file defines.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError};

use super::definition::{SystemDefinition, WrittenDerived, WrittenOutput};
use super::dimensions::unit_of;
use super::evaluate::Bodies;
use super::examined::ExaminedSystem;
use super::formula::{Dimension, Formula, FormulaFault, Valued, WHOLE};
use super::instance::{Instance, Member};
use super::sizes::ranges;
use super::state_units::StateUnits;
use super::velocities::SpeedOf;
use crate::model::ball_balancer::PROFILE_PARAMETERS;
use crate::model::invalid_parameter::invalid;
use crate::model::parameter_name::{member_name, unit_ending};
use crate::model::{
    Capabilities, Components, ContactNames, ContactUnits, Coordinate, DefaultModel,
    DerivedQuantity, Drawing, Field, FrictionLaw, GivenMotion, InvalidParameter, ModelKind,
    OutputName, OutputUnits, OwnKind, OwnModel, ParameterDescriptor, SlidingSpeed,
    SmallMotionEquations, StageMotion, System, Units,
};

/// What a kind of model of a file computes, with the texts that a process keeps.
struct WrittenKind {
    definition: &'static SystemDefinition,
    /// A number for each definition of the process.
    number: usize,
    /// For each coordinate of the definition, its position and its rate of change.
    coordinates: Vec<[StartName; 2]>,
    /// Whether the definition is part of this program.
    is_built_in: bool,
    /// The systems with the numbers of bodies for which all formulas have been checked.
    sound: Mutex<Vec<Arc<Instance<'static>>>>,
}

/// A coordinate of a start state for all bodies together.
struct StartName {
    /// The name in study files, with its unit.
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    /// The default range, if it has formulas of parameters.
    range: Option<&'static str>,
}

/// All definitions of the process. A definition is kept for the life of the process, as all kinds of models are.
static KINDS: Mutex<Vec<(&'static WrittenKind, &'static ModelKind)>> = Mutex::new(Vec::new());

/// A definition's number, values of its parameters, the law of the study, and what they say about the system.
type Latest = (usize, Vec<f64>, FrictionLaw, Arc<ExaminedSystem>);

/// How many are kept in each thread.
const MOST_KEPT: usize = 4;

thread_local! {
    static LATEST: RefCell<Vec<Latest>> = const { RefCell::new(Vec::new()) };
}

/// Begins the names by which a program calls kinds of files: different systems may have one name.
pub const WRITTEN: char = '#';

/// Returns the kind of model of a definition, which has been checked, and a name of this kind that no other has in this
/// process. Equal definitions give the same kind.
pub fn written_kind(
    definition: SystemDefinition,
    is_built_in: bool,
) -> (&'static ModelKind, String) {
    let mut all = KINDS.lock().unwrap_or_else(PoisonError::into_inner);
    let is_it =
        |known: &WrittenKind| known.is_built_in == is_built_in && *known.definition == definition;
    let number = all.iter().position(|(known, _)| is_it(known));
    let number = number.unwrap_or_else(|| {
        let number = all.len();
        all.push(leaked(definition, number, is_built_in));
        number
    });
    (all[number].1, format!("{WRITTEN}{number}"))
}

/// Returns the kind of a file with this name of [`written_kind`].
pub fn written_kind_named(name: &str) -> Option<&'static ModelKind> {
    let number: usize = name.strip_prefix(WRITTEN)?.parse().ok()?;
    let all = KINDS.lock().unwrap_or_else(PoisonError::into_inner);
    all.get(number).map(|(_, kind)| *kind)
}

fn kept(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

fn leaked(
    definition: SystemDefinition,
    number: usize,
    is_built_in: bool,
) -> (&'static WrittenKind, &'static ModelKind) {
    let definition: &'static SystemDefinition = Box::leak(Box::new(definition));
    let parameters = definition.parameters.iter().map(|parameter| ParameterDescriptor {
        name: kept(format!("{}{}", parameter.name, unit_ending(&parameter.unit.si))),
        unit: &parameter.unit.si,
        meaning: &parameter.meaning,
        field: match parameter.counts {
            Some([least, most]) => Field::Count { default: parameter.value as usize, least, most },
            None => Field::Own { default: parameter.value, bound: parameter.bound },
        },
    });
    let profile = definition.turning.iter().flat_map(|_| PROFILE_PARAMETERS);
    let coordinates = definition.coordinates.iter().map(|written| {
        let unit = written.unit.si.as_str();
        let rate = match (definition.has_units(), unit) {
            (false, _) => "1",
            (true, "1") => "1/s",
            (true, unit) => kept(format!("{unit}/s")),
        };
        let of = if written.meaning.is_empty() { &written.name } else { &written.meaning };
        let name = |stem: String, unit: &str| kept(stem + &unit_ending(unit));
        let range = |[low, high]: &[Formula; 2]| {
            let is_number = |text: &str| text.is_empty() || text.parse::<f64>().is_ok();
            let texts = [low, high].map(|end| end.text.as_str());
            (!texts.into_iter().all(is_number))
                .then(|| kept(format!("[{}, {}]", texts[0], texts[1])))
        };
        let position = StartName {
            range: range(&written.start[0]),
            name: name(written.name.clone(), unit),
            unit,
            meaning: kept(format!("start value: {of}")),
        };
        let velocity = StartName {
            range: range(&written.start[1]),
            name: name(written.rate.clone(), rate),
            unit: rate,
            meaning: kept(format!("rate of change at the start: {of}")),
        };
        [position, velocity]
    });
    let written: &'static WrittenKind = Box::leak(Box::new(WrittenKind {
        coordinates: coordinates.collect(),
        sound: Mutex::default(),
        is_built_in,
        definition,
        number,
    }));
    let kind = ModelKind {
        name: &definition.name,
        meaning: &definition.meaning,
        parameters: Box::leak(parameters.chain(profile).collect::<Vec<_>>().into_boxed_slice()),
        body: "contact",
        sliding_speed: sliding_speed_of_study(definition),
        offers: Capabilities::MOTION,
        default: DefaultModel::Own(written),
    };
    (written, Box::leak(Box::new(kind)))
}

/// Returns the unit of sliding speeds in the law of friction of the study.
fn sliding_speed_of_study(definition: &'static SystemDefinition) -> SlidingSpeed {
    let instance = Instance::new(definition, |name| definition.default_count(name).max(1)).ok();
    let of_study = |instance: &Instance| {
        let mut numbers = 0..instance.contacts.len();
        let first = numbers.find(|number| instance.contact(*number).0.has_law_of_study)?;
        instance.speed_dimension(first).ok()
    };
    match instance.and_then(|instance| of_study(&instance)) {
        Some([0, 0, _]) => SlidingSpeed::RadS,
        _ => SlidingSpeed::MS,
    }
}

impl WrittenKind {
    /// Returns the system with the numbers of bodies of a model.
    fn instance(&self, model: &OwnModel) -> Valued<Arc<Instance<'static>>> {
        let count = |name: &str| self.value(model, name) as i64;
        let mut sound = self.sound.lock().unwrap_or_else(PoisonError::into_inner);
        let has_counts = |known: &&Arc<Instance>| {
            known.bodies.counts.iter().all(|(name, number)| count(name) == *number)
        };
        if let Some(known) = sound.iter().find(has_counts) {
            return Ok(Arc::clone(known));
        }
        let instance = Instance::new(self.definition, count).map_err(|(_, fault)| fault)?;
        instance.check().map_err(|(_, fault)| fault)?;
        let instance = Arc::new(instance);
        sound.push(Arc::clone(&instance));
        Ok(instance)
    }

    /// Returns the value of a parameter by its name in formulas.
    fn value(&self, model: &OwnModel, name: &str) -> f64 {
        let place = self.definition.parameters.iter().position(|parameter| parameter.name == name);
        place.map_or(f64::NAN, |place| model.values()[place])
    }

    /// Returns what the values of a model say about the system. The latest ones of each thread are kept, because all runs at one
    /// point have the same values.
    fn examined(&self, model: &OwnModel) -> Valued<Arc<ExaminedSystem>> {
        LATEST.with_borrow_mut(|latest| {
            let is_it = |(number, values, law, _): &Latest| {
                *number == self.number && values == model.values() && law == model.friction()
            };
            if let Some((.., known)) = latest.iter().find(|entry| is_it(entry)) {
                return Ok(Arc::clone(known));
            }
            let (instance, values, law) = (self.instance(model)?, model.values(), model.friction());
            let examined = Arc::new(ExaminedSystem::new(instance, self.number, values, law)?);
            latest.truncate(MOST_KEPT - 1);
            latest.insert(0, (self.number, values.to_vec(), *law, Arc::clone(&examined)));
            Ok(examined)
        })
    }

    /// Returns the unit in which results show a quantity.
    fn shown_unit(&self, dimension: Dimension) -> String {
        if self.definition.has_units() { unit_of(dimension) } else { "1".to_owned() }
    }

    /// Returns the name and the unit of a quantity that results show.
    fn named(
        &self,
        instance: &Instance<'_>,
        WrittenOutput { name, unit, meaning, formula, .. }: &WrittenOutput,
        bodies: Bodies,
    ) -> Valued<OutputName> {
        let unit = match unit {
            Some(unit) => unit.si.clone(),
            None => self.shown_unit(instance.dimension(formula, bodies)?),
        };
        let name = format!("{name}{}", unit_ending(&unit));
        Ok(OutputName { name, unit, meaning: meaning.clone() })
    }

    /// Returns what a system with the numbers of bodies of a model computes.
    fn of_instance<T: Default>(
        &self,
        model: &OwnModel,
        compute: impl FnOnce(&Instance<'static>) -> Valued<T>,
    ) -> T {
        // A model is validated before it is simulated; what has a fault has no coordinates.
        self.instance(model).and_then(|instance| compute(&instance)).unwrap_or_default()
    }
}

/// Returns a name with the number of the body that it belongs to.
fn numbered(name: &str, unit: &str, body: Option<i64>) -> String {
    body.map_or_else(|| name.to_owned(), |body| member_name(name, unit, body as usize))
}

impl OwnKind for WrittenKind {
    fn source(&self) -> Option<&serde_json::Value> {
        (!self.is_built_in).then_some(&self.definition.source)
    }

    fn has_law_of_study(&self) -> bool {
        self.definition.has_law_of_study()
    }

    /// A fault concerns a formula.
    fn reports_parameters(&self) -> bool {
        false
    }

    fn validate(&self, model: &OwnModel) -> Result<(), InvalidParameter> {
        let refuse = |fault: FormulaFault| {
            let found = format!("{}: {}", fault.problem, fault.found);
            invalid("system", &found, "numbers of bodies for which all formulas exist")
        };
        let examined = self.examined(model).map_err(refuse)?;
        examined.sound.clone()
    }

    fn coordinates(&self, model: &OwnModel) -> Vec<Coordinate> {
        self.of_instance(model, |instance| {
            let ranges = ranges(instance, model.values())?;
            let of_coordinate = |which: usize| {
                let members = instance.coordinates.iter().zip(&ranges);
                members.map(move |(member, range)| {
                    let start = &self.coordinates[member.of][which];
                    let StartName { name, unit, meaning, .. } = start;
                    let coordinate = match member.body {
                        Some(body) => {
                            Coordinate::of_body(name, body as usize, unit, meaning, range[which])
                        }
                        None => Coordinate::new(*name, unit, meaning, range[which]),
                    };
                    Coordinate { default_in_words: start.range, ..coordinate }
                })
            };
            Ok(of_coordinate(0).chain(of_coordinate(1)).collect())
        })
    }

    fn coordinate_count(&self, model: &OwnModel) -> usize {
        let examined = self.examined(model);
        examined.map_or(0, |examined| 2 * examined.system.instance.coordinates.len())
    }

    fn units(&self, model: &OwnModel) -> Units {
        let Ok(examined) = self.examined(model) else { return Units::default() };
        let ExaminedSystem { speeds, outputs, system, .. } = &*examined;
        let instance = &system.instance;
        let unit = |dimension: Dimension| system.scales.unit(dimension);
        let StateUnits { time, power, positions, .. } = &system.units;
        let second = unit([0, 0, WHOLE]) * time;
        let power = unit([WHOLE, 2 * WHOLE, -3 * WHOLE]) * power;
        let contact = |(number, &sliding_speed): (usize, &f64)| {
            let place = system.position(number);
            let member = instance.coordinates[place];
            ContactUnits {
                position: match system.integrals[number] {
                    SpeedOf::Formula => {
                        unit(self.definition.coordinates[member.of].unit.dimension)
                            * positions[place]
                    }
                    _ => sliding_speed * second,
                },
                sliding_speed,
                force_n: system.force_units[number] * power / sliding_speed,
            }
        };
        let of_coordinate = |which: usize| {
            instance.coordinates.iter().enumerate().map(move |(number, member)| {
                let coordinate = &self.definition.coordinates[member.of];
                let state_unit = system.units.of_coordinate(number)[which];
                let [mass, length, time] = coordinate.unit.dimension;
                let is_position = which == 0;
                let is_length = matches!(coordinate.unit.si.as_str(), "m" | "1");
                OutputUnits {
                    size: state_unit
                        * unit([mass, length, time - if is_position { 0 } else { WHOLE }]),
                    angular: is_position && coordinate.periodic,
                    has_amplitude: is_position && is_length,
                }
            })
        };
        let coordinates = of_coordinate(0).chain(of_coordinate(1));
        let outputs = outputs.iter().map(|dimension| OutputUnits {
            size: unit(*dimension),
            angular: false,
            has_amplitude: false,
        });
        Units {
            natural_rad_s: 1.0 / second,
            length_m: unit([0, WHOLE, 0]),
            contacts: speeds.iter().enumerate().map(contact).collect(),
            outputs: coordinates.chain(outputs).collect(),
            ..Units::default()
        }
    }

    fn small_motions(&self, model: &OwnModel) -> SmallMotionEquations {
        self.of_instance(model, |instance| instance.small_motions(model.values()))
    }

    fn speed_place(&self) -> Option<usize> {
        self.definition.speed_place()
    }

    fn motions(&self) -> Vec<&GivenMotion> {
        self.definition.motions.iter().map(|written| &written.motion).collect()
    }

    fn system_in_stage(&self, model: &OwnModel, stage: &StageMotion) -> (Arc<dyn System>, bool) {
        let Ok(examined) = self.examined(model) else { return (self.system(model), false) };
        let system = examined.system.in_stage(stage);
        let has_clock = system.has_clock();
        (Arc::new(system), has_clock)
    }

    fn lasting_system(&self, model: &OwnModel, end_s: f64) -> Option<(f64, Arc<dyn System>)> {
        let examined = self.examined(model).ok()?;
        let system = &examined.system;
        let second = system.scales.unit([0, 0, WHOLE]) * system.units.time;
        let find = || system.lasting().map(|(time, system)| (time, Arc::new(system)));
        let (time, system) = examined.lasting.get_or_init(find).as_ref()?;
        let begins_s = time * second;
        (begins_s < end_s).then(|| (begins_s, Arc::clone(system) as Arc<dyn System>))
    }

    fn system(&self, model: &OwnModel) -> Arc<dyn System> {
        match self.examined(model) {
            Ok(examined) => Arc::clone(&examined.system) as Arc<dyn System>,
            // A model is validated before it is simulated.
            Err(fault) => panic!("a model that has not been validated: {fault:?}"),
        }
    }

    fn start_state(&self, model: &OwnModel, start: &[f64]) -> Components {
        let state = self.examined(model).and_then(|examined| examined.start_state(start));
        state.unwrap_or_default().into()
    }

    fn output_names(&self, model: &OwnModel) -> Vec<OutputName> {
        self.of_instance(model, |instance| {
            let of_coordinate = |which: usize| {
                instance.coordinates.iter().map(move |member| {
                    let StartName { name, unit, .. } = self.coordinates[member.of][which];
                    let meaning = match (which, &self.definition.coordinates[member.of].meaning) {
                        (1, meaning) if !meaning.is_empty() => format!("rate of change: {meaning}"),
                        (_, meaning) => meaning.clone(),
                    };
                    let name = numbered(name, unit, member.body);
                    Ok(OutputName { name, unit: unit.to_owned(), meaning })
                })
            };
            let of_output = |(number, member): (usize, &Member)| {
                let (output, bodies) = instance.output(number);
                let OutputName { name, unit, meaning } = self.named(instance, output, bodies)?;
                Ok(OutputName { name: numbered(&name, &unit, member.body), unit, meaning })
            };
            let outputs = instance.outputs.iter().enumerate().map(of_output);
            of_coordinate(0).chain(of_coordinate(1)).chain(outputs).collect()
        })
    }

    fn drawing(&self, model: &OwnModel) -> Option<Drawing> {
        self.of_instance(model, |instance| instance.drawing(model.values()))
    }

    fn derived(&self, model: &OwnModel) -> Vec<DerivedQuantity> {
        self.of_instance(model, |instance| {
            let value = |formula: &Formula| instance.constant(formula, model.values());
            let range = |[low, high]: &[Formula; 2]| Ok([value(low)?, value(high)?]);
            let derived = |WrittenDerived { quantity, within, usual }: &WrittenDerived| {
                let is_shown = within.is_none() && usual.is_none();
                let name = self.named(instance, quantity, instance.bodies.clone())?;
                let usual = usual.as_ref().map(range).transpose()?;
                Ok(DerivedQuantity { name, value: value(&quantity.formula)?, usual, is_shown })
            };
            self.definition.derived.iter().map(derived).collect()
        })
    }

    fn contact_names(&self, model: &OwnModel) -> Vec<ContactNames> {
        let Ok(instance) = self.instance(model) else { return Vec::new() };
        let name = |number: usize| {
            let member = instance.contacts[number];
            let contact = &self.definition.contacts[member.of];
            let position = instance.coordinates[instance.positions[number]];
            let [start, _] = &self.coordinates[position.of];
            let speed = instance.speed_dimension(number).ok()?;
            let power = [WHOLE, 2 * WHOLE, -3 * WHOLE];
            let force = [0, 1, 2].map(|place| power[place] - speed[place]);
            let unit = |dimension| self.shown_unit(dimension);
            Some(ContactNames {
                contact: numbered(&contact.name, "1", member.body),
                position: (numbered(start.name, start.unit, position.body), start.unit),
                speed_unit: unit(speed).replace("1/s", "rad/s"),
                force_unit: unit(force),
            })
        };
        (0..instance.contacts.len()).filter_map(name).collect()
    }
}
