"""Runs of a table: the arrays that the scheme needs, the results by name, and tables in CSV."""

import csv
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

import machine as machines
import scheme
import starts

OVERLAP = 1e-9  # allowed overlap of given start states, in rad


def read(path):
    """Returns the rows of a table as dictionaries. Empty cells are absent."""
    with open(path, newline="") as file:
        return [{name: cell for name, cell in row.items() if cell} for row in csv.DictReader(file)]


def case(row, speed_rad_s):
    """Returns the machine at a speed, and the start state of a row of `reference_<speed>.csv`."""
    names = ("x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2")
    return machines.machine(2, {"speed_rad_s": speed_rad_s}), np.array([float(row[name]) for name in names])


class Options(NamedTuple):
    """How to integrate. `tail` is the last part of the run, as a fraction, for the mean speeds. With `until_rest` a run
    ends before the end time if it is at rest. Without `contact` the balls pass through each other."""

    contact: bool = True
    map_starts: bool = True
    restitution: float = 0.36
    ball_friction: float = 0.0
    step: float = 5e-3
    end_time_s: float = 16.5
    tail: float = 0.2
    until_rest: bool = True


class Motion(NamedTuple):
    """A run: its first and last state with unwrapped angles, neighbours, numbers and mean speeds."""

    start: np.ndarray
    end: np.ndarray
    pairs: np.ndarray
    angles: np.ndarray
    results: np.ndarray
    speeds: np.ndarray


def motion(machine, state, options):
    """Integrates one run."""
    n = len(machine.mass)
    state = np.array(state, float)
    pairs, angles = np.zeros((0, 2), np.int64), np.zeros(0)
    if options.contact:
        beta = starts.apart(state[2 : 2 + n], machine.diameter) if options.map_starts else state[2 : 2 + n]
        order = starts.order_on_ring(beta)
        state[2 : 2 + n] = starts.unwrapped(beta, order)
        pairs, angles = starts.neighbours(order, machine.diameter)
        least = starts.gaps(state[2 : 2 + n], pairs, angles).min(initial=math.inf)
        if least < -OVERLAP:
            raise ValueError(f"balls overlap by {-least:.6g} rad")
    start = state.copy()
    steps = round(options.end_time_s * machine.omega_n / options.step)
    results, speeds = np.zeros(scheme.RESULTS), np.zeros(n)
    law = np.array([options.restitution, options.ball_friction])
    scheme.run(state, options.step, steps, *machine[:4], pairs, angles, law, options.until_rest,
               round(options.tail * steps), results, speeds)
    return Motion(start, state, pairs, angles, results, speeds)


def compute(cases, options, threads=1):
    """Integrates (machine, state) pairs and returns the results of each run by name."""

    # The compiled function releases Python's lock.
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(lambda one: outcome(one[0], motion(*one, options)), cases))


def outcome(machine, motion):
    """Returns the results of a run by name, in SI units."""
    n, omega_n, results = len(machine.mass), machine.omega_n, motion.results
    end_gaps = starts.gaps(motion.end[2 : 2 + n], motion.pairs, motion.angles)
    # A contact persists at a gap of zero, or at the depth that the step of its last impact reached.
    touching = [f"{i + 1}-{j + 1}" for (i, j), gap in zip(motion.pairs, end_gaps) if gap <= 1e-9]
    at_rest = bool(results[scheme.AT_REST])
    row = {"label": "equilibrium" if at_rest else "moving"}
    row["time_to_rest_s"] = float((results[scheme.END_TIME] - results[scheme.STILL_FOR]) / omega_n) if at_rest else None
    row["touching"] = " ".join(touching)
    row["impacts"] = int(results[scheme.IMPACTS])
    for ball in range(n):
        row[f"beta_{ball + 1}_rad"] = float(motion.end[2 + ball] % starts.TURN)
    for ball in range(n):
        row[f"ball_speed_{ball + 1}_rad_s"] = float(motion.speeds[ball] * omega_n)
    row["least_gap_rad"] = float(results[scheme.LEAST_GAP]) if len(motion.pairs) else None
    row["lifted_steps"] = int(results[scheme.LIFTED])
    row["unsolved_steps"] = int(results[scheme.UNSOLVED])
    return row


def compact(result):
    """Returns the results that comparisons need, with as many digits as the method can have."""
    digits = {"label": None, "touching": None, "time_to_rest_s": 4, "impacts": None}
    balls = sum(name.startswith("ball_speed_") for name in result)
    digits |= {f"beta_{ball + 1}_rad": 6 for ball in range(balls)}
    digits |= {f"ball_speed_{ball + 1}_rad_s": 4 for ball in range(balls)}
    cells = {name: result[name] for name in digits}
    return {name: round(cell, digits[name]) if isinstance(cell, float) else cell for name, cell in cells.items()}


def summary(results):
    """Returns a text with counts over runs."""
    rest = [one for one in results if one["label"] == "equilibrium"]
    moving = [one for one in results if one["label"] != "equilibrium"]
    total = {name: sum(one[name] for one in results) for name in ("impacts", "lifted_steps", "unsolved_steps")}
    text = (f"{len(results)} runs: {len(rest)} at rest, {sum(bool(one['touching']) for one in rest)} of these in contact; "
            f"{len(moving)} moving, {sum(bool(one['touching']) for one in moving)} of these in contact")
    return (f"{text}\nimpacts {total['impacts']}, steps in which a ball lifts off the ring {total['lifted_steps']}, "
            f"unsolved steps {total['unsolved_steps']}")


def write(path, rows):
    """Writes dictionaries as CSV."""
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
