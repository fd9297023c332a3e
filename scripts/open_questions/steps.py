"""Question 4: what does a change of speed do when an equilibrium exists at one speed and not at the next?"""

import numpy as np

from . import statistics
from .cells import percent, table
from .statics import table_and_margin
from .style import FORCES, SCALE, Panel, lay_out

STUDIES = ("speed-steps",)
SPEEDS = (-160.8103, -173.1803, -179.2671, -191.6372, -216.3772)
#: A position that differs by less than this is the same one, rad.
SAME = 0.02


def _moved(before, after):
    return statistics.turn(after - before).max(axis=1)


def _runs(results):
    """For each normal force and both speeds, columns by run: at rest at the first speed; whether the position is an
    equilibrium at the second speed; at rest there, at the same place; at rest after the return, at the same place."""
    study = results[STUDIES[0]]
    stages = study.stages()
    found = {}
    for point in study.points("point_id", "normal_force", "start_speed_rad_s", "ramp_to_2_rad_s"):
        first, second, third = (
            stages[stage][stages[stage][:, 1] == point["point_id"]] for stage in (2, 4, 6)
        )
        # A run that fails after its first stage has no later ones.
        whole = np.isin(first[:, 0], second[:, 0]) & np.isin(first[:, 0], third[:, 0])
        first = first[whole]
        second, third = (rows[np.isin(rows[:, 0], first[:, 0])] for rows in (second, third))
        _, margin = table_and_margin(first[:, 3], first[:, 4], point["ramp_to_2_rad_s"])
        found[(point["normal_force"], point["start_speed_rad_s"], point["ramp_to_2_rad_s"])] = {
            "first": first[:, 2] == 1,
            "held": margin >= 0,
            "second": second[:, 2] == 1,
            "stays": (second[:, 2] == 1) & (_moved(first[:, 3:5], second[:, 3:5]) < SAME),
            "third": third[:, 2] == 1,
            "back": (third[:, 2] == 1) & (_moved(first[:, 3:5], third[:, 3:5]) < SAME),
        }
    return found


def _fraction(of, among):
    return statistics.wilson(int((of & among).sum()), int(among.sum()))


def values(results):
    found = _runs(results)
    rows = []
    for start in SPEEDS:
        for to in SPEEDS:
            if start == to:
                continue
            both = [found[(force, start, to)] for force in FORCES]
            cells = []
            for name, given in (("second", False), ("second", True), ("stays", True)):
                for one in both:
                    among = one["first"] & (one["held"] == given)
                    few = int(among.sum()) < 5
                    cells.append("–" if few else percent(_fraction(one[name], among)))
            cells += [percent(_fraction(one["back"], one["first"])) for one in both]
            held = both[0]["held"][both[0]["first"]]
            rows.append([f"{start:.1f}", f"{to:.1f}", percent(float(held.mean())), *cells])
    head = ["from, rad/s", "to, rad/s", "equilibrium at `to`, %"]
    for words in (
        "not an equilibrium: at rest",
        "equilibrium: at rest",
        "equilibrium: at the same place",
        "returned to the same place",
    ):
        head += [f"{words}, {force}, %" for force in FORCES]
    numbers = {}
    for force in FORCES:
        up = found[(force, -160.8103, -216.3772)]
        down = found[(force, -216.3772, -191.6372)]
        below = [one for key, one in found.items() if key[0] == force and -key[1] < 181 and -key[2] < 181]
        above = [one for key, one in found.items() if key[0] == force and -key[1] < 181 < -key[2]]

        def pooled(runs, of, given):
            of = np.concatenate([one[of] for one in runs])
            among = np.concatenate([one["first"] & (one["held"] == given) for one in runs])
            return percent(_fraction(of, among), 1)

        numbers[f"steps-below-lost-{force}"] = pooled(below, "second", False)
        numbers[f"steps-above-lost-{force}"] = pooled(above, "second", False)
        numbers[f"steps-above-held-{force}"] = pooled(above, "second", True)
        numbers[f"steps-up-{force}"] = percent(_fraction(up["second"], up["first"]), 1)
        numbers[f"steps-down-stay-{force}"] = percent(_fraction(down["stays"], down["first"] & down["held"]))
        numbers[f"steps-down-lost-{force}"] = percent(
            _fraction(down["second"], down["first"] & ~down["held"])
        )
    return {"steps": table(head, rows)}, numbers


def figure(results):
    found = _runs(results)
    panels = []
    for of, words in (("second", "at rest at the second speed"), ("back", "back at the same place")):
        for force in FORCES:
            grid = np.full((len(SPEEDS), len(SPEEDS)), np.nan)
            for row, start in enumerate(SPEEDS):
                for column, to in enumerate(SPEEDS):
                    if start != to:
                        one = found[(force, start, to)]
                        grid[row, column] = _fraction(one[of], one["first"])[0]

            def draw(axes, grid=grid):
                drawn = axes.imshow(np.ma.masked_invalid(grid), cmap=SCALE, vmin=0, vmax=1, origin="lower")
                for row, column in np.argwhere(np.isfinite(grid)):
                    axes.text(column, row, f"{100 * grid[row, column]:.0f}", ha="center", va="center")
                names = [f"{at:.0f}".replace("-", "−") for at in SPEEDS]
                axes.set_xticks(range(len(SPEEDS)), names)
                axes.set_yticks(range(len(SPEEDS)), names)
                axes.set_xlabel("second speed [rad/s]")
                axes.set_ylabel("first speed [rad/s]")
                return drawn

            panels.append(Panel(draw, f"{words}, {force}", 1.0, scale="fraction"))
    return lay_out(
        panels,
        columns=2,
        width="double",
        title="Steps between the thesis's speeds",
        caption="Percentage of the runs that are at rest 10 s after a step from the first to the second speed, and "
        "of those that rest at their first place after the return. The runs start at rest, uniformly distributed in "
        "the equilibrium set of the first speed.",
        alternative="Four maps of percentages over the first and the second speed, for both normal forces.",
    )
