//! Impacts: bodies that meet in one or more gaps, or at contacts that open, at the same instant.
//!
//! In each gap whose contacts touch, Newton's law and Coulomb's law hold for the impulses (J. J. Moreau, *Unilateral
//! contact and dry friction in finite freedom dynamics*, Springer 1988, doi:10.1007/978-3-7091-2624-0_1): an impulse `P ≥ 0`
//! acts only if the opening speed afterwards is `-e` times that before, which it is never below, and the friction impulse
//! `|Q| ≤ μ_b P` opposes the rolling speed afterwards. The friction of the ring is left out: a ball that sticks gets the
//! speed that the impact gives it, and stops again.
//!
//! With friction, Newton's law can add energy (T. R. Kane, *A dynamics puzzle*, Stanford Mechanics Alumni Club Newsletter 6,
//! 1984), and in several gaps Poisson's law can, too (C. Glocker, Multibody System Dynamics 29 (2013) 77 and 30 (2013) 445,
//! doi:10.1007/s11044-013-9387-2). The same laws with `e = 0` never do: with the mass matrix `M`, their impulses make
//! `v⁺ᵀ M (v⁺ - v⁻)` the work of friction on the speeds afterwards, which is not positive, so that the energy is at most that
//! before. Where Newton's impulses would add energy, the impulses that conserve it take their place, on the line from the
//! impulses with `e = 0` to Newton's (A. Chatterjee, A. Ruina, J. Appl. Mech. 65 (1998) 939, doi:10.1115/1.2791938): less of
//! the speed of approach is restored. The energy is a convex function on this line, so that there is exactly one such
//! point. `P ≥ 0` and `|Q| ≤ μ_b P` hold there, and no gap closes.

use smallvec::{SmallVec, smallvec};

use super::impulse_response::ImpactPlace;
use super::impulses::{GapLaw, ImpactEquations, Impulses, Pairs};
use super::linear_system::Solved;
use super::{Evaluator, Failure, Phase};
use crate::model::{Components, Elementary, ImpactLaw};

/// Rounding tolerance of impulses and speeds, over the largest speed.
const ROUNDING: f64 = 1e-13;

/// Speeds of separation up to this, non-dimensional, cannot be resolved: the width of the gap stays below rounding.
const UNRESOLVED: f64 = 1e-9;

/// What an impact has done.
#[derive(Clone, Debug)]
pub(crate) struct Impact {
    /// The places whose bodies stay together.
    pub(super) together: SmallVec<[ImpactPlace; 8]>,
    /// The gaps that were open and have closed.
    pub(crate) hits: SmallVec<[Hit; 2]>,
    /// The contacts that were apart and have hit.
    pub(crate) landed: SmallVec<[usize; 2]>,
    /// The contacts that may open and do not slide afterwards.
    pub(super) stopped: SmallVec<[usize; 2]>,
    /// The contacts that the impulses lift off their support, which the model does not follow.
    pub(super) lifted: usize,
}

/// An impact in a gap that was open.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// The gap.
    pub(crate) gap: usize,
    /// The speed at which it opened just before.
    pub(crate) opening_speed: f64,
}

