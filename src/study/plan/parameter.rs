//! The parameters that a study may sweep or draw: names, units, meanings and setters.

use std::fmt;

use crate::model::{
    Ball, Block, FrictionLaw, Ground, Machine, Model, NormalForce, ball_parameter_name,
};
use crate::study::error::Fault;
use crate::study::file::yaml_tree::describe_number;

/// The value of a parameter at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// A number in the parameter's unit.
    Number(f64),
    /// A word, such as `newton`.
    Text(&'static str),
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParameterValue::Number(number) => out.write_str(&describe_number(*number)),
            ParameterValue::Text(text) => out.write_str(text),
        }
    }
}

/// Whether a column holds numbers or words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// Numbers in the parameter's unit.
    Number,
    /// Words.
    Text,
}

/// A parameter that differs between points or runs, as a column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariedParameter {
    /// Name, as in the study file and in tables.
    pub name: String,
    /// Unit, such as `kg`; `1` for dimensionless numbers, empty for words.
    pub unit: &'static str,
    /// Meaning, in a few words.
    pub meaning: String,
    /// Whether the values are numbers or words.
    pub kind: ParameterKind,
}

/// The physical quantity of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum Quantity {
    TableMass,
    Mass,
    Stiffness,
    Damping,
    RingRadius,
    ImbalanceMass,
    ImbalanceRadius,
    BallMass,
    BallDiameter,
    PressingForce,
    FrictionCoefficient,
    StaticFrictionCoefficient,
    StribeckSpeed,
    SmoothingSpeed,
    ViscousCoefficient,
    Speed,
    BeltSpeed,
    NormalForce,
}

use Quantity as Q;

/// Every quantity with its name, unit and meaning. Sliding speeds have the name and unit for a ball.
const QUANTITIES: [(Quantity, &str, &str, &str); 18] = [
    (Q::TableMass, "table_mass_kg", "kg", "mass of table, motor, ring and disc"),
    (Q::Mass, "mass_kg", "kg", "mass of the block"),
    (Q::Stiffness, "stiffness_n_m", "N/m", "stiffness of the spring or suspension"),
    (Q::Damping, "damping_n_s_m", "N s/m", "viscous damping of the suspension"),
    (Q::RingRadius, "ring_radius_m", "m", "distance from the ring's centre to the balls' centres"),
    (Q::ImbalanceMass, "imbalance_mass_kg", "kg", "mass of the imbalance"),
    (
        Q::ImbalanceRadius,
        "imbalance_radius_m",
        "m",
        "distance of the imbalance from the ring's centre",
    ),
    (Q::BallMass, "ball_mass_kg", "kg", "mass"),
    (Q::BallDiameter, "ball_diameter_m", "m", "diameter"),
    (Q::PressingForce, "normal_force_n", "N", "force that presses the block on the ground"),
    (Q::FrictionCoefficient, "friction_coefficient", "1", "coefficient of friction"),
    (
        Q::StaticFrictionCoefficient,
        "static_friction_coefficient",
        "1",
        "coefficient of friction at rest",
    ),
    (
        Q::StribeckSpeed,
        "stribeck_speed_rad_s",
        "rad/s",
        "speed over which friction falls from its static value",
    ),
    (
        Q::SmoothingSpeed,
        "smoothing_speed_rad_s",
        "rad/s",
        "speed at which friction reaches half of its limit",
    ),
    (
        Q::ViscousCoefficient,
        "viscous_coefficient_n_s_m",
        "N s/m",
        "viscous drag force divided by sliding speed",
    ),
    (Q::Speed, "speed_rad_s", "rad/s", "prescribed speed of the disc"),
    (Q::BeltSpeed, "belt_speed_m_s", "m/s", "speed of the belt"),
    (Q::NormalForce, "normal_force", "", "how the normal force is derived"),
];

/// The values of `normal_force` by name.
pub(crate) const NORMAL_FORCES: [(&str, NormalForce); 2] =
    [("lagrange", NormalForce::Lagrange), ("newton", NormalForce::Newton)];

impl Quantity {
    /// Returns name, unit and meaning. The flag decides between the sliding speed of a ball and of
    /// a block.
    fn describe(self, of_balls: bool) -> (&'static str, &'static str, &'static str) {
        let row = QUANTITIES.iter().find(|(quantity, ..)| *quantity == self);
        let (name, unit, meaning) =
            row.map_or(("", "", ""), |(_, name, unit, meaning)| (*name, *unit, *meaning));
        match self {
            Q::StribeckSpeed if !of_balls => ("stribeck_speed_m_s", "m/s", meaning),
            Q::SmoothingSpeed if !of_balls => ("smoothing_speed_m_s", "m/s", meaning),
            _ => (name, unit, meaning),
        }
    }

