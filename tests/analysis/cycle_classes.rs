//! Classes of limit cycles: equivalent cycles, and only those, have the same class.

use crate::support::Block;
use proptest::prelude::*;
use stickslip::analysis::{CycleClass, Role, groups_of_identical};
use stickslip::classification::{
    ClosedOrbit, Cycle, CyclePhase, Evidence, Outcome, Rest, TouchingPair,
};
use stickslip::model::{Balancer, Ball, Machine, Model, State};
use stickslip::motion::{Direction, Phase};

use crate::support::reference::derivative;

/// A ball's part in a random cycle.
#[derive(Clone, Debug)]
struct Part {
    kind: u8,
    turns: i32,
    letters: Vec<CyclePhase>,
    angle: f64,
}

/// A machine and a cycle on it.
#[derive(Clone, Debug)]
struct Sample {
    machine: Machine,
    cycle: Cycle,
    angles: Vec<f64>,
}

/// Returns the evidence of a run on a cycle.
fn on(cycle: Cycle) -> Evidence {
    Evidence::ClosedOrbit(ClosedOrbit { cycle: Some(Box::new(cycle)), ..ClosedOrbit::default() })
}

impl Sample {
    fn class(&self) -> CycleClass {
        let evidence = on(self.cycle.clone());
        let outcome = Outcome { position: Some(self.angles.clone()), ..Outcome::of(evidence) };
        CycleClass::of(&self.machine.clone().into(), &outcome).expect("a cycle")
    }

    /// Returns the same motion with the balls in another order.
    fn in_order(&self, order: &[usize]) -> Sample {
        let mut other = self.clone();
        for (place, &ball) in order.iter().enumerate() {
            other.machine.balls[place] = self.machine.balls[ball];
            other.cycle.turns[place] = self.cycle.turns[ball];
            other.cycle.speed_extremes[place] = self.cycle.speed_extremes[ball];
            other.angles[place] = self.angles[ball];
            for (cycle_phases, before) in
                other.cycle.configurations.iter_mut().zip(&self.cycle.configurations)
            {
                cycle_phases[place] = before[ball];
            }
        }
        other
    }

    /// Returns the mirror image, with a disc that turns in the opposite direction.
    fn mirrored(&self) -> Sample {
        let mut other = self.clone();
        other.machine.speed_rad_s = -self.machine.speed_rad_s;
        other.angles.iter_mut().for_each(|angle| *angle = std::f64::consts::TAU - *angle);
        other.cycle.turns.iter_mut().for_each(|turns| *turns = -*turns);
        for extremes in &mut other.cycle.speed_extremes {
            *extremes = [-extremes[1], -extremes[0]];
        }
        for cycle_phase in other.cycle.configurations.iter_mut().flatten() {
            *cycle_phase = match cycle_phase {
                CyclePhase::Stick | CyclePhase::Apart => *cycle_phase,
                CyclePhase::Forward => CyclePhase::Backward,
                CyclePhase::Backward => CyclePhase::Forward,
            };
        }
        other
    }
}

/// Returns a cycle that attracts, with other values of 0.
pub fn cycle(turns: Vec<i32>, configurations: Vec<Vec<CyclePhase>>) -> Cycle {
    let balls = turns.len();
    Cycle {
        turns,
        configurations,
        touching: Vec::new(),
        speed_extremes: vec![[0.0; 2]; balls],
        position_extremes: vec![None; balls],
        stick_fraction: vec![0.0; balls],
        peak_amplitude_m: 0.0,
        multipliers: Vec::new(),
        neutral_directions: 0,
    }
}

fn cycle_phase() -> impl Strategy<Value = CyclePhase> {
    prop::sample::select(vec![CyclePhase::Stick, CyclePhase::Forward, CyclePhase::Backward])
}

