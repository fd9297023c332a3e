"""Question 6: is the whole equilibrium set stable?"""

import math

import numpy as np

from . import statistics
from .cells import number, percent, table
from .statics import FRICTION, RADIUS, table_and_margin
from .style import DASHES, FORCES, INK, MARKS, SERIES, Panel, bars, lay_out, speed

STUDIES = ("kicks",)
SPEEDS = (-160.8103, -173.1803, -191.6372, -216.3772)
#: A ball that rolls farther has left its place, rad.
LEFT = 0.1
INERTIA = 1.4  # 1 + 4 J of a sphere


def estimated_angle(kick, at):
    """How far a kick along the ring rolls a ball that friction alone stops: the ball gets the speed kick / (1.4 L),
    and the friction μ ω² stops it."""
    start = kick / RADIUS / INERTIA
    return start**2 * INERTIA / (2 * FRICTION * at**2)


def _runs(results):
    """For each normal force, speed and kick, columns by run: friction margin before the kick, at rest after it, largest
    angle by which a ball has moved, balls that the kick lifts off."""
    study = results[STUDIES[0]]
    stages = study.stages()
    found = {}
    for point in study.points("point_id", "normal_force", "speed_rad_s", "kick_speed_m_s"):
        before, after = (stages[stage][stages[stage][:, 1] == point["point_id"]] for stage in (1, 2))
        before = before[np.isin(before[:, 0], after[:, 0])]
        rests = before[:, 2] == 1
        before, after = before[rests], after[rests]
        _, margin = table_and_margin(before[:, 3], before[:, 4], point["speed_rad_s"])
        found[(point["normal_force"], point["speed_rad_s"], point["kick_speed_m_s"])] = np.column_stack(
            [margin, after[:, 2], statistics.turn(after[:, 3:5] - before[:, 3:5]).max(axis=1), after[:, 5]]
        )
    return found


def _half(kicks, escaped):
    """The kick at which half of the runs escape, between the kicks of the study; columns of `escaped` are kicks."""
    fractions = np.maximum.accumulate(escaped.mean(axis=0))
    above = np.argmax(fractions >= 0.5) if (fractions >= 0.5).any() else None
    if above is None or above == 0:
        return math.nan
    low, high = fractions[above - 1], fractions[above]
    share = (0.5 - low) / (high - low)
    return math.exp((1 - share) * math.log(kicks[above - 1]) + share * math.log(kicks[above]))


def values(results):
    found = _runs(results)
    kicks = sorted({key[2] for key in found})
    rows, numbers = [], {}
    for at in SPEEDS:
        for force in FORCES:
            own = [found[(force, at, kick)] for kick in kicks]
            escaped = np.column_stack([1 - one[:, 1] for one in own])
            left = np.column_stack([(one[:, 2] > LEFT) | (one[:, 1] == 0) for one in own]) * 1.0
            first = next((kick for kick, column in zip(kicks, escaped.T) if column.any()), None)
            half = statistics.bootstrap(escaped, lambda draws: _half(kicks, draws), 500)
            half_left = statistics.bootstrap(left, lambda draws: _half(kicks, draws), 500)
            largest = statistics.wilson(int(escaped[:, -1].sum()), len(escaped))
            rows.append(
                [
                    f"{at:.1f}",
                    force,
                    number(1000 * first if first else math.nan, 1),
                    number(tuple(1000 * (one or math.nan) for one in half), 1),
                    number(tuple(1000 * (one or math.nan) for one in half_left), 1),
                    percent(largest),
                ]
            )
            numbers[f"kicks-half-{-at:.0f}-{force}"] = number(
                tuple(1000 * (one or math.nan) for one in half), 0
            )
            numbers[f"kicks-all-{-at:.0f}-{force}"] = percent(largest)
    head = [
        "speed, rad/s",
        "normal force",
        "smallest kick after which a run does not rest, mm/s",
        "kick after which half of the runs do not rest, mm/s",
        "kick after which half of the runs have left their place, mm/s",
        "runs not at rest after 500 mm/s, %",
    ]
    small = []
    for at in SPEEDS:
        for kick in (1e-4, 1e-3):
            cells = [f"{at:.1f}", number(1000 * kick, 1), number(1e6 * estimated_angle(kick, at), 2)]
            for force in FORCES:
                one = found[(force, at, kick)]
                cells.append(
                    number(tuple(1e6 * v for v in statistics.bootstrap(one[:, 2], np.median, 500)), 2)
                )
            one = found[(FORCES[0], at, kick)]
            for low, high in ((0.0, 0.01), (0.01, 0.1), (0.1, 1.0)):
                among = one[(one[:, 0] >= low) & (one[:, 0] < high)]
                gone = int(((among[:, 2] > LEFT) | (among[:, 1] == 0)).sum())
                cells.append(f"{gone} of {len(among)}")
            small.append(cells)
    small_head = [
        "speed, rad/s",
        "kick, mm/s",
        "estimated angle, µrad",
        "median angle, lagrange, µrad",
        "median angle, newton, µrad",
        "left with margin below 0.01",
        "left with margin 0.01 to 0.1",
        "left with margin above 0.1",
    ]
    every = np.concatenate(list(found.values()))
    numbers["kicks-lifted"] = number(statistics.bootstrap(every[:, 3], np.mean, 200), 2)
    return {"kicks": table(head, rows), "kicks-small": table(small_head, small)}, numbers


