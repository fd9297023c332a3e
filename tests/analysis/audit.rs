//! Counts of audited runs.

use stickslip::analysis::{AuditCounts, Z_95, wilson};
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
    assert_eq!(counts, AuditCounts { runs: 64, flips: 56, rest_flips: 14 });
    assert_eq!((counts.flip_rate(), counts.interval()), (Some(56.0 / 64.0), wilson(56, 64, Z_95)));
}
