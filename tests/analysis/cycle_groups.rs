//! Statistics of the limit cycles of a point, from constructed outcomes.

use std::f64::consts::TAU;

use stickslip::analysis::{CycleGroup, ObservedRun, PointAccumulator, Z_95, wilson_with_failures};
use stickslip::classification::{ClosedOrbit, Cycle, CyclePhase, Evidence, Outcome};
use stickslip::model::{Case, Machine, Simulation, Start};

use super::cycle_classes::cycle;

fn case(machine: Machine) -> Case {
    let start = Start::of_balancer([0.0; 2], &[0.0; 2], [0.0; 2], &[0.0; 2]);
    Case { model: machine.into(), start, simulation: Simulation::default() }
}

fn groups(runs: &[(Case, Outcome)]) -> Vec<CycleGroup> {
    let mut point = PointAccumulator::default();
    for (case, outcome) in runs {
        point.add(ObservedRun { cell: 0, case: Some(case), outcome, audit: None });
    }
    point.detail([16.5; 2]).cycles
}

/// Returns a run at -247.3 rad/s in which one ball falls back by some turns per period while the
/// other rests at an angle.
pub fn falls_back(turns: i32, period_s: f64, rests_at: f64, second_rests: bool) -> (Case, Outcome) {
    fn in_order<T>(second_rests: bool, runs: T, rests: T) -> Vec<T> {
        if second_rests { vec![runs, rests] } else { vec![rests, runs] }
    }
    let cycle = Cycle {
        speed_extremes: in_order(second_rests, [60.0 + period_s, 80.0 + period_s], [0.0; 2]),
        position_extremes: in_order(second_rests, None, Some([rests_at; 2])),
        peak_amplitude_m: 2.0 * period_s,
        multipliers: vec![period_s, 0.5 * period_s],
        neutral_directions: 1,
        ..cycle(
            in_order(second_rests, turns, 0),
            vec![in_order(second_rests, CyclePhase::Forward, CyclePhase::Stick)],
        )
    };
    let outcome = Outcome {
        position: Some(in_order(second_rests, 1.0, rests_at)),
        amplitude_m: Some(period_s),
        end_time_s: Some(5.0),
        ..Outcome::of(Evidence::ClosedOrbit(ClosedOrbit {
            period_s,
            friction_margin: Some(period_s),
            cycle: Some(Box::new(cycle)),
        }))
    };
    (case(Machine { speed_rad_s: -247.3, ..Machine::default() }), outcome)
}

#[test]
fn a_class_has_the_statistics_of_its_runs() {
    let failed = Outcome::of(Evidence::Panic(String::new()));
    let bare = Outcome::of(Evidence::ClosedOrbit(ClosedOrbit::default()));
    let any = case(Machine::default());
    let runs = [
        falls_back(1, 0.25, 6.0, true),
        falls_back(1, 0.75, 0.5, false),
        falls_back(1, 0.375, 0.25, true),
        falls_back(2, 1.0, 3.0, true),
        (any.clone(), bare),
        (any, failed),
    ];
    let groups = groups(&runs);
    let names: Vec<(&str, u64)> =
        groups.iter().map(|group| (group.class.as_str(), group.runs)).collect();
    assert_eq!(names, [("-1|rest", 3), ("-2|rest", 1), ("unknown", 1)]);
    let first = &groups[0];
    assert_eq!((first.fraction, first.interval), (0.5, wilson_with_failures(3, 1, 6, Z_95)));
    let period = first.period_s.expect("known");
    assert_eq!([period.middle, period.least, period.greatest], [0.375, 0.25, 0.75]);
    let amplitude = first.amplitude_m.expect("known");
    let mean = (0.25 + 0.375 + 0.75) / 3.0;
    assert!((amplitude.middle - mean).abs() < 1e-15);
    assert_eq!([amplitude.least, amplitude.greatest], [0.25, 0.75]);
    assert_eq!(first.amplitude_peak_m, Some(1.5));
    assert_eq!(first.multipliers, Some(vec![0.75, 0.375]));
    assert_eq!(first.largest_multiplier(), Some(0.75));
    assert_eq!((first.neutral_directions, first.balls_running()), (Some(1), Some(1)));
    assert_eq!(first.least_margin, Some(0.25));
    let [runs, rests] = &first.roles[..] else { panic!("{:?}", first.roles) };
    // Counted in the disc's sense, which is the negative one.
    assert_eq!((runs.role.turns, rests.role.turns), (-1, 0));
    assert_eq!((runs.mean_speed, rests.mean_speed), (-TAU / 0.375, 0.0));
    assert_eq!(runs.speed_extremes, [-80.75, -60.25]);
    assert_eq!((runs.stays_between, rests.stays_between), (None, Some([6.0, 0.5])));
    let unknown = &groups[2];
    assert_eq!((unknown.balls_running(), unknown.largest_multiplier()), (None, None));
}

/// A thousand classes are reported separately and the rest together, independent of the order of
/// runs.
#[test]
fn at_most_a_thousand_classes_are_separate() {
    let mut runs: Vec<_> = (1..=1500).map(|turns| falls_back(turns, 0.1, 1.0, true)).collect();
    let forwards = groups(&runs);
    runs.reverse();
    assert_eq!(forwards, groups(&runs));
    assert_eq!(forwards.len(), 1001);
    let last = forwards.last().expect("a thousand and one");
    assert_eq!((last.class.as_str(), last.runs), (CycleGroup::OTHER, 500));
    assert_eq!((last.period_s, last.roles.len()), (None, 0));
    let kept: u64 = forwards[..1000].iter().map(|group| group.runs).sum();
    assert_eq!(kept, 1000);
    assert!(forwards.iter().any(|group| group.class == "-1000|rest"));
}

/// With more runs than separately counted periods, the median is accurate in any order.
#[test]
fn the_median_of_many_runs_is_accurate() {
    let mut runs: Vec<_> = (0..5000)
        .map(|i| {
            let fraction = f64::from(i * 7 % 5000) / 4999.0;
            falls_back(1, 0.0895 + 1e-6 * fraction, 5.0 + 2.0 * fraction, i % 3 == 0)
        })
        .collect();
    let found = groups(&runs);
    runs.reverse();
    assert_eq!(found, groups(&runs));
    let [group] = &found[..] else { panic!("{} classes", found.len()) };
    let period = group.period_s.expect("known");
    assert!((period.middle - 0.089_500_5).abs() < 1e-8, "{period:?}");
    assert_eq!([period.least, period.greatest], [0.0895, 0.0895 + 1e-6]);
    let [from, to] = group.roles[1].stays_between.expect("it rests");
    assert!((from - 5.0).abs() < 1e-12 && (to - (7.0 - TAU)).abs() < 1e-12);
}
