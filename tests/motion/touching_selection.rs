//! The joint decision for touching balls, where the equations of rigid bodies have one solution or none.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};
use stickslip::model::{BallContact, BallsInContact, Machine, Method, System};
use stickslip::motion::{Failure, Motion, Phase, SLACK};

use super::mode_selection::undecided_machine;
use crate::support::settings;

/// Two balls at rest in touch; ball 2 is ahead.
struct Pair {
    machine: BallsInContact<2>,
    position: [f64; 2],
    beta: [f64; 2],
    /// `tan(Δ/2)`.
    tangent: f64,
}

/// The unknowns of a combination, with `a` the acceleration of the table without its rotating frame.
struct Solution {
    /// Friction that each ball needs for its acceleration, without the force between the balls.
    needed: [f64; 2],
    /// Force from the ring, without the force between the balls.
    normal: [f64; 2],
    acceleration: [f64; 2],
    /// Force between the balls along the ring.
    force: f64,
}

/// How a ball goes on: it sticks (0), or slips in a direction from now on.
type Directions = [f64; 2];

impl Pair {
    fn ball(&self, ball: usize) -> (f64, f64, f64) {
        let ball = &self.machine.balancer.balls[ball];
        (ball.mass, ball.friction.limit, 1.0 + 4.0 * ball.inertia)
    }

    /// Solves the equations of table and balls for `a_x`, `a_y`, both accelerations and the force between the balls,
    /// which keeps the gap closed if `closed`.
    fn solve(&self, directions: Directions, closed: bool) -> Solution {
        let balancer = &self.machine.balancer;
        let square = balancer.speed * balancer.speed;
        let mut matrix = SMatrix::<f64, 5, 5>::zeros();
        let mut right = SVector::<f64, 5>::zeros();
        let [x, y] = self.position;
        // The damper acts where the table rests in the rotating frame, too.
        let damping = 2.0 * balancer.damping_ratio * balancer.speed;
        right[0] = balancer.imbalance * square - x + damping * y;
        right[1] = -y - damping * x;
        (matrix[(0, 0)], matrix[(1, 1)]) = (1.0, 1.0);
        for ball in 0..2 {
            let (mass, limit, inertia) = self.ball(ball);
            let (sine, cosine) = self.beta[ball].sin_cos();
            right[0] += mass * cosine * square;
            right[1] += mass * sine * square;
            matrix[(0, 2 + ball)] = -mass * sine;
            matrix[(1, 2 + ball)] = mass * cosine;
            let row = 2 + ball;
            matrix[(row, row)] = inertia;
            let direction = directions[ball];
            if direction != 0.0 {
                // Friction is `direction μ f_n`, with `f_n = ω² - c a_x - s a_y + tan(Δ/2) λ/m`.
                let push = if ball == 0 { -1.0 } else { 1.0 };
                matrix[(row, 0)] = -sine - direction * limit * cosine;
                matrix[(row, 1)] = cosine - direction * limit * sine;
                matrix[(row, 4)] = (direction * limit * self.tangent - push) / mass;
                right[row] = -direction * limit * square;
            }
        }
        if closed && directions != [0.0; 2] {
            (matrix[(4, 2)], matrix[(4, 3)]) = (1.0, -1.0);
        } else {
            matrix[(4, 4)] = 1.0;
        }
        let found = matrix.lu().solve(&right).expect("regular equations");
        let of = |ball: usize| self.beta[ball].sin_cos();
        let (a_x, a_y) = (found[0], found[1]);
        Solution {
            needed: [0, 1].map(|ball| of(ball).0 * a_x - of(ball).1 * a_y),
            normal: [0, 1].map(|ball| square - of(ball).1 * a_x - of(ball).0 * a_y),
            acceleration: [found[2], found[3]],
            force: found[4],
        }
    }

    /// Returns whether some force `λ >= 0` between balls that stick keeps the friction of both within its limits:
    /// `|T ∓ λ/m| <= μ (f + tan(Δ/2) λ/m)`.
    fn is_held(&self, solution: &Solution) -> bool {
        let (mut least, mut most) = (0.0_f64, f64::INFINITY);
        for ball in 0..2 {
            let (mass, limit, _) = self.ball(ball);
            let push = if ball == 0 { -1.0 } else { 1.0 };
            for side in [1.0, -1.0] {
                // `slack + slope λ >= 0`.
                let slack = limit * solution.normal[ball] - side * solution.needed[ball];
                let slope = (limit * self.tangent - side * push) / mass;
                if slope > 0.0 {
                    least = least.max(-slack / slope);
                } else {
                    most = most.min(-slack / slope);
                }
            }
        }
        least <= most + SLACK
    }

