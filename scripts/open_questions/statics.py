"""Equilibria of the thesis's machine in closed form: where friction holds two balls (docs/methods.md)."""

import math

import numpy as np

TABLE_MASS, STIFFNESS, DAMPING = 0.324, 1.07e4, 1.28
RADIUS, BALL_MASS, DIAMETER = 1.15e-2, 1.4e-4, 3.0e-3
IMBALANCE_MASS, IMBALANCE_RADIUS, FRICTION = 5.6e-5, 3.7e-2, 2.75e-3

MASS = TABLE_MASS + IMBALANCE_MASS + 2 * BALL_MASS
NATURAL = math.sqrt(STIFFNESS / MASS)
DAMPING_RATIO = DAMPING / (2 * MASS * NATURAL)
#: The angle between balls that touch.
TOUCHING = 2 * math.asin(DIAMETER / (2 * RADIUS))


def table_and_margin(first, second, speed):
    """The position of the table, non-dimensional and complex, with balls at rest at these angles, and the smallest
    unused fraction of a friction limit; negative where friction does not hold both balls."""
    ratio = speed / NATURAL
    balls = np.exp(1j * np.asarray(first)) + np.exp(1j * np.asarray(second))
    unbalance = (IMBALANCE_MASS * IMBALANCE_RADIUS / RADIUS + BALL_MASS * balls) / MASS
    table = unbalance * ratio**2 / (1 - ratio**2 + 2j * DAMPING_RATIO * ratio)
    margins = []
    for angle in (first, second):
        turned = table * np.exp(-1j * np.asarray(angle))
        # Along the ring and across it, over the square of the speed.
        margins.append(1 - np.abs(turned.imag) / (FRICTION * (1 + turned.real)))
    return table, np.minimum(*margins)


def apart(first, second):
    """Whether the balls do not overlap."""
    difference = np.abs((first - second + np.pi) % (2 * np.pi) - np.pi)
    return difference >= TOUCHING


def uniform_rests(speed, count, seed=5601):
    """Positions of the table and angles of balls that are apart, uniformly distributed in the equilibrium set."""
    draws = np.random.default_rng(seed)
    rows = []
    while len(rows) < count:
        first, second = draws.uniform(0, 2 * math.pi, 2)
        if not apart(first, second):
            continue
        table, margin = table_and_margin(first, second, speed)
        if margin > 0:
            rows.append((table.real, table.imag, first, second))
    return np.array(rows)
