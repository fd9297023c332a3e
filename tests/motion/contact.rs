//! Balls that touch: impacts, lasting contact and release, against closed forms, balances and known answers.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use stickslip::model::{
    Ball, BallContact, BallsInContact, Components, Dual, Machine, Method, Model, Start, System,
};
use stickslip::motion::{Evaluator, ImpactPlace, Motion, Phase, Settings};

use super::impacts::kinetic;
use super::samples::Sampler;
use crate::support::{METHODS, go_on, rest_margin, settings};

fn touching(machine: &Machine, restitution: f64, friction_coefficient: f64) -> Machine {
    Machine { contact: Some(BallContact { restitution, friction_coefficient }), ..machine.clone() }
}

fn started(machine: &Machine, start: &Start, settings: Settings) -> Motion {
    let model = Model::from(machine.clone());
    let system = model.system_for(start).expect("a system");
    let state = model.start_state(start).expect("a state");
    Motion::new(&system, settings, &state).expect("starts")
}

/// Returns the width of each gap of a machine, from ball 1 around the ring.
fn widths(machine: &Machine, state: &[f64]) -> Vec<f64> {
    let balls = machine.balls.len();
    let mut order: Vec<usize> = (0..balls).collect();
    order.sort_by(|a, b| state[4 + a].total_cmp(&state[4 + b]));
    let width = |place: usize| {
        let (behind, ahead) = (order[place], order[(place + 1) % balls]);
        let angle = machine.contact_angle_rad(&machine.balls[behind], &machine.balls[ahead]);
        (state[4 + ahead] - state[4 + behind]).rem_euclid(TAU) - angle
    };
    (0..balls).map(width).collect()
}

/// Returns a start state with balls that do not overlap.
fn apart(machine: &Machine, sampler: &mut Sampler) -> Start {
    let balls = &machine.balls;
    let angle =
        |ball: usize| machine.contact_angle_rad(&balls[ball], &balls[(ball + 1) % balls.len()]);
    let all: f64 = (0..balls.len()).map(angle).sum();
    let first = sampler.between(0.0, TAU);
    let mut offsets: Vec<f64> = (1..balls.len()).map(|_| sampler.between(0.0, TAU)).collect();
    offsets.sort_by(f64::total_cmp);
    let (mut beta, mut taken) = (vec![first], 0.0);
    for (ball, offset) in offsets.iter().enumerate() {
        taken += angle(ball);
        beta.push((first + offset * (1.0 - all / TAU) + taken).rem_euclid(TAU));
    }
    let mut near = || [(); 2].map(|()| sampler.between(-0.05, 0.05));
    let (position, velocity) = (near(), near());
    let speeds: Vec<f64> = balls.iter().map(|_| sampler.between(-1.0, 1.0)).collect();
    Start::of_balancer(position, &beta, velocity, &speeds)
}

/// Table 5.1's pairs (thesis section 5.3), moved apart until they touch: they stay in touch, and run at these mean speeds
/// (Moreau's time stepping in `scripts/reference`).
#[test]
fn running_pairs_stay_in_touch_at_the_known_speeds() {
    for (speed_rad_s, friction, expected) in [
        (-247.3, 0.0, 72.19),
        (-247.3, 0.1, 72.02),
        (-247.3, 0.2, 71.86),
        (-309.15, 0.0, 133.49),
        (-309.15, 0.1, 133.34),
        (-309.15, 0.2, 133.20),
        (-216.3772, 0.0, 41.46),
    ] {
        let machine = touching(&Machine { speed_rad_s, ..Machine::default() }, 0.5, friction);
        let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
        let natural = machine.natural_frequency_rad_s();
        let running = -speed_rad_s / natural - 1.0;
        let beta = [1.0, 1.0 + angle + 1e-6];
        let start = Start::of_balancer([0.0; 2], &beta, [0.0; 2], &[running; 2]);
        let mut motion = started(&machine, &start, settings(Method::Switch, 1e-8));
        let marks = [30.0, 40.0].map(|time| {
            go_on(&mut motion, time * natural);
            (motion.time(), motion.unwrapped())
        });
        assert_eq!(motion.phases()[2..], [Phase::Closed, Phase::Open]);
        for ball in 0..2 {
            let turned = marks[1].1[ball] - marks[0].1[ball];
            let mean = turned / (marks[1].0 - marks[0].0) * natural;
            assert!((mean - expected).abs() < 0.03, "{speed_rad_s} {friction}: {mean}");
        }
    }
}

