//! The impulses of an impact: Newton's law of restitution and Coulomb's law of friction in several gaps at once. A contact that
//! opens is a gap here, too.
//!
//! The unknowns are a contact impulse `P` and a friction impulse `Q` in each gap. A gap takes part in one of four ways, and
//! each way gives two linear equations. All combinations of ways are tried; a combination holds if the impulses, and the
//! speeds after them, meet the conditions of each way. The impulses of a gap are eliminated once from the equations of the
//! gaps after it, for all ways of these gaps.

use smallvec::{SmallVec, smallvec};

use super::Failure;
use crate::model::{Elementary, Number};

/// In a row of bodies that do not slide on each other the friction impulses are not determined, but the speeds are. With
/// this much more of its own speed for each friction impulse they are determined.
const GIVE: f64 = 1e-12;

/// The largest friction impulse of bodies that do not slide on each other, over the product of the largest mass and the
/// largest speed. Where the equations of a row of bodies contradict each other, the impulses are much larger.
const LARGEST: f64 = 1e3;

/// Speeds after an impact that differ by no more than this, over the largest speed, are the same motion, and so are those that
/// differ by this multiple of the rounding tolerance: bodies that hardly move meet the conditions of several ways to rounding.
const SAME: f64 = 1e-6;
const UNDECIDED: f64 = 1e3;

/// The most combinations of ways that are tried: those of eight gaps.
const MOST_TRIED: usize = 1 << 16;

/// Two numbers for each gap: one for the contact, one for the friction.
pub(super) type Pairs<T> = SmallVec<[T; 16]>;

/// How a gap takes part in an impact.
#[derive(Clone, Copy, Debug)]
enum ImpactMode {
    /// No impulse.
    None,
    /// An impulse with full friction against this direction of rolling.
    Slides(f64),
    /// An impulse after which the bodies do not slide on each other.
    Sticks,
}

/// The law of impact in a gap.
#[derive(Clone, Copy, Debug)]
pub(super) struct GapLaw {
    /// The speed of separation over the speed of approach.
    pub(super) restitution: f64,
    /// The sliding speed over that before, with the opposite sign, where the bodies do not slide on each other.
    pub(super) tangential_restitution: f64,
    pub(super) friction_coefficient: f64,
    /// The mass that the opening acceleration meets.
    pub(super) mass: f64,
}

/// Gaps whose contacts are at each other, and how they answer to impulses.
#[derive(Clone)]
pub(super) struct ImpactEquations<T> {
    /// The law of each gap.
    pub(super) laws: SmallVec<[GapLaw; 8]>,
    /// The opening speed and the rolling speed of each gap before the impact.
    pub(super) before: Pairs<T>,
    /// The change of each of these speeds by each impulse, row by row.
    pub(super) answers: Vec<T>,
    /// The largest of these speeds.
    pub(super) fastest: f64,
    /// The largest mass.
    pub(super) heaviest: f64,
    /// The rounding tolerance of speeds.
    pub(super) tolerance: f64,
}

/// The impulses in all gaps, and the opening speeds and the rolling speeds after them.
#[derive(Clone)]
pub(super) struct Impulses<T> {
    pub(super) impulses: Pairs<T>,
    pub(super) after: Pairs<T>,
    /// Whether the bodies of each gap do not slide on each other after them, but for what rounding leaves.
    pub(super) stick: SmallVec<[bool; 8]>,
}

impl<T: Elementary> ImpactEquations<T> {
    /// Returns the impulses that obey both laws.
    ///
    /// # Errors
    /// [`Failure::UndecidedImpact`] unless all combinations that hold lead to the same speeds, and
    /// [`Failure::TooManyCombinations`] for so many gaps that they cannot be tried.
    pub(super) fn impulses(&self) -> Result<Impulses<T>, Failure> {
        let values = ImpactEquations {
            laws: self.laws.clone(),
            before: self.before.iter().map(|speed| speed.value()).collect(),
            answers: self.answers.iter().map(|answer| answer.value()).collect(),
            fastest: self.fastest,
            heaviest: self.heaviest,
            tolerance: self.tolerance,
        };
        let number = (0..self.laws.len()).map(|gap| values.ways(gap).count());
        if number.fold(1, usize::saturating_mul) > MOST_TRIED {
            return Err(Failure::TooManyCombinations);
        }
        let mut found = Vec::new();
        values.search(&mut ImpulseElimination::new(&values), &mut Vec::new(), &mut found);
        let [(ways, _)] = &found[..] else {
            return Err(Failure::UndecidedImpact { solutions: found.len() });
        };
        let mut elimination = ImpulseElimination::new(self);
        for (gap, way) in ways.iter().enumerate() {
            elimination.eliminate(&self.laws, gap, *way);
        }
        let impulses = elimination.impulses(|_, _| true).ok_or(Failure::NotFinite)?;
        let sticks = |(way, law): (&ImpactMode, &GapLaw)| {
            matches!(way, ImpactMode::Sticks) && law.tangential_restitution == 0.0
        };
        let stick = ways.iter().zip(&self.laws).map(sticks).collect();
        Ok(Impulses { after: self.after(&impulses), impulses, stick })
    }
}