def figure(results):
    found = _runs(results)
    kicks = sorted({key[2] for key in found})
    panels = []
    for at in SPEEDS:

        def draw(axes, at=at):
            for place, (words, of) in enumerate(
                (
                    ("not at rest", lambda one: one[:, 1] == 0),
                    ("has left its place", lambda one: (one[:, 2] > LEFT) | (one[:, 1] == 0)),
                )
            ):
                for dashed, force in enumerate(FORCES):
                    estimates = [
                        statistics.wilson(
                            int(of(found[(force, at, kick)]).sum()), len(found[(force, at, kick)])
                        )
                        for kick in kicks
                    ]
                    bars(axes, np.array(kicks), estimates, place, f"{words}, {force}", bool(dashed))
            axes.set_xscale("log")
            axes.set_ylim(-0.03, 1.03)
            axes.set_xlabel("kick [m/s]")
            axes.set_ylabel("fraction")

        panels.append(Panel(draw, speed(at), 0.75))

    def draw_angles(axes):
        for place, at in enumerate(SPEEDS):
            medians = [np.median(found[(FORCES[0], at, kick)][:, 2]) for kick in kicks]
            axes.plot(
                kicks, medians, color=SERIES[place], marker=MARKS[place], label=f"median at {speed(at)}"
            )
        axes.plot(
            kicks,
            [estimated_angle(kick, -216.3772) for kick in kicks],
            color=INK,
            linestyle=DASHES[1],
            label="estimate at −216 rad/s",
        )
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylim(1e-8, 10)
        axes.set_xlabel("kick [m/s]")
        axes.set_ylabel("angle rolled [rad]")

    panels.append(Panel(draw_angles, "angle between the rests before and after the kick", 0.75))

    def draw_margin(axes):
        edges = np.array([0, 0.01, 0.03, 0.1, 0.3, 1.0])
        for place, at in enumerate(SPEEDS):
            one = np.concatenate([found[(FORCES[0], at, kick)] for kick in (3e-4, 1e-3, 3e-3)])
            shares = []
            for low, high in zip(edges[:-1], edges[1:]):
                among = one[(one[:, 0] >= low) & (one[:, 0] < high)]
                shares.append(
                    statistics.wilson(int(((among[:, 2] > LEFT) | (among[:, 1] == 0)).sum()), len(among))
                    if len(among)
                    else (None, None, None)
                )
            bars(axes, np.arange(5) + 0.05 * (2 * place - 3), shares, place)
        axes.set_xticks(range(5), ["0–0.01", "–0.03", "–0.1", "–0.3", "–1"])
        axes.set_ylim(-0.03, 1.03)
        axes.set_xlabel("friction margin before the kick")
        axes.set_ylabel("has left its place")

    panels.append(Panel(draw_margin, "kicks of 0.3 to 3 mm/s, lagrange", 0.75))
    return lay_out(
        panels,
        columns=3,
        width="double",
        title="Kicks of balls at rest",
        caption="Fraction of the runs that have left their place (by more than 0.1 rad) and of those that are not at "
        "rest 16 s after a kick, over the change of the table's velocity; angle between the rests before and after "
        "it; and the share that leaves its place after small kicks, over the friction margin. Bars: 95 % intervals.",
        alternative="Six panels over the size of the kick and over the friction margin.",
    )