    /// Returns the accelerations of all combinations that meet their conditions, pressed to the ring.
    fn solutions(&self) -> Vec<[f64; 2]> {
        let mut found: Vec<[f64; 2]> = Vec::new();
        let ways = [0.0, 1.0, -1.0];
        for directions in ways.into_iter().flat_map(|first| ways.map(|second| [first, second])) {
            for closed in [false, true] {
                let [behind, ahead] = directions;
                let both_stick = directions == [0.0; 2];
                // The balls move apart if the gap opens, and together if it stays closed.
                let moves = if closed { behind == ahead } else { behind <= ahead && !both_stick };
                if !moves {
                    continue;
                }
                let solution = self.solve(directions, closed);
                let sets_off = |ball: usize| {
                    let direction = directions[ball];
                    let limit = self.ball(ball).1;
                    if direction == 0.0 {
                        let reserve = limit * solution.normal[ball] - solution.needed[ball].abs();
                        closed || reserve >= -SLACK
                    } else {
                        direction * solution.acceleration[ball] >= -SLACK
                    }
                };
                let gap = if closed {
                    solution.force >= -SLACK
                } else {
                    solution.acceleration[1] - solution.acceleration[0] >= -SLACK
                };
                let held = !(closed && both_stick) || self.is_held(&solution);
                let pressed = (0..2).all(|ball| {
                    let push = self.tangent * solution.force / self.ball(ball).0;
                    solution.normal[ball] + push > 0.0
                });
                let new = found.iter().all(|other| {
                    (0..2).any(|ball| (other[ball] - solution.acceleration[ball]).abs() > 1e-5)
                });
                if gap && held && pressed && new && (0..2).all(sets_off) {
                    found.push(solution.acceleration);
                }
            }
        }
        found
    }
}

/// A start is refused exactly if the equations do not have one solution, with the number of the solutions.
#[test]
fn touching_balls_without_a_unique_solution_are_refused() {
    let contact = BallContact { restitution: 0.0, friction_coefficient: 0.0 };
    let mut seen = [0_u32; 4];
    for k in 0..10_000_u32 {
        let spread = |factor: f64| (f64::from(k) * factor + 0.7).sin();
        let machine: Machine = undecided_machine(3.0 + 2.0 * spread(0.9));
        let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
        let beta = [3.0 * spread(1.3), 3.0 * spread(1.3) + angle];
        let position = [0.13 * spread(2.1), 0.13 * spread(3.7)];
        let in_touch = BallsInContact::<2>::new(&machine, &contact, &beta).expect("two balls");
        let tangent = (0.5 * angle).tan();
        let pair = Pair { machine: in_touch, position, beta, tangent };
        let found = pair.solutions();
        seen[found.len()] += 1;
        let state = [position[0], position[1], 0.0, 0.0, beta[0], beta[1], 0.0, 0.0];
        let system: Arc<dyn System> = Arc::new(pair.machine.clone());
        for method in [Method::Switch, Method::Event] {
            match (Motion::new(&system, settings(method, 1e-9), &state), found.len()) {
                (Ok(motion), 1) => {
                    let moves = |ball: usize| found[0][ball].abs() > 1e-5;
                    for ball in 0..2 {
                        assert_eq!(
                            motion.phases()[ball] != Phase::Stick,
                            moves(ball),
                            "{k} {method:?} {:?} {found:?}",
                            motion.phases()
                        );
                    }
                }
                (Err(Failure::ContactLost { .. }), 0 | 1) => {}
                (Err(Failure::NoSolution { solutions }), number) => {
                    assert_eq!(solutions, number, "{k} {method:?}");
                }
                (other, _) => panic!("{k} {method:?}: {:?} {found:?}", other.map(|_| ())),
            }
        }
    }
    // Two balls in touch move like one body: no state of this machine has several solutions.
    assert!(seen[0] > 1000 && seen[1] > 1000, "{seen:?}");
}