/// Balls of two kinds that rest, run, or switch, with so few options that equal classes are common.
fn sample(most_balls: usize, most_letters: usize) -> impl Strategy<Value = Sample> {
    let parts = (1..=most_balls, 1..=most_letters).prop_flat_map(|(balls, letters)| {
        let switching = (Just(0), -1..=1, prop::collection::vec(cycle_phase(), letters));
        let running = (Just(0), prop::sample::select(vec![-2, -1, 1]), cycle_phase());
        let part = prop_oneof![
            Just((0, 0, vec![CyclePhase::Stick; letters])),
            running.prop_map(move |(kind, turns, cycle_phase)| {
                let cycle_phase = if cycle_phase == CyclePhase::Stick {
                    CyclePhase::Forward
                } else {
                    cycle_phase
                };
                (kind, turns, vec![cycle_phase; letters])
            }),
            switching,
        ];
        prop::collection::vec((part, 0..2_u8, 0.0..6.0_f64), balls)
    });
    (parts, any::<bool>()).prop_map(|(parts, backwards)| {
        let parts: Vec<Part> = parts
            .into_iter()
            .map(|((_, turns, letters), kind, angle)| Part { kind, turns, letters, angle })
            .collect();
        let ball = |kind: u8| Ball { mass_kg: 1e-4 * f64::from(1 + kind), ..Ball::default() };
        let letters = parts[0].letters.len();
        let configuration = |step| parts.iter().map(|part: &Part| part.letters[step]).collect();
        Sample {
            machine: Machine {
                balls: parts.iter().map(|part| ball(part.kind)).collect(),
                speed_rad_s: if backwards { -200.0 } else { 200.0 },
                ..Machine::default()
            },
            cycle: Cycle {
                // A unique value per ball, by which the test identifies it.
                speed_extremes: parts.iter().map(|part| [-part.angle, part.angle]).collect(),
                peak_amplitude_m: 1e-4,
                multipliers: vec![0.5],
                ..cycle(
                    parts.iter().map(|part| part.turns).collect(),
                    (0..letters).map(configuration).collect(),
                )
            },
            angles: parts.iter().map(|part| part.angle).collect(),
        }
    })
}

/// Returns all orders of the numbers below a count.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let shorter = orders(count - 1);
    let inserted = |order: &Vec<usize>| {
        (0..count).map(|at| [&order[..at], &[count - 1], &order[at..]].concat()).collect::<Vec<_>>()
    };
    shorter.iter().flat_map(inserted).collect()
}

/// Returns the orders in which every ball takes the place of an identical ball.
fn orders_of_alike(balls: &[Ball]) -> Vec<Vec<usize>> {
    let mut orders = orders(balls.len());
    orders.retain(|order| order.iter().enumerate().all(|(i, &ball)| balls[i] == balls[ball]));
    orders
}

/// Returns the periodic sequence of phases of all balls; a ball that runs without stopping has its
/// direction in its turns and no phase.
fn circle(sample: &Sample) -> Vec<Vec<Option<CyclePhase>>> {
    let configurations = &sample.cycle.configurations;
    let constant = |ball: usize| {
        configurations.iter().all(|cycle_phases| cycle_phases[ball] == configurations[0][ball])
    };
    let shown = |cycle_phases: &Vec<CyclePhase>| {
        let of_ball = |(ball, &cycle_phase): (usize, &CyclePhase)| {
            (!constant(ball) || cycle_phase == CyclePhase::Stick).then_some(cycle_phase)
        };
        cycle_phases.iter().enumerate().map(of_ball).collect::<Vec<_>>()
    };
    let steps: Vec<_> = configurations.iter().map(shown).collect();
    let before = |step: usize| &steps[(step + steps.len() - 1) % steps.len()];
    let changes: Vec<_> = (0..steps.len()).filter(|&step| steps[step] != *before(step)).collect();
    if changes.is_empty() {
        return steps[..1].to_vec();
    }
    changes.into_iter().map(|step| steps[step].clone()).collect()
}

/// Returns by brute force whether two samples have equivalent cycles: some order of identical
/// balls, some start of the period and, for opposite directions of the disc, the mirror image make
/// them equal.
fn same(a: &Sample, b: &Sample) -> bool {
    let b = if a.machine.speed_rad_s == b.machine.speed_rad_s { b.clone() } else { b.mirrored() };
    if a.machine.balls != b.machine.balls {
        return false;
    }
    let goal = circle(a);
    orders_of_alike(&a.machine.balls).iter().any(|order| {
        let b = b.in_order(order);
        let mut found = circle(&b);
        let begun = |_| {
            found.rotate_left(1);
            found == goal
        };
        // A ball that rests has no turns to count.
        let turns = |sample: &Sample| -> Vec<Option<i32>> {
            let turns = sample.cycle.turns.iter().enumerate();
            turns.map(|(ball, &turns)| (!sample.cycle.rests(ball)).then_some(turns)).collect()
        };
        turns(a) == turns(&b) && (0..goal.len()).any(begun)
    })
}

