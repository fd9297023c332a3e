//! The affine motion of a system while all its contacts stick.
//!
//! The free components `z` of the state obey `ż = A (z - z_0)` with constant coefficients. If all eigenvalues of `A` lie left
//! of the imaginary axis, Lyapunov's equation `Aᵀ P + P A = -1` has a positive definite solution (H. K. Khalil, *Nonlinear
//! Systems*, 3rd ed., Prentice Hall 2002, theorem 4.6), and the distance `R = sqrt((z - z_0)ᵀ P (z - z_0))` from the rest point
//! `z_0` never grows. A force `f_0 + c (z - z_0)` then differs from that at rest by at most `R sqrt(c P⁻¹ cᵀ)`, for all later
//! times. If friction holds all contacts against these differences, the run has certainly ended in equilibrium. If the bound
//! is too coarse, the motion is followed until the bound suffices.
//!
//! If the equations are not affine, `A` is their derivative at the rest point, and differs from that elsewhere by at most `Δ`
//! within the distance `R`. The distance then still falls if `|| |P| Δ || < 1/2`, because
//! `d/dt zᵀ P z <= -(1 - 2 || |P| Δ ||) zᵀ z`.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use smallvec::SmallVec;

use crate::model::{Gap, HeldContact, held};

/// The motion is followed in steps of this fraction of the time in which it changes.
const FOLLOWED: f64 = 0.02;
/// The most steps in which a motion is followed.
const MOST_FOLLOWED: usize = 1_000_000;
/// The affine motion for one set of positions of the contacts.
#[derive(Debug)]
pub(super) struct StuckMotion {
    /// The matrix `A`.
    pub(super) matrix: DMatrix<f64>,
    /// The rest point.
    pub(super) rest: DVector<f64>,
    pub(super) distance: Distance,
    pub(super) contacts: Vec<StuckContact>,
    /// The amplitude of the vibration at rest.
    pub(super) amplitude: f64,
}

/// By how much derivatives in a region around the rest point differ at most from those at the rest point.
pub(super) struct Curvature {
    /// Those of the rates of the free components, row by row.
    pub(super) rates: DMatrix<f64>,
    /// Those of the friction and the normal force of each contact.
    pub(super) forces: Vec<[DVector<f64>; 2]>,
}

/// The distance from the rest point that never grows; 0 without free components.
#[derive(Debug)]
pub(super) struct Distance(Option<Cholesky<f64, Dyn>>);

/// The forces of a contact that sticks.
#[derive(Debug)]
pub(super) struct StuckContact {
    pub(super) friction: AffineForce,
    pub(super) normal: AffineForce,
    /// The static coefficient of friction.
    pub(super) limit: f64,
}

/// A force that is affine in the free components.
#[derive(Debug)]
pub(super) struct AffineForce {
    at_rest: f64,
    gradient: DVector<f64>,
    /// The most by which it differs from that at rest, over the distance from the rest point.
    most: f64,
    /// The most by which its rate of change differs from zero, over the distance.
    most_rate: f64,
}

impl Distance {
    /// Returns the distance for a motion with this matrix; `None` if the motion is not damped.
    pub(super) fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        if matrix.is_empty() {
            return Some(Distance(None));
        }
        Some(Distance(Some(Cholesky::new(lyapunov_solution(matrix)?)?)))
    }

    /// Returns the distance of a displacement from the rest point.
    pub(super) fn size(&self, displacement: &DVector<f64>) -> f64 {
        self.0.as_ref().map_or(0.0, |form| form.l().tr_mul(displacement).norm())
    }

    /// Returns the most by which each component differs from that at the rest point, over the distance.
    pub(super) fn components(&self, number: usize) -> DVector<f64> {
        let unit = |place| DVector::from_fn(number, |i, _| if i == place { 1.0 } else { 0.0 });
        DVector::from_fn(number, |place, _| self.most(&unit(place)))
    }

    /// Returns whether the distance falls where the derivative of the rates differs from that at the rest point by at most these
    /// numbers.
    fn falls(&self, differences: &DMatrix<f64>) -> bool {
        // `P = L Lᵀ`
        let form = self.0.as_ref().map(|form| form.l() * form.l().transpose());
        form.is_none_or(|form| (form.abs() * differences).norm() < 0.5)
    }

    /// Returns the largest value of a linear form over the distance.
    fn most(&self, row: &DVector<f64>) -> f64 {
        let square = self.0.as_ref().map_or(0.0, |form| row.dot(&form.solve(row)));
        square.max(0.0).sqrt()
    }
}

