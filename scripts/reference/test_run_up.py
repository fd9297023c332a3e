"""Known answers about a disc that starts: power of the motor, closed forms, constant speed, and the recorded runs."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import event_located as el
import run_up
from run_up import ALPHA, DIM, N, OMEGA, P_D, P_J, P_M, P_MIE, P_MU, P_ZETA, STATE, THETA, TIME, Profile

DATA = Path(__file__).parents[2] / "tests" / "data"
NATURAL = el.natural_frequency()
ECCENTRICITY = el.ECCENTRICITY / el.RING


def follow(start, profile, p, rows=0):
    """Returns the state in the fixed frame at the end, infos, and the recorded rows."""
    record, info = np.zeros((rows, STATE + N)), np.array([0.0, 0.0, math.inf])
    y, used = run_up.follow(start, profile.parts, profile.durations, p, run_up.RTOL, run_up.ATOL, info, record)
    assert used >= 0
    return y, info, record[:used]


def opposite_balls(mu, normal_force="lagrange"):
    """Returns a balanced machine, whose table stays at rest while both balls move alike, and its start state."""
    p = el.parameters(-100.0, mu, normal_force)
    p[P_MIE] = 0.0
    start = np.zeros(DIM)
    start[2:4] = 1.0, 1.0 + math.pi
    return p, start


# --- Energy -----------------------------------------------------------------------------


def energy(y, part, p):
    """Kinetic and elastic energy; analytic in the state, so that a complex step differentiates it."""
    t = y[TIME]
    omega, theta = part[OMEGA] + part[ALPHA] * t, part[THETA] + t * (part[OMEGA] + part[ALPHA] * t / 2.0)
    imbalance = p[P_MIE] / ECCENTRICITY

    def moving(radius, angle, rate):
        return (y[4] - radius * rate * np.sin(angle)) ** 2 + (y[5] + radius * rate * np.cos(angle)) ** 2

    twice = y[0] ** 2 + y[1] ** 2
    twice += (1.0 - imbalance - p[P_M] - p[P_M + 1]) * (y[4] ** 2 + y[5] ** 2)
    twice += imbalance * moving(ECCENTRICITY, theta, omega)
    for i in range(N):
        spin = p[P_D + i] * omega - 2.0 * y[6 + i]
        twice += p[P_M + i] * (moving(1.0, theta + y[2 + i], omega + y[6 + i]) + p[P_J] * spin**2)
    return twice / 2.0


def power(y, sig, part, p):
    """Returns the motor's power less what damper and friction take, and the state's time derivative.

    The motor's torque balances the imbalance's inertia, the forces that roll the balls, which act at the radius
    1 + d/2, and the resistance to rolling.
    """
    a, b, dy = np.zeros((DIM, DIM)), np.zeros(DIM), np.zeros(STATE)
    run_up.derivative(y, sig, part, p, a, b, dy)
    t, alpha = y[TIME], part[ALPHA]
    omega, theta = part[OMEGA] + alpha * t, part[THETA] + t * (part[OMEGA] + alpha * t / 2.0)
    torque = p[P_MIE] * (math.cos(theta) * b[1] - math.sin(theta) * b[0] + ECCENTRICITY * alpha)
    taken = 2.0 * p[P_ZETA] * (y[4] ** 2 + y[5] ** 2)
    for i in range(N):
        m, d = p[P_M + i], p[P_D + i]
        torque += m * (p[P_J] * (2.0 + d) * (d * alpha - 2.0 * dy[6 + i]) - b[6 + i])
        taken += m * b[6 + i] * y[6 + i]
    return omega * torque - taken, dy


def test_power_of_the_motor():
    """The energy changes at the rate of all powers, at any state, acceleration and combination of stick and slip."""
    rng = np.random.default_rng(3)
    errors, rates = [], []
    for draw in range(300):
        p = el.parameters(-100.0, mu=0.3, normal_force=("lagrange", "newton")[draw % 2])
        part = rng.uniform(-1.0, 1.0, 3)
        y = rng.uniform(-1.0, 1.0, STATE)
        sig = rng.integers(-1, 2, N)
        y[6:8] = sig * abs(y[6:8])
        expected, dy = power(y, sig, part, p)
        rates.append(energy(y + 1e-30j * dy, part, p).imag / 1e-30)
        errors.append(rates[-1] - expected)
    print(f"rate of the energy: {np.abs(rates).mean():.1e} on average, largest error {np.abs(errors).max():.1e}")
    assert np.abs(errors).max() < 1e-14 < 1e-4 < np.abs(rates).mean()


# --- Closed forms -----------------------------------------------------------------------


def test_table_with_sticking_balls():
    """With balls that stick, the table is a linear oscillator: its motion is an integral over its impulse response."""
    p = el.parameters(-200.0, mu=1e9)
    start = np.zeros(DIM)
    start[2:4] = 0.4, 1.3
    mass = p[P_MIE] + p[P_M] * (np.exp(0.4j) + np.exp(1.3j))
    zeta = p[P_ZETA]
    swing = math.sqrt(1.0 - zeta**2)
    for profile in (Profile(-20.0, [(0.4, -200.0)]), Profile(-20.0, [(0.3, -200.0), (0.1, -200.0), (0.2, -120.0)])):
        y, _, _ = follow(start, profile, p)
        expected, after = 0.0, profile.durations.sum()
        nodes, weights = np.polynomial.legendre.leggauss(400)
        for part, duration in zip(profile.parts, profile.durations):
            t = duration * (nodes + 1.0) / 2.0
            omega, theta = part[OMEGA] + part[ALPHA] * t, part[THETA] + t * (part[OMEGA] + part[ALPHA] * t / 2.0)
            force = mass * (omega**2 - 1j * part[ALPHA]) * np.exp(1j * theta)
            response = np.exp(-zeta * (after - t)) * np.sin(swing * (after - t)) / swing
            expected += duration / 2.0 * (weights @ (force * response))
            after -= duration
        error = abs(complex(y[0], y[1]) - expected)
        print(f"{profile}: displacement {abs(expected):.3e}, error {error:.1e}")
        assert error < 1e-8 * abs(expected)


def test_balls_without_friction():
    """Balls that roll freely stay behind with the constant acceleration (1 - 2 J d) alpha / (1 + 4 J)."""
    p, start = opposite_balls(0.0)
    profile = Profile(-10.0, [(0.5, -200.0), (0.2, -200.0)])
    y, _, _ = follow(start, profile, p)
    lag = -(1.0 - 2.0 * p[P_J] * p[P_D]) / (1.0 + 4.0 * p[P_J]) * profile.parts[0, ALPHA]
    first, second = profile.durations
    expected = lag * first * (first / 2.0 + second)
    print(f"angle {y[2] - 1.0:.12f}, expected {expected:.12f} rad")
    assert np.abs(y[2:4] - start[2:4] - expected).max() < 1e-8 and np.abs(y[6:8] - lag * first).max() < 1e-10


def test_balls_with_friction():
    """With the normal force of Newton's law, the absolute speed of a ball that slips obeys a Riccati equation."""
    p, start = opposite_balls(el.MU, "newton")
    profile = Profile(-60.0, [(6.0, -200.0)])
    y, info, record = follow(start, profile, p, 20_000)
    alpha = profile.parts[0, ALPHA]
    own = alpha * (4.0 * p[P_J] + 2.0 * p[P_J] * p[P_D]) / (1.0 + 4.0 * p[P_J])
    drag = p[P_MU] / (1.0 + 4.0 * p[P_J])
    scale, rate = math.sqrt(own / -drag), math.sqrt(-own * drag)
    slips = record[:, STATE] != 0
    t = record[slips, TIME]

    def relative(t):
        absolute = -scale * np.tan(rate * t + math.atan(60.0 / NATURAL / scale))
        return absolute - profile.parts[0, OMEGA] - alpha * t

    error = np.abs(record[slips, 6] - relative(t)).max()
    print(f"{slips.sum()} steps in slip, error of the speed {error:.1e}, {info[1]:.0f} events")
    assert error < 1e-9 and slips.sum() > 100 and info[1] == 1
    assert abs(relative(record[~slips, TIME].min())) < 1e-9 and (y[6:8] == 0.0).all()


