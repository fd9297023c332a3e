//! What each ball does, and how that is decided for all balls in the band together.

use super::Failure;
use super::ambiguity::unique_or_refused;
use crate::model::{Balancer, Contact, Forces, State};

/// What a ball does (thesis table 4.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Phase {
    /// It moves, faster than the band, in the direction 1 or -1.
    Slip(f64),
    /// It rests on the ring: friction holds it.
    Stick,
    /// It is in the band but friction does not hold it: it accelerates in the direction 1 or -1.
    Transition(f64),
}

/// Slack of the conditions for stick and transition, as an acceleration over `L ω_n²`: a phase ends
/// when its condition fails by more than this.
///
/// It keeps a decision that is met only to rounding (the instant of break-away) from being taken
/// twice, and it sets the pace at which a creeping ball, whose pull hovers at the friction limit,
/// alternates between stick and transition: the number of switches goes as one over the slack.
/// Friction limits of a real balancer are some 1e-3, so that this is a millionth of them.
pub const SLACK: f64 = 1e-9;

impl Phase {
    /// How friction acts on the ball.
    pub fn contact(self, friction_coefficient: f64) -> Contact {
        match self {
            Phase::Stick => Contact { free: 0.0, signed_friction: 0.0 },
            Phase::Slip(direction) | Phase::Transition(direction) => {
                Contact { free: 1.0, signed_friction: direction * friction_coefficient }
            }
        }
    }

    /// Whether the ball's speed is in the band.
    pub fn in_band(self) -> bool {
        !matches!(self, Phase::Slip(_))
    }
}

/// How friction acts on every ball.
pub fn contacts<const N: usize>(balancer: &Balancer<N>, phases: &[Phase; N]) -> [Contact; N] {
    std::array::from_fn(|i| phases[i].contact(balancer.balls[i].friction_coefficient))
}

/// What is left of the friction limit on a ball that sticks, `μ f_n - |f_w|`.
pub fn stick_reserve<const N: usize>(
    balancer: &Balancer<N>,
    forces: &Forces<N>,
    ball: usize,
) -> f64 {
    balancer.balls[ball].friction_coefficient * forces.normal[ball] - forces.friction[ball].abs()
}

/// Decides stick or transition for all balls in the band together (thesis section 4.3, appendix
/// C) and returns the forces that go with the decision. Balls in slip are left alone.
///
/// The conditions are a linear complementarity problem: a ball sticks if friction within its limit
/// can hold it, else it accelerates against full friction. For light balls the problem's matrix is
/// nearly diagonal; exchanging all phases that fail their condition at once then settles it in a
/// step or two. Should it not settle, all `3^k` combinations are tried. Where the balls are so heavy
/// and the friction so large that there may be several solutions, all of them are looked for, and
/// none is chosen silently ([`crate::model::ExistenceVerdict`]).
///
/// # Errors
/// [`Failure::NoSolution`] where no combination meets all conditions, or several different ones do.
pub fn decide<const N: usize>(
    balancer: &Balancer<N>,
    state: &State<N>,
    phases: &mut [Phase; N],
) -> Result<Forces<N>, Failure> {
    if !balancer.surely_one_solution() && !balancer.one_solution_at(&state.beta) {
        return unique_or_refused(balancer, state, phases);
    }
    let evaluate = |phases: &[Phase; N]| balancer.forces(state, &contacts(balancer, phases));
    for _ in 0..N + 3 {
        let forces = evaluate(phases);
        let mut settled = true;
        for (ball, phase) in phases.iter_mut().enumerate() {
            if let Some(other) = better_phase(balancer, &forces, *phase, ball) {
                *phase = other;
                settled = false;
            }
        }
        if settled {
            return Ok(forces);
        }
    }
    let choices = [Phase::Stick, Phase::Transition(1.0), Phase::Transition(-1.0)];
    let in_band: Vec<usize> = (0..N).filter(|&ball| phases[ball].in_band()).collect();
    for combination in 0..3_usize.pow(in_band.len() as u32) {
        let mut rest = combination;
        for &ball in &in_band {
            phases[ball] = choices[rest % 3];
            rest /= 3;
        }
        let forces = evaluate(phases);
        let fits = |&ball: &usize| better_phase(balancer, &forces, phases[ball], ball).is_none();
        if in_band.iter().all(fits) {
            return Ok(forces);
        }
    }
    Err(Failure::NoSolution { solutions: 0 })
}

/// The phase that a ball should have instead, where the one that was assumed fails its condition.
pub(super) fn better_phase<const N: usize>(
    balancer: &Balancer<N>,
    forces: &Forces<N>,
    assumed: Phase,
    ball: usize,
) -> Option<Phase> {
    match assumed {
        Phase::Slip(_) => None,
        Phase::Stick => (stick_reserve(balancer, forces, ball) < -SLACK)
            .then(|| Phase::Transition(forces.friction[ball].signum())),
        Phase::Transition(direction) => {
            (direction * forces.beta_ddot[ball] < -SLACK).then_some(Phase::Stick)
        }
    }
}
