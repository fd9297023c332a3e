//! Equations that depend on the time, but no longer from some time on, as those of a machine that a pulse has moved.

use super::{Graph, Node};
use crate::model::interval::{Bounded, Interval};

/// Values that differ by no more than this, over 1 and their size, are the same to rounding.
const ROUNDING: f64 = 1e-13;

impl Graph {
    /// Returns whether all functions of the time alone, which is a component of the state, keep their values from an instant on, by
    /// interval arithmetic. `inputs` are the values of the inputs.
    pub fn lasts_from(&self, clock: usize, time: f64, inputs: &[f64]) -> bool {
        let exact =
            |value: f64| Bounded { value: Interval::exact(value), slope: Interval::exact(0.0) };
        let later = Bounded { value: Interval { low: time, high: f64::INFINITY }, ..exact(0.0) };
        // What depends on other components, too, is not a number.
        let state = |component: usize| if component == clock { later } else { exact(f64::NAN) };
        let mut values: Vec<Bounded> = Vec::with_capacity(self.nodes.len());
        let mut is_seen = vec![false; self.nodes.len()];
        for node in &self.nodes {
            let at = |node: u32| values[node as usize];
            let value = match node {
                Node::Solution { .. } => exact(f64::NAN),
                node => node.value(at, |input| exact(inputs[input]), state),
            };
            if value.value.low.is_nan() {
                for operand in node.operands(&self.solves) {
                    is_seen[operand as usize] = true;
                }
            }
            values.push(value);
        }
        let rates = self.derivative.iter().chain(self.contacts.iter().flatten());
        let of_openings = self.openings.iter().flat_map(|of| [of.gap, of.speed, of.acceleration]);
        for node in rates.copied().chain(of_openings) {
            is_seen[node as usize] = true;
        }
        let keeps = |Interval { low, high }: Interval| {
            low.is_nan() || low.is_finite() && high - low <= ROUNDING * low.abs().max(1.0)
        };
        self.events.is_empty()
            && self.gaps.is_empty()
            && values.iter().zip(is_seen).all(|(of, is_seen)| !is_seen || keeps(of.value))
    }
}
