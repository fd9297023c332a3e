//! Motions while the speed of the disc changes: energy balance with the motor's work, closed forms, an independent
//! integration, and the classical result for the passage through resonance.

use std::f64::consts::TAU;

use stickslip::classification::{Instants, RecordedRun, simulate};
use stickslip::model::{
    Balancer, Ball, BallContact, Case, Forces, Machine, Method, Model, ProfilePart, Ramp,
    RampShape, Simulation, SpeedProfile, Stage, Start, State,
};
use stickslip::motion::{Motion, Phase, Tolerance};

use super::conservation::{energy, powers};
use super::samples::GAUSS;
use crate::classification::recorder::recorded;
use crate::support::settings;

/// Parts of a step over which Gauss's rule is applied.
const PARTS: usize = 4;

fn with_ramp(machine: &Machine, shape: RampShape, from: f64, to: f64, over_s: f64) -> Machine {
    let ramp = ProfilePart::Ramp(Ramp { shape, to_rad_s: None, over_s });
    let profile = SpeedProfile { start_speed_rad_s: from, parts: vec![ramp] };
    Machine { speed_rad_s: to, speed_profile: Some(profile), ..machine.clone() }
}

/// Returns the first stage of a machine with a ramp, and its motion.
fn first_stage(machine: &Machine, start: &Start, end_time_s: f64) -> (Stage, Motion) {
    let model = Model::from(machine.clone());
    let stages = model.stages(start, end_time_s).expect("balls");
    let stage = stages[0].clone();
    let state = model.start_state(start).expect("a state");
    let (state, _) = stage.entered(None, &state);
    let motion =
        Motion::new(&stage.system, settings(Method::Event, 1e-12), &state).expect("starts");
    (stage, motion)
}

/// The machine at an instant of its ramp.
struct Turning<const N: usize> {
    machine: Machine,
    balancer: Balancer<N>,
}

impl<const N: usize> Turning<N> {
    fn at(machine: &Machine, time: f64) -> Self {
        let natural = machine.natural_frequency_rad_s();
        let (segment, _) = machine.disc_motion().segments[0];
        let time_s = time / natural;
        let slope =
            segment.terms[1] + time_s * (2.0 * segment.terms[2] + 3.0 * segment.terms[3] * time_s);
        let speed_rad_s = segment.speed_rad_s(time_s);
        let machine = Machine { speed_rad_s, speed_profile: None, ..machine.clone() };
        let acceleration = Some(slope / (natural * natural));
        let balancer = Balancer { acceleration, ..Balancer::new(&machine).expect("balls") };
        Turning { machine, balancer }
    }

    /// Returns the power of dampers, friction and motor.
    fn power(&self, motion: &Motion, phases: &[Phase], state: &[f64]) -> f64 {
        let Balancer { speed, acceleration, runout, .. } = self.balancer;
        let alpha = acceleration.expect("an acceleration");
        let now: State<N> = State::of_components(&state[..4 + 2 * N]).expect("components");
        let ([x, y], [x_dot, y_dot]) = (now.position, now.velocity);
        let rates = motion.evaluator().rates(phases, state);
        let of_balls = motion.evaluator().forces(phases, state);
        // The acceleration of the ring's centre.
        let [e_x, e_y] = runout.unwrap_or_default();
        let a_x = rates[2] - 2.0 * speed * y_dot - speed * speed * (x + e_x) - alpha * (y + e_y);
        let a_y = rates[3] + 2.0 * speed * x_dot - speed * speed * (y + e_y) + alpha * (x + e_x);
        let forces = Forces {
            table_acceleration: [a_x, a_y],
            beta_ddot: std::array::from_fn(|ball| of_balls[ball].acceleration),
            normal: std::array::from_fn(|ball| of_balls[ball].normal),
            friction: std::array::from_fn(|ball| of_balls[ball].friction),
        };
        powers(&self.machine, &self.balancer, &now, &forces).iter().sum()
    }
}