impl ImpactEquations<f64> {
    /// Returns the ways in which a gap may take part: first that in which the bodies slide as before.
    fn ways(&self, gap: usize) -> impl Iterator<Item = ImpactMode> + use<> {
        let rolling = if self.before[2 * gap + 1] < 0.0 { -1.0 } else { 1.0 };
        let rough = self.laws[gap].friction_coefficient > 0.0;
        let all = [
            ImpactMode::Slides(rolling),
            ImpactMode::None,
            ImpactMode::Sticks,
            ImpactMode::Slides(-rolling),
        ];
        all.into_iter().take(if rough { 4 } else { 2 })
    }

    /// Adds all combinations that hold, of those that begin with `ways`, to `found`: one of each motion.
    fn search(
        &self,
        elimination: &mut ImpulseElimination<f64>,
        ways: &mut Vec<ImpactMode>,
        found: &mut Vec<(Vec<ImpactMode>, Pairs<f64>)>,
    ) {
        let gap = ways.len();
        if gap < self.laws.len() {
            for way in self.ways(gap) {
                elimination.eliminate(&self.laws, gap, way);
                ways.push(way);
                self.search(elimination, ways, found);
                ways.pop();
            }
            return;
        }
        let are_allowed = |gap, impulses| self.are_allowed(gap, ways[gap], impulses);
        let Some(impulses) = elimination.impulses(are_allowed) else { return };
        let after = self.after(&impulses);
        let mut gaps = ways.iter().zip(after.chunks(2)).enumerate();
        let holds = gaps.all(|(gap, (way, speeds))| self.follow(gap, *way, [speeds[0], speeds[1]]));
        let same = |(_, other): &(_, Pairs<f64>)| {
            let mut speeds = other.iter().zip(&after);
            let same = SAME * self.fastest + UNDECIDED * self.tolerance;
            speeds.all(|(left, right)| (left - right).abs() <= same)
        };
        if holds && !found.iter().any(same) {
            found.push((ways.clone(), after));
        }
    }

    /// Returns whether a contact impulse and a friction impulse meet the conditions of a way.
    fn are_allowed(&self, gap: usize, way: ImpactMode, [force, friction]: [f64; 2]) -> bool {
        // An impulse over the mass that it meets is a speed.
        let slack = self.tolerance * self.laws[gap].mass;
        let most = self.laws[gap].friction_coefficient * force + slack;
        let sticks = friction.abs() <= most.min(LARGEST * self.heaviest * self.fastest);
        (-slack..f64::INFINITY).contains(&force) && (sticks || !matches!(way, ImpactMode::Sticks))
    }

    /// Returns whether an opening speed and a rolling speed after the impact meet the conditions of a way.
    fn follow(&self, gap: usize, way: ImpactMode, [opening, rolling]: [f64; 2]) -> bool {
        let law = self.laws[gap];
        let rough = law.friction_coefficient > 0.0;
        match way {
            ImpactMode::None => opening + law.restitution * self.before[2 * gap] >= -self.tolerance,
            ImpactMode::Slides(direction) => {
                let least = -law.tangential_restitution * self.before[2 * gap + 1];
                !rough || direction * (rolling - least) >= -self.tolerance
            }
            ImpactMode::Sticks => true,
        }
    }
}

impl<T: Number> ImpactEquations<T> {
    /// Returns the opening speeds and the rolling speeds after impulses.
    fn after(&self, impulses: &[T]) -> Pairs<T> {
        let rows = self.before.iter().zip(self.answers.chunks(impulses.len()));
        rows.map(|(before, answers)| {
            answers.iter().zip(impulses).fold(*before, |sum, (by, impulse)| sum + *by * *impulse)
        })
        .collect()
    }
}

/// The equations of all gaps, whose impulses are eliminated one gap after the other.
struct ImpulseElimination<T> {
    /// For each gap, the equations of [`ImpactMode::Sticks`] of this gap and the gaps after it, without the impulses of
    /// the gaps before it. Each gap has two rows, that of the contact and that of the friction; a row consists of the
    /// coefficients of the impulses and the right side.
    remaining: SmallVec<[Vec<T>; 8]>,
    /// For each gap, its two equations in its way, divided by their diagonal entries, which are not replaced by ones.
    solved: SmallVec<[[SmallVec<[T; 17]>; 2]; 8]>,
}

