//! One step of DOP853 in modal coordinates: the same interface as `step::attempt`, start and end in the
//! turning frame.
//!
//! With z the table's place and Y = z + Σ m e^{iβ} the centre of mass, the table is two complex modes
//! y± with eigenvalues λ± = -ζ ± iν, forced by the balls' places and speeds only:
//! ẏ± = (λ± - iω) y± ± Σ m (1 + 2ζ i w) e^{iβ} / 2iν (turning frame, w = ω + β̇). ν has the sign against ω,
//! so that + is the mode that turns against the balls and - the one that turns with them, slow in the
//! turning frame. From y+ its quasi-static answer S(w) e^{iβ} to each ball is taken off; what is left,
//! r+, is carried as R+ = e^{-i(ν - ω)τ} r+ and so changes slowly as well (S). With `SHAKEN` the
//! shaking of the balls by r+ is taken off too: β = B + Re(K D² u), β̇ = V + Re(K D u), u = r+ e^{-iB},
//! K = (p + i) λ+² / (1 + 4J), D = 1 / (λ+ - i w₀) with w₀ the ball's at the step's start (F).

use fearless_simd::{Simd, f64x8, prelude::*};

use crate::equations::{N, Phase, Vector};
use crate::sincos::{sin_cos, sin_cos_small};
use crate::step::{Tolerance, Tried, combine};
use crate::tableau::{ERROR_FIFTH, ERROR_THIRD, NODES, SOLUTION, STAGES};

/// A complex number in each lane: real and imaginary part.
type Complex<S> = (f64x8<S>, f64x8<S>);

#[inline(always)]
fn times<S: Simd>(a: Complex<S>, b: Complex<S>) -> Complex<S> {
    (a.0.mul_add_precise(b.0, -(a.1 * b.1)), a.0.mul_add_precise(b.1, a.1 * b.0))
}
/// a conj(b)
#[inline(always)]
fn times_conjugate<S: Simd>(a: Complex<S>, b: Complex<S>) -> Complex<S> {
    (a.0.mul_add_precise(b.0, a.1 * b.1), a.1.mul_add_precise(b.0, -(a.0 * b.1)))
}
/// Re(a b)
#[inline(always)]
fn real<S: Simd>(a: Complex<S>, b: Complex<S>) -> f64x8<S> {
    a.0.mul_add_precise(b.0, -(a.1 * b.1))
}
/// Im(a b)
#[inline(always)]
fn imaginary<S: Simd>(a: Complex<S>, b: Complex<S>) -> f64x8<S> {
    a.0.mul_add_precise(b.1, a.1 * b.0)
}
#[inline(always)]
fn plus<S: Simd>(a: Complex<S>, b: Complex<S>) -> Complex<S> {
    (a.0 + b.0, a.1 + b.1)
}
#[inline(always)]
fn minus<S: Simd>(a: Complex<S>, b: Complex<S>) -> Complex<S> {
    (a.0 - b.0, a.1 - b.1)
}
#[inline(always)]
fn scaled<S: Simd>(a: f64x8<S>, b: Complex<S>) -> Complex<S> {
    (a * b.0, a * b.1)
}

/// What a machine's modes are, in each lane another machine's.
#[derive(Clone, Copy)]
pub struct Modes<S: Simd> {
    pub zeta: f64x8<S>,
    /// ν, with the sign against ω's.
    pub nu: f64x8<S>,
    /// ζ / ν and 1 / 2ν.
    pub zeta_over_nu: f64x8<S>,
    pub half_over_nu: f64x8<S>,
    /// λ+², λ-²
    pub plus_squared: Complex<S>,
    pub minus_squared: Complex<S>,
    /// ν - ω: how fast the mode + turns in the frame, and -ν - ω for the mode -.
    pub plus_turn: f64x8<S>,
    pub minus_turn: f64x8<S>,
    /// Answers to the imbalance.
    pub plus_rest: Complex<S>,
    pub minus_rest: Complex<S>,
    /// Force by the imbalance and its answers.
    pub force: Complex<S>,
    /// S = m (s₁ + s₂ D'), D' = 1 / (iw - λ+)
    pub s1: Complex<S>,
    pub s2: Complex<S>,
    /// -S' = m t D'²
    pub t: Complex<S>,
}

