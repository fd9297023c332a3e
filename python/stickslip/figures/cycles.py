"""Draws the classes of limit cycles over a swept parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np
from matplotlib.axes import Axes

from . import words
from .endings import interval
from .panels import Panel, lay_out, named_axis
from .paper import DASHES, FAINT, MARKS, SERIES, Paper, Width
from .sweep import Sweep
from .tables import Directory, Source

__all__ = ["limit_cycle_branches"]

#: Largest number of classes shown; these have the most runs.
_MOST_CLASSES = 8

#: Name; SI unit, or `vibration` or `speed` for the unit of the study; columns of the value and of both ends of its
#: range.
_QUANTITIES = (
    ("fraction of the runs", "", ("fraction", "ci_low", "ci_high")),
    ("period", "s", ("period_s", "period_low_s", "period_high_s")),
    ("RMS amplitude", "vibration", ("amplitude_rms_m", "amplitude_rms_low_m", "amplitude_rms_high_m")),
    ("amplitude", "m", ("amplitude_m", "amplitude_low_m", "amplitude_high_m")),
    ("speed of ball 1", "speed", ("mean_speed_1_rad_s", "min_speed_1_rad_s", "max_speed_1_rad_s")),
    ("largest multiplier", "", ("largest_multiplier",)),
)


def limit_cycle_branches(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws limit cycles over the swept parameter, with one branch per class and one panel per quantity.

    The quantities are the fraction of a point's runs that end on the class, with Wilson's 95 % interval; the
    period [s], the amplitude (root mean square of the table, or amplitude of a block) and the mean speed of
    ball 1, in the units of the study, each with its range over the runs or the cycle; and the largest modulus
    of the Floquet multipliers, which is below 1 for a stable cycle. The abscissa is the swept numeric
    parameter with the most values, or the points. docs/methods.md explains the names of the classes. Compare
    figure 5.15 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show; ``sheet``:
    which sheet of twelve panels, from 1. Raises FiguresError if no run ended in a limit cycle.
    """
    results = Directory(directory)
    sweep = Sweep(results)
    table = results.table("cycles")
    shown_quantities = [one for one in _QUANTITIES if one[2][0] in table.columns]
    table.need([column for *_, columns in shown_quantities for column in columns])
    read = table.read(
        ["point_id", "class", "runs", *(column for *_, columns in shown_quantities for column in columns)]
    )
    chosen = sweep.details(points) if points is not None else list(range(len(sweep)))
    here = np.isin(read["point_id"], sweep.ids[chosen])
    if not np.any(here):
        raise table.nothing(
            "no run of these points ended in a limit cycle", "draw `ending_fractions` to see how they ended"
        )
    read = {name: values[here] for name, values in read.items()}
    classes: dict[str, int] = {}
    for name, count in zip(read["class"], read["runs"]):
        classes[str(name)] = classes.get(str(name), 0) + int(count)
    ordered = sorted(classes, key=lambda name: -classes[name])
    axes_of = sweep.axes(2)
    over = axes_of[0] if axes_of else None
    some = sweep.details(points)
    groups = sweep.groups([over.column]) if over else {"": some}
    panels = []
    for title, rows in groups.items():
        rows = [row for row in rows if row in chosen]
        place_of = {int(sweep.ids[row]): over.values[row] if over else float(k) for k, row in enumerate(rows)}
        of_group = np.isin(read["point_id"], list(place_of))
        for name, quantity, columns in shown_quantities:
            unit, si = {"vibration": table.vibration, "speed": table.speed}.get(quantity, (quantity, 1.0))
            if not np.any(np.isfinite(read[columns[0]][of_group])):
                continue

            def draw(
                axes: Axes,
                name: str = name,
                unit: str = unit,
                si: float = si,
                columns: tuple[str, ...] = columns,
                place_of: dict[int, float] = place_of,
                rows: list[int] = rows,
            ) -> None:
                for number, of_class in enumerate(ordered[:_MOST_CLASSES]):
                    of = (read["class"] == of_class) & np.isin(read["point_id"], list(place_of))
                    if not np.any(of):
                        continue
                    x = np.array([place_of[int(point)] for point in read["point_id"][of]])
                    order = np.argsort(x, kind="stable")
                    y, low, high = (read[(columns * 3)[k]][of][order] / si for k in range(3))
                    interval(
                        axes,
                        x[order],
                        y,
                        low,
                        high,
                        colour=SERIES[number],
                        mark=MARKS[number],
                        dashes=DASHES[number % 5],
                        name=f"class {of_class.replace('-', '−')}",
                    )
                axes.set_ylabel(words.axis(name, unit))
                if name.startswith("largest"):
                    axes.axhline(1.0, color=FAINT, linewidth=0.7, linestyle=(0, (4, 2)), zorder=1)
                    axes.annotate(
                        "stable below",
                        (0.98, 1.0),
                        xycoords=("axes fraction", "data"),
                        ha="right",
                        va="top",
                        xytext=(0, -2),
                        textcoords="offset points",
                        color="#505050",
                    )
                _not_too_close(axes)
                if over is None:
                    named_axis(axes, [sweep.short(row) for row in rows], sweep.short_names)
                else:
                    axes.set_xscale("log" if over.logarithmic else "linear")
                    axes.set_xlim(over.limits)
                    axes.set_xlabel(over.label)

            panels.append(Panel(draw, title))
    more = ""
    if len(ordered) > _MOST_CLASSES:
        more = f" The {_MOST_CLASSES} classes with the most runs, of {len(ordered)}, are shown."
    return lay_out(
        panels,
        title="Limit cycles",
        caption="One branch per class of limit cycles (docs/methods.md explains their names), with the range over "
        f"its runs, or Wilson's 95 % interval of a fraction.{more}",
        alternative=words.listed([f"class {name}: {classes[name]} runs" for name in ordered]),
        width=width,
        sheet=sheet,
    )


def _not_too_close(axes: Axes) -> None:
    """Widens the ordinate so that it leaves a margin and does not magnify rounding errors."""
    low, high = axes.get_ylim()
    middle = (low + high) / 2
    least = max(0.02 * abs(middle), 1e-12)
    margin = max(0.06 * (high - low), (least - (high - low)) / 2)
    axes.set_ylim(low - margin, high + margin)
