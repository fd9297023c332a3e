//! Contacts that open and close, against closed forms: impacts with friction, accumulation into lasting contact and release.

use std::sync::Arc;

use stickslip::classification::simulate;
use stickslip::model::{
    Case, Expression, Friction, FrictionLaw, ImpactLaw, Mechanism, MechanismContact,
    MechanismNormal, Method, Number, OutputValue, Recorder, Simulation, System,
};
use stickslip::motion::{Direction, Motion, Phase, Settings, Tolerance};

use super::samples::compare_displacements;
use crate::classification::openings::block;
use crate::classification::outputs::cases;
use crate::support::OwnSystem;

fn settings(method: Method) -> Settings {
    let tolerance = Tolerance { relative: 1e-12, absolute: 1e-14 };
    Settings { method, band: 1e-6, tolerance, effort_limit: 1_000_000 }
}

fn smooth() -> Friction {
    FrictionLaw::viscous(0.0).contact(0.0, 1.0, 1.0)
}

fn law(restitution: f64) -> ImpactLaw {
    ImpactLaw { restitution, ..ImpactLaw::default() }
}

/// A ball above a plate that vibrates, with the acceleration of gravity and the frequency of the plate as units: the height
/// above the plate obeys `h'' = Γ cos φ - 1` in flight. State: phase, place along the plate, height, and their speeds.
fn plate(shaking: f64, restitution: f64) -> Arc<dyn System> {
    let contacts = vec![(smooth(), true, law(restitution))];
    Arc::new(OwnSystem::mechanism(block, vec![shaking, 0.0], contacts))
}

/// The height and the speed at a phase after a flight that begins at another phase on the plate with a speed.
fn flight(shaking: f64, from: f64, speed: f64, to: f64) -> [f64; 2] {
    let time = to - from;
    let height =
        speed * time - 0.5 * time * time - shaking * (to.cos() - from.cos() + from.sin() * time);
    [height, speed - time + shaking * (to.sin() - from.sin())]
}

/// A ball rests on the plate until the plate falls faster than the ball, `Γ cos φ = 1`; it flies, bounces, and comes to rest
/// again after infinitely many impacts.
#[test]
fn a_ball_is_lifted_off_comes_to_rest_by_accumulation_and_is_lifted_again() {
    let (shaking, restitution) = (1.3_f64, 0.4);
    let system = plate(shaking, restitution);
    let mut motion =
        Motion::new(&system, settings(Method::Event), &[0.0; 5]).expect("starts on the plate");
    assert_eq!(motion.phases(), [Phase::Apart], "the plate falls faster than the ball");
    let lifts_off = std::f64::consts::TAU - (1.0 / shaking).acos();
    // The flights of the closed form, each to the first return to the plate.
    let (mut from, mut speed) = (0.0, 0.0);
    for cycle in 0..3 {
        let mut impacts = 0;
        loop {
            let (mut low, mut high) = (from, from);
            while flight(shaking, from, speed, high)[0] >= 0.0 {
                low = high;
                high += 1e-3_f64.max(speed);
            }
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                match flight(shaking, from, speed, middle)[0] >= 0.0 && middle > from {
                    true => low = middle,
                    false => high = middle,
                }
            }
            let approach = -flight(shaking, from, speed, low)[1];
            if approach < 1e-4 {
                break;
            }
            while !motion.advance(100.0).expect("continues") {}
            assert!((motion.time() - low).abs() < 1e-9, "{cycle}: {} {low}", motion.time());
            assert!((motion.state()[4] - restitution * approach).abs() < 1e-8);
            (from, speed) = (low, restitution * approach);
            impacts += 1;
        }
        assert!(impacts > 5, "{impacts}");
        while motion.phases()[0] == Phase::Apart {
            motion.advance(100.0).expect("continues");
        }
        assert_eq!(motion.phases(), [Phase::Free]);
        let state = motion.state();
        assert!(state[2].abs() < 1e-9 && state[4].abs() < 1e-6, "{state:?}");
        while motion.phases()[0] == Phase::Free {
            motion.advance(100.0).expect("continues");
        }
        from = lifts_off + std::f64::consts::TAU * f64::from(cycle);
        speed = 0.0;
        assert!((motion.time() - from).abs() < 1e-9, "{} {from}", motion.time());
    }
}