/// Parses a class's text.
fn read(name: &str) -> Vec<Role> {
    let letter = |letter: char| match letter {
        'S' => CyclePhase::Stick,
        'F' => CyclePhase::Forward,
        'B' => CyclePhase::Backward,
        other => panic!("{other}"),
    };
    let part = |part: &str| {
        if part == "rest" {
            return Role { turns: 0, letters: Vec::new(), rests: true };
        }
        let (turns, letters) = part.split_once(':').unwrap_or((part, ""));
        let turns = turns.parse().expect("a whole number");
        Role { turns, letters: letters.chars().map(letter).collect(), rests: false }
    };
    name.split('|').map(part).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// Starting the period elsewhere (also within a phase), reordering identical balls, or
    /// mirroring does not change the class; and the class names the balls in its places.
    #[test]
    fn what_makes_no_difference(
        first in sample(4, 6),
        (by, pick) in (0..6_usize, any::<prop::sample::Index>()),
    ) {
        let class = first.class();
        let mut begun = first.clone();
        let steps = begun.cycle.configurations.len();
        begun.cycle.configurations.rotate_left(by % steps);
        prop_assert_eq!(&begun.class(), &class);
        let again = begun.cycle.configurations[0].clone();
        begun.cycle.configurations.push(again);
        prop_assert_eq!(&begun.class(), &class);
        prop_assert_eq!(&first.mirrored().class().name, &class.name);
        prop_assert_eq!(&first.mirrored().class().roles, &class.roles);

        let all = orders_of_alike(&first.machine.balls);
        let order = pick.get(&all);
        let reordered = first.in_order(order).class();
        prop_assert_eq!(&reordered.name, &class.name);
        // The same balls in the same places, whatever their numbers.
        let found: Vec<usize> = reordered.balls.iter().map(|&ball| order[ball]).collect();
        prop_assert_eq!(&found, &class.balls);

        prop_assert_eq!(&read(&class.name), &class.roles);
        for (place, &ball) in class.balls.iter().enumerate() {
            prop_assert_eq!(first.machine.balls[place], first.machine.balls[ball]);
            prop_assert_eq!(class.roles[place].rests, first.cycle.rests(ball));
        }
        for group in groups_of_identical(&first.machine.balls) {
            for pair in group.windows(2) {
                let [first, second] = [pair[0], pair[1]].map(|place| &class.roles[place]);
                prop_assert!(first.rests <= second.rests);
                let both_move = !first.rests && !second.rests;
                prop_assert!(!both_move || first.turns.abs() >= second.turns.abs());
            }
        }
    }

    /// Two cycles have the same class if and only if they are equivalent by brute force.
    #[test]
    fn what_makes_a_difference(mut first in sample(2, 3), second in sample(2, 3)) {
        prop_assume!(first.machine.balls.len() == second.machine.balls.len());
        first.machine.balls.clone_from(&second.machine.balls);
        prop_assert_eq!(
            first.class().name == second.class().name,
            same(&first, &second),
            "{} {}", first.class().name, second.class().name
        );
    }
}

/// Random pairs are equivalent often enough for the property above to be meaningful.
#[test]
fn brute_force_finds_both() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let (mut equal, all) = (0, 2000);
    for _ in 0..all {
        let pair = (sample(2, 3), sample(2, 3)).new_tree(&mut runner).expect("a pair").current();
        let (mut first, second) = pair;
        if first.machine.balls.len() == second.machine.balls.len() {
            first.machine.balls.clone_from(&second.machine.balls);
            equal += usize::from(same(&first, &second));
        }
    }
    assert!((50..1000).contains(&equal), "{equal}");
}

fn named(speed_rad_s: f64, alike: bool, balls: &[(i32, &[CyclePhase])]) -> CycleClass {
    let masses = [1.4e-4, if alike { 1.4e-4 } else { 2e-4 }];
    let steps = balls.iter().map(|(_, cycle_phases)| cycle_phases.len()).max().expect("balls");
    let at = |step: usize| {
        balls.iter().map(|(_, cycle_phases)| cycle_phases[step % cycle_phases.len()]).collect()
    };
    Sample {
        machine: Machine {
            speed_rad_s,
            balls: (0..balls.len())
                .map(|ball| Ball { mass_kg: masses[ball.min(1)], ..Ball::default() })
                .collect(),
            ..Machine::default()
        },
        cycle: cycle(balls.iter().map(|&(turns, _)| turns).collect(), (0..steps).map(at).collect()),
        angles: (0..balls.len()).map(|ball| 3.0 - ball as f64).collect(),
    }
    .class()
}

