"""Basins of attraction: which start states end where."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from . import runs, words
from . import paper as look
from .panels import Panel, angle_axis, lay_out
from .paper import Paper, Width
from .sweep import LABELS, Sweep
from .tables import Directory, FiguresError, Numbers, Source

__all__ = ["basins"]

#: Approximate largest number of dots in all panels together.
_MOST_DOTS = 48_000


def basins(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws basins of attraction: the start states in planes of two coordinates, coloured by the label of the run.

    Each point has a panel for each of these pairs: the angles of balls 1 and 2, their speeds, x and y, the
    velocities of x and y, and angle and speed of each ball; for a block, position and velocity. The other
    coordinates differ from dot to dot, so each panel is a projection of the basins, not a section. Angles are in
    [rad] and the block's coordinates in [m] and [m/s]; the others are dimensionless as in the study. `diagnostics`
    shows the labels in doubt.

    If the sweep sets the number of balls, all points shown must have the same number, as in `preferred_equilibria`.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show; ``sheet``:
    which sheet of twelve panels, from 1. Above 48,000 dots it plots a labelled subsample. Raises FiguresError if
    the directory has no `runs.parquet` or its start states have fewer than two coordinates.
    """
    results = Directory(directory)
    sweep = Sweep(results)
    table = results.table("runs")
    starts = [name for name in table.columns if name.startswith("initial_")]
    balls, rows = runs.points_of_one_number(results, sweep, points)
    pairs = _pairs(starts, balls)
    if not pairs:
        raise FiguresError(
            results.path, table.name, "it has fewer than two columns of start states", "`stickslip run` writes them"
        )
    columns = sorted({name for pair in pairs for name in pair})
    sample = runs.read(results, sweep, rows, ["label", *columns], max(1, _MOST_DOTS // len(pairs)))
    rasterized = len(sample) * len(pairs) > runs.MOST_VECTOR_DOTS
    size = float(np.clip(50 / np.sqrt(max(len(sample), 1) / len(rows)), 1.4, 3.2))
    seen = [name for name in LABELS if np.any(sample["label"] == name)]
    keys = [
        Line2D(
            [],
            [],
            color=look.LABELS[name][0],
            marker=look.LABELS[name][1],
            linestyle="none",
            label=words.label(name),
        )
        for name in seen
    ]
    panels = []
    for row in rows:
        of_point = sample.where(sample["point_id"] == sweep.ids[row])
        for pair in pairs:

            def draw(axes: Axes, of_point: runs.Sample = of_point, pair: tuple[str, str] = pair) -> None:
                x, y = (of_point[name].astype(float) for name in pair)
                for name in seen:
                    colour, mark, _ = look.LABELS[name]
                    of = of_point["label"] == name
                    axes.plot(
                        x[of],
                        y[of],
                        linestyle="none",
                        marker=mark,
                        color=colour,
                        markersize=size,
                        markeredgewidth=0.6 if mark == "x" else 0,
                        rasterized=rasterized,
                    )
                for which, column, values in (
                    ("x", pair[0], sample[pair[0]]),
                    ("y", pair[1], sample[pair[1]]),
                ):
                    _start_axis(axes, which, column, table.unit(column), values.astype(float))

            title = sweep.title(row)
            said = f"{words.coordinate(pair[0])} and {words.coordinate(pair[1])}"
            panels.append(Panel(draw, f"{title} – {said}" if title else said, 1.0, keys=keys))
    counts = sweep.numbers([f"{name}_runs" for name in LABELS])
    told = [
        f"{np.nansum(counts[f'{name}_runs'][rows]):.0f} {words.label(name)}"
        for name in LABELS
        if np.nansum(counts[f"{name}_runs"][rows]) > 0
    ]
    return lay_out(
        panels,
        title="Basins of attraction: which start states end where",
        caption="Start states in planes of two coordinates, coloured by the label of the run; the other "
        f"coordinates differ from dot to dot.{sweep.left_out(rows)}{sample.subsample}",
        alternative=f"Runs by label: {', '.join(told)}.",
        width=width,
        sheet=sheet,
        legend_title=sample.label,
    )


def _pairs(starts: Sequence[str], balls: int) -> list[tuple[str, str]]:
    """Returns the pairs of start coordinates that share a panel."""
    if balls == 0:
        return [(starts[0], other) for other in starts[1:4]]
    names = [("beta_1", "beta_2"), ("beta_dot_1", "beta_dot_2")] if balls > 1 else []
    names += [("x", "y"), ("x_dot", "y_dot")]
    names += [(f"beta_{ball}", f"beta_dot_{ball}") for ball in range(1, balls + 1)]
    pairs = [(f"initial_{first}", f"initial_{second}") for first, second in names]
    return [pair for pair in pairs if set(pair) <= set(starts)]


def _start_axis(axes: Axes, which: str, column: str, unit: str, values: Numbers) -> None:
    """Labels and scales an axis; an angle axis covers one turn if all start angles lie in it."""
    name = f"{words.coordinate(column)} at the start"
    if unit == "rad" and values.size and values.min() >= 0 and values.max() <= 2 * np.pi:
        angle_axis(axes, which, name)
        return
    set_label = axes.set_xlabel if which == "x" else axes.set_ylabel
    set_limits = axes.set_xlim if which == "x" else axes.set_ylim
    set_label(words.axis(name, unit))
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    margin = 0.05 * (high - low) or 1.0
    set_limits(low - margin, high + margin)
    axes.locator_params(axis="x" if which == "x" else "y", nbins=6)
