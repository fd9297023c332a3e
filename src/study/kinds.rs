//! The kinds of models of a program: the built-in ones, and those that the program registers.

use std::sync::OnceLock;

use thiserror::Error;

use super::resolve::built_in_system;
use super::resolve::names::is_key;
use crate::model::{
    BALL_BALANCER, Capabilities, ContactMode, FRICTION_COEFFICIENT, FRICTION_LAWS, Field, Graph,
    Model, ModelKind, ParameterDescriptor, Start, StateLayout, unit_ending, written_kind_named,
};

/// The system files in this program, in the order of the documentation.
const SYSTEMS: [(&str, &str); 3] = [
    ("block_on_spring.yaml", include_str!("systems/block_on_spring.yaml")),
    ("block_on_belt.yaml", include_str!("systems/block_on_belt.yaml")),
    ("rotor_balancer.yaml", include_str!("systems/rotor_balancer.yaml")),
];

static KINDS: OnceLock<Vec<&'static ModelKind>> = OnceLock::new();

/// Returns all kinds of models: the built-in ones in the order of the documentation, and then the registered ones.
pub fn model_kinds() -> &'static [&'static ModelKind] {
    KINDS.get_or_init(built_in)
}

/// Returns the kind of model with this name.
pub fn model_kind(name: &str) -> Option<&'static ModelKind> {
    let registered = model_kinds().iter().copied().find(|kind| kind.name == name);
    registered.or_else(|| written_kind_named(name))
}

fn built_in() -> Vec<&'static ModelKind> {
    let systems = SYSTEMS.iter().map(|(file, text)| built_in_system(file, text));
    [&BALL_BALANCER].into_iter().chain(systems).collect()
}

