#!/usr/bin/env python3
"""Event-located reference integrator for the two-ball balancer with Coulomb friction.

"Thesis" is TU Eindhoven, "Modeling and Analysis of an Automatic Balancing Unit
with Dry Friction". Everything below is non-dimensional as in its appendix B.6:
lengths over L, time times omega_n = sqrt(k/M), ball forces over m_i omega_n^2 L.

Computes the exact (Filippov) motion under Coulomb friction, that is the
limit of the thesis's switch model (4.2, 4.3) for a band width eta -> 0:

* Within a phase every ball either slips with a fixed sign or sticks with a ball
  speed of exactly zero. The accelerations and forces come from one 8x8 linear
  system in (xdd, ydd, bdd_1, bdd_2, f_n1, f_n2, f_w1, f_w2): the extended Lagrange
  equations with the rings' constraints and friction laws (3.5, eqs. 3.13-3.16,
  appendix C) with nothing eliminated by hand, solved by Gaussian elimination.
* Dormand-Prince 5(4) steps with an adaptive size.
* A ball's stop (speed zero) and its break-away (|f_w| = mu f_n) are bracketed on the
  dense output and then located by repeating the step with a shorter size.
* After an event the next phase is the consistent one among all combinations of
  {stick, slip +, slip -} of the balls at rest.

A run ends in equilibrium when all balls stick and a bound on the table's remaining
vibration excludes any break-away for ever (`certain_rest`), or when it creeps into
the edge of the equilibrium set (`Creep` below).
"""

import argparse
import csv
import math
import os

import numba as nb
import numpy as np

# --- Machine: thesis table 3.2 (SI units) ------------------------------------------
M_TABLE = 3.24e-1
DAMPING = 1.28
STIFFNESS = 1.07e4
RING = 1.15e-2
M_BALL = (1.4e-4, 1.4e-4)
D_BALL = (3.0e-3, 3.0e-3)
M_IMBALANCE = 5.6e-5
ECCENTRICITY = 3.7e-2
INERTIA = 0.1  # J / (m d^2) of a homogeneous sphere
MU = 2.75e-3

SPEEDS = (-160.8103, -191.6372, -216.3772, -173.1803, -179.2671)  # rad/s, table A.1
END_TIME_S = 16.5
SEED = 20240611

# Start box, order (x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2).
# The box of thesis 5.3 is lost in the scan; this one is reconstructed from its counts.
BOX_LOW = np.array([-0.05, -0.05, 0.0, 0.0, -0.05, -0.05, -1.0, -1.0])
BOX_HIGH = np.array([0.05, 0.05, 2 * np.pi, 2 * np.pi, 0.05, 0.05, 1.0, 1.0])

# --- Positions in the parameter vector ------------------------------------------------
P_OMEGA, P_ZETA, P_MIE, P_J, P_NEWTON = 0, 1, 2, 3, 4
P_M, P_D, P_MU = 5, 7, 9  # two entries each
N_PARAMS = 11

N = 2  # balls
DIM = 8  # unknowns of the linear system, and components of the state

# --- Numerical choices ------------------------------------------------------------------
RTOL, ATOL = 1e-9, 1e-11
H_MAX = 0.25  # the fastest motion has an angular frequency of about 2.2
SAMPLES = 8  # evaluations of the event functions per step
EVENT_TIME_TOL = 1e-13  # width of the final bracket
# A ball at rest breaks away where |f_w| - mu f_n exceeds this: about 1000 roundings of
# the force, so that just after a break-away `slip` is consistent and `stick` is not.
BREAK_AWAY_MARGIN = 1e-15
AT_REST = 1e-12  # a decelerating ball slower than this at another ball's event stops too
# Creep: towards some points of the set's edge the ball speed decays for ever without
# becoming zero. Counted as equilibrium when, for CREEP_WINDOW long, no ball was faster
# than CREEP_SPEED, the table's vibration is small and no ball's friction demand at the
# rest point exceeds its limit by more than CREEP_EDGE.
CREEP_SPEED = 1e-7
CREEP_WINDOW = 50.0
CREEP_VIBRATION = 1e-5
CREEP_EDGE = 1e-7
MAX_EVENTS = 2_000_000

