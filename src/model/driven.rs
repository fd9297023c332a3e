//! A balancer whose disc turns with a speed that is a polynomial of time, as one part of a speed profile prescribes it.
//!
//! The time since the begin of the part is the last component of the state.

use std::any::{Any, TypeId};
use std::sync::Arc;

use super::recorded_balancer::{DiscSpeed, DrivenDisc};
use super::system::pass_on;
use super::{
    Balancer, BallsInContact, ContactMode, Expression, Friction, Machine, Number, Recorder,
    SPEED_TERMS, Structure, System, SystemEquations, Touching,
};

/// A balancer whose disc turns with a speed that changes.
#[derive(Clone, Debug)]
struct Driven<const N: usize, B> {
    /// The balancer at the largest speed of the part, for bounds.
    fastest: B,
    /// The coefficients of the speed over `ω_n`, as a polynomial of the time since the begin of the part.
    speed: [f64; SPEED_TERMS],
}

impl Machine {
    /// Returns the system of this machine at constant speed, or at the largest speed while its disc turns with this speed over
    /// `ω_n`; `None` for an unsupported number of balls. The balls with contact have the order of these angles.
    pub(super) fn driven(
        &self,
        angles: &[f64],
        speed: impl Into<Option<[f64; SPEED_TERMS]>>,
    ) -> Option<Arc<dyn System>> {
        fn of<const N: usize>(
            machine: &Machine,
            angles: &[f64],
            speed: Option<[f64; SPEED_TERMS]>,
        ) -> Option<Arc<dyn System>> {
            Some(match &machine.contact {
                None => turning(Balancer::<N>::new(machine)?, speed),
                Some(contact) => {
                    turning(BallsInContact::<N>::new(machine, contact, angles)?, speed)
                }
            })
        }
        fn turning<const N: usize>(
            fastest: impl DrivenDisc<N> + 'static,
            speed: Option<[f64; SPEED_TERMS]>,
        ) -> Arc<dyn System> {
            match speed {
                Some(speed) => Arc::new(Driven { fastest, speed }),
                None => Arc::new(fastest),
            }
        }
        let speed = speed.into();
        match self.balls.len() {
            1 => of::<1>(self, angles, speed),
            2 => of::<2>(self, angles, speed),
            3 => of::<3>(self, angles, speed),
            4 => of::<4>(self, angles, speed),
            5 => of::<5>(self, angles, speed),
            6 => of::<6>(self, angles, speed),
            7 => of::<7>(self, angles, speed),
            8 => of::<8>(self, angles, speed),
            _ => None,
        }
    }
}

/// Returns the value of a polynomial and of its derivative.
fn polynomial<T: Number>(coefficients: &[T], at: T) -> [T; 2] {
    let zero = T::constant(0.0);
    coefficients.iter().rev().fold([zero; 2], |[value, slope], coefficient| {
        [value * at + *coefficient, slope * at + value]
    })
}

impl<const N: usize, B: DrivenDisc<N>> System for Driven<N, B> {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let turning = || {
            let time = recorder.state();
            let terms = self.speed.map(|_| recorder.parameter("speed_term"));
            let [speed, acceleration] = polynomial(&terms, time);
            Some(DiscSpeed { speed, acceleration })
        };
        let mut equations = self.fastest.record_turning(recorder, turning);
        equations.derivative.push(Expression::constant(1.0));
        equations
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let mut inputs = self.speed.to_vec();
        inputs.extend(self.fastest.inputs_turning(modes, true));
        inputs
    }

    fn structure(&self) -> Option<Structure> {
        let (_, laws, order) = self.fastest.structure()?;
        Some((TypeId::of::<Self>(), laws, order))
    }

    pass_on! { fastest:
        fn contacts() -> usize;
        fn friction(contact: usize) -> &Friction;
        fn longest_step() -> f64;
        fn fastest_rate() -> f64;
        fn fewest_steps() -> f64;
        fn surely_one_solution() -> bool;
        fn force_scale() -> f64;
        fn jump_of_balls(state: &mut [f64], jump: [f64; 2]) -> u32;
        fn touching() -> Option<&dyn Touching>;
    }

    fn one_solution_at(&self, state: &[f64]) -> bool {
        state.split_last().is_some_and(|(_, state)| self.fastest.one_solution_at(state))
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
