"""Runs of a table: the arrays that the scheme needs, the results by name, and tables of cases in CSV or Parquet."""

import csv
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

import machine as machines
import scheme
import starts

OVERLAP = 1e-9  # allowed overlap of given start states, in rad


def components(balls):
    """Returns the names of a state's components in the tables of the program."""
    each = range(1, balls + 1)
    angles, speeds = [f"beta_{ball}" for ball in each], [f"beta_dot_{ball}" for ball in each]
    return ["x", "y", *angles, "x_dot", "y_dot", *speeds]


def read(path):
    """Returns the rows of a table of cases as dictionaries. Empty cells are absent."""
    if str(path).endswith(".parquet"):
        import pyarrow.parquet

        rows = pyarrow.parquet.read_table(path).to_pylist()
    else:
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
    return [{name: cell for name, cell in row.items() if cell not in (None, "")} for row in rows]


def number_of_balls(row):
    """Returns the number of balls of a row."""
    balls = 0
    while f"initial_beta_{balls + 1}" in row or f"beta_{balls + 1}" in row:
        balls += 1
    if not 1 <= balls <= 8:
        raise ValueError(f"found {balls} columns initial_beta_K; allowed: 1 to 8 balls")
    return balls


def case(row, constants):
    """Returns the machine and the start state of a row. A column of the table precedes a constant."""
    balls = number_of_balls(row)
    known = machines.names(balls)
    values = {**constants, **{name: row[name] for name in known if name in row}}
    values = {name: cell if name == "normal_force" else float(cell) for name, cell in values.items()}
    cells = {name: row.get(f"initial_{name}", row.get(name)) for name in components(balls)}
    absent = [name for name, cell in cells.items() if cell is None]
    if absent:
        raise ValueError(f"found no column initial_{absent[0]}")
    return machines.machine(balls, values), np.array([float(cell) for cell in cells.values()])


class Options(NamedTuple):
    """How to integrate. `tail` is the last part of the run, as a fraction, for the mean speeds. With `until_rest` a run
    ends before the end time if it is at rest. Without `contact` the balls pass through each other. `samples` is the
    number of states to keep on the way."""

    contact: bool = True
    map_starts: bool = True
    restitution: float = 0.36
    ball_friction: float = 0.0
    ring_impulse: bool = False
    step: float = 5e-3
    end_time_s: float = 16.5
    tail: float = 0.2
    until_rest: bool = True
    samples: int = 0


class Motion(NamedTuple):
    """A run: its first and last state with unwrapped angles, neighbours, numbers, mean speeds, and states on the way."""

    start: np.ndarray
    end: np.ndarray
    pairs: np.ndarray
    angles: np.ndarray
    results: np.ndarray
    speeds: np.ndarray
    samples: np.ndarray


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
    samples = np.zeros((options.samples, len(state)))
    law = np.array([options.restitution, options.ball_friction, float(options.ring_impulse)])
    scheme.run(state, options.step, steps, *machine[:4], pairs, angles, law, options.until_rest,
               round(options.tail * steps), results, speeds, samples)
    return Motion(start, state, pairs, angles, results, speeds, samples)


def compute(cases, options, threads=1):
    """Integrates (machine, state) pairs and returns the results of each run by name."""

    def result(row):
        machine, state = cases[row]
        try:
            return outcome(machine, motion(machine, state, options))
        except ValueError as error:
            raise ValueError(f"row {row}: {error}") from error

    if len({len(machine.mass) for machine, _ in cases}) > 1:
        raise ValueError("all rows need the same number of balls")
    # The compiled function releases Python's lock.
    with ThreadPoolExecutor(threads) as pool:
        return list(pool.map(result, range(len(cases))))


def outcome(machine, motion):
    """Returns the results of a run by name, in SI units; start states remain non-dimensional."""
    n, omega_n, results = len(machine.mass), machine.omega_n, motion.results
    end_gaps = starts.gaps(motion.end[2 : 2 + n], motion.pairs, motion.angles)
    # A contact persists at a gap of zero, or at the depth that the step of its last impact reached.
    touching = [f"{i + 1}-{j + 1}" for (i, j), gap in zip(motion.pairs, end_gaps) if gap <= 1e-9]
    row = {f"initial_{name}": float(value) for name, value in zip(components(n), motion.start)}
    at_rest = bool(results[scheme.AT_REST])
    row["label"] = "equilibrium" if at_rest else "moving"
    row["time_to_rest_s"] = float((results[scheme.END_TIME] - results[scheme.STILL_FOR]) / omega_n) if at_rest else None
    row["touching"] = " ".join(touching)
    row["impacts"] = int(results[scheme.IMPACTS])
    row["end_time_s"] = float(results[scheme.END_TIME] / omega_n)
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
    """Writes dictionaries as CSV or, by the ending, as Parquet."""
    if str(path).endswith(".parquet"):
        import pyarrow
        import pyarrow.parquet

        pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows), path)
        return
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
