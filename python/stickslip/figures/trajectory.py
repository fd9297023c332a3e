"""Draws the motion of one run over time."""

from __future__ import annotations

import re
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes

from . import words
from .panels import Panel, angle_axis, lay_out
from .paper import DASHES, INK, SERIES, Paper, Width
from .tables import Directory, Numbers, Source, Table

__all__ = ["motion"]

#: Number of distinguishable positions along the time axis.
_BINS = 1200
#: Colour of contact between balls, wide behind the curves.
CONTACT = "#bbbbbb"


def motion(directory: Source, *, width: Optional[Width] = None, sheet: int = 1) -> Paper:
    """Draws the motion of a run over time [s], from `trajectory.parquet` of `stickslip replay`.

    For balls, the panels show their angles from the imbalance [rad], their speeds relative to the ring, and
    the position x, y of the disc's centre in the frame that rotates with the disc, x towards the imbalance;
    for a disc that starts or a table that is kicked, also the speed of the disc, each in the unit of the
    study. For a system in a file, they show its coordinates, their rates of change and its outputs, sliding
    speeds and friction forces, one panel for each unit. The curves end with the record; the record of a run that comes to permanent rest ends at that time. With contact between
    balls, the panel of the angles marks where two balls touch, and crosses between the balls mark impacts
    from `touches.parquet`. Long records are reduced to the extreme values in 1,200 equal intervals of time.
    See figures 5.6 and 5.15 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm). Raises FiguresError if the directory has no
    `trajectory.parquet` or if the table has fewer than two times.
    """
    table = Directory(directory).table("trajectory")
    balls = sum(1 for name in table.columns if name.startswith("beta_unwrapped_"))
    numbers = range(1, balls + 1)
    speed, vibration = table.speed, table.vibration
    quantities: list[tuple[str, tuple[str, float], list[str]]] = [
        ("angle of the balls", ("rad", 1.0), [f"beta_{ball}_rad" for ball in numbers]),
        ("speed of the balls", speed, [f"ball_speed_{ball}_rad_s" for ball in numbers]),
        ("x of the table", vibration, ["x_m"]),
        ("y of the table", vibration, ["y_m"]),
    ]
    starts = "speed_rad_s" in table.columns
    if starts:
        quantities.append(("speed of the disc", speed, ["speed_rad_s"]))
    if not balls:
        quantities = _of_system(table)
    gaps = [name for name in table.columns if re.fullmatch(r"touching_\d+_\d+", name)]
    read = table.read(["time_s", *(column for *_, columns in quantities for column in columns), *gaps])
    time = read["time_s"].astype(float)
    if time.size < 2 or not time[-1] > time[0]:
        raise table.nothing(
            f"it has {time.size} times, and a curve needs two", "repeat `stickslip replay` with more"
        )
    # Balls side by side have the same curve.
    beside = balls == 2 and all(
        np.array_equal(read[first], read[second], equal_nan=True)
        for first, second in (columns for *_, columns in quantities[:2])
    )
    panels = []
    for name, (unit, si), columns in quantities:

        def draw(
            axes: Axes,
            name: str = name,
            unit: str = unit,
            columns: list[str] = columns,
            si: float = si,
        ) -> None:
            values = [read[column].astype(float) / si for column in columns]
            if len(values) == 2 and beside:
                values, named = values[:1], ["balls 1 and 2, side by side"]
            else:
                named = [f"ball {ball + 1}" for ball in range(len(values))] if balls else columns
            for ball, (one, label) in enumerate(zip(values, named)):
                alone = len(values) == 1
                x, y = thinned(time, one)
                if unit == "rad" and balls:
                    x, y = _unbroken(x, y)
                style: dict[str, Any] = {
                    "linewidth": 0.8,
                    "color": INK if alone else SERIES[ball % len(SERIES)],
                }
                if not alone:
                    style["linestyle"] = DASHES[ball % len(DASHES)]
                axes.plot(x, y, label=label if len(columns) > 1 else "", **style)
            if unit == "rad" and balls:
                _mark_contact(axes, Directory(directory), read, gaps)
                angle_axis(axes, "y", name)
            else:
                axes.set_ylabel(words.axis(name, unit))
            axes.set_xlim(time[0], time[-1])
            axes.set_xlabel("time [s]")

        panels.append(Panel(draw, aspect=0.55 if balls else 0.75))
    run = table.about.get("options", {}).get("run_id")
    of_balls = (
        "Angles of the balls from the imbalance, their speeds relative to the ring, and the position of the "
        "disc's centre in the frame that rotates with the disc, x towards the imbalance."
    )
    if starts:
        of_balls += " Speed of the disc."
    if gaps:
        of_balls += " Wide grey: two balls touch. Crosses: impacts."
    title = f"Run {run} of {table.study}" if run is not None else table.study
    return lay_out(
        panels,
        title=f"Motion: {title}",
        caption=of_balls if balls else "Coordinates, their rates of change, outputs, sliding speeds and friction forces over time.",
        alternative=f"The motion of {'balls and table' if balls else 'the bodies'} from {time[0]:.4f} s to "
        f"{time[-1]:.4f} s.",
        width=width,
        sheet=sheet,
        columns=2 if balls else 3,
    )


