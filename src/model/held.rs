//! Whether friction holds contacts that touch each other.
//!
//! The forces between bodies that rest and touch are not determined. The bodies rest if there are any forces with which
//! all conditions hold: in each gap `λ ≥ 0` and `|q| ≤ μ_b λ`, and at each contact `|T + t| ≤ μ (f + n)` with the
//! tangential and normal forces `t` and `n` from the gaps. The forces with the largest reserve of friction solve a linear
//! programme. It has few variables, and its result must be accurate to rounding; hence it is solved here, by the
//! simplex method with Bland's rule (V. Chvátal, *Linear Programming*, Freeman 1983, chapter 3).

use smallvec::SmallVec;

use super::Gap;

/// A contact that sticks, with its forces without those from gaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldContact {
    /// Normal force, compression positive.
    pub normal: f64,
    /// The friction force that it needs to stick.
    pub friction: f64,
    /// The static coefficient of friction.
    pub limit: f64,
    /// How much of the contact's reserve one unit of the common reserve takes: 1, or `1 + μ` for the disturbance that both
    /// forces of a contact may have.
    pub weight: f64,
}

/// The forces that hold contacts with the largest common reserve.
#[derive(Clone, Debug, PartialEq)]
pub struct Holding {
    /// The reserve: the smallest `(μ (f + n) - |T + t|) / weight` of a contact. The contacts rest if it is not negative.
    pub reserve: f64,
    /// For each gap, `λ` of full friction in either rolling direction, over the reduced mass: their sum is the contact
    /// force, and their difference times `μ_b` is the friction.
    pub forces: SmallVec<[[f64; 2]; 2]>,
}

/// Returns the forces with the largest reserve in gaps that are closed. The gaps count the contacts of the list.
pub fn held(contacts: &[HeldContact], gaps: &[Gap]) -> Holding {
    held_by_at_most(f64::INFINITY, contacts, gaps)
}

/// Accuracy of the least force, over the force.
const FORCE_ACCURACY: f64 = 1e-9;
/// The largest ratio of a least force to the friction that contacts need.
const MOST_FORCE: f64 = 1e9;

/// Returns the force `λ` in the gap with the largest one, for forces that hold the contacts and have the smallest such
/// force; `None` if no forces hold them.
pub fn least_force(contacts: &[HeldContact], gaps: &[Gap]) -> Option<f64> {
    let holds = |most: f64| held_by_at_most(most, contacts, gaps).reserve >= 0.0;
    let needed = contacts.iter().map(|contact| contact.friction.abs()).sum::<f64>();
    let scale = needed * gaps.iter().map(Gap::reduced_mass).fold(0.0, f64::max);
    smallest(scale, MOST_FORCE * scale, FORCE_ACCURACY, holds)
}

/// Accuracy of the strength of friction that holds contacts.
const STRENGTH_ACCURACY: f64 = 1e-12;
/// The largest factor on the coefficients of friction that is sought.
pub const MOST_STRENGTH: f64 = 1e6;

/// Returns the smallest common factor on the coefficients of friction with which friction holds contacts, for some forces
/// in gaps that are closed; infinite if none does.
pub fn strength_that_holds(contacts: &[HeldContact], gaps: &[Gap]) -> f64 {
    if gaps.is_empty() {
        let needed = |contact: &HeldContact| match contact.limit * contact.normal {
            _ if contact.friction == 0.0 => 0.0,
            limit if limit > 0.0 => contact.friction.abs() / limit,
            _ => f64::INFINITY,
        };
        return contacts.iter().map(needed).fold(0.0, f64::max);
    }
    let holds = |strength: f64| {
        let weaker = |held: &HeldContact| HeldContact { limit: strength * held.limit, ..*held };
        let contacts: SmallVec<[HeldContact; 8]> = contacts.iter().map(weaker).collect();
        held(&contacts, gaps).reserve >= 0.0
    };
    least_strength(MOST_STRENGTH, holds).unwrap_or(f64::INFINITY)
}

/// Returns the smallest factor on the coefficients of friction with which contacts hold, up to `most`; `None` if they do not hold
/// with this one.
pub fn least_strength(most: f64, holds: impl Fn(f64) -> bool) -> Option<f64> {
    smallest(1.0, most, STRENGTH_ACCURACY, holds)
}

/// Returns the smallest number with which something holds, to an accuracy over the number; `None` if it does not hold with `most`.
/// Unless it holds with 0, the search begins at `first`.
fn smallest(first: f64, most: f64, accuracy: f64, holds: impl Fn(f64) -> bool) -> Option<f64> {
    if holds(0.0) {
        return Some(0.0);
    }
    let (mut low, mut high) = (0.0, first);
    while !holds(high) {
        (low, high) = (high, 2.0 * high);
        if high.is_nan() || high > most {
            return None;
        }
    }
    while high - low > accuracy * high {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        (low, high) = if holds(middle) { (low, middle) } else { (middle, high) };
    }
    Some(high)
}

/// Returns the largest number `r` of at most `most` with `a · z + r ≤ b` for all rows `(a, b)` and some numbers `z`.
pub fn largest_reserve(rows: &[(Vec<f64>, f64)], most: f64) -> f64 {
    let least = rows.iter().map(|(_, bound)| *bound).fold(most, f64::min);
    let count = rows.first().map_or(0, |(coefficients, _)| coefficients.len());
    // Each number is the difference of two that are not negative. The last variable is the reserve above the least bound.
    let entries = rows.iter().flat_map(|(coefficients, bound)| {
        let both = coefficients.iter().flat_map(|coefficient| [*coefficient, -coefficient]);
        both.chain([1.0, bound - least])
    });
    let limit = std::iter::repeat_n(0.0, 2 * count).chain([1.0, most - least]);
    let table =
        SimplexTableau { variables: 2 * count + 1, entries: entries.chain(limit).collect() };
    least + largest_last_variable(table).0
}

