#!/usr/bin/env python3
"""Reference integrator for the start of a disc with the two-ball balancer and Coulomb friction.

The motor's speed is piecewise linear in time: ramps and plateaus. The machine, the
parameter vector and the scaling are those of `event_located.py`, which also integrates
the last part of each run, at constant speed, and gives the run its label. This program
integrates the parts before it. Symbols without unit are non-dimensional (lengths over L,
time times omega_n); names of quantities with a unit end with it.

Equations. All are written for a fixed frame, so that no Coriolis, centrifugal or Euler
term occurs. The disc has the angle theta(t), the speed omega and the acceleration alpha.
X, Y is the ring's centre, psi_i = theta + beta_i the direction of ball i from there, and
l_i its distance, which the ring keeps at 1 (extended Lagrange form with constraints,
thesis 3.5). With the mass M = 1 of all bodies, the position of the imbalance
X + e cos theta, Y + e sin theta, that of a ball X + l cos psi, Y + l sin psi, and the spin
of a rolling ball sigma = omega - 2 l (psi_dot - omega) / d,

    T = (1 - m_I - sum m_i) / 2 (X_dot^2 + Y_dot^2) + m_I / 2 |v_I|^2
        + sum m_i / 2 (|v_i|^2 + J (d_i sigma_i)^2),
    V = (X^2 + Y^2) / 2, damping 2 zeta per direction.

Lagrange's equations of X, Y, psi_i and l_i, the latter two over m_i, are

    X_ddot - sum m sin(psi) psi_ddot = -X - 2 zeta X_dot
        + m_I e (cos(theta) omega^2 + sin(theta) alpha) + sum m cos(psi) psi_dot^2
    Y_ddot + sum m cos(psi) psi_ddot = -Y - 2 zeta Y_dot
        + m_I e (sin(theta) omega^2 - cos(theta) alpha) + sum m sin(psi) psi_dot^2
    -sin(psi) X_ddot + cos(psi) Y_ddot + (1 + 4 J) psi_ddot + f_w = (4 J + 2 J d) alpha
    cos(psi) X_ddot + sin(psi) Y_ddot + f_n = psi_dot^2 + (dT / dl of the spin) / m
    (dT / dl of the spin) / m = -2 J (d omega - 2 beta_dot) beta_dot.

The terms with alpha in the third line are the share of the spin, whose momentum
dT / d psi_dot = -2 J (d omega - 2 beta_dot) m changes with the disc's speed. The normal
force has no term of its own with alpha: T does not depend on l_dot through the spin.
These are the equations of the thesis's normal force; that of Newton's second law is
without dT / dl of the spin. Each ball has one more row: f_w = sign mu f_n in slip, and
psi_ddot = alpha in stick. The eight unknowns come from Gaussian elimination.

Method: Dormand-Prince 5(4) steps; stops and break-aways on eight points per step and then
by bisection with repeated steps; after each of them, and at each corner of the speed, the
next phase is the consistent one among all combinations of stick and slip of the balls
without speed. A dip of an event function between these points that is shorter than an
eighth of a step goes unnoticed.
"""

import argparse
import csv
import math
from pathlib import Path

import numba as nb
import numpy as np

import event_located as el
from event_located import (
    AT_REST, BREAK_AWAY_MARGIN, DIM, EVENT_TIME_TOL, H_MAX, N, SAMPLES,
    P_D, P_J, P_M, P_MIE, P_MU, P_NEWTON, P_ZETA,
)  # fmt: skip

# State of a run in the fixed frame: X, Y, beta_1, beta_2, X_dot, Y_dot, beta_dot_1,
# beta_dot_2, and the time since the begin of the present part.
TIME = DIM
STATE = DIM + 1

# A part of the speed: disc angle and speed at its begin, and acceleration.
THETA, OMEGA, ALPHA = 0, 1, 2

RTOL = 1e-11
ATOL = 1e-2 * RTOL
MAX_EVENTS = 100_000

