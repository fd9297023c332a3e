"""Known answers about runs of the thesis's machine: order of convergence, rest with and without contact, running pairs.

The variable STICKSLIP names a program whose motion without contact is compared; without it, the recorded endings in
tests/data, which event_located.py computed, take its place.
"""

import math
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import runs
import scheme
import starts
from machine import machine

DATA = Path(__file__).parents[2] / "tests" / "data"
THREADS = os.cpu_count()

# The thesis's start states of its limit cycles (table 5.1): x, y, both angles, x_dot, y_dot, both speeds.
PAIRS = {-247.3: (-0.0109, -0.0047, 3.3088, 0.0020, -0.0041, 0.4224), -309.15: (-0.01, 0.01, 1.5, -0.01, -0.01, 0.75)}
PAIR_SPEEDS = {-247.3: (72.19, 72.02, 71.86), -309.15: (133.49, 133.34, 133.20)}  # friction between balls 0, 0.1, 0.2

STUDY = """schema: 1
name: without-contact
seed: 11
model:
  kind: ball_balancer
  parameters: {speed_rad_s: -160.8103}
initial_conditions:
  box: {x: [-0.05, 0.05], "y": [-0.05, 0.05], beta: [0, 6.283185307179586], x_dot: [-0.05, 0.05], y_dot: [-0.05, 0.05],
    beta_dot: [-1, 1]}
  design: {monte_carlo: {samples: 24}}
simulation: {end_time_s: 16.5, tolerance: {relative: 1.0e-8, absolute: 1.0e-10}}
"""


# The box of start states, which is reconstructed from the thesis's counts: half widths, and angles all around.
HALF = np.array([0.05, 0.05, 0.0, 0.0, 0.05, 0.05, 1.0, 1.0])


def from_box(speed, count):
    """Returns runs with uniform start states in the box."""
    rng = np.random.default_rng(8)
    states = rng.uniform(-1.0, 1.0, (count, 8)) * HALF
    states[:, 2:4] = rng.uniform(0.0, 2.0 * math.pi, (count, 2))
    return [(machine(2, {"speed_rad_s": speed}), state) for state in states]


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


def test_rest_without_contact(tmp_path):
    """The angles at rest of another program, at -160.8103 rad/s."""
    program = os.environ.get("STICKSLIP")
    if program:
        (tmp_path / "study.yaml").write_text(STUDY)
        subprocess.run([os.path.abspath(program), "run", "study.yaml", "--quiet", "--out", "out"], cwd=tmp_path, check=True)
        rows = runs.read(tmp_path / "out" / "runs.parquet")
        expected = [[row["beta_1_rad"], row["beta_2_rad"]] for row in rows]
        assert all(row["label"] == "equilibrium" for row in rows)
    else:
        rows = runs.read(DATA / "reference_160.8103.csv")[::11]
        expected = [[float(row["end_beta_1"]), float(row["end_beta_2"])] for row in rows]
    cases = [runs.case(row, {"speed_rad_s": -160.8103}) for row in rows]
    found = runs.compute(cases, runs.Options(contact=False), THREADS)
    assert all(one["label"] == "equilibrium" and one["unsolved_steps"] == 0 for one in found)
    angles = np.array([[one["beta_1_rad"], one["beta_2_rad"]] for one in found])
    errors = np.abs((angles - expected + math.pi) % (2.0 * math.pi) - math.pi).max(axis=1)
    print(f"{program or 'recorded'}: error of angles at rest, median {np.median(errors):.1e}, "
          f"90 % {np.quantile(errors, 0.9):.1e}, largest {errors.max():.1e}")
    assert np.median(errors) < 5e-4 and np.quantile(errors, 0.9) < 3e-3


@pytest.mark.parametrize("speed, least, most", [(-173.1803, 28, 32), (-160.8103, 10, 22)])
def test_rests_in_contact(speed, least, most):
    """From the box, all runs come to rest: nearly all at -173.1803 rad/s and about half at -160.8103 rad/s in contact."""
    found = runs.compute(from_box(speed, 32), runs.Options(restitution=0.5), THREADS)
    assert all(one["label"] == "equilibrium" and one["unsolved_steps"] == 0 for one in found)
    touching = sum(bool(one["touching"]) for one in found)
    print(f"{speed} rad/s: {touching} of 32 rests in contact")
    assert least <= touching <= most