/// Each impact of balls without friction loses `½ (1 - e²) ġ² / (wᵀ M⁻¹ w)`, and with `e = 1` nothing, to 1e-12.
#[test]
fn impacts_lose_the_energy_of_the_closed_form() {
    let (mut impacts, mut rest) = (0, 0);
    for (seed, restitution) in (0..40).zip([1.0, 0.5, 0.0, 0.9].into_iter().cycle()) {
        let mut sampler = Sampler::new(seed);
        let mut machine = touching(&Machine::default(), restitution, 0.0);
        machine.balls = vec![Ball::default(); 2 + (seed % 3) as usize];
        for ball in &mut machine.balls {
            ball.mass_kg *= sampler.between(0.5, 20.0);
            ball.diameter_m *= sampler.between(0.5, 1.5);
        }
        let start = apart(&machine, &mut sampler);
        let system = Model::from(machine.clone()).system_for(&start).expect("a system");
        let contact = system.touching().expect("gaps");
        let evaluator = Evaluator::new(Arc::clone(&system));
        let mut motion = started(&machine, &start, settings(Method::Event, 1e-10));
        while motion.time() < 60.0 {
            if !motion.advance(60.0).expect("continues") {
                continue;
            }
            let Some(before) = motion.before_switch() else { continue };
            let (before, after) = (before.state, motion.state());
            let speeds = 4 + machine.balls.len();
            let closing = contact.gaps().iter().enumerate().filter_map(|(index, gap)| {
                let opening = |state: &[f64]| {
                    state[speeds + gap.contacts[1]] - state[speeds + gap.contacts[0]]
                };
                let wide = gap.width(gap.contacts.map(|ball| before[4 + ball])).abs() > 1e-9;
                let met = opening(&before) < 0.0 && !wide;
                met.then(|| (index, opening(&before), opening(&after)))
            });
            let closing: Vec<_> = closing.collect();
            let [(index, approach, separation)] = closing[..] else { continue };
            // The closed form is that of an impact of two balls which touch no third, and which separate.
            let closed = contact
                .gaps()
                .iter()
                .filter(|gap| gap.width(gap.contacts.map(|ball| before[4 + ball])).abs() < 1e-9);
            let lasts = -approach < 1e-6 && restitution < 1.0;
            if closed.count() > 1 || lasts {
                continue;
            }
            assert!((separation + restitution * approach).abs() < 1e-13, "{separation:e}");
            let dual: Vec<Dual> =
                before.iter().map(|value| Dual { value: *value, slope: 0.0 }).collect();
            let response = &evaluator.responses(&dual, &[ImpactPlace::Gap(index)])[0].components;
            let gap = contact.gaps()[index];
            let answer =
                response[speeds + gap.contacts[1]].value - response[speeds + gap.contacts[0]].value;
            let lost = 0.5 * (1.0 - restitution * restitution) * approach * approach / answer;
            let scale = kinetic(&machine, &before);
            let found = scale - kinetic(&machine, &after);
            assert!((found - lost).abs() < 1e-12 * scale, "{seed}: {found:e}, not {lost:e}");
            impacts += 1;
            rest += i32::from(restitution == 1.0);
        }
    }
    assert!(impacts > 200 && rest > 50, "{impacts} {rest}");
}

/// Until the first impact a run is the same to the last bit as one without contact.
#[test]
fn until_the_first_impact_nothing_changes() {
    let mut untouched = 0;
    for seed in 0..60 {
        let mut sampler = Sampler::new(seed);
        let balls = vec![Ball::default(); 1 + (seed % 3) as usize];
        let alone = Machine { balls, ..Machine::default() };
        let machine = touching(&alone, 0.36, 0.1);
        let start = apart(&machine, &mut sampler);
        let method = [Method::Switch, Method::Event][(seed % 2) as usize];
        let [mut with, mut without] =
            [&machine, &alone].map(|machine| started(machine, &start, settings(method, 1e-8)));
        let mut met = false;
        while with.time() < 200.0 && !met {
            let resets = with.advance(200.0).expect("continues");
            met = resets && widths(&machine, &with.state()).iter().any(|gap| gap.abs() < 1e-9);
            if !met {
                without.advance(200.0).expect("continues");
                assert_eq!(with.state(), without.state(), "{seed} at {}", with.time());
            }
        }
        untouched += i32::from(!met);
    }
    assert!(untouched > 5, "{untouched}");
}

