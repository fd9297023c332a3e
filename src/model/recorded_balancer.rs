//! The balancer as a graph of expressions. Parameters, laws and modes are inputs of the graph, so that runs with other
//! parameters in other modes share it.

use std::any::{Any, TypeId};

use smallvec::SmallVec;

use super::contact_mode::{add_contact_inputs, record_contact};
use super::system::stiff_rate;
use super::{
    Balancer, BalancerBall, Contact, ContactEquations, ContactLayout, ContactMode, Expression,
    Forces, Friction, Gap, GapEquations, Number, Recorder, RestForms, State, StateLayout,
    Structure, System, SystemEquations, pushes,
};

/// Speed and acceleration of the disc in recorded equations.
#[derive(Clone, Copy)]
pub(super) struct DiscSpeed<'r> {
    pub(super) speed: Expression<'r>,
    pub(super) acceleration: Expression<'r>,
}

/// A balancer with or without contact between its balls, whose disc may turn with a speed that changes.
pub(super) trait DrivenDisc<const N: usize>: System + Clone {
    /// Returns the balancer without contact between balls.
    fn balancer(&self) -> &Balancer<N>;

    /// Returns the gaps between neighbouring balls; none without contact.
    fn gaps(&self) -> &[Gap];

    /// Records the equations at constant speed, or with what `turning` returns. `turning` is called when the components of
    /// the state are recorded, and may record another one.
    fn record_turning<'r>(
        &self,
        recorder: &'r Recorder,
        turning: impl FnOnce() -> Option<DiscSpeed<'r>>,
    ) -> SystemEquations<'r> {
        let state = record_state(recorder);
        let balancer = self.balancer().record_parameters(recorder, turning());
        let contacts = std::array::from_fn(|i| {
            record_contact(recorder, &balancer.balls[i].friction, state.beta_dot[i])
        });
        let closed: Vec<_> = self.gaps().iter().map(|_| recorder.input("closed")).collect();
        let gaps = self.gaps().iter().zip(closed).map(|(gap, closed)| {
            let pushes = [(); 2].map(|()| [(); 2].map(|()| recorder.input("push")));
            RecordedGap { contacts: gap.contacts, closed, pushes }
        });
        let gaps: Vec<_> = gaps.collect();
        let (forces, gap_forces) = balancer.record_forces(recorder, &state, &contacts, &gaps);
        let State { position, velocity, beta, beta_dot } =
            balancer.derivative(&state, &contacts, &forces);
        let components = position.into_iter().chain(velocity).chain(beta).chain(beta_dot);
        let contact = |i: usize| ContactEquations {
            sliding_speed: state.beta_dot[i],
            sliding_acceleration: forces.beta_ddot[i],
            normal: forces.normal[i],
            friction: forces.friction[i],
        };
        let gap = |(gap, force): (&RecordedGap<'r>, Expression<'r>)| {
            let [behind, ahead] = gap.contacts.map(|ball| forces.beta_ddot[ball]);
            GapEquations { opening_acceleration: ahead - behind, force }
        };
        // The direction of the table's velocity is arbitrary: one group.
        let speeds = (4 + N..4 + 2 * N).map(|speed| vec![speed]);
        let layout = StateLayout {
            contacts: (4..4 + N)
                .map(|position| ContactLayout { position, angular: true })
                .collect(),
            velocities: std::iter::once(vec![2, 3]).chain(speeds).collect(),
            vibration: Some([0, 1]),
            ..StateLayout::default()
        };
        SystemEquations {
            derivative: components.collect(),
            contacts: (0..N).map(contact).collect(),
            gaps: gaps.iter().zip(gap_forces).map(gap).collect(),
            layout,
            ..SystemEquations::default()
        }
    }

    /// Returns the values of the inputs without those that `turning` records.
    fn inputs_turning(&self, modes: &[ContactMode], turning: bool) -> Vec<f64> {
        let mut inputs = self.balancer().parameter_inputs(turning);
        for (ball, mode) in self.balancer().balls.iter().zip(modes) {
            add_contact_inputs(&mut inputs, *mode, &ball.friction);
        }
        let pushes: SmallVec<[_; 8]> = pushes(self.gaps(), modes).collect();
        inputs.extend(pushes.iter().map(|pushes| if pushes.is_some() { 1.0 } else { 0.0 }));
        // Without a force, the pushes do not matter.
        for (gap, pushes) in self.gaps().iter().zip(&pushes) {
            inputs.extend(pushes.unwrap_or_else(|| gap.rolling_pushes(0.0)).as_flattened());
        }
        inputs
    }
}

/// The components of the state, in the order position, velocity, contacts' positions, contacts' speeds.
fn record_state<const N: usize>(recorder: &Recorder) -> State<N, Expression<'_>> {
    State {
        position: std::array::from_fn(|_| recorder.state()),
        velocity: std::array::from_fn(|_| recorder.state()),
        beta: std::array::from_fn(|_| recorder.state()),
        beta_dot: std::array::from_fn(|_| recorder.state()),
    }
}

