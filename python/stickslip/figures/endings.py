"""Draws the fractions of the labels over a sweep, and of failed and doubtful runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes

from . import paper as look
from . import words
from .panels import Panel, lay_out, named_axis
from .paper import Paper, Width
from .sweep import LABELS, Sweep
from .tables import Directory, Numbers, Source

__all__ = ["diagnostics", "ending_fractions"]


def _fractions(sweep: Sweep) -> dict[str, Numbers]:
    """Returns the runs, the fraction and the interval of each label at each point."""
    columns = [f"{name}_{part}" for name in LABELS for part in ("runs", "low", "high")]
    found = sweep.numbers([*columns, "equilibrium_fraction", "ci_low", "ci_high"])
    with np.errstate(invalid="ignore"):
        for name in LABELS:
            found[name] = found[f"{name}_runs"] / sweep.runs
    # The interval of equilibria is the one that the study requests; it accounts for failed runs.
    found["equilibrium"] = found["equilibrium_fraction"]
    found["equilibrium_low"], found["equilibrium_high"] = found["ci_low"], found["ci_high"]
    return found


def interval(
    axes: Axes,
    x: Numbers,
    y: Numbers,
    low: Numbers,
    high: Numbers,
    *,
    colour: str,
    mark: str,
    dashes: Any = "none",
    name: str,
) -> None:
    """Draws marks with intervals, joined by a line if `dashes` is given."""
    known = np.isfinite(y)
    if not np.any(known):
        return
    x, y, low, high = x[known], y[known], low[known], high[known]
    low, high = np.where(np.isfinite(low), low, y), np.where(np.isfinite(high), high, y)
    axes.errorbar(
        x,
        y,
        yerr=[np.maximum(y - low, 0), np.maximum(high - y, 0)],
        color=colour,
        marker=mark,
        linestyle=dashes,
        markersize=4.5 if mark == "x" else 3.5,
        capsize=2,
        elinewidth=0.9,
        capthick=0.9,
        label=name,
        clip_on=False,
        zorder=3,
    )


def ending_fractions(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws the fraction of each label over the swept parameter, with 95 % intervals.

    The abscissa is the swept numeric parameter with the most values, such as speed [rad/s], or the points if no
    numeric parameter is swept. Each combination of the other parameters has a panel. The fractions refer to all
    finished runs of a point. The interval of equilibria (`ci_low` to `ci_high` of `points.parquet`) covers this
    label alone and is widened for failed runs, whose label is unknown; the wider intervals of the other labels are
    simultaneous for all labels. The runs are counted as in section 5.3 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show; ``sheet``:
    which sheet of twelve panels, from 1. Raises FiguresError if the directory has no `points.parquet`.
    """
    sweep = Sweep(Directory(directory))
    found = _fractions(sweep)
    shown = set(sweep.details(points) if points is not None else range(len(sweep)))
    seen = [name for name in LABELS if name == "equilibrium" or np.any(found[f"{name}_runs"] > 0)]
    axes_of = sweep.axes(2)

    def draw(axes: Axes, x: Numbers, rows: Sequence[int]) -> None:
        for name in seen:
            colour, mark, dashes = look.LABELS[name]
            one, low, high = (found[key][list(rows)] for key in (name, f"{name}_low", f"{name}_high"))
            interval(axes, x, one, low, high, colour=colour, mark=mark, dashes=dashes, name=words.label(name))
        axes.set_ylim(0, 1)
        axes.set_ylabel("fraction of the runs")

    panels = []
    if axes_of:
        over = axes_of[0]
        groups = {
            title: [row for row in rows if row in shown]
            for title, rows in sweep.groups([over.column]).items()
        }
        for title, rows in sorted(groups.items(), key=lambda group: -len(group[1])):
            if not rows:
                continue
            rows = sorted(rows, key=lambda row: over.values[row])

            def panel(axes: Axes, rows: list[int] = rows) -> None:
                draw(axes, over.values[rows], rows)
                axes.set_xscale("log" if over.logarithmic else "linear")
                axes.set_xlim(over.limits)
                axes.set_xlabel(over.label)

            panels.append(Panel(panel, title))
        title = f"How the runs end, over {over.name}"
    else:
        some = [row for row in sweep.details(points) if row in shown]

        def named(axes: Axes) -> None:
            draw(axes, np.arange(len(some), dtype=float), some)
            named_axis(axes, [sweep.short(row) for row in some], sweep.short_names)

        panels = [Panel(named)]
        title = "How the runs end"
    equilibria = found["equilibrium"][sorted(shown)]
    return lay_out(
        panels,
        title=title,
        caption="Fraction of the runs of each point with each label, with 95 % intervals. The interval of equilibria "
        "covers this label alone and is widened for failed runs, whose label is unknown; the others are "
        "simultaneous for all labels, and therefore wider.",
        alternative=f"The fraction of runs that end in equilibrium lies between {np.nanmin(equilibria):.3f} and "
        f"{np.nanmax(equilibria):.3f}.",
        width=width,
        sheet=sheet,
    )


def diagnostics(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws the fractions of failed and undecided runs and of audit flips at each point.

    The fractions [1] of failed and undecided runs refer to all finished runs of a point, with simultaneous 95 %
    intervals for all labels. Flips are audited runs (`audit:` in the study) whose label changes when they are
    computed more precisely, as a fraction of the audited runs, with Wilson's 95 % interval.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show. Raises
    FiguresError if the directory has no `points.parquet`.
    """
    sweep = Sweep(Directory(directory))
    rows = sweep.details(points)
    found = _fractions(sweep)
    flips = sweep.numbers(
        ["audit_flip_rate", "audit_flip_low", "audit_flip_high", "audit_flips", "audited_runs"]
    )
    audited = bool(np.nansum(flips["audited_runs"]) > 0)

    def draw(axes: Axes) -> None:
        place = np.arange(len(rows), dtype=float)
        for name, shift in (("undecided", -0.16), ("failed", 0.0)):
            colour, mark, _ = look.LABELS[name]
            one, low, high = (found[key][rows] for key in (name, f"{name}_low", f"{name}_high"))
            interval(axes, place + shift, one, low, high, colour=colour, mark=mark, name=words.label(name))
        if audited:
            rate, low, high = (flips[f"audit_flip_{part}"][rows] for part in ("rate", "low", "high"))
            name, colour = "flips, of audited runs", look.SERIES[0]
            interval(axes, place + 0.16, rate, low, high, colour=colour, mark="^", name=name)
        axes.set_ylim(bottom=0)
        axes.set_ylabel("fraction of the runs")
        named_axis(axes, [sweep.short(row) for row in rows], sweep.short_names)

    counts = [f"{np.nansum(found[f'{name}_runs']):.0f} runs {said}" for name, said in _SAID]
    audit = (
        f" {np.nansum(flips['audit_flips']):.0f} of {np.nansum(flips['audited_runs']):.0f} audited runs change "
        "their label when they are computed more precisely."
        if audited
        else " No run was audited (`audit:` in the study computes some of them more precisely)."
    )
    wide = width or ("double" if len(rows) > 6 else "single")
    return lay_out(
        [Panel(draw, aspect=0.42 if wide == "double" else 0.7)],
        title="Failed and undecided runs, and labels in doubt",
        caption="Runs that failed, runs without a proven label, and audited runs whose label changed when they were "
        "computed more precisely, with 95 % intervals." + sweep.left_out(rows),
        alternative=f"{', '.join(counts)}.{audit}",
        width=wide,
        sheet=sheet,
    )


_SAID = (("failed", "failed"), ("undecided", "are undecided"))