    fn of_ball(self, ball: &mut Ball) -> Option<&mut f64> {
        match self {
            Q::BallMass => Some(&mut ball.mass_kg),
            Q::BallDiameter => Some(&mut ball.diameter_m),
            Q::FrictionCoefficient => Some(&mut ball.friction_coefficient),
            _ => None,
        }
    }

    fn of_machine(self, machine: &mut Machine) -> Option<&mut f64> {
        match self {
            Q::TableMass => Some(&mut machine.table_mass_kg),
            Q::Stiffness => Some(&mut machine.stiffness_n_m),
            Q::Damping => Some(&mut machine.damping_n_s_m),
            Q::RingRadius => Some(&mut machine.ring_radius_m),
            Q::ImbalanceMass => Some(&mut machine.imbalance_mass_kg),
            Q::ImbalanceRadius => Some(&mut machine.imbalance_radius_m),
            Q::Speed => Some(&mut machine.speed_rad_s),
            _ => None,
        }
    }

    fn of_block(self, block: &mut Block) -> Option<&mut f64> {
        match (self, &mut block.ground) {
            (Q::Mass, _) => Some(&mut block.mass_kg),
            (Q::Stiffness, _) => Some(&mut block.stiffness_n_m),
            (Q::PressingForce, _) => Some(&mut block.normal_force_n),
            (Q::FrictionCoefficient, _) => Some(&mut block.friction_coefficient),
            (Q::BeltSpeed, Ground::Belt { speed_m_s }) => Some(speed_m_s),
            _ => None,
        }
    }

    fn of_friction(self, law: &mut FrictionLaw) -> Option<&mut f64> {
        match (self, law) {
            (
                Q::StaticFrictionCoefficient,
                FrictionLaw::Stribeck { static_friction_coefficient, .. },
            ) => Some(static_friction_coefficient),
            (Q::StribeckSpeed, FrictionLaw::Stribeck { stribeck_speed, .. }) => {
                Some(stribeck_speed)
            }
            (Q::SmoothingSpeed, FrictionLaw::Smooth { smoothing_speed }) => Some(smoothing_speed),
            (Q::ViscousCoefficient, FrictionLaw::Viscous { viscous_coefficient_n_s_m }) => {
                Some(viscous_coefficient_n_s_m)
            }
            _ => None,
        }
    }

    fn is_of_balls(self) -> bool {
        self.of_ball(&mut Ball::default()).is_some()
    }
}

/// A parameter of a model, of all its balls, or of one ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Parameter {
    quantity: Quantity,
    /// The ball, counted from one, if this is the parameter of one ball.
    ball: Option<usize>,
    /// Whether the model has balls.
    of_balls: bool,
}

impl Parameter {
    /// Returns all parameters of a model.
    pub fn all(model: &Model) -> Vec<Parameter> {
        let balls = model.balls();
        let mut model = model.clone();
        let candidates = QUANTITIES.into_iter().flat_map(|(quantity, ..)| {
            let own = if quantity.is_of_balls() { balls } else { 0 };
            let general = std::iter::once(None);
            general.chain((1..=own).map(Some)).map(move |ball| Parameter {
                quantity,
                ball,
                of_balls: balls > 0,
            })
        });
        candidates
            .filter(|parameter| {
                !parameter.is_number() && balls > 0 || !parameter.fields(&mut model).is_empty()
            })
            .collect()
    }

    /// Returns the parameter of this name, if the model has one.
    pub fn find(name: &str, model: &Model) -> Option<Parameter> {
        Parameter::all(model).into_iter().find(|parameter| parameter.name() == name)
    }

    /// Returns the name, as in the study file.
    pub fn name(self) -> String {
        let general = self.quantity.describe(self.of_balls).0;
        self.ball.map_or_else(|| general.to_owned(), |ball| ball_parameter_name(general, ball))
    }

