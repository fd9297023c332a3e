//! The tables of kinds of models and of friction laws are complete: an entry that is forgotten or wrong fails here.

use std::sync::Arc;

use crate::support::{Block, example_law, numbered_contacts, unit_kind};
use stickslip::model::{
    BallContact, Bound, Capabilities, Components, ContactNames, ContactUnits, Coordinate,
    DefaultModel, FRICTION_LAWS, Field, Kick, MAX_LAW_PARAMETERS, Machine, Model, ModelKind,
    OwnKind, OwnModel, ParameterDescriptor, ProfilePart, Ramp, RampShape, SlidingSpeed,
    SpeedProfile, System, Units,
};
use stickslip::study::{Registry, model_kinds};

/// Gives a machine what it has only on request: contact between balls, a speed profile with one part of each form, and a
/// kick. Their parameters exist only then.
fn with_all_parts(mut model: Model) -> Model {
    if let Some(machine) = model.ball_balancer_mut() {
        machine.contact = Some(BallContact::default());
        machine.kicks = vec![Kick { at_s: 1.0, speed_m_s: 0.01, direction_rad: 0.0 }];
    }
    if let Some(speed) = model.speed_parameter() {
        let last = *speed.numbers(&mut model, None)[0];
        let (start_speed_rad_s, middle) = (0.1 * last, 0.5 * last);
        let ramp = Ramp { shape: RampShape::Linear, to_rad_s: Some(middle), over_s: 1.0 };
        let parts = vec![
            ProfilePart::Ramp(ramp),
            ProfilePart::Hold(Some(1.0)),
            ProfilePart::Table(vec![[0.0, middle], [1.0, last]]),
        ];
        *model.speed_profile_mut() = Some(SpeedProfile { start_speed_rad_s, parts });
    }
    model
}

/// The default of each kind is of that kind, is valid, and has a value of each number among the parameters.
#[test]
fn defaults_have_all_parameters() {
    for kind in model_kinds().iter().copied() {
        let mut model = with_all_parts(kind.default_model());
        assert_eq!(model.kind(), kind);
        assert_eq!(model.validate(), Ok(()), "{kind:?}");
        for parameter in kind.parameters.iter().filter(|parameter| parameter.is_number()) {
            let numbers = parameter.numbers(&mut model, None);
            assert_eq!(numbers.len(), 1, "{kind:?}: {parameter:?}");
        }
    }
}

/// Each parameter has its own field: a new value changes one parameter and no other.
#[test]
fn parameters_have_fields_of_their_own() {
    for kind in model_kinds().iter().copied() {
        let numbers = || kind.parameters.iter().filter(|parameter| parameter.is_number());
        for changed in numbers() {
            let mut model = with_all_parts(kind.default_model());
            *changed.numbers(&mut model, None)[0] = 1234.5;
            let is_changed = |name: &str| {
                let number = numbers().find(|parameter| parameter.name == name).expect("a number");
                *number.numbers(&mut model.clone(), None)[0] == 1234.5
            };
            let all: Vec<&str> =
                numbers().map(|parameter| parameter.name).filter(|name| is_changed(name)).collect();
            assert_eq!(all, [changed.name], "{kind:?}");
        }
    }
}

/// Names are unique, and end with their units.
#[test]
fn names_are_unique_and_have_units() {
    let endings = "kg=_kg, kg/m3=_kg_m3, kg m=_kg_m, m=_m, s=_s, rad=_rad, N/m=_n_m, N s/m=_n_s_m, \
                   N=_n, rad/s=_rad_s, m/s=_m_s, 1/s=_1_s, m/s2=_m_s2, kg m2=_kg_m2";
    let endings: Vec<_> = endings.split(", ").filter_map(|pair| pair.split_once('=')).collect();
    for kind in model_kinds().iter().copied() {
        for law in FRICTION_LAWS {
            let of_kind = kind.parameters.iter().map(|parameter| (parameter.name, parameter.unit));
            let of_law = law.parameters().iter();
            let of_law = of_law.map(|parameter| {
                (parameter.name(kind.sliding_speed), parameter.unit(kind.sliding_speed))
            });
            let mut all: Vec<(&str, &str)> = of_kind.chain(of_law).collect();
            for (name, unit) in &all {
                let ending = endings.iter().find(|(known, _)| known == unit);
                match ending {
                    Some((_, ending)) => assert!(name.ends_with(ending), "{name} has {unit}"),
                    None => assert!(["1", ""].contains(unit), "{name} has {unit}"),
                }
            }
            let count = all.len();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), count, "{kind:?} with {}", law.name());
        }
    }
}