/// Balls of different sizes never overlap, and keep their order; nor do eight in a nearly full ring.
#[test]
fn balls_do_not_overlap() {
    let mut closed = 0;
    for seed in 0..24 {
        let mut sampler = Sampler::new(seed);
        let speed_rad_s = sampler.one_of(&[-173.1803, -216.3772, 190.0]);
        let friction = sampler.one_of(&[0.0, 0.1, 0.3]);
        let restitution = sampler.one_of(&[0.0, 0.36, 0.8]);
        let mut machine =
            touching(&Machine { speed_rad_s, ..Machine::default() }, restitution, friction);
        machine.balls = vec![Ball::default(); 2 + (seed % 7) as usize];
        for ball in &mut machine.balls {
            ball.diameter_m *= sampler.between(0.5, 2.0);
            ball.mass_kg *= sampler.between(0.5, 4.0);
        }
        if seed % 7 == 6 {
            // Eight balls that leave three hundredths of the ring free.
            let alike = 0.97 * 2.0 * machine.ring_radius_m * (PI / 8.0).sin();
            machine.balls.iter_mut().for_each(|ball| ball.diameter_m = alike);
        }
        let start = apart(&machine, &mut sampler);
        let method = [Method::Switch, Method::Event][(seed % 2) as usize];
        let mut motion = started(&machine, &start, settings(method, 1e-8));
        while motion.time() < 150.0 {
            motion.advance(150.0).unwrap_or_else(|failure| {
                panic!("{seed}: {failure} at {} {:?}", motion.time(), motion.phases())
            });
            let least = widths(&machine, &motion.state()).into_iter().fold(f64::INFINITY, f64::min);
            assert!(least > -1e-9, "{seed}: {least:e} at {}", motion.time());
            closed += i32::from(motion.phases().contains(&Phase::Closed));
        }
    }
    assert!(closed > 1000, "{closed}");
}

/// Each impact moves the balls that rest elsewhere a little. Those that rest in touch, because one needs the force of the
/// other, rest in touch again, and the motion goes on. Impacts of balls that hardly move have one solution.
#[test]
fn balls_that_rest_in_touch_do_not_chatter() {
    let mut machine = touching(&Machine::default(), 0.0, 0.1);
    machine.balls = vec![Ball::default(); 4];
    for (ball, friction) in machine.balls.iter_mut().zip([0.002, 0.01, 0.03, 0.07]) {
        ball.friction_coefficient = friction;
    }
    for seed in 0..40 {
        let start = apart(&machine, &mut Sampler::new(seed));
        for method in [Method::Event, Method::Switch] {
            let mut motion = started(&machine, &start, settings(method, 1e-8));
            while motion.time() < 300.0 {
                motion.advance(300.0).unwrap_or_else(|failure| {
                    panic!("{seed}: {failure} at {} {:?}", motion.time(), motion.phases())
                });
            }
        }
    }
}

/// At -173.1803 rad/s 0.3844 of the positions in which the balls touch are rests, and 0.2200 without the force between them
/// (Moreau's time stepping and the inequalities for two equal balls).
#[test]
fn touching_positions_that_are_rests() {
    let machine = touching(&Machine { speed_rad_s: -173.1803, ..Machine::default() }, 0.5, 0.0);
    let angle = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
    let system =
        BallsInContact::<2>::new(&machine, &machine.contact.expect("contact"), &[0.0, 1.0]);
    let system = system.expect("two balls");
    let places = 20_000;
    let share = |rests: &dyn Fn(&[f64; 2]) -> bool| {
        let place = |k: i32| TAU * (f64::from(k) + 0.5) / f64::from(places);
        let rests = (0..places).filter(|k| rests(&[place(*k), place(*k) + angle]));
        rests.count() as f64 / f64::from(places)
    };
    let with = share(&|beta| system.rest_margin(beta) >= 0.0);
    let without = share(&|beta| rest_margin(&system.balancer, beta) >= 0.0);
    assert!((with - 0.3844).abs() < 1e-4, "{with}");
    assert!((without - 0.2200).abs() < 1e-4, "{without}");
    // The interval of forces, written out.
    let interval = share(&|beta| {
        let rest = system.balancer.rest_point(beta);
        let ball = system.balancer.balls[0];
        let (mu, m, tau) = (ball.friction.limit, ball.mass, (0.5 * angle).tan());
        let ([t_i, t_j], [f_i, f_j]) = (rest.friction, rest.normal);
        let low =
            [m * (t_i - mu * f_i) / (1.0 + mu * tau), m * (-t_j - mu * f_j) / (1.0 + mu * tau)];
        let high =
            [m * (t_i + mu * f_i) / (1.0 - mu * tau), m * (mu * f_j - t_j) / (1.0 - mu * tau)];
        low.into_iter().fold(0.0, f64::max) <= high.into_iter().fold(f64::INFINITY, f64::min)
    });
    assert_eq!(interval, with);
}

