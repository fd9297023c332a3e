"""Balls that cannot pass through each other, in heyoka: events for stops, break-aways and impacts, and for the force
between two balls that touch. The numbers of the mode are parameters, so that the runs of a batch can differ."""

import math

import heyoka as hy
import numba as nb
import numpy as np
from contact import couple, decide_in_touch, holding_sums, meet, reserve
from equations import (
    BALL_FRICTION, CONTACT_ANGLE, DAMPING, FRICTION, SLACK, SPEED, TURN, after_event, decide,
    distance_squared, rest, set_in_motion,
)  # fmt: skip
from heyoka_batch import Batch
from heyoka_free import certainty
from heyoka_free import reserve as reserve_of_ball
from heyoka_system import NAMES, system

# Parameters of a lane: the mode (phase of each ball, and which is ahead), the matrix of `couple`, the factors of the
# guards, and what certifies rest.
MODE, COUPLED, FACTORS, REST, PARAMETERS = 0, 3, 7, 15, 19
# Factors: a stuck first ball, what holds both balls, speed and stick of the second ball, the force between both, a
# constant, open gaps, and whether the second ball is ahead.
STICK_1, HELD, SLIP_2, STICK_2, PRESSED, NOTHING, OPEN, AHEAD = range(FACTORS, FACTORS + 8)
# A gap that opens has this width, so that its guard starts above zero; about 1e-13 rad.
OPENED = 6e-13


def coupled(forces):
    """Returns the accelerations of both balls by the forces along the ring of both."""
    first, second = forces
    k11, k12, k21, k22 = (hy.par[COUPLED + k] for k in range(4))
    return [k11 * first + k12 * second, k21 * first + k22 * second]


def held(p, normals, frictions):
    """Returns an expression that falls through zero when no force between two balls that touch holds both: the product of
    the sums of `holding_sums`, which are all positive before, each over the friction coefficient."""
    share, mu = hy.par[AHEAD], float(p[FRICTION])
    bounds = []
    for first, second in ((0, 1), (1, 0)):
        normal = share * normals[first] + (1.0 - share) * normals[second]
        friction = share * frictions[first] + (1.0 - share) * frictions[second]
        bounds += [normal - friction / mu, normal + friction / mu]
    product = 1.0
    for weights in holding_sums(p):
        terms = [float(weight) * bound for weight, bound in zip(weights, bounds) if weight != 0.0]
        product *= sum(terms) + SLACK / mu
    return product


class TouchingBalls:
    """The motion of balls that may touch."""

    def __init__(self, p):
        self.p, self.given = p, (p, holding_sums(p), np.zeros(8 + 3 + 8 + 4))

    def batch(self, tolerance):
        """Compiles an integrator."""
        p = self.p
        rates, normals, frictions, nets = system(p, [hy.par[0], hy.par[1]], coupled)
        _, _, beta_1, beta_2, _, _, v1, v2 = hy.make_vars(*NAMES)
        holds = [reserve_of_ball(p, *forces) for forces in zip(normals, frictions)]
        first = hy.par[0] * v1 + hy.par[STICK_1] * holds[0]
        first += hy.par[HELD] * held(p, normals, frictions)
        second = hy.par[SLIP_2] * v2 + hy.par[STICK_2] * holds[1]
        second += hy.par[PRESSED] * (nets[0] - nets[1]) + hy.par[NOTHING]
        # One guard for both gaps: the angle between the balls differs from half a turn by less than if they touched.
        most = (math.pi - float(p[CONTACT_ANGLE])) ** 2 + OPENED
        apart = most - (beta_2 - beta_1 - math.pi) ** 2.0
        gaps = hy.par[OPEN] * apart + (1.0 - hy.par[OPEN])
        state, lanes = np.zeros((8, 1)), np.zeros((PARAMETERS, 1))
        state[3] = math.pi
        enter(state, lanes, 0, *self.given)
        switch(state, lanes, 0, 0, False, 0.0, *self.given)
        return Batch(
            rates, [first, second, gaps], certainty(p, REST), tolerance, 3, PARAMETERS, switch,
            self.given,
        )  # fmt: skip

    def run(self, batch, starts, phases, begin, end):
        """Computes all runs, whose balls are apart at the start."""
        starts, modes = starts.copy(), np.zeros((len(starts), 3))
        starts[:, 3] = starts[:, 2] + (starts[:, 3] - starts[:, 2]) % TURN
        modes[:, :2] = phases

        def begin_lane(lane):
            return enter(batch.state, batch.lanes, lane, *self.given)

        return batch.run(starts, modes, begin, end, begin_lane)