/// The example of each law is valid in each kind of model, and its force has the properties that the law states.
#[test]
fn laws_are_what_they_state() {
    for law in FRICTION_LAWS {
        assert!(law.parameters().len() <= MAX_LAW_PARAMETERS);
        for kind in model_kinds().iter().copied() {
            let unit = usize::from(kind.sliding_speed == SlidingSpeed::MS);
            let mut model = kind.default_model();
            *model.friction_mut() = example_law(law, unit);
            assert_eq!(model.validate(), Ok(()), "{kind:?} with {}", law.name());
        }
        let values = example_law(law, 1);
        let friction = values.contact(0.1, 1.0, 1.0);
        let name = law.name();
        assert_eq!(law.can_stick(), friction.limit > 0.0, "{name}");
        assert!(friction.limit <= friction.largest_ratio(), "{name}");
        for direction in [-1.0, 1.0] {
            let force = |speed: f64| friction.slip(direction, direction * speed);
            let slow = force(1e-9);
            assert!(
                slow.signed_friction.abs() <= friction.largest_ratio() * (1.0 + 1e-12),
                "{name}"
            );
            // Friction takes energy, and is odd.
            let at = force(0.02);
            assert!(direction * (at.signed_friction + at.drag) >= 0.0, "{name}");
            let opposite = friction.slip(-direction, -direction * 0.02);
            assert_eq!(at.signed_friction, -opposite.signed_friction, "{name}");
            assert_eq!(at.drag, -opposite.drag, "{name}");
            // A linear law is a fixed ratio and a drag in proportion to speed.
            let [slow, fast] = [0.01, 0.02].map(force);
            let linear = slow.signed_friction == fast.signed_friction
                && (2.0 * slow.drag - fast.drag).abs() <= 1e-15;
            assert_eq!(values.is_linear(0.1), linear, "{name}");
        }
        let unused = values.contact(0.3, 1.0, 1.0);
        let depends = friction.slip(1.0, 0.02) != unused.slip(1.0, 0.02);
        assert_eq!(law.uses_friction_coefficient(), depends, "{name}");
    }
}

/// Returns the kind of a program with these names and parameters.
fn kind(name: &'static str, parameters: Vec<ParameterDescriptor>) -> ModelKind {
    ModelKind {
        name,
        meaning: "A kind.",
        parameters: parameters.leak(),
        body: "block",
        sliding_speed: SlidingSpeed::MS,
        offers: Capabilities::MOTION,
        default: DefaultModel::BallBalancer(Machine::default),
    }
}

/// A kind with the equations of a block and a wrong number of units of force.
struct TwoForces;

impl OwnKind for TwoForces {
    fn coordinates(&self, _: &OwnModel) -> Vec<Coordinate> {
        Model::from(Block::on_belt()).coordinates()
    }

    fn units(&self, _: &OwnModel) -> Units {
        Units {
            contacts: vec![ContactUnits::new(1.0, 1.0, 1.0); 2],
            ..Model::from(Block::on_belt()).units()
        }
    }

    fn contact_names(&self, _: &OwnModel) -> Vec<ContactNames> {
        numbered_contacts(2)
    }

    fn system(&self, _: &OwnModel) -> Arc<dyn System> {
        Block::on_belt().system()
    }

    fn start_state(&self, _: &OwnModel, start: &[f64]) -> Components {
        start.iter().copied().collect()
    }
}

static TWO_FORCES: ModelKind = unit_kind(
    "two_forces",
    &[ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.1)],
    &TwoForces,
);

static INVALID: ModelKind = unit_kind(
    "invalid",
    &[ParameterDescriptor::positive("friction_coefficient", "1", "friction", 0.0)],
    &TwoForces,
);

/// A registry with a kind that contradicts itself or another one is refused, with its name and the reason.
#[test]
fn unsound_kinds_are_refused() {
    let number = |name| ParameterDescriptor::positive(name, "1", "a number", 1.0);
    let friction = || number("friction_coefficient");
    let field = Field::Own { default: 1.0, bound: Bound::None };
    let without_unit = ParameterDescriptor { name: "mass", unit: "kg", meaning: "a mass", field };
    let of_machine = model_kinds()[0].parameters[0].field;
    let of_machine = ParameterDescriptor { field: of_machine, ..number("mass") };
    let count = ParameterDescriptor::count("blocks", "number of blocks", 3, 2);
    let more = Capabilities { vibration: true, ..Capabilities::MOTION };
    let cases = [
        (kind("block_on_belt", vec![friction()]), "another kind has this name"),
        (kind("a-b", vec![friction()]), "lower-case letters"),
        (kind("a", vec![number("A"), friction()]), "the name `A`"),
        (kind("a", vec![number("b"), number("b"), friction()]), "two parameters are called `b`"),
        (kind("a", vec![number("balls"), friction()]), "two parameters are called `balls`"),
        (kind("a", vec![number("static_friction_coefficient"), friction()]), "that of a law"),
        (kind("a", vec![without_unit, friction()]), "`mass` needs the ending `_kg`"),
        (kind("a", vec![of_machine, friction()]), "`mass` needs the field"),
        (kind("a", vec![count, friction()]), "the default of `blocks`"),
        (kind("a", vec![number("b")]), "needs the parameter `friction_coefficient`"),
        (ModelKind { offers: more, ..kind("a", vec![friction()]) }, "only built-in kinds"),
        (kind("a", vec![friction()]), "its default is not an `OwnModel` of this kind"),
    ];
    for (kind, reason) in cases {
        let name = kind.name;
        let error = Registry::new().with(Box::leak(Box::new(kind))).install().expect_err(reason);
        let error = error.to_string();
        assert!(error.contains(&format!("`{name}`")) && error.contains(reason), "{error}");
    }
    for (kind, reason) in [
        (&TWO_FORCES, "the numbers of units of contacts and contacts differ: 2 and 1"),
        (&INVALID, "its default is invalid: friction_coefficient is 0"),
    ] {
        let error = Registry::new().with(kind).install().expect_err(reason).to_string();
        assert!(error.contains(reason), "{error}");
    }
    // The built-in kinds alone can be installed at any time.
    assert_eq!(Registry::new().install(), Ok(()));
}
