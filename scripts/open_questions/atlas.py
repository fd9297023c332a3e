"""Question 7: how do sets, rests and classes of cycles change with speed and friction?"""

import numpy as np

from . import statistics
from .cells import number, percent, table
from .style import DASHES, FORCES, SCALE, SERIES, Panel, lay_out

STUDIES = ("atlas", "atlas-friction")
LABELS = ("equilibrium", "limit_cycle", "irregular", "undecided", "failed")
#: A column of points.parquet that the atlas shows where a version of the program writes it.
ENTROPY = "basin_entropy"
#: Classes with fewer runs are not in the table.
FEWEST = 10


def _points(study, *columns):
    wanted = ["point_id", "runs", "normal_force", "speed_rad_s", "set_fraction", "touching_set_fraction"]
    wanted += [f"{label}_runs" for label in LABELS] + list(columns)
    if ENTROPY in study.directory.table("points").columns:
        wanted.append(ENTROPY)
    return study.points(*wanted)


def _ranges(speeds, step):
    """Ranges of neighbouring speeds, as words."""
    speeds = sorted(-at for at in speeds)
    ranges = []
    for at in speeds:
        if ranges and at - ranges[-1][1] <= 1.5 * step:
            ranges[-1][1] = at
        else:
            ranges.append([at, at])
    words = [f"{low:.0f} to {high:.0f}" if high > low else f"{low:.0f}" for low, high in ranges]
    return (
        ", ".join(words)
        if len(words) < 5
        else f"{len(speeds)} speeds between {speeds[0]:.0f} and {speeds[-1]:.0f}"
    )


def _branches(study):
    """Classes of limit cycles, followed over the speed, by normal force."""
    point = {one["point_id"]: one for one in _points(study)}
    read = study.read("cycles", "point_id", "class", "runs", "mean_speed_1_rad_s", "largest_multiplier")
    found = {}
    for row in zip(*read.values()):
        at, name, runs, mean, multiplier = row
        own = point[at]
        found.setdefault((own["normal_force"], name), []).append(
            (own["speed_rad_s"], int(runs), int(own["runs"]), float(mean), float(multiplier))
        )
    return found


def _direction(rests):
    """The mean direction of the balls."""
    return float(np.angle(np.exp(1j * rests).mean()))


