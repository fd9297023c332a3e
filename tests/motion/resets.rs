//! Events that reset the state against closed forms: a bouncing mass, and a block that is kicked and pulled by a ramp.

use std::sync::Arc;

use stickslip::model::{
    ContactEquations, ContactLayout, EventEquations, Expression, Friction, Number, Recorder,
    StateLayout, System, SystemEquations,
};
use stickslip::motion::{Direction, Failure, Motion, Phase, Settings};

use super::samples::{EXACT, compare_displacements};
use crate::support::{OwnSystem, shared};

/// A mass above the ground: height, speed; parameters: gravity, coefficient of restitution.
fn bouncing_mass(recorder: &Recorder) -> SystemEquations<'_> {
    let [height, speed] = [(); 2].map(|()| recorder.state());
    let [gravity, restitution] = ["gravity", "restitution"].map(|name| recorder.input(name));
    let impact = EventEquations {
        guard: height,
        reset: vec![(0, Expression::constant(0.0)), (1, -restitution * speed)],
    };
    SystemEquations {
        derivative: vec![speed, -gravity],
        events: vec![impact],
        layout: StateLayout { velocities: vec![vec![1]], ..StateLayout::default() },
        ..SystemEquations::default()
    }
}

fn mass(gravity: f64, restitution: f64) -> Arc<dyn System> {
    shared(OwnSystem::new(bouncing_mass, vec![gravity, restitution], vec![]))
}

/// Falls from `height` at rest: impacts at `t_k` with speeds `v e^k`, where `v = sqrt(2 g h)`, `t_0 = v / g` and
/// `t_(k+1) - t_k = 2 v e^(k+1) / g`. The instants converge to `t_0 (1 + e) / (1 - e)`.
#[test]
fn bounces_at_the_times_of_the_closed_form() {
    let (gravity, restitution, height) = (9.81, 0.7, 0.4_f64);
    let speed = (2.0 * gravity * height).sqrt();
    let mut motion =
        Motion::new(&mass(gravity, restitution), EXACT, &[height, 0.0]).expect("starts");
    let mut expected = speed / gravity;
    for bounce in 0..30 {
        while !motion.advance(10.0).expect("continues") {}
        let after = restitution.powi(bounce + 1) * speed;
        assert!((motion.time() - expected).abs() < 2e-14, "{bounce}: {}", motion.time() - expected);
        assert_eq!(motion.state()[0], 0.0);
        assert!((motion.state()[1] / after - 1.0).abs() < 1e-9, "{bounce}");
        let before = motion.before_switch().expect("a reset");
        assert!((before.state[1] * restitution + motion.state()[1]).abs() < 1e-15);
        expected += 2.0 * after / gravity;
    }
    let limit = speed / gravity * (1.0 + restitution) / (1.0 - restitution);
    let rest = 2.0 * restitution.powi(30) * speed / gravity / (1.0 - restitution);
    assert!((motion.time() + rest - limit).abs() < 1e-13);
}

/// Infinitely many impacts in a finite time end at the limit of steps, not in an endless loop.
#[test]
fn accumulating_impacts_end_at_the_limit_of_steps() {
    let settings = Settings { effort_limit: 5000, ..EXACT };
    let mut motion = Motion::new(&mass(1.0, 0.5), settings, &[0.5, 0.0]).expect("starts");
    let ending = (0..10_000).find_map(|_| motion.advance(10.0).err());
    assert_eq!(ending, Some(Failure::StepLimit));
    assert!((motion.time() - 3.0).abs() < 1e-6, "{}", motion.time());
}

#[test]
fn displacements_jump_at_impacts() {
    for time in [0.9, 1.9, 2.4] {
        let system = mass(1.0, 0.8);
        compare_displacements(&system, EXACT, &[0.3, 0.2], &[0, 1], time, [1e-5, 1e-6]);
    }
}

