//! Which limit cycle a run is on: the class that it fractions with all runs that do the same.
//!
//! A class says which balls run, how often they go round per period, and in which order they stick
//! and slip. Its text has one part for each ball, joined by `|`:
//!
//! ```text
//! class   = ball *( "|" ball )
//! ball    = "rest"                    it sticks all along
//!         / turns                     it never changes what it does: it runs and never stops
//!         / turns ":" letters         it does one thing after another, in a circle
//! turns   = a whole number: turns around the ring per period, negative against the disc's rotation
//! letters = two or more of S (sticks), F (slips in the disc's sense), B (slips against it)
//! ```
//!
//! `-1|rest`: one ball falls back by one turn per period while the other rests. `-1:SB|0:BF`: the
//! first sticks and slips, and the second swings without going round. The letters of several balls
//! belong together: the third letters say what the balls do at one and the same time, so that a
//! ball that goes on with what it did has the same letter twice. A ball without letters is left out
//! of that, as it never switches. A block has one part with 0 turns, and the belt's direction is
//! forward. `unknown` is the class of a cycle of which nothing is known but that it closes.
//!
//! What makes no difference is folded, by taking the smallest of all forms:
//!
//! - Balls that are alike have no names: among their places, balls that run come first, then those
//!   that swing, then those that rest. Balls that differ keep their places in the machine.
//! - A period begins nowhere: letters start where they come first in the order S, F, B.
//! - The mirror image, `y`, angles and speeds with the other sign, solves the equations of the disc
//!   that turns the other way and no others: of the speed `ω` they have `ω²`, `ω β̇`, `ω ẏ` and `ω x`
//!   in the equation along `y`. So senses are counted from the disc's. At one speed there is no
//!   other such symmetry: the imbalance fixes the direction of `x`, and the terms in `ω ẏ` and
//!   `ω β̇` the sense. (At standstill there would be; nothing drives a cycle there.)
//!
//! One class can hold a continuous family of cycles: where resting balls rest does not count.

use std::cmp::{Ordering, Reverse};
use std::fmt;

use super::identical_balls::groups_of_identical;
use crate::classification::{Cycle, CyclePhase, Evidence, Outcome};
use crate::model::Model;

/// What one ball does in a class of cycles, or a block. In order: those that run, those that swing,
/// those that rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Role {
    /// Turns around the ring per period, negative against the disc's rotation; 0 of a block.
    pub turns: i32,
    /// What it does one after another, forward in the disc's sense or the belt's; empty where it
    /// does one thing only.
    pub letters: Vec<CyclePhase>,
    /// Whether it sticks all along.
    pub rests: bool,
}

impl Role {
    fn key(&self) -> impl Ord + '_ {
        let more_turns_first = Reverse(self.turns.unsigned_abs());
        (self.rests, self.turns == 0, more_turns_first, self.turns, &self.letters)
    }
}

impl PartialOrd for Role {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Role {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(&other.key())
    }
}

impl fmt::Display for Role {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.rests {
            return out.write_str("rest");
        }
        write!(out, "{}", self.turns)?;
        if !self.letters.is_empty() {
            out.write_str(":")?;
        }
        self.letters.iter().try_for_each(|letter| {
            out.write_str(match letter {
                CyclePhase::Stick => "S",
                CyclePhase::Forward => "F",
                CyclePhase::Backward => "B",
            })
        })
    }
}

/// The class of a run's cycle, and which of its balls has which place there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CycleClass {
    /// The class as text; equal of runs in the same class and of no others.
    pub name: String,
    /// What the ball in each place does; empty where that is unknown.
    pub roles: Vec<Role>,
    /// The ball in each place. Alike balls with the same role stand in ascending order of the angle
    /// at which they rest, or of the greatest speed that they reach in the disc's sense.
    pub balls: Vec<usize>,
}

impl CycleClass {
    /// Name of the class of cycles of which nothing is known but that they close.
    pub const UNKNOWN: &'static str = "unknown";

    /// The class of a run's limit cycle; none of a run that has not been shown to be on one.
    pub fn of(model: &Model, outcome: &Outcome) -> Option<Self> {
        if outcome.evidence != Evidence::ClosedOrbit {
            return None;
        }
        let known = outcome.cycle.as_ref().and_then(|cycle| {
            let angles = outcome.position.as_deref().unwrap_or_default();
            CycleForm::new(model, cycle, angles)
        });
        Some(known.map_or_else(
            || CycleClass { name: Self::UNKNOWN.to_owned(), roles: Vec::new(), balls: Vec::new() },
            |form| form.class(model),
        ))
    }
}

/// 1 where senses of rotation count as they are, -1 where the disc turns in the negative sense.
pub(super) fn sense(model: &Model) -> i32 {
    if model.ball_balancer().is_some_and(|machine| machine.speed_rad_s < 0.0) { -1 } else { 1 }
}