/// Changes the state by an impact at the places `touching`, whose bodies are at each other, with the phases of all contacts
/// and gaps before it. The slopes of dual numbers change, too.
pub(super) fn impact<T: Solved>(
    evaluator: &Evaluator,
    state: &mut [T],
    touching: &[ImpactPlace],
    phases: &[Phase],
) -> Result<Impact, Failure> {
    let (system, graph) = (evaluator.system(), evaluator.graph());
    let contacts = graph.contacts.len();
    let between = system.touching();
    let all_gaps = between.map_or(&[][..], |between| between.gaps());
    let speeds: SmallVec<[Option<usize>; 8]> =
        (0..contacts).map(|contact| graph.speed_component(contact)).collect();
    let openings = evaluator.openings(|component| state[component]);
    let of_contacts = speeds.iter().flatten().map(|speed| state[*speed]);
    let at_openings = openings.iter().flat_map(|[_, opening, sliding]| [*opening, *sliding]);
    let all = of_contacts.chain(at_openings).map(|speed| speed.value().abs());
    let fastest = all.fold(1.0, f64::max);
    // The opening speed and the sliding speed of a place, from a state or from a response.
    let in_gap = |gap: usize, of: &[T]| {
        let speed = |contact: usize| speeds[contact].expect("speeds of balls are components");
        let [behind, ahead] = all_gaps[gap].contacts.map(|contact| of[speed(contact)]);
        [ahead - behind, ahead + behind]
    };
    let before: Pairs<T> = touching
        .iter()
        .flat_map(|place| match *place {
            ImpactPlace::Gap(gap) => in_gap(gap, state),
            ImpactPlace::Opening(opening) => [openings[opening][1], openings[opening][2]],
        })
        .collect();
    let responses = evaluator.responses(state, touching);
    let rows = touching.iter().flat_map(|place| [0, 1].map(|speed| (*place, speed)));
    let answers: Vec<T> = rows
        .flat_map(|(place, speed)| {
            responses.iter().map(move |by| match place {
                ImpactPlace::Gap(gap) => in_gap(gap, &by.components)[speed],
                ImpactPlace::Opening(opening) => by.openings[opening][speed],
            })
        })
        .collect();
    // The law of impact, the friction coefficient, the mass that the opening acceleration meets, the masses of the bodies, and the
    // arm of their friction.
    let law = |(row, place): (usize, &ImpactPlace)| {
        let answer = answers[2 * row * (before.len() + 1)].value();
        match (*place, between) {
            (ImpactPlace::Gap(gap), Some(between)) => {
                let gap = &between.gaps()[gap];
                let restitution = between.restitution();
                let lasting_approach = between.lasting_approach();
                let law = ImpactLaw { restitution, tangential_restitution: 0.0, lasting_approach };
                (law, gap.friction_coefficient, gap.reduced_mass(), (gap.masses, gap.lever))
            }
            (ImpactPlace::Gap(index) | ImpactPlace::Opening(index), _) => {
                let contact = graph.openings[index].contact;
                let friction_coefficient = system.friction(contact).coefficient;
                let mass = 1.0 / answer;
                (system.impact_law(contact), friction_coefficient, mass, ([mass; 2], 1.0))
            }
        }
    };
    let laws: SmallVec<[_; 8]> = touching.iter().enumerate().map(law).collect();
    let with_opening = laws.iter().zip(before.iter().step_by(2));
    let gap_laws = with_opening.map(|((law, friction_coefficient, mass, _), opening)| {
        let lasts = -opening.value() < law.lasting_approach && law.restitution < 1.0;
        let is_slow = lasts || opening.value() >= 0.0;
        GapLaw {
            restitution: if is_slow { 0.0 } else { law.restitution },
            tangential_restitution: if is_slow { 0.0 } else { law.tangential_restitution },
            friction_coefficient: *friction_coefficient,
            mass: *mass,
        }
    });
    let masses = laws.iter().flat_map(|(.., (masses, _))| *masses);
    let meeting = ImpactEquations {
        laws: gap_laws.collect(),
        fastest: before.iter().map(|speed| speed.value().abs()).fold(0.0, f64::max),
        heaviest: masses.fold(0.0, f64::max),
        tolerance: ROUNDING * fastest,
        before,
        answers,
    };
    let arms: SmallVec<[f64; 8]> = laws.iter().map(|(.., (_, arm))| *arm).collect();
    let Impulses { impulses, after, stick } = passive(&meeting, &arms)?;

    let mut pressed: Components = smallvec![0.0; contacts];
    for (place, (impulse, response)) in impulses.iter().zip(&responses).enumerate() {
        let components = state.iter_mut().zip(&response.components);
        components.for_each(|(to, by)| *to = *to + *impulse * *by);
        if let ImpactPlace::Gap(gap) = touching[place / 2] {
            let gap = &all_gaps[gap];
            for (contact, [_, outward]) in gap.contacts.into_iter().zip(gap.pushes()[place % 2]) {
                pressed[contact] += outward * impulse.value();
            }
        }
    }
    // Bodies that separate more slowly than after the slowest impact that is resolved stay together.
    let slow = |law: &ImpactLaw| match law.restitution {
        restitution if restitution < 1.0 => 0.99 * restitution.max(0.01) * law.lasting_approach,
        _ => UNRESOLVED,
    };
    let places = || touching.iter().zip(&laws).zip(after.iter().step_by(2));
    let together = places().filter(|((_, (law, ..)), opening)| opening.value() <= slow(law));
    let together: SmallVec<[ImpactPlace; 8]> = together.map(|((place, _), _)| *place).collect();
    let closes = |place: &ImpactPlace, opening: &T| {
        opening.value() < -meeting.tolerance || together.contains(place)
    };
    let mut hits = SmallVec::new();
    let mut landed = SmallVec::new();
    for (place, opening) in touching.iter().zip(meeting.before.iter().step_by(2)) {
        match *place {
            ImpactPlace::Gap(gap)
                if phases[contacts + gap] == Phase::Open && closes(place, opening) =>
            {
                hits.push(Hit { gap, opening_speed: opening.value() });
            }
            ImpactPlace::Opening(site) => {
                let contact = graph.openings[site].contact;
                if phases[contact] == Phase::Apart && closes(place, opening) {
                    landed.push(contact);
                }
            }
            _ => {}
        }
    }
    let stopped = touching.iter().zip(stick).filter_map(|(place, sticks)| match *place {
        ImpactPlace::Opening(site) if sticks => Some(graph.openings[site].contact),
        _ => None,
    });
    let stopped = stopped.collect();
    let lifted = pressed.iter().filter(|force| **force < 0.0).count();
    Ok(Impact { together, hits, landed, stopped, lifted })
}