TABLEAU = np.zeros((7, 7))
TABLEAU[1, 0] = el.A21
TABLEAU[2, :2] = el.A31, el.A32
TABLEAU[3, :3] = el.A41, el.A42, el.A43
TABLEAU[4, :4] = el.A51, el.A52, el.A53, el.A54
TABLEAU[5, :5] = el.A61, el.A62, el.A63, el.A64, el.A65
TABLEAU[6, :6] = el.B1, 0.0, el.B3, el.B4, el.B5, el.B6
ERROR = np.array([el.E1, 0.0, el.E3, el.E4, el.E5, el.E6, el.E7])


class Profile:
    """Motor speed from `start_rad_s` over parts (duration in s, speed at its end in rad/s)."""

    def __init__(self, start_rad_s, parts):
        natural = el.natural_frequency()
        self.start_rad_s = start_rad_s
        self.parts_s_rad_s = tuple(parts)
        self.end_rad_s = parts[-1][1] if parts else start_rad_s
        self.duration_s = sum(seconds for seconds, _ in parts)
        self.durations = np.array([seconds * natural for seconds, _ in parts])
        self.parts = np.zeros((len(parts), 3))
        theta, omega = 0.0, start_rad_s / natural
        for row, duration, (_, end_rad_s) in zip(self.parts, self.durations, parts):
            alpha = (end_rad_s / natural - omega) / duration
            row[:] = theta, omega, alpha
            theta += duration * (omega + end_rad_s / natural) / 2.0
            omega = end_rad_s / natural
        self.end = np.array([theta, omega])

    def __str__(self):
        parts = [f"in {seconds:g} s to {end:g}" for seconds, end in self.parts_s_rad_s]
        return f"from {self.start_rad_s:g} rad/s " + ", ".join(parts)


@nb.njit
def solve(y, sig, part, p, a, b):
    """Accelerations and forces (X_ddot, Y_ddot, psi_ddot_i, f_n_i, f_w_i) in one phase, in b.

    sig[i]: 0 stick, +1 or -1 slip with that sign of beta_dot.
    """
    t = y[TIME]
    al = part[ALPHA]
    om = part[OMEGA] + al * t
    th = part[THETA] + t * (part[OMEGA] + 0.5 * al * t)
    jj = p[P_J]
    a[:, :] = 0.0
    a[0, 0] = 1.0
    a[1, 1] = 1.0
    b[0] = -y[0] - 2.0 * p[P_ZETA] * y[4]
    b[1] = -y[1] - 2.0 * p[P_ZETA] * y[5]
    b[0] += p[P_MIE] * (math.cos(th) * om * om + math.sin(th) * al)
    b[1] += p[P_MIE] * (math.sin(th) * om * om - math.cos(th) * al)
    for i in range(N):
        m = p[P_M + i]
        d = p[P_D + i]
        bd = y[6 + i]
        s = math.sin(th + y[2 + i])
        c = math.cos(th + y[2 + i])
        w = om + bd
        a[0, 2 + i] = -m * s
        a[1, 2 + i] = m * c
        b[0] += m * c * w * w
        b[1] += m * s * w * w
        # Coordinate psi_i.
        r = 2 + i
        a[r, 0] = -s
        a[r, 1] = c
        a[r, 2 + i] = 1.0 + 4.0 * jj
        a[r, 6 + i] = 1.0
        b[r] = (4.0 * jj + 2.0 * jj * d) * al
        # Coordinate l_i with the constraint l_i = 1; its multiplier is f_n.
        r = 4 + i
        a[r, 0] = c
        a[r, 1] = s
        a[r, 4 + i] = 1.0
        b[r] = w * w
        if p[P_NEWTON] == 0.0:
            b[r] -= 2.0 * jj * (d * om - 2.0 * bd) * bd
        # Friction law (slip) or constraint (stick).
        r = 6 + i
        if sig[i] == 0:
            a[r, 2 + i] = 1.0
            b[r] = al
        else:
            a[r, 6 + i] = 1.0
            a[r, 4 + i] = -sig[i] * p[P_MU + i]
            b[r] = 0.0
    el.gauss(a, b)


