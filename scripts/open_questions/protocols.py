"""Question 1: do protocols I and II lead to different rest positions?"""

import numpy as np

from . import statistics
from .cells import number, percent, table
from .style import DASHES, FAINT, FORCES, Panel, bars, lay_out, speed

STUDIES = ("protocols", "protocols-no-contact")
SPEEDS = (-160.8103, -173.1803, -191.6372, -216.3772)
CONTACT = {"protocols": "yes", "protocols-no-contact": "no"}
LEVEL = 0.05
HITS = 3


def _samples(results):
    """For each study, normal force, speed, ramp and hit: runs and rests after protocol I and after protocol II.

    Protocol I takes the runs with even numbers, and protocol II those with odd numbers, so that the samples are
    independent."""
    found = {}
    for name in STUDIES:
        stages = results[name].stages()
        for point in results[name].points(
            "point_id", "normal_force", "speed_rad_s", "kick_speed_m_s", "ramp_over_s"
        ):
            key = (
                name,
                point["normal_force"],
                point["speed_rad_s"],
                point["ramp_over_s"],
                point["kick_speed_m_s"],
            )
            both = []
            for stage, odd in ((2, 0), (2 + HITS, 1)):
                rows = stages[stage]
                rows = rows[(rows[:, 1] == point["point_id"]) & (rows[:, 0] % 2 == odd)]
                both.append((len(rows), rows[rows[:, 2] == 1][:, 3:5]))
            found[key] = both
    return found


def _compared(samples, keys):
    """Both tests for each key, with Holm's correction over all of them."""
    rows, p_rest, p_place = [], [], []
    for key in keys:
        (runs_1, rests_1), (runs_2, rests_2) = samples[key]
        p_rest.append(statistics.fisher(len(rests_1), runs_1, len(rests_2), runs_2))
        coefficient, p = statistics.energy(rests_1, rests_2)
        p_place.append(p)
        rows.append((key, (runs_1, rests_1), (runs_2, rests_2), coefficient))
    adjusted = statistics.holm(p_rest + p_place)
    return [(*row, adjusted[place], adjusted[len(rows) + place]) for place, row in enumerate(rows)]


def _test(p):
    if p is None:
        return "too few rests"
    return (
        ("different" if p < LEVEL else "not shown")
        + f", p = {p:.2g}" * (p >= 0.001)
        + ", p < 0.001" * (p < 0.001)
    )


def values(results):
    samples = _samples(results)
    keys = [
        (name, force, at, ramp, 0.1)
        for ramp in (2.0, 20.0)
        for name in STUDIES
        for at in SPEEDS
        for force in FORCES
    ]
    compared = _compared(samples, keys)
    head = [
        "contact",
        "speed, rad/s",
        "normal force",
        "at rest in I, %",
        "at rest in II, %",
        "are the fractions different?",
        "coefficient of the positions",
        "are the positions different?",
    ]
    tables, numbers = {}, {}
    for title, ramp in (("protocols", 2.0), ("protocols-slow", 20.0)):
        rows = []
        for key, (runs_1, rests_1), (runs_2, rests_2), coefficient, p_rest, p_place in compared:
            if key[3] == ramp:
                rows.append(
                    [
                        CONTACT[key[0]],
                        f"{key[2]:.1f}",
                        key[1],
                        percent(statistics.wilson(len(rests_1), runs_1)),
                        percent(statistics.wilson(len(rests_2), runs_2)),
                        _test(p_rest),
                        number(coefficient, 3),
                        _test(p_place),
                    ]
                )
        tables[title] = table(head, rows)
    for force in FORCES:
        (runs_1, rests_1), (runs_2, rests_2) = samples[("protocols", force, -216.3772, 2.0, 0.1)]
        numbers[f"protocols-first-{force}"] = percent(statistics.wilson(len(rests_1), runs_1), 1)
        numbers[f"protocols-second-{force}"] = percent(statistics.wilson(len(rests_2), runs_2))
        numbers[f"protocols-coefficient-{force}"] = number(
            statistics.energy(*(one[1] for one in samples[("protocols", force, -173.1803, 2.0, 0.1)]))[0], 2
        )
        for name in STUDIES:
            (runs, rests) = samples[(name, force, -216.3772, 2.0, 0.0)][1]
            word = "contact" if CONTACT[name] == "yes" else "alone"
            numbers[f"protocols-wait-{word}-{force}"] = percent(statistics.wilson(len(rests), runs))
    numbers["protocols-tests"] = number(
        sum(row[4] is not None for row in compared) + sum(row[5] is not None for row in compared), 0
    )
    return tables, numbers


def figure(results):
    samples = _samples(results)
    panels = []
    hits = (0, 0.01, 0.1, 0.3)
    for kind in ("rest", "place"):
        for at in SPEEDS:

            def draw(axes, at=at, kind=kind):
                for place, (name, words) in enumerate(
                    (("protocols", "contact"), ("protocols-no-contact", "no contact"))
                ):
                    for dashed, force in enumerate(FORCES):
                        of = [samples[(name, force, at, 2.0, hit)] for hit in hits]
                        if kind == "rest":
                            (runs, rests), _ = of[0]
                            estimates = [statistics.wilson(len(rests), runs)]
                            estimates += [statistics.wilson(len(second[1]), second[0]) for _, second in of]
                            x = np.arange(5)
                        else:
                            estimates = [statistics.energy(one[0][1], one[1][1], 1)[0] for one in of]
                            x = np.arange(1, 5)
                        shift = 0.1 * (2 * place + dashed - 1.5)
                        bars(axes, x + shift, estimates, place, f"{words}, {force}", bool(dashed))
                if kind == "place" and not axes.containers:
                    axes.text(2, 0.5, "fewer than 5 rests", ha="center", color=FAINT)
                axes.set_xlim(-0.5, 4.5)
                axes.set_xticks(range(5), ["I", *(f"{hit:g}" for hit in hits)], rotation=45)
                axes.set_xlabel("hit [m/s]")
                if kind == "rest":
                    axes.set_ylim(-0.03, 1.03)
                    axes.set_ylabel("fraction at rest")
                else:
                    axes.axhline(0, color=FAINT, linewidth=0.6, linestyle=DASHES[2])
                    axes.set_ylim(-0.15, 1.0)
                    axes.set_ylabel("coefficient")

            panels.append(Panel(draw, speed(at) + (": positions" if kind == "place" else ": rests"), 0.9))
    return lay_out(
        panels,
        columns=4,
        width="double",
        title="Protocols I and II",
        caption="Above: fraction of the runs at rest after protocol I and after protocol II with three hits of each "
        "size; a hit of 0 is a longer wait. Below: coefficient of the energy distance between the positions of rest "
        "of both protocols. Bars: 95 % intervals.",
        alternative="Eight panels over the size of the hit at four speeds.",
    )
