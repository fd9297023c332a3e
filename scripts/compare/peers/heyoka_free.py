"""Balls that never touch, in heyoka: the events of both balls, while the disc starts and at constant speed."""

import heyoka as hy
import numba as nb
import numpy as np
from equations import (
    ACCELERATION, FRICTION, RAMP_TIME, SPEED, decisions, equations, rest, set_in_motion,
)  # fmt: skip
from equations import distance_squared as distance_from_rest
from heyoka_batch import Batch
from heyoka_system import apart, distance_squared, system

# Parameters of a lane: phase of each ball, the table's rest point, the distance from it that certifies rest, and
# whether both balls stick.
PHASE, REST, ALLOWED, STUCK, PARAMETERS = 0, 2, 4, 5, 6
# Numbers that the decisions work with: state, phases, derivatives, and the machine at the time.
WORK = 8 + 2 + 8 + 14


def reserve(p, normal, friction):
    """Returns an expression that is positive while friction holds a ball that sticks."""
    # About the tolerance of the other peers, for squared quantities.
    return (float(p[FRICTION]) * normal) ** 2.0 - friction**2.0 + 4e-15


def certainty(p, place):
    """Returns an expression that falls through zero when rest becomes certain, from the place of the rest point in the
    parameters, which the distance from it that certifies rest and whether both balls stick follow."""
    x0, y0, allowed, stuck = (hy.par[place + k] for k in range(4))
    return stuck * (distance_squared(p, x0, y0) - allowed) + (1.0 - stuck)


class FreeBalls:
    """The motion of balls that never touch; `changes`: the disc starts."""

    def __init__(self, p, changes):
        self.p, self.changes = p, changes
        self.enter, self.switch = compiled(changes)
        self.given = p, np.zeros(WORK)

    def batch(self, tolerance):
        """Compiles an integrator."""
        p = self.p
        phases = [hy.par[PHASE], hy.par[PHASE + 1]]
        rates, normals, frictions, _ = system(p, phases, apart(p, phases), self.changes)
        guards = []
        for ball, phase in enumerate(phases):
            free = phase * phase
            slips = phase * rates[6 + ball][0]
            holds = reserve(p, normals[ball], frictions[ball])
            guards.append(free * slips + (1.0 - free) * holds)
        # While the disc starts, nothing rests for good.
        certain, parameters = (None, 2) if self.changes else (certainty(p, REST), PARAMETERS)
        self.enter(np.zeros((8, 1)), np.zeros((PARAMETERS, 1)), 0, 0.0, *self.given)
        self.switch(np.zeros((8, 1)), np.zeros((PARAMETERS, 1)), 0, 0, False, 0.0, *self.given)
        return Batch(
            rates, guards, certain, tolerance, 2, parameters, self.switch, self.given
        )  # fmt: skip

    def run(self, batch, starts, phases, begin, end):
        """Computes all runs from their phases."""

        def enter(lane):
            return self.enter(batch.state, batch.lanes, lane, begin, *self.given)

        return batch.run(starts, phases, begin, end, enter)


def compiled(changes):
    """Compiles what happens to a lane at its start and at an event; both return whether it rests for good."""
    decide, after_event = decisions(equations(changes))

    @nb.njit
    def take(state, lanes, lane, time, p, work):
        y, s, scratch, now = work[:8], work[8:10], work[10:18], p
        y[:] = state[:, lane]
        s[:] = lanes[:2, lane]
        if changes:
            now = work[18:]
            now[:] = p
            now[SPEED] += p[ACCELERATION] * (time - p[RAMP_TIME])
        return y, s, scratch, now

    @nb.njit
    def put(state, lanes, lane, p, y, s):
        set_in_motion(y, s)
        state[:, lane] = y
        lanes[:2, lane] = s
        if changes:
            return False
        lanes[STUCK, lane] = 0.0
        if s[0] != 0.0 or s[1] != 0.0:
            return False
        x0, y0, allowed = rest(y, p)
        lanes[STUCK, lane] = 1.0
        lanes[REST, lane], lanes[REST + 1, lane], lanes[ALLOWED, lane] = x0, y0, allowed
        return distance_from_rest(y, x0, y0, p) <= allowed

    @nb.njit
    def enter(state, lanes, lane, time, p, work):
        y, s, scratch, now = take(state, lanes, lane, time, p, work)
        decide(y, s, -1, now, scratch)
        return put(state, lanes, lane, p, y, s)

    @nb.njit
    def switch(state, lanes, lane, ball, at_once, time, p, work):
        y, s, scratch, now = take(state, lanes, lane, time, p, work)
        after_event(y, s, ball, at_once, now, scratch)
        return put(state, lanes, lane, p, y, s)

    return enter, switch