/// Kinds of models that a program adds to the built-in ones.
#[derive(Clone, Debug, Default)]
pub struct Registry(Vec<&'static ModelKind>);

/// Why kinds of models cannot be registered: a programming error.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RegistryError {
    /// A kind contradicts itself or another kind.
    #[error("the kind of model `{kind}`: {problem}")]
    Unsound {
        /// The name of the kind.
        kind: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// The kinds are already in use.
    #[error("the kinds of models are already in use; register all of them first")]
    TooLate,
}

impl Registry {
    /// Returns an empty registry.
    pub fn new() -> Self {
        Registry::default()
    }

    /// Adds a kind of model.
    #[must_use]
    pub fn with(mut self, kind: &'static ModelKind) -> Self {
        self.0.push(kind);
        self
    }

    /// Makes the kinds those of the process. The command line does this, see [`crate::cli::run`].
    ///
    /// # Errors
    /// Returns an error if a kind contradicts itself or another kind, or if other kinds are already in use.
    pub fn install(self) -> Result<(), RegistryError> {
        let mut kinds = built_in();
        for new_kind in self.0 {
            let refuse = |problem: String| RegistryError::Unsound { kind: new_kind.name, problem };
            if kinds.iter().any(|kind| kind.name == new_kind.name) {
                return Err(refuse("another kind has this name; choose a name of its own".into()));
            }
            check_names(new_kind).and_then(|()| check_default(new_kind)).map_err(refuse)?;
            kinds.push(new_kind);
        }
        let installed = KINDS.get_or_init(|| kinds.clone());
        if *installed == kinds { Ok(()) } else { Err(RegistryError::TooLate) }
    }
}

/// Checks the names in the table of a kind, and what its parameters are.
fn check_names(kind: &ModelKind) -> Result<(), String> {
    let of_laws = FRICTION_LAWS.iter().flat_map(|law| law.parameters());
    let of_laws: Vec<&str> = of_laws.map(|parameter| parameter.name(kind.sliding_speed)).collect();
    let mut known: Vec<&str> = vec!["balls"];
    if !is_key(kind.name) || !is_key(kind.body) {
        return Err("its name and that of its body need lower-case letters, digits and _".into());
    }
    for parameter in kind.parameters {
        let name = parameter.name;
        if !is_key(name) {
            return Err(format!("the name `{name}` needs lower-case letters, digits and _"));
        }
        if known.contains(&name) || of_laws.contains(&name) {
            return Err(format!("two parameters are called `{name}`, or it is that of a law"));
        }
        let ending = unit_ending(parameter.unit);
        if !name.ends_with(&ending) {
            return Err(format!("`{name}` needs the ending `{ending}` of its unit"));
        }
        match parameter.field {
            Field::Own { .. } => {}
            Field::Count { default, least, most } if (least.max(1)..=most).contains(&default) => {}
            Field::Count { .. } => {
                return Err(format!("the default of `{name}` is not from 1 to its largest value"));
            }
            _ => return Err(format!("`{name}` needs the field `Field::Own` or `Field::Count`")),
        }
        known.push(name);
    }
    let is_friction = |parameter: &&ParameterDescriptor| parameter.name == FRICTION_COEFFICIENT;
    match kind.parameters.iter().find(is_friction).map(|parameter| parameter.field) {
        Some(Field::Own { .. }) => {}
        _ => return Err(format!("it needs the parameter `{FRICTION_COEFFICIENT}`")),
    }
    match kind.offers == Capabilities::MOTION {
        true => Ok(()),
        false => Err("only built-in kinds offer more than `Capabilities::MOTION`".into()),
    }
}

/// Checks that the default model is sound, and that its functions agree also with the largest whole numbers.
fn check_default(kind: &'static ModelKind) -> Result<(), String> {
    let model = kind.default_model();
    if model.kind() != kind || !matches!(model, Model::Own(_)) {
        return Err("its default is not an `OwnModel` of this kind".into());
    }
    model.validate().map_err(|invalid| format!("its default is invalid: {invalid}"))?;
    check_numbers(&model)?;
    let mut largest = model;
    for parameter in kind.parameters {
        if let Some(most) = parameter.largest_count() {
            parameter.numbers(&mut largest, None).into_iter().for_each(|slot| *slot = most as f64);
        }
    }
    check_numbers(&largest)
}

/// Checks that the functions of a model agree on the numbers of coordinates, inputs and contacts.
fn check_numbers(model: &Model) -> Result<(), String> {
    let system = model.system().ok_or("a model has no system")?;
    let graph = Graph::of(system.as_ref());
    let coordinates = model.coordinates();
    let start = coordinates.iter().map(|coordinate| coordinate.default_range[0]).collect();
    let state = model.start_state(&Start(start)).map_err(|error| error.to_string())?;
    let modes = vec![ContactMode::Stick; system.contacts()];
    let pairs = [
        ("components of its start state and of its equations", state.len(), graph.derivative.len()),
        ("recorded inputs and values of inputs", graph.inputs.len(), system.inputs(&modes).len()),
        ("recorded contacts and contacts", graph.contacts.len(), system.contacts()),
        ("contacts in the layout and contacts", graph.layout.contacts.len(), system.contacts()),
        ("units of contacts and contacts", model.units().contacts.len(), system.contacts()),
    ];
    if let Some((what, left, right)) = pairs.into_iter().find(|(_, left, right)| left != right) {
        return Err(format!("the numbers of {what} differ: {left} and {right}, for {model:?}"));
    }
    let StateLayout { contacts, velocities, vibration, forcing, angles } = &graph.layout;
    if let Some(forcing) =
        forcing.filter(|forcing| forcing.period.is_nan() || forcing.period <= 0.0)
    {
        return Err(format!("the period of its forcing is not positive: {}", forcing.period));
    }
    let reset = graph.events.iter().flat_map(|event| event.reset.iter().map(|(place, _)| *place));
    let named = contacts.iter().map(|contact| contact.position).chain(reset);
    let mut named = named
        .chain(velocities.iter().flatten().copied())
        .chain(vibration.iter().flatten().copied())
        .chain(forcing.iter().map(|forcing| forcing.component))
        .chain(angles.iter().copied());
    match named.find(|component| *component >= state.len()) {
        Some(component) => Err(format!(
            "its layout or an event names the component {component}, counted from 0, of {}",
            state.len()
        )),
        None => Ok(()),
    }
}
