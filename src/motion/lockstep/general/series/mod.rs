//! The power series of all expressions of a recorded system as a straight-line program, order by order.
//!
//! Each operation has a rule for the coefficient of order `k` of its result. The rule reads the coefficients of the
//! operands up to order `k` and those of the result below order `k` (Å. Jorba, M. Zou, Exp. Math. 14 (2005) 99,
//! doi:10.1080/10586458.2005.10128904). Coefficients that are always zero take no part. In a sum, the coefficients that
//! were computed last come last, to avoid waiting for them.
//!
//! Read first `expansion`, the coefficients that are known, then `rules`, which add to them. `screen` bounds the conditions, and `tail` adds the highest powers of a perturbation. This file makes the programs.

mod expansion;
mod rules;
mod screen;
mod tail;

use std::collections::HashMap;

use super::operations::{Operations, Slot};
use super::radius::radii;
use crate::graph::{Builder, Cell, tangent};
use crate::motion::lockstep::run::Runner;
use crate::motion::lockstep::{ORDER, TERMS};
use expansion::{Expansion, LowerOrders};
pub(super) use screen::{ConditionBound, Screen};

/// The programs of a step; each runs after those before it, if at all.
#[derive(Debug)]
pub(super) struct Programs {
    /// Computes what depends on parameters alone.
    pub(super) fixed: Runner,
    /// Computes what depends on parameters and modes alone; it runs after `fixed`.
    pub(super) modes: Runner,
    /// Expands the motion from the state, and the friction forces; it runs after `modes`.
    pub(super) motion: Runner,
    /// Expands the motion and keeps what `perturbation` needs.
    pub(super) perturbed_motion: Runner,
    /// Expands the normal forces; it runs after `motion`.
    pub(super) normals: Runner,
    /// Bounds the conditions; it runs after `motion`, or after `normals` if [`Screen::needs_normals`].
    pub(super) screen: (Runner, Screen),
    /// Bounds the conditions with the series of the normal forces, if `screen` does not; it runs after `normals`.
    pub(super) exact_screen: Option<(Runner, Screen)>,
    /// Expands a perturbation of the state; it runs after `perturbed_motion`.
    pub(super) perturbation: Runner,
    /// Adds the highest powers of the perturbation; it runs after `perturbation`.
    pub(super) tail: Runner,
    /// Computes what does not depend on the modes at one instant; it runs after `fixed`.
    pub(super) instant: Runner,
    /// Computes rates and forces at one instant; it runs after `instant`.
    pub(super) decision: Runner,
    /// Computes the rates of change of the forces; it runs after `decision`.
    pub(super) ahead: Runner,
}

impl Operations {
    /// Returns the programs of a step.
    pub(super) fn programs(&self) -> Programs {
        let components = 0..self.rates.len() as Slot;
        let mut expansion = Expansion {
            of: self,
            builder: Builder::with_cells(self.cells()),
            not_zero: vec![false; self.slots * TERMS],
            lower: self.all.iter().map(|_| LowerOrders::default()).collect(),
            ahead: HashMap::new(),
            known: vec![0; self.slots],
            running: Vec::new(),
        };
        components.clone().for_each(|slot| {
            expansion.place(slot, 0);
        });
        self.statics.emit(&mut expansion.builder);
        for k in 0..ORDER {
            expansion.begin_order(k);
            for (place, operation) in self.all.iter().enumerate() {
                expansion.apply(place, operation, k);
            }
            expansion.next_state(k);
        }
        expansion.last_of_positions();
        let of_contacts = |which: usize| self.contacts.iter().map(move |contact| contact[which]);
        let radii = radii(self, of_contacts(2));
        let exact = radii.is_some().then(|| expansion.screen(None));
        let screen = expansion.screen(radii.as_deref());
        let Expansion { builder, not_zero, .. } = expansion;
        let series = |slot: Slot| {
            let orders = (0..TERMS).filter(|k| not_zero[slot as usize * TERMS + k]);
            orders.map(|k| self.coefficient(slot, k)).collect::<Vec<_>>()
        };
        let moved: Vec<Slot> = components.clone().chain(of_contacts(0)).collect();
        let watched = of_contacts(1).chain(of_contacts(3)).chain(self.guards.iter().copied());
        let watched = moved.iter().copied().chain(watched).chain(self.gaps.iter().copied());
        let watched = watched.chain(self.exponents()).chain(self.forces_over_time());
        let rates = self.rates.iter().map(|rate| self.coefficient(*rate, 0));
        let in_motion: Vec<Cell> = watched.flat_map(series).chain(rates.clone()).collect();
        let normals: Vec<Cell> = of_contacts(2).flat_map(series).collect();
        let forces = |k: usize| {
            let slots = self.contacts.iter().flatten();
            slots.map(|slot| self.coefficient(*slot, k)).collect::<Vec<_>>()
        };
        let (screened, exactly) =
            (screen.cells(), exact.as_ref().map_or(Vec::new(), Screen::cells));
        let kept = in_motion.iter().chain(&normals).chain(&screened).chain(&exactly).copied();
        let all = builder.finish(kept.chain(forces(1)));
        let states: Vec<Cell> = components.clone().map(|slot| self.coefficient(slot, 0)).collect();
        let of_modes = self.inputs[0].iter().chain(&self.discrete);
        let of_modes: Vec<Cell> = of_modes.map(|(cell, _)| *cell).collect();
        let conditions = self.length()..self.cells() as Cell;
        let varying = states.iter().chain(&of_modes).copied().chain(conditions.clone());
        let [mut fixed, varying] = all.split(varying);
        let [mut modes, expansion] = varying.split(states.iter().copied().chain(conditions));
        let [motion, by_bounds, normals, by_series] = match exact {
            None => expansion.parts([&in_motion, &[], &normals, &screened]),
            Some(_) => expansion.parts([&in_motion, &screened, &normals, &exactly]),
        };
        let [by_bounds, by_series] = [by_bounds, by_series].map(Runner::new);
        let (screen, exact_screen) = match exact {
            None => ((by_series, screen), None),
            Some(exact) => ((by_bounds, screen), Some((by_series, exact))),
        };
        // The highest coefficients of the components come with the powers above them.
        let highest = components.clone().map(|slot| self.coefficient(slot, TERMS - 1));
        let highest: Vec<Cell> = highest.collect();
        let series = moved.into_iter().flat_map(series).filter(|cell| !highest.contains(cell));
        let perturbation = tangent(&motion, states, series);
        let mut perturbed_motion = motion.clone();
        let [of_rates] = expansion.parts([&rates.clone().collect::<Vec<_>>()]);
        let tail = tail::tail(self, &of_rates, &perturbation);
        for program in [&mut fixed, &mut modes, &mut perturbed_motion] {
            program.keep_for(&perturbation);
            program.keep_for(&tail);
        }
        let at_instant = [forces(0), rates.collect()].concat();
        let [at_instant, ahead] = varying.parts([&at_instant, &forces(1)]);
        let [instant, decision] = at_instant.split(of_modes);
        Programs {
            fixed: Runner::new(fixed),
            modes: Runner::new(modes),
            motion: Runner::new(motion),
            perturbed_motion: Runner::new(perturbed_motion),
            normals: Runner::new(normals),
            screen,
            exact_screen,
            perturbation: Runner::new(perturbation),
            tail: Runner::new(tail),
            instant: Runner::new(instant),
            decision: Runner::new(decision),
            ahead: Runner::new(ahead),
        }
    }
}