    /// Returns the unit: `1` for dimensionless numbers, empty for words.
    pub fn unit(self) -> &'static str {
        self.quantity.describe(self.of_balls).1
    }

    /// Returns the meaning.
    pub fn meaning(self) -> String {
        let meaning = self.quantity.describe(self.of_balls).2;
        match self.ball {
            Some(ball) => format!("{meaning} of ball {ball}"),
            None if self.is_general() => format!("{meaning} of every ball"),
            None => meaning.to_owned(),
        }
    }

    /// Returns whether the values are numbers.
    pub fn is_number(self) -> bool {
        self.quantity != Q::NormalForce
    }

    /// Returns whether the parameter applies to all balls together.
    pub fn is_general(self) -> bool {
        self.of_balls && self.quantity.is_of_balls() && self.ball.is_none()
    }

    /// Returns the parameter of all balls together, if this is the parameter of one ball.
    pub fn general(self) -> Option<Parameter> {
        self.ball.map(|_| Parameter { ball: None, ..self })
    }

    /// Returns the corresponding parameter of one ball.
    pub fn of_one_ball(self, ball: usize) -> Parameter {
        Parameter { ball: Some(ball), ..self }
    }

    /// Returns whether the model's friction law does not use the parameter.
    pub fn is_unused(self, model: &Model) -> bool {
        self.quantity == Q::FrictionCoefficient
            && matches!(model.friction(), FrictionLaw::Viscous { .. })
    }

    /// Returns the column of the parameter in a table.
    pub fn column(self) -> VariedParameter {
        let kind = if self.is_number() { ParameterKind::Number } else { ParameterKind::Text };
        VariedParameter { name: self.name(), unit: self.unit(), meaning: self.meaning(), kind }
    }

    /// Sets the value in a model; a value of the wrong kind changes nothing.
    pub fn set(self, model: &mut Model, value: ParameterValue) {
        match value {
            ParameterValue::Number(number) => {
                self.fields(model).into_iter().for_each(|field| *field = number);
            }
            ParameterValue::Text(text) => {
                let force = NORMAL_FORCES.into_iter().find(|(name, _)| *name == text);
                if let (Q::NormalForce, Some((_, force)), Some(machine)) =
                    (self.quantity, force, model.ball_balancer_mut())
                {
                    machine.normal_force = force;
                }
            }
        }
    }

    /// Returns the numbers of a model that the parameter sets: several for a parameter of all
    /// balls, none if the model does not have the parameter.
    fn fields(self, model: &mut Model) -> Vec<&mut f64> {
        let quantity = self.quantity;
        if quantity.of_friction(model.friction_mut()).is_some() {
            return quantity.of_friction(model.friction_mut()).into_iter().collect();
        }
        match model {
            Model::Block(block) => quantity.of_block(block).into_iter().collect(),
            Model::BallBalancer(machine) => {
                if !quantity.is_of_balls() {
                    return quantity.of_machine(machine).into_iter().collect();
                }
                let balls = (1..).zip(&mut machine.balls);
                let balls = balls.filter(|(ball, _)| self.ball.is_none_or(|own| own == *ball));
                balls.filter_map(|(_, ball)| quantity.of_ball(ball)).collect()
            }
        }
    }

    /// Sets the default of the balls if this parameter applies to all balls together.
    pub fn set_general(self, general: &mut Ball, number: f64) {
        if let (true, Some(field)) = (self.is_general(), self.quantity.of_ball(general)) {
            *field = number;
        }
    }

    /// Returns the value in a model; `general` contains the default values of the balls.
    pub fn get(self, model: &Model, general: &Ball) -> ParameterValue {
        let mut general = *general;
        if let (true, Some(number)) = (self.is_general(), self.quantity.of_ball(&mut general)) {
            return ParameterValue::Number(*number);
        }
        // A parameter of all balls has returned its general value above.
        if let Some(number) = self.fields(&mut model.clone()).first() {
            return ParameterValue::Number(**number);
        }
        let force = model.ball_balancer().map(|machine| machine.normal_force);
        let found = NORMAL_FORCES.iter().find(|(_, other)| Some(*other) == force);
        ParameterValue::Text(found.map_or("lagrange", |(name, _)| *name))
    }

    /// Checks whether the value alone is possible in a model of this form. [`Model::validate`]
    /// checks values against each other.
    ///
    /// # Errors
    /// Returns a fault if the value is impossible.
    pub fn check(self, number: f64, form: &Model) -> Result<(), Fault> {
        let mut model = form.clone();
        self.set(&mut model, ParameterValue::Number(number));
        if self.quantity == Q::StaticFrictionCoefficient {
            // Its lower bound is another parameter; a single value is only bounded by zero.
            Parameter { quantity: Q::FrictionCoefficient, ball: None, ..self }
                .set(&mut model, ParameterValue::Number(0.0));
        }
        match model.validate() {
            Err(invalid) if invalid.name == self.validated_name() => {
                Err(Fault::new("no physical meaning", describe_number(number), invalid.allowed))
            }
            _ => Ok(()),
        }
    }

    /// Returns the name that the validation reports.
    fn validated_name(self) -> String {
        if self.is_general() { self.of_one_ball(1).name() } else { self.name() }
    }
}
