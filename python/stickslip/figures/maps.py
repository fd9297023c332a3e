"""Draws the results of a sweep over two parameters as maps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable

from .panels import Panel, lay_out
from .paper import SCALE, Paper, Width
from .sweep import Axis, Sweep, by_decades
from .tables import Directory, Numbers, Source

__all__ = ["label_map"]

#: Least number of values of each parameter.
_LEAST = 3
#: Largest number of combinations of the other parameters that have maps.
_MOST_PLANES = 12

_SHOWN = (
    ("fraction of runs in equilibrium", "fraction", "equilibrium_fraction", (0.0, 1.0)),
    ("median time to rest", "time to rest [s]", "time_to_rest_p50_s", None),
    ("median of amplitude / amplitude without balls", "ratio", "relative_amplitude_p50", None),
    ("fraction of positions in the equilibrium set", "fraction", "set_fraction", (0.0, 1.0)),
)


def label_map(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws maps over two swept parameters, with one cell per point; cells without a value are white.

    The maps show the fraction of runs that end in equilibrium, the median time to rest [s] (no value if less than
    half of the runs come to rest), the median of the final amplitude of each run divided by that of its own machine
    without balls, and the fraction of all ball positions that are equilibria. The axes are the two swept numeric parameters with the most values; each
    combination of the other parameters has a row of maps. `points.parquet` and `ending_fractions` contain the
    confidence intervals.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show; ``sheet``:
    which sheet of twelve panels, from 1. Raises FiguresError if fewer than two numeric parameters have three or
    more values.
    """
    sweep = Sweep(Directory(directory))
    axes_of = sweep.axes(_LEAST)
    if len(axes_of) < 2:
        raise sweep.table.nothing(
            f"{len(axes_of)} of its swept parameters are numbers with {_LEAST} values or more, and a map needs "
            "two",
            "sweep two parameters, or draw `ending_fractions`",
        )
    across, up = axes_of[:2]
    shown = None if points is None else set(sweep.details(points))
    wanted = [column for *_, column, _ in _SHOWN if column in sweep.table.columns]
    found = sweep.numbers(wanted)
    panels = []
    cells = across.distinct.size * up.distinct.size
    drawn = 0
    for title, rows in list(sweep.groups([across.column, up.column]).items())[:_MOST_PLANES]:
        rows = [row for row in rows if shown is None or row in shown]
        # A mostly empty map is a path in the plane, which curves show better.
        if 3 * len(rows) < cells:
            continue
        drawn += len(rows)
        for name, scale, column, limits in _SHOWN:
            if column in found and np.any(np.isfinite(found[column][rows])):
                said = f"{title} – {name}" if title else name
                panels.append(_panel(said, (scale, limits), (across, up), rows, found[column]))
    if not panels:
        raise sweep.table.nothing(
            "most combinations of the two parameters are missing", "sweep them as a grid"
        )
    more = "" if drawn == len(sweep) else f" {drawn} of {len(sweep)} points are shown."
    return lay_out(
        panels,
        title=f"Maps over {across.name} and {up.name}",
        caption=f"One cell per point of the sweep; cells without a value are white.{more}",
        alternative=f"{drawn} points over {across.label} and {up.label}.",
        width=width,
        sheet=sheet,
        columns=2,
    )


def _panel(
    title: str,
    shown: tuple[str, Optional[tuple[float, float]]],
    over: tuple[Axis, Axis],
    rows: Sequence[int],
    values: Numbers,
) -> Panel:
    scale, limits = shown
    across, up = over
    grid = np.full((up.distinct.size, across.distinct.size), np.nan)
    for row in rows:
        place = (
            np.searchsorted(up.distinct, up.values[row]),
            np.searchsorted(across.distinct, across.values[row]),
        )
        grid[place] = values[row]
    low, high = limits or (float(np.nanmin(grid)), float(np.nanmax(grid)))

    def draw(axes: Axes) -> ScalarMappable:
        mesh = axes.pcolormesh(
            edges(across.distinct),
            edges(up.distinct),
            np.ma.masked_invalid(grid),
            cmap=SCALE,
            vmin=low,
            vmax=high if high > low else low + 1,
            edgecolors="face",
            linewidth=0.1,
        )
        for axis, set_scale, set_label in (
            (across, axes.set_xscale, axes.set_xlabel),
            (up, axes.set_yscale, axes.set_ylabel),
        ):
            set_scale("log" if axis.logarithmic else "linear")
            set_label(axis.label)
        return mesh

    return Panel(draw, title, scale=scale)


def edges(values: Numbers) -> Numbers:
    """Returns the cell edges of ascending values: the midpoints of neighbours on a linear or logarithmic axis."""
    logarithmic = by_decades(values)
    along = np.log(values) if logarithmic else values
    between = (along[1:] + along[:-1]) / 2
    all_edges = np.r_[2 * along[0] - between[0], between, 2 * along[-1] - between[-1]]
    return np.asarray(np.exp(all_edges) if logarithmic else all_edges)