/// Returns the forces with the largest reserve, of forces `λ` of at most `most` in each gap.
fn held_by_at_most(most: f64, contacts: &[HeldContact], gaps: &[Gap]) -> Holding {
    // Each row is a bound on the sum of the variables times their coefficients.
    let columns = |gap: &Gap| gap_columns(gap, contacts);
    let columns: SmallVec<[[GapColumn; 2]; 2]> = gaps.iter().map(columns).collect();
    let bound = |row: usize| {
        let HeldContact { normal, friction, limit, weight } = contacts[row / 2];
        (limit * normal - SIGNS[row % 2] * friction) / weight
    };
    let rows = 0..2 * contacts.len();
    let least = rows.clone().map(bound).fold(f64::INFINITY, f64::min);
    let entries = rows.flat_map(|row| {
        let pushes =
            columns.iter().flat_map(move |of_gap| of_gap.iter().map(move |column| column[row]));
        // The last variable is the reserve above that without any forces.
        pushes.chain([1.0, bound(row) - least])
    });
    let mut table = SimplexTableau { variables: 2 * gaps.len() + 1, entries: entries.collect() };
    if most.is_finite() {
        for (place, gap) in gaps.iter().enumerate() {
            let both = 2 * place..2 * place + 2;
            let entry = |column: usize| if both.contains(&column) { 1.0 } else { 0.0 };
            table.entries.extend((0..table.variables).map(entry));
            table.entries.push(most / gap.reduced_mass());
        }
    }
    let (more, values) = largest_last_variable(table);
    let forces = values.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    Holding { reserve: least + more, forces }
}

const SIGNS: [f64; 2] = [1.0, -1.0];

/// An entry for each contact and direction of slip.
pub type GapColumn = SmallVec<[f64; 4]>;

/// Returns how the two forces of a gap take up the reserve of each contact against forward and backward slip.
pub fn gap_columns(gap: &Gap, contacts: &[HeldContact]) -> [GapColumn; 2] {
    let unit = gap.reduced_mass();
    SIGNS.map(|rolling| {
        let mut column = GapColumn::from_elem(0.0, 2 * contacts.len());
        for (contact, [along, outward]) in gap.contacts.into_iter().zip(gap.rolling_pushes(rolling))
        {
            let HeldContact { limit, weight, .. } = contacts[contact];
            for (side, sign) in SIGNS.into_iter().enumerate() {
                column[2 * contact + side] += unit * (sign * along - limit * outward) / weight;
            }
        }
        column
    })
}

/// Coefficients up to this size count as zero.
const ZERO: f64 = 1e-14;
/// The largest number of exchanges; a degenerate programme of this size takes a few dozen.
const MOST_EXCHANGES: usize = 10_000;

/// Rows of coefficients of the variables, each with a bound at its end.
struct SimplexTableau {
    /// Number of variables.
    variables: usize,
    entries: SmallVec<[f64; 32]>,
}

impl SimplexTableau {
    fn rows(&self) -> usize {
        self.entries.len() / (self.variables + 1)
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * (self.variables + 1)..][..=self.variables]
    }

    /// Exchanges the variable of a row with that of a column.
    fn exchange(&mut self, row: usize, column: usize) {
        let width = self.variables + 1;
        let inverse = 1.0 / self.entries[row * width + column];
        let pivot: SmallVec<[f64; 8]> = self.row(row).iter().map(|entry| entry * inverse).collect();
        for line in self.entries.chunks_exact_mut(width) {
            let factor = line[column];
            line.iter_mut().zip(&pivot).for_each(|(entry, pivot)| *entry -= factor * pivot);
            line[column] = -factor * inverse;
        }
        let line = &mut self.entries[row * width..][..width];
        line.copy_from_slice(&pivot);
        line[column] = inverse;
    }
}

/// Maximises the last of some variables that are not negative. Each row has their coefficients and the upper bound, not
/// negative, on their sum; the aim follows as the last row. Returns the maximum and the other variables.
fn largest_last_variable(mut table: SimplexTableau) -> (f64, SmallVec<[f64; 8]>) {
    let variables = table.variables;
    let aim = table.rows();
    table.entries.resize(table.entries.len() + variables + 1, 0.0);
    table.entries[aim * (variables + 1) + variables - 1] = 1.0;
    // The variable of each column, and of each row: those from `variables` on are the distances from the bounds.
    let mut outside: SmallVec<[usize; 8]> = (0..variables).collect();
    let mut basis: SmallVec<[usize; 8]> = (variables..variables + aim).collect();
    for _ in 0..MOST_EXCHANGES {
        let promising = (0..variables).filter(|column| table.row(aim)[*column] > ZERO);
        let Some(entering) = promising.min_by_key(|column| outside[*column]) else { break };
        let limits = (0..aim).filter(|row| table.row(*row)[entering] > ZERO);
        let ratio = |row: usize| table.row(row)[variables] / table.row(row)[entering];
        let order = |left: &usize, right: &usize| {
            ratio(*left).total_cmp(&ratio(*right)).then(basis[*left].cmp(&basis[*right]))
        };
        let Some(leaving) = limits.min_by(order) else { break };
        table.exchange(leaving, entering);
        std::mem::swap(&mut basis[leaving], &mut outside[entering]);
    }
    let mut values: SmallVec<[f64; 8]> = SmallVec::from_elem(0.0, variables);
    for (row, variable) in basis.iter().enumerate() {
        if *variable < variables {
            values[*variable] = table.row(row)[variables];
        }
    }
    let most = values.pop().unwrap_or(0.0);
    (most, values)
}
