//! The impulses of an impact: Newton's law of restitution and Coulomb's law of friction in several gaps at once. A contact that
//! opens is a gap here, too.
//!
//! The unknowns are a contact impulse `P` and a friction impulse `Q` in each gap. A gap takes part in one of four ways, and
//! each way gives two linear equations. All combinations of ways are tried; a combination holds if the impulses, and the
//! speeds after them, meet the conditions of each way. The equations of a gap are eliminated once for all ways of the
//! gaps after it.

use smallvec::{SmallVec, smallvec};

use super::Failure;
use crate::model::{Dual, Number};

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

/// The coefficients of all impulses, and the right side.
type Equation<T> = SmallVec<[T; 17]>;

/// How a gap takes part in an impact.
#[derive(Clone, Copy, Debug)]
enum Way {
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
pub(super) struct Meeting<T = Dual> {
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
pub(super) struct Impulses {
    pub(super) impulses: Pairs<Dual>,
    pub(super) after: Pairs<Dual>,
}

impl Meeting {
    /// Returns the impulses that obey both laws.
    ///
    /// # Errors
    /// [`Failure::UndecidedImpact`] unless all combinations that hold lead to the same speeds, and
    /// [`Failure::TooManyCombinations`] for so many gaps that they cannot be tried.
    pub(super) fn impulses(&self) -> Result<Impulses, Failure> {
        let values = Meeting {
            laws: self.laws.clone(),
            before: self.before.iter().map(|speed| speed.value).collect(),
            answers: self.answers.iter().map(|answer| answer.value).collect(),
            fastest: self.fastest,
            heaviest: self.heaviest,
            tolerance: self.tolerance,
        };
        let number = (0..self.laws.len()).map(|gap| values.ways(gap).count());
        if number.fold(1, usize::saturating_mul) > MOST_TRIED {
            return Err(Failure::TooManyCombinations);
        }
        let mut found = Vec::new();
        values.search(&mut Vec::new(), &mut Vec::new(), &mut found);
        let [(ways, _)] = &found[..] else {
            return Err(Failure::UndecidedImpact { solutions: found.len() });
        };
        let mut equations = Vec::new();
        for (gap, way) in ways.iter().enumerate() {
            self.add_equations(&mut equations, gap, *way);
        }
        let impulses = self.solved(&equations, |_, _| true).ok_or(Failure::NotFinite)?;
        Ok(Impulses { after: self.after(&impulses), impulses })
    }
}

impl Meeting<f64> {
    /// Returns the ways in which a gap may take part: first that in which the bodies slide as before.
    fn ways(&self, gap: usize) -> impl Iterator<Item = Way> + use<> {
        let rolling = if self.before[2 * gap + 1] < 0.0 { -1.0 } else { 1.0 };
        let rough = self.laws[gap].friction_coefficient > 0.0;
        let all = [Way::Slides(rolling), Way::None, Way::Sticks, Way::Slides(-rolling)];
        all.into_iter().take(if rough { 4 } else { 2 })
    }

    /// Adds all combinations that hold, of those that begin with `ways`, to `found`: one of each motion.
    fn search(
        &self,
        ways: &mut Vec<Way>,
        equations: &mut Vec<Equation<f64>>,
        found: &mut Vec<(Vec<Way>, Pairs<f64>)>,
    ) {
        let gap = ways.len();
        if gap < self.laws.len() {
            for way in self.ways(gap) {
                self.add_equations(equations, gap, way);
                ways.push(way);
                self.search(ways, equations, found);
                ways.pop();
                equations.truncate(2 * gap);
            }
            return;
        }
        let are_allowed = |gap, impulses| self.are_allowed(gap, ways[gap], impulses);
        let Some(impulses) = self.solved(equations, are_allowed) else { return };
        let after = self.after(&impulses);
        let mut gaps = ways.iter().zip(after.chunks(2)).enumerate();
        let holds = gaps.all(|(gap, (way, speeds))| self.follow(gap, *way, [speeds[0], speeds[1]]));
        let same = |(_, other): &(_, Pairs<f64>)| {
            let mut speeds = other.iter().zip(&after);
            let same = SAME * self.fastest + UNDECIDED * self.tolerance;
            speeds.all(|(one, other)| (one - other).abs() <= same)
        };
        if holds && !found.iter().any(same) {
            found.push((ways.clone(), after));
        }
    }