@nb.njit
def derivative(y, sig, part, p, a, b, dy):
    """Time derivative of the state; b keeps the solution of the linear system."""
    solve(y, sig, part, p, a, b)
    dy[0] = y[4]
    dy[1] = y[5]
    dy[4] = b[0]
    dy[5] = b[1]
    dy[TIME] = 1.0
    for i in range(N):
        if sig[i] == 0:
            dy[2 + i] = 0.0
            dy[6 + i] = 0.0
        else:
            dy[2 + i] = y[6 + i]
            dy[6 + i] = b[2 + i] - part[ALPHA]


@nb.njit
def step(y, k, h, sig, part, p, a, b, out, rtol, atol):
    """One Dormand-Prince step from y with k[0] = y'. Returns the error norm."""
    for stage in range(1, 7):
        for j in range(STATE):
            v = 0.0
            for q in range(stage):
                v += TABLEAU[stage, q] * k[q, j]
            out[j] = y[j] + h * v
        derivative(out, sig, part, p, a, b, k[stage])
    worst = 0.0
    for j in range(DIM):
        e = 0.0
        for q in range(7):
            e += ERROR[q] * k[q, j]
        size = 1.0 if (j == 2 or j == 3) else max(abs(y[j]), abs(out[j]))
        worst = max(worst, abs(h * e) / (atol + rtol * size))
    return worst


@nb.njit
def violation(y, sig, part, p, a, b):
    """Largest event function: positive once the phase is no longer valid."""
    solve(y, sig, part, p, a, b)
    largest = -1e300
    for i in range(N):
        if sig[i] == 0:
            v = abs(b[6 + i]) - p[P_MU + i] * b[4 + i] - BREAK_AWAY_MARGIN
        else:
            v = -sig[i] * y[6 + i]
        largest = max(largest, v)
    return largest


@nb.njit
def decide(y, sig, part, p, a, b):
    """Sets sig to the consistent combination, with as many sticking balls as possible.

    Balls with a speed keep its sign. If rounding leaves no consistent combination, the
    least inconsistent one is taken.
    """
    trial = np.zeros(N, np.int64)
    best = np.zeros(N, np.int64)
    least = 1e300
    for slipping in range(N + 1):
        for code in range(3**N):
            rest = code
            count = 0
            possible = True
            for i in range(N):
                trial[i] = (0, 1, -1)[rest % 3]
                rest //= 3
                if y[6 + i] == 0.0:
                    count += trial[i] != 0
                elif trial[i] * y[6 + i] <= 0.0:
                    possible = False
            if not possible or count != slipping:
                continue
            solve(y, trial, part, p, a, b)
            worst = -1e300
            for i in range(N):
                if y[6 + i] == 0.0:
                    if trial[i] == 0:
                        v = abs(b[6 + i]) - p[P_MU + i] * b[4 + i] - BREAK_AWAY_MARGIN
                    else:
                        v = -trial[i] * (b[2 + i] - part[ALPHA])
                    worst = max(worst, v)
            if worst < least:
                least = worst
                best[:] = trial
            if least <= 0.0:
                sig[:] = best
                return
    sig[:] = best


