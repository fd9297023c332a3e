//! The section that a contact marks, with coordinates on it.
//!
//! The beginning of a period of the forcing marks it, if the system is forced. Otherwise, a ball that runs in a ring marks it by its
//! passages through the angle 0. Other angles, such as that of a motor, mark it by their passages through 1 rad, a contact on a moving
//! support where its position is at a maximum, and each coordinate where it turns back.
//!
//! Where a translation that no equation notices carries a coordinate along, its speed relative to the translation counts.
//!
//! The coordinates are what remains of the free components (position and velocity of the table) without translations, and the variables
//! of the contacts that vary: not the component that marks the section, the speed of a
//! contact that sticks there, or the position of a contact that rests throughout. Such a contact may
//! rest anywhere in an interval; each such position is a neutral direction of a continuous family of
//! cycles, with a multiplier of exactly 1. Contacts that touch move together, and count once.

use std::f64::consts::TAU;

use nalgebra::DVector;
use smallvec::{SmallVec, smallvec};

use super::system_view::{ContactPlace, SystemView};
use crate::model::{Components, ForcingLayout, Translations, wrap_to_pi};
use crate::motion::{Direction, Motion, Phase, Phases};

/// A velocity turns its sign by more than rounding if it has at least this size, non-dimensional, at an end of the step. Where
/// bodies touch or stick, their relative speeds are zero to rounding.
pub(super) const RESOLVED: f64 = 1e-9;

/// The angle that marks a section, rad: no particular one, at which the sliding speed of a mechanism might vanish.
const MARKED_ANGLE: f64 = 1.0;

/// A function of the state, and its value on a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Marking {
    /// The component that is the function, but for a multiple of another component.
    pub(super) component: usize,
    minus: Option<(usize, f64)>,
    value: f64,
}

impl Marking {
    fn new(component: usize, value: f64) -> Self {
        Marking { component, minus: None, value }
    }

    /// Gives the function its value on the section in a state.
    pub(super) fn put_on(&self, state: &mut [f64]) {
        let other = self.minus.map_or(0.0, |(place, by)| by * state[place]);
        state[self.component] = self.value + other;
    }

    /// Returns the components that the function reads.
    pub(super) fn components(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.component).chain(self.minus.map(|(place, _)| place))
    }

    /// Returns the function of a state with these components.
    pub(super) fn of(&self, component: impl Fn(usize) -> f64) -> f64 {
        component(self.component) - self.minus.map_or(0.0, |(place, by)| by * component(place))
    }
}

/// What marks a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SectionMark {
    /// A contact passes through the angle 0 in this direction. `may_stop` states whether it may stop or turn back on its way.
    Round { contact: usize, direction: f64, may_stop: bool },
    /// A position, of this contact if it is one, turns back where its velocity or sliding speed falls, or else rises, through a value.
    TurningPoint { contact: Option<usize>, speed: Marking, falls: bool },
    /// This component, an angle, grows, or else falls, through [`MARKED_ANGLE`], modulo one turn.
    Angle { component: usize, grows: bool },
    /// A period of the forcing begins.
    Period(ForcingLayout),
}

impl SectionMark {
    /// Returns the contact that marks the section, if it is one.
    pub(super) fn contact(self) -> Option<usize> {
        match self {
            SectionMark::Round { contact, .. } => Some(contact),
            SectionMark::TurningPoint { contact, .. } => contact,
            SectionMark::Angle { .. } | SectionMark::Period(_) => None,
        }
    }

    /// Returns the function that marks the section.
    pub(super) fn marking(self, view: &SystemView) -> Marking {
        match self {
            SectionMark::Round { contact, .. } => {
                Marking::new(view.contacts[contact].position, 0.0)
            }
            SectionMark::TurningPoint { speed, .. } => speed,
            SectionMark::Angle { component, .. } => Marking::new(component, MARKED_ANGLE),
            SectionMark::Period(forcing) => Marking::new(forcing.component, 0.0),
        }
    }

    /// Returns the value through which its function passes next, and whether from above.
    pub(super) fn next(self, view: &SystemView, from: f64) -> (f64, bool) {
        let value = self.marking(view).value;
        let after = |period: f64| value + period * (((from - value) / period).floor() + 1.0);
        let before = |period: f64| value + period * (((from - value) / period).ceil() - 1.0);
        match self {
            SectionMark::Round { direction, .. } => (value, direction < 0.0),
            SectionMark::TurningPoint { falls, .. } => (value, falls),
            SectionMark::Angle { grows: true, .. } => (after(TAU), false),
            SectionMark::Angle { grows: false, .. } => (before(TAU), true),
            SectionMark::Period(forcing) => (after(forcing.period), false),
        }
    }
}

