"""Peer: heyoka, Taylor's method of high order compiled for this machine, eight runs per batch.

The method suits smooth motion very well. With friction the phases are parameters, so that lanes can differ, and the
stop is an event, too. The disc starts with an integrator of its own, whose equations depend on time. Balls that touch
have further events, and a matrix of parameters that couples their accelerations.
"""

import heyoka as hy
import numpy as np
from contact import forces_on_balls
from equations import CONTACT_ANGLE, FRICTION, RAMP_TIME
from heyoka_batch import LANES
from heyoka_contact import TouchingBalls, coupled
from heyoka_free import FreeBalls
from heyoka_system import apart, system
from serve import serve

hy.set_logger_level_error()  # lanes at the end time give warnings


class Peer:
    def __init__(self, parameters, end_time, starts):
        self.parameters, self.end_time, self.starts = parameters, end_time, starts
        self.smooth = parameters[FRICTION] == 0.0
        self.ramp_time, self.contact = parameters[RAMP_TIME], parameters[CONTACT_ANGLE] > 0.0
        self.motions = [] if self.smooth else self.stages()
        self.integrators = {}  # those of each tolerance, compiled on first use
        self.compiled = {}

    def stages(self):
        """Returns motions with their begin and end."""
        if self.contact:
            return [(TouchingBalls(self.parameters), 0.0, self.end_time)]
        steady = FreeBalls(self.parameters, changes=False), self.ramp_time, self.end_time
        if self.ramp_time == 0.0:
            return [steady]
        return [(FreeBalls(self.parameters, changes=True), 0.0, self.ramp_time), steady]

    def prepare(self, relative, absolute):
        if relative in self.integrators:
            return
        if self.smooth:
            rates, *_ = system(self.parameters, (1.0, 1.0), apart(self.parameters, (1.0, 1.0)))
            zeros = np.zeros((8, LANES))
            self.integrators[relative] = hy.taylor_adaptive_batch(
                rates, zeros, tol=relative, fast_math=True
            )
            return
        self.integrators[relative] = [motion.batch(relative) for motion, *_ in self.motions]

    def run(self, relative, absolute):
        if self.smooth:
            return self.smooth_runs(self.integrators[relative])
        states, phases = self.starts, np.sign(self.starts[:, 6:])
        steps = events = 0
        for batch, (motion, begin, end) in zip(self.integrators[relative], self.motions):
            result = motion.run(batch, states, phases, begin, end)
            states, phases = result["state"], result.pop("phases")
            steps, events = steps + result["steps"], events + result["events"]
        return result | {"steps": steps, "events": events}

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

    def forces(self, y, s1, s2, column=np.inf):
        """Returns derivatives and forces, with contact for the ball ahead of two that touch, else for a time."""
        changes = not self.contact and column < self.ramp_time
        if changes not in self.compiled:
            phases = [hy.par[0], hy.par[1]]
            respond = coupled if self.contact else apart(self.parameters, phases)
            rates, normals, frictions, _ = system(self.parameters, phases, respond, changes)
            variables = [variable for variable, _ in rates]
            values = [rate for _, rate in rates] + normals + frictions
            self.compiled[changes] = hy.cfunc(values, variables)
        given = {"time": column} if changes else {}
        if self.contact:
            mode, matrix, out = np.array([s1, s2, column]), np.zeros(4), np.zeros(8)
            between = forces_on_balls(y, mode, self.parameters, matrix, out)
            rates = self.compiled[changes](y, pars=[s1, s2, 0.0, *matrix])[:8]
            return [*rates, *out[:4], between]
        if not self.smooth:
            given["pars"] = [s1, s2]
        return self.compiled[changes](y, **given)


if __name__ == "__main__":
    serve(Peer)
