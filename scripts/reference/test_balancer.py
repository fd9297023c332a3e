"""Known answers about runs of the thesis's machine: order of convergence, rest without contact, running pairs."""

import math
import os
from pathlib import Path

import numpy as np
import pytest

import runs
import scheme
import starts
from machine import machine

DATA = Path(__file__).parents[2] / "tests" / "data"
THREADS = os.cpu_count()


def slope(steps, errors):
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("smooth", [False, True])
def test_order_of_convergence(smooth):
    """Order 1 with impacts, stops and break-aways; order 2 without any. The error is the median over runs."""
    one = machine(2, {"friction_coefficient": 0.0 if smooth else 2.75e-2})
    steps = [1.6e-2, 8e-3, 4e-3, 2e-3]
    common = {"contact": not smooth, "map_starts": False, "end_time_s": 10.0 / one.omega_n, "until_rest": False,
              "ball_friction": 0.1}
    rng = np.random.default_rng(4)
    errors, impacts = [], []
    for _ in range(12):
        # Ball 1 follows ball 2 and reaches it.
        beta = rng.uniform(0.0, 6.0)
        state = np.array([0.01, -0.02, beta, beta + rng.uniform(0.4, 0.8), 0.0, 0.02, rng.uniform(0.6, 1.0), 0.2])
        exact = runs.motion(one, state, runs.Options(step=1.25e-4, **common))
        impacts.append(exact.results[scheme.IMPACTS])
        ends = [runs.motion(one, state, runs.Options(step=step, **common)).end for step in steps]
        errors.append([max(abs(end - exact.end)) for end in ends])
    errors = np.median(errors, axis=0)
    order = slope(steps, errors)
    print(f"{'smooth' if smooth else 'with impacts'}: {sum(impacts):.0f} impacts, order {order:.2f}, errors "
          + ", ".join(f"{error:.1e}" for error in errors))
    assert abs(order - (2.0 if smooth else 1.0)) < 0.25
    assert smooth or min(impacts) > 0


def test_rest_without_contact():
    """The angles at rest that event_located.py found, at -160.8103 rad/s."""
    rows = runs.read(DATA / "reference_160.8103.csv")[::11]
    expected = [[float(row["end_beta_1"]), float(row["end_beta_2"])] for row in rows]
    found = runs.compute([runs.case(row, -160.8103) for row in rows], runs.Options(contact=False), THREADS)
    assert all(one["label"] == "equilibrium" and one["unsolved_steps"] == 0 for one in found)
    angles = np.array([[one["beta_1_rad"], one["beta_2_rad"]] for one in found])
    errors = np.abs((angles - expected + math.pi) % (2.0 * math.pi) - math.pi).max(axis=1)
    print(f"error of angles at rest, median {np.median(errors):.1e}, "
          f"90 % {np.quantile(errors, 0.9):.1e}, largest {errors.max():.1e}")
    assert np.median(errors) < 5e-4 and np.quantile(errors, 0.9) < 3e-3


@pytest.mark.parametrize("friction, expected", [(0.0, 72.19), (0.1, 72.02), (0.2, 71.86)])
def test_running_pair(friction, expected):
    """The thesis's two balls side by side at -247.3 rad/s (table 5.1), moved apart to touch, stay in contact. Friction
    between them slows them."""
    one = machine(2, {"speed_rad_s": -247.3})
    ahead = 3.3088 + starts.least_angle(*one.diameter) + 1e-6
    state = np.array([-0.0109, -0.0047, 3.3088, ahead, 0.0020, -0.0041, 0.4224, 0.4224])
    [found] = runs.compute([(one, state)], runs.Options(map_starts=False, ball_friction=friction, tail=0.6))
    speeds = [found["ball_speed_1_rad_s"], found["ball_speed_2_rad_s"]]
    print(f"friction {friction}: mean speeds {speeds[0]:.3f}, {speeds[1]:.3f} rad/s, known {expected}")
    assert found["touching"] == "1-2" and found["unsolved_steps"] == 0
    assert max(abs(value - expected) for value in speeds) < 0.03