impl<S: Simd> Modes<S> {
    #[inline(always)]
    pub fn blank(simd: S) -> Self {
        let o = f64x8::splat(simd, 0.0);
        let c = (o, o);
        Modes {
            zeta: f64x8::splat(simd, 0.1),
            nu: f64x8::splat(simd, 1.0),
            zeta_over_nu: o,
            half_over_nu: f64x8::splat(simd, 0.5),
            plus_squared: c,
            minus_squared: c,
            plus_turn: o,
            minus_turn: o,
            plus_rest: c,
            minus_rest: c,
            force: c,
            s1: c,
            s2: c,
            t: c,
        }
    }

    /// Sets one lane. The damping ratio has to be below 1.
    pub fn set(&mut self, lane: usize, omega: f64, zeta: f64, imbalance: f64) {
        type C = (f64, f64);
        let mul = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        let div = |a: C, b: C| {
            let n = 1.0 / (b.0 * b.0 + b.1 * b.1);
            (((a.0 * b.0) + (a.1 * b.1)) * n, (a.1 * b.0 - a.0 * b.1) * n)
        };
        let nu = -(1.0 - zeta * zeta).sqrt().copysign(omega);
        let (lp, lm) = ((-zeta, nu), (-zeta, -nu));
        let (lp2, lm2) = (mul(lp, lp), mul(lm, lm));
        let f = (imbalance * omega * omega, 0.0);
        let two_i_nu = (0.0, 2.0 * nu);
        let pp = div(div(f, two_i_nu), (-lp.0, omega - lp.1));
        let pm = div(div((-f.0, 0.0), two_i_nu), (-lm.0, omega - lm.1));
        let s1 = div((2.0 * zeta, 0.0), two_i_nu);
        let s2 = div((-lp2.0, -lp2.1), two_i_nu);
        let (a, b) = (mul(lp2, pp), mul(lm2, pm));
        let put = |to: &mut Complex<S>, v: C| {
            to.0[lane] = v.0;
            to.1[lane] = v.1;
        };
        self.zeta[lane] = zeta;
        self.nu[lane] = nu;
        self.zeta_over_nu[lane] = zeta / nu;
        self.half_over_nu[lane] = 0.5 / nu;
        self.plus_turn[lane] = nu - omega;
        self.minus_turn[lane] = -nu - omega;
        put(&mut self.plus_squared, lp2);
        put(&mut self.minus_squared, lm2);
        put(&mut self.plus_rest, pp);
        put(&mut self.minus_rest, pm);
        put(&mut self.force, (f.0 + a.0 + b.0, a.1 + b.1));
        put(&mut self.s1, s1);
        put(&mut self.s2, s2);
        put(&mut self.t, (-lp2.0 * 0.5 / nu, -lp2.1 * 0.5 / nu));
    }
}

/// What is frozen over a step, of one ball: S(w) as the line S₀ + S₁ δ, δ = w - w₀.
#[derive(Clone, Copy)]
pub struct Frozen<S: Simd> {
    /// β̇ at w₀: about that in the middle of the step.
    speed: f64x8<S>,
    s0: Complex<S>,
    s1: Complex<S>,
    /// Force on the table per e^{iβ}, beside m w²: q₀ + q₁ δ.
    q0: Complex<S>,
    q1: Complex<S>,
    /// Forcing of the mode -: f₀ w + i f₁
    f0: f64x8<S>,
    f1: f64x8<S>,
    /// K D and K D² (F only).
    kd: Complex<S>,
    kdd: Complex<S>,
}

/// D' = 1 / (iw - λ+) = (ζ - i(w - ν)) / n of two balls, by one division.
#[inline(always)]
fn poles<S: Simd>(modes: &Modes<S>, w: [f64x8<S>; 2]) -> [Complex<S>; 2] {
    let one = f64x8::splat(w[0].simd, 1.0);
    let zz = modes.zeta * modes.zeta;
    let d = [w[0] - modes.nu, w[1] - modes.nu];
    let n = [d[0].mul_add_precise(d[0], zz), d[1].mul_add_precise(d[1], zz)];
    let inverse = one / (n[0] * n[1]);
    let i = [inverse * n[1], inverse * n[0]];
    [(modes.zeta * i[0], -(d[0] * i[0])), (modes.zeta * i[1], -(d[1] * i[1]))]
}

