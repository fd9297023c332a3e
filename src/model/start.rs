//! The start state of a run.

use serde::Serialize;

/// A start state: one value for each of [`Model::coordinates`], in that order.
///
/// The balancer's are non-dimensional as in the thesis (lengths over `L`, time times `ω_n`), in the
/// frame that turns with the disc; a block's are in m and m/s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Start(pub Vec<f64>);

impl Start {
    /// A start state of the balancer: table position and velocity, angle and speed of each ball.
    ///
    /// ```
    /// use stickslip::model::Start;
    ///
    /// let start = Start::of_balancer([0.01, 0.0], &[1.0, 4.0], [0.0, 0.02], &[0.5, -0.3]);
    /// assert_eq!(start.0, [0.01, 0.0, 1.0, 4.0, 0.0, 0.02, 0.5, -0.3]);
    /// ```
    pub fn of_balancer(
        position: [f64; 2],
        beta: &[f64],
        velocity: [f64; 2],
        beta_dot: &[f64],
    ) -> Self {
        Start([&position, beta, &velocity, beta_dot].concat())
    }
}
