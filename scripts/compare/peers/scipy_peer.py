"""Peers: SciPy's solve_ivp, LSODA or DOP853, with right-hand side and events compiled by numba.

Many short runs are expensive: Python interprets every step and every event check, and every event is a new call of
solve_ivp.
"""

import math
import sys

import numba as nb
import numpy as np
from equations import (
    FRICTION, SLACK, SPEED, after_event, derivative, distance_squared, rest, set_in_motion, values,
)  # fmt: skip
from scipy.integrate import solve_ivp
from serve import serve


@nb.njit
def right_hand_side(_, y, s, p):
    out = np.empty(8)
    derivative(y, s[0], s[1], p, out)
    return out


@nb.njit
def guard(y, s, ball, p):
    """Returns the guard of a ball's phase, positive while it is valid: the sliding speed, or the friction reserve."""
    if s[ball] != 0.0:
        return s[ball] * y[6 + ball]
    forces = derivative(y, s[0], s[1], p, np.empty(8))
    return p[FRICTION] * forces[ball] - abs(forces[2 + ball]) + SLACK


class Event:
    """Returns an event that ends a call of solve_ivp when its value falls through zero."""

    terminal, direction = True, -1.0

    def __init__(self, value):
        self.value = value

    def __call__(self, time, y, s, p):
        return self.value(y, s, p)


class Peer:
    def __init__(self, parameters, end_time, starts, method):
        self.parameters, self.end_time, self.starts = parameters, end_time, starts
        self.method = method
        self.smooth = parameters[FRICTION] == 0.0
        self.longest = math.inf if self.smooth else 0.5 * math.pi / (abs(parameters[SPEED]) + 1.0)
        self.guards = [Event(lambda y, s, p, ball=ball: guard(y, s, ball, p)) for ball in range(2)]

    def prepare(self, relative, absolute):
        y, s = self.starts[0].copy(), np.ones(2)
        right_hand_side(0.0, y, s, self.parameters)
        guard(y, s, 0, self.parameters)
        after_event(y, s, 0, False, self.parameters, np.empty(8))
        set_in_motion(y, s)
        distance_squared(y, *rest(y, self.parameters)[:2], self.parameters)

    def run(self, relative, absolute):
        self.evaluations = self.events = 0
        outcomes = [self.run_one(start.copy(), relative, absolute) for start in self.starts]
        rests, times, ends = zip(*outcomes)
        return {
            "rest": np.array(rests), "time": np.array(times), "state": np.array(ends),
            "evaluations": self.evaluations, "events": self.events,
        }  # fmt: skip

    def run_one(self, y, relative, absolute):
        """Returns whether a run rests, its end time and its final state."""
        p = self.parameters
        s = np.sign(y[6:])
        time, last, step, scratch = 0.0, -1.0, 0.05, np.empty(8)
        events, certain = ([] if self.smooth else self.guards), None
        while time < self.end_time:
            solution = solve_ivp(
                right_hand_side, (time, self.end_time), y, method=self.method, events=events,
                args=(s, p), rtol=relative, atol=absolute, max_step=self.longest,
                first_step=min(step, self.end_time - time),
            )  # fmt: skip
            self.evaluations += solution.nfev
            time, y = solution.t[-1], solution.y[:, -1].copy()
            if solution.status != 1:
                break
            if len(solution.t) > 2:
                step = solution.t[-2] - solution.t[-3]
            if certain is not None and len(solution.t_events[2]):
                return True, time, y
            self.events += 1
            ball = 0 if len(solution.t_events[0]) else 1
            after_event(y, s, ball, time - last < 1e-12, p, scratch)
            set_in_motion(y, s)
            last, events, certain = time, self.guards, None
            if not s.any():
                x0, y0, allowed = rest(y, p)
                if distance_squared(y, x0, y0, p) <= allowed:
                    return True, time, y
                certain = Event(
                    lambda y, s, p, x=x0, z=y0, a=allowed: distance_squared(y, x, z, p) - a
                )
                events = [*self.guards, certain]
        return False, time, y

    def forces(self, y, s1, s2):
        return values(y, s1, s2, self.parameters)


if __name__ == "__main__":
    serve(lambda *cases: Peer(*cases, method=sys.argv[2]))
