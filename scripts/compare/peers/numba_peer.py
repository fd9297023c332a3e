"""Peer: a whole compiled loop in numba, DOP853 with events located on its dense output.

The whole loop is compiled. Unlike the program it does not compute several runs in vector lanes, for which numba
cannot vectorize such a loop.
"""

import math

import numba as nb
import numpy as np
from equations import FRICTION, SLACK, after_event, derivative, distance_squared, rest, values
from numba_dop853 import OPTIONS, compiled, evaluate
from serve import serve

attempt, error, interpolant = compiled(derivative)
# A quarter of the shortest period of the table in the rotating frame, so that no friction force can rise and fall
# between the ends of a step.
QUARTER = 0.5 * math.pi


@nb.njit(**OPTIONS)
def guard(y, forces, s, ball, p):
    """Returns the guard of a ball's phase, positive while it is valid: the sliding speed, or the friction reserve."""
    if s[ball] != 0.0:
        return s[ball] * y[6 + ball]
    return p[FRICTION] * forces[ball] - abs(forces[2 + ball]) + SLACK


@nb.njit(**OPTIONS)
def locate(y, f, before, after, s, ball, p, tmp, scratch):
    """Returns where a guard falls through zero in a step, by the Illinois method on the dense output; 0 if it was
        never above zero, that is if a ball stops at the instant of its break-away."""
    low, high = 0.0, 1.0
    while before <= 0.0:
        low = 0.001 if low == 0.0 else 2.0 * low
        if low >= 1.0:
            return 0.0
        evaluate(y, f, low, tmp)
        forces = derivative(tmp, s[0], s[1], p, scratch)
        before = guard(tmp, forces, s, ball, p)
    for _ in range(100):
        theta = high - after * (high - low) / (after - before)
        if not low < theta < high:
            theta = 0.5 * (low + high)
        evaluate(y, f, theta, tmp)
        forces = derivative(tmp, s[0], s[1], p, scratch)
        value = guard(tmp, forces, s, ball, p)
        if value > 0.0:
            low, before = theta, value
            after *= 0.5
        else:
            high, after = theta, value
            before *= 0.5
        if high - low < 1e-13 or abs(value) < 1e-16:
            break
    return high


@nb.njit(**OPTIONS)
def run_one(y, p, end_time, relative, absolute, smooth, work):
    """Computes one run; leaves the final state in `y`. Returns whether it rests, its end time, and counts."""
    k, tmp, end, f, scale, scratch = work
    s = np.empty(2)
    s[0], s[1] = math.copysign(1.0, y[6]), math.copysign(1.0, y[7])
    longest = 1e300 if smooth else QUARTER / (abs(p[0]) + 1.0)
    time, h, steps, evaluations, events = 0.0, 0.05, 0, 1, 0
    forces = derivative(y, s[0], s[1], p, k[0])
    x0, y0, allowed = 0.0, 0.0, -1.0
    while time < end_time:
        length = min(h, longest, end_time - time)
        end_forces = attempt(y, length, s[0], s[1], p, k, tmp, end)
        steps += 1
        evaluations += 12
        for i in range(8):
            scale[i] = absolute + relative * max(abs(y[i]), abs(end[i]))
        scale[2] = scale[3] = absolute + relative
        fault = error(y, end, length, k, scale)
        change = 0.9 * fault**-0.125 if fault > 0.0 else 6.0
        if fault > 1.0:
            h = length * max(0.333, change)
            continue
        if length >= h or change < 1.0:
            h = length * min(6.0, change)
        first, which, ready = 2.0, -1, False
        if not smooth:
            for ball in range(2):
                after = guard(end, end_forces, s, ball, p)
                if after <= 0.0:
                    before = guard(y, forces, s, ball, p)
                    if not ready:
                        interpolant(y, end, length, s[0], s[1], p, k, tmp, f)
                        evaluations += 3
                        ready = True
                    theta = locate(y, f, before, after, s, ball, p, tmp, scratch)
                    if theta < first:
                        first, which = theta, ball
        if which < 0:
            time += length
            y[:] = end
            k[0] = k[12]
            forces = end_forces
        else:
            evaluate(y, f, first, tmp)
            y[:] = tmp
            time += first * length
            after_event(y, s, which, first == 0.0, p, scratch)
            forces = derivative(y, s[0], s[1], p, k[0])
            evaluations += 2
            events += 1
            if s[0] == 0.0 and s[1] == 0.0:
                x0, y0, allowed = rest(y, p)
        stuck = not smooth and s[0] == 0.0 and s[1] == 0.0
        if stuck and distance_squared(y, x0, y0, p) <= allowed:
            return True, time, steps, evaluations, events
    return False, time, steps, evaluations, events


@nb.njit(**OPTIONS)
def run_all(y, p, end_time, relative, absolute, smooth, rests, times, counts):
    """Computes all runs; `y` holds start states before and final states after."""
    work = (np.zeros((16, 8)), np.zeros(8), np.zeros(8), np.zeros((7, 8)), np.zeros(8), np.zeros(8))
    for i in range(len(y)):
        rests[i], times[i], a, b, c = run_one(y[i], p, end_time, relative, absolute, smooth, work)
        counts[0] += a
        counts[1] += b
        counts[2] += c


class Peer:
    def __init__(self, parameters, end_time, starts):
        self.parameters, self.end_time, self.starts = parameters, end_time, starts
        self.smooth = bool(parameters[FRICTION] == 0.0)

    def prepare(self, relative, absolute):
        self.compute(self.starts[:1].copy(), relative, absolute, end_time=1.0)

    def compute(self, y, relative, absolute, end_time):
        rests, times, counts = np.zeros(len(y), np.bool_), np.zeros(len(y)), np.zeros(3, np.int64)
        p = self.parameters
        run_all(y, p, end_time, relative, absolute, self.smooth, rests, times, counts)
        steps, evaluations, events = counts.tolist()
        return {
            "rest": rests, "time": times, "state": y,
            "steps": steps, "evaluations": evaluations, "events": events,
        }  # fmt: skip

    def run(self, relative, absolute):
        return self.compute(self.starts.copy(), relative, absolute, self.end_time)

    def forces(self, y, s1, s2):
        return values(y, s1, s2, self.parameters)


if __name__ == "__main__":
    serve(Peer)