@nb.njit
def integrate(y, part, duration, p, rtol, atol, info, record, rows):
    """Integrates one part of the speed; y becomes the state at its end.

    info: steps, events, least f_n. The states after accepted steps go to `record` (time,
    state and stick or slip) from row `rows` on, as long as there is room; returns the
    next row, or -1 after too many events.
    """
    a = np.zeros((DIM, DIM))
    b = np.zeros(DIM)
    k = np.zeros((7, STATE))
    kt = np.zeros((7, STATE))
    y1 = np.zeros(STATE)
    yt = np.zeros(STATE)
    sig = np.zeros(N, np.int64)
    y[TIME] = 0.0
    h = 0.01
    decided = False
    while y[TIME] < duration:
        if not decided:
            decide(y, sig, part, p, a, b)
            decided = True
        derivative(y, sig, part, p, a, b, k[0])
        for i in range(N):
            info[2] = min(info[2], b[4 + i])
        if rows < len(record):
            record[rows, :STATE] = y
            record[rows, STATE:] = sig
            rows += 1
        h = min(h, H_MAX)
        last = y[TIME] + h >= duration
        taken = duration - y[TIME] if last else h
        err = step(y, k, taken, sig, part, p, a, b, y1, rtol, atol)
        if err > 1.0:
            h = taken * max(0.2, 0.9 * err**-0.2)
            continue
        info[0] += 1
        lo = 0.0
        hi = -1.0
        for q in range(1, SAMPLES + 1):
            if q == SAMPLES:
                yt[:] = y1
            else:
                el.dense(y, y1, k, taken, q / SAMPLES, yt)
                yt[TIME] = y[TIME] + taken * q / SAMPLES
            if violation(yt, sig, part, p, a, b) > 0.0:
                lo = (q - 1) / SAMPLES
                hi = q / SAMPLES
                break
        if hi < 0.0:
            y[:] = y1
            if last:
                y[TIME] = duration
            h = max(h if last else 0.0, taken * min(5.0, 0.9 * max(err, 1e-12) ** -0.2))
            continue
        # Bisection by repeated steps; the end of the bracket is the first state beyond the event.
        kt[0] = k[0]
        while (hi - lo) * taken > EVENT_TIME_TOL:
            mid = 0.5 * (lo + hi)
            if mid <= lo or mid >= hi:
                break
            step(y, kt, mid * taken, sig, part, p, a, b, yt, rtol, atol)
            if violation(yt, sig, part, p, a, b) > 0.0:
                hi = mid
            else:
                lo = mid
        step(y, kt, hi * taken, sig, part, p, a, b, yt, rtol, atol)
        if last and hi == 1.0:
            yt[TIME] = duration
        y[:] = yt
        info[1] += 1
        if info[1] > MAX_EVENTS:
            return -1
        for i in range(N):
            if sig[i] != 0:
                speed = sig[i] * y[6 + i]
                slowing = sig[i] * kt[6, 6 + i] < 0.0
                if speed <= 0.0 or (speed < AT_REST and slowing):
                    y[6 + i] = 0.0
        decided = False
        h = min(max(h, 1e-3), 0.05)
    return rows


@nb.njit
def on_the_disc(y, theta, omega):
    """State in the frame of the disc, which turns: z = Z exp(-i theta)."""
    out = y[:DIM].copy()
    turn = complex(math.cos(theta), -math.sin(theta))
    z = complex(y[0], y[1]) * turn
    v = complex(y[4], y[5]) * turn - 1j * omega * z
    out[0] = z.real
    out[1] = z.imag
    out[4] = v.real
    out[5] = v.imag
    return out


@nb.njit
def in_space(y, omega):
    """State in the fixed frame at theta = 0, of a state in the frame of the disc."""
    out = np.zeros(STATE)
    out[:DIM] = y
    out[4] = y[4] - omega * y[1]
    out[5] = y[5] + omega * y[0]
    return out


@nb.njit
def follow(start, parts, durations, p, rtol, atol, info, record):
    """State in the fixed frame after all parts, of a start state in the frame of the disc."""
    y = in_space(start, parts[0, OMEGA])
    rows = 0
    for q in range(len(durations)):
        rows = integrate(y, parts[q], durations[q], p, rtol, atol, info, record, rows)
        if rows < 0:
            break
    return y, rows


@nb.njit(parallel=True)
def run_all(starts, parts, durations, end, p, t_end, rtol, atol):
    """All runs: start states in the frame of the disc, parts of the speed, then constant speed.

    end: disc angle and speed after all parts; t_end: end time after them. Returns
    outcomes, times to rest since the end of the parts, states on the disc at the end of
    the parts and of the run, and infos: steps, events and least f_n of the parts.
    """
    n = len(starts)
    outcome = np.zeros(n, np.int64)
    rest = np.zeros(n)
    reached = np.zeros((n, DIM))
    ends = np.zeros((n, DIM))
    infos = np.zeros((n, 3))
    for i in nb.prange(n):
        infos[i, 2] = 1e300
        nothing = np.zeros((0, STATE + N))
        y, rows = follow(starts[i], parts, durations, p, rtol, atol, infos[i], nothing)
        if rows < 0:
            outcome[i] = el.FAILED
            continue
        reached[i] = on_the_disc(y, end[0], end[1])
        outcome[i], rest[i] = el.run(reached[i], p, t_end, rtol, atol, ends[i], np.zeros(4))
    return outcome, rest, reached, ends, infos


