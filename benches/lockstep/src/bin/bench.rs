#![forbid(unsafe_code)]
use fearless_simd::{Level, Simd, f64x8, prelude::*};
use lockstep_prototype::equations::{Ball, N, Phase, Vector};
use lockstep_prototype::sincos::sin_cos;
use lockstep_prototype::step::{Tolerance, Tried, attempt};
use std::hint::black_box;
use std::time::Instant;
use stickslip::model::{Balancer, Contact, Machine, State};

pub fn phase<S: Simd>(simd: S, b: &Balancer<2>, direction: [f64; 2], free: [f64; 2]) -> Phase<S> {
    let c = |v: f64| f64x8::splat(simd, v);
    let o = b.speed;
    Phase {
        omega: c(o),
        two_omega: c(2.0 * o),
        omega_squared: c(o * o),
        drag: c(2.0 * b.damping_ratio),
        drag_omega: c(2.0 * b.damping_ratio * o),
        imbalance: c(b.imbalance * o * o),
        balls: std::array::from_fn(|i| {
            let ball = &b.balls[i];
            Ball {
                mass: c(ball.mass),
                mobility: c(ball.mobility * free[i]),
                mobile_mass: c(ball.mass * ball.mobility * free[i]),
                friction: c(ball.friction.coefficient * direction[i] * free[i]),
                rolling_linear: c(-ball.rolling_linear),
                rolling_quadratic: c(-ball.rolling_quadratic),
            }
        }),
    }
}

#[inline(always)]
fn rhs_chain<S: Simd, const M: usize>(
    simd: S,
    b: &Balancer<2>,
    starts: &[[f64; 8]; 8],
    n: usize,
) -> f64 {
    // dependent chain as in a stage: state' = start + h k; M independent chains
    let phases: [Phase<S>; M] = [phase(simd, b, [1.0, -1.0], [1.0; 2]); M];
    let start: Vector<S> = std::array::from_fn(|i| f64x8::from_fn(simd, |lane| starts[lane][i]));
    let mut ks = [start; M];
    let h = f64x8::splat(simd, 0.1);
    for _ in 0..n {
        for m in 0..M {
            let mut state = start;
            for i in 0..N {
                state[i] = h.mul_add_precise(ks[m][i], start[i]);
            }
            phases[m].derivative(&state, &mut ks[m]);
        }
    }
    let mut sum = 0.0;
    for k in ks {
        for v in k {
            sum += v[0];
        }
    }
    sum
}

#[inline(always)]
fn step_chain<S: Simd, const M: usize>(
    simd: S,
    b: &Balancer<2>,
    starts: &[[f64; 8]; 8],
    n: usize,
) -> f64 {
    let phases: [Phase<S>; M] = [phase(simd, b, [1.0, -1.0], [1.0; 2]); M];
    let start: Vector<S> = std::array::from_fn(|i| f64x8::from_fn(simd, |lane| starts[lane][i]));
    let (k, c) = phases[0].full(&start);
    let mut y = [start; M];
    let mut ks = [k; M];
    let mut tried = [Tried {
        end: start,
        derivative: k,
        contacts: c,
        error_squared: start[0],
        inner: [[start[0]; 4]; 3],
    }; M];
    let mut stages = [start; 12];
    let h = [f64x8::splat(simd, 0.3); M];
    let tolerance = Tolerance { relative: 1e-6, absolute: 1e-8 };
    for _ in 0..n {
        for m in 0..M {
            attempt(tolerance, &phases[m], &y[m], &ks[m], h[m], &mut stages, &mut tried[m]);
            let good = tried[m].error_squared.simd_le(f64x8::splat(simd, 1.0));
            for i in 0..N {
                y[m][i] = good.select(tried[m].end[i], y[m][i]);
                ks[m][i] = good.select(tried[m].derivative[i], ks[m][i]);
            }
        }
    }
    let mut sum = 0.0;
    for k in y {
        for v in k {
            sum += v[0];
        }
    }
    sum
}

#[inline(always)]
fn carried_chain<S: Simd>(simd: S, b: &Balancer<2>, starts: &[[f64; 8]; 8], n: usize) -> f64 {
    let phase: Phase<S> = phase(simd, b, [1.0, -1.0], [1.0; 2]);
    let mut start = [f64x8::splat(simd, 0.0); 10];
    for lane in 0..8 {
        let s = starts[lane];
        let all =
            [s[0], s[1], s[2], s[3], s[4].cos(), s[4].sin(), s[5].cos(), s[5].sin(), s[6], s[7]];
        for i in 0..10 {
            start[i][lane] = all[i];
        }
    }
    let mut k = start;
    let h = f64x8::splat(simd, 0.1);
    for _ in 0..n {
        let mut state = start;
        for i in 0..10 {
            state[i] = h.mul_add_precise(k[i], start[i]);
        }
        phase.carried(&state, &mut k);
    }
    k[8][0]
}

