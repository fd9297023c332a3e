"""Peer: heyoka, Taylor's method of high order compiled for this machine, eight runs per batch.

The method suits smooth motion very well. With friction the phases are parameters, so that lanes can differ, and the
stop is an event, too; integration and event detection are compiled, and one compiled call from Python handles the
event. A lane whose run has ended takes the next run.
"""

import heyoka as hy
import numba as nb
import numpy as np
from equations import (
    DAMPING, DIAMETER, DRAG, FRICTION, IMBALANCE, INERTIA, MASS, ROLLING, SPEED,
    after_event, distance_squared, rest, set_in_motion,
)  # fmt: skip
from serve import serve

hy.set_logger_level_error()  # lanes at the end time give warnings

LANES = 8
NAMES = ("x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2")
# Parameters of a lane: phase of each ball, the table's rest point, the distance from it that certifies rest, and
# whether both balls stick.
PHASE, REST, ALLOWED, STUCK = 0, 2, 4, 5


def system(p, phases):
    """Returns the equations of motion and the forces on each ball, as expressions."""
    x, y, *beta, x_dot, y_dot, v1, v2 = hy.make_vars(*NAMES)
    omega, zeta, mass, mu = (float(p[i]) for i in (SPEED, DAMPING, MASS, FRICTION))
    mobility = float(1.0 / (1.0 + 4.0 * p[INERTIA]))
    linear = float(p[ROLLING] * 2.0 * p[INERTIA] * p[DIAMETER] * omega)
    quadratic = float(p[ROLLING] * -4.0 * p[INERTIA])
    matrix = [[1.0, 0.0], [0.0, 1.0]]
    force_x = float(p[IMBALANCE] * omega * omega) - x - 2.0 * zeta * (x_dot - omega * y)
    force_y = -y - 2.0 * zeta * (y_dot + omega * x)
    balls = []
    for angle, v, phase in zip(beta, (v1, v2), phases):
        s, c = hy.sin(angle), hy.cos(angle)
        w = (omega + v) * (omega + v)
        pressed = w - (linear + quadratic * v) * v
        free = 1.0 if mu == 0.0 else phase * phase
        signed = 0.0 if mu == 0.0 else mu * phase
        viscous = float(p[DRAG]) * v
        along_x, along_y = s + signed * c, signed * s - c
        mobile = mass * mobility * free
        matrix[0][0] -= mobile * s * along_x
        matrix[0][1] -= mobile * s * along_y
        matrix[1][0] += mobile * c * along_x
        matrix[1][1] += mobile * c * along_y
        held = mobile * (signed * pressed + viscous)
        force_x += mass * c * w - s * held
        force_y += mass * s * w + c * held
        balls.append((s, c, pressed, v, free, signed, viscous))
    (a, b), (c, d) = matrix
    inverse = 1.0 / (a * d - b * c)
    a_x, a_y = (d * force_x - b * force_y) * inverse, (a * force_y - c * force_x) * inverse
    accelerations, normals, frictions = [], [], []
    for s, c, pressed, v, free, signed, viscous in balls:
        along = s * a_x - c * a_y
        normal = pressed - c * a_x - s * a_y
        slip = signed * normal + viscous
        accelerations.append(free * mobility * (along - slip))
        normals.append(normal)
        frictions.append(free * slip + (1.0 - free) * along)
    turning_x = a_x + 2.0 * omega * y_dot + omega * omega * x
    turning_y = a_y - 2.0 * omega * x_dot + omega * omega * y
    moving = [ball[4] * ball[3] for ball in balls]
    rates = (x_dot, y_dot, *moving, turning_x, turning_y, *accelerations)
    variables = (x, y, *beta, x_dot, y_dot, v1, v2)
    return list(zip(variables, rates)), normals, frictions


@nb.njit
def on_event(state, lanes, lane, ball, at_once, p, y, s, scratch):
    """Decides the phases of one lane after an event, and whether it rests for good."""
    y[:] = state[:, lane]
    s[:] = lanes[:2, lane]
    after_event(y, s, ball, at_once, p, scratch)
    set_in_motion(y, s)
    state[:, lane] = y
    lanes[:2, lane] = s
    lanes[STUCK, lane] = 0.0
    if s[0] != 0.0 or s[1] != 0.0:
        return False
    x0, y0, allowed = rest(y, p)
    lanes[STUCK, lane] = 1.0
    lanes[REST, lane], lanes[REST + 1, lane], lanes[ALLOWED, lane] = x0, y0, allowed
    return distance_squared(y, x0, y0, p) <= allowed


