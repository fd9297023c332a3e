//! Contacts that hold a body more than once, such as the feet of a box: rigid bodies do not determine all of their forces.
//!
//! The equations of such contacts are dependent while all of them hold. The forces that they do not determine are then 0: the first
//! contacts carry the load. Where one of them is at its friction limit, the decision between stick and slip finds the others.

use super::Expression;
use super::mechanism_contact::ContactRows;

/// Returns whether contacts may hold bodies more than once: their equations cannot be assigned to different velocities, or several of
/// them contain as many velocities round and round, as `x' - y'`, `y' - z'` and `z' - x'` do. A contact that `carries_load` rejects
/// shares the load of another one.
pub(super) fn may_be_dependent(
    rows: &[ContactRows<'_>],
    carries_load: impl Fn(usize) -> bool,
) -> bool {
    let moved = |shares: &[Expression<'_>]| -> Vec<usize> {
        (0..shares.len()).filter(|place| shares[*place].known() != Some(0.0)).collect()
    };
    let across = rows.iter().filter_map(|row| row.normal.as_ref()).map(|(shares, _)| moved(shares));
    let along =
        (0..rows.len()).filter(|row| carries_load(*row)).map(|row| moved(&rows[row].tangential.0));
    let equations: Vec<Vec<usize>> = across.chain(along).filter(|row| !row.is_empty()).collect();
    let mut assigned = Vec::new();
    if !(0..equations.len()).all(|row| assign(row, &equations, &mut assigned, &mut Vec::new())) {
        return true;
    }
    // An equation leads to those that have been assigned its velocities.
    let returns = |row: usize| {
        let (mut open, mut seen) = (vec![row], Vec::new());
        while let Some(from) = open.pop() {
            for &(velocity, to) in &assigned {
                if to == from || seen.contains(&to) || !equations[from].contains(&velocity) {
                    continue;
                }
                if to == row {
                    return true;
                }
                seen.push(to);
                open.push(to);
            }
        }
        false
    };
    (0..equations.len()).any(returns)
}

/// Assigns a velocity to an equation, and other velocities to equations before it where needed. Pairs in `assigned` are a velocity and
/// its equation; `tried` are the velocities that are known to be of no use.
fn assign(
    row: usize,
    equations: &[Vec<usize>],
    assigned: &mut Vec<(usize, usize)>,
    tried: &mut Vec<usize>,
) -> bool {
    for &velocity in &equations[row] {
        if tried.contains(&velocity) {
            continue;
        }
        tried.push(velocity);
        match assigned.iter().position(|(other, _)| *other == velocity) {
            None => {
                assigned.push((velocity, row));
                return true;
            }
            Some(place) => {
                if assign(assigned[place].1, equations, assigned, tried) {
                    assigned[place].1 = row;
                    return true;
                }
            }
        }
    }
    false
}
