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

#[test]
fn the_oldest_design_is_dropped_first() {
    let mut neighbours = Neighbours::new(500_000);
    let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
    assert_eq!(
        [ask(0.0, 60), ask(1.0, 60), ask(0.5, 10)].concat(),
        [None, Some(false), Some(true)]
    );
    // Of 0, 1 and 0.5 the first one has been dropped: the nearest to 0 is 0.5.
    assert_eq!(ask(0.0, 60), [Some(true)]);
}

/// A study with one point stores 10,000 designs: the first one, which differs from all others, is
/// the nearest to a new design until 10,000 others are stored.
#[test]
fn ten_thousand_designs_are_stored() {
    let mut neighbours = Neighbours::new(1);
    let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
    assert_eq!(ask(0.0, 10), [None]);
    for design in 1..10_000 {
        ask(f64::from(design), 60);
    }
    assert_eq!(ask(0.4, 60), [Some(true)]);
    // The nearest design is now the previous one.
    assert_eq!(ask(0.1, 60), [Some(false)]);
}

/// A number of 0 points counts as 1.
#[test]
fn several_designs_are_stored_without_points() {
    let mut neighbours = Neighbours::new(0);
    let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
    assert_eq!([ask(0.0, 10), ask(1.0, 60), ask(2.0, 60)].concat()[1..], [Some(true), Some(false)]);
    assert_eq!(ask(0.4, 60), [Some(true)]);
}

/// A study with too many points for a million counts stores one design.
#[test]
fn one_design_is_always_stored() {
    let mut neighbours = Neighbours::new(u64::MAX);
    let mut ask = |at: f64, equilibria| neighbours.compare(vec![at], vec![counts(equilibria)]);
    assert_eq!([ask(0.0, 60), ask(1.0, 10)].concat(), [None, Some(true)]);
    assert_eq!(ask(0.1, 10), [Some(false)]);
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