/// Classes say which balls touch; of identical balls with the same role, any order gives the same class.
#[test]
fn classes_say_which_balls_touch() {
    let balls = |turns: &[i32], angles: &[f64], touching: &[([usize; 2], bool)]| {
        let phase =
            |turns: &i32| if *turns == 0 { CyclePhase::Stick } else { CyclePhase::Backward };
        let pair = |(contacts, throughout): &([usize; 2], bool)| TouchingPair {
            contacts: *contacts,
            throughout: *throughout,
        };
        let sample = Sample {
            machine: Machine {
                speed_rad_s: 247.3,
                balls: vec![Ball::default(); turns.len()],
                ..Machine::default()
            },
            cycle: Cycle {
                touching: touching.iter().map(pair).collect(),
                speed_extremes: angles.iter().map(|angle| [-angle, *angle]).collect(),
                ..cycle(turns.to_vec(), vec![turns.iter().map(phase).collect()])
            },
            angles: angles.to_vec(),
        };
        sample.class()
    };
    assert_eq!(balls(&[-1, -1], &[1.0, 2.0], &[([0, 1], true)]).name, "-1|-1;touch:1-2");
    assert_eq!(balls(&[-1, 0], &[1.0, 2.0], &[([0, 1], false)]).name, "-1|rest;meet:1-2");
    let mut classes = Vec::new();
    for order in orders(4) {
        // Two of three running balls touch, and the third one meets a ball that rests.
        let (turns, angles) = ([-1, -1, -1, 0], [0.1, 0.2, 0.3, 0.4]);
        let place = |ball: usize| {
            order.iter().position(|placed| *placed == ball).expect("each ball is placed")
        };
        let pair = |first: usize, second: usize| {
            let (first, second) = (place(first), place(second));
            [first.min(second), first.max(second)]
        };
        let turns: Vec<i32> = order.iter().map(|ball| turns[*ball]).collect();
        let angles: Vec<f64> = order.iter().map(|ball| angles[*ball]).collect();
        classes.push(balls(&turns, &angles, &[(pair(0, 2), true), (pair(1, 3), false)]));
    }
    for class in &classes {
        assert_eq!(class.name, "-1|-1|-1|rest;touch:1-2;meet:3-4");
    }
}

#[test]
fn classes_by_name() {
    use CyclePhase::{Backward as B, Forward as F, Stick as S};
    let name = |speed, alike, balls: &[(i32, &[CyclePhase])]| named(speed, alike, balls).name;
    // At -247.3 rad/s a ball that goes round in the positive sense falls back.
    assert_eq!(name(-247.3, true, &[(0, &[S]), (1, &[F])]), "-1|rest");
    assert_eq!(name(247.3, true, &[(-1, &[B]), (0, &[S])]), "-1|rest");
    assert_eq!(name(-247.3, false, &[(0, &[S]), (1, &[F])]), "rest|-1");
    assert_eq!(name(247.3, true, &[(1, &[F]), (-1, &[B])]), "-1|1");
    assert_eq!(name(247.3, true, &[(-1, &[B]), (-1, &[B])]), "-1|-1");
    assert_eq!(name(247.3, true, &[(0, &[F, S, B, S]), (-1, &[B])]), "-1|0:SFSB");
    // Whether one ball sticks while the other does is part of the class.
    let together: [(i32, &[CyclePhase]); 2] = [(0, &[S, F, B]), (0, &[S, F, B])];
    let apart: [(i32, &[CyclePhase]); 2] = [(0, &[S, F, B]), (0, &[F, B, S])];
    assert_eq!(name(1.0, true, &together), "0:SFB|0:SFB");
    assert_eq!(name(1.0, true, &apart), "0:SFB|0:FBS");
    // Balls that rest stand in the order of their angles, 3, 2 and 1 rad.
    let two_rest = named(247.3, true, &[(0, &[S]), (-1, &[B]), (0, &[S])]);
    assert_eq!((two_rest.name.as_str(), two_rest.balls), ("-1|rest|rest", vec![1, 2, 0]));
}

