//! Resolution of the model, with all defaults.

use crate::model::{Ball, Block, Ground, MAX_BALLS, Machine, Model, NormalForce};
use crate::study::error::{Fault, Locate, StudyError};
use crate::study::file::balls::{BallFile, Balls};
use crate::study::file::key_path::KeyPath;
use crate::study::file::study_file::{ModelFile, ModelKind, NormalForceKind, ParametersFile};
use crate::study::file::yaml_tree::describe_number;
use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::resolve::friction::{check_friction, friction_to_file, resolve_friction};

/// The model before any parameter is swept or drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    /// The model.
    pub model: Model,
    /// Default values of the balls.
    pub general: Ball,
    /// The own values of each ball.
    own: Vec<BallFile>,
}

impl Base {
    /// Validates the parameters and fills in the defaults.
    ///
    /// # Errors
    /// Returns an error for the first parameter that the model does not have or that is physically
    /// impossible.
    pub fn resolve(locate: &dyn Locate, written: &ModelFile) -> Result<Base, StudyError> {
        let path = KeyPath::of("model.parameters");
        let given = written.parameters.clone().unwrap_or_default();
        let friction = resolve_friction(locate, written)?;
        // One ball represents all balls until all values are known.
        let mut model = match written.kind {
            ModelKind::BallBalancer => Model::BallBalancer(Machine {
                balls: vec![Ball::default()],
                friction,
                ..Machine::default()
            }),
            ModelKind::BlockOnSpring => Model::Block(Block { friction, ..Block::on_spring() }),
            ModelKind::BlockOnBelt => Model::Block(Block { friction, ..Block::on_belt() }),
        };
        for (name, value) in numbers(&given) {
            let Some(value) = value else { continue };
            let Some(parameter) = Parameter::find(name, &model) else {
                let own = numbers(&given).map(|(name, _)| name);
                let own = own.into_iter().filter(|name| Parameter::find(name, &model).is_some());
                let allowed = own.collect::<Vec<_>>().join(", ");
                let problem = format!("not a parameter of {}", model.kind());
                return Err(locate.refuse_key(&path.key(name), Fault::new(problem, name, allowed)));
            };
            check(locate, &path.key(name), parameter, &model, value)?;
            parameter.set(&mut model, ParameterValue::Number(value));
        }
        let (mut general, mut own) = (Ball::default(), Vec::new());
        match &mut model {
            Model::BallBalancer(machine) => {
                machine.normal_force = match written.normal_force {
                    None | Some(NormalForceKind::Lagrange) => NormalForce::Lagrange,
                    Some(NormalForceKind::Newton) => NormalForce::Newton,
                };
                general = machine.balls.first().copied().unwrap_or_default();
                own = own_values(locate, &path.key("balls"), given.balls.as_ref())?;
                machine.balls = own.iter().map(|ball| overlay(general, ball)).collect();
            }
            Model::Block(_) => {
                let foreign = [
                    (path.key("balls"), given.balls.is_some()),
                    (KeyPath::of("model.normal_force"), written.normal_force.is_some()),
                ];
                if let Some((path, _)) = foreign.into_iter().find(|(_, given)| *given) {
                    let allowed = "kind: ball_balancer, or no such key";
                    let found = format!("kind: {}", model.kind());
                    let fault = Fault::new("only for a ball balancer", found, allowed);
                    return Err(locate.refuse_key(&path, fault));
                }
            }
        }
        check_friction(locate, &model)?;
        Ok(Base { model, general, own })
    }

    /// Checks whether a parameter may vary. A value of all balls may not vary if one ball has its
    /// own value, which would be ambiguous. A parameter that the friction law does not use may not
    /// vary either.
    ///
    /// # Errors
    /// Returns a fault that names the parameters to vary instead.
    pub fn check_varied(&self, parameter: Parameter) -> Result<(), Fault> {
        if parameter.is_unused(&self.model) {
            let allowed = "viscous_coefficient_n_s_m, or another friction law";
            return Err(Fault::new("viscous friction does not use it", parameter.name(), allowed));
        }
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
                let problem = "a ball has its own value";
                Err(Fault::new(problem, found, allowed.join(", ")))
            }
        }
    }

    /// Returns whether any ball has its own values.
    pub fn has_own(&self) -> bool {
        self.own.iter().any(|ball| *ball != BallFile::default())
    }

    /// Returns the model in the form of a study file, with all values.
    pub fn to_file(&self) -> ModelFile {
        let alike = self.own.iter().all(|ball| *ball == BallFile::default());
        let balls = if alike {
            Balls::Number(self.own.len() as u64)
        } else {
            Balls::Each(self.own.clone())
        };
        let (kind, parameters, normal_force) = match &self.model {
            Model::BallBalancer(machine) => {
                let parameters = ParametersFile {
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
                    ..ParametersFile::default()
                };
                let normal_force = match machine.normal_force {
                    NormalForce::Lagrange => NormalForceKind::Lagrange,
                    NormalForce::Newton => NormalForceKind::Newton,
                };
                (ModelKind::BallBalancer, parameters, Some(normal_force))
            }
            Model::Block(block) => {
                let (kind, belt_speed_m_s) = match block.ground {
                    Ground::Fixed => (ModelKind::BlockOnSpring, None),
                    Ground::Belt { speed_m_s } => (ModelKind::BlockOnBelt, Some(speed_m_s)),
                };
                let parameters = ParametersFile {
                    mass_kg: Some(block.mass_kg),
                    stiffness_n_m: Some(block.stiffness_n_m),
                    normal_force_n: Some(block.normal_force_n),
                    friction_coefficient: Some(block.friction_coefficient),
                    belt_speed_m_s,
                    ..ParametersFile::default()
                };
                (kind, parameters, None)
            }
        };
        ModelFile {
            kind,
            parameters: Some(parameters),
            friction: Some(friction_to_file(self.model.friction(), kind)),
            normal_force,
        }
    }
}

fn numbers(given: &ParametersFile) -> [(&'static str, Option<f64>); 13] {
    [
        ("table_mass_kg", given.table_mass_kg),
        ("mass_kg", given.mass_kg),
        ("stiffness_n_m", given.stiffness_n_m),
        ("damping_n_s_m", given.damping_n_s_m),
        ("ring_radius_m", given.ring_radius_m),
        ("imbalance_mass_kg", given.imbalance_mass_kg),
        ("imbalance_radius_m", given.imbalance_radius_m),
        ("ball_mass_kg", given.ball_mass_kg),
        ("ball_diameter_m", given.ball_diameter_m),
        ("normal_force_n", given.normal_force_n),
        ("friction_coefficient", given.friction_coefficient),
        ("speed_rad_s", given.speed_rad_s),
        ("belt_speed_m_s", given.belt_speed_m_s),
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
            let form = Model::BallBalancer(Machine::default());
            if let (Some(parameter), Some(value)) = (Parameter::find(general, &form), value) {
                check(locate, &path.item(index).key(key), parameter, &form, value)?;
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
    form: &Model,
    value: f64,
) -> Result<(), StudyError> {
    parameter.check(value, form).map_err(|allowed| {
        let fault = Fault::new("no physical meaning", describe_number(value), allowed);
        locate.refuse_value(path, fault)
    })
}