MOVING, REST, CREEP, FAILED = 0, 1, 2, 3

# Dormand-Prince 5(4), and Shampine's fourth-order dense output in Hairer's form.
A21 = 1 / 5
A31, A32 = 3 / 40, 9 / 40
A41, A42, A43 = 44 / 45, -56 / 15, 32 / 9
A51, A52, A53, A54 = 19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729
A61, A62, A63, A64, A65 = 9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656
B1, B3, B4, B5, B6 = 35 / 384, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84
E1, E3, E4, E5, E6, E7 = (
    71 / 57600, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40,
)
D1, D3, D4, D5, D6, D7 = (
    -12715105075 / 11282082432, 87487479700 / 32700410799, -10690763975 / 1880347072,
    701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423,
)


def natural_frequency():
    """omega_n in rad/s."""
    return math.sqrt(STIFFNESS / (M_TABLE + M_IMBALANCE + sum(M_BALL)))


def parameters(speed, mu=MU, normal_force="lagrange"):
    """Non-dimensional parameter vector for a motor speed in rad/s (thesis B.6)."""
    mass = M_TABLE + M_IMBALANCE + sum(M_BALL)
    wn = natural_frequency()
    p = np.zeros(N_PARAMS)
    p[P_OMEGA] = speed / wn
    p[P_ZETA] = DAMPING / (2 * mass * wn)
    p[P_MIE] = M_IMBALANCE / mass * ECCENTRICITY / RING
    p[P_J] = INERTIA
    p[P_NEWTON] = {"lagrange": 0.0, "newton": 1.0}[normal_force]
    for i in range(N):
        p[P_M + i] = M_BALL[i] / mass
        p[P_D + i] = D_BALL[i] / RING
        p[P_MU + i] = mu
    return p


@nb.njit(fastmath=False)
def gauss(a, b):
    """Solve a x = b in place (b becomes x), with partial pivoting."""
    n = DIM
    for k in range(n):
        piv = k
        big = abs(a[k, k])
        for r in range(k + 1, n):
            v = abs(a[r, k])
            if v > big:
                big = v
                piv = r
        if piv != k:
            for c in range(k, n):
                a[k, c], a[piv, c] = a[piv, c], a[k, c]
            b[k], b[piv] = b[piv], b[k]
        for r in range(k + 1, n):
            if a[r, k] != 0.0:
                f = a[r, k] / a[k, k]
                for c in range(k + 1, n):
                    a[r, c] -= f * a[k, c]
                b[r] -= f * b[k]
    for k in range(n - 1, -1, -1):
        v = b[k]
        for c in range(k + 1, n):
            v -= a[k, c] * b[c]
        b[k] = v / a[k, k]