/// The energy that table and balls gain in a ramp is the work of motor, dampers and friction.
#[test]
fn the_motors_work_accounts_for_the_energy_through_a_ramp() {
    let ball = |mass_kg: f64, diameter_m: f64| Ball {
        mass_kg,
        diameter_m,
        friction_coefficient: 0.05,
        ..Ball::default()
    };
    let machine = Machine { balls: vec![ball(3e-3, 3e-3), ball(1e-3, 2e-3)], ..Machine::default() };
    let start = Start::of_balancer([0.01, -0.02], &[1.0, 3.5], [0.0; 2], &[0.0; 2]);
    for (shape, from, to, over_s, ring_runout_m) in [
        (RampShape::Linear, -40.0, -216.3772, 1.0, 0.0),
        (RampShape::Smooth, -40.0, -216.3772, 0.7, 0.0),
        (RampShape::Smooth, 250.0, 30.0, 1.0, 0.0),
        (RampShape::Smooth, 250.0, 30.0, 1.0, 2e-4),
    ] {
        let machine = Machine { ring_runout_m, ring_runout_angle_rad: 2.0, ..machine.clone() };
        let machine = with_ramp(&machine, shape, from, to, over_s);
        let (stage, mut motion) = first_stage(&machine, &start, 2.0 * over_s);
        assert!(stage.is_driven && stage.ends_s == over_s);
        let end = over_s * machine.natural_frequency_rad_s();
        let at = |time: f64| Turning::<2>::at(&machine, time);
        let energy_at = |time: f64, state: &[f64]| {
            let state = State::of_components(&state[..8]).expect("components");
            let turning = at(time);
            energy(&turning.machine, &turning.balancer, &state)
        };
        let (mut work, begun) = (0.0, energy_at(0.0, &motion.state()));
        let (mut stuck, mut slipped) = (0, 0);
        while motion.time() < end {
            let from = motion.time();
            motion.advance(end).expect("continues");
            let phases = motion.phases_during_step().to_vec();
            stuck += phases.iter().filter(|phase| **phase == Phase::Stick).count();
            slipped += phases.iter().filter(|phase| matches!(phase, Phase::Slip(_))).count();
            let length = (motion.time() - from) / PARTS as f64;
            for part in 0..PARTS {
                for (node, weight) in GAUSS {
                    let time = from + (part as f64 + node) * length;
                    let Some(state) = motion.within_last_step(time) else { continue };
                    work += weight * length * at(time).power(&motion, &phases, &state);
                }
            }
        }
        let gained = energy_at(end, &motion.state()) - begun;
        assert!((gained - work).abs() < 1e-9, "{shape:?} {gained:e} {:e}", gained - work);
        assert!(gained.abs() > 1e-4 && stuck > 10 && slipped > 10, "{gained} {stuck} {slipped}");
    }
}

fn at_times(machine: &Machine, start: &Start, end_time_s: f64, times: Vec<f64>) -> RecordedRun {
    let simulation = Simulation {
        end_time_s,
        tolerance: Tolerance { relative: 1e-11, absolute: 1e-13 },
        ..Simulation::default()
    };
    let case = Case { model: machine.clone().into(), start: start.clone(), simulation };
    recorded(&case, Instants::At(times)).1
}

/// A ramp from a speed to the same speed gives the motion at constant speed.
#[test]
fn a_ramp_without_acceleration_changes_nothing() {
    let contact = Some(BallContact::default());
    let start = Start::of_balancer([0.01, 0.02], &[1.0, 4.0], [0.02, 0.0], &[0.5, -0.3]);
    for contact in [None, contact] {
        let machine = Machine { contact, ..Machine::default() };
        let speed = machine.speed_rad_s;
        let natural = machine.natural_frequency_rad_s();
        let times: Vec<f64> = (0..60).map(f64::from).collect();
        let end_time_s = 60.0 / natural;
        let constant = at_times(&machine, &start, end_time_s, times.clone());
        for shape in [RampShape::Linear, RampShape::Smooth] {
            let ramp = with_ramp(&machine, shape, speed, speed, 0.6 * end_time_s);
            let found = at_times(&ramp, &start, end_time_s, times.clone());
            assert_eq!((found.samples.len(), constant.samples.len()), (60, 60));
            for (ramped, steady) in found.samples.iter().zip(&constant.samples) {
                let [ramped_table, steady_table] =
                    [ramped, steady].map(|sample| sample.table.expect("a table"));
                for (ramped, steady) in ramped_table.iter().zip(steady_table) {
                    assert!((ramped - steady).abs() < 1e-12, "{ramped} {steady}");
                }
                for (ramped, steady) in ramped.contacts.iter().zip(&steady.contacts) {
                    assert!(
                        (ramped.position - steady.position).abs() < 1e-12,
                        "{ramped:?} {steady:?}"
                    );
                    assert!((ramped.speed - steady.speed).abs() < 1e-12, "{ramped:?} {steady:?}");
                }
            }
        }
    }
}