impl<const N: usize> Balancer<N> {
    /// Records the parameters as inputs, whose values [`Balancer::parameter_inputs`] returns.
    fn record_parameters<'r>(
        &self,
        recorder: &'r Recorder,
        turning: Option<DiscSpeed<'r>>,
    ) -> Balancer<N, Expression<'r>> {
        let [speed, damping_ratio, imbalance] =
            ["speed", "damping_ratio", "imbalance"].map(|name| recorder.parameter(name));
        let runout = self.runout.map(|parts| parts.map(|_| recorder.parameter("runout")));
        let unused = Expression::constant(0.0);
        let balls = self.balls.map(|ball| {
            let [mass, mobility, rolling_linear, rolling_quadratic] =
                ["mass", "mobility", "rolling_linear", "rolling_quadratic"]
                    .map(|name| recorder.parameter(name));
            let at_constant_speed = BalancerBall {
                mass,
                inertia: unused,
                diameter: unused,
                friction: ball.friction,
                mobility,
                rolling_linear,
                rolling_quadratic,
            };
            turning.map_or(at_constant_speed, |turning| {
                let [inertia, diameter] =
                    ["inertia", "diameter"].map(|name| recorder.parameter(name));
                // `2 J d ω`, or 0 (Newton).
                let half = Expression::constant(-0.5);
                let rolling_linear = half * rolling_quadratic * diameter * turning.speed;
                BalancerBall { inertia, diameter, rolling_linear, ..at_constant_speed }
            })
        });
        let at_constant_speed =
            Balancer { speed, acceleration: None, damping_ratio, imbalance, runout, balls };
        turning.map_or(at_constant_speed, |DiscSpeed { speed, acceleration }| Balancer {
            speed,
            acceleration: Some(acceleration),
            ..at_constant_speed
        })
    }

    /// Returns the values of the inputs of the parameters; if `turning`, of a disc whose speed changes.
    fn parameter_inputs(&self, turning: bool) -> Vec<f64> {
        // The inputs of contacts and of gaps follow.
        let mut inputs = Vec::with_capacity(5 + 20 * N);
        inputs.extend_from_slice(&[self.speed, self.damping_ratio, self.imbalance]);
        inputs.extend(self.runout.into_iter().flatten());
        for ball in &self.balls {
            let BalancerBall { mass, mobility, rolling_linear, rolling_quadratic, .. } = *ball;
            inputs.extend_from_slice(&[mass, mobility, rolling_linear, rolling_quadratic]);
            if turning {
                inputs.extend_from_slice(&[ball.inertia, ball.diameter]);
            }
        }
        inputs
    }
}