@nb.njit
def solve(y, sig, p, a, b):
    """Accelerations and forces in one phase.

    y: (x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2). sig[i]: 0 stick,
    +1/-1 slip with that sign. Leaves (xdd, ydd, bdd_i, f_ni, f_wi) in b.
    """
    om = p[P_OMEGA]
    zeta = p[P_ZETA]
    jj = p[P_J]
    for r in range(DIM):
        b[r] = 0.0
        for c in range(DIM):
            a[r, c] = 0.0
    # Acceleration of the ring's centre due to the frame's turning (B.1).
    fx = -2.0 * om * y[5] - om * om * y[0]
    fy = 2.0 * om * y[4] - om * om * y[1]
    # Generalised coordinates x, y: all masses together have mass 1.
    a[0, 0] = 1.0
    a[1, 1] = 1.0
    b[0] = -fx - y[0] - 2.0 * zeta * (y[4] - om * y[1]) + p[P_MIE] * om * om
    b[1] = -fy - y[1] - 2.0 * zeta * (y[5] + om * y[0])
    for i in range(N):
        m = p[P_M + i]
        s = math.sin(y[2 + i])
        c = math.cos(y[2 + i])
        bd = y[6 + i]
        w = om + bd
        a[0, 2 + i] = -m * s
        a[1, 2 + i] = m * c
        b[0] += m * c * w * w
        b[1] += m * s * w * w
        # Coordinate beta_i, divided by m_i; rolling adds 4 J to the ball's inertia.
        r = 2 + i
        a[r, 0] = -s
        a[r, 1] = c
        a[r, 2 + i] = 1.0 + 4.0 * jj
        a[r, 6 + i] = 1.0
        b[r] = s * fx - c * fy
        # Coordinate l_i with the constraint l_i = 1; its multiplier is f_n (3.5, B.4).
        r = 4 + i
        a[r, 0] = c
        a[r, 1] = s
        a[r, 4 + i] = 1.0
        b[r] = w * w - c * fx - s * fy
        if p[P_NEWTON] == 0.0:
            # The spin omega - 2 l beta_dot / d depends on l: its share of dT/dl.
            b[r] -= 2.0 * jj * p[P_D + i] * om * bd - 4.0 * jj * bd * bd
        # Friction law (slip) or constraint (stick).
        r = 6 + i
        if sig[i] == 0:
            a[r, 2 + i] = 1.0
        else:
            a[r, 6 + i] = 1.0
            a[r, 4 + i] = -sig[i] * p[P_MU + i]
    gauss(a, b)


@nb.njit
def derivative(y, sig, p, a, b, dy):
    """Time derivative of the state; b keeps the solution of the linear system."""
    solve(y, sig, p, a, b)
    dy[0] = y[4]
    dy[1] = y[5]
    dy[4] = b[0]
    dy[5] = b[1]
    for i in range(N):
        if sig[i] == 0:
            dy[2 + i] = 0.0
            dy[6 + i] = 0.0
        else:
            dy[2 + i] = y[6 + i]
            dy[6 + i] = b[2 + i]


@nb.njit
def step(y, k, h, sig, p, a, b, tmp, out, rtol, atol):
    """One Dormand-Prince step from y with k[0] = y'. Returns the error norm.

    Fills k[1..6] and out. Ball angles are measured against a scale of 1 rad, however
    often the ball has gone round.
    """
    for j in range(DIM):
        tmp[j] = y[j] + h * A21 * k[0, j]
    derivative(tmp, sig, p, a, b, k[1])
    for j in range(DIM):
        tmp[j] = y[j] + h * (A31 * k[0, j] + A32 * k[1, j])
    derivative(tmp, sig, p, a, b, k[2])
    for j in range(DIM):
        tmp[j] = y[j] + h * (A41 * k[0, j] + A42 * k[1, j] + A43 * k[2, j])
    derivative(tmp, sig, p, a, b, k[3])
    for j in range(DIM):
        tmp[j] = y[j] + h * (A51 * k[0, j] + A52 * k[1, j] + A53 * k[2, j] + A54 * k[3, j])
    derivative(tmp, sig, p, a, b, k[4])
    for j in range(DIM):
        tmp[j] = y[j] + h * (
            A61 * k[0, j] + A62 * k[1, j] + A63 * k[2, j] + A64 * k[3, j] + A65 * k[4, j]
        )
    derivative(tmp, sig, p, a, b, k[5])
    for j in range(DIM):
        out[j] = y[j] + h * (
            B1 * k[0, j] + B3 * k[2, j] + B4 * k[3, j] + B5 * k[4, j] + B6 * k[5, j]
        )
    derivative(out, sig, p, a, b, k[6])
    err = 0.0
    for j in range(DIM):
        e = h * (
            E1 * k[0, j] + E3 * k[2, j] + E4 * k[3, j] + E5 * k[4, j] + E6 * k[5, j]
            + E7 * k[6, j]
        )
        size = 1.0 if (j == 2 or j == 3) else max(abs(y[j]), abs(out[j]))
        err = max(err, abs(e) / (atol + rtol * size))
    return err


