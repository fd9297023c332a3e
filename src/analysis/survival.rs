//! Time to rest: the share of runs still moving over time, with runs that were stopped before they
//! came to rest as censored observations (Kaplan-Meier).

/// The Kaplan-Meier estimate of the share of runs still moving.
///
/// Source: E. L. Kaplan, P. Meier, J. Am. Stat. Assoc. 53 (1958) 457,
/// doi:10.1080/01621459.1958.10501452.
#[derive(Clone, Debug, PartialEq)]
pub struct SurvivalCurve {
    /// Times at which runs came to rest, s, ascending, and the share still moving right after.
    pub steps: Vec<(f64, f64)>,
}

impl SurvivalCurve {
    /// The curve of `[runs that came to rest, runs that were stopped]` at ascending times, s. A run
    /// that has been shown never to come to rest was stopped at an infinite time. At equal times,
    /// runs that came to rest count before runs that were stopped.
    pub fn new(groups: impl Iterator<Item = (f64, [u64; 2])> + Clone) -> Self {
        let mut at_risk: u64 = groups.clone().map(|(_, [rests, stopped])| rests + stopped).sum();
        let mut moving = 1.0;
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for (time, [rests, stopped]) in groups {
            if rests > 0 {
                moving *= 1.0 - rests as f64 / at_risk as f64;
                steps.push((time, moving));
            }
            at_risk -= rests + stopped;
        }
        SurvivalCurve { steps }
    }

    /// The time by which this share of runs has come to rest, s; `None` where it is not reached.
    pub fn time_to_rest_quantile(&self, share: f64) -> Option<f64> {
        // A share like 0.95 of 256 runs must not be missed for a rounding error in the product.
        let enough = 1.0 - share + 1e-12;
        self.steps.iter().find(|(_, moving)| *moving <= enough).map(|(time, _)| *time)
    }
}

#[cfg(test)]
mod tests {
    use super::SurvivalCurve;
    use crate::analysis::Tally;

    fn curve(rests: &[f64], stopped: &[f64]) -> SurvivalCurve {
        let mut times = Tally::default();
        stopped.iter().for_each(|time| times.add(*time, 1));
        rests.iter().for_each(|time| times.add(*time, 0));
        SurvivalCurve::new(times.groups())
    }

    /// The remission times of the 6-MP group of Freireich et al. (Blood 21 (1963) 699), with the
    /// estimates that textbooks print: 0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448.
    #[test]
    fn textbook_data() {
        let rests = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0];
        let stopped = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0];
        let curve = curve(&rests, &stopped);
        let expected = [0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448];
        assert_eq!(curve.steps.len(), expected.len());
        for ((_, moving), printed) in curve.steps.iter().zip(expected) {
            assert!((moving - printed).abs() < 5.01e-4, "{moving} {printed}");
        }
        assert_eq!(curve.time_to_rest_quantile(0.5), Some(23.0));
        assert_eq!(curve.time_to_rest_quantile(0.75), None);
    }

    #[test]
    fn nothing_censored_gives_the_sample_quantile() {
        let times: Vec<f64> = (1..=100).map(f64::from).collect();
        let curve = curve(&times, &[]);
        assert_eq!(curve.time_to_rest_quantile(0.5), Some(50.0));
        assert_eq!(curve.time_to_rest_quantile(0.95), Some(95.0));
        assert_eq!(curve.time_to_rest_quantile(1.0), Some(100.0));
        assert_eq!(SurvivalCurve::new([].into_iter()).time_to_rest_quantile(0.5), None);
    }
}