/// A section and the contacts' phases there.
#[derive(Clone, Debug)]
pub(super) struct Section {
    /// What marks it.
    pub(super) mark: SectionMark,
    /// The phases of the contacts there.
    pub(super) phases: Phases,
    /// Which contacts rest throughout the orbit.
    pub(super) rests: SmallVec<[bool; 8]>,
    /// The function that marks the section.
    marking: Marking,
    /// The components that are the coordinates, but for their displacement by the translations, and whether they are angles.
    coordinates: Vec<(usize, bool)>,
    /// The translations of the orbit that no equation notices.
    translations: Translations,
    /// The positions, and the speeds, of the contacts that touch another one, each with that of the contact that it follows.
    following: [Vec<(usize, usize)>; 2],
    /// Number of components of a state.
    dimension: usize,
}

impl Section {
    pub(super) fn new(
        view: &SystemView,
        mark: SectionMark,
        phases: &[Phase],
        rests: SmallVec<[bool; 8]>,
    ) -> Self {
        let marking = mark.marking(view);
        let marked = marking.component;
        let following = view.evaluator.following(phases, mark.contact());
        let driven = |place: &usize| {
            let mut contacts = view.contacts.iter().zip(&rests);
            contacts.any(|(contact, rests)| *rests && contact.driven == Some(*place))
        };
        // A translation that displaces a contact that rests is none of the orbit.
        let rests_at = |place: usize| {
            let mut contacts = view.contacts.iter().zip(&rests);
            contacts.any(|(contact, rests)| *rests && contact.holds() && contact.position == place)
        };
        let translations = view.translations.without(rests_at);
        let free = view.free.iter().copied().filter(|place| !translations.has_pivot(*place));
        let free = free.filter(|place| *place != marked && !driven(place));
        let mut coordinates: Vec<_> = free.map(|place| (place, view.is_angle(place))).collect();
        for (index, contact) in view.contacts.iter().enumerate() {
            if following[0].iter().any(|(follower, _)| *follower == contact.position) {
                continue;
            }
            // Several contacts may have the speed and the position of one body.
            let is_new = |coordinates: &[(usize, bool)], place: usize| {
                let known = coordinates.iter().any(|(other, _)| *other == place);
                place != marked && !known && !driven(&place)
            };
            if phases[index] != Phase::Stick {
                let speed = contact.speed.filter(|speed| is_new(&coordinates, *speed));
                coordinates.extend(speed.map(|place| (place, false)));
            }
            // Another contact of the same body may hold it there.
            let held = |(other, place): (usize, &ContactPlace)| {
                place.position == contact.position && rests[other] && place.holds()
            };
            let counts = !translations.has_pivot(contact.position)
                && !view.contacts.iter().enumerate().any(held);
            if counts && is_new(&coordinates, contact.position) {
                coordinates.push((contact.position, contact.angular));
            }
        }
        Section {
            mark,
            phases: phases.iter().copied().collect(),
            rests,
            marking,
            coordinates,
            translations,
            following,
            dimension: view.dimension(),
        }
    }

    /// The coordinates of a state, or of a perturbation.
    pub(super) fn coordinates(&self, state: &[f64]) -> DVector<f64> {
        let values = (self.coordinates.iter())
            .map(|(place, _)| self.translations.remaining(|place| state[place], *place));
        DVector::from_iterator(self.coordinates.len(), values)
    }

    /// Returns the state with these coordinates; the other variables are those of `like`, and the
    /// marking function has its value.
    pub(super) fn state(&self, like: &[f64], coordinates: &DVector<f64>) -> Components {
        let mut state = Components::from_slice(like);
        for ((place, _), value) in self.coordinates.iter().zip(coordinates.iter()) {
            let carried = like[*place] - self.translations.remaining(|place| like[place], *place);
            state[*place] = value + carried;
        }
        self.put_on(&mut state);
        let [positions, speeds] = &self.following;
        for (follower, leader) in positions {
            state[*follower] = state[*leader] + (like[*follower] - like[*leader]);
        }
        speeds.iter().for_each(|(follower, leader)| state[*follower] = state[*leader]);
        state
    }

    /// Gives the marking function its value.
    pub(super) fn put_on(&self, state: &mut [f64]) {
        self.marking.put_on(state);
    }

