//! Recorded contact between balls: gaps at instants, impacts and ends of lasting contact.

use std::collections::BTreeMap;

use stickslip::classification::{
    ContactSample, Instants, Outcome, RecordedRun, RunRecorder, Touch, TouchingOutcome, simulate,
    simulate_recorded,
};
use stickslip::model::{Case, Start, TOUCHING, wrap_to_pi};
use stickslip::motion::Phase;

use super::recorder::{cases, recorded};

/// Restitution of all cases.
const RESTITUTION: f64 = 0.36;

fn model(parameters: &str, restitution: f64) -> String {
    format!(
        "{{kind: ball_balancer, parameters: {{{parameters}}}, \
         contact: {{restitution: {restitution}, friction_coefficient: 0.1}}}}"
    )
}

/// Runs with contact: both methods, two and three balls, a continued end time.
fn in_contact() -> Vec<Case> {
    let balls = |parameters: &str| model(parameters, RESTITUTION);
    let extend = "{end_time_s: 1.5, extend: {factor: 2, labels: [undecided, irregular]}}";
    [
        cases(&balls("speed_rad_s: -173.1803"), 4, "{end_time_s: 3}"),
        cases(&balls("speed_rad_s: -173.1803"), 2, "{end_time_s: 3, method: event}"),
        cases(&balls("speed_rad_s: -216.3772"), 2, extend),
        cases(&balls("speed_rad_s: -173.1803, balls: 3"), 2, "{end_time_s: 2}"),
    ]
    .concat()
}

/// Returns the record with a state inside each step.
fn inside(case: &Case) -> (Outcome, TouchingOutcome, RecordedRun) {
    let (outcome, recording) = recorded(case, Instants::EveryStep { inside: 1 });
    assert_eq!(outcome, simulate(case));
    let touching = outcome.touching.expect("contact between balls");
    (outcome, touching, recording)
}

/// The touches of a run are those of its outcome: as many impacts, and as long in contact.
#[test]
fn touches_are_those_of_the_outcome() {
    let (mut impacts, mut lasting, mut separations, mut extended) = (0, 0, 0, 0);
    let inelastic = cases(&model("balls: 3", 0.0), 4, "{end_time_s: 4}");
    for case in in_contact().into_iter().chain(inelastic) {
        let (outcome, touching, RecordedRun { samples, touches, .. }) = inside(&case);
        let counted = touches.iter().filter(|touch| touch.is_impact()).count();
        assert_eq!(counted as u64, touching.impacts, "{case:?}");
        impacts += counted;
        extended += u32::from(outcome.extended);

        let mut closed = BTreeMap::new();
        for gap in &samples[0].gaps {
            closed.insert(gap.contacts, gap.phase == Phase::Closed);
        }
        assert_eq!(Some(closed.keys().len()), case.model.gaps(&case.start).map(|gaps| gaps.len()));
        let (mut time, mut last) = (0.0, 0.0);
        for touch in &touches {
            assert!(touch.time >= last && touch.before.contacts == touch.after.contacts);
            time += if closed.values().any(|closed| *closed) { touch.time - last } else { 0.0 };
            last = touch.time;
            let now = touch.after.phase == Phase::Closed;
            let before = closed.insert(touch.after.contacts, now);
            assert_eq!(before, Some(touch.before.phase == Phase::Closed), "{touch:?}");
            lasting += u32::from(now);
            separations += u32::from(!touch.is_impact());
        }
        let at_end = closed.values().any(|closed| *closed);
        assert_eq!(at_end, touching.at_end);
        let natural = case.model.natural_frequency_rad_s();
        let end = samples.last().expect("samples").time;
        time += if at_end { end - last } else { 0.0 };
        assert!((time / natural - touching.time_s).abs() < 1e-9, "{time} {touching:?}");
    }
    assert!(impacts > 50 && lasting > 3 && separations > 0, "{impacts} {lasting} {separations}");
    assert!(extended > 0);
}

