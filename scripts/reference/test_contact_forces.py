"""Accelerations and rests in contact, compared with solutions of the equations that share no code with the scheme."""

import math
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import runs
import scheme
import starts
from machine import IMBALANCE, OMEGA, ROLLING, ZETA, machine

RECORDED = sorted((Path(__file__).parents[2] / "tests" / "data").glob("contact_*.csv"))
UNEQUAL = {"speed_rad_s": -173.1803, "ball_mass_2_kg": 3.1e-4, "ball_diameter_2_m": 4e-3, "friction_coefficient_2": 4e-3}


def direct(one, state, pairs, ball_friction):
    """Returns the balls' accelerations and the contact forces, from one linear system in which all balls roll and the
    balls of each pair (behind, ahead) accelerate alike. The unknowns are a_x, a_y, each beta_ddot and each force."""
    n, k = len(one.mass), len(pairs)
    (x, y), beta, (u, v), speed = state[:2], state[2 : 2 + n], state[2 + n : 4 + n], state[4 + n :]
    omega, zeta = one.scalars[OMEGA], one.scalars[ZETA]
    A, b = np.zeros((2 + n + k, 2 + n + k)), np.zeros(2 + n + k)
    A[0, 0] = A[1, 1] = 1.0
    b[0] = one.scalars[IMBALANCE] * omega**2 - x - 2.0 * zeta * (u - omega * y)
    b[1] = -y - 2.0 * zeta * (v + omega * x)
    for i in range(n):
        m, s, c, w = one.mass[i], math.sin(beta[i]), math.cos(beta[i]), omega + speed[i]
        A[0, 2 + i], A[1, 2 + i] = -m * s, m * c
        b[0] += m * c * w * w
        b[1] += m * s * w * w
        rolling = 0.2 * one.diameter[i] * omega * speed[i] - 0.4 * speed[i] ** 2
        limit = one.friction[i] * math.copysign(1.0, speed[i])
        # 1.4 beta_ddot = s a_x - c a_y - limit f_n + contacts, with f_n = w^2 - c a_x - s a_y - r + contacts
        A[2 + i, 0], A[2 + i, 1], A[2 + i, 2 + i] = -s - limit * c, c - limit * s, 1.4
        b[2 + i] = -limit * (w * w - one.scalars[ROLLING] * rolling)
    for row, (i, j) in enumerate(pairs):
        half = math.asin((one.diameter[i] + one.diameter[j]) / 4.0)
        grip = ball_friction * math.copysign(1.0, speed[i] + speed[j])
        turning = grip * (1.0 / math.cos(half) + math.tan(half))
        for ball, side in ((i, -1.0), (j, 1.0)):
            limit = one.friction[ball] * math.copysign(1.0, speed[ball])
            normal = math.tan(half) + side * grip
            A[2 + ball, 2 + n + row] = -(side - turning - limit * normal) / one.mass[ball]
        A[2 + n + row, 2 + j], A[2 + n + row, 2 + i] = 1.0, -1.0
    solution = np.linalg.solve(A, b)
    return solution[2 : 2 + n], solution[2 + n :]


@pytest.mark.parametrize("law", ["lagrange", "newton"])
@pytest.mark.parametrize("balls", [2, 3])
def test_accelerations_of_rolling_balls_in_contact(balls, law):
    """One step with two or three unequal balls in a row, friction on the ring and between the balls. Contacts press."""
    one = machine(balls, UNEQUAL | {"normal_force": law})
    rng = np.random.default_rng(11)
    pairs = [(i, i + 1) for i in range(balls - 1)]
    step, worst, largest, tested = 1e-5, 0.0, 0.0, 0
    while tested < 20:
        beta = rng.uniform(0.0, 6.0) + np.cumsum([0.0, *(starts.least_angle(*one.diameter[[i, j]]) for i, j in pairs)])
        beta -= 1e-12 * np.arange(balls)
        speed = np.full(balls, rng.choice([-1.0, 1.0]) * rng.uniform(0.05, 0.8))
        state = np.concatenate([rng.uniform(-0.05, 0.05, 2), beta, rng.uniform(-0.05, 0.05, 2), speed])
        expected, forces = direct(one, state, pairs, 0.1)
        if forces.min() < 1e-6:
            continue
        options = runs.Options(map_starts=False, ball_friction=0.1, step=step, end_time_s=step / one.omega_n, until_rest=False)
        made = runs.motion(one, state, options)
        assert made.results[scheme.UNSOLVED] == 0
        worst = max(worst, abs((made.end[4 + balls :] - speed) / step - expected).max())
        largest = max(largest, abs(expected).max())
        tested += 1
    print(f"{balls} balls, {law}: largest acceleration {largest:.1e}, largest error {worst:.1e}")
    assert worst < 1e-5