#: What a quantity with this unit is called.
_NAMES = {"m": "position", "m/s": "speed", "rad": "angle", "rad/s": "angular speed", "N": "force", "N m": "torque"}


def _of_system(table: Table) -> list[tuple[str, tuple[str, float], list[str]]]:
    """Returns the quantities of a system without balls: those with one unit share a panel."""
    panels: dict[tuple[str, str], list[str]] = {}
    for column in table.columns:
        unit = table.unit(column)
        if column in ("time_s", "time", "step") or column.startswith(("phase", "friction_limit", "normal")):
            continue
        names = {"sliding_speed": "sliding speed", "friction": "friction force"}
        known = [name for prefix, name in names.items() if column.startswith(prefix)]
        panels.setdefault((known[0] if known else _NAMES.get(unit, "value"), unit), []).append(column)
    return [(name, (unit, 1.0), columns) for (name, unit), columns in panels.items()]


def _mark_contact(axes: Axes, directory: Directory, read: dict[str, Any], gaps: list[str]) -> None:
    """Marks angles at which two balls touch, and impacts."""
    time = read["time_s"].astype(float)
    label = "balls touch"
    for gap in gaps:
        for ball in gap.split("_")[1:]:
            angle = np.where(read[gap].astype(bool), read[f"beta_{ball}_rad"].astype(float), np.nan)
            if not np.all(np.isnan(angle)):
                x, y = _unbroken(*thinned(time, angle))
                axes.plot(x, y, label=label, linewidth=4, color=CONTACT, solid_capstyle="butt", zorder=1)
                label = ""
    if not gaps or not directory.has("touches"):
        return
    touches = directory.table("touches").read(["time_s", "from", "beta_behind_rad", "beta_ahead_rad"])
    at = touches["time_s"].astype(float)
    shown = (touches["from"] == "open") & (at >= time[0]) & (at <= time[-1])
    if np.any(shown):
        behind, ahead = (touches[f"beta_{side}_rad"][shown].astype(float) for side in ("behind", "ahead"))
        between = (behind + (ahead - behind) % (2 * np.pi) / 2) % (2 * np.pi)
        axes.plot(
            at[shown],
            between,
            label="impact",
            linestyle="none",
            marker="x",
            markersize=4,
            color=INK,
            zorder=3,
        )


def thinned(time: Numbers, values: Numbers) -> tuple[Numbers, Numbers]:
    """Reduces a long curve to the first, least, greatest and last point of each of many equal intervals of time."""
    if time.size <= 4 * _BINS:
        return time, values
    place = np.minimum((_BINS * (time - time[0]) / (time[-1] - time[0])).astype(int), _BINS - 1)
    starts = np.flatnonzero(np.r_[True, np.diff(place) > 0])
    kept = []
    for start, end in zip(starts, np.r_[starts[1:], time.size]):
        part = values[start:end]
        if np.all(np.isnan(part)):
            kept += [start]
            continue
        kept += sorted({start, start + int(np.nanargmin(part)), start + int(np.nanargmax(part)), end - 1})
    return time[kept], values[kept]


def _unbroken(time: Numbers, angle: Numbers) -> tuple[Numbers, Numbers]:
    """Returns angles over time, broken where an angle wraps."""
    gaps = np.flatnonzero(np.abs(np.diff(angle)) > np.pi) + 1
    return np.insert(time, gaps, np.nan), np.insert(angle, gaps, np.nan)