/// Gaps have the width between their balls, which is zero where they touch and never negative; impacts obey Newton's law.
#[test]
fn gaps_and_impacts_obey_their_laws() {
    let (mut touching, mut bounces) = (0, 0);
    for case in in_contact() {
        let (_, _, recording) = inside(&case);
        let machine = case.model.ball_balancer().expect("balls");
        let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[0]);
        for sample in &recording.samples {
            let sum: f64 = sample.gaps.iter().map(|gap| gap.width).sum();
            let free = std::f64::consts::TAU - sample.gaps.len() as f64 * angle;
            assert!((sum - free).abs() < 1e-9, "{sample:?}");
            for gap in &sample.gaps {
                let [behind, ahead] = gap.contacts.map(|contact| sample.contacts[contact]);
                let speed = |ball: ContactSample| match ball.phase {
                    Phase::Stick => 0.0,
                    _ => ball.speed,
                };
                assert_eq!(gap.opening_speed, speed(ahead) - speed(behind));
                let apart = ahead.position - behind.position - gap.width - angle;
                let turns = apart / std::f64::consts::TAU;
                assert!((turns - turns.round()).abs() < 1e-9, "{sample:?}");
                match gap.phase {
                    Phase::Closed => {
                        touching += 1;
                        assert!(gap.width.abs() < 1e-9 && gap.opening_speed.abs() < 1e-9);
                    }
                    _ => assert!(gap.phase == Phase::Open && gap.width > -TOUCHING, "{gap:?}"),
                }
            }
        }
        for touch in recording.touches.iter().filter(|touch| touch.is_impact()) {
            let [before, after] = [touch.before, touch.after].map(|gap| gap.opening_speed);
            assert!(before < 0.0 && touch.before.width.abs() < 1e-9, "{touch:?}");
            let apart = wrap_to_pi(touch.positions[1] - touch.positions[0]);
            assert!((apart - touch.after.width - angle).abs() < 1e-9, "{touch:?}");
            if touch.after.phase == Phase::Closed {
                assert_eq!(after, 0.0, "{touch:?}");
            } else if case.model.balls() == 2 {
                bounces += 1;
                assert!((after + RESTITUTION * before).abs() < 1e-9 * before.abs(), "{touch:?}");
            }
        }
    }
    assert!(touching > 100 && bounces > 30, "{touching} {bounces}");
}

/// Balls that are at each other at the start, and approach, make an impact at time 0: it is counted, and recorded. Balls
/// that do not approach are in contact.
#[test]
fn an_impact_at_the_start_is_counted_and_recorded() {
    let case = cases(&model("balls: 3", RESTITUTION), 1, "{end_time_s: 0.1}").remove(0);
    let machine = case.model.ball_balancer().expect("balls");
    let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[0]);
    let beta = [0, 1, 2].map(|ball| 1.0 + f64::from(ball) * angle);
    for (speeds, expected) in [([0.5, 0.1, 0.1], 1), ([0.5, 0.1, -0.3], 2), ([0.5; 3], 0)] {
        let start = Start::of_balancer([0.0; 2], &beta, [0.0; 2], &speeds);
        let (_, touching, recording) = inside(&Case { start, ..case.clone() });
        let impacts = recording.touches.iter().filter(|touch| touch.is_impact());
        assert_eq!(impacts.clone().count() as u64, touching.impacts);
        let first: Vec<_> = impacts.filter(|touch| touch.time == 0.0).collect();
        assert_eq!(first.len(), expected, "{first:?}");
        for touch in first {
            let Touch { before, after, .. } = touch;
            assert!(before.opening_speed < 0.0 && after.opening_speed >= 0.0, "{touch:?}");
        }
    }
}

#[test]
fn without_contact_there_are_no_gaps() {
    for model in ["{kind: ball_balancer}", "{kind: block_on_spring}"] {
        for case in cases(model, 2, "{end_time_s: 0.5}") {
            let (_, recording) = recorded(&case, Instants::EveryStep { inside: 0 });
            let RecordedRun { samples, touches, .. } = recording;
            assert!(samples.len() > 1 && samples.iter().all(|sample| sample.gaps.is_empty()));
            assert!(touches.is_empty() && case.model.gaps(&case.start).is_none());
        }
    }
}

#[test]
fn too_many_touches_are_cut_off() {
    let case = in_contact()
        .into_iter()
        .find(|case| inside(case).2.touches.len() > 3)
        .expect("a run with impacts");
    let mut recorder = RunRecorder::new(Instants::At(vec![0.0]), 3);
    simulate_recorded(&case, &mut recorder);
    let recording = recorder.finish();
    assert!(recording.cut_off && recording.touches.len() == 3, "{recording:?}");
}
