//! The parameters that a study may sweep or draw: names, units, meaning, and how each is set.

use std::fmt;

use crate::model::{Ball, Machine, NormalForce, ball_parameter_name};

/// The value of a parameter at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// A number in the parameter's unit.
    Number(f64),
    /// One of the parameter's words, such as `newton`.
    Text(&'static str),
}

impl fmt::Display for ParameterValue {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParameterValue::Number(number) => out.write_str(&super::node::describe_number(*number)),
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

/// A parameter that differs between points or runs: one column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VariedParameter {
    /// Name, as in the study file and in tables.
    pub name: String,
    /// Unit, such as `kg`; `1` for dimensionless numbers, empty for words.
    pub unit: &'static str,
    /// What it means, in a few words.
    pub meaning: String,
    /// Numbers or words.
    pub kind: ParameterKind,
}

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Quantity {
    TableMass,
    Stiffness,
    Damping,
    RingRadius,
    ImbalanceMass,
    ImbalanceRadius,
    BallMass,
    BallDiameter,
    FrictionCoefficient,
    Speed,
    NormalForce,
}

use Quantity as Q;

const QUANTITIES: [Quantity; 11] = [
    Q::TableMass,
    Q::Stiffness,
    Q::Damping,
    Q::RingRadius,
    Q::ImbalanceMass,
    Q::ImbalanceRadius,
    Q::BallMass,
    Q::BallDiameter,
    Q::FrictionCoefficient,
    Q::Speed,
    Q::NormalForce,
];

/// The words of `normal_force`.
pub(crate) const NORMAL_FORCES: [(&str, NormalForce); 2] =
    [("lagrange", NormalForce::Lagrange), ("newton", NormalForce::Newton)];

impl Quantity {
    /// Name, unit and meaning.
    fn describe(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Q::TableMass => ("table_mass_kg", "kg", "mass of table, motor, ring and disc"),
            Q::Stiffness => ("stiffness_n_m", "N/m", "spring stiffness of the suspension"),
            Q::Damping => ("damping_n_s_m", "N s/m", "viscous damping of the suspension"),
            Q::RingRadius => {
                ("ring_radius_m", "m", "distance from the ring's centre to the balls' centres")
            }
            Q::ImbalanceMass => ("imbalance_mass_kg", "kg", "mass of the imbalance"),
            Q::ImbalanceRadius => {
                ("imbalance_radius_m", "m", "distance of the imbalance from the ring's centre")
            }
            Q::BallMass => ("ball_mass_kg", "kg", "mass"),
            Q::BallDiameter => ("ball_diameter_m", "m", "diameter"),
            Q::FrictionCoefficient => ("friction_coefficient", "1", "coefficient of friction"),
            Q::Speed => ("speed_rad_s", "rad/s", "prescribed speed of the disc"),
            Q::NormalForce => ("normal_force", "", "how the normal force is derived"),
        }
    }

    fn is_of_balls(self) -> bool {
        matches!(self, Q::BallMass | Q::BallDiameter | Q::FrictionCoefficient)
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
}

/// A parameter of the machine, of all its balls, or of one ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Parameter {
    quantity: Quantity,
    /// The ball, counted from one, where one ball's own value is meant.
    ball: Option<usize>,
}

impl Parameter {
    /// Every parameter of a machine with so many balls.
    pub fn all(balls: usize) -> Vec<Parameter> {
        QUANTITIES
            .into_iter()
            .flat_map(|quantity| {
                let own = if quantity.is_of_balls() { balls } else { 0 };
                let of_one = (1..=own).map(move |ball| Parameter { quantity, ball: Some(ball) });
                std::iter::once(Parameter { quantity, ball: None }).chain(of_one)
            })
            .collect()
    }

    /// The parameter of this name in a machine with so many balls.
    pub fn find(name: &str, balls: usize) -> Option<Parameter> {
        Parameter::all(balls).into_iter().find(|parameter| parameter.name() == name)
    }

    /// Name, as in the study file.
    pub fn name(self) -> String {
        let general = self.quantity.describe().0;
        self.ball.map_or_else(|| general.to_owned(), |ball| ball_parameter_name(general, ball))
    }

    /// Unit; `1` for dimensionless numbers, empty for words.
    pub fn unit(self) -> &'static str {
        self.quantity.describe().1
    }

    /// What it means.
    pub fn meaning(self) -> String {
        let meaning = self.quantity.describe().2;
        match self.ball {
            Some(ball) => format!("{meaning} of ball {ball}"),
            None if self.quantity.is_of_balls() => format!("{meaning} of every ball"),
            None => meaning.to_owned(),
        }
    }

    /// Whether its values are numbers.
    pub fn is_number(self) -> bool {
        self.quantity != Q::NormalForce
    }

    /// Whether it is the value of all balls together.
    pub fn is_general(self) -> bool {
        self.quantity.is_of_balls() && self.ball.is_none()
    }

    /// The parameter of all balls together that this one ball's parameter refines.
    pub fn general(self) -> Option<Parameter> {
        self.ball.map(|_| Parameter { quantity: self.quantity, ball: None })
    }

    /// The same parameter of one ball.
    pub fn of_one_ball(self, ball: usize) -> Parameter {
        Parameter { quantity: self.quantity, ball: Some(ball) }
    }

    /// The column that it makes in a table.
    pub fn column(self) -> VariedParameter {
        let kind = if self.is_number() { ParameterKind::Number } else { ParameterKind::Text };
        VariedParameter { name: self.name(), unit: self.unit(), meaning: self.meaning(), kind }
    }

    /// Sets the value in a machine; a value of the wrong kind changes nothing.
    pub fn set(self, machine: &mut Machine, value: ParameterValue) {
        match value {
            ParameterValue::Number(number) => {
                if let Some(field) = self.quantity.of_machine(machine) {
                    *field = number;
                }
                for (index, ball) in machine.balls.iter_mut().enumerate() {
                    let meant = self.ball.is_none_or(|ball| ball == index + 1);
                    if let (true, Some(field)) = (meant, self.quantity.of_ball(ball)) {
                        *field = number;
                    }
                }
            }
            ParameterValue::Text(text) => {
                for (name, normal_force) in NORMAL_FORCES {
                    if self.quantity == Q::NormalForce && name == text {
                        machine.normal_force = normal_force;
                    }
                }
            }
        }
    }

    /// The value in a machine; `general` holds the values of balls that have none of their own.
    pub fn get(self, machine: &Machine, general: &Ball) -> ParameterValue {
        let mut machine = machine.clone();
        let mut ball = match self.ball {
            Some(ball) => machine.balls.get(ball - 1).copied().unwrap_or(*general),
            None => *general,
        };
        if let Some(number) = self.quantity.of_ball(&mut ball) {
            return ParameterValue::Number(*number);
        }
        if let Some(number) = self.quantity.of_machine(&mut machine) {
            return ParameterValue::Number(*number);
        }
        let found = NORMAL_FORCES.iter().find(|(_, force)| *force == machine.normal_force);
        ParameterValue::Text(found.map_or("lagrange", |(name, _)| *name))
    }

    /// What is wrong with a value: the finding and what is allowed.
    pub fn check(self, number: f64) -> Result<(), &'static str> {
        let mut machine = Machine::default();
        machine.balls.resize(self.ball.unwrap_or(1).max(1), Ball::default());
        self.set(&mut machine, ParameterValue::Number(number));
        machine.validate().map_err(|invalid| invalid.allowed)
    }
}