impl AffineForce {
    /// Creates the force with this value at rest and this gradient.
    pub(super) fn new(
        at_rest: f64,
        gradient: DVector<f64>,
        matrix: &DMatrix<f64>,
        distance: &Distance,
    ) -> Self {
        let rate = if matrix.is_empty() { gradient.clone() } else { matrix.tr_mul(&gradient) };
        let [most, most_rate] = [&gradient, &rate].map(|row| distance.most(row));
        AffineForce { at_rest, gradient, most, most_rate }
    }

    pub(super) fn at_rest(&self) -> f64 {
        self.at_rest
    }

    /// Returns a component of the gradient.
    pub(super) fn gradient(&self, component: usize) -> f64 {
        self.gradient[component]
    }
}

impl StuckMotion {
    /// Returns the contacts with coefficients of friction that are multiplied by `strength`; `at` returns each force.
    pub(super) fn held_contacts(
        &self,
        strength: f64,
        at: impl Fn(&AffineForce) -> f64,
    ) -> SmallVec<[HeldContact; 8]> {
        let contact = |contact: &StuckContact| HeldContact {
            normal: at(&contact.normal),
            friction: at(&contact.friction),
            limit: strength * contact.limit,
            weight: 1.0,
        };
        self.contacts.iter().map(contact).collect()
    }

    /// Returns whether friction holds all contacts if the motion is at most at a distance from the rest point.
    pub(super) fn holds_all_contacts(
        &self,
        gaps: &[Gap],
        strength: f64,
        distance: f64,
        residual: &[[f64; 2]],
    ) -> bool {
        let mut contacts = self.held_contacts(strength, |force| force.at_rest);
        for ((held, contact), residual) in contacts.iter_mut().zip(&self.contacts).zip(residual) {
            let most = [contact.friction.most, contact.normal.most].map(|most| most * distance);
            widen(held, most, *residual);
        }
        held(&contacts, gaps).reserve >= 0.0
    }

    /// Returns whether the motion certainly approaches the rest point from this distance, and friction holds all contacts on its
    /// way, if the derivatives within the distance differ from those at the rest point by at most these numbers.
    pub(super) fn contracts(
        &self,
        gaps: &[Gap],
        strength: f64,
        distance: f64,
        residual: &[[f64; 2]],
        curvature: &Curvature,
    ) -> bool {
        let components = self.distance.components(self.rest.len());
        let bent = curvature.forces.iter().zip(residual).map(|(forces, residual)| {
            let of = |which: usize| residual[which] + distance * forces[which].dot(&components);
            [of(0), of(1)]
        });
        let bent: SmallVec<[[f64; 2]; 8]> = bent.collect();
        self.distance.falls(&curvature.rates)
            && self.holds_all_contacts(gaps, strength, distance, &bent)
    }

    /// Follows the motion until friction certainly holds all contacts. `false` means that a contact breaks loose, or that the
    /// margin is too small for a decision. Between the instants of the steps, forces are bounded by their rates of change.
    pub(super) fn followed_to_rest(
        &self,
        gaps: &[Gap],
        mut displaced: DVector<f64>,
        push: f64,
        residual: &[[f64; 2]],
    ) -> bool {
        let interval = FOLLOWED / (1.0 + self.matrix.norm());
        let step = (&self.matrix * interval).exp();
        for _ in 0..MOST_FOLLOWED {
            let distance = self.distance.size(&displaced) + push;
            if self.holds_all_contacts(gaps, 1.0, distance, residual) {
                return true;
            }
            let mut contacts =
                self.held_contacts(1.0, |force| force.at_rest + force.gradient.dot(&displaced));
            for ((held, contact), residual) in contacts.iter_mut().zip(&self.contacts).zip(residual)
            {
                let unseen =
                    |force: &AffineForce| force.most_rate * distance * interval + force.most * push;
                widen(held, [unseen(&contact.friction), unseen(&contact.normal)], *residual);
            }
            if held(&contacts, gaps).reserve < 0.0 {
                return false;
            }
            displaced = &step * displaced;
        }
        false
    }
}

/// Takes into account that the friction force and the normal force of a contact may differ by numbers.
fn widen(contact: &mut HeldContact, differences: [f64; 2], others: [f64; 2]) {
    let [friction, normal] = [0, 1].map(|force| differences[force] + others[force]);
    contact.friction += friction.copysign(contact.friction);
    contact.normal -= normal;
}

/// Returns the solution `P` of `Aᵀ P + P A = -1`; `None` if there is not exactly one.
fn lyapunov_solution(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let identity = DMatrix::<f64>::identity(n, n);
    let transposed = matrix.transpose();
    let equations = identity.kronecker(&transposed) + transposed.kronecker(&identity);
    let right = DVector::from_iterator(n * n, identity.iter().map(|entry| -entry));
    let solution = DMatrix::from_column_slice(n, n, equations.lu().solve(&right)?.as_slice());
    Some((&solution + solution.transpose()) * 0.5)
}