@nb.njit
def dense(y, y1, k, h, theta, out):
    """Returns the dense output at the fraction theta of the step y -> y1."""
    t1 = 1.0 - theta
    for j in range(DIM):
        dif = y1[j] - y[j]
        r3 = h * k[0, j] - dif
        r4 = dif - h * k[6, j] - r3
        r5 = h * (
            D1 * k[0, j] + D3 * k[2, j] + D4 * k[3, j] + D5 * k[4, j] + D6 * k[5, j]
            + D7 * k[6, j]
        )
        out[j] = y[j] + theta * (dif + t1 * (r3 + theta * (r4 + t1 * r5)))


@nb.njit
def gauges(y, sig, p, a, b, g):
    """Event functions, positive once the phase is no longer valid. Returns the largest.

    Slip: minus the speed in the direction of slip. Stick: friction beyond its limit.
    """
    stuck = False
    for i in range(N):
        if sig[i] == 0:
            stuck = True
    if stuck:
        solve(y, sig, p, a, b)
    big = -1e300
    for i in range(N):
        if sig[i] == 0:
            g[i] = abs(b[6 + i]) - p[P_MU + i] * b[4 + i] - BREAK_AWAY_MARGIN
        else:
            g[i] = -sig[i] * y[6 + i]
        big = max(big, g[i])
    return big


@nb.njit
def decide(y, sig, p, a, b):
    """Set sig of the balls at rest (beta_dot exactly 0) to the consistent combination.

    All 3^k combinations are tried, those with more sticking balls first: |f_w| within
    its limit for stick, acceleration in the direction of slip otherwise (thesis
    appendix C). If rounding leaves none consistent, the least inconsistent is taken.
    """
    rest = np.zeros(N, np.int64)
    n_rest = 0
    for i in range(N):
        if y[6 + i] == 0.0:
            rest[n_rest] = i
            n_rest += 1
    if n_rest == 0:
        return
    total = 3**n_rest
    trial = sig.copy()
    best = sig.copy()
    best_violation = 1e300
    for slips in range(n_rest + 1):
        for code in range(total):
            rem = code
            count = 0
            for q in range(n_rest):
                d = rem % 3
                rem //= 3
                trial[rest[q]] = 0 if d == 0 else (1 if d == 1 else -1)
                if d != 0:
                    count += 1
            if count != slips:
                continue
            solve(y, trial, p, a, b)
            violation = -1e300
            for q in range(n_rest):
                i = rest[q]
                if trial[i] == 0:
                    v = abs(b[6 + i]) - p[P_MU + i] * b[4 + i] - BREAK_AWAY_MARGIN
                else:
                    v = -trial[i] * b[2 + i]
                violation = max(violation, v)
            if violation < best_violation:
                best_violation = violation
                for i in range(N):
                    best[i] = trial[i]
            if violation <= 0.0:
                for i in range(N):
                    sig[i] = trial[i]
                return
    for i in range(N):
        sig[i] = best[i]


@nb.njit
def rest_point(y, p):
    """Table vibration about the rest point that the present ball angles would give.

    With fixed balls z = x + i y obeys
        z'' + 2 (zeta + i om) z' + (1 - om^2 + 2 i zeta om) z = om^2 F,
    F = m_I e + sum m_i exp(i beta_i), with rest point z0 (thesis 5.2, eqs. 5.3, 5.4).
    Returns (sqrt(|u|^2 + |v|^2), excess): u = z - z0, v = u' + i om u its velocity seen
    from inertial space; excess: largest |f_w| - mu f_n of a ball at z0 (eq. 5.5).
    """
    om = p[P_OMEGA]
    zeta = p[P_ZETA]
    f = p[P_MIE] + 0.0j
    for i in range(N):
        f += p[P_M + i] * complex(math.cos(y[2 + i]), math.sin(y[2 + i]))
    z0 = om * om * f / (1.0 - om * om + 2j * zeta * om)
    u = complex(y[0], y[1]) - z0
    v = complex(y[4], y[5]) + 1j * om * u
    size = math.sqrt(u.real**2 + u.imag**2 + v.real**2 + v.imag**2)
    excess = -1e300
    for i in range(N):
        s = math.sin(y[2 + i])
        c = math.cos(y[2 + i])
        demand = om * om * abs(z0.real * s - z0.imag * c)
        normal = om * om * (1.0 + z0.real * c + z0.imag * s)
        excess = max(excess, demand - p[P_MU + i] * normal)
    return size, excess


