//! Compares the design of each request with the nearest earlier one.

use std::collections::VecDeque;

use super::discontinuity::{LEVEL, MOST_DESIGNS, distance, labels_differ, near};
use crate::analysis::LabelCounts;
use crate::classification::Label;

/// The largest number of stored counts, one per design and point: about 50 MB.
const MOST_COUNTS: u64 = 1_000_000;

/// A design with its label counts at each point.
struct Before {
    scaled: Vec<f64>,
    counts: Vec<LabelCounts>,
}

/// The designs of the last requests: at most [`MOST_DESIGNS`], fewer for studies with many points. The oldest design
/// is dropped first.
pub struct Neighbours {
    before: VecDeque<Before>,
    most: usize,
}

impl Neighbours {
    /// Creates an empty list for designs with this many points.
    pub fn new(points: u64) -> Self {
        let most = (MOST_COUNTS / points.max(1)).clamp(1, MOST_DESIGNS as u64);
        Neighbours { before: VecDeque::new(), most: usize::try_from(most).unwrap_or(1) }
    }

    /// Returns, point by point, whether the labels of a design differ from those of a nearest earlier design; `None` if
    /// there is none. `scaled` holds the variables, with ranges of length 1. All tests of a point together have a
    /// level of 1 %. A repeated design is not its own neighbour.
    pub fn compare(&mut self, scaled: Vec<f64>, counts: Vec<LabelCounts>) -> Vec<Option<bool>> {
        let others = || self.before.iter().filter(|other| other.scaled != scaled);
        let away = |other: &Before| distance(&scaled, &other.scaled);
        let least = others().map(away).fold(f64::INFINITY, f64::min);
        let nearest: Vec<&Before> = others().filter(|other| near(away(other), least)).collect();
        let level = LEVEL / (nearest.len() * Label::ALL.len()) as f64;
        let differs = |(point, own): (usize, &LabelCounts)| {
            let mut at_point = nearest.iter().filter_map(|other| other.counts.get(point));
            (!nearest.is_empty()).then(|| at_point.any(|other| labels_differ(own, other, level)))
        };
        let flags = counts.iter().enumerate().map(differs).collect();
        if self.before.iter().all(|other| other.scaled != scaled) {
            if self.before.len() == self.most {
                self.before.pop_front();
            }
            self.before.push_back(Before { scaled, counts });
        }
        flags
    }
}

#[cfg(test)]
mod tests {
    use super::Neighbours;
    use crate::analysis::LabelCounts;
    use crate::analysis::test_rng::TestRng;
    use crate::classification::Label;

    fn counts(equilibria: u64) -> LabelCounts {
        let mut counts = LabelCounts::default();
        (0..equilibria).for_each(|_| counts.add(Label::Equilibrium));
        (equilibria..64).for_each(|_| counts.add(Label::Undecided));
        counts
    }

    #[test]
    fn a_design_is_compared_with_those_before_it() {
        let mut neighbours = Neighbours::new(1);
        let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
        assert_eq!(ask(0.0, 60), [None]);
        // A repeated design has no neighbour yet.
        assert_eq!(ask(0.0, 60), [None]);
        assert_eq!(ask(1.0, 20), [Some(true)]);
        assert_eq!(ask(0.1, 61), [Some(false)]);
        assert_eq!(ask(0.9, 22), [Some(false)]);
        // The same design has another nearest neighbour now.
        assert_eq!(ask(0.0, 60), [Some(false)]);
        // Of two equally near designs either may differ.
        assert_eq!(ask(0.5, 60), [Some(true)]);
    }

    #[test]
    fn points_are_compared_one_by_one() {
        let mut neighbours = Neighbours::new(2);
        neighbours.compare(vec![0.0], vec![counts(60), counts(10)]);
        let flags = neighbours.compare(vec![1.0], vec![counts(62), counts(50)]);
        assert_eq!(flags, [Some(false), Some(true)]);
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let mut neighbours = Neighbours::new(500_000);
        let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
        assert_eq!(
            [ask(0.0, 60), ask(1.0, 60), ask(0.5, 10)].concat(),
            [None, Some(false), Some(true)]
        );
        // Of 0, 1 and 0.5 the first one has been dropped: the nearest to 0 is 0.5.
        assert_eq!(ask(0.0, 60), [Some(true)]);
        assert_eq!(neighbours.before.len(), 2);
        assert_eq!(Neighbours::new(1).most, 10_000);
        assert_eq!((Neighbours::new(0).most, Neighbours::new(u64::MAX).most), (10_000, 1));
    }

    /// Without any change at most 1 % of the answers are flagged: more than 36 of 2000 seeded ones would have a
    /// probability below 0.001.
    #[test]
    fn level() {
        let mut draws = TestRng::new(6);
        let mut flagged = 0;
        for _ in 0..2000 {
            let mut neighbours = Neighbours::new(1);
            let mut ask = |at: f64| {
                let rests = (0..64).filter(|_| draws.uniform() < 0.4).count() as u64;
                neighbours.compare(vec![at], vec![counts(rests)])
            };
            // Two equally near neighbours.
            ask(0.0);
            ask(1.0);
            flagged += u32::from(ask(0.5) == [Some(true)]);
        }
        println!("{flagged} of 2000");
        assert!(flagged <= 36, "{flagged}");
    }
}
