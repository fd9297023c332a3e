//! Whether stick and slip are always decided in exactly one way, a question that the thesis leaves
//! open (section 4.3). For Coulomb friction and any number of balls the answer is a closed form.
//!
//! **The problem.** Without the table's acceleration, the equations of motion (`super::equations`)
//! say how the forces on ball `i` answer to the accelerations of all balls:
//!
//! ```text
//! f_w = q - A β̈     A_ij = (1 + 4J) δ_ij - m_j cos(β_i - β_j)
//! f_n = n + B β̈     B_ij = m_j sin(β_i - β_j)
//! ```
//!
//! A ball in the band has `f_w = p f_n` with `p = μ` where it accelerates forwards, `-μ` backwards,
//! and anything between where it sticks; a slipping ball has a fixed `p = ±μ`. Subtracting
//! two solutions with accelerations that differ by `d`, where one solution presses every ball to the
//! ring, gives `d_i (K d)_i = -d_i (p_i - p'_i) f_n,i ≤ 0` for every ball, with
//!
//! ```text
//! K(p) = A + diag(p) B     K_ij = (1 + 4J) δ_ij - m_j [cos(β_i - β_j) - p_i sin(β_i - β_j)]
//! ```
//!
//! A matrix for which that leaves only `d = 0` is a P-matrix: all its principal minors are positive
//! (Fiedler and Pták 1962; Cottle, Pang and Stone, *The Linear Complementarity Problem*, section
//! 3.3). So if `K(p)` is one for all `|p_i| ≤ μ_i`, there is at most one solution with all contacts
//! closed. Put `μ max(f_n, 0)` for the friction limit, and there is always exactly one: the same
//! difference argument holds, the map from accelerations to `q` (with the jump of friction made
//! steep instead) is continuous, one-to-one and grows without bound, hence onto. Either that
//! solution keeps all contacts closed, or none does and a contact opens. Subsets of the balls, the
//! others slipping or sticking, are Schur complements and principal submatrices of the same `K`:
//! one test covers all configurations. Drag does not change the answer: that of a slipping ball is
//! part of `q`, and a ball at rest has none.
//!
//! Conversely, where some `K(p)` is not a P-matrix there is a `d ≠ 0` with `d_i (K d)_i ≤ 0`. Then
//! `d⁺` and `d⁻` (in the directions of the corner `p`) both solve the problem for one and the same
//! pair of forces: the motion is not determined.
//!
//! **The minors.** Row `i` alone contains `p_i`, so every minor is linear in each `p_i` and least at
//! a corner `p_i = ±μ_i`. And `A - diag(1 + 4J)`, with `B`, has rank two, so that a minor of any size
//! is a 2×2 determinant. For a set `S` of balls, with `g = m / (1 + 4J)` and sums over `S`,
//!
//! ```text
//! det K_S / Π (1 + 4J) = ¼ (|2 - W|² - |Z|²)     W = Σ g (1 + i p)     Z = Σ g (1 + i p) e^{2iβ}
//! ```
//!
//! At the worst position all terms of `Z` point the same way, `2β_i + atan p_i` equal for all balls,
//! and `|Z| = Σ g sqrt(1 + μ²)`. So the decision always has exactly one solution if and only if
//!
//! ```text
//! (2 - Σ g)² + (Σ g p)² > (Σ g sqrt(1 + μ²))²     for all sets of balls and signs of p = ±μ.
//! ```
//!
//! `Σ g (1 + sqrt(1 + μ²)) < 2` over all balls is enough. As `Σ g < 1 / (1 + 4J) = 5/7`, no machine
//! at all with coefficients below `sqrt(56)/5 = 1.4966` ([`SAFE_FRICTION`]) can fail, nor can any
//! machine with one ball.

use super::{Balancer, Machine, SPHERE_INERTIA};

/// Largest friction coefficient with which no machine can fail: `sqrt(56) / 5`, rounded down.
pub const SAFE_FRICTION: f64 = 1.4966;

/// Minors up to this size count as zero, because of rounding.
const ZERO_MINOR: f64 = 1e-12;

/// Whether stick and slip are decided in exactly one way, at all positions and for all forces.
///
/// Principal minors are given over the product of their diagonal entries `1 + 4J - m`: 1 where balls
/// do not feel each other, 0 or less where the solution is not unique.
#[derive(Clone, Debug, PartialEq)]
pub enum ExistenceVerdict {
    /// Exactly one solution always, proven.
    Unique {
        /// The least principal minor over all positions and sets of balls.
        least_minor: f64,
    },
    /// At some positions there are forces with several solutions, or with none.
    NotUnique {
        /// The least principal minor over all positions and sets of balls.
        least_minor: f64,
        /// The worst position: the balls involved, numbered from 1, each with its angle, rad,
        /// relative to the first of them. Half a turn more for any of them is equally bad.
        position: Vec<(usize, f64)>,
    },
}

impl ExistenceVerdict {
    /// Returns the identifier that the tables use.
    pub fn word(&self) -> &'static str {
        match self {
            ExistenceVerdict::Unique { .. } => "unique",
            ExistenceVerdict::NotUnique { .. } => "not_unique",
        }
    }

    /// The least principal minor over all positions and sets of balls.
    pub fn least_minor(&self) -> f64 {
        match self {
            ExistenceVerdict::Unique { least_minor }
            | ExistenceVerdict::NotUnique { least_minor, .. } => *least_minor,
        }
    }
}