/// One ball of a mass that moves nothing.
fn without_balls() -> Machine {
    let ball = Ball { mass_kg: 1e-15, ..Ball::default() };
    Machine { balls: vec![ball], ..Machine::default() }
}

/// Integrates the unbalanced table in the frame at rest, `Z̈ + 2ζ Ż + Z = m_I e (φ̇² - i φ̈) e^{iφ}`, by the classical
/// Runge-Kutta method with small steps. Returns the positions in the turning frame after every `every` steps.
fn in_the_frame_at_rest(
    balancer: &Balancer<1>,
    angle: impl Fn(f64) -> [f64; 3],
    (step, steps, every): (f64, usize, usize),
) -> Vec<[f64; 2]> {
    let rate = |time: f64, [x, y, u, v]: [f64; 4]| {
        let [phi, speed, acceleration] = angle(time);
        let (s, c) = phi.sin_cos();
        let (radial, tangential) = (speed * speed, acceleration);
        let drag = 2.0 * balancer.damping_ratio;
        let force = balancer.imbalance;
        [
            u,
            v,
            force * (radial * c + tangential * s) - x - drag * u,
            force * (radial * s - tangential * c) - y - drag * v,
        ]
    };
    let mut state = [0.0; 4];
    let mut found = Vec::new();
    for number in 0..=steps {
        let time = number as f64 * step;
        if number % every == 0 {
            let (s, c) = angle(time)[0].sin_cos();
            found.push([state[0] * c + state[1] * s, state[1] * c - state[0] * s]);
        }
        let add = |by: f64, rates: [f64; 4]| {
            std::array::from_fn(|component| state[component] + by * rates[component])
        };
        let k1 = rate(time, state);
        let k2 = rate(time + 0.5 * step, add(0.5 * step, k1));
        let k3 = rate(time + 0.5 * step, add(0.5 * step, k2));
        let k4 = rate(time + step, add(step, k3));
        state = std::array::from_fn(|k| {
            state[k] + step / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k])
        });
    }
    found
}

/// The run-up of the unbalanced table through resonance agrees with an integration in the frame at rest.
#[test]
fn the_run_up_through_resonance_agrees_with_an_independent_integration() {
    let over_s = 1.2;
    for shape in [RampShape::Linear, RampShape::Smooth] {
        let machine = with_ramp(&without_balls(), shape, -20.0, -250.0, over_s);
        let natural = machine.natural_frequency_rad_s();
        let disc = machine.disc_motion();
        let angle = |time: f64| {
            let time_s = time / natural;
            let (segment, before) = disc.segments[usize::from(time_s > over_s)];
            let after = time_s - segment.begins_s;
            let [_, b, c, d] = segment.terms;
            let slope = b + after * (2.0 * c + 3.0 * d * after);
            let turned = (before + segment.turned_rad(after)) % TAU;
            [turned, segment.speed_rad_s(after) / natural, slope / (natural * natural)]
        };
        let balancer = Balancer::<1>::new(&machine).expect("one ball");
        let (step, every) = (5e-3, 200);
        let steps = (1.5 * over_s * natural / step) as usize;
        let expected = in_the_frame_at_rest(&balancer, angle, (step, steps, every));
        let times = (0..expected.len()).map(|k| k as f64 * step * every as f64).collect();
        let start = Start::of_balancer([0.0; 2], &[0.0], [0.0; 2], &[0.0]);
        let found = at_times(&machine, &start, 1.6 * over_s, times);
        assert_eq!(found.samples.len(), expected.len());
        let largest = expected.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        for (sample, [x, y]) in found.samples.iter().zip(&expected) {
            let table = sample.table.expect("a table");
            let off = (table[0] - x).hypot(table[1] - y);
            assert!(off < 1e-6 * largest, "{shape:?} {} {off:e} {largest:e}", sample.time);
        }
    }
}

/// Returns the largest amplitude over that of the imbalance, and its speed over the natural frequency, in a run-up without
/// damping whose acceleration is `acceleration` times the square of the natural frequency.
fn peak_of_run_up(acceleration: f64) -> [f64; 2] {
    let machine = Machine { damping_n_s_m: 0.0, ..without_balls() };
    let natural = machine.natural_frequency_rad_s();
    let (from, to) = (0.2 * natural, 1.8 * natural);
    let over_s = (to - from) / (acceleration * natural * natural);
    let machine = with_ramp(&machine, RampShape::Linear, from, to, over_s);
    let start = Start::of_balancer([0.0; 2], &[0.0], [0.0; 2], &[0.0]);
    let simulation = Simulation { end_time_s: over_s + 0.01, ..Simulation::default() };
    let outcome = simulate(&Case { model: machine.clone().into(), start, simulation });
    let peak = outcome.peak.expect("a peak");
    let unit = machine.imbalance_mass_kg / machine.total_mass_kg() * machine.imbalance_radius_m;
    let speed = machine.disc_motion().speed_rad_s(peak.time_s) / natural;
    [peak.amplitude_m / unit, speed]
}

