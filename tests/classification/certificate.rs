//! The rest certificate: certified balls never move again.

use proptest::prelude::*;
use stickslip::model::{Balancer, Machine, Method, State, certified, certified_by_closed_form};
use stickslip::motion::{Phase, Settings, Tolerance};

use crate::support::{for_each_kernel, started};

fn state(balancer: &Balancer<2>, beta: [f64; 2], far: f64, direction: [f64; 2]) -> State<2> {
    let rest = balancer.rest_point(&beta);
    let (s, c) = direction[0].sin_cos();
    let (t, d) = direction[1].sin_cos();
    State {
        position: [rest.position[0] + far * c, rest.position[1] + far * s],
        velocity: [far * d, far * t],
        beta,
        beta_dot: [0.0; 2],
    }
}

/// Returns whether a ball ever leaves stick in the further motion, on which both kernels agree.
fn ever_moves(balancer: &Balancer<2>, state: State<2>) -> bool {
    let settings = Settings {
        method: Method::Switch,
        band: 1e-4,
        tolerance: Tolerance { relative: 1e-10, absolute: 1e-12 },
        effort_limit: 1_000_000,
    };
    let end = 30.0 / balancer.damping_ratio.max(0.01);
    let [tuned, general] = for_each_kernel(*balancer).map(|system| {
        let mut motion = started(&system, settings, &state);
        loop {
            if motion.phases().iter().any(|phase| *phase != Phase::Stick) {
                return true;
            }
            if motion.time() >= end {
                return false;
            }
            motion.advance(end).expect("continues");
        }
    });
    assert_eq!(tuned, general);
    tuned
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// States certified by either certificate stay at rest, and the closed form certifies at least
    /// the states that the bound does.
    #[test]
    fn certified_balls_never_move(
        speed in -400.0..400.0_f64, damping in 0.3..30.0_f64, friction in 1e-3..0.05_f64,
        beta in prop::array::uniform2(0.0..std::f64::consts::TAU), far in -5.0..-1.5_f64,
        direction in prop::array::uniform2(0.0..std::f64::consts::TAU),
    ) {
        let mut machine = Machine { speed_rad_s: speed, damping_n_s_m: damping, ..Machine::default() };
        machine.balls.iter_mut().for_each(|ball| ball.friction_coefficient = friction);
        let balancer = Balancer::<2>::new(&machine).expect("two balls");
        let state = state(&balancer, beta, 10_f64.powf(far), direction);
        let rest = balancer.rest_point(&beta);
        let by_bound = certified(&balancer, &rest, &state);
        let by_closed_form = certified_by_closed_form(&balancer, &rest, &state);
        prop_assert!(by_closed_form || !by_bound);
        if by_closed_form {
            prop_assert!(!ever_moves(&balancer, state));
        }
    }
}

/// The closed form certifies states that the bound cannot, and rejects states in which a ball
/// breaks loose: a scan of amplitudes contains both, without errors.
#[test]
fn closed_form_is_sharper_than_the_bound() {
    let balancer = Balancer::<2>::new(&Machine::default()).expect("two balls");
    let (mut sharper, mut refused) = (0, 0);
    for k in 0..200 {
        let beta = [2.27, 4.01];
        let far = 3e-3 * 1.0025_f64.powi(k);
        let state = state(&balancer, beta, far, [0.7, 2.0]);
        let rest = balancer.rest_point(&beta);
        let by_closed_form = certified_by_closed_form(&balancer, &rest, &state);
        sharper += i32::from(by_closed_form && !certified(&balancer, &rest, &state));
        if !by_closed_form {
            refused += i32::from(ever_moves(&balancer, state));
        }
    }
    assert!(sharper > 3 && refused > 3, "{sharper} {refused}");
}
