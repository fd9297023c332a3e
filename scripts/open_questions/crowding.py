"""Question 2: do contact, start-up or runout make rests crowd near β1 = β2 = π?"""

import numpy as np

from . import statistics
from .cells import percent, table
from .statics import apart, table_and_margin
from .style import DASHES, FAINT, FORCES, Panel, bars, lay_out, speed

STUDIES = ("crowding-no-contact", "crowding-any-start", "crowding-start-up")
SPEEDS = (-160.8103, -173.1803, -191.6372, -216.3772)
RUNOUTS = (1e-5, 3e-5, 1e-4)
ANGLES = (0.0, np.pi / 2, np.pi, 3 * np.pi / 2)
#: Both balls within this angle of π (or of 0) are near it.
NEAR = np.pi / 4
#: Balls whose angle differs by less than this are near β1 = β2; balls that touch differ by 15°.
ADJACENT = np.pi / 6


def near(places, angle):
    return (statistics.turn(places - angle) < NEAR).all(axis=1)


def adjacent(places):
    return statistics.turn(places[:, 0] - places[:, 1]) < ADJACENT


def _rests(results):
    """Rests and runs by study, normal force, speed, runout and the number of its angle."""
    found = {}
    for name in STUDIES[1:]:
        columns = (
            "point_id",
            "runs",
            "normal_force",
            "speed_rad_s",
            "ring_runout_m",
            "ring_runout_angle_rad",
        )
        for point in results[name].points(*columns):
            angle = int(round(point["ring_runout_angle_rad"] / (np.pi / 2))) % 4
            key = (name, point["normal_force"], point["speed_rad_s"], point["ring_runout_m"], angle)
            found[key] = results[name].rests(point["point_id"]), int(point["runs"])
    name = STUDIES[0]
    for point in results[name].points("point_id", "runs", "normal_force", "speed_rad_s"):
        key = (name, point["normal_force"], point["speed_rad_s"], 0.0, 0)
        found[key] = results[name].rests(point["point_id"]), int(point["runs"])
    return found


def _share(rests, of):
    return statistics.wilson(int(of(rests).sum()), len(rests)) if len(rests) else None


MECHANISMS = (
    ("the thesis's model: any start", STUDIES[0], 0.0, 0),
    ("contact", STUDIES[1], 0.0, 0),
    ("contact, start-up", STUDIES[2], 0.0, 0),
    ("contact, runout 30 µm at π", STUDIES[1], 3e-5, 2),
    ("contact, runout 100 µm at π", STUDIES[1], 1e-4, 2),
    ("contact, runout 100 µm at 0", STUDIES[1], 1e-4, 0),
    ("contact, start-up, runout 30 µm at π", STUDIES[2], 3e-5, 2),
    ("contact, start-up, runout 100 µm at π", STUDIES[2], 1e-4, 2),
)


def values(results):
    rests = _rests(results)
    tables = {}
    for title, of in (("crowding-pi", lambda places: near(places, np.pi)), ("crowding-adjacent", adjacent)):
        rows = []
        for words, name, runout, angle in MECHANISMS:
            for force in FORCES:
                cells = []
                for at in SPEEDS:
                    own, _ = rests[(name, force, at, runout, angle)]
                    # A share of very few rests says nothing.
                    cells.append(
                        percent(_share(own, of))
                        if len(own) >= 5
                        else f"{len(own)} rest" + "s" * (len(own) != 1)
                    )
                rows.append([words, force, *cells])
        steps = (np.arange(720) + 0.5) * 2 * np.pi / 720
        first, second = (grid.ravel() for grid in np.meshgrid(steps, steps))
        separate = apart(first, second)
        places = np.column_stack([first, second])[separate]
        cells = []
        for at in SPEEDS:
            _, margin = table_and_margin(places[:, 0], places[:, 1], at)
            cells.append(percent(float(of(places[margin >= 0]).mean())))
        rows.append(["any position of the set without runout", "both", *cells])
        tables[title] = table(["mechanism", "normal force", *(f"{at:.1f} rad/s" for at in SPEEDS)], rows)
    numbers = {}
    for force in FORCES:
        for runout in (0.0, 1e-4):
            for start, name in (("any", STUDIES[1]), ("start", STUDIES[2])):
                own, _ = rests[(name, force, -160.8103, runout, 2 if runout else 0)]
                numbers[f"crowding-{start}-{1e6 * runout:.0f}-{force}"] = percent(
                    _share(own, lambda places: near(places, np.pi))
                )
        own, _ = rests[(STUDIES[0], force, -160.8103, 0.0, 0)]
        numbers[f"crowding-thesis-{force}"] = percent(_share(own, lambda places: near(places, np.pi)))
        for at in (-191.6372, -216.3772):
            own, runs = rests[(STUDIES[2], force, at, 0.0, 0)]
            numbers[f"crowding-start-rests-{-at:.0f}-{force}"] = percent(statistics.wilson(len(own), runs), 1)
    return tables, numbers


def figure(results):
    rests = _rests(results)
    panels = []
    for name, words in ((STUDIES[1], "any start"), (STUDIES[2], "start-up")):
        for at in SPEEDS:

            def draw(axes, name=name, at=at):
                x = np.arange(4)
                for angle, label in enumerate(("0", "π/2", "π", "3π/2")):
                    for dashed, force in enumerate(FORCES):
                        estimates = []
                        for runout in (0.0, *RUNOUTS):
                            own, _ = rests[(name, force, at, runout, angle if runout else 0)]
                            share = _share(own, lambda places: near(places, np.pi)) if len(own) >= 5 else None
                            estimates.append(share or (None, None, None))
                        shift = 0.06 * (2 * angle + dashed - 3.5)
                        bars(axes, x + shift, estimates, angle, f"runout at {label}, {force}", bool(dashed))
                axes.axhline(0.5, color=FAINT, linewidth=0.6, linestyle=DASHES[2])
                axes.set_xlim(-0.4, 3.4)
                axes.set_xticks(x, ["0", "10", "30", "100"])
                axes.set_ylim(-0.03, 1.03)
                axes.set_xlabel("runout [µm]")
                axes.set_ylabel("share near π")

            panels.append(Panel(draw, f"{speed(at)}, {words}", 0.9))
    return lay_out(
        panels,
        columns=4,
        width="double",
        title="Rests near β₁ = β₂ = π",
        caption="Share of the rests at which both balls are within 45° of π, opposite to the imbalance, over the "
        "runout of the ring, for four directions of the runout from the imbalance. Fewer than 5 rests have no mark. "
        "Bars: 95 % intervals.",
        alternative="Eight panels over the runout, at four speeds, with any start and with a start of the disc.",
    )
