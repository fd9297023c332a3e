"""The reference results of a work, computed with tight tolerances, and the errors of a tool relative to it."""

import numpy as np
from engine import Engine
from peer import TOOLS, Peer

# Allowed error of the final state of smooth motion, in any component of any run.
ERROR_ALLOWED = 1e-8
# The search for the tolerance starts here and moves by half decades, coarser or finer.
FIRST_GUESS = -9.0


class Reference:
    """Computes endings with a tight tolerance by Boost. With friction, compares them with the program's exact motion at a
    tight tolerance."""

    def __init__(self, work, stickslip, folder):
        self.smooth = work.smooth
        relative = 1e-14 if work.smooth else 1e-12
        tool = TOOLS["boost"]
        if tool.missing():
            raise SystemExit(f"compare: the reference needs {', '.join(tool.missing())}")
        peer = Peer(tool, tool.command(folder), work)
        result = peer.run(relative, 0.01 * relative)
        peer.close()
        self.rest, self.state = np.array(result["rest"]), np.array(result["state"])
        self.about = f"{tool.title} at {relative:g}"
        if not work.smooth:
            exact = Engine(stickslip, work, folder, "stickslip, event", {"method": "event"})
            program = exact.run(1e-10, 1e-12)
            differ = self.errors(program)["labels_that_differ"]
            self.about += f"; {differ} labels differ from stickslip's by event at 1e-10"

    def errors(self, result):
        """Returns the number of different labels and the errors of ball angles at rest; for smooth motion the largest
            error of a final state, of the ball angles alone if a tool lacks the other components."""
        difference = np.array(result["state"]) - self.state
        turn = 2.0 * np.pi
        difference[:, 2:4] = (difference[:, 2:4] + np.pi) % turn - np.pi
        if self.smooth:
            return {"largest_error": float(np.nanmax(np.abs(difference)))}
        rest = np.array(result["rest"])
        both = rest & self.rest
        angles = np.abs(difference[both, 2:4]).max(axis=1)
        return {
            "labels_that_differ": int((rest != self.rest).sum()),
            "median_angle_error": float(np.median(angles)) if len(angles) else None,
        }


def ladder(tool, work, reference):
    """Returns the tolerance to use and a result with it: with friction that of the study; for smooth motion the
        coarsest one, in half decades, that reaches the required accuracy of the final states."""
    if not work.smooth:
        return work.relative, tool.run(work.relative, work.absolute)
    found, exponent, step = None, FIRST_GUESS, 0.5
    while -14.0 <= exponent <= -4.0:
        relative = float(f"{10.0**exponent:.0e}")
        result = tool.run(relative, 0.01 * relative)
        allowed = reference.errors(result)["largest_error"] <= ERROR_ALLOWED
        if allowed:
            found = relative, result
        if exponent == FIRST_GUESS and not allowed:
            step = -0.5
        elif allowed != (step > 0.0):
            break
        exponent += step
    return found or (relative, result)