#[inline(always)]
fn array_chain(b: &Balancer<2>, starts: &[[f64; 8]; 8], n: usize) -> f64 {
    use lockstep_prototype::array::Array;
    use stickslip::model::Number;
    let b: Balancer<2, Array> = b.lifted();
    let mu = b.balls[0].friction.coefficient;
    let contact = |p: f64| Contact {
        free: Array::constant(1.0),
        signed_friction: Array::constant(p),
        drag: Array::constant(0.0),
    };
    let contacts = [contact(mu), contact(-mu)];
    let at = |i: usize| {
        let mut out = [0.0; 8];
        for lane in 0..8 {
            out[lane] = starts[lane][i];
        }
        Array(out)
    };
    let start = State {
        position: [at(0), at(1)],
        velocity: [at(2), at(3)],
        beta: [at(4), at(5)],
        beta_dot: [at(6), at(7)],
    };
    let mut k = start;
    for _ in 0..n {
        let mut x = start;
        x.add_scaled(Array::constant(0.1), &k);
        k = b.derivative(&x, &contacts, &b.forces(&x, &contacts));
    }
    k.beta_dot[0].0[0]
}

#[inline(always)]
fn sincos_chain<S: Simd>(simd: S, n: usize) -> f64 {
    let mut x = f64x8::from_fn(simd, |i| i as f64 * 0.7);
    for _ in 0..n {
        let (s, c) = sin_cos(x);
        x = x + s * c;
    }
    x[0]
}

fn time(f: impl FnOnce() -> f64) -> f64 {
    let start = Instant::now();
    black_box(f());
    start.elapsed().as_secs_f64() * 1e9
}

fn main() {
    let b = Balancer::<2>::new(&Machine::default()).unwrap();
    let starts: [[f64; 8]; 8] = std::array::from_fn(|lane| {
        let l = lane as f64;
        [
            0.01 * l - 0.03,
            0.02 - 0.005 * l,
            0.01,
            -0.02,
            0.7 * l,
            5.0 - 0.5 * l,
            0.3 + 0.05 * l,
            -0.4 - 0.03 * l,
        ]
    });
    // accuracy of sine and cosine, against sums of two doubles
    let level = Level::new();
    let mut worst = [0.0f64; 2];
    let mut state = 1u64;
    for _ in 0..400_000 {
        let xs: [f64; 8] = std::array::from_fn(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 * 20.0 - 10.0
        });
        let (s, c) = lockstep_prototype::at_level!(level, simd => {
            let (s, c) = sin_cos(f64x8::load_array(simd, xs));
            (s.to_array(), c.to_array())
        });
        for i in 0..8 {
            let (ts, tc) = accurate(xs[i]);
            worst[0] = worst[0].max(ulps(s[i], ts));
            worst[1] = worst[1].max(ulps(c[i], tc));
        }
    }
    println!(
        "sincos: worst error [ulp] sine {:.3} cosine {:.3} (|x| < 10, 3.2e6 angles)",
        worst[0], worst[1]
    );
    // same derivative as the model's own
    let contacts = [
        Contact { free: 1.0, signed_friction: b.balls[0].friction.coefficient, drag: 0.0 },
        Contact { free: 1.0, signed_friction: -b.balls[1].friction.coefficient, drag: 0.0 },
    ];
    let mut worst = 0.0f64;
    let model_rhs = |s: &State<2>| b.derivative(s, &contacts, &b.forces(s, &contacts));
    let got: [[f64; 8]; 8] = lockstep_prototype::at_level!(level, simd => {
        let p = phase(simd, &b, [1.0, -1.0], [1.0; 2]);
        let start: Vector<_> = std::array::from_fn(|i| f64x8::from_fn(simd, |lane| starts[lane][i]));
        p.full(&start).0.map(|v| v.to_array())
    });
    for lane in 0..8 {
        let s = starts[lane];
        let st = State {
            position: [s[0], s[1]],
            velocity: [s[2], s[3]],
            beta: [s[4], s[5]],
            beta_dot: [s[6], s[7]],
        };
        let d = model_rhs(&st);
        let want = [
            d.position[0],
            d.position[1],
            d.velocity[0],
            d.velocity[1],
            d.beta[0],
            d.beta[1],
            d.beta_dot[0],
            d.beta_dot[1],
        ];
        for i in 0..8 {
            worst = worst.max((want[i] - got[i][lane]).abs());
        }
    }
    println!("right-hand side against the model: {worst:.2e}");

    let n = 20_000;
    let mut rows: Vec<(String, Vec<f64>)> = Vec::new();
    let mut add = |name: &str, value: f64| match rows.iter_mut().find(|r| r.0 == name) {
        Some(r) => r.1.push(value),
        None => rows.push((name.to_owned(), vec![value])),
    };
    for _ in 0..21 {
        let t = time(|| {
            let s = starts[3];
            let st = State {
                position: [s[0], s[1]],
                velocity: [s[2], s[3]],
                beta: [s[4], s[5]],
                beta_dot: [s[6], s[7]],
            };
            let mut k = st;
            for _ in 0..n {
                let mut x = st;
                x.add_scaled(0.1, &k);
                k = model_rhs(&x);
            }
            k.beta_dot[0]
        });
        add("rhs scalar (libm)", t / n as f64);
        let t = time(|| {
            let s = starts[3];
            let mut st = State {
                position: [s[0], s[1]],
                velocity: [s[2], s[3]],
                beta: [s[4], s[5]],
                beta_dot: [s[6], s[7]],
            };
            let mut k = model_rhs(&st);
            let tol = stickslip::motion::Tolerance { relative: 1e-6, absolute: 1e-8 };
            for _ in 0..n / 10 {
                let step = stickslip::motion::Step::attempt(model_rhs, &st, &k, 0.3);
                if step.error(tol, true) < 1.0 {
                    st = step.end;
                }
                k = model_rhs(&st);
            }
            st.beta_dot[0]
        });
        add("step scalar", t / (n / 10) as f64);
        let levels: Vec<(&str, Level)> = {
            let mut v = vec![("best", level)];
            if let Some(l) = level.as_avx2() {
                v.push(("avx2", Level::Avx2(l)));
            }
            v
        };
        for (name, level) in levels {
            let t = time(|| lockstep_prototype::at_level!(level, simd => sincos_chain(simd, n)));
            add(&format!("{name} sincos chain"), t / (8 * n) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => rhs_chain::<_, 1>(simd, &b, &starts, n)),
            );
            add(&format!("{name} rhs M=1"), t / (8 * n) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => { let _ = simd; array_chain(&b, &starts, n) }),
            );
            add(&format!("{name} rhs plain arrays"), t / (8 * n) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => carried_chain(simd, &b, &starts, n)),
            );
            add(&format!("{name} rhs, (cos, sin) carried"), t / (8 * n) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => rhs_chain::<_, 2>(simd, &b, &starts, n)),
            );
            add(&format!("{name} rhs M=2"), t / (16 * n) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => step_chain::<_, 1>(simd, &b, &starts, n / 10)),
            );
            add(&format!("{name} step M=1"), t / (8 * n / 10) as f64);
            let t = time(
                || lockstep_prototype::at_level!(level, simd => step_chain::<_, 2>(simd, &b, &starts, n / 10)),
            );
            add(&format!("{name} step M=2"), t / (16 * n / 10) as f64);
        }
    }
    for (name, mut values) in rows {
        values.sort_by(f64::total_cmp);
        println!("{name:24} median {:8.2} ns  least {:8.2}", values[values.len() / 2], values[0]);
    }
}