/// Derivative in modal coordinates at one stage, with the balls' own speeds and accelerations. `turn` is e^{i(ν - ω)τ}.
#[inline]
fn derivative<S: Simd, const SHAKEN: bool>(
    phase: &Phase<S>,
    modes: &Modes<S>,
    frozen: &[Frozen<S>; 2],
    turn: Complex<S>,
    state: &Vector<S>,
    out: &mut Vector<S>,
    look: &mut [f64x8<S>; 4],
) {
    phase.omega.simd.vectorize(
        #[inline(always)]
        || {
            let [r_x, r_y, ym_x, ym_y, b1, b2, v1, v2] = *state;
            let r = times(turn, (r_x, r_y));
            let ym = (ym_x, ym_y);
            let (sn1, cs1) = sin_cos(b1);
            let (sn2, cs2) = sin_cos(b2);
            // e^{iB}, and e^{iβ}
            let base = [(cs1, sn1), (cs2, sn2)];
            let mut e = base;
            let mut speeds = [v1, v2];
            let mut u = base;
            if SHAKEN {
                macro_rules! shake {
                    ($($i:literal)*) => {$(
                        u[$i] = times_conjugate(r, base[$i]);
                        let (s, c) = sin_cos_small(real(frozen[$i].kdd, u[$i]));
                        e[$i] = times(base[$i], (c, s));
                        speeds[$i] = speeds[$i] + real(frozen[$i].kd, u[$i]);
                    )*};
                }
                shake!(0 1);
            }
            let delta = [speeds[0] - frozen[0].speed, speeds[1] - frozen[1].speed];
            // Force on the table but for the balls' accelerations.
            let mut force = plus(times(modes.plus_squared, r), times(modes.minus_squared, ym));
            force = plus(force, modes.force);
            macro_rules! ball {
                ($i:literal) => {{
                    let b = &frozen[$i];
                    let k = (
                        b.q1.0.mul_add_precise(delta[$i], b.q0.0),
                        b.q1.1.mul_add_precise(delta[$i], b.q0.1),
                    );
                    let f = (b.f0 * (phase.omega + speeds[$i]), b.f1);
                    (times(k, e[$i]), times(f, e[$i]))
                }};
            }
            let (k1, f1) = ball!(0);
            let (k2, f2) = ball!(1);
            force = plus(force, plus(k1, k2));
            let forcing = plus(f1, f2);
            let (_, alpha, _) = phase.accelerations(
                [force.0, force.1],
                [(e[0].1, e[0].0), (e[1].1, e[1].0)],
                speeds,
            );
            *look = [speeds[0], speeds[1], alpha[0], alpha[1]];
            // Mode -: (λ- - iω) ym - forcing.
            out[2] = -(modes.zeta * ym.0 + modes.minus_turn * ym.1) - forcing.0;
            out[3] = modes.minus_turn * ym.0 - modes.zeta * ym.1 - forcing.1;
            // Mode +: -Σ S₁ (α + iδ²) e.
            macro_rules! residue {
                ($i:literal) => {
                    times(times(frozen[$i].s1, (alpha[$i], delta[$i] * delta[$i])), e[$i])
                };
            }
            let sum = plus(residue!(0), residue!(1));
            let chi = (-sum.0, -sum.1);
            let back = times_conjugate(chi, turn);
            out[0] = back.0 - modes.zeta * r_x;
            out[1] = back.1 - modes.zeta * r_y;
            if SHAKEN {
                let one = f64x8::splat(r_x.simd, 1.0);
                let q = [imaginary(frozen[0].kdd, u[0]), imaginary(frozen[1].kdd, u[1])];
                let (g, h) = (one + q[0], one + q[1]);
                let inverse = one / (g * h);
                let i = [inverse * h, inverse * g];
                macro_rules! shaken {
                    ($($i:literal)*) => {$(
                        let v = state[6 + $i];
                        let x = times_conjugate(chi, base[$i]);
                        let e = -((v - frozen[$i].speed).mul_add_precise(q[$i], real(frozen[$i].kdd, x)));
                        let b_dot = e.mul_add_precise(i[$i], v);
                        let t = modes.plus_turn - b_dot;
                        let u_dot = (
                            x.0 - modes.zeta.mul_add_precise(u[$i].0, t * u[$i].1),
                            x.1 + t.mul_add_precise(u[$i].0, -(modes.zeta * u[$i].1)),
                        );
                        out[4 + $i] = b_dot;
                        out[6 + $i] = alpha[$i] - real(frozen[$i].kd, u_dot);
                    )*};
                }
                shaken!(0 1);
            } else {
                out[4] = v1;
                out[5] = v2;
                out[6] = alpha[0];
                out[7] = alpha[1];
            }
        },
    );
}