impl Machine {
    /// Returns whether stick and slip are always decided in exactly one way. The machine must be
    /// valid; all sets of balls are enumerated.
    pub fn existence(&self) -> ExistenceVerdict {
        verdict(&self.couplings(1.0))
    }

    /// Returns the largest common factor on the friction of all balls, at most 1, for which stick
    /// and slip are decided in exactly one way.
    pub fn unambiguous_friction_fraction(&self) -> f64 {
        let fine = |share: f64| {
            let (least_minor, _) = least_at_worst_position(&self.couplings(share));
            least_minor > ZERO_MINOR
        };
        if fine(1.0) {
            return 1.0;
        }
        // More friction never helps, because (Σ g p)² grows more slowly with it than the square on
        // the other side.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if fine(middle) { low = middle } else { high = middle }
        }
        low
    }

    fn couplings(&self, friction_share: f64) -> Vec<Coupling> {
        let whole = self.total_mass_kg() * (1.0 + 4.0 * SPHERE_INERTIA);
        let coupling = |ball: &super::Ball| Coupling {
            mass: ball.mass_kg / whole,
            friction: friction_share * self.friction.largest_ratio(ball.friction_coefficient),
        };
        self.balls.iter().map(coupling).collect()
    }
}

impl<const N: usize> Balancer<N> {
    /// Returns whether the simple bound `Σ g (1 + sqrt(1 + μ²)) < 2` proves that there is always
    /// exactly one solution, at negligible cost.
    #[inline]
    pub fn surely_one_solution(&self) -> bool {
        let part = |c: Coupling| c.mass * (1.0 + (1.0 + c.friction * c.friction).sqrt());
        self.couplings().into_iter().map(part).sum::<f64>() < 2.0 - ZERO_MINOR
    }

    /// Returns the least principal minor with the balls at the angles `beta`; if it is positive,
    /// stick and slip are decided in exactly one way there, for any forces. NaN if an angle is NaN.
    pub fn least_minor_at(&self, beta: &[f64; N]) -> f64 {
        let couplings = self.couplings();
        let doubled = beta.map(|angle| libm::sincos(2.0 * angle));
        let turned = |ball: usize, p: f64| {
            let (s, c) = doubled[ball];
            [c - p * s, s + p * c]
        };
        least_minor(&couplings, turned).0
    }

    /// Returns whether stick and slip are decided in exactly one way with the balls at `beta`.
    pub fn one_solution_at(&self, beta: &[f64; N]) -> bool {
        self.least_minor_at(beta) > ZERO_MINOR
    }

    fn couplings(&self) -> [Coupling; N] {
        self.balls.map(|ball| Coupling {
            mass: ball.mass * ball.mobility,
            friction: ball.friction.largest_ratio(),
        })
    }
}

/// The contribution of one ball to the minors.
#[derive(Clone, Copy, Debug)]
struct Coupling {
    /// `g = m / (1 + 4J)`.
    mass: f64,
    /// `μ`.
    friction: f64,
}

fn verdict(couplings: &[Coupling]) -> ExistenceVerdict {
    let (least_minor, combination) = least_at_worst_position(couplings);
    if least_minor > ZERO_MINOR {
        return ExistenceVerdict::Unique { least_minor };
    }
    // 2β + atan p is the same for all balls.
    let angle = |(ball, direction): (usize, f64)| {
        (ball + 1, -0.5 * libm::atan(direction * couplings[ball].friction))
    };
    let mut position: Vec<(usize, f64)> = chosen(combination, couplings.len()).map(angle).collect();
    let first = position.first().map_or(0.0, |(_, angle)| *angle);
    for (_, angle) in &mut position {
        *angle -= first;
    }
    ExistenceVerdict::NotUnique { least_minor, position }
}

fn least_at_worst_position(couplings: &[Coupling]) -> (f64, usize) {
    least_minor(couplings, |_, p| [(1.0 + p * p).sqrt(), 0.0])
}

/// Returns the least minor over all sets of balls and corners, and the index of its combination.
/// `turned` returns `(1 + ip) e^{2iβ}` of a ball, from its index and its `p`.
fn least_minor(couplings: &[Coupling], turned: impl Fn(usize, f64) -> [f64; 2]) -> (f64, usize) {
    let mut least = (1.0, 0); // the minor of any single ball
    for combination in 1..3_usize.pow(couplings.len() as u32) {
        let (mut g, mut w, mut z, mut diagonal) = (0.0, 0.0, [0.0; 2], 1.0);
        for (ball, direction) in chosen(combination, couplings.len()) {
            let Coupling { mass, friction } = couplings[ball];
            let p = direction * friction;
            let [re, im] = turned(ball, p);
            g += mass;
            w += mass * p;
            z = [z[0] + mass * re, z[1] + mass * im];
            diagonal *= 1.0 - mass;
        }
        let square = (2.0 - g) * (2.0 - g) + w * w - (z[0] * z[0] + z[1] * z[1]);
        let minor = 0.25 * square / diagonal;
        if minor.is_nan() {
            return (minor, combination);
        }
        if minor < least.0 {
            least = (minor, combination);
        }
    }
    least
}

/// Returns the balls of a combination, each with the sign of its `p`: the combination's ternary
/// digits.
fn chosen(combination: usize, balls: usize) -> impl Iterator<Item = (usize, f64)> {
    let digits = (0..balls).scan(combination, |rest, ball| {
        let digit = *rest % 3;
        *rest /= 3;
        Some((ball, digit))
    });
    digits.filter(|(_, digit)| *digit > 0).map(|(ball, digit)| (ball, [0.0, 1.0, -1.0][digit]))
}
