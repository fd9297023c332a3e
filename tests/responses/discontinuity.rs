//! Abrupt changes of label fractions in tables of designs.

use crate::support::TestRng;
use stickslip::analysis::LabelCounts;
use stickslip::classification::Label;
use stickslip::responses::discontinuous;

fn counts(equilibria: u64, undecided: u64) -> LabelCounts {
    let mut counts = LabelCounts::default();
    counts.add_many(Label::Equilibrium, equilibria);
    counts.add_many(Label::Undecided, undecided);
    counts
}

#[test]
fn a_step_is_seen_from_both_sides() {
    let scaled: Vec<Vec<f64>> = [0.0, 0.1, 0.2, 0.3, 0.4].map(|x| vec![x]).to_vec();
    let fractions = [60, 62, 61, 20, 22].map(|equilibria| counts(equilibria, 64 - equilibria));
    let expected = [false, false, true, true, false].map(Some);
    assert_eq!(discontinuous(&scaled, &fractions), expected);
    assert_eq!(discontinuous(&scaled[..1], &fractions[..1]), [None]);
    // Another order gives the same flags.
    let order = [3, 0, 4, 2, 1];
    let flags = discontinuous(&order.map(|at| scaled[at].clone()), &order.map(|at| fractions[at]));
    assert_eq!(flags, order.map(|at| expected[at]));
}

/// Without any change at most 1 % of the tables have a flag: more than 36 of 2000 seeded ones would have a
/// probability below 0.001.
#[test]
fn one_percent_of_the_tables_have_a_flag_by_chance() {
    let mut draws = TestRng::new(5);
    let scaled: Vec<Vec<f64>> = (0..10).map(|x| vec![f64::from(x)]).collect();
    let mut flagged = 0;
    for _ in 0..2000 {
        let fractions: Vec<LabelCounts> = (0..10)
            .map(|_| {
                let rests = (0..50).filter(|_| draws.uniform() < 0.4).count() as u64;
                counts(rests, 50 - rests)
            })
            .collect();
        flagged += u32::from(discontinuous(&scaled, &fractions).contains(&Some(true)));
    }
    println!("{flagged} of 2000");
    assert!(flagged <= 36, "{flagged}");
}