/// Tries a step, as `step::attempt`.
#[inline(always)]
#[expect(clippy::too_many_arguments)]
pub fn attempt<S: Simd, const SHAKEN: bool>(
    tolerance: Tolerance,
    phase: &Phase<S>,
    modes: &Modes<S>,
    start: &Vector<S>,
    slope: &Vector<S>,
    length: f64x8<S>,
    stages: &mut [Vector<S>; 12],
    tried: &mut Tried<S>,
) {
    let simd = length.simd;
    macro_rules! c {
        ($value:expr) => {
            f64x8::splat(simd, $value)
        };
    }
    let one = c!(1.0);
    // To modal coordinates.
    let w = [phase.omega + start[6], phase.omega + start[7]];
    let trigonometry = [sin_cos(start[4]), sin_cos(start[5])];
    let e = [(trigonometry[0].1, trigonometry[0].0), (trigonometry[1].1, trigonometry[1].0)];
    let m = [phase.balls[0].mass, phase.balls[1].mass];
    let centre =
        (start[0] + (m[0] * e[0].0 + m[1] * e[1].0), start[1] + (m[0] * e[0].1 + m[1] * e[1].1));
    let velocity = (
        start[2] - phase.omega * start[1] - (m[0] * w[0] * e[0].1 + m[1] * w[1] * e[1].1),
        start[3] + phase.omega * start[0] + (m[0] * w[0] * e[0].0 + m[1] * w[1] * e[1].0),
    );
    let zero = c!(0.0);
    let blank = (zero, zero);
    let mut frozen = [Frozen {
        speed: zero,
        s0: blank,
        s1: blank,
        q0: blank,
        q1: blank,
        f0: zero,
        f1: zero,
        kd: blank,
        kdd: blank,
    }; 2];
    let ahead = c!(0.5) * length;
    let middle =
        [ahead.mul_add_precise(slope[6], start[6]), ahead.mul_add_precise(slope[7], start[7])];
    let pole = poles(modes, [phase.omega + middle[0], phase.omega + middle[1]]);
    macro_rules! line {
        ($($i:literal)*) => {$(
            let f = &mut frozen[$i];
            let unit = m[$i];
            f.speed = middle[$i];
            f.s0 = scaled(unit, plus(times(modes.s2, pole[$i]), modes.s1));
            f.s1 = scaled(-unit, times(modes.t, times(pole[$i], pole[$i])));
            let drag = unit * phase.drag;
            f.q0 = times(modes.plus_squared, f.s0);
            f.q0.0 = f.q0.0 + unit;
            f.q0.1 = drag.mul_add_precise(phase.omega + middle[$i], f.q0.1);
            f.q1 = times(modes.plus_squared, f.s1);
            f.q1.1 = f.q1.1 + drag;
            f.f0 = unit * modes.zeta_over_nu;
            f.f1 = -(unit * modes.half_over_nu);
        )*};
    }
    line!(0 1);
    macro_rules! answer {
        ($i:literal, $speed:expr) => {{
            let delta = $speed - frozen[$i].speed;
            times(
                (
                    frozen[$i].s1.0.mul_add_precise(delta, frozen[$i].s0.0),
                    frozen[$i].s1.1.mul_add_precise(delta, frozen[$i].s0.1),
                ),
                e[$i],
            )
        }};
    }
    // (V - λ∓ Y) / 2iν
    let sum = plus(velocity, scaled(modes.zeta, centre));
    let half = modes.half_over_nu;
    let other = scaled(c!(0.5), centre);
    let turned = (half * sum.1, -(half * sum.0));
    let mut r = minus(plus(other, turned), modes.plus_rest);
    let ym = minus(minus(other, turned), modes.minus_rest);
    r = minus(r, plus(answer!(0, start[6]), answer!(1, start[7])));
    let mut base = [r.0, r.1, ym.0, ym.1, start[4], start[5], start[6], start[7]];
    if SHAKEN {
        macro_rules! freeze {
            ($($i:literal)*) => {$(
                let d = (-pole[$i].0, -pole[$i].1);
                let mobility = phase.balls[$i].mobility;
                let k = times((phase.balls[$i].friction * mobility, mobility), modes.plus_squared);
                let kd = times(k, d);
                let kdd = times(kd, d);
                frozen[$i].kd = kd;
                frozen[$i].kdd = kdd;
                // B + Re(K D² r e^{-iB}) = β by Newton's method.
                let u0 = times_conjugate(r, e[$i]);
                let mut u = u0;
                let mut shift = zero; // β - B
                for _ in 0..3 {
                    let slope = one + imaginary(kdd, u);
                    shift = shift + (real(kdd, u) - shift) / slope;
                    let (s, c) = sin_cos_small(shift);
                    u = times(u0, (c, s));
                }
                base[4 + $i] = start[4 + $i] - shift;
                base[6 + $i] = start[6 + $i] - real(kd, u);
            )*};
        }
        freeze!(0 1);
    }
    let mut look = [zero; 4];
    if SHAKEN {
        derivative::<S, SHAKEN>(
            phase,
            modes,
            &frozen,
            (one, zero),
            &base,
            &mut stages[0],
            &mut look,
        );
    } else {
        // The accelerations are known.
        macro_rules! known {
            ($i:literal) => {{
                let b = &frozen[$i];
                let delta = start[6 + $i] - b.speed;
                (
                    times((b.f0 * w[$i], b.f1), e[$i]),
                    times(times(b.s1, (slope[6 + $i], delta * delta)), e[$i]),
                )
            }};
        }
        let (f1, c1) = known!(0);
        let (f2, c2) = known!(1);
        stages[0] = [
            -(c1.0 + c2.0) - modes.zeta * r.0,
            -(c1.1 + c2.1) - modes.zeta * r.1,
            -(modes.zeta * ym.0 + modes.minus_turn * ym.1) - (f1.0 + f2.0),
            modes.minus_turn * ym.0 - modes.zeta * ym.1 - (f1.1 + f2.1),
            start[6],
            start[7],
            slope[6],
            slope[7],
        ];
    }
    let mut state = base;
    let turning = modes.plus_turn * length;
    let mut turn;
    macro_rules! stage {
        ($($index:literal)*) => {$(
            for i in 0..N {
                let slope = combine(STAGES[$index], i, stages);
                state[i] = length.mul_add_precise(slope, base[i]);
            }
            let (s, c) = sin_cos(turning * c!(NODES[$index]));
            turn = (c, s);
            derivative::<S, SHAKEN>(
                phase, modes, &frozen, turn, &state, &mut stages[$index + 1], &mut look,
            );
        )*};
    }
    stage!(0 1 2 3 4);
    tried.inner[0] = look;
    stage!(5 6 7);
    tried.inner[1] = look;
    stage!(8 9);
    tried.inner[2] = look;
    stage!(10);
    let mut modal = base;
    for i in 0..N {
        let slope = combine(SOLUTION, i, stages);
        modal[i] = length.mul_add_precise(slope, base[i]);
    }
    // Back to the turning frame.
    let r = times(turn, (modal[0], modal[1]));
    let mut angles = [modal[4], modal[5]];
    let mut speeds = [modal[6], modal[7]];
    if SHAKEN {
        macro_rules! drop {
            ($($i:literal)*) => {$(
                let (s, c) = sin_cos(angles[$i]);
                let u = times_conjugate(r, (c, s));
                angles[$i] = angles[$i] + real(frozen[$i].kdd, u);
                speeds[$i] = speeds[$i] + real(frozen[$i].kd, u);
            )*};
        }
        drop!(0 1);
    }
    let trigonometry = [sin_cos(angles[0]), sin_cos(angles[1])];
    let e = [(trigonometry[0].1, trigonometry[0].0), (trigonometry[1].1, trigonometry[1].0)];
    let w = [phase.omega + speeds[0], phase.omega + speeds[1]];
    macro_rules! answer {
        ($i:literal) => {{
            let delta = speeds[$i] - frozen[$i].speed;
            times(
                (
                    frozen[$i].s1.0.mul_add_precise(delta, frozen[$i].s0.0),
                    frozen[$i].s1.1.mul_add_precise(delta, frozen[$i].s0.1),
                ),
                e[$i],
            )
        }};
    }
    let yp = plus(plus(r, modes.plus_rest), plus(answer!(0), answer!(1)));
    let ym = plus((modal[2], modal[3]), modes.minus_rest);
    let centre = plus(yp, ym);
    // V = -ζ Y + iν (y+ - y-)
    let difference = scaled(modes.nu, minus(yp, ym));
    let x = centre.0 - (m[0] * e[0].0 + m[1] * e[1].0);
    let y = centre.1 - (m[0] * e[0].1 + m[1] * e[1].1);
    let v_x = -(modes.zeta * centre.0 + difference.1)
        + (m[0] * w[0] * e[0].1 + m[1] * w[1] * e[1].1)
        + phase.omega * y;
    let v_y = difference.0
        - modes.zeta * centre.1
        - (m[0] * w[0] * e[0].0 + m[1] * w[1] * e[1].0)
        - phase.omega * x;
    let end = [x, y, v_x, v_y, angles[0], angles[1], speeds[0], speeds[1]];
    (tried.derivative, tried.contacts) = phase.with_trigonometry(&end, trigonometry);
    tried.end = end;
    // Errors: both modes to the scale of the table's whole motion, speeds with a floor.
    let relative = c!(tolerance.relative);
    let absolute = c!(tolerance.absolute);
    let from = base[0] * base[0] + base[1] * base[1] + (base[2] * base[2] + base[3] * base[3]);
    let to =
        modal[0] * modal[0] + modal[1] * modal[1] + (modal[2] * modal[2] + modal[3] * modal[3]);
    let motion = from.max(to).max(c!(1e-6)).sqrt();
    let table = relative.mul_add_precise(motion, absolute);
    let angle = relative + absolute;
    let floor = c!(0.3);
    let speed_1 = relative.mul_add_precise(base[6].abs().max(modal[6].abs()).max(floor), absolute);
    let speed_2 = relative.mul_add_precise(base[7].abs().max(modal[7].abs()).max(floor), absolute);
    let scale_1 = speed_1 * speed_1;
    let scale_2 = speed_2 * speed_2;
    macro_rules! weighted {
        ($terms:ident) => {{
            let e = [
                combine($terms, 0, stages),
                combine($terms, 1, stages),
                combine($terms, 2, stages),
                combine($terms, 3, stages),
                combine($terms, 4, stages),
                combine($terms, 5, stages),
                combine($terms, 6, stages),
                combine($terms, 7, stages),
            ];
            (
                e[0] * e[0] + e[1] * e[1] + (e[2] * e[2] + e[3] * e[3]),
                e[4] * e[4] + e[5] * e[5],
                e[6] * e[6] * scale_2 + e[7] * e[7] * scale_1,
            )
        }};
    }
    let fifth = weighted!(ERROR_FIFTH);
    let third = weighted!(ERROR_THIRD);
    let [a, b, d] = [one / (table * table), one / (angle * angle), one / (scale_1 * scale_2)];
    let fifth = fifth.0 * a + (fifth.1 * b + fifth.2 * d);
    let third = third.0 * a + (third.1 * b + third.2 * d);
    let weight = third.mul_add_precise(c!(0.01), fifth + c!(1e-60));
    let scaled = length * fifth;
    tried.error_squared = scaled * scaled / (weight * c!(N as f64));
}