@nb.njit
def put(state, lanes, lane, p, sums, y, m, out, matrix):
    """Writes state and mode of a lane; returns whether it rests for good."""
    set_in_motion(y, m)
    couple(m, p, matrix)
    state[:, lane] = y
    lanes[:3, lane] = m
    lanes[COUPLED : COUPLED + 4, lane] = matrix
    lanes[FACTORS : REST + 4, lane] = 0.0
    sticks = m[0] == 0.0 and m[1] == 0.0
    if m[2] == 0.0:
        lanes[STICK_1, lane], lanes[STICK_2, lane] = 1.0 - m[0] * m[0], 1.0 - m[1] * m[1]
        lanes[SLIP_2, lane], lanes[OPEN, lane] = m[1], 1.0
    elif sticks:
        lanes[HELD, lane], lanes[NOTHING, lane] = 1.0, 1.0
        lanes[AHEAD, lane] = 1.0 if m[2] > 0.0 else 0.0
    else:
        lanes[PRESSED, lane] = 0.5 * m[2] / (1.0 - p[FRICTION] * p[BALL_FRICTION])
        lanes[NOTHING, lane] = SLACK
    if not sticks:
        return False
    x0, y0, allowed = rest(y, p)
    if m[2] != 0.0:
        allowed = allowed_in_touch(y, m, x0, y0, p, sums, out)
    lanes[REST, lane], lanes[REST + 1, lane], lanes[REST + 2, lane] = x0, y0, allowed
    lanes[REST + 3, lane] = 1.0
    return distance_squared(y, x0, y0, p) <= allowed


@nb.njit
def allowed_in_touch(y, m, x0, y0, p, sums, out):
    """Returns the distance from the rest point that certifies rest, as `rest` of equations.py, of balls that touch."""
    square = p[SPEED] * p[SPEED]
    for i in range(2):
        s, c = math.sin(y[2 + i]), math.cos(y[2 + i])
        out[i] = square * (1.0 + c * x0 + s * y0)
        out[2 + i] = square * (c * y0 - s * x0)
    bound = reserve(out, m[2], p, sums) / (1.0 + p[FRICTION])
    return bound * bound / (1.0 + 4.0 * p[DAMPING] * p[DAMPING]) if bound > 0.0 else -1.0


@nb.njit
def enter(state, lanes, lane, p, sums, work):
    """Decides the phases of balls that are apart, at the start of a run; returns whether it rests for good."""
    y, m, out, matrix = work[:8], work[8:11], work[11:19], work[19:]
    y[:] = state[:, lane]
    m[:] = lanes[:3, lane]
    decide(y, m, -1, p, out)
    return put(state, lanes, lane, p, sums, y, m, out, matrix)


@nb.njit
def switch(state, lanes, lane, guard, at_once, time, p, sums, work):
    """Decides the mode after an event; returns whether the run rests for good. Guard 0 of balls that touch is the speed of
    both or what holds them, guard 1 the force between them, and guard 2 the gaps."""
    y, m, out, matrix = work[:8], work[8:11], work[11:19], work[19:]
    y[:] = state[:, lane]
    m[:] = lanes[:3, lane]
    if guard == 2:
        meet(y, m, p, sums, matrix, out)
    elif m[2] == 0.0:
        after_event(y, m, guard, at_once, p, out)
    elif guard == 1:
        m[2] = 0.0
    else:
        stops = m[0] != 0.0
        m[0] = m[1] = y[6] = y[7] = 0.0
        if not (stops and at_once):
            decide_in_touch(y, m, p, sums, matrix, out)
    # The second ball is ahead of the first by less than a turn.
    y[3] = y[2] + (y[3] - y[2]) % TURN
    return put(state, lanes, lane, p, sums, y, m, out, matrix)
