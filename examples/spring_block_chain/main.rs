//! The Burridge-Knopoff chain: equal blocks on a moving belt, each on a leaf spring, with springs between neighbours.
//!
//! `m ẍ_i = -k x_i + k_c (x_{i+1} - 2 x_i + x_{i-1}) - f_i`, without the terms of missing neighbours. Without
//! dimensions: lengths over `F_n / k`, time times `ω_n = sqrt(k / m)`, forces over `F_n`.

use std::any::{Any, TypeId};
use std::f64::consts::FRAC_PI_2;
use std::process::ExitCode;
use std::sync::Arc;

use stickslip::model::{
    Capabilities, Components, ContactEquations, ContactLayout, ContactMode, ContactUnits,
    Coordinate, DefaultModel, Expression, Friction, Layout, ModelKind, Number, OwnKind, OwnModel,
    ParameterDescriptor as Parameter, Recorder, Registry, SlidingSpeed, Structure, System,
    SystemEquations, Units, add_contact_inputs, record_contact, stiff_pace,
};

static KIND: ModelKind = ModelKind {
    name: "spring_block_chain",
    meaning: "Equal blocks on a moving belt, each on a leaf spring, with springs between neighbours.",
    parameters: &[
        Parameter::count("blocks", "number of blocks", 2, 32),
        Parameter::positive("mass_kg", "kg", "mass of each block", 1.0),
        Parameter::positive("leaf_stiffness_n_m", "N/m", "stiffness of each leaf spring", 100.0),
        Parameter::not_negative("coupling_stiffness_n_m", "N/m", "stiffness between blocks", 50.0),
        Parameter::positive("normal_force_n", "N", "force of each block on the belt", 10.0),
        Parameter::not_negative("friction_coefficient", "1", "coefficient of friction", 0.1),
        Parameter::positive("belt_speed_m_s", "m/s", "speed of the belt", 0.1),
    ],
    body: "block",
    sliding_speed: SlidingSpeed::MS,
    offers: Capabilities::MOTION,
    default: DefaultModel::Own(&Chains),
};

/// What the program asks about a chain in SI units.
struct Chains;

impl OwnKind for Chains {
    fn coordinates(&self, model: &OwnModel) -> Vec<Coordinate> {
        let reach = model.number("normal_force_n") / model.number("leaf_stiffness_n_m");
        let (of_position, of_velocity) = (
            "start position of the block, from where its leaf spring is free",
            "start velocity of the block",
        );
        let position =
            |block| Coordinate::of_body("position_m", block, "m", of_position, [-reach, reach]);
        let velocity =
            |block| Coordinate::of_body("velocity_m_s", block, "m/s", of_velocity, [0.0, 0.0]);
        let blocks = 1..=model.count("blocks");
        blocks.clone().map(position).chain(blocks.map(velocity)).collect()
    }

    fn units(&self, model: &OwnModel) -> Units {
        let length_m = model.number("normal_force_n") / model.number("leaf_stiffness_n_m");
        let natural_rad_s = (model.number("leaf_stiffness_n_m") / model.number("mass_kg")).sqrt();
        let block = ContactUnits::new(length_m, natural_rad_s, model.number("normal_force_n"));
        Units {
            natural_rad_s,
            length_m,
            contacts: vec![block; model.count("blocks")],
            ground_m_s: model.number("belt_speed_m_s"),
            ..Units::default()
        }
    }

    fn system(&self, model: &OwnModel) -> Arc<dyn System> {
        let Units { natural_rad_s, length_m, .. } = self.units(model);
        let (speed_unit, drag_unit) =
            (length_m * natural_rad_s, model.number("mass_kg") * natural_rad_s);
        Arc::new(Chain {
            blocks: model.count("blocks"),
            belt_speed: model.number("belt_speed_m_s") / speed_unit,
            coupling: model.number("coupling_stiffness_n_m") / model.number("leaf_stiffness_n_m"),
            friction: model.contact(speed_unit, drag_unit),
        })
    }