@nb.njit
def certain_rest(y, p):
    """True if stuck balls can never break loose again.

    From inertial space U = u exp(i om t) is a free damped oscillator,
    U'' + 2 zeta U' + U = 0, so |U|^2 + |U'|^2 never grows, and by Cauchy-Schwarz
    |U''| = |U + 2 zeta U'| <= sqrt(1 + 4 zeta^2) sqrt(|U|^2 + |U'|^2) =: A for ever.
    A ball's f_w and f_n change by the components of U'' along its two orthogonal
    directions, so |f_w| - mu f_n grows by at most sqrt(1 + mu^2) A over its value at
    the rest point.
    """
    size, excess = rest_point(y, p)
    mu = 0.0
    for i in range(N):
        mu = max(mu, p[P_MU + i])
    grow = math.sqrt((1.0 + mu * mu) * (1.0 + 4.0 * p[P_ZETA] ** 2)) * size
    return excess + grow <= 0.0


@nb.njit
def run(start, p, t_end, rtol, atol, end_state, info):
    """Integrate one run. Returns (outcome, time to rest, last phase code).

    end_state: state at the end of the run (at t_end for a moving one).
    info: [steps, events, phase decisions without progress, least f_n met].
    Time to rest: when the last ball came to rest (creep: when the last ball's speed
    fell below CREEP_SPEED for good).
    """
    a = np.zeros((DIM, DIM))
    b = np.zeros(DIM)
    k = np.zeros((7, DIM))
    kt = np.zeros((7, DIM))
    tmp = np.zeros(DIM)
    y = start.copy()
    y1 = np.zeros(DIM)
    yt = np.zeros(DIM)
    g = np.zeros(N)
    gs = np.zeros((SAMPLES + 1, N))
    sig = np.zeros(N, np.int64)
    for i in range(N):
        sig[i] = 1 if y[6 + i] > 0.0 else (-1 if y[6 + i] < 0.0 else 0)
    decide(y, sig, p, a, b)

    t = 0.0
    t_stop = t_end
    t_stuck = 0.0  # start of the present all-stuck phase
    t_loud = 0.0  # last time a ball was faster than CREEP_SPEED
    t_event = -1.0
    stalled = 0
    saved = False
    h = 0.01
    info[0] = 0.0
    info[1] = 0.0
    info[2] = 0.0
    info[3] = 1e300
    fresh = True

    while True:
        stuck = True
        fast = 0.0
        for i in range(N):
            if sig[i] != 0:
                stuck = False
            fast = max(fast, abs(y[6 + i]))
        if stuck and certain_rest(y, p):
            if not saved:
                end_state[:] = y
            return (REST if t_stuck <= t_end else MOVING), t_stuck
        if fast >= CREEP_SPEED:
            t_loud = t
            if saved:
                return MOVING, math.nan
        elif t - t_loud >= CREEP_WINDOW:
            size, excess = rest_point(y, p)
            if size < CREEP_VIBRATION and excess <= CREEP_EDGE:
                if not saved:
                    end_state[:] = y
                return CREEP, t_loud
        if t >= t_stop:
            if not saved:
                end_state[:] = y
                saved = True
            # A run at rest at the end time is continued until it is known whether it stays at rest.
            if fast >= CREEP_SPEED or t > t_end + 1e4:
                return MOVING, math.nan
            t_stop = t + 1.0
        if info[1] > MAX_EVENTS:
            if not saved:
                end_state[:] = y
            return FAILED, math.nan

        if fresh:
            derivative(y, sig, p, a, b, k[0])
            fresh = False
        h = min(h, H_MAX)
        last = t + h >= t_stop
        if last:
            h = t_stop - t
        err = step(y, k, h, sig, p, a, b, tmp, y1, rtol, atol)
        if err > 1.0:
            h *= max(0.2, 0.9 * err**-0.2)
            continue
        info[0] += 1
        for i in range(N):
            info[3] = min(info[3], b[4 + i])
        grow = 5.0 if err < 1e-4 else min(5.0, 0.9 * err**-0.2)

        # --- Is there an event in this step? --------------------------------------------
        lo = -1.0
        hi = -1.0
        gauges(y, sig, p, a, b, g)
        for i in range(N):
            gs[0, i] = g[i]
        for q in range(1, SAMPLES + 1):
            th = q / SAMPLES
            if q == SAMPLES:
                yt[:] = y1
            else:
                dense(y, y1, k, h, th, yt)
            top = gauges(yt, sig, p, a, b, g)
            for i in range(N):
                gs[q, i] = g[i]
            if top <= 0.0 and q >= 2:
                # A peak between samples: parabola through the last three.
                for i in range(N):
                    g0 = gs[q - 2, i]
                    gm = gs[q - 1, i]
                    g1 = gs[q, i]
                    if gm >= g0 and gm >= g1 and (gm > g0 or gm > g1):
                        curv = 2.0 * gm - g0 - g1
                        if gm + (g1 - g0) ** 2 / (8.0 * curv) > 0.0:
                            shift = 0.5 * (g1 - g0) / curv
                            thv = (q - 1 + shift) / SAMPLES
                            dense(y, y1, k, h, thv, yt)
                            if gauges(yt, sig, p, a, b, g) > 0.0:
                                lo = (q - 2) / SAMPLES
                                hi = thv
                                break
                if hi > 0.0:
                    break
            elif top > 0.0:
                lo = (q - 1) / SAMPLES
                hi = th
                break

        if hi < 0.0:
            t = t_stop if last else t + h
            y[:] = y1
            k[0, :] = k[6]
            if not (last and grow > 1.0):
                h *= grow
            elif last:
                h = max(h, 0.01) * grow
            continue

        # --- Locate it by repeating the step with a shorter size ------------------------
        kt[0, :] = k[0]
        step(y, kt, hi * h, sig, p, a, b, tmp, yt, rtol, atol)
        g_hi = gauges(yt, sig, p, a, b, g)
        if g_hi <= 0.0:
            # The dense output and the repeated step differ by rounding: no event yet.
            t += hi * h
            y[:] = yt
            k[0, :] = kt[6]
            continue
        g_lo = 0.0
        if lo > 0.0:
            step(y, kt, lo * h, sig, p, a, b, tmp, yt, rtol, atol)
            g_lo = gauges(yt, sig, p, a, b, g)
            if g_lo > 0.0:
                hi = lo
                g_hi = g_lo
                lo = 0.0
        if lo == 0.0:
            g_lo = gauges(y, sig, p, a, b, g)
        secant = True
        while (hi - lo) * h > EVENT_TIME_TOL:
            mid = 0.5 * (lo + hi)
            if secant and g_lo < 0.0:
                mid = lo + (hi - lo) * g_lo / (g_lo - g_hi)
                # Aims slightly past the root so that the bracket closes from above.
                mid = min(mid + 0.3 * EVENT_TIME_TOL / h, hi - 0.01 * (hi - lo))
                if mid <= lo:
                    mid = 0.5 * (lo + hi)
            width = hi - lo
            step(y, kt, mid * h, sig, p, a, b, tmp, yt, rtol, atol)
            g_mid = gauges(yt, sig, p, a, b, g)
            if g_mid > 0.0:
                hi = mid
                g_hi = g_mid
            else:
                lo = mid
                g_lo = g_mid
            if mid == lo and hi - lo == width:
                break
            secant = (hi - lo) < 0.5 * width or not secant
        step(y, kt, hi * h, sig, p, a, b, tmp, yt, rtol, atol)
        gauges(yt, sig, p, a, b, g)
        t += hi * h
        info[1] += 1
        y[:] = yt
        was_stuck = stuck

        # --- Next phase -------------------------------------------------------------------
        for i in range(N):
            if sig[i] != 0:
                speed = sig[i] * y[6 + i]
                slowing = sig[i] * kt[6, 6 + i] < 0.0
                if speed <= 0.0 or (speed < AT_REST and slowing):
                    y[6 + i] = 0.0
                    sig[i] = 0
        decide(y, sig, p, a, b)
        if t - t_event < 1e-11:
            stalled += 1
        else:
            stalled = 0
        t_event = t
        if stalled > 20:
            # Only rounding determines the phases here: hold the resting balls for a moment.
            info[2] += 1
            stalled = 0
            for i in range(N):
                if y[6 + i] == 0.0:
                    sig[i] = 0
            derivative(y, sig, p, a, b, k[0])
            step(y, k, 1e-6, sig, p, a, b, tmp, yt, rtol, atol)
            t += 1e-6
            y[:] = yt
            decide(y, sig, p, a, b)
        stuck = True
        for i in range(N):
            if sig[i] != 0:
                stuck = False
        if stuck and not was_stuck:
            t_stuck = t
        h = min(max(h, 1e-3), 0.05)
        fresh = True


