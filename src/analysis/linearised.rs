//! Linearised motion about a position without dry friction, with viscous drag on the balls.
//!
//! The equations of motion with `f_w = C β̇` (over `m ω_n² L`; thesis equation 5.1), linearised
//! about balls at rest at `β` (thesis equation 5.2), are `M q̈ + D q̇ + K q = 0` for small `q = (x,
//! y, β_1, ..., β_N)`. With `s = sin β`, `c = cos β`, `p = x_0 c + y_0 s` (`z_0` that of the ring's centre) and the balls' equations
//! multiplied by their mass,
//!
//! ```text
//! M = [ 1     0     -m s      ]   D = [ 2ζ      -2ω     -2ω m c ]   K = [ 1-ω²    -2ζω     ω² m s ]
//!     [ 0     1      m c      ]       [ 2ω       2ζ     -2ω m s ]       [ 2ζω     1-ω²    -ω² m c ]
//!     [ -m s  m c    m (1+4J) ]       [ 2ω m c  2ω m s   m C    ]       [ ω² m s  -ω² m c  ω² m p ]
//! ```
//!
//! with one row and one column for each ball and the last block diagonal. Balls that touch move together: the angles of a
//! row of such balls are one coordinate, and its row and column are the sums of those of its balls. The forces between the
//! balls do no work.

use nalgebra::{Complex, DMatrix, Schur};
use serde::Serialize;

use super::balance::balances;
use super::rest_form::{RestForm, direction};
use crate::named::named;

/// Stability of an equilibrium against small disturbances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stability {
    /// All disturbances decay, except those along a family of equilibria, which persist.
    Stable,
    /// A disturbance grows.
    Unstable,
    /// No disturbance grows, but one neither grows nor decays; the linearised equations do not
    /// decide the stability.
    Marginal,
    /// The eigenvalues could not be computed.
    Unknown,
}

named!(Stability {
    Stable: "stable",
    Unstable: "unstable",
    Marginal: "marginal",
    Unknown: "unknown",
});

/// Eigenvalues of the linearised equations of motion.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallMotions {
    /// All eigenvalues, non-dimensional (times `ω_n`: 1/s), the fastest growing first: of the balancer `2 (2 + N)`, fewer where balls
    /// touch. Empty if they could not be computed.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Stability according to the eigenvalues, without those along a family.
    pub stability: Stability,
}

/// Real parts below this fraction of the matrix norm count as rounding errors.
const ZERO_REAL_PART: f64 = 1e-14;
/// Maximum number of iterations per eigenvalue; about ten are usual.
const ITERATIONS: usize = 200;

/// Returns the matrix `A` of `d/dt (q, q̇) = A (q, q̇)` for small `q = (x, y, β_1, ...)` about
/// balls at rest at `beta` (one angle per ball), non-dimensional, with the viscous drag `C = drag`
/// on each ball; balls that touch have one angle together. `None` if the table has no rest point.
pub fn state_matrix(form: &RestForm, beta: &[f64], drag: f64) -> Option<DMatrix<f64>> {
    let n = 2 + beta.len();
    let (omega, zeta) = (form.speed, form.damping_ratio);
    let omega_squared = omega * omega;
    let z = ring_centre(form, beta)?;
    let mut mass = DMatrix::<f64>::identity(n, n);
    let mut damping = DMatrix::<f64>::zeros(n, n);
    let mut stiffness = DMatrix::<f64>::zeros(n, n);
    for axis in 0..2 {
        damping[(axis, axis)] = 2.0 * zeta;
        stiffness[(axis, axis)] = 1.0 - omega_squared;
    }
    damping[(0, 1)] = -2.0 * omega;
    damping[(1, 0)] = 2.0 * omega;
    stiffness[(0, 1)] = -2.0 * zeta * omega;
    stiffness[(1, 0)] = 2.0 * zeta * omega;
    for (ball, &beta) in beta.iter().enumerate() {
        let (i, m, e) = (2 + ball, form.mass[ball], direction(beta));
        for (axis, across, along) in [(0, e.im, e.re), (1, -e.re, e.im)] {
            mass[(axis, i)] = -m * across;
            mass[(i, axis)] = -m * across;
            damping[(axis, i)] = -2.0 * omega * m * along;
            damping[(i, axis)] = 2.0 * omega * m * along;
            stiffness[(axis, i)] = omega_squared * m * across;
            stiffness[(i, axis)] = omega_squared * m * across;
        }
        mass[(i, i)] = m * form.inertia[ball];
        damping[(i, i)] = m * drag;
        stiffness[(i, i)] = omega_squared * m * (z.re * e.re + z.im * e.im);
    }
    let together = coordinates(form, beta);
    let [mass, damping, stiffness] =
        [mass, damping, stiffness].map(|of_balls| together.transpose() * of_balls * &together);
    let n = together.ncols();
    let factors = mass.lu();
    let mut matrix = DMatrix::<f64>::zeros(2 * n, 2 * n);
    matrix.view_mut((0, n), (n, n)).fill_with_identity();
    matrix.view_mut((n, 0), (n, n)).copy_from(&-factors.solve(&stiffness)?);
    matrix.view_mut((n, n), (n, n)).copy_from(&-factors.solve(&damping)?);
    Some(matrix)
}