/// A gap between two balls whose force is an unknown of the equations of motion.
struct RecordedGap<'r> {
    /// The ball behind and the ball ahead.
    contacts: [usize; 2],
    /// 1 if it is closed, else 0.
    closed: Expression<'r>,
    /// Tangential and normal force on each ball, over its mass, by a unit of the force.
    pushes: [[Expression<'r>; 2]; 2],
}

impl<'r, const N: usize> Balancer<N, Expression<'r>> {
    /// Records the accelerations of the balls and of the table and the forces in gaps as unknowns of one linear system. Returns
    /// the forces that follow from them, and those in the gaps.
    fn record_forces(
        &self,
        recorder: &'r Recorder,
        state: &State<N, Expression<'r>>,
        contacts: &[Contact<Expression<'r>>; N],
        gaps: &[RecordedGap<'r>],
    ) -> (Forces<N, Expression<'r>>, Vec<Expression<'r>>) {
        let terms = self.ball_terms(state, contacts, &state.beta.map(Number::sin_cos));
        let one = Expression::constant(1.0);
        let zero = Expression::constant(0.0);
        // Balls, gaps, table: the order in which elimination adds the fewest entries.
        let table = [N, N + 1].map(|place| place + gaps.len());
        let mut matrix = vec![vec![zero; table[1] + 1]; table[1] + 1];
        let mut right = vec![zero; table[1] + 1];
        let mut balls = [zero; 2];
        // What a ball that slips feels of the table's acceleration along the ring, and what a ball that sticks does.
        let felt = |i: usize| {
            let friction = contacts[i].signed_friction;
            let (sine, cosine) = (terms[i].sine, terms[i].cosine);
            [sine + friction * cosine, cosine - friction * sine]
        };
        table.iter().for_each(|row| matrix[*row][*row] = one);
        for (i, term) in terms.iter().enumerate() {
            let (ball, contact) = (&self.balls[i], &contacts[i]);
            let (sine, cosine) = (term.sine, term.cosine);
            matrix[table[0]][i] = -(ball.mass * sine);
            matrix[table[1]][i] = ball.mass * cosine;
            balls[0] = balls[0] + cosine * term.outward;
            balls[1] = balls[1] + sine * term.outward;
            if let Some(euler) = term.euler {
                balls[0] = balls[0] + sine * euler;
                balls[1] = balls[1] - cosine * euler;
            }
            let mobility = ball.mobility * contact.free;
            let [felt_x, felt_y] = felt(i);
            matrix[i][table[0]] = -(mobility * felt_x);
            matrix[i][table[1]] = mobility * felt_y;
            matrix[i][i] = one;
            let friction = contact.signed_friction * term.pressed + contact.drag;
            right[i] = -(mobility * self.euler_force(i).map_or(friction, |euler| friction + euler));
        }
        for (row, gap) in (N..).zip(gaps) {
            matrix[row][row] = one - gap.closed;
            for ((ball, [along, outward]), side) in
                gap.contacts.into_iter().zip(gap.pushes).zip([-1.0, 1.0])
            {
                let mobility = self.balls[ball].mobility * contacts[ball].free;
                matrix[ball][row] =
                    -(mobility * (along - contacts[ball].signed_friction * outward));
                matrix[row][ball] = Expression::constant(side) * gap.closed;
            }
        }
        [right[table[0]], right[table[1]]] = self.force_on_table(state, balls);
        let unknowns = recorder.accelerations(&matrix, &right);
        let in_gaps = unknowns[N..table[0]].to_vec();
        let table = table.map(|place| unknowns[place]);
        // The tangential or the normal force of all gaps on a ball.
        let pushed = |ball: usize, way: usize| {
            let sides = gaps.iter().zip(&in_gaps).flat_map(|(gap, force)| {
                let sides = gap.contacts.into_iter().zip(gap.pushes);
                sides.map(move |(contact, push)| (contact, push[way] * *force))
            });
            sides.filter(|(contact, _)| *contact == ball).fold(zero, |sum, (_, force)| sum + force)
        };
        let normal = std::array::from_fn(|i| {
            let felt = terms[i].cosine * table[0] + terms[i].sine * table[1];
            terms[i].pressed - felt + pushed(i, 1)
        });
        let friction = std::array::from_fn(|i| {
            let [felt_x, felt_y] = felt(i);
            let along = felt_x * table[0] - felt_y * table[1];
            let along = self.euler_force(i).map_or(along, |euler| along - euler) + pushed(i, 0);
            let Contact { free, signed_friction, drag } = contacts[i];
            free * (signed_friction * normal[i] + drag) + (one - free) * along
        });
        let beta_ddot = std::array::from_fn(|i| unknowns[i]);
        (Forces { table_acceleration: table, beta_ddot, normal, friction }, in_gaps)
    }
}

impl<const N: usize> DrivenDisc<N> for Balancer<N> {
    fn balancer(&self) -> &Balancer<N> {
        self
    }

    fn gaps(&self) -> &[Gap] {
        &[]
    }
}

impl<const N: usize> System for Balancer<N> {
    fn record<'r>(&self, recorder: &'r Recorder) -> SystemEquations<'r> {
        self.record_turning(recorder, || None)
    }

    fn inputs(&self, modes: &[ContactMode]) -> Vec<f64> {
        self.inputs_turning(modes, false)
    }

    fn structure(&self) -> Option<Structure> {
        let laws = self.balls.iter().map(|ball| ball.friction.law_name());
        let runout = usize::from(self.runout.is_some());
        Some((TypeId::of::<Self>(), laws.collect(), vec![runout]))
    }

    fn contacts(&self) -> usize {
        N
    }

    fn friction(&self, contact: usize) -> &Friction {
        &self.balls[contact].friction
    }

    /// A quarter of the shortest period of the table in the turning frame.
    fn longest_step(&self) -> f64 {
        0.5 * std::f64::consts::PI / (self.speed.abs() + 1.0)
    }

    fn fastest_rate(&self) -> f64 {
        let weight = self.speed * self.speed;
        let rates = self.balls.iter().map(|ball| ball.friction.damping_rate(weight));
        1.0 + self.speed.abs() + self.damping_ratio + stiff_rate(rates.fold(0.0, f64::max))
    }

    /// The number of steps of an explicit method is about a tenth of the table's damping rate.
    fn fewest_steps(&self) -> f64 {
        1.0 / self.longest_step() + 0.2 * self.damping_ratio
    }

    fn surely_one_solution(&self) -> bool {
        Balancer::surely_one_solution(self)
    }

    fn one_solution_at(&self, state: &[f64]) -> bool {
        let state: Option<State<N>> = State::of_components(state);
        state.is_some_and(|state| Balancer::one_solution_at(self, &state.beta))
    }

    fn force_scale(&self) -> f64 {
        1.0 + self.speed * self.speed
    }

    fn rest_forms(&self) -> Option<&dyn RestForms> {
        Some(self)
    }

    fn jump_of_balls(&self, state: &mut [f64], jump: [f64; 2]) -> u32 {
        Balancer::jump_of_balls(self, state, jump)
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