@pytest.mark.parametrize("speed", list(PAIRS))
def test_running_pairs(speed):
    """The thesis's two balls side by side, moved apart to touch, stay in contact. Friction between them slows them."""
    one = machine(2, {"speed_rad_s": speed})
    x, y, beta, x_dot, y_dot, beta_dot = PAIRS[speed]
    ahead = beta + starts.least_angle(*one.diameter) + 1e-6
    state = np.array([x, y, beta, ahead, x_dot, y_dot, beta_dot, beta_dot])
    for friction, expected in zip((0.0, 0.1, 0.2), PAIR_SPEEDS[speed]):
        options = runs.Options(map_starts=False, ball_friction=friction, end_time_s=16.5, tail=0.6)
        [found] = runs.compute([(one, state)], options)
        speeds = [found["ball_speed_1_rad_s"], found["ball_speed_2_rad_s"]]
        print(f"{speed} rad/s, friction {friction}: mean speeds {speeds[0]:.3f}, {speeds[1]:.3f} rad/s, known {expected}")
        assert found["touching"] == "1-2" and found["unsolved_steps"] == 0
        assert max(abs(value - expected) for value in speeds) < 0.03


def test_running_pair_of_a_recorded_start():
    """At -216.3772 rad/s, a run from the box becomes a pair in contact that runs at 41.46 rad/s."""
    row = runs.read(DATA / "reference_216.3772.csv")[27]
    [found] = runs.compute([runs.case(row, {"speed_rad_s": -216.3772})], runs.Options(restitution=0.5, tail=0.4))
    speeds = [found["ball_speed_1_rad_s"], found["ball_speed_2_rad_s"]]
    print(f"mean speeds {speeds[0]:.3f}, {speeds[1]:.3f} rad/s, known 41.46")
    assert found["label"] == "moving" and found["touching"] and found["unsolved_steps"] == 0
    assert max(abs(value - 41.46) for value in speeds) < 0.03


def test_three_balls_rest_in_contact():
    """The balls keep their order, and no gap is deeper than a step's motion."""
    one = machine(3, {"speed_rad_s": -173.1803, "ball_diameter_3_m": 2e-3})
    state = np.array([0.01, 0.02, 0.3, 2.0, 4.0, 0.0, 0.0, 0.5, -0.4, 0.1])
    made = runs.motion(one, state, runs.Options(ball_friction=0.1))
    found = runs.outcome(one, made)
    print(f"rest in contact: {found['touching']}; least gap {found['least_gap_rad']:.1e}")
    assert found["label"] == "equilibrium" and len(found["touching"].split()) == 2 and found["unsolved_steps"] == 0
    assert found["least_gap_rad"] > -5e-3


def test_tables(tmp_path):
    """A table of cases in both formats gives the same runs; errors name what is wrong."""
    row = {"run_id": 0, "speed_rad_s": -160.8103, "initial_x": 0.01, "initial_y": 0.0, "initial_beta_1": 1.0,
           "initial_beta_2": 1.2, "initial_x_dot": 0.0, "initial_y_dot": 0.0, "initial_beta_dot_1": 0.1,
           "initial_beta_dot_2": 0.3, "ball_mass_2_kg": 2e-4}
    results = []
    for name in ("cases.csv", "cases.parquet"):
        runs.write(tmp_path / name, [row])
        [case] = [runs.case(one, {"friction_coefficient": "3e-3"}) for one in runs.read(tmp_path / name)]
        assert case[0].friction[1] == 3e-3 and abs(case[0].mass[1] / case[0].mass[0] - 2.0 / 1.4) < 1e-12
        results.append(runs.compute([case], runs.Options(end_time_s=0.1))[0])
    assert results[0] == results[1] and results[0]["initial_beta_2"] > 1.2
    with pytest.raises(ValueError, match="row 0: balls overlap by 0.06"):
        runs.compute([case], runs.Options(map_starts=False))
    with pytest.raises(ValueError, match="no column initial_y_dot"):
        runs.case({name: cell for name, cell in row.items() if name != "initial_y_dot"}, {})
    with pytest.raises(ValueError, match="unknown parameters: ball_mas_kg"):
        runs.case(row, {"ball_mas_kg": "1"})
