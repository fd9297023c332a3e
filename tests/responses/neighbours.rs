//! Comparison of each design with the nearest earlier one.

use crate::support::TestRng;
use stickslip::analysis::LabelCounts;
use stickslip::classification::Label;
use stickslip::responses::Neighbours;

fn counts(equilibria: u64) -> LabelCounts {
    let mut counts = LabelCounts::default();
    counts.add_many(Label::Equilibrium, equilibria);
    counts.add_many(Label::Undecided, 64 - equilibria);
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

/// The oldest design is dropped first. A study with one point stores 10,000 designs, one with as many points as half a million
/// counts two, and one with more points one; a number of 0 points counts as 1. The first design differs from all others, and is
/// the nearest to a new one until so many others are stored.
#[test]
fn designs_are_stored_for_a_million_counts() {
    for (points, stored) in [(0, 10_000), (1, 10_000), (500_000, 2), (u64::MAX, 1)] {
        let mut neighbours = Neighbours::new(points);
        let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
        assert_eq!(ask(0.0, 10), [None]);
        for design in 1..stored {
            ask(f64::from(design), 60);
        }
        assert_eq!(ask(0.4, 60), [Some(true)], "{points}");
        // The nearest design is now the previous one.
        assert_eq!(ask(0.1, 60), [Some(false)], "{points}");
    }
}

/// Without any change at most 1 % of the answers are flagged: more than 36 of 2000 seeded ones would have a
/// probability below 0.001.
#[test]
fn one_percent_of_the_answers_are_flagged_by_chance() {
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