/// Returns the impulses of both laws or, where these would add energy, those that conserve it. There are none unless
/// contacts approach each other.
fn passive<T: Elementary>(
    meeting: &ImpactEquations<T>,
    arms: &[f64],
) -> Result<Impulses<T>, Failure> {
    let ImpactEquations { laws, before, tolerance, .. } = meeting;
    if before.iter().step_by(2).all(|opening| opening.value() >= -tolerance) {
        let impulses = smallvec![T::constant(0.0); before.len()];
        let stick = laws.iter().map(|_| false).collect();
        return Ok(Impulses { impulses, after: before.clone(), stick });
    }
    let sum = |left: &Pairs<T>, factor: T, right: &Pairs<T>| -> Pairs<T> {
        left.iter().zip(right).map(|(left, right)| *left + factor * *right).collect()
    };
    // Twice the work of impulses at these speeds. The friction impulse acts on the bodies against their sliding, with an arm.
    let work = |impulses: &Pairs<T>, speeds: &Pairs<T>| {
        let arms = arms.iter().flat_map(|arm| [1.0, -arm]);
        let all = arms.zip(impulses).zip(speeds);
        all.fold(T::constant(0.0), |sum, ((arm, impulse), speed)| {
            sum + T::constant(arm) * *impulse * *speed
        })
    };
    let one = T::constant(1.0);
    let added = |by: &Impulses<T>| work(&by.impulses, &sum(before, one, &by.after));
    let newton = meeting.impulses()?;
    let rounding: f64 =
        newton.impulses.iter().map(|impulse| tolerance * impulse.value().abs()).sum();
    let is_inelastic =
        laws.iter().all(|law| law.restitution == 0.0 && law.tangential_restitution == 0.0);
    if is_inelastic || added(&newton).value() <= rounding {
        return Ok(newton);
    }
    let plastic = |law: &GapLaw| GapLaw { restitution: 0.0, tangential_restitution: 0.0, ..*law };
    let laws = laws.iter().map(plastic).collect();
    let inelastic = ImpactEquations { laws, ..meeting.clone() }.impulses()?;
    let impulses = sum(&newton.impulses, -one, &inelastic.impulses);
    let after = sum(&newton.after, -one, &inelastic.after);
    // Twice the added energy as a polynomial of the share of the difference.
    let (constant, square) = (added(&inelastic), work(&impulses, &after));
    let linear = added(&newton) - constant - square;
    let root = (linear * linear - T::constant(4.0) * square * constant).sqrt();
    let share = (root - linear) * (T::constant(2.0) * square).reciprocal();
    Ok(Impulses {
        impulses: sum(&inelastic.impulses, share, &impulses),
        after: sum(&inelastic.after, share, &after),
        stick: newton
            .stick
            .iter()
            .zip(&inelastic.stick)
            .map(|(left, right)| *left && *right)
            .collect(),
    })
}