fn ulps(value: f64, (high, low): (f64, f64)) -> f64 {
    let unit = high.abs().next_up() - high.abs();
    ((value - high) - low).abs() / unit
}

// double-double sine and cosine
type DD = (f64, f64);
fn two_sum(a: f64, b: f64) -> DD {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}
fn add(a: DD, b: DD) -> DD {
    let (s, e) = two_sum(a.0, b.0);
    let (t, f) = two_sum(a.1, b.1);
    let (s, e) = two_sum(s, e + t);
    two_sum(s, e + f)
}
fn mul(a: DD, b: DD) -> DD {
    let p = a.0 * b.0;
    let e = a.0.mul_add(b.0, -p);
    two_sum(p, e + (a.0 * b.1 + a.1 * b.0))
}
fn div_int(a: DD, n: f64) -> DD {
    let q = a.0 / n;
    let r = (-q).mul_add(n, a.0) + a.1;
    two_sum(q, r / n)
}
fn accurate(x: f64) -> (DD, DD) {
    let q = (x * std::f64::consts::FRAC_2_PI).round();
    // π/2 in three parts
    let parts = [1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33];
    let mut r: DD = (x, 0.0);
    for p in parts {
        let h = q * p;
        let l = q.mul_add(p, -h);
        r = add(r, (-h, -l));
    }
    let z = mul(r, r);
    let (mut s, mut c) = (r, (1.0, 0.0));
    let (mut ts, mut tc): (DD, DD) = (r, (1.0, 0.0));
    for k in 1..16 {
        let k = k as f64;
        tc = div_int(mul(tc, z), -(2.0 * k - 1.0) * (2.0 * k));
        ts = div_int(mul(ts, z), -(2.0 * k) * (2.0 * k + 1.0));
        s = add(s, ts);
        c = add(c, tc);
    }
    let neg = |a: DD| (-a.0, -a.1);
    match (q as i64).rem_euclid(4) {
        0 => (s, c),
        1 => (c, neg(s)),
        2 => (neg(s), neg(c)),
        _ => (neg(c), s),
    }
}