def values(results):
    study = results["atlas"]
    points = _points(study)
    rows = []
    # Neighbouring speeds are pooled, so that a row has enough runs.
    edges = (120, 140, 160, 170, 176, 181.6, 186, 192, 200, 210, 230, 260, 290, 320)
    for low, high in zip(edges[:-1], edges[1:]):
        of = [one for one in points if low <= -one["speed_rad_s"] < high]
        cells = [
            f"{low:g} to {high:g}",
            percent(float(np.mean([one["set_fraction"] for one in of]))),
            percent(float(np.nanmean([one["touching_set_fraction"] for one in of]))),
        ]
        for label in ("equilibrium", "limit_cycle"):
            for force in FORCES:
                own = [one for one in of if one["normal_force"] == force]
                count, total = (int(sum(one[name] for one in own)) for name in (f"{label}_runs", "runs"))
                cells.append(percent(statistics.wilson(count, total)))
        for force in FORCES:
            own = [one for one in of if one["normal_force"] == force]
            rests = np.concatenate([study.rests(one["point_id"]) for one in own])
            gaps = statistics.turn(rests[:, 0] - rests[:, 1])
            estimate = statistics.bootstrap(gaps, np.median, 500) if len(gaps) >= 10 else None
            cells.append(number(estimate, 2) if estimate else f"{len(gaps)} rest" + "s" * (len(gaps) != 1))
        rows.append(cells)
    head = ["speed against the clock, rad/s", "set, %", "set of balls that touch, %"]
    for words in ("at rest", "limit cycle"):
        head += [f"{words}, {force}, %" for force in FORCES]
    head += [f"median difference of the angles, {force}, rad" for force in FORCES]
    head[0] = "absolute speed, rad/s"

    branches = _branches(study)
    classes = []
    for (force, name), own in sorted(branches.items(), key=lambda item: -sum(row[1] for row in item[1])):
        runs = sum(row[1] for row in own)
        if runs < FEWEST:
            continue
        most = max(own, key=lambda row: row[1] / row[2])
        classes.append(
            [
                f"`{name}`".replace("|", "\\|"),
                force,
                _ranges([row[0] for row in own], 1.0),
                number(len(own), 0),
                number(runs, 0),
                percent(statistics.wilson(most[1], most[2])),
                f"{-most[0]:.0f}",
                number(max(row[4] for row in own), 3),
            ]
        )
    class_head = [
        "class",
        "normal force",
        "absolute speeds, rad/s",
        "speeds",
        "runs",
        "largest fraction, %",
        "at, rad/s",
        "largest multiplier",
    ]

    friction = []
    for coefficient in sorted(
        {one["friction_coefficient"] for one in _points(results["atlas-friction"], "friction_coefficient")}
    ):
        of = [
            one
            for one in _points(results["atlas-friction"], "friction_coefficient")
            if one["friction_coefficient"] == coefficient
        ]
        for side, words in ((True, "below 181.6"), (False, "above 181.6")):
            own = [one for one in of if (-one["speed_rad_s"] < 181.6) == side]
            cells = [f"{coefficient:g}", words, percent(float(np.mean([one["set_fraction"] for one in own])))]
            for label in ("equilibrium", "limit_cycle", "undecided"):
                for force in FORCES:
                    mine = [one for one in own if one["normal_force"] == force]
                    count, total = (int(sum(one[name] for one in mine)) for name in (f"{label}_runs", "runs"))
                    cells.append(percent(statistics.wilson(count, total)))
            friction.append(cells)
    friction_head = ["friction", "speed, rad/s", "set, %"]
    for words in ("at rest", "limit cycle", "undecided"):
        friction_head += [f"{words}, {force}, %" for force in FORCES]

    numbers = {}
    for force in FORCES:
        own = [one for one in points if one["normal_force"] == force]
        for name, low, high in (("below", 120, 181.6), ("middle", 183, 200), ("above", 200, 320)):
            of = [one for one in own if low <= -one["speed_rad_s"] < high]
            count, total = (int(sum(one[key] for one in of)) for key in ("equilibrium_runs", "runs"))
            numbers[f"atlas-{name}-{force}"] = percent(statistics.wilson(count, total), 1)
        for low, high in ((160, 165), (170, 175), (175, 180)):
            of = [study.rests(one["point_id"]) for one in own if low <= -one["speed_rad_s"] < high]
            numbers[f"atlas-direction-{low}-{force}"] = number(
                statistics.bootstrap(np.concatenate(of), _direction, 500), 2
            )
        numbers[f"atlas-classes-{force}"] = number(sum(key[0] == force for key in branches), 0)
        failed, total = (int(sum(one[key] for one in own)) for key in ("failed_runs", "runs"))
        numbers[f"atlas-failed-{force}"] = percent(statistics.wilson(failed, total), 1)
    smallest = min(points, key=lambda one: one["set_fraction"])
    numbers["atlas-smallest-set"] = percent(float(smallest["set_fraction"]), 1)
    numbers["atlas-smallest-at"] = number(-float(smallest["speed_rad_s"]), 0)
    tables = {
        "atlas": table(head, rows),
        "atlas-classes": table(class_head, classes),
        "atlas-friction": table(friction_head, friction),
    }
    return tables, numbers