# --- The recorded runs ------------------------------------------------------------------
# All balls slip throughout the single ramp. The plateaus of the other profiles let balls
# come to rest, and their second ramps break some of them away; the last one passes the
# natural frequency.
PROFILES = (
    Profile(-10.0, [(3.0, -160.8103)]),
    Profile(-10.0, [(2.0, -140.0), (4.0, -140.0), (1.5, -173.1803)]),
    Profile(-10.0, [(2.0, -160.0), (3.0, -160.0), (4.0, -216.3772)]),
)
AFTER_THE_RAMP_S = 8.0
RUNS = 64
SEED = 20261124


def recorded(profile):
    """Start states of the recorded runs of a profile: table and balls at rest on the disc, the balls at uniform angles."""
    starts = np.zeros((RUNS, DIM))
    seed = [SEED, round(abs(profile.end_rad_s) * 1e4)]
    starts[:, 2:4] = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, (RUNS, 2))
    return starts


def runs(starts, profile):
    """`run_all` for a profile."""
    p = el.parameters(profile.end_rad_s)
    t_end = AFTER_THE_RAMP_S * el.natural_frequency()
    return run_all(starts, profile.parts, profile.durations, profile.end, p, t_end, RTOL, ATOL)


def write(path, starts, outcome, rest, reached, ends):
    natural = el.natural_frequency()
    names = ["beta_{}_rad", "reached_beta_{}_rad", "reached_ball_speed_{}_rad_s", "end_beta_{}_rad"]
    header = [name.format(ball + 1) for name in names for ball in range(N)]
    with open(path, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(header + ["label", "time_to_rest_s"])
        for i in range(len(starts)):
            calm = outcome[i] in (el.REST, el.CREEP)
            # The outer remainder keeps 2 pi itself out when rounding produces it.
            angles = [s[2:4] % (2 * np.pi) % (2 * np.pi) for s in (starts[i], reached[i], ends[i])]
            numbers = [*angles[0], *angles[1], *(reached[i, 6:8] * natural), *angles[2]]
            out.writerow(
                [repr(float(number)) for number in numbers]
                + ["equilibrium" if calm else "moving", repr(float(rest[i] / natural)) if calm else ""]
            )


def main():
    ap = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ap.add_argument("--out", type=Path, help="folder for the CSV files; without it no files are written")
    args = ap.parse_args()
    natural = el.natural_frequency()
    for profile in PROFILES:
        starts = recorded(profile)
        outcome, rest, reached, ends, infos = runs(starts, profile)
        calm = (outcome == el.REST) | (outcome == el.CREEP)
        print(
            f"{profile}: {calm.sum()} of {RUNS} equilibria ({(outcome == el.CREEP).sum()} creeping), failed"
            f" {(outcome == el.FAILED).sum()}; balls at rest at the end of the ramp {(reached[:, 6:] == 0.0).sum()},"
            f" stops and break-aways before it {infos[:, 1].sum():.0f}, least f_n {infos[:, 2].min():.2g};"
            f" time to rest, median {np.median(rest[calm]) / natural:.3g} s, longest {rest[calm].max() / natural:.3g} s"
        )
        if args.out:
            if (outcome == el.FAILED).any():
                raise SystemExit("event limit reached: no file written")
            args.out.mkdir(parents=True, exist_ok=True)
            name = f"reference_run_up_{abs(profile.end_rad_s):.4f}.csv"
            write(args.out / name, starts, outcome, rest, reached, ends)


if __name__ == "__main__":
    main()