/// The rest positions converge as the speed of approach below which contact lasts goes to zero.
#[test]
fn results_converge_as_the_threshold_of_lasting_contact_vanishes() {
    let machine = touching(&Machine { speed_rad_s: -173.1803, ..Machine::default() }, 0.36, 0.1);
    let ends = |threshold: f64| -> Vec<Components> {
        let runs = (0..12).map(|seed| {
            let start = apart(&machine, &mut Sampler::new(seed));
            let contact = machine.contact.expect("contact");
            let angles = &start.0[2..4];
            let mut system = BallsInContact::<2>::new(&machine, &contact, angles).expect("two");
            system.lasting_approach = threshold;
            let state = Model::from(machine.clone()).start_state(&start).expect("a state");
            let system: Arc<dyn System> = Arc::new(system);
            let mut motion =
                Motion::new(&system, settings(Method::Switch, 1e-10), &state).expect("starts");
            go_on(&mut motion, 600.0);
            motion.state()
        });
        runs.collect()
    };
    // Below 1e-7 impacts would be nearer to each other than they are located.
    let exact = ends(1e-7);
    let error = |threshold: f64| {
        let pairs = ends(threshold).into_iter().zip(&exact);
        let angles = pairs
            .map(|(found, exact)| (found[4] - exact[4]).abs().max((found[5] - exact[5]).abs()));
        let mut angles: Vec<f64> = angles.collect();
        angles.sort_by(f64::total_cmp);
        angles[angles.len() / 2]
    };
    let errors = [1e-3, 1e-4, 1e-5, 1e-6].map(error);
    assert!(errors[3] < 1e-5 && errors[3] < 0.1 * errors[0], "{errors:?}");
}

/// Exchanging balls, and the mirror image, give the exchanged and the mirrored motion, with and without contact.
#[test]
fn exchanged_and_mirrored_motions() {
    for seed in 0..12 {
        let mut sampler = Sampler::new(seed);
        let machine = touching(&Machine::default(), 0.36, 0.1);
        let start = apart(&machine, &mut sampler);
        let [x, y, b1, b2, x_dot, y_dot, v1, v2] = start.0[..] else { panic!("eight") };
        let exchanged = Start::of_balancer([x, y], &[b2, b1], [x_dot, y_dot], &[v2, v1]);
        let mirror = |angle: f64| TAU - angle;
        let mirrored =
            Start::of_balancer([x, -y], &[mirror(b1), mirror(b2)], [x_dot, -y_dot], &[-v1, -v2]);
        for (method, contact) in
            METHODS.into_iter().flat_map(|method| [(method, machine.contact), (method, None)])
        {
            let machine = Machine { contact, ..machine.clone() };
            let back = Machine { speed_rad_s: -machine.speed_rad_s, ..machine.clone() };
            let after = |machine: &Machine, start: &Start| {
                let mut motion = started(machine, start, settings(method, 1e-11));
                go_on(&mut motion, 25.0);
                motion.unwrapped()
            };
            let straight = after(&machine, &start);
            let (other, image) = (after(&machine, &exchanged), after(&back, &mirrored));
            for ball in 0..2 {
                let exchange = (straight[ball] - other[1 - ball]).abs();
                let reflection = (straight[ball] + image[ball] - TAU).abs();
                assert!(exchange < 1e-7 && reflection < 1e-7, "{seed}: {exchange} {reflection}");
            }
        }
    }
}