/// A sphere that spins about a horizontal axis falls on the ground. The sliding speed is that of its lowest point.
fn falling_sphere<'r>(recorder: &'r Recorder, friction: &[Friction]) -> Mechanism<'r> {
    let [x, x_speed, y, y_speed, angle, spin] = [(); 6].map(|()| recorder.state());
    let inertia = recorder.parameter("inertia");
    let [zero, one] = [0.0, 1.0].map(Expression::constant);
    Mechanism {
        coordinates: vec![[x, x_speed], [y, y_speed], [angle, spin]],
        rates: vec![],
        others: vec![],
        mass: vec![vec![one, zero, zero], vec![zero, one, zero], vec![zero, zero, inertia]],
        forces: vec![zero, -one, zero],
        contacts: vec![MechanismContact {
            position: (x, false),
            sliding_speed: x_speed + spin,
            normal: MechanismNormal::Gap(y),
            friction: friction[0],
            force_unit: 1.0,
        }],
        forcing: None,
        angles: vec![],
    }
}

/// The impulses of a sphere of radius and mass 1: friction is `μ (1 + e) v_y` where it slides on, and it stops or reverses the
/// sliding speed where that needs less. It then rolls, because nothing else acts along the ground.
#[test]
fn a_sphere_that_hits_the_ground_slides_on_or_grips() {
    let inertia: f64 = 0.4;
    let answer = 1.0 + 1.0 / inertia;
    for method in [Method::Event, Method::Switch] {
        for (friction, restitution, tangential, x_speed, spin) in [
            (0.1, 0.5, 0.0, 2.0, 1.0),
            (0.1, 0.5, 0.0, -2.0, 1.0),
            (0.5, 0.8, 0.0, 0.3, 0.2),
            (0.5, 0.8, 0.6, 0.3, 0.2),
            (0.5, 0.8, 0.6, -0.3, -0.2),
            (0.2, 0.0, 0.0, 1.5, 1.0),
        ] {
            let law = ImpactLaw { tangential_restitution: tangential, ..law(restitution) };
            let contacts = vec![(Friction::coulomb(friction), true, law)];
            let system: Arc<dyn System> =
                Arc::new(OwnSystem::mechanism(falling_sphere, vec![inertia], contacts));
            let height: f64 = 0.5;
            let start = [0.0, x_speed, height, 0.0, 0.0, spin];
            let mut motion = Motion::new(&system, settings(method), &start).expect("starts");
            while !motion.advance(10.0).expect("continues") {}
            let approach = (2.0 * height).sqrt();
            assert!((motion.time() - approach).abs() < 1e-11);
            let sliding: f64 = x_speed + spin;
            let normal = (1.0 + restitution) * approach;
            let most = friction * normal;
            let needed = (1.0 + tangential) * sliding / answer;
            let impulse = needed.clamp(-most, most);
            let state = motion.state();
            let expected = [x_speed - impulse, restitution * approach, spin - impulse / inertia];
            for (place, expected) in [1, 3, 5].into_iter().zip(expected) {
                assert!((state[place] - expected).abs() < 1e-10, "{place}: {state:?} {expected}");
            }
            // Until it lies on the ground and rolls.
            let rolls = |motion: &Motion| motion.phases()[0] == Phase::Stick;
            while !rolls(&motion) && motion.time() < 100.0 {
                motion.advance(100.0).expect("continues");
            }
            assert!(rolls(&motion), "{:?}", motion.phases());
            let state = motion.state();
            assert!(state[2].abs() < 1e-9 && (state[1] + state[5]).abs() < 2e-6, "{state:?}");
            // The angular momentum about a point of the ground is kept.
            let momentum = inertia * spin - x_speed;
            assert!((inertia * state[5] - state[1] - momentum).abs() < 1e-8, "{state:?}");
        }
    }
}

/// A block that slides up a slope, stops, and sticks or slides down again.
#[test]
fn a_body_that_slides_on_the_ground_keeps_its_direction_until_it_stops() {
    let contacts = vec![(Friction::coulomb(0.25), true, law(0.0))];
    let system: Arc<dyn System> =
        Arc::new(OwnSystem::mechanism(falling_sphere, vec![1e6], contacts));
    let start = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    let mut motion = Motion::new(&system, settings(Method::Event), &start).expect("starts");
    assert_eq!(motion.phases(), [Phase::Slip(Direction::Forward)]);
    while !motion.advance(10.0).expect("continues") {}
    assert!((motion.time() - 4.0).abs() < 1e-4, "{}", motion.time());
    assert_eq!(motion.phases(), [Phase::Stick]);
    assert!((motion.state()[0] - 2.0).abs() < 1e-4);
}

