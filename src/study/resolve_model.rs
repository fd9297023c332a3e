//! From the model and simulation as written to a checked machine and settings with all defaults.

use super::error::{Fault, Locate, StudyError};
use super::file::{
    BallFile, FrictionKind, MethodKind, ModelFile, ModelKind, NormalForceKind, ParametersFile,
    SimulationFile, ToleranceFile,
};
use super::file_values::Balls;
use super::key_path::KeyPath;
use super::node::describe_number;
use super::parameter::{Parameter, ParameterValue};
use crate::model::{Ball, MAX_BALLS, Machine, Method, NormalForce, Simulation};

/// The machine before anything is swept or drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    /// The machine.
    pub machine: Machine,
    /// Values of balls that have none of their own.
    pub general: Ball,
    /// What each ball has of its own.
    own: Vec<BallFile>,
}

impl Base {
    /// Checks the parameters and fills in the thesis's values for those not given.
    ///
    /// # Errors
    /// The first parameter that makes no physical sense.
    pub fn resolve(locate: &dyn Locate, written: &ModelFile) -> Result<Base, StudyError> {
        let path = KeyPath::of("model.parameters");
        let given = written.parameters.clone().unwrap_or_default();
        let mut machine = Machine { balls: vec![Ball::default()], ..Machine::default() };
        for (name, value) in numbers(&given) {
            let (Some(parameter), Some(value)) = (Parameter::find(name, 1), value) else {
                continue;
            };
            check(locate, &path.key(name), parameter, value)?;
            parameter.set(&mut machine, ParameterValue::Number(value));
        }
        machine.normal_force = match written.normal_force {
            None | Some(NormalForceKind::Lagrange) => NormalForce::Lagrange,
            Some(NormalForceKind::Newton) => NormalForce::Newton,
        };
        let general = machine.balls.first().copied().unwrap_or_default();
        let own = own_values(locate, &path.key("balls"), given.balls.as_ref())?;
        machine.balls = own.iter().map(|ball| overlay(general, ball)).collect();
        Ok(Base { machine, general, own })
    }

    /// Number of balls.
    pub fn balls(&self) -> usize {
        self.own.len()
    }

    /// Refuses to vary a value of all balls where one ball has its own: which would count?
    ///
    /// # Errors
    /// What is found and what to vary instead.
    pub fn check_varied(&self, parameter: Parameter) -> Result<(), Fault> {
        if !parameter.is_general() {
            return Ok(());
        }
        let name = parameter.name();
        let has_own = |ball: &BallFile| match name.as_str() {
            "ball_mass_kg" => ball.mass_kg.is_some(),
            "ball_diameter_m" => ball.diameter_m.is_some(),
            _ => ball.friction_coefficient.is_some(),
        };
        match self.own.iter().position(has_own) {
            None => Ok(()),
            Some(index) => {
                let found = format!("{name}, while ball {} has its own value", index + 1);
                let one = |ball| parameter.of_one_ball(ball).name();
                let allowed: Vec<String> = (1..=self.own.len()).map(one).collect();
                let problem = "a value of all balls where one ball has its own";
                Err(Fault::new(problem, found, allowed.join(", ")))
            }
        }
    }

    /// The model with every value written out.
    pub fn to_file(&self) -> ModelFile {
        let alike = self.own.iter().all(|ball| *ball == BallFile::default());
        let balls = if alike {
            Balls::Number(self.own.len() as u64)
        } else {
            Balls::Each(self.own.clone())
        };
        let machine = &self.machine;
        ModelFile {
            kind: ModelKind::BallBalancer,
            parameters: Some(ParametersFile {
                table_mass_kg: Some(machine.table_mass_kg),
                stiffness_n_m: Some(machine.stiffness_n_m),
                damping_n_s_m: Some(machine.damping_n_s_m),
                ring_radius_m: Some(machine.ring_radius_m),
                imbalance_mass_kg: Some(machine.imbalance_mass_kg),
                imbalance_radius_m: Some(machine.imbalance_radius_m),
                balls: Some(balls),
                ball_mass_kg: Some(self.general.mass_kg),
                ball_diameter_m: Some(self.general.diameter_m),
                friction_coefficient: Some(self.general.friction_coefficient),
                speed_rad_s: Some(machine.speed_rad_s),
            }),
            friction: Some(FrictionKind::Coulomb),
            normal_force: Some(match machine.normal_force {
                NormalForce::Lagrange => NormalForceKind::Lagrange,
                NormalForce::Newton => NormalForceKind::Newton,
            }),
        }
    }
}