@nb.njit(parallel=True)
def run_all(starts, p, t_end, rtol, atol):
    """All runs of one speed. Returns outcomes, times to rest, end states, infos."""
    n = starts.shape[0]
    outcome = np.zeros(n, np.int64)
    rest = np.zeros(n)
    ends = np.zeros((n, DIM))
    infos = np.zeros((n, 4))
    for i in nb.prange(n):
        o, tr = run(starts[i], p, t_end, rtol, atol, ends[i], infos[i])
        outcome[i] = o
        rest[i] = tr
    return outcome, rest, ends, infos


def start_states(speed):
    """One uniform sample in each of the 2^8 cells of the box (thesis 5.3)."""
    rng = np.random.default_rng([SEED, round(abs(speed) * 1e4)])
    half = (BOX_HIGH - BOX_LOW) / 2
    cells = (np.arange(256)[:, None] >> np.arange(DIM)[None, :]) & 1
    return BOX_LOW + (cells + rng.random((256, DIM))) * half


def write(path, starts, outcome, rest, ends):
    names = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"]
    with open(path, "w", newline="") as f:
        out = csv.writer(f, lineterminator="\n")
        out.writerow(names + ["label", "end_beta_1", "end_beta_2", "time_to_rest"])
        for i in range(len(starts)):
            calm = outcome[i] in (REST, CREEP)
            # The outer remainder keeps 2 pi itself out when rounding produces it.
            angles = [repr(float(v % (2 * np.pi) % (2 * np.pi))) for v in ends[i, 2:4]]
            out.writerow(
                [repr(float(v)) for v in starts[i]]
                + ["equilibrium" if calm else "moving", *angles]
                + [repr(float(rest[i])) if calm else ""]
            )


