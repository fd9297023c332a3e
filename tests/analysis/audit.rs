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
    assert_eq!(counts, AuditCounts { runs: 36, flips: 30, rest_flips: 10 });
    let rate = 30.0 / 36.0;
    assert_eq!(counts.flip_rate(), Some(rate));
    // The roots of |p - 30/36| = z sqrt(p (1 - p) / 36).
    let (low, high) = counts.interval();
    for end in [low, high] {
        let score = (end - rate).abs() - 1.959_963_984_540_054 * (end * (1.0 - end) / 36.0).sqrt();
        assert!(score.abs() < 1e-12, "{end}");
    }
}