    /// Returns whether contacts may have these phases in a motion that comes back. Contacts that rest must stick. A contact that
    /// marks the section may be in the band only if it may stop.
    pub(super) fn allows(&self, phases: &[Phase]) -> bool {
        let mut rests = self.rests.iter().zip(phases);
        let stops = match self.mark {
            SectionMark::Round { contact, may_stop: false, .. } => phases[contact].in_band(),
            SectionMark::Round { .. }
            | SectionMark::TurningPoint { .. }
            | SectionMark::Angle { .. }
            | SectionMark::Period(_) => false,
        };
        !stops && rests.all(|(rests, phase)| !rests || *phase == Phase::Stick)
    }

    /// Returns time and state of a passage through the section in the latest step of a motion.
    pub(super) fn passage(&self, view: &SystemView, motion: &Motion) -> Option<(f64, Components)> {
        let marked = |state: &[f64]| self.marking.of(|place| state[place]);
        match self.mark {
            SectionMark::Round { contact, direction, .. } => motion
                .passage(contact)
                .filter(|(_, state)| direction * motion.evaluator().speeds(state)[contact] > 0.0),
            mark => {
                let begun = marked(&motion.within_last_step(motion.last_step_began())?);
                let (target, from_above) = mark.next(view, begun);
                let sign = if from_above { 1.0 } else { -1.0 };
                let (time, mut state) =
                    motion.falls_through_zero(|state| sign * (marked(state) - target))?;
                let end = marked(&motion.within_last_step(motion.time())?);
                let is_resolved = !matches!(mark, SectionMark::TurningPoint { .. })
                    || [begun, end].iter().any(|end| (end - target).abs() > RESOLVED);
                if matches!(mark, SectionMark::Period(_)) {
                    self.put_on(&mut state);
                }
                is_resolved.then_some((time, state))
            }
        }
    }

    /// Returns the number of independent displacements after which the motion would also repeat: of contacts that rest, and
    /// translations that no equation notices.
    pub(super) fn neutral_directions(&self, view: &SystemView) -> usize {
        let rests = |index: usize| self.rests[index] && view.contacts[index].holds();
        let contacts = view.contacts.iter().enumerate().filter(|(index, _)| rests(*index));
        let mut positions: Vec<usize> = contacts.map(|(_, contact)| contact.position).collect();
        let pivots = self.translations.pivots();
        positions.extend(pivots.filter(|place| *place != self.marking.component));
        positions.sort_unstable();
        positions.dedup();
        positions.len()
    }

    /// Unit perturbations along the coordinates.
    pub(super) fn directions(&self) -> Vec<Components> {
        let unit = |(place, _): &(usize, bool)| {
            let mut direction: Components = smallvec![0.0; self.dimension];
            direction[*place] = 1.0;
            direction[self.marking.component] -= self.marking.of(|place| direction[place]);
            for (follower, leader) in self.following.iter().flatten() {
                direction[*follower] = direction[*leader];
            }
            direction
        };
        self.coordinates.iter().map(unit).collect()
    }

    /// Returns the projection on the section of a perturbation of the motion, in a state with this
    /// time derivative: neighbours reach the section slightly earlier or later.
    pub(super) fn on_section(&self, perturbation: &[f64], rate: &[f64]) -> DVector<f64> {
        let [perturbed, passing] =
            [perturbation, rate].map(|of| self.marking.of(|place| of[place]));
        let late = perturbed / passing;
        self.coordinates(perturbation) + self.coordinates(rate) * -late
    }

    /// The difference of two states' coordinates, angles modulo 2π.
    pub(super) fn difference(&self, left: &[f64], right: &[f64]) -> DVector<f64> {
        let mut difference = self.coordinates(left) - self.coordinates(right);
        for ((_, is_angle), value) in self.coordinates.iter().zip(difference.iter_mut()) {
            if *is_angle {
                *value = wrap_to_pi(*value);
            }
        }
        difference
    }
}

/// Returns what marks the section of a system if no ball that goes round a ring does: the periods of its forcing; or else its angles
/// besides the maxima of positions on a moving support, or the turning points of all coordinates.
pub(super) fn marks(view: &SystemView) -> Vec<SectionMark> {
    if let Some(forcing) = view.evaluator.graph().layout.forcing {
        return vec![SectionMark::Period(forcing)];
    }
    let angles = view.marking_angles();
    if angles.is_empty() && view.revolves() {
        return Vec::new();
    }
    let both = |component| [true, false].map(|grows| SectionMark::Angle { component, grows });
    let mut marks: Vec<_> = angles.into_iter().flat_map(both).collect();
    let maxima = maxima(view);
    marks.extend(if maxima.is_empty() { turning_points(view) } else { maxima });
    marks
}

