//! The systems as graphs of expressions. Parameters, laws and modes are inputs of the graph, so that runs with other
//! parameters in other modes share it.

use super::{
    Balancer, BalancerBall, Contact, ContactEquations, Expression, Forces, Friction, Number,
    Recorder, Slider, State, SystemEquations,
};

/// How a contact moves during a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactMode {
    /// It sticks.
    Stick,
    /// It slips in a direction, 1 or -1; a law that cannot stick ignores the direction.
    Slip(f64),
}

/// A system whose equations can be recorded.
pub trait RecordedSystem {
    /// Records the equations.
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r>;

    /// Returns the values of the inputs, in their order, for modes of all contacts.
    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64>;
}

/// The values of the inputs of a contact: its mode and the numbers of its law.
fn contact_inputs(mode: ContactMode, friction: &Friction) -> Vec<f64> {
    let [free, direction] = match mode {
        ContactMode::Stick => [0.0, 0.0],
        ContactMode::Slip(direction) => [1.0, direction],
    };
    [free, direction].into_iter().chain(friction.expression_inputs()).collect()
}

fn record_contact<'r>(
    recorder: &'r Recorder,
    friction: &Friction,
    speed: Expression<'r>,
) -> Contact<Expression<'r>> {
    let mode = ["free", "direction"].map(|name| recorder.input(name));
    friction.record(recorder, mode, speed)
}

fn equations<'r, const N: usize, const FREE: usize>(
    state: &State<N, Expression<'r>, FREE>,
    derivative: &State<N, Expression<'r>, FREE>,
    forces: &Forces<N, Expression<'r>, FREE>,
) -> SystemEquations<'r> {
    let State { position, velocity, beta, beta_dot } = *derivative;
    let components = position.into_iter().chain(velocity).chain(beta).chain(beta_dot);
    let contact = |i: usize| ContactEquations {
        sliding_speed: state.beta_dot[i],
        sliding_acceleration: forces.beta_ddot[i],
        normal: forces.normal[i],
        friction: forces.friction[i],
    };
    SystemEquations { derivative: components.collect(), contacts: (0..N).map(contact).collect() }
}

/// The components of the state, in the order position, velocity, contacts' positions, contacts' speeds.
fn record_state<const N: usize, const FREE: usize>(
    recorder: &Recorder,
) -> State<N, Expression<'_>, FREE> {
    State {
        position: std::array::from_fn(|_| recorder.state()),
        velocity: std::array::from_fn(|_| recorder.state()),
        beta: std::array::from_fn(|_| recorder.state()),
        beta_dot: std::array::from_fn(|_| recorder.state()),
    }
}

impl<const N: usize> RecordedSystem for Balancer<N> {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let state = record_state(recorder);
        let [speed, damping_ratio, imbalance] =
            ["speed", "damping_ratio", "imbalance"].map(|name| recorder.input(name));
        let unused = Expression::constant(0.0);
        let balls = self.balls.map(|ball| {
            let [mass, mobility, rolling_linear, rolling_quadratic] =
                ["mass", "mobility", "rolling_linear", "rolling_quadratic"]
                    .map(|name| recorder.input(name));
            BalancerBall {
                mass,
                inertia: unused,
                diameter: unused,
                friction: ball.friction,
                mobility,
                rolling_linear,
                rolling_quadratic,
            }
        });
        let balancer = Balancer { speed, damping_ratio, imbalance, balls };
        let contacts = std::array::from_fn(|i| {
            record_contact(recorder, &self.balls[i].friction, state.beta_dot[i])
        });
        let forces = balancer.forces(&state, &contacts);
        equations(&state, &balancer.derivative(&state, &contacts, &forces), &forces)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let machine = [self.speed, self.damping_ratio, self.imbalance].into_iter();
        let ball = |ball: &BalancerBall| {
            [ball.mass, ball.mobility, ball.rolling_linear, ball.rolling_quadratic]
        };
        let contacts = self.balls.iter().zip(modes);
        machine
            .chain(self.balls.iter().flat_map(ball))
            .chain(contacts.flat_map(|(ball, mode)| contact_inputs(*mode, &ball.friction)))
            .collect()
    }
}

impl RecordedSystem for Slider {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        let state: State<1, Expression<'r>, 0> = record_state(recorder);
        let belt_speed = recorder.input("belt_speed");
        let contacts = [record_contact(recorder, &self.friction, state.beta_dot[0])];
        let forces = Slider::forces_of(&state, &contacts);
        let derivative = Slider::derivative_of(belt_speed, &state, &contacts, &forces);
        equations(&state, &derivative, &forces)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        let contact = modes.iter().flat_map(|mode| contact_inputs(*mode, &self.friction));
        std::iter::once(self.belt_speed).chain(contact).collect()
    }
}

impl<const N: usize, const FREE: usize> State<N, f64, FREE> {
    /// Returns the components in the order of a recorded system.
    pub fn components(&self) -> Vec<f64> {
        let State { position, velocity, beta, beta_dot } = *self;
        position.into_iter().chain(velocity).chain(beta).chain(beta_dot).collect()
    }
}
