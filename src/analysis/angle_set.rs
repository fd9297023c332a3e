//! Shortest arc of the circle that contains a set of angles, in memory that does not grow with the
//! set.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Number of equal parts of the circle.
const PARTS: f64 = 360.0;

/// A set of angles, reduced to the least and the greatest angle in each degree.
///
/// Gaps between angles in different degrees are exact, and no gap within one degree exceeds one
/// degree. The arc is therefore the shortest one if that is shorter than 359 degrees, and otherwise
/// an arc that contains all angles. The result does not depend on the order of the angles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AngleSet {
    parts: BTreeMap<u16, [f64; 2]>,
}

impl AngleSet {
    /// Adds an angle, rad. A non-finite angle is ignored.
    pub fn add(&mut self, angle: f64) {
        if !angle.is_finite() {
            return;
        }
        // Adding 0 turns -0 into 0.
        let within = angle.rem_euclid(TAU) + 0.0;
        // The remainder of a tiny negative angle rounds to a full turn.
        let within = if within < TAU { within } else { 0.0 };
        let part = (within / TAU * PARTS) as u16;
        let [least, greatest] = self.parts.entry(part).or_insert([within; 2]);
        *least = least.min(within);
        *greatest = greatest.max(within);
    }

    /// Returns the start and the end of the shortest arc that contains all angles, in the positive
    /// sense, each in [0, 2π). The arc passes through 0 if its start exceeds its end. `None` if the
    /// set is empty.
    pub fn shortest_arc(&self) -> Option<[f64; 2]> {
        let mut parts = self.parts.values();
        let [first, mut before] = *parts.next()?;
        let (mut arc, mut longest_gap) = ([first, before], f64::NEG_INFINITY);
        for &[least, greatest] in parts {
            if least - before > longest_gap {
                (arc, longest_gap) = ([least, before], least - before);
            }
            before = greatest;
        }
        if first + TAU - before >= longest_gap {
            arc = [first, before];
        }
        Some(arc)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::AngleSet;

    fn arc(angles: &[f64]) -> Option<[f64; 2]> {
        let mut set = AngleSet::default();
        angles.iter().for_each(|&angle| set.add(angle));
        set.shortest_arc()
    }

    fn length([from, to]: [f64; 2]) -> f64 {
        if from <= to { to - from } else { to - from + TAU }
    }

    fn holds([from, to]: [f64; 2], angle: f64) -> bool {
        if from <= to { from <= angle && angle <= to } else { angle >= from || angle <= to }
    }

    #[test]
    fn arcs_may_pass_through_zero() {
        assert_eq!(arc(&[]), None);
        assert_eq!(arc(&[f64::NAN]), None);
        assert_eq!(arc(&[1.5]), Some([1.5, 1.5]));
        assert_eq!(arc(&[2.0, 1.0, 1.5]), Some([1.0, 2.0]));
        assert_eq!(arc(&[0.1, 6.0, 0.3]), Some([6.0, 0.3]));
        assert_eq!(arc(&[-1e-300, 0.2]), Some([0.0, 0.2]));
        assert_eq!(arc(&[3.0, 3.0 + TAU, 3.001]).map(|[from, _]| from), Some(3.0));
    }

    proptest! {
        /// The arc is the shortest of all arcs from an angle to the preceding one, whatever the
        /// order of the angles. The angles lie around a centre, so that arcs of all lengths occur.
        #[test]
        fn is_the_shortest_of_all(
            centre in 0.0..TAU,
            half in 0.001..3.2_f64,
            fractions in prop::collection::vec(-1.0..1.0_f64, 1..60),
        ) {
            let mut angles: Vec<f64> =
                fractions.iter().map(|fraction| (centre + half * fraction).rem_euclid(TAU)).collect();
            let found = arc(&angles).unwrap();
            angles.reverse();
            prop_assert_eq!(Some(found), arc(&angles));
            prop_assert!(angles.iter().all(|&angle| holds(found, angle)));
            let arcs = angles.iter().flat_map(|&from| angles.iter().map(move |&to| [from, to]));
            let all = |ends: &[f64; 2]| angles.iter().all(|&angle| holds(*ends, angle));
            let shortest = arcs.filter(all).map(length).fold(TAU, f64::min);
            let exact = shortest < 359.0 / 360.0 * TAU;
            prop_assert!(!exact || (length(found) - shortest).abs() < 1e-14, "{found:?} {shortest}");
        }
    }

    /// With angles in every degree, the arc contains all of them.
    #[test]
    fn an_arc_of_angles_in_every_degree_contains_them() {
        let angles: Vec<f64> = (0..100_000).map(|k| (f64::from(k) * 2.4).rem_euclid(TAU)).collect();
        let found = arc(&angles).unwrap();
        assert!(length(found) > 0.99 * TAU && angles.iter().all(|&angle| holds(found, angle)));
    }
}
