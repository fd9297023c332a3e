//! Impacts: contacts that meet in one or more gaps at the same instant.
//!
//! In each gap whose contacts touch, Newton's law and Coulomb's law hold for the impulses (J. J. Moreau, *Unilateral
//! contact and dry friction in finite freedom dynamics*, Springer 1988, doi:10.1007/978-3-7091-2624-0_1): an impulse `P ≥ 0`
//! acts only if the opening speed afterwards is `-e` times that before, which it is never below, and the friction impulse
//! `|Q| ≤ μ_b P` opposes the rolling speed afterwards. The friction of the ring is left out: a ball that sticks gets the
//! speed that the impact gives it, and stops again.

use smallvec::{SmallVec, smallvec};

use super::Failure;
use super::evaluator::{Entries, Unknowns, solved};
use crate::model::{Components, Dual, Gap, Number, Touching};

/// Rounding tolerance of impulses and speeds, over the largest speed.
const ROUNDING: f64 = 1e-13;

/// Speeds of separation up to this, non-dimensional, cannot be resolved: the width of the gap stays below rounding.
const UNRESOLVED: f64 = 1e-9;

/// In a row of bodies that do not slide on each other the friction impulses are not determined, but the speeds are. With
/// this much more of its own speed for each friction impulse they are determined.
const GIVE: f64 = 1e-10;

/// The most combinations of ways to touch that are tried.
const MOST_TRIED: usize = 1 << 16;

/// A gap whose contacts touch.
#[derive(Clone, Copy, Debug)]
struct Meeting<'a> {
    index: usize,
    gap: &'a Gap,
    restitution: f64,
    /// Opening speed and rolling speed before the impact.
    before: [Dual; 2],
}

/// How a gap takes part in an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// No impulse.
    None,
    /// An impulse with full friction against this direction of rolling.
    Slides(f64),
    /// An impulse after which the bodies do not slide on each other.
    Sticks,
}

/// What an impact has done.
#[derive(Clone, Debug)]
pub(super) struct Impact {
    /// The state after the impact, with its change along a direction.
    pub(super) state: Vec<Dual>,
    /// The gaps whose contacts stay together.
    pub(super) together: Vec<usize>,
    /// The gaps that have closed.
    pub(super) hits: usize,
    /// The contacts that the impulses lift off their support, which the model does not follow.
    pub(super) lifted: usize,
}

