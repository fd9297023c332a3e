//! Compares the design of each request with the nearest earlier one.

use std::collections::VecDeque;

use super::discontinuity::{LEVEL, MOST_DESIGNS, distance, is_nearest, labels_differ};
use crate::analysis::LabelCounts;
use crate::classification::Label;

/// The largest number of stored counts, one per design and point: about 50 MB.
const MOST_COUNTS: u64 = 1_000_000;

/// A design with its label counts at each point.
struct EarlierDesign {
    scaled: Vec<f64>,
    counts: Vec<LabelCounts>,
}

/// The designs of the last requests: at most [`MOST_DESIGNS`], fewer for studies with many points. The oldest design
/// is dropped first.
pub struct Neighbours {
    designs: VecDeque<EarlierDesign>,
    capacity: usize,
}

impl Neighbours {
    /// Creates an empty list for designs with this many points.
    pub fn new(points: u64) -> Self {
        let capacity = (MOST_COUNTS / points.max(1)).clamp(1, MOST_DESIGNS as u64);
        Neighbours { designs: VecDeque::new(), capacity: usize::try_from(capacity).unwrap_or(1) }
    }

    /// Returns, point by point, whether the labels of a design differ from those of a nearest earlier design; `None` if
    /// there is none. `scaled` holds the variables, with ranges of length 1. All tests of a point together have a
    /// level of 1 %. A repeated design is not its own neighbour.
    pub fn compare(&mut self, scaled: Vec<f64>, counts: Vec<LabelCounts>) -> Vec<Option<bool>> {
        let others = || self.designs.iter().filter(|other| other.scaled != scaled);
        let distance_to = |other: &EarlierDesign| distance(&scaled, &other.scaled);
        let least = others().map(distance_to).fold(f64::INFINITY, f64::min);
        let nearest: Vec<&EarlierDesign> =
            others().filter(|other| is_nearest(distance_to(other), least)).collect();
        let level = LEVEL / (nearest.len() * Label::ALL.len()) as f64;
        let differs = |(point, labels): (usize, &LabelCounts)| {
            let mut at_point = nearest.iter().filter_map(|other| other.counts.get(point));
            (!nearest.is_empty()).then(|| at_point.any(|other| labels_differ(labels, other, level)))
        };
        let flags = counts.iter().enumerate().map(differs).collect();
        if self.designs.iter().all(|other| other.scaled != scaled) {
            if self.designs.len() == self.capacity {
                self.designs.pop_front();
            }
            self.designs.push_back(EarlierDesign { scaled, counts });
        }
        flags
    }
}
