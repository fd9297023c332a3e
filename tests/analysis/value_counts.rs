//! Quantiles of many values counted together.

use stickslip::analysis::ValueCounts;

fn counted(values: impl IntoIterator<Item = f64>) -> ValueCounts {
    let mut counts = ValueCounts::default();
    values.into_iter().for_each(|value| counts.add(value, 0));
    counts
}

#[test]
fn quantiles_interpolate_between_order_statistics() {
    let few = counted([4.0, 2.0, 1.0, 3.0]);
    assert_eq!(few.quantile(0.5), Some(2.5));
    assert_eq!(few.quantile(0.0), Some(1.0));
    assert_eq!(few.quantile(1.0), Some(4.0));
    assert_eq!(ValueCounts::default().quantile(0.5), None);
    assert_eq!(counted([f64::NAN, -1.0]).quantile(0.5), None);
}

/// A million different values are within 2.5e-4 of the exact quantiles in any order, in a
/// bounded number of groups.
#[test]
fn many_values_are_counted_coarsely() {
    let value = |i: u32| 1e-5 * (1.0 + f64::from(i)).powf(1.3);
    let ascending = counted((0..1_000_000).map(value));
    assert_eq!(ascending, counted((0..1_000_000).rev().map(value)));
    assert!(ascending.groups().count() <= 65_536);
    for fraction in [0.05, 0.5, 0.95] {
        let exact = value((fraction * 999_999.0) as u32);
        let found = ascending.quantile(fraction).unwrap();
        assert!((found / exact - 1.0).abs() < 2.5e-4, "{found} {exact}");
    }
    let mut endless = ascending;
    endless.add(f64::INFINITY, 1);
    assert_eq!(endless.groups().last(), Some((f64::INFINITY, [0, 1])));
}
