//! The loads of contacts with one sliding speed, such as two pads on a disc or the feet of a box, which hold it together.
//!
//! Accelerations do not say which of these contacts carries the load. In the equations the first one that sticks carries it, and
//! results show for those that stick shares in proportion to their friction limits: they break loose together, where the load
//! exceeds the sum of the limits.

use super::mechanism_contact::{ContactRows, MechanismContact};
use super::{Expression, Node, Number, Recorder};

/// The contacts of a mechanism, by their sliding speeds.
pub(super) struct SharedLoads<'m, 'r> {
    rows: &'m [ContactRows<'r>],
    /// For each contact the contacts with its sliding speed, in their order.
    with_speed: Vec<Vec<usize>>,
}

impl<'m, 'r> SharedLoads<'m, 'r> {
    pub(super) fn new(
        recorder: &Recorder,
        contacts: &[MechanismContact<'r>],
        rows: &'m [ContactRows<'r>],
    ) -> Self {
        let speed = |contact: usize| recorder.node_of(contacts[contact].sliding_speed);
        let is_same = |a: usize, b: usize| {
            a == b || speed(a) == speed(b) && !matches!(speed(a), Node::Constant(_))
        };
        let with = |row: usize| (0..rows.len()).filter(|other| is_same(row, *other)).collect();
        SharedLoads { rows, with_speed: (0..rows.len()).map(with).collect() }
    }

    /// Returns whether no contact before this one has its sliding speed.
    pub(super) fn is_first(&self, contact: usize) -> bool {
        self.with_speed[contact][0] == contact
    }

    /// Returns 1 where a contact sticks and no contact before it holds the same speed, otherwise 0.
    pub(super) fn holds(&self, contact: usize) -> Expression<'r> {
        let before = self.with_speed[contact].iter().take_while(|other| **other != contact);
        self.sticks(contact) * self.are_free(before)
    }

    /// Returns the friction force that results show for a contact; `loads` returns for each contact its friction force in the
    /// equations and its normal force.
    pub(super) fn friction(
        &self,
        contact: usize,
        loads: impl Fn(usize) -> (Expression<'r>, Expression<'r>),
    ) -> Expression<'r> {
        let (force, all) = (loads(contact).0, &self.with_speed[contact]);
        if all.len() == 1 {
            return force;
        }
        let [zero, one] = [0.0, 1.0].map(Expression::constant);
        // 1 where at most one of them sticks.
        let alone = all.iter().fold(self.are_free(all.iter()), |sum, holder| {
            let others = all.iter().filter(|other| *other != holder);
            sum + self.sticks(*holder) * self.are_free(others)
        });
        let together = one - alone;
        // The friction force and the friction limit of a contact that sticks; 0 for others.
        let when_stuck = |holder: usize| {
            let ((force, normal), stuck) = (loads(holder), self.sticks(holder));
            [stuck * force, stuck * (self.rows[holder].limit * normal)]
        };
        let [load, limits] = all.iter().fold([zero; 2], |[load, limits], other| {
            let [force, limit] = when_stuck(*other);
            [load + force, limits + limit]
        });
        let [held, limit] = when_stuck(contact);
        let share = load * limit / (together * limits + alone);
        force + together * (share - held)
    }

    fn sticks(&self, contact: usize) -> Expression<'r> {
        Expression::constant(1.0) - self.rows[contact].contact.free
    }

    fn are_free<'i>(&self, contacts: impl Iterator<Item = &'i usize>) -> Expression<'r> {
        let one = Expression::constant(1.0);
        contacts.fold(one, |product, other| product * self.rows[*other].contact.free)
    }
}