class Peer:
    def __init__(self, parameters, end_time, starts):
        self.parameters, self.end_time, self.starts = parameters, end_time, starts
        self.smooth = parameters[FRICTION] == 0.0
        self.integrators = {}  # one per tolerance, compiled on first use

    def integrator(self, tolerance):
        p, zeros = self.parameters, np.zeros((8, LANES))
        phases = [hy.par[PHASE], hy.par[PHASE + 1]]
        equations, normals, frictions = system(p, phases)
        if self.smooth:
            return hy.taylor_adaptive_batch(equations, zeros, tol=tolerance, fast_math=True)
        views = {"events": 0}
        y, s, scratch = np.zeros(8), np.zeros(2), np.zeros(8)

        def changes(ball):
            def callback(_, direction, lane):
                time = views["time"][lane]
                at_once = time - views["last"][lane] < 1e-12
                views["last"][lane] = time
                views["events"] += 1
                state, lanes = views["state"], views["lanes"]
                return not on_event(state, lanes, lane, ball, at_once, p, y, s, scratch)

            return callback

        events = []
        down = hy.event_direction.negative
        for ball in range(2):
            phase = phases[ball]
            reserve = (float(p[FRICTION]) * normals[ball]) ** 2.0 - frictions[ball] ** 2.0
            free = phase * phase
            slips = phase * equations[6 + ball][0]
            # About the tolerance of the other peers, for squared quantities.
            guard = free * slips + (1.0 - free) * (reserve + 4e-15)
            # No cooldown: the next event may follow immediately, and no event is detected twice, because a ball that breaks
            # away accelerates and a ball that stops is below its friction limit.
            callback = changes(ball)
            events.append(hy.t_event_batch(guard, callback=callback, direction=down, cooldown=0.0))
        (x, _), (y_, _), *_, (x_dot, _), (y_dot, _), _, _ = equations
        u, v = x - hy.par[REST], y_ - hy.par[REST + 1]
        u_dot, v_dot = x_dot - float(p[SPEED]) * v, y_dot + float(p[SPEED]) * u
        distance = u * u + v * v + u_dot * u_dot + v_dot * v_dot
        certain = hy.par[STUCK] * (distance - hy.par[ALLOWED]) + (1.0 - hy.par[STUCK])
        events.append(hy.t_event_batch(certain, direction=down))
        lanes = np.zeros((6, LANES))
        integrator = hy.taylor_adaptive_batch(
            equations, zeros, pars=lanes, tol=tolerance, fast_math=True, t_events=events
        )
        views["state"], views["lanes"] = integrator.state, integrator.pars
        views["time"], views["last"] = integrator.time, np.zeros(LANES)
        return integrator, views

    def prepare(self, relative, absolute):
        if relative not in self.integrators:
            self.integrators[relative] = self.integrator(relative)
            args = np.zeros((8, 1)), np.zeros((6, 1)), 0, 0, False, self.parameters
            on_event(*args, np.zeros(8), np.zeros(2), np.zeros(8))

    def run(self, relative, absolute):
        compute = self.smooth_runs if self.smooth else self.runs_with_events
        return compute(self.integrators[relative])

    def smooth_runs(self, ta):
        ends, steps = self.starts.copy(), 0
        for first in range(0, len(ends), LANES):
            some = ends[first : first + LANES]
            ta.state[:, : len(some)] = some.T
            ta.set_time(0.0)
            ta.propagate_until(self.end_time)
            some[:] = ta.state[:, : len(some)].T
            steps += sum(result[3] for result in ta.propagate_res[: len(some)])
        count = len(ends)
        return {
            "rest": np.zeros(count, bool), "time": np.full(count, self.end_time), "state": ends,
            "steps": steps, "events": 0,
        }  # fmt: skip

    def runs_with_events(self, integrator_and_views):
        ta, views = integrator_and_views
        state, lanes, last = views["state"], views["lanes"], views["last"]
        count = len(self.starts)
        rests, times, ends = np.zeros(count, bool), np.zeros(count), np.zeros((count, 8))
        runs = np.full(LANES, -1)
        clock = np.full(LANES, self.end_time)
        begun, steps, before = 0, 0, views["events"]
        while True:
            for lane in np.flatnonzero(runs < 0):
                clock[lane] = self.end_time
                if begun < count:
                    state[:, lane] = self.starts[begun]
                    lanes[:, lane] = 0.0
                    lanes[:2, lane] = np.sign(self.starts[begun, 6:])
                    clock[lane], last[lane], runs[lane] = 0.0, -1.0, begun
                    ta.reset_cooldowns(int(lane))
                    begun += 1
            if (runs < 0).all():
                break
            ta.set_time(clock)
            ta.propagate_until(self.end_time)
            clock[:] = views["time"]
            for lane, (outcome, _, _, taken) in enumerate(ta.propagate_res):
                steps += taken
                going_on = outcome in (hy.taylor_outcome.time_limit, hy.taylor_outcome.success)
                at_end = clock[lane] >= self.end_time
                if runs[lane] < 0 or (not at_end and (going_on or int(outcome) >= 0)):
                    continue
                run = runs[lane]
                rests[run], times[run] = clock[lane] < self.end_time, clock[lane]
                ends[run] = state[:, lane]
                runs[lane] = -1
        return {
            "rest": rests, "time": times, "state": ends,
            "steps": steps, "events": views["events"] - before,
        }  # fmt: skip

    def forces(self, y, s1, s2):
        if not hasattr(self, "compiled"):
            phases = [hy.par[PHASE], hy.par[PHASE + 1]]
            equations, normals, frictions = system(self.parameters, phases)
            variables = [variable for variable, _ in equations]
            values = [rate for _, rate in equations] + normals + frictions
            self.compiled = hy.cfunc(values, variables)
        return self.compiled(y) if self.smooth else self.compiled(y, pars=[s1, s2])


if __name__ == "__main__":
    serve(Peer)