/// The least and the greatest speed of a contact, counted in the disc's sense.
pub(super) fn speeds_in_sense(model: &Model, [least, greatest]: [f64; 2]) -> [f64; 2] {
    let [least, greatest] = if sense(model) < 0 { [-greatest, -least] } else { [least, greatest] };
    // Adding 0 makes -0 to 0.
    [least + 0.0, greatest + 0.0]
}

/// A cycle in the disc's sense, ball by ball in the machine's order, from where its period was begun.
struct CycleForm {
    roles: Vec<Role>,
    /// What puts balls with equal roles in order.
    standings: Vec<[f64; 3]>,
}

impl CycleForm {
    /// None of a cycle that has another number of contacts than the model.
    fn new(model: &Model, cycle: &Cycle, angles: &[f64]) -> Option<Self> {
        let contacts = model.contacts();
        let of_ball = [cycle.turns.len(), cycle.speed_extremes.len(), angles.len()];
        let configurations = &cycle.configurations;
        let lengths = of_ball.into_iter().chain(configurations.iter().map(Vec::len));
        let fits = lengths.into_iter().all(|length| length == contacts);
        let first = configurations.first().filter(|_| fits)?;
        let switches = |contact: usize| {
            configurations.iter().any(|cycle_phases| cycle_phases[contact] != first[contact])
        };
        let switching: Vec<usize> = (0..contacts).filter(|&contact| switches(contact)).collect();
        let mut steps: Vec<Vec<CyclePhase>> = configurations
            .iter()
            .map(|cycle_phases| {
                switching.iter().map(|&contact| in_sense(model, cycle_phases[contact])).collect()
            })
            .collect();
        // A period that was begun amid a phase has that phase at both ends.
        steps.dedup();
        while steps.len() > 1 && steps.first() == steps.last() {
            steps.pop();
        }
        let letters = |contact: usize| match switching.iter().position(|&other| other == contact) {
            Some(column) => steps.iter().map(|cycle_phases| cycle_phases[column]).collect(),
            None => Vec::new(),
        };
        let role = |contact: usize| {
            let rests = cycle.rests(contact);
            let turns = if rests { 0 } else { cycle.turns[contact] };
            let turns = turns.saturating_mul(sense(model));
            Role { turns, letters: letters(contact), rests }
        };
        let roles: Vec<Role> = (0..contacts).map(role).collect();
        let standings = (0..contacts)
            .map(|contact| {
                let [least, greatest] = speeds_in_sense(model, cycle.speed_extremes[contact]);
                let angle = angles[contact];
                if roles[contact].rests { [angle, 0.0, 0.0] } else { [greatest, least, angle] }
            })
            .collect();
        Some(CycleForm { roles, standings })
    }

    /// The smallest form over all beginnings of the period and all orders of alike balls. For one
    /// beginning, what a ball does is a matter of that ball alone, so that sorting finds the order.
    fn class(&self, model: &Model) -> CycleClass {
        let groups = model
            .ball_balancer()
            .map_or_else(|| vec![vec![0]], |machine| groups_of_identical(&machine.balls));
        let beginnings = self.roles.iter().map(|role| role.letters.len()).max().unwrap_or(0).max(1);
        let begun_at = |beginning: usize| {
            let mut roles = self.roles.clone();
            for role in roles.iter_mut().filter(|role| !role.letters.is_empty()) {
                role.letters.rotate_left(beginning);
            }
            let mut balls: Vec<usize> = (0..roles.len()).collect();
            for places in &groups {
                let mut sorted = places.clone();
                sorted.sort_by(|&a, &b| {
                    roles[a].cmp(&roles[b]).then_with(|| self.compare_standing(a, b))
                });
                for (&place, ball) in places.iter().zip(sorted) {
                    balls[place] = ball;
                }
            }
            let roles: Vec<Role> = balls.iter().map(|&ball| roles[ball].clone()).collect();
            (roles, balls)
        };
        let mut smallest = begun_at(0);
        for (roles, balls) in (1..beginnings).map(begun_at) {
            let order = roles.cmp(&smallest.0).then_with(|| {
                let pairs = balls.iter().zip(&smallest.1);
                let standings = pairs.map(|(&a, &b)| self.compare_standing(a, b));
                standings.fold(Ordering::Equal, Ordering::then)
            });
            if order == Ordering::Less {
                smallest = (roles, balls);
            }
        }
        let (roles, balls) = smallest;
        let parts: Vec<String> = roles.iter().map(Role::to_string).collect();
        CycleClass { name: parts.join("|"), roles, balls }
    }

    fn compare_standing(&self, a: usize, b: usize) -> Ordering {
        let pairs = self.standings[a].iter().zip(&self.standings[b]);
        pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
    }
}

fn in_sense(model: &Model, cycle_phase: CyclePhase) -> CyclePhase {
    match cycle_phase {
        CyclePhase::Forward if sense(model) < 0 => CyclePhase::Backward,
        CyclePhase::Backward if sense(model) < 0 => CyclePhase::Forward,
        as_it_is => as_it_is,
    }
}
