//! Classification of limit cycles: runs on equivalent cycles share one class name.
//!
//! A class names the balls that run, their turns per period, and the order in which they stick and
//! slip. Its text has one part for each ball, joined by `|`:
//!
//! ```text
//! class   = ball *( "|" ball ) [ ";touch:" pairs ] [ ";meet:" pairs ]
//! ball    = "rest"                    sticks throughout
//!         / turns                     runs in one phase throughout
//!         / turns ":" letters         passes through a periodic sequence of phases
//! turns   = integer: turns around the ring per period, negative against the disc's rotation
//! letters = two or more of S (sticks), F (slips in the disc's sense), B (slips against it)
//! pairs   = place "-" place *( "," place "-" place )
//! ```
//!
//! `-1|rest`: one ball falls back by one turn per period while the other rests. `-1:SB|0:BF`: the
//! first ball sticks and slips, and the second swings without revolving. The letters of several
//! balls are synchronous: the third letters are the phases of all balls at the same time, so that a
//! ball whose phase does not change has the same letter twice. A ball without letters never
//! switches and is omitted from the sequence. A block has one part with 0 turns, and the belt's
//! direction is forward. `unknown` is the class of a closed cycle whose phases are not known.
//!
//! With contact between balls, the class ends with the places of the balls that touch throughout the period, and of those
//! that meet and separate: `-1|-1;touch:1-2` is a pair that runs in touch.
//!
//! Equivalent descriptions are reduced to one by taking the smallest form:
//!
//! - Identical balls are interchangeable: among their places, balls that run come first, then balls
//!   that swing, then balls that rest. Balls that differ keep their places in the machine. Identical balls that do the
//!   same take the places that give the smallest list of pairs.
//! - The start of a period is arbitrary: the letters start where they come first in the order S, F,
//!   B.
//! - The mirror image (`y`, angles and speeds with the opposite sign) solves the equations of a
//!   disc that turns in the opposite direction, and no others: the equations contain the speed `ω`
//!   as `ω²`, `ω β̇`, `ω ẏ` and, in the equation along `y`, `ω x`. Directions are therefore counted
//!   relative to the disc's. At one speed there is no other such symmetry: the imbalance fixes the
//!   direction of `x`, and the terms in `ω ẏ` and `ω β̇` fix the sense of rotation. (At standstill
//!   there would be one, but then nothing drives a cycle.)
//!
//! One class can contain a continuous family of cycles: the rest positions of resting balls do not
//! count.

use std::cmp::{Ordering, Reverse};
use std::fmt;

use super::identical_balls::groups_of_identical;
use crate::classification::{Cycle, CyclePhase, Evidence, Outcome, TouchingPair};
use crate::model::Model;

/// The role of one ball, or of a block, in a class of cycles. Roles are ordered: balls that run,
/// balls that swing, balls that rest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Role {
    /// Turns around the ring per period, negative against the disc's rotation; 0 for a block.
    pub turns: i32,
    /// The sequence of phases; forward is the disc's or the belt's direction. Empty for a single
    /// phase.
    pub letters: Vec<CyclePhase>,
    /// Whether the ball sticks throughout.
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
                CyclePhase::Apart => "A",
            })
        })
    }
}

/// The class of a run's cycle, and the assignment of its balls to the places of the class.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CycleClass {
    /// The class as text. Two runs have the same text if and only if they are in the same class.
    pub name: String,
    /// The role of the ball in each place; empty if unknown.
    pub roles: Vec<Role>,
    /// The ball in each place. Identical balls with the same role are in ascending order of the
    /// angle at which they rest, or of the greatest speed that they reach in the disc's sense.
    pub balls: Vec<usize>,
}

impl CycleClass {
    /// Name of the class of closed cycles whose phases are not known.
    pub const UNKNOWN: &'static str = "unknown";

    /// Returns the class of a run's limit cycle; `None` if the run has not been shown to be on one.
    pub fn of(model: &Model, outcome: &Outcome) -> Option<Self> {
        let Evidence::ClosedOrbit(orbit) = &outcome.evidence else { return None };
        let known = orbit.cycle.as_ref().and_then(|cycle| {
            let angles = outcome.position.as_deref().unwrap_or_default();
            CycleForm::new(model, cycle, angles)
        });
        Some(known.map_or_else(
            || CycleClass { name: Self::UNKNOWN.to_owned(), roles: Vec::new(), balls: Vec::new() },
            |form| form.class(model),
        ))
    }
}

/// Returns -1 if the disc turns in the negative sense, otherwise 1.
pub(super) fn sense(model: &Model) -> i32 {
    if model.ball_balancer().is_some_and(|machine| machine.speed_rad_s < 0.0) { -1 } else { 1 }
}

/// Returns the least and the greatest speed of a contact, counted in the disc's sense.
pub(super) fn speeds_in_sense(model: &Model, [least, greatest]: [f64; 2]) -> [f64; 2] {
    let [least, greatest] = if sense(model) < 0 { [-greatest, -least] } else { [least, greatest] };
    // Adding 0 turns -0 into 0.
    [least + 0.0, greatest + 0.0]
}

/// A cycle in the disc's sense, ball by ball in the machine's order, from an arbitrary start of its
/// period.
struct CycleForm {
    roles: Vec<Role>,
    /// Sort keys among balls with equal roles.
    sort_keys: Vec<[f64; 3]>,
    /// The balls that touch each other.
    touching: Vec<TouchingPair>,
}