def test_break_away():
    """A ball that sticks breaks away from a disc that slows down at omega^2 mu = (1 - 2 J d) |alpha|."""
    p, start = opposite_balls(el.MU)
    profile = Profile(-200.0, [(4.0, -20.0)])
    _, _, record = follow(start, profile, p, 20_000)
    slips = record[record[:, STATE] != 0]
    speed = profile.parts[0, OMEGA] + profile.parts[0, ALPHA] * slips[0, TIME]
    expected = -math.sqrt((1.0 - 2.0 * p[P_J] * p[P_D]) * profile.parts[0, ALPHA] / el.MU)
    print(f"break-away at {speed * NATURAL:.9f} rad/s, expected {expected * NATURAL:.9f} rad/s")
    # The balls run ahead of the disc, one a rounding error before the other.
    assert abs(speed - expected) < 1e-10 and (slips[1, STATE:] == -1).all()


# --- Other runs -------------------------------------------------------------------------


@pytest.mark.parametrize("normal_force", ["lagrange", "newton"])
def test_constant_speed(normal_force):
    """A profile without ramp gives the motion of event_located.py, whose equations are those of the turning frame."""
    speed, time_s = -216.3772, 1.2
    starts = el.start_states(speed)[::12]
    p = el.parameters(speed, normal_force=normal_force)
    _, _, ends, _ = el.run_all(starts, p, time_s * NATURAL, 1e-10, 1e-12)
    profile = Profile(speed, [(0.5, speed), (0.7, speed)])
    errors, events = [], 0
    for start, end in zip(starts, ends):
        y, info, _ = follow(start, profile, p)
        errors.append(np.abs(run_up.on_the_disc(y, *profile.end)[2:4] - end[2:4]).max())
        events += info[1]
    print(f"{normal_force}: {len(errors)} runs, {events:.0f} events, angles differ by at most {max(errors):.1e} rad")
    assert max(errors) < 1e-6 and events > 100


@pytest.mark.parametrize("profile", run_up.PROFILES, ids=str)
def test_recorded_runs(profile):
    """The rows in tests/data are those that the program computes."""
    with open(DATA / f"reference_run_up_{abs(profile.end_rad_s):.4f}.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    starts = run_up.recorded(profile)
    assert len(rows) == len(starts) == run_up.RUNS
    for row, start in zip(rows, starts):
        assert [float(row[f"beta_{ball + 1}_rad"]) for ball in range(N)] == list(start[2:4])
    outcome, rest, reached, ends, _ = run_up.runs(starts[:4], profile)
    for i, row in enumerate(rows[:4]):
        assert (row["label"] == "equilibrium") == (outcome[i] in (el.REST, el.CREEP))
        assert abs(float(row["time_to_rest_s"]) - rest[i] / NATURAL) < 1e-6
        for ball in range(N):
            for name, angle in (("reached", reached[i, 2 + ball]), ("end", ends[i, 2 + ball])):
                difference = (float(row[f"{name}_beta_{ball + 1}_rad"]) - angle + math.pi) % (2.0 * math.pi) - math.pi
                assert abs(difference) < 1e-6