/// Displacements pass through impacts with friction, accumulation excepted, and through release.
#[test]
fn displacements_pass_through_impacts_with_friction_and_through_release() {
    let contacts = vec![(Friction::coulomb(0.3), true, law(0.5))];
    let sphere: Arc<dyn System> =
        Arc::new(OwnSystem::mechanism(falling_sphere, vec![0.4], contacts));
    let lifted = plate(1.3, 0.0);
    let cases = [
        // It slides on, then it grips.
        (&sphere, &[0.0, 3.0, 0.5, 0.0, 0.0, 1.0][..], &[1, 2, 3, 5][..], 1.8),
        (&sphere, &[0.0, 0.1, 0.5, 0.0, 0.0, 0.2], &[1, 2, 3, 5], 1.8),
        (&lifted, &[3.0, 0.0, 0.0, 0.0, 0.0], &[0], 6.2),
    ];
    for (system, start, places, end) in cases {
        let settings = settings(Method::Event);
        compare_displacements(system, settings, start, places, end, [1e-6, 1e-5]);
    }
}

/// A forced mass hits a light plate on a spring. Far from the origin of the coordinates, rounding leaves more of the force at which they
/// separate than the force changes in a short time, and the light plate makes a large acceleration of it.
#[test]
fn a_light_plate_separates_wherever_the_origin_lies() {
    for origin in [0.0, 10.0, 1000.0] {
        let system = format!(
            "parameters: {{l: {origin:?}, mp: 1e-3, bet: 15, cp: 0.02, om: 1.1}}
coordinates: {{x: {{start: l}}, p: {{start: l + 0.02}}}}
mass: {{x: {{x: 1}}, p: {{p: mp}}}}
force:
  x: 1.6 * cos(om * t) - (x - l) - 0.1 * x'
  p: -bet * (p - l - 0.02) - cp * p'
contacts: {{stop: {{gap: p - x}}}}
period: 2 * pi / om"
        );
        for method in [Method::Switch, Method::Event] {
            let case = cases(&system, 1, 300.0).remove(0);
            let simulation = Simulation { method, ..case.simulation };
            let outcome = simulate(&Case { simulation, ..case });
            if origin < 100.0 {
                assert_eq!(outcome.evidence.name(), "closed_orbit", "{origin} {method:?}");
                let cycle = outcome.evidence.cycle().expect("a cycle");
                assert!((cycle.multipliers[0] - 0.744_3).abs() < 1e-4, "{cycle:?}");
            }
            let amplitude = outcome.outputs[0].value(OutputValue::Amplitude);
            assert!((amplitude.unwrap_or(f64::NAN) - 1.0769).abs() < 1e-3, "{outcome:?}");
        }
    }
}

/// A nut falls on a thread with a lead angle below the angle of friction: the only motion after the impact is stick, also where the inertia of
/// the screw is so small that the equations of slip have no solution (Painlevé). The margin is `1 - tan(lead) / μ`.
#[test]
fn a_nut_sticks_where_it_falls_on_a_screw() {
    for inertia in [1e-4, 1.1e-5, 9e-6, 5e-6] {
        let system = format!(
            "parameters: {{J: {inertia:e} kg m^2, m: 10 kg, r: 10 mm, lam: 0.1 rad, mu: 0.2, W: 100 N, b: 0.01 N m s/rad}}
coordinates: {{th: {{unit: rad}}, x: {{unit: m, start_rate: -0.01}}}}
mass: {{th: {{th: J}}, x: {{x: m}}}}
force: {{th: -b * th', x: -W}}
contacts:
  thread:
    gap: x * cos(lam) - r * th * sin(lam)
    sliding: x' * sin(lam) + r * th' * cos(lam)
    friction: {{coulomb: {{coefficient: mu}}}}"
        );
        for method in [Method::Switch, Method::Event] {
            let case = cases(&system, 1, 2.0).remove(0);
            let simulation = Simulation { method, ..case.simulation };
            let outcome = simulate(&Case { simulation, ..case });
            assert_eq!(outcome.evidence.name(), "rest_certified", "{inertia} {method:?}");
            let margin = outcome.evidence.friction_margin().unwrap_or(f64::NAN);
            assert!((margin - (1.0 - 0.1_f64.tan() / 0.2)).abs() < 1e-6, "{margin}");
        }
    }
}