fn numbers(given: &ParametersFile) -> [(&'static str, Option<f64>); 10] {
    [
        ("table_mass_kg", given.table_mass_kg),
        ("stiffness_n_m", given.stiffness_n_m),
        ("damping_n_s_m", given.damping_n_s_m),
        ("ring_radius_m", given.ring_radius_m),
        ("imbalance_mass_kg", given.imbalance_mass_kg),
        ("imbalance_radius_m", given.imbalance_radius_m),
        ("ball_mass_kg", given.ball_mass_kg),
        ("ball_diameter_m", given.ball_diameter_m),
        ("friction_coefficient", given.friction_coefficient),
        ("speed_rad_s", given.speed_rad_s),
    ]
}

fn own_values(
    locate: &dyn Locate,
    path: &KeyPath,
    balls: Option<&Balls>,
) -> Result<Vec<BallFile>, StudyError> {
    let number = match balls {
        None => Machine::default().balls.len() as u64,
        Some(Balls::Number(number)) => *number,
        Some(Balls::Each(own)) => own.len() as u64,
    };
    if !(1..=MAX_BALLS as u64).contains(&number) {
        let allowed = format!("between 1 and {MAX_BALLS} balls");
        let fault = Fault::new("wrong number of balls", number.to_string(), allowed);
        return Err(locate.refuse_value(path, fault));
    }
    let Some(Balls::Each(own)) = balls else {
        return Ok((0..number).map(|_| BallFile::default()).collect());
    };
    for (index, ball) in own.iter().enumerate() {
        for (key, general, value) in [
            ("mass_kg", "ball_mass_kg", ball.mass_kg),
            ("diameter_m", "ball_diameter_m", ball.diameter_m),
            ("friction_coefficient", "friction_coefficient", ball.friction_coefficient),
        ] {
            if let (Some(parameter), Some(value)) = (Parameter::find(general, 1), value) {
                check(locate, &path.item(index).key(key), parameter, value)?;
            }
        }
    }
    Ok(own.clone())
}

fn overlay(general: Ball, own: &BallFile) -> Ball {
    Ball {
        mass_kg: own.mass_kg.unwrap_or(general.mass_kg),
        diameter_m: own.diameter_m.unwrap_or(general.diameter_m),
        friction_coefficient: own.friction_coefficient.unwrap_or(general.friction_coefficient),
    }
}

fn check(
    locate: &dyn Locate,
    path: &KeyPath,
    parameter: Parameter,
    value: f64,
) -> Result<(), StudyError> {
    parameter.check(value).map_err(|allowed| {
        let fault = Fault::new("no physical meaning", describe_number(value), allowed);
        locate.refuse_value(path, fault)
    })
}

/// In a wider band, balls that move count as standing, and may switch between stick and transition
/// without end.
const WIDEST_BAND: f64 = 1.0e-2;

/// Checks how runs are integrated and fills in the defaults.
///
/// # Errors
/// A band, tolerance or end time that is not positive; a band that is too wide to be one.
pub(crate) fn resolve_simulation(
    locate: &dyn Locate,
    written: Option<&SimulationFile>,
) -> Result<Simulation, StudyError> {
    let default = Simulation::default();
    let given = written.cloned().unwrap_or_default();
    let tolerance = given.tolerance.unwrap_or_default();
    let positive = |keys: &str, given: Option<f64>, default: f64| {
        let value = given.unwrap_or(default);
        if value.is_finite() && value > 0.0 {
            return Ok(value);
        }
        let allowed = "a positive, finite number";
        let fault = Fault::new("not positive", describe_number(value), allowed);
        Err(locate.refuse_value(&KeyPath::of(keys), fault))
    };
    let band = positive("simulation.band", given.band, default.band)?;
    if band > WIDEST_BAND {
        let allowed = format!("at most {WIDEST_BAND}; results are better the narrower it is");
        let fault = Fault::new("too wide", describe_number(band), allowed);
        return Err(locate.refuse_value(&KeyPath::of("simulation.band"), fault));
    }
    Ok(Simulation {
        method: match given.method {
            None | Some(MethodKind::Switch) => Method::Switch,
            Some(MethodKind::Event) => Method::Event,
        },
        band,
        end_time_s: positive("simulation.end_time_s", given.end_time_s, default.end_time_s)?,
        relative_tolerance: positive(
            "simulation.tolerance.relative",
            tolerance.relative,
            default.relative_tolerance,
        )?,
        absolute_tolerance: positive(
            "simulation.tolerance.absolute",
            tolerance.absolute,
            default.absolute_tolerance,
        )?,
    })
}

/// The simulation with every value written out.
pub(crate) fn simulation_to_file(simulation: &Simulation) -> SimulationFile {
    SimulationFile {
        method: Some(match simulation.method {
            Method::Switch => MethodKind::Switch,
            Method::Event => MethodKind::Event,
        }),
        band: Some(simulation.band),
        end_time_s: Some(simulation.end_time_s),
        tolerance: Some(ToleranceFile {
            relative: Some(simulation.relative_tolerance),
            absolute: Some(simulation.absolute_tolerance),
        }),
    }
}
