use std::sync::Arc;
use stickslip::model::*;
use stickslip::motion::*;

fn settings() -> Settings {
    Settings { method: Method::Switch, band: 1e-8, tolerance: Tolerance { relative: 1e-8, absolute: 1e-10 }, effort_limit: 100_000_000 }
}

fn main() {
    let which: Vec<String> = std::env::args().collect();
    match which[1].as_str() {
        "pair" => {
            for (speed, mu) in [(-247.3, 0.0), (-247.3, 0.1), (-247.3, 0.2), (-309.15, 0.0), (-309.15, 0.1), (-216.3772, 0.0)] {
                let machine = Machine { speed_rad_s: speed, contact: Some(BallContact { restitution: 0.5, friction_coefficient: mu }), ..Machine::default() };
                let delta = machine.contact_angle_rad(&machine.balls[0], &machine.balls[1]);
                let natural = machine.natural_frequency_rad_s();
                let run = -speed / natural - 1.0;
                let start = Start::of_balancer([0.0, 0.0], &[1.0, 1.0 + delta + 1e-6], [0.0, 0.0], &[run, run]);
                let model = Model::from(machine);
                let system = model.system_for(&start).unwrap();
                let state = model.start_state(&start).unwrap();
                let mut motion = Motion::new(&system, settings(), &state).unwrap();
                let end = 30.0 * natural;
                let mut half = None;
                let mut events = 0;
                while motion.time() < end {
                    let before: Phases = motion.phases().into();
                    if let Err(e) = motion.advance(end) { println!("failed at {} {e} {:?}", motion.time(), motion.phases()); break; }
                    if motion.phases() != &before[..] { events += 1; if events < 12 { println!("{:.6} {:?} -> {:?} {:?}", motion.time(), before, motion.phases(), motion.state()); } }
                    if half.is_none() && motion.time() > end / 2.0 { half = Some((motion.time(), motion.unwrapped())); }
                }
                let (t, b) = half.unwrap_or((0.0, motion.unwrapped()));
                let now = motion.unwrapped();
                println!("speed {speed} mu {mu}: mean {:?} rad/s, {:?} steps {:?}, events {events}", (0..2).map(|i| (now[i] - b[i]) / (motion.time() - t) * natural).collect::<Vec<_>>(), motion.phases(), motion.effort());
            }
        }
        _ => {}
    }
    let _: Option<Arc<dyn System>> = None;
}