/// Returns the state after an impact in the gaps `touching`, whose contacts are at each other. `speeds` are the components
/// that are the speeds of the contacts.
///
/// # Errors
/// [`Failure::NoSolution`] if no impulses meet all conditions.
pub(super) fn impact(
    system: &dyn Touching,
    speeds: &[usize],
    state: &[Dual],
    touching: &[usize],
) -> Result<Impact, Failure> {
    let gaps = system.gaps();
    let fastest = speeds.iter().fold(1.0, |most: f64, speed| most.max(state[*speed].value.abs()));
    let tolerance = ROUNDING * fastest;
    let relative = |gap: &Gap, of: &[Dual]| {
        let [behind, ahead] = gap.contacts.map(|contact| of[speeds[contact]]);
        [ahead - behind, ahead + behind]
    };
    let meeting = |index: &usize| {
        let gap = &gaps[*index];
        let before = relative(gap, state);
        let lasts = -before[0].value < system.lasting_approach() && system.restitution() < 1.0;
        let restitution = if lasts { 0.0 } else { system.restitution() };
        Meeting { index: *index, gap, restitution, before }
    };
    let meetings: SmallVec<[Meeting<'_>; 8]> = touching.iter().map(meeting).collect();
    let responses = system.responses(state);
    // How opening and rolling speed of each gap answer to both impulses in each gap.
    let answers = |meeting: &Meeting<'_>, cause: &Meeting<'_>, impulse: usize| {
        relative(meeting.gap, &responses[cause.index][impulse])
    };
    let attempt = |parts: &[Part]| solve(&meetings, parts, &answers);
    let mut parts: SmallVec<[Part; 8]> = meetings.iter().map(Part::before).collect();
    let mut solution = None;
    for _ in 0..meetings.len() + 4 {
        let (impulses, after) = attempt(&parts);
        let corrected: SmallVec<[Part; 8]> = (0..parts.len())
            .map(|i| corrected(&meetings[i], parts[i], (impulses[i], after[i]), tolerance))
            .collect();
        if corrected == parts {
            solution = Some((impulses, after));
            break;
        }
        parts = corrected;
    }
    let solution = solution.or_else(|| {
        combinations(&meetings).find_map(|parts| {
            let (impulses, after) = attempt(&parts);
            let fits = (0..parts.len()).all(|i| {
                let now = (impulses[i], after[i]);
                corrected(&meetings[i], parts[i], now, tolerance) == parts[i]
            });
            fits.then_some((impulses, after))
        })
    });
    let finite = |(impulses, _): &(Pairs, Pairs)| {
        impulses.iter().flatten().all(|impulse| impulse.value.is_finite())
    };
    let Some((impulses, after)) = solution.filter(finite) else {
        return Err(Failure::NoSolution { solutions: 0 });
    };

    let mut changed = state.to_vec();
    let mut pressed: Components = smallvec![0.0; speeds.len()];
    for (meeting, impulses) in meetings.iter().zip(&impulses) {
        for (which, impulse) in impulses.iter().enumerate() {
            let response = &responses[meeting.index][which];
            changed.iter_mut().zip(response).for_each(|(to, by)| *to = *to + *impulse * *by);
            let pushes = meeting.gap.pushes()[which];
            for (contact, [_, outward]) in meeting.gap.contacts.into_iter().zip(pushes) {
                pressed[contact] += outward * impulse.value;
            }
        }
    }
    // Contacts that separate more slowly than after the slowest impact that is resolved stay together.
    let slow = match system.restitution() {
        restitution if restitution < 1.0 => {
            0.99 * restitution.max(0.01) * system.lasting_approach()
        }
        _ => UNRESOLVED,
    };
    let together = meetings.iter().zip(&after).filter(|(_, after)| after[0].value <= slow);
    Ok(Impact {
        together: together.map(|(one, _)| one.index).collect(),
        hits: meetings.iter().filter(|one| one.before[0].value < -tolerance).count(),
        lifted: pressed.iter().filter(|force| **force < 0.0).count(),
        state: changed,
    })
}

impl Part {
    /// Returns a first guess.
    fn before(meeting: &Meeting<'_>) -> Part {
        Part::Slides(if meeting.before[1].value < 0.0 { -1.0 } else { 1.0 })
    }
}

/// Returns how a gap should take part if the assumed way fails its condition, else the assumed way.
fn corrected(
    meeting: &Meeting<'_>,
    part: Part,
    ([force, friction], [opening, rolling]): ([Dual; 2], [Dual; 2]),
    tolerance: f64,
) -> Part {
    let limit = meeting.gap.friction_coefficient;
    let slips =
        |direction: f64| if limit > 0.0 { Part::Slides(direction) } else { Part::Slides(1.0) };
    // An impulse over the mass that it meets is a speed.
    let mass = meeting.gap.reduced_mass();
    match part {
        Part::None => {
            let short = opening.value + meeting.restitution * meeting.before[0].value;
            if short < -tolerance { Part::before(meeting) } else { part }
        }
        _ if force.value < -tolerance * mass => Part::None,
        Part::Slides(_) if limit == 0.0 => part,
        Part::Slides(direction) if direction * rolling.value < -tolerance => Part::Sticks,
        Part::Sticks if friction.value.abs() > limit * force.value + tolerance * mass => {
            slips(friction.value.signum())
        }
        Part::Slides(_) | Part::Sticks => part,
    }
}

/// Returns all combinations of ways to take part.
fn combinations<'a>(meetings: &'a [Meeting<'a>]) -> impl Iterator<Item = SmallVec<[Part; 8]>> + 'a {
    let ways = |meeting: &Meeting<'_>| if meeting.gap.friction_coefficient > 0.0 { 4 } else { 2 };
    let number = meetings.iter().map(ways).product::<usize>().min(MOST_TRIED);
    (0..number).map(move |mut combination| {
        let mut parts = SmallVec::new();
        for meeting in meetings {
            let way = combination % ways(meeting);
            combination /= ways(meeting);
            parts.push([Part::Slides(1.0), Part::None, Part::Slides(-1.0), Part::Sticks][way]);
        }
        parts
    })
}

type Pairs = SmallVec<[[Dual; 2]; 8]>;

/// Returns force and friction impulse of each gap, and its opening and rolling speed afterwards.
fn solve<'a>(
    meetings: &[Meeting<'a>],
    parts: &[Part],
    answers: &impl Fn(&Meeting<'a>, &Meeting<'a>, usize) -> [Dual; 2],
) -> (Pairs, Pairs) {
    let zero = Dual::constant(0.0);
    // The unknowns: the gap, and how much of both impulses one unit is.
    let mut unknowns: Vec<(usize, [f64; 2])> = Vec::new();
    for (i, (part, meeting)) in parts.iter().zip(meetings).enumerate() {
        match part {
            Part::None => {}
            Part::Slides(rolling) => {
                unknowns.push((i, [1.0, rolling * meeting.gap.friction_coefficient]));
            }
            Part::Sticks => unknowns.extend([(i, [1.0, 0.0]), (i, [0.0, 1.0])]),
        }
    }
    let answer = |of: usize, (cause, shares): (usize, [f64; 2]), which: usize| {
        let by = |impulse: usize| {
            let all = answers(&meetings[of], &meetings[cause], impulse);
            Dual::constant(shares[impulse]) * all[which]
        };
        by(0) + by(1)
    };
    let (mut matrix, mut right) = (Entries::new(), Unknowns::new());
    for (of, shares) in &unknowns {
        // The opening speed is given by the law of impact, and the rolling speed is zero where the bodies stick.
        let which = usize::from(shares[0] == 0.0);
        let give = Dual::constant(1.0 + if which == 1 { GIVE } else { 0.0 });
        matrix.extend(unknowns.iter().map(|cause| {
            let own = answer(*of, *cause, which);
            if cause == &(*of, *shares) { give * own } else { own }
        }));
        let Meeting { restitution, before, .. } = meetings[*of];
        let kept = Dual::constant(if which == 0 { -restitution } else { 0.0 });
        right.push(kept * before[which] - before[which]);
    }
    let solution = solved(matrix, right);
    let mut impulses: Pairs = smallvec![[zero; 2]; meetings.len()];
    for ((of, shares), value) in unknowns.iter().zip(solution) {
        for (impulse, share) in impulses[*of].iter_mut().zip(shares) {
            *impulse = *impulse + Dual::constant(*share) * value;
        }
    }
    let after = meetings.iter().map(|meeting| {
        let mut after = meeting.before;
        for (cause, impulses) in meetings.iter().zip(&impulses) {
            for (which, impulse) in impulses.iter().enumerate() {
                let answer = answers(meeting, cause, which);
                for (to, by) in after.iter_mut().zip(answer) {
                    *to = *to + *impulse * by;
                }
            }
        }
        after
    });
    let after = after.collect();
    (impulses, after)
}