    /// Returns whether a contact impulse and a friction impulse meet the conditions of a way.
    fn are_allowed(&self, gap: usize, way: Way, [force, friction]: [f64; 2]) -> bool {
        // An impulse over the mass that it meets is a speed.
        let slack = self.tolerance * self.laws[gap].mass;
        let most = self.laws[gap].friction_coefficient * force + slack;
        let sticks = friction.abs() <= most.min(LARGEST * self.heaviest * self.fastest);
        (-slack..f64::INFINITY).contains(&force) && (sticks || !matches!(way, Way::Sticks))
    }

    /// Returns whether an opening speed and a rolling speed after the impact meet the conditions of a way.
    fn follow(&self, gap: usize, way: Way, [opening, rolling]: [f64; 2]) -> bool {
        let law = self.laws[gap];
        let rough = law.friction_coefficient > 0.0;
        match way {
            Way::None => opening + law.restitution * self.before[2 * gap] >= -self.tolerance,
            Way::Slides(direction) => {
                let least = -law.tangential_restitution * self.before[2 * gap + 1];
                !rough || direction * (rolling - least) >= -self.tolerance
            }
            Way::Sticks => true,
        }
    }
}

impl<T: Number> Meeting<T> {
    /// Adds both equations of a gap that takes part in a way to those of the gaps before it, in triangular form with ones on
    /// the diagonal.
    fn add_equations(&self, equations: &mut Vec<Equation<T>>, gap: usize, way: Way) {
        let size = self.before.len();
        for row in [2 * gap, 2 * gap + 1] {
            let mut equation: Equation<T> = smallvec![T::constant(0.0); size + 1];
            let is_friction = row % 2 == 1;
            // The first impulse in the equation.
            let first = match way {
                Way::None => {
                    equation[row] = T::constant(1.0);
                    row
                }
                Way::Slides(rolling) if is_friction => {
                    let share = rolling * self.laws[gap].friction_coefficient;
                    equation[row - 1] = T::constant(-share);
                    equation[row] = T::constant(1.0);
                    row - 1
                }
                // Both speeds are given by the law of impact; most bodies that stick do not slide afterwards.
                Way::Slides(_) | Way::Sticks => {
                    equation[..size].copy_from_slice(&self.answers[row * size..][..size]);
                    let law = self.laws[gap];
                    let (give, kept) = match is_friction {
                        true => (GIVE, law.tangential_restitution),
                        false => (0.0, law.restitution),
                    };
                    equation[row] = T::constant(1.0 + give) * equation[row];
                    equation[size] = T::constant(-1.0 - kept) * self.before[row];
                    0
                }
            };
            for (column, known) in equations.iter().enumerate().skip(first) {
                let factor = equation[column];
                for (own, known) in equation[column + 1..].iter_mut().zip(&known[column + 1..]) {
                    *own = *own - factor * *known;
                }
            }
            let inverse = equation[row].reciprocal();
            equation[row + 1..].iter_mut().for_each(|own| *own = inverse * *own);
            equations.push(equation);
        }
    }

    /// Returns the impulses that solve the equations of all gaps; `None` if those of a gap are not allowed.
    fn solved(
        &self,
        equations: &[Equation<T>],
        are_allowed: impl Fn(usize, [T; 2]) -> bool,
    ) -> Option<Pairs<T>> {
        let size = self.before.len();
        let mut impulses: Pairs<T> = smallvec![T::constant(0.0); size];
        for (row, equation) in equations.iter().enumerate().rev() {
            let known = equation[row + 1..size].iter().zip(&impulses[row + 1..]);
            impulses[row] = known.fold(equation[size], |sum, (own, known)| sum - *own * *known);
            if row % 2 == 0 && !are_allowed(row / 2, [impulses[row], impulses[row + 1]]) {
                return None;
            }
        }
        Some(impulses)
    }

    /// Returns the opening speeds and the rolling speeds after impulses.
    fn after(&self, impulses: &[T]) -> Pairs<T> {
        let rows = self.before.iter().zip(self.answers.chunks(impulses.len()));
        rows.map(|(before, answers)| {
            answers.iter().zip(impulses).fold(*before, |sum, (by, one)| sum + *by * *one)
        })
        .collect()
    }
}