impl CycleForm {
    /// Returns `None` if the cycle and the model differ in their number of contacts.
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
        // A period that starts within a phase has that phase at both ends.
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
        let sort_keys = (0..contacts)
            .map(|contact| {
                let [least, greatest] = speeds_in_sense(model, cycle.speed_extremes[contact]);
                let angle = angles[contact];
                if roles[contact].rests { [angle, 0.0, 0.0] } else { [greatest, least, angle] }
            })
            .collect();
        Some(CycleForm { roles, sort_keys, touching: cycle.touching.clone() })
    }

    /// Returns the smallest form over all starts of the period and all orders of identical balls.
    /// For a given start the role of a ball does not depend on the other balls, so that sorting
    /// finds the order.
    fn class(&self, model: &Model) -> CycleClass {
        let groups = model
            .ball_balancer()
            .map(|machine| groups_of_identical(&machine.balls))
            .unwrap_or_else(|| (0..model.contacts()).map(|contact| vec![contact]).collect());
        let starts = self.roles.iter().map(|role| role.letters.len()).max().unwrap_or(0).max(1);
        let starting_at = |start: usize| {
            let mut roles = self.roles.clone();
            for role in roles.iter_mut().filter(|role| !role.letters.is_empty()) {
                role.letters.rotate_left(start);
            }
            let mut balls: Vec<usize> = (0..roles.len()).collect();
            for places in &groups {
                let mut sorted = places.clone();
                sorted.sort_by(|&a, &b| {
                    roles[a].cmp(&roles[b]).then_with(|| self.compare_sort_keys(a, b))
                });
                for (&place, ball) in places.iter().zip(sorted) {
                    balls[place] = ball;
                }
            }
            let roles: Vec<Role> = balls.iter().map(|&ball| roles[ball].clone()).collect();
            (roles, balls)
        };
        let mut smallest = starting_at(0);
        for (roles, balls) in (1..starts).map(starting_at) {
            let order = roles.cmp(&smallest.0).then_with(|| {
                let pairs = balls.iter().zip(&smallest.1);
                let sort_keys = pairs.map(|(&a, &b)| self.compare_sort_keys(a, b));
                sort_keys.fold(Ordering::Equal, Ordering::then)
            });
            if order == Ordering::Less {
                smallest = (roles, balls);
            }
        }
        let (roles, balls) = smallest;
        let balls = self.with_smallest_pairs(&groups, &roles, balls);
        let parts: Vec<String> = roles.iter().map(Role::to_string).collect();
        let name = parts.join("|") + &pairs_text(&self.pairs(&balls));
        CycleClass { name, roles, balls }
    }

    /// Returns the places of the balls that touch each other, in ascending order, and whether they touch throughout.
    fn pairs(&self, balls: &[usize]) -> Vec<(bool, [usize; 2])> {
        let place =
            |ball: usize| balls.iter().position(|listed| *listed == ball).unwrap_or(ball) + 1;
        let pair = |pair: &TouchingPair| {
            let [first, second] = pair.contacts.map(place);
            (!pair.throughout, [first.min(second), first.max(second)])
        };
        let mut pairs: Vec<_> = self.touching.iter().map(pair).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Exchanges identical balls with equal roles so that the list of pairs is the smallest.
    fn with_smallest_pairs(
        &self,
        groups: &[Vec<usize>],
        roles: &[Role],
        balls: Vec<usize>,
    ) -> Vec<usize> {
        if self.touching.is_empty() {
            return balls;
        }
        let mut orders = vec![balls];
        for places in groups {
            for equal in places.chunk_by(|left, right| roles[*left] == roles[*right]) {
                orders = orders.iter().flat_map(|order| exchanges(order, equal)).collect();
            }
        }
        // The first of equal ones is in the order of the sort keys.
        orders.into_iter().min_by_key(|balls| self.pairs(balls)).unwrap_or_default()
    }

    fn compare_sort_keys(&self, a: usize, b: usize) -> Ordering {
        let pairs = self.sort_keys[a].iter().zip(&self.sort_keys[b]);
        pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(b)))
    }
}

/// Returns all orders of the balls in some places, the given order first.
fn exchanges(balls: &[usize], places: &[usize]) -> Vec<Vec<usize>> {
    let Some((first, others)) = places.split_first() else { return vec![balls.to_vec()] };
    let exchanged = |place: &usize| {
        let mut balls = balls.to_vec();
        balls.swap(*first, *place);
        exchanges(&balls, others)
    };
    places.iter().flat_map(exchanged).collect()
}

/// Returns the part of a class that says which balls touch.
fn pairs_text(pairs: &[(bool, [usize; 2])]) -> String {
    let list = |meet: bool, name: &str| {
        let of_kind = pairs.iter().filter(|(kind, _)| *kind == meet);
        let texts: Vec<String> =
            of_kind.map(|(_, [first, second])| format!("{first}-{second}")).collect();
        if texts.is_empty() { String::new() } else { format!(";{name}:{}", texts.join(",")) }
    };
    list(false, "touch") + &list(true, "meet")
}

fn in_sense(model: &Model, cycle_phase: CyclePhase) -> CyclePhase {
    match cycle_phase {
        CyclePhase::Forward if sense(model) < 0 => CyclePhase::Backward,
        CyclePhase::Backward if sense(model) < 0 => CyclePhase::Forward,
        stick => stick,
    }
}