    fn start_state(&self, model: &OwnModel, start: &[f64]) -> Components {
        let Units { natural_rad_s, length_m, ground_m_s, .. } = self.units(model);
        let (positions, velocities) = start.split_at(model.count("blocks"));
        let speeds = velocities.iter().map(|one| (one - ground_m_s) / (length_m * natural_rad_s));
        positions.iter().map(|position| position / length_m).chain(speeds).collect()
    }
}

/// A chain without dimensions. Its state is the position of each block and then its speed relative to the belt.
#[derive(Debug)]
struct Chain {
    blocks: usize,
    belt_speed: f64,
    coupling: f64,
    friction: Friction,
}

impl Chain {
    /// An upper bound of the frequencies of the chain without friction.
    fn highest_frequency(&self) -> f64 {
        (1.0 + 4.0 * self.coupling).sqrt()
    }
}

impl System for Chain {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let x: Vec<Expression<'r>> = (0..self.blocks).map(|_| recorder.state()).collect();
        let speed: Vec<Expression<'r>> = (0..self.blocks).map(|_| recorder.state()).collect();
        let [belt_speed, coupling] =
            ["belt_speed", "coupling"].map(|name| recorder.parameter(name));
        let one = Expression::constant(1.0);
        let (mut velocity, mut acceleration) = (Vec::new(), Vec::new());
        let mut contacts = Vec::new();
        for i in 0..self.blocks {
            let contact = record_contact(recorder, &self.friction, speed[i]);
            let neighbours = [i.checked_sub(1), Some(i + 1).filter(|next| *next < self.blocks)];
            let pulls = neighbours.into_iter().flatten().map(|other| coupling * (x[other] - x[i]));
            let springs = pulls.fold(-x[i], |sum, pull| sum + pull);
            let (stuck, sliding) = (one - contact.free, contact.signed_friction + contact.drag);
            let sliding_acceleration = contact.free * (springs - sliding);
            // A sticking block moves with the belt, and a rest of its speed decays.
            velocity.push(belt_speed + contact.free * speed[i]);
            acceleration.push(sliding_acceleration - stuck * speed[i]);
            contacts.push(ContactEquations {
                sliding_speed: speed[i],
                sliding_acceleration,
                normal: one,
                friction: contact.free * sliding + stuck * springs,
            });
        }
        let layout = Layout {
            contacts: (0..self.blocks)
                .map(|position| ContactLayout { position, angular: false })
                .collect(),
            velocities: (self.blocks..2 * self.blocks).map(|speed| vec![speed]).collect(),
            vibration: None,
            forcing: None,
        };
        let derivative = [velocity, acceleration].concat();
        SystemEquations { derivative, contacts, layout, ..SystemEquations::default() }
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mut inputs = vec![self.belt_speed, self.coupling];
        for mode in modes {
            add_contact_inputs(&mut inputs, *mode, &self.friction);
        }
        inputs
    }

    fn structure(&self) -> Option<Structure> {
        Some((TypeId::of::<Self>(), vec![self.friction.law_name(); self.blocks], Vec::new()))
    }

    fn contacts(&self) -> usize {
        self.blocks
    }

    fn friction(&self, _block: usize) -> &Friction {
        &self.friction
    }

    fn longest_step(&self) -> f64 {
        FRAC_PI_2 / self.highest_frequency()
    }

    fn pace(&self) -> f64 {
        self.highest_frequency() + stiff_pace(self.friction.damping_rate(1.0))
    }

    fn surely_one_solution(&self) -> bool {
        true
    }

    fn one_solution_at(&self, _state: &[f64]) -> bool {
        true
    }

    fn force_scale(&self) -> f64 {
        1.0 + 4.0 * self.coupling
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

fn main() -> ExitCode {
    stickslip::cli::run(Registry::new().with(&KIND))
}