def main():
    ap = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ap.add_argument("--out", help="folder for the CSV files; without it no files are written")
    ap.add_argument("--speeds", type=float, nargs="+", default=list(SPEEDS), help="rad/s")
    args = ap.parse_args()
    for speed in args.speeds:
        starts = start_states(speed)
        t_end = END_TIME_S * natural_frequency()
        outcome, rest, ends, infos = run_all(starts, parameters(speed), t_end, RTOL, ATOL)
        calm = (outcome == REST) | (outcome == CREEP)
        print(
            f"{speed:.4f} rad/s: {calm.sum()} of {len(starts)} equilibria"
            f" ({(outcome == CREEP).sum()} creeping), failed {(outcome == FAILED).sum()};"
            f" steps {infos[:, 0].sum():.3g}, events {infos[:, 1].sum():.3g}"
            f" (most {infos[:, 1].max():.0f}), held {infos[:, 2].sum():.0f},"
            f" least f_n {infos[:, 3].min():.3g}"
        )
        if args.out:
            if (outcome == FAILED).any():
                raise SystemExit("event limit reached: no file written")
            os.makedirs(args.out, exist_ok=True)
            name = f"reference_{abs(speed):.4f}.csv"
            write(os.path.join(args.out, name), starts, outcome, rest, ends)


if __name__ == "__main__":
    main()
