//! The rest certificate: whether balls that all stick can ever break loose again.
//!
//! With all balls stuck the table is a damped linear oscillator in inertial space, whose distance
//! `R` from the rest point in phase space never grows; the acceleration in excess of that at the
//! rest point is at most `sqrt(1 + 4ζ²) R`. If every ball's friction limit covers this bound, the
//! run has certainly ended in equilibrium. If the bound is too coarse, the motion in closed form is
//! followed until the bound suffices.

use super::{Balancer, Contact, Forces, RestAmplitude, RestForms, RestPoint, State};

impl<const N: usize> RestForms for Balancer<N> {
    fn surely_rests(&self, state: &[f64]) -> bool {
        let Some(state) = State::of_components(state) else { return false };
        certified(self, &self.rest_point(&state.beta), &state)
    }

    fn rests(&self, state: &[f64]) -> bool {
        let Some(state) = State::of_components(state) else { return false };
        certified_by_closed_form(self, &self.rest_point(&state.beta), &state)
    }

    fn at_rest(&self, state: &[f64]) -> RestAmplitude {
        let state: Option<State<N>> = State::of_components(state);
        let beta = state.map_or([0.0; N], |state| state.beta);
        let rest = self.rest_point(&beta);
        RestAmplitude {
            amplitude: rest.position[0].hypot(rest.position[1]),
            friction_margin: 1.0 - self.friction_use(&rest, 0.0),
        }
    }

    fn nearly_rests(&self, state: &[f64], excess: f64) -> bool {
        let Some(state) = State::of_components(state) else { return false };
        let rest = self.rest_point(&state.beta);
        let disturbance = self.acceleration_bound(self.distance_from_rest(&state, &rest));
        self.friction_use(&rest, disturbance) <= 1.0 + excess
    }
}

/// Returns whether no ball can ever break loose, by the energy bound alone. All balls must stick.
pub fn certified<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
    state: &State<N>,
) -> bool {
    balancer.friction_use(rest, disturbance_bound(balancer, rest, state)) <= 1.0
}

/// Returns a bound on the deviation of any force from its value at rest, for all later times.
pub(super) fn disturbance_bound<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
    state: &State<N>,
) -> f64 {
    let (normal, push) = balancer.residual_disturbance(state);
    let distance = balancer.distance_from_rest(state, rest) + push;
    balancer.acceleration_bound(distance) + normal
}

/// Returns whether no ball can ever break loose, by following the closed form of the table's motion
/// until the energy bound holds. Between the sampled instants, forces are bounded through their
/// rate of change, so that `true` is certain; `false` means that a ball breaks loose, or that the
/// margin is too small for a decision.
///
/// In inertial space `u e^{iωt}` obeys `ü + 2ζ u̇ + u = 0`; the solution over a fixed time is one
/// complex 2×2 matrix, which is applied repeatedly.
pub fn certified_by_closed_form<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
    state: &State<N>,
) -> bool {
    // If the balls are not held at the rest point itself, following the motion cannot certify rest.
    if balancer.friction_use(rest, 0.0) >= 1.0 || balancer.damping_ratio <= 0.0 {
        return false;
    }
    followed_to_rest(
        balancer,
        rest,
        state,
        |current| certified(balancer, rest, current),
        |forces, unseen| {
            (0..N).all(|ball| {
                let limit = balancer.balls[ball].friction.limit * (forces.normal[ball] - unseen);
                forces.friction[ball].abs() + unseen <= limit
            })
        },
    )
}

/// Follows the closed form of the table's motion until `certified` holds in a state. `held` returns whether friction holds
/// all balls with these forces, if all of them may differ by a number.
pub(super) fn followed_to_rest<const N: usize>(
    balancer: &Balancer<N>,
    rest: &RestPoint<N>,
    state: &State<N>,
    certified: impl Fn(&State<N>) -> bool,
    held: impl Fn(&Forces<N>, f64) -> bool,
) -> bool {
    if balancer.damping_ratio <= 0.0 {
        return false;
    }
    let omega = balancer.speed;
    let zeta = balancer.damping_ratio;
    let stick = [Contact::STICK; N];
    let interval = 0.02 / (omega.abs() + 1.0);
    let propagate = Propagator::new(zeta, omega, interval);
    let mut current = *state;
    // The closed form does not include the decaying residual speeds of the balls; their effect is
    // bounded once.
    let (normal, push) = balancer.residual_disturbance(state);
    let residual = normal + push + balancer.acceleration_bound(push);
    let mut u = [state.position[0] - rest.position[0], state.position[1] - rest.position[1]];
    let mut v = [state.velocity[0] - omega * u[1], state.velocity[1] + omega * u[0]];
    for _ in 0..1_000_000 {
        current.position = [rest.position[0] + u[0], rest.position[1] + u[1]];
        current.velocity = [v[0] + omega * u[1], v[1] - omega * u[0]];
        if certified(&current) {
            return true;
        }
        // Seen from the turning frame the acceleration changes at most at the rate
        // (|ω| + sqrt(1 + 4ζ²)) times its bound, which never grows: until the next instant it
        // differs from the present one by no more than this.
        let bound = disturbance_bound(balancer, rest, &current);
        let rate = (omega.abs() + balancer.acceleration_bound(1.0)) * bound;
        let unseen = rate * interval + residual;
        let forces = balancer.forces(&current, &stick);
        if !held(&forces, unseen) {
            return false;
        }
        (u, v) = propagate.step(u, v);
    }
    false
}

/// The exact motion of the damped oscillator over a fixed time, seen from the turning frame.
struct Propagator {
    /// `u ← uu·u + uv·v`, `v ← vu·u + vv·v` in inertial space.
    matrix: [f64; 4],
    /// Turn of the frame over the time, `(cos, sin)`.
    turn: (f64, f64),
}

impl Propagator {
    fn new(zeta: f64, omega: f64, time: f64) -> Self {
        // Sums the matrix exponential: for the short times used here about a dozen terms reach
        // rounding accuracy, for any moderate damping ratio.
        let (mut term, mut sum) = ([1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]);
        for power in 1..60 {
            let scale = time / f64::from(power);
            let [a, b, c, d] = term;
            // Multiply by [[0, 1], [-1, -2ζ]].
            term = [
                -b * scale,
                (a - 2.0 * zeta * b) * scale,
                -d * scale,
                (c - 2.0 * zeta * d) * scale,
            ];
            for (total, value) in sum.iter_mut().zip(term) {
                *total += value;
            }
        }
        let (sine, cosine) = libm::sincos(omega * time);
        Propagator { matrix: sum, turn: (cosine, sine) }
    }

    fn step(&self, u: [f64; 2], v: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let [uu, uv, vu, vv] = self.matrix;
        let (cosine, sine) = self.turn;
        let back = |[a, b]: [f64; 2]| [cosine * a + sine * b, cosine * b - sine * a];
        (
            back([uu * u[0] + uv * v[0], uu * u[1] + uv * v[1]]),
            back([vu * u[0] + vv * v[0], vu * u[1] + vv * v[1]]),
        )
    }
}