/// Returns the matrix with a column for the change of all variables with each coordinate.
fn coordinates(form: &RestForm, beta: &[f64]) -> DMatrix<f64> {
    let leader = form.leaders(beta);
    let leaders: Vec<usize> = (0..beta.len()).filter(|ball| leader[*ball] == *ball).collect();
    let mut matrix = DMatrix::zeros(2 + beta.len(), 2 + leaders.len());
    matrix.view_mut((0, 0), (2, 2)).fill_with_identity();
    for (column, lead) in leaders.iter().enumerate() {
        let led = (0..beta.len()).filter(|ball| leader[*ball] == *lead);
        led.for_each(|ball| matrix[(2 + ball, 2 + column)] = 1.0);
    }
    matrix
}

/// Returns where the ring's centre rests, which is 0 if the balls balance the imbalance, even at resonance.
fn ring_centre(form: &RestForm, beta: &[f64]) -> Option<Complex<f64>> {
    let z = form.ring_centre(beta);
    if z.is_finite() {
        return Some(z);
    }
    balances(form, beta).then(|| Complex::from(0.0))
}

impl SmallMotions {
    /// Computes the linearised motion about balls at rest at `beta`, a position of a family of
    /// `family_dimension` dimensions (0: isolated), with the viscous drag `drag` on each ball.
    pub fn about(form: &RestForm, beta: &[f64], drag: f64, family_dimension: usize) -> Self {
        match state_matrix(form, beta, drag) {
            Some(matrix) => {
                let rounding = ZERO_REAL_PART * (1.0 + matrix.norm());
                SmallMotions::of(&matrix, rounding, family_dimension)
            }
            None => SmallMotions { eigenvalues: Vec::new(), stability: Stability::Unknown },
        }
    }

    /// Computes the motions `d/dt x = A x` of a matrix `A` whose eigenvalues along a family of equilibria vanish; real parts up to
    /// `rounding` count as zero.
    pub(crate) fn of(matrix: &DMatrix<f64>, rounding: f64, family_dimension: usize) -> Self {
        let unknown = SmallMotions { eigenvalues: Vec::new(), stability: Stability::Unknown };
        if matrix.iter().any(|entry| !entry.is_finite()) {
            return unknown;
        }
        let iterations = ITERATIONS * matrix.nrows();
        // Coinciding eigenvalues, as of many identical balls, may need a larger tolerance to
        // converge.
        let mut tolerances = [1.0, 16.0, 256.0].map(|factor| factor * f64::EPSILON).into_iter();
        let schur =
            tolerances.find_map(|tolerance| Schur::try_new(matrix.clone(), tolerance, iterations));
        let Some(schur) = schur else { return unknown };
        let mut eigenvalues: Vec<Complex<f64>> =
            schur.complex_eigenvalues().iter().copied().collect();
        // The eigenvalues along the family are zero up to rounding: the smallest ones.
        eigenvalues.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let across = eigenvalues.iter().skip(family_dimension).map(|value| value.re);
        let largest = across.fold(f64::NEG_INFINITY, f64::max);
        let stability = if largest > rounding {
            Stability::Unstable
        } else if largest < -rounding {
            Stability::Stable
        } else {
            Stability::Marginal
        };
        eigenvalues.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        SmallMotions { eigenvalues, stability }
    }
}
