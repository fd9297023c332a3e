"""A batch of runs with events in heyoka: integration and event detection are compiled, and one compiled call from
Python handles an event. A lane whose run has ended takes the next run."""

import heyoka as hy
import numpy as np

LANES = 8


class Batch:
    """An integrator of several runs with guards, whose values fall through zero at an event.

    The first of the `parameters` of a lane are the phases, as many as `phases`. `certain`: falls through zero when rest for
    good becomes certain. `switch(state, lanes, lane, guard, at_once, time, *given)`, compiled, changes the state and
    the parameters of a lane after an event, and returns whether the run rests for good."""

    def __init__(self, equations, guards, certain, tolerance, phases, parameters, switch, given):
        self.events, self.phases = 0, phases
        down = hy.event_direction.negative
        # No cooldown: the next event may follow immediately, and no event is detected twice, because a ball that breaks
        # away accelerates and a ball that stops is below its friction limit.
        events = [
            hy.t_event_batch(value, callback=callback, direction=down, cooldown=0.0)
            for value, callback in zip(guards, self.callbacks(len(guards), switch, given))
        ]
        if certain is not None:
            events.append(hy.t_event_batch(certain, direction=down))
        self.integrator = hy.taylor_adaptive_batch(
            equations, np.zeros((8, LANES)), pars=np.zeros((parameters, LANES)), tol=tolerance,
            fast_math=True, t_events=events,
        )  # fmt: skip
        self.state, self.lanes = self.integrator.state, self.integrator.pars
        self.time, self.last = self.integrator.time, np.zeros(LANES)

    def callbacks(self, guards, switch, given):
        """Yields what heyoka calls at an event of each guard."""
        for guard in range(guards):

            def callback(_, direction, lane, guard=guard):
                time = self.time[lane]
                at_once = time - self.last[lane] < 1e-12
                self.last[lane] = time
                self.events += 1
                return not switch(self.state, self.lanes, lane, guard, at_once, time, *given)

            yield callback

    def run(self, starts, phases, begin, end, enter):
        """Computes all runs from `begin` until rest or `end`. `enter(lane)` decides the phases of a run that has just been
        put into a lane, and returns whether it rests for good."""
        ta, state, lanes = self.integrator, self.state, self.lanes
        count = len(starts)
        rests, times, ends = np.zeros(count, bool), np.zeros(count), np.zeros((count, 8))
        ends_phases = np.zeros((count, self.phases))
        runs, clock = np.full(LANES, -1), np.full(LANES, end)
        begun, steps, before = 0, 0, self.events
        while True:
            for lane in np.flatnonzero(runs < 0):
                clock[lane] = end
                while begun < count:
                    run, begun = begun, begun + 1
                    state[:, lane], lanes[:, lane] = starts[run], 0.0
                    lanes[: self.phases, lane] = phases[run]
                    if enter(lane):
                        rests[run], times[run], ends[run] = True, begin, state[:, lane]
                        continue
                    clock[lane], self.last[lane], runs[lane] = begin, -1.0, run
                    ta.reset_cooldowns(int(lane))
                    break
            if (runs < 0).all():
                break
            ta.set_time(clock)
            ta.propagate_until(end)
            clock[:] = self.time
            for lane, (outcome, _, _, taken) in enumerate(ta.propagate_res):
                steps += taken
                going_on = outcome in (hy.taylor_outcome.time_limit, hy.taylor_outcome.success)
                at_end = clock[lane] >= end
                if runs[lane] < 0 or (not at_end and (going_on or int(outcome) >= 0)):
                    continue
                run = runs[lane]
                rests[run], times[run] = clock[lane] < end, clock[lane]
                ends[run], ends_phases[run] = state[:, lane], lanes[: self.phases, lane]
                runs[lane] = -1
        return {
            "rest": rests, "time": times, "state": ends, "phases": ends_phases,
            "steps": steps, "events": self.events - before,
        }  # fmt: skip