/// Of all sign changes of x, y, angles and time, combined with a rotation of all angles by π and an
/// exchange of x and y, only the identity maps solutions of the equations of motion to solutions at
/// the same speed, and only the mirror image at the opposite speed.
#[test]
fn the_mirror_image_is_the_only_symmetry() {
    let machine = |speed_rad_s| Machine { speed_rad_s, ..Machine::default() };
    let at = |speed| Balancer::<2>::new(&machine(speed)).expect("two balls");
    let state = State {
        position: [0.01, -0.023],
        velocity: [0.017, 0.029],
        beta: [0.7, 2.9],
        beta_dot: [0.4, -0.3],
    };
    let slips = |state: &State<2>| state.beta_dot.map(|speed| Phase::Slip(Direction::of(speed)));
    let moved =
        |balancer: &Balancer<2>, state: &State<2>| derivative(balancer, &slips(state), state);
    let before = moved(&at(-247.3), &state);
    let signs = [1.0, -1.0];
    let mut found = Vec::new();
    for (other, exchange) in [(-247.3, false), (247.3, false), (-247.3, true), (247.3, true)] {
        for (sign_x, sign_y) in signs.into_iter().flat_map(|x| signs.map(|y| (x, y))) {
            for (sign, time) in signs.into_iter().flat_map(|beta| signs.map(|time| (beta, time))) {
                for shift in [0.0, 0.5, 1.0, 1.5].map(|part| part * std::f64::consts::PI) {
                    let plane = |[x, y]: [f64; 2]| {
                        let [x, y] = if exchange { [y, x] } else { [x, y] };
                        [sign_x * x, sign_y * y]
                    };
                    let image = State {
                        position: plane(state.position),
                        velocity: plane(state.velocity).map(|speed| time * speed),
                        beta: state.beta.map(|angle| sign * angle + shift),
                        beta_dot: state.beta_dot.map(|speed| time * sign * speed),
                    };
                    let after = moved(&at(other), &image);
                    let expected =
                        plane(before.velocity).into_iter().chain(before.beta_dot.map(|a| sign * a));
                    let accelerations = after.velocity.into_iter().chain(after.beta_dot);
                    if accelerations.zip(expected).all(|(a, b)| (a - b).abs() < 1e-9) {
                        found.push((other, exchange, [sign_x, sign_y, sign, time], shift));
                    }
                }
            }
        }
    }
    let identity = (-247.3, false, [1.0; 4], 0.0);
    let mirror = (247.3, false, [1.0, -1.0, -1.0, 1.0], 0.0);
    assert_eq!(found, [identity, mirror]);
}

/// Runs without evidence of a cycle have no class; evidence without cycle data, or with the cycle
/// data of another machine, has the class `unknown`.
#[test]
fn unknown_and_none() {
    let model: Model = Machine::default().into();
    let unstable = Evidence::UnstableOrbit(Box::new(cycle(vec![0], Vec::new())));
    assert_eq!(CycleClass::of(&model, &Outcome::of(unstable)), None);
    let rest = Evidence::RestCertified(Rest::default());
    assert_eq!(CycleClass::of(&model, &Outcome::of(rest)), None);
    let bare = Outcome::of(Evidence::ClosedOrbit(ClosedOrbit::default()));
    let unknown = CycleClass::of(&model, &bare).expect("a claim");
    assert_eq!((unknown.name.as_str(), unknown.roles.len()), (CycleClass::UNKNOWN, 0));
    let block = Block::on_belt();
    let phases = [CyclePhase::Backward, CyclePhase::Stick].map(|phase| vec![phase]);
    let cycle = Cycle {
        speed_extremes: vec![[-1.0, 0.0]],
        multipliers: vec![0.0],
        ..cycle(vec![0], phases.to_vec())
    };
    let outcome = Outcome { position: Some(vec![0.0]), ..Outcome::of(on(cycle)) };
    let of = |model: &Model| CycleClass::of(model, &outcome).expect("a claim").name;
    assert_eq!(of(&block.into()), "0:SB");
    assert_eq!(of(&model), CycleClass::UNKNOWN);
}