/// A block of mass 1 on the ground with Coulomb friction; the pull grows in proportion to time up to the end of the
/// ramp, and a kick changes the speed. State: time, position, speed, whether the ramp and the kick are still to come.
fn pulled_block(recorder: &Recorder) -> SystemEquations<'_> {
    let [time, _, speed] = [(); 3].map(|()| recorder.state());
    let [ramps, waits] = [(); 2].map(|()| recorder.discrete());
    let names = ["friction", "slope", "ramp_end", "kick_time", "kick", "slips", "direction"];
    let [friction, slope, ramp_end, kick_time, kick, slips, direction] =
        names.map(|name| recorder.input(name));
    let [zero, one] = [0.0, 1.0].map(Expression::constant);
    let pull = slope * (ramps * time + (one - ramps) * ramp_end);
    let acceleration = slips * (pull - direction * friction);
    let guard = |pending, at| pending * (at - time) + (one - pending);
    SystemEquations {
        derivative: vec![one, speed, acceleration, zero, zero],
        contacts: vec![ContactEquations {
            sliding_speed: speed,
            sliding_acceleration: acceleration,
            normal: one,
            friction: slips * direction * friction + (one - slips) * pull,
        }],
        events: vec![
            EventEquations { guard: guard(ramps, ramp_end), reset: vec![(3, zero)] },
            EventEquations {
                guard: guard(waits, kick_time),
                reset: vec![(2, speed + kick), (4, zero)],
            },
        ],
        layout: StateLayout {
            contacts: vec![ContactLayout { position: 1, angular: false }],
            velocities: vec![vec![2]],
            ..StateLayout::default()
        },
        ..SystemEquations::default()
    }
}

const FRICTION: f64 = 0.5;
const SLOPE: f64 = 0.25;

fn block([ramp_end, kick_time, kick]: [f64; 3]) -> Arc<dyn System> {
    let parameters = vec![FRICTION, SLOPE, ramp_end, kick_time, kick];
    shared(OwnSystem::new(pulled_block, parameters, vec![Friction::coulomb(FRICTION)]))
}

/// The block breaks loose at 2, where the pull reaches the limit of friction. The ramp ends at 3. A kick at 5 throws the block back;
/// it comes to rest and slips forward again. A kick at 1 moves the block that sticks; it comes to rest again and breaks loose as if
/// it had not been kicked.
#[test]
fn a_block_on_a_ramp_is_kicked() {
    let [forwards, backwards] = [Direction::Forward, Direction::Backward].map(Phase::Slip);
    // The speed after the ramp and before and after the kick; the pull is then 0.75.
    let ramped = SLOPE * 0.5;
    let thrown = ramped + 2.0 * 0.25 - 2.0;
    let back = -thrown / (0.75 + FRICTION);
    let rest = 3.0 - back;
    let position =
        SLOPE / 6.0 + (ramped * 2.0 + 0.25 * 2.0) + thrown * back / 2.0 + 0.25 * rest * rest / 2.0;
    let thrown_back = [(2.0, forwards), (3.0, forwards), (5.0, backwards), (5.0 + back, forwards)];
    // v = 0.1 - (0.5 - 0.25) τ + 0.125 τ²
    let stop = (0.25 - (0.0625_f64 - 4.0 * 0.125 * 0.1).sqrt()) / 0.25;
    let moved = 0.1 * stop - 0.125 * stop.powi(2) + 0.125 / 3.0 * stop.powi(3);
    let stops = [(1.0, forwards), (1.0 + stop, Phase::Stick), (2.0, forwards)];
    for (kick, events, end, [late, off]) in [
        ([3.0, 5.0, -2.0], &thrown_back[..], [8.0, position, 0.25 * rest, 0.0], [1e-11; 2]),
        ([3.0, 1.0, 0.1], &stops[..], [2.0, moved, 0.0, 1.0], [1e-10, 1e-12]),
    ] {
        let mut motion =
            Motion::new(&block(kick), EXACT, &[0.0, 0.0, 0.0, 1.0, 1.0]).expect("starts");
        for (time, phase) in events {
            while !motion.advance(8.0).expect("continues") {}
            assert!((motion.time() - time).abs() < late, "{} {time}", motion.time());
            assert_eq!(motion.phases()[0], *phase);
        }
        while motion.time() < end[0] {
            assert_eq!(motion.advance(end[0]), Ok(false), "no further event");
        }
        let state = motion.state();
        assert!((state[0] - end[0]).abs() < late, "{state:?}");
        assert!((state[1] - end[1]).abs() < off && (state[2] - end[2]).abs() < off, "{state:?}");
        assert_eq!(state[3..], [end[3], 0.0]);
    }
}

/// A neighbour that is late in time breaks loose, leaves the ramp and is kicked later.
#[test]
fn displacements_follow_ramp_and_kick() {
    for time in [1.5, 2.5, 4.0, 5.5, 8.0] {
        let (system, start) = (block([3.0, 5.0, -2.0]), [0.0, 0.0, 0.3, 1.0, 1.0]);
        compare_displacements(&system, EXACT, &start, &[0, 1, 2], time, [1e-5, 1e-6]);
    }
}