def rests(one, beta, ball_friction, contact=True):
    """Tells whether two touching balls, ball 2 ahead of ball 1, can be at rest. The contact force l >= 0 and the friction
    |q| <= mu_b l obey linear inequalities. They have a solution if a corner of their set is one; all sets have corners,
    because l >= |q| / mu_b. Without friction, q is absent. Without contact, l is absent too."""
    omega, zeta = one.scalars[OMEGA], one.scalars[ZETA]
    force = one.scalars[IMBALANCE] + one.mass @ np.exp(1j * beta)
    rest = omega**2 * force / (1.0 - omega**2 + 2j * zeta * omega)
    turned = omega**2 * rest * np.exp(-1j * beta)
    tangential, normal = turned.imag, omega**2 + turned.real
    half = math.asin(one.diameter.sum() / 4.0)
    kappa = 1.0 / math.cos(half) + math.tan(half)
    rows, right = [], []  # rows @ (l, q) <= right
    for ball, side in ((0, -1.0), (1, 1.0)):
        m, mu = one.mass[ball], one.friction[ball]
        drive, press = np.array([side, -kappa]) / m, np.array([math.tan(half), side]) / m
        for sign in (1.0, -1.0):
            rows.append(sign * drive - mu * press)
            right.append(mu * normal[ball] - sign * tangential[ball])
    if not contact:
        return min(right) >= 0.0
    rows += [(-1.0, 0.0), (-ball_friction, 1.0), (-ball_friction, -1.0)]
    right += [0.0, 0.0, 0.0]
    rows, right = np.array(rows), np.array(right)
    for a, b in combinations(range(len(rows)), 2):
        if abs(np.linalg.det(rows[[a, b]])) > 1e-300:
            corner = np.linalg.solve(rows[[a, b]], right[[a, b]])
            if (rows @ corner <= right + 1e-12).all():
                return True
    return False


def stays(one, beta, ball_friction):
    """Tells whether two balls, set down at rest and in contact, do not move in one step."""
    omega, zeta = one.scalars[OMEGA], one.scalars[ZETA]
    force = one.scalars[IMBALANCE] + one.mass @ np.exp(1j * beta)
    rest = omega**2 * force / (1.0 - omega**2 + 2j * zeta * omega)
    state = np.array([rest.real, rest.imag, *beta, 0.0, 0.0, 0.0, 0.0])
    options = runs.Options(map_starts=False, ball_friction=ball_friction, end_time_s=5e-3 / one.omega_n, until_rest=False)
    made = runs.motion(one, state, options)
    assert made.results[scheme.UNSOLVED] == 0
    return not made.end[6:].any()


@pytest.mark.parametrize("values, ball_friction, known", [
    ({}, 0.0, 0.3844), ({}, 0.1, None), (UNEQUAL, 0.0, None), (UNEQUAL, 0.1, None)])
def test_positions_of_rest_in_contact(values, ball_friction, known):
    """The scheme holds exactly those touching positions that the closed form of the rests allows."""
    one = machine(2, {"speed_rad_s": -173.1803} | values)
    least = starts.least_angle(*one.diameter)
    grid = (np.arange(720) + 0.5) * 2.0 * math.pi / 720
    at = [np.array([beta, beta + least - 1e-12]) for beta in grid]
    closed = np.array([rests(one, beta, ball_friction) for beta in at])
    alone = np.array([rests(one, beta, 0.0, contact=False) for beta in at])
    held = np.array([stays(one, beta, ball_friction) for beta in at])
    print(f"{values or 'thesis'}, friction between balls {ball_friction}: rests {closed.mean():.4f} of the positions, "
          f"{alone.mean():.4f} without contact; differences {(closed != held).sum()}")
    assert (closed != held).sum() <= 2
    if known is not None:
        assert abs(closed.mean() - known) < 2e-3 and abs(alone.mean() - 0.2200) < 2e-3


@pytest.mark.parametrize("path", RECORDED, ids=lambda path: path.stem)
def test_recorded_rests(path):
    """The closed form allows every recorded rest, most of those in contact only with the contact force."""
    speed, _, ball_friction = path.stem.split("_")[1:]
    one = machine(2, {"speed_rad_s": -float(speed)})
    in_contact = []
    rows = [row for row in runs.read(path) if row["label"] == "equilibrium"]
    for row in rows:
        beta = np.array([float(row["beta_1_rad"]), float(row["beta_2_rad"])])
        touching = row.get("touching")
        ordered = beta[::-1] if touching == "2-1" else beta
        assert rests(one, ordered, float(ball_friction.removeprefix("mu")), contact=bool(touching)), f"row {row['row']}"
        if touching:
            in_contact.append(rests(one, ordered, 0.0, contact=False))
    print(f"{path.stem}: {len(rows)} rests, {len(in_contact)} in contact, "
          f"{in_contact.count(False)} of these only with the contact force")
