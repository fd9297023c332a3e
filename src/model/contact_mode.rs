//! How a contact moves during a step, and what that means in recorded equations.

use super::{Contact, Expression, Friction, Recorder};

/// How a contact moves during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactMode {
    /// It sticks.
    Stick,
    /// It slips in a direction, 1 or -1; a law that cannot stick ignores the direction.
    Slip(f64),
    /// It sets off in a direction: its friction is that at the speed 0, whatever its residual speed.
    BreakingAway(f64),
    /// Its bodies do not touch.
    Apart,
    /// It is a gap, and there is no force in it.
    Open,
    /// It is a gap, and its two contacts touch.
    Closed,
}

impl ContactMode {
    /// Returns the direction in which a contact slips or sets off; 0 if it sticks.
    pub fn direction(self) -> f64 {
        match self {
            ContactMode::Slip(direction) | ContactMode::BreakingAway(direction) => direction,
            _ => 0.0,
        }
    }
}

/// Adds the values of the inputs of a contact that [`record_contact`] records: its mode and the numbers of its law.
pub fn add_contact_inputs(inputs: &mut Vec<f64>, mode: ContactMode, friction: &Friction) {
    inputs.extend_from_slice(&match mode {
        ContactMode::Stick | ContactMode::Open | ContactMode::Closed => [0.0, 0.0, 0.0],
        ContactMode::Apart => [1.0, 0.0, 0.0],
        ContactMode::Slip(direction) => [1.0, direction, 1.0],
        ContactMode::BreakingAway(direction) => [1.0, direction, 0.0],
    });
    inputs.extend_from_slice(&friction.expression_inputs());
}

/// Adds the values of the inputs of a contact that a [`super::Mechanism`] records; `opens` if its normal force is that of a
/// gap.
pub fn add_mechanism_inputs(
    inputs: &mut Vec<f64>,
    mode: ContactMode,
    friction: &Friction,
    opens: bool,
) {
    add_contact_inputs(inputs, mode, friction);
    inputs.push(friction.limit);
    inputs.extend(opens.then_some(if mode == ContactMode::Apart { 0.0 } else { 1.0 }));
}

/// Records what a contact with this sliding speed does in the equations of motion. Its inputs are its mode and the numbers
/// of its law, whose values [`add_contact_inputs`] adds.
pub fn record_contact<'r>(
    recorder: &'r Recorder,
    friction: &Friction,
    speed: Expression<'r>,
) -> Contact<Expression<'r>> {
    let free = recorder.switch("free");
    let [direction, slips] = ["direction", "slips"].map(|name| recorder.input(name));
    friction.record(recorder, [free, direction], slips * speed)
}