def figure(results):
    study = results["atlas"]
    points = _points(study)
    speeds = sorted({-one["speed_rad_s"] for one in points})
    panels = []

    def of(force, column):
        own = sorted(
            (one for one in points if one["normal_force"] == force), key=lambda one: -one["speed_rad_s"]
        )
        return np.array([float(one[column]) for one in own]), np.array([float(one["runs"]) for one in own])

    def draw_sets(axes):
        axes.plot(
            speeds,
            of(FORCES[0], "set_fraction")[0],
            color="black",
            label="equilibrium set, share of positions",
        )
        axes.plot(
            speeds,
            of(FORCES[0], "touching_set_fraction")[0],
            color="black",
            linestyle=DASHES[2],
            label="set of balls that touch",
        )
        for place, force in enumerate(FORCES):
            count, runs = of(force, "equilibrium_runs")
            axes.plot(
                speeds,
                count / runs,
                color=SERIES[place],
                linestyle=DASHES[place],
                linewidth=0.8,
                label=f"at rest, {force}",
            )
        if ENTROPY in points[0]:
            entropy, _ = of(FORCES[0], ENTROPY)
            axes.plot(speeds, entropy, color=SERIES[3], linewidth=0.8, label="basin entropy, lagrange")
        axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel("fraction")
        axes.set_xlabel("absolute speed [rad/s]")

    panels.append(Panel(draw_sets, "sets and rests", 0.62))

    branches = _branches(study)
    totals = {}
    for (_, name), own in branches.items():
        totals[name] = totals.get(name, 0) + sum(row[1] for row in own)
    largest = sorted(totals, key=lambda name: -totals[name])[:3]

    def draw_classes(axes):
        for place, name in enumerate(largest):
            for dashed, force in enumerate(FORCES):
                runs = {-row[0]: row[1] / row[2] for row in branches.get((force, name), [])}
                axes.plot(
                    speeds,
                    [runs.get(at, 0.0) for at in speeds],
                    color=SERIES[place],
                    linestyle=DASHES[dashed],
                    linewidth=0.8,
                    label=f"{name}, {force}",
                )
        axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel("fraction of the runs")
        axes.set_xlabel("absolute speed [rad/s]")

    panels.append(Panel(draw_classes, "classes of limit cycles", 0.62))

    bins = np.linspace(0, 2 * np.pi, 37)
    for force in FORCES:
        grid = np.zeros((36, len(speeds)))
        for one in points:
            if one["normal_force"] == force:
                rests = study.rests(one["point_id"]).ravel()
                column = speeds.index(-one["speed_rad_s"])
                if len(rests) >= 10:
                    grid[:, column] = np.histogram(rests, bins)[0] / len(rests) * 36
                else:
                    grid[:, column] = np.nan

        def draw_density(axes, grid=grid):
            drawn = axes.pcolormesh(
                speeds,
                (bins[1:] + bins[:-1]) / 2,
                np.ma.masked_invalid(grid),
                cmap=SCALE,
                vmin=0,
                vmax=5,
                rasterized=True,
                shading="nearest",
            )
            axes.set_yticks([0, np.pi, 2 * np.pi], ["0", "π", "2π"])
            axes.set_ylabel("angle of a ball at rest [rad]")
            axes.set_xlabel("absolute speed [rad/s]")
            return drawn

        panels.append(Panel(draw_density, f"density of rests, {force}", 0.62, scale="times uniform"))
    rows = _points(results["atlas-friction"], "friction_coefficient")
    coefficients = sorted({one["friction_coefficient"] for one in rows})
    across = sorted({-one["speed_rad_s"] for one in rows})
    for force in FORCES:
        grid = np.full((len(coefficients), len(across)), np.nan)
        for one in rows:
            if one["normal_force"] == force:
                place = coefficients.index(one["friction_coefficient"]), across.index(-one["speed_rad_s"])
                grid[place] = one["equilibrium_runs"] / one["runs"]

        def draw_map(axes, grid=grid):
            drawn = axes.pcolormesh(
                across,
                range(len(coefficients)),
                grid,
                cmap=SCALE,
                vmin=0,
                vmax=1,
                shading="nearest",
                rasterized=True,
            )
            axes.set_yticks(range(len(coefficients)), [f"{one:g}" for one in coefficients])
            axes.set_ylabel("friction of the ring")
            axes.set_xlabel("absolute speed [rad/s]")
            return drawn

        panels.append(Panel(draw_map, f"at rest, {force}", 0.62, scale="fraction"))
    return lay_out(
        panels,
        columns=2,
        width="double",
        title="Sets, rests and limit cycles over the speed",
        caption="Share of positions in the equilibrium set and fraction of the runs at rest; fractions of the three "
        "most frequent classes of limit cycles; density of the angles at rest (a speed with fewer than 5 rests is white); "
        "and fraction at rest over speed and friction.",
        alternative="Six panels over the absolute speed of the disc, from 120 to 319 rad/s.",
    )