/// Returns the marks at the turning points of coordinates, in either direction: an impact may leave only one of them smooth.
fn turning_points(view: &SystemView) -> Vec<SectionMark> {
    let velocities = view.evaluator.graph().layout.velocities.iter().flatten();
    let both = velocities.flat_map(|component| [true, false].map(|falls| (*component, falls)));
    both.map(|(component, falls)| {
        let contact = view.contacts.iter().position(|contact| contact.speed == Some(component));
        let at_rest = || Marking::new(component, smooth_speed(view, component, 0.0));
        let speed = relative_speed(view, component).unwrap_or_else(at_rest);
        SectionMark::TurningPoint { contact, speed, falls }
    })
    .collect()
}

/// Returns the speed of a position relative to the translation that carries it along: of a block that a spring pulls at a constant speed,
/// its speed less that of the spring's end. `component` is the velocity of the position.
fn relative_speed(view: &SystemView, component: usize) -> Option<Marking> {
    let graph = view.evaluator.graph();
    // The rate of change of a component, without velocities and with one of them.
    let rates_of = |place: usize, velocity: Option<usize>| {
        let rate = |size: f64| {
            let mut state = vec![0.0; view.dimension()];
            velocity.into_iter().for_each(|velocity| state[velocity] = size);
            view.evaluator.rates(&view.evaluator.no_phases(), &state)[place]
        };
        [rate(0.0), rate(1.0) - rate(0.0)]
    };
    let carried = |place: usize| {
        let mut carriers = view.translations.carriers(place).filter(|(pivot, _)| *pivot != place);
        Some((place, carriers.next()?)).filter(|_| carriers.next().is_none())
    };
    let mut all = (0..view.dimension()).filter_map(carried);
    let (position, (pivot, by)) =
        all.find(|(place, _)| graph.only_rate(*place) == Some(component))?;
    let carrier = if graph.is_clock(pivot) { None } else { Some(graph.only_rate(pivot)?) };
    let [constant, factor] = rates_of(position, Some(component));
    let [carried, per_speed] = rates_of(pivot, carrier).map(|rate| by * rate / factor);
    let minus = carrier.map(|velocity| (velocity, per_speed));
    Some(Marking { component, minus, value: carried - constant / factor })
}

/// Returns the marks at the maxima of positions. The contact must slip there: the speed of its position differs from its
/// sliding speed, always by the same amount, as on a belt.
fn maxima(view: &SystemView) -> Vec<SectionMark> {
    let slip = view.contacts.iter().map(|_| Phase::Slip(Direction::Forward));
    let gaps = view.evaluator.graph().gaps.iter().map(|_| Phase::Open);
    let phases: Phases = slip.chain(gaps).collect();
    let probe = |scale: f64| -> Vec<f64> {
        (0..view.dimension()).map(|component| scale * (0.3 + 0.07 * component as f64)).collect()
    };
    let mark = |(contact, place): (usize, &ContactPlace)| {
        let component = place.speed?;
        let [first, second] = [1.0, -0.5].map(|scale| {
            let state = probe(scale);
            state[component] - view.evaluator.rates(&phases, &state)[place.position]
        });
        let same = (first - second).abs() <= 1e-12 * first.abs();
        let value = smooth_speed(view, component, first);
        let speed = Marking::new(component, value);
        let mark = SectionMark::TurningPoint { contact: Some(contact), speed, falls: true };
        (same && first != 0.0).then_some(mark)
    };
    view.contacts.iter().enumerate().filter_map(mark).collect()
}

/// The speed, non-dimensional, at which the section of a body on fixed ground lies.
const SLIGHT: f64 = 1e-4;

/// Returns the speed at which a section lies. A section where a contact stops would lie on a switch, where the derivative of the
/// return map depends on the side. If several contacts of one body stop at different speeds, such as a block on the ground and on a
/// belt, the section lies halfway between two of these speeds; if its contacts stop at rest, it lies at a slight speed.
fn smooth_speed(view: &SystemView, component: usize, speed: f64) -> f64 {
    let graph = view.evaluator.graph();
    let mut state = vec![0.0; view.dimension()];
    let at_zero = view.evaluator.speeds(&state);
    state[component] = 1.0;
    let at_one = view.evaluator.speeds(&state);
    let shifted = (0..view.contacts.len())
        .filter(|contact| graph.shifted_component(*contact) == Some(component));
    let stops = shifted.map(|contact| at_zero[contact] / (at_zero[contact] - at_one[contact]));
    let nearest = stops.filter(|stop| *stop != 0.0).min_by(|a, b| a.abs().total_cmp(&b.abs()));
    let rests = speed == 0.0
        && (0..view.contacts.len()).any(|contact| {
            graph.speed_component(contact) == Some(component)
                && view.system().friction(contact).can_stick()
        });
    nearest.map_or(if rests { SLIGHT } else { speed }, |stop| 0.5 * stop)
}
