//! Counts of audited runs.

use stickslip::analysis::AuditCounts;
use stickslip::classification::Label;

#[test]
fn other_labels_and_failures_on_one_side_are_flips() {
    let mut counts = AuditCounts::default();
    assert_eq!((counts.flip_rate(), counts.interval()), (None, (0.0, 1.0)));
    for first in Label::ALL {
        for second in Label::ALL {
            counts.add(first, second);
        }
    }
    assert_eq!(counts, AuditCounts { runs: 49, flips: 42, rest_flips: 12 });
    let rate = 42.0 / 49.0;
    assert_eq!(counts.flip_rate(), Some(rate));
    // The roots of |p - 42/49| = z sqrt(p (1 - p) / 49).
    let (low, high) = counts.interval();
    for end in [low, high] {
        let score = (end - rate).abs() - 1.959_963_984_540_054 * (end * (1.0 - end) / 49.0).sqrt();
        assert!(score.abs() < 1e-12, "{end}");
    }
}