/// The passage through resonance without damping (F. M. Lewis, Trans. ASME 54 (1932) 253): for a small acceleration `h`
/// over the square of the natural frequency, the amplitude follows Cornu's spiral. It is largest, `1.4671 / sqrt(h)`
/// times that of a slow rotation, at the speed `1 + 2.1574 sqrt(h)` (the first maximum of the Fresnel integrals).
#[test]
fn the_peak_of_a_run_up_is_that_of_lewis() {
    let off = [4e-4_f64, 1e-4].map(|acceleration| {
        let root = acceleration.sqrt();
        let [amplitude, speed] = peak_of_run_up(acceleration);
        [amplitude * root / 1.4671 - 1.0, (speed - 1.0) / root / 2.1574 - 1.0]
    });
    // The deviation of the amplitude is of first order in the root: the force grows with the speed.
    assert!(off.iter().all(|[amplitude, speed]| amplitude.abs() < 0.02 && speed.abs() < 5e-3));
    assert!((off[0][0] / off[1][0] - 2.0).abs() < 0.1, "{off:?}");
}

/// A ball that sticks breaks loose exactly where friction no longer holds it against the table's and its own inertia.
#[test]
fn a_ball_breaks_loose_where_friction_no_longer_holds_it() {
    let ball = |friction_coefficient| Ball { friction_coefficient, ..Ball::default() };
    let machine = Machine { balls: vec![ball(0.01), ball(0.2)], ..Machine::default() };
    let mut broken = 0;
    for (shape, over_s) in [(RampShape::Linear, 1.5), (RampShape::Smooth, 1.0)] {
        let machine = with_ramp(&machine, shape, -120.0, -216.3772, over_s);
        let start = Start::of_balancer([0.0; 2], &[1.0, 4.0], [0.0; 2], &[0.0; 2]);
        let (_, mut motion) = first_stage(&machine, &start, 2.0 * over_s);
        let end = over_s * machine.natural_frequency_rad_s();
        // Returns what is left of the friction of each ball while both stick.
        let reserve = |time: f64, state: &[f64]| -> [f64; 2] {
            let turning = Turning::<2>::at(&machine, time);
            let Balancer { speed, acceleration, damping_ratio, imbalance, balls, .. } =
                turning.balancer;
            let alpha = acceleration.expect("an acceleration");
            let [x, y, x_dot, y_dot] = [state[0], state[1], state[2], state[3]];
            let drag = 2.0 * damping_ratio;
            let mut a_x = imbalance * speed * speed - x - drag * (x_dot - speed * y);
            let mut a_y = -imbalance * alpha - y - drag * (y_dot + speed * x);
            let turned = [4, 5].map(|place| state[place].sin_cos());
            for (ball, (s, c)) in balls.iter().zip(turned) {
                a_x += ball.mass * (s * alpha + c * speed * speed);
                a_y += ball.mass * (s * speed * speed - c * alpha);
            }
            std::array::from_fn(|i| {
                let ((s, c), ball) = (turned[i], &balls[i]);
                let lever = 1.0 - 2.0 * ball.inertia * ball.diameter;
                let needed = s * a_x - c * a_y - lever * alpha;
                let normal = speed * speed - c * a_x - s * a_y;
                ball.friction.limit * normal - needed.abs()
            })
        };
        while motion.time() < end {
            motion.advance(end).expect("continues");
            if motion.phases_during_step() != [Phase::Stick; 2] {
                break;
            }
            let state =
                motion.before_switch().map_or_else(|| motion.state(), |before| before.state);
            let left = reserve(motion.time(), &state);
            if motion.phases() == [Phase::Stick; 2] {
                assert!(left.iter().all(|left| *left > -1e-12), "{left:?}");
            } else {
                assert!(left[0].abs() < 1e-9 && left[1] > 1e-3, "{left:?}");
                broken += 1;
                break;
            }
        }
    }
    assert_eq!(broken, 2);
}