impl<T: Number> ImpulseElimination<T> {
    fn new(meeting: &ImpactEquations<T>) -> Self {
        let size = meeting.before.len();
        let mut first = Vec::with_capacity(size * (size + 1));
        for (row, answers) in meeting.answers.chunks(size).enumerate() {
            let law = meeting.laws[row / 2];
            let (give, kept) = match row % 2 {
                0 => (0.0, law.restitution),
                _ => (GIVE, law.tangential_restitution),
            };
            first.extend_from_slice(answers);
            first[row * (size + 2)] = T::constant(1.0 + give) * answers[row];
            first.push(T::constant(-1.0 - kept) * meeting.before[row]);
        }
        let zero = |length: usize| smallvec![T::constant(0.0); length];
        let gaps = 0..meeting.laws.len();
        let rows = gaps.clone().map(|gap| size - 2 * gap);
        let mut remaining: SmallVec<[Vec<T>; 8]> =
            rows.map(|rows| vec![T::constant(0.0); rows * (rows + 1)]).collect();
        if let Some(all) = remaining.first_mut() {
            *all = first;
        }
        let solved = gaps.map(|gap| [zero(size - 2 * gap + 1), zero(size - 2 * gap + 1)]).collect();
        ImpulseElimination { remaining, solved }
    }

    /// Eliminates the impulses of a gap that takes part in a way from the equations of the gaps after it.
    fn eliminate(&mut self, laws: &[GapLaw], gap: usize, way: ImpactMode) {
        let (known, later) = self.remaining.split_at_mut(gap + 1);
        let known = &known[gap][..];
        let [contact, friction] = &mut self.solved[gap];
        let width = contact.len();
        // Subtracts a multiple of the equation of the impulse in a column.
        let subtract = |from: &mut [T], column: usize, equation: &[T]| {
            let factor = from[column];
            let rest = from[column + 1..].iter_mut().zip(&equation[column + 1..]);
            rest.for_each(|(entry, known)| *entry = *entry - factor * *known);
        };
        let scale = |equation: &mut [T], column: usize| {
            let inverse = equation[column].reciprocal();
            equation[column + 1..].iter_mut().for_each(|entry| *entry = inverse * *entry);
        };
        contact.fill(T::constant(0.0));
        friction.fill(T::constant(0.0));
        friction[1] = T::constant(1.0);
        if !matches!(way, ImpactMode::None) {
            contact.copy_from_slice(&known[..width]);
            scale(contact, 0);
            match way {
                ImpactMode::Slides(rolling) => {
                    friction[0] = T::constant(-rolling * laws[gap].friction_coefficient);
                }
                // Most bodies that stick do not slide afterwards.
                _ => friction.copy_from_slice(&known[width..2 * width]),
            }
            subtract(friction, 0, contact);
            scale(friction, 1);
        }
        let Some(later) = later.first_mut() else { return };
        let mut row: SmallVec<[T; 17]> = SmallVec::new();
        for (from, to) in known.chunks(width).skip(2).zip(later.chunks_mut(width - 2)) {
            if matches!(way, ImpactMode::None) {
                to.copy_from_slice(&from[2..]);
                continue;
            }
            row.clear();
            row.extend_from_slice(from);
            subtract(&mut row, 0, contact);
            subtract(&mut row, 1, friction);
            to.copy_from_slice(&row[2..]);
        }
    }

    /// Returns the impulses that solve the equations of all gaps; `None` if those of a gap are not allowed.
    fn impulses(&self, are_allowed: impl Fn(usize, [T; 2]) -> bool) -> Option<Pairs<T>> {
        let size = 2 * self.solved.len();
        let mut impulses: Pairs<T> = smallvec![T::constant(0.0); size];
        for (gap, [contact, friction]) in self.solved.iter().enumerate().rev() {
            let place = 2 * gap;
            let of = |equation: &[T], column: usize, impulses: &[T]| {
                let known = equation[column + 1..].iter().zip(&impulses[place + column + 1..]);
                let right = equation[equation.len() - 1];
                known.fold(right, |sum, (factor, known)| sum - *factor * *known)
            };
            impulses[place + 1] = of(friction, 1, &impulses);
            impulses[place] = of(contact, 0, &impulses);
            if !are_allowed(gap, [impulses[place], impulses[place + 1]]) {
                return None;
            }
        }
        Some(impulses)
    }
}
