"""Draws the distributions of the time to rest and of the final amplitude over the runs of each point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Callable, Optional

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from . import runs, words
from .panels import Panel, lay_out
from .paper import DASHES, INK, SERIES, Paper, Width
from .sweep import Sweep, evenly
from .tables import Directory, Numbers, Source

__all__ = ["amplitudes", "time_to_rest"]

#: Largest number of curves in one panel.
_MOST_CURVES = 6
#: Largest number of steps of a curve; more cannot be distinguished.
_MOST_STEPS = 400
#: Approximate largest number of amplitudes in memory.
_MOST_AMPLITUDES = 2_000_000


def _few_each(rows: Sequence[int], ids: NDArray[Any]) -> list[tuple[str, list[int]]]:
    """Distributes neighbouring rows over panels; returns the titles and rows of the panels."""
    count = max(1, -(-len(rows) // _MOST_CURVES))
    each = max(1, -(-len(rows) // count))
    parts = [list(rows[first : first + each]) for first in range(0, len(rows), each)]
    if len(parts) < 2:
        return [("", part) for part in parts]
    return [
        (f"points {ids[part[0]]} to {ids[part[-1]]}" if len(part) > 1 else f"point {ids[part[0]]}", part)
        for part in parts
    ]


def _panels(
    sweep: Sweep,
    rows: Sequence[int],
    draw: Callable[[Axes, int, str, int], None],
    finish: Callable[[Axes], None],
    ruled: bool = False,
) -> list[Panel]:
    """Returns panels with a few curves each; several panels have a legend each."""
    parts = _few_each(rows, sweep.ids)

    def panel(part: list[int]) -> Callable[[Axes], None]:
        def of(axes: Axes) -> None:
            for place, row in enumerate(part):
                failed = f" ({sweep.failed[row]:.0f} failed)" if sweep.failed[row] > 0 else ""
                named = sweep.short(row) if sweep.parameters or len(sweep) > 1 else "all runs"
                draw(axes, row, named + failed, place)
            finish(axes)
            if len(parts) > 1:
                _own_legend(axes, sweep.short_names, ruled)

        return of

    if len(parts) < 2:
        return [Panel(panel(part), aspect=0.62) for _, part in parts]
    return [
        Panel(panel(part), title, above=10.0 * (-(-len(part) // 2) + bool(sweep.short_names) + ruled))
        for title, part in parts
    ]


def _own_legend(axes: Axes, title: str, ruled: bool) -> None:
    """Adds a legend of these axes above them."""
    handles, names = axes.get_legend_handles_labels()
    legend = axes.legend(
        handles,
        names,
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=1.5 if ruled else 0.3,
        borderpad=0.0,
        ncols=2,
        handlelength=1.8,
        columnspacing=0.8,
        labelspacing=0.2,
        title=title or None,
        alignment="left",
    )
    # The legend must not move the title above it.
    legend.set_in_layout(False)
    for handle in [*axes.lines, *axes.collections]:
        handle.set_label("")


def time_to_rest(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws the probability that the balls (or the block) are at rest by time t [s], with one curve per point.

    For a disc that starts or a table that is kicked, time counts from the begin of the last stage.
    The curve is the Kaplan-Meier estimator from `time_to_rest.parquet`; runs that still move at the end are
    censored. The bands are pointwise 95 % confidence intervals. Failed runs are excluded from the curve; the band
    includes the two extremes that all of them rest immediately or that none ever does.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show. Raises
    FiguresError if the directory has no such table.
    """
    results = Directory(directory)
    sweep = Sweep(results)
    table = results.table("time_to_rest")
    read = table.read(["point_id", "time_s", "probability_at_rest", "ci_low", "ci_high"])
    curves: dict[int, tuple[Numbers, ...]] = {}
    for row in sweep.details(points):
        of = np.flatnonzero(read["point_id"] == sweep.ids[row])
        if of.size:
            of = of[evenly(of.size, _MOST_STEPS)]
            names = ("time_s", "probability_at_rest", "ci_low", "ci_high")
            curves[row] = tuple(read[name][of].astype(float) for name in names)
    if not curves:
        raise table.nothing("it has no rows of these points", "choose points with runs that did not fail")
    # With stages, time counts from the begin of the last one, up to the last censored run.
    staged = results.has("stages")
    after = " after the begin of the last stage" if staged else ""
    end = max(float(np.nanmax(read["time_s"])), 0.0 if staged else table.parameters.get("end_time_s", 0.0))

    def draw(axes: Axes, row: int, name: str, place: int) -> None:
        time, probability, low, high = curves[row]
        failed = sweep.failed[row] / max(sweep.runs[row], 1.0)
        low, high = low * (1 - failed), high * (1 - failed) + failed
        if time[0] > 0:
            time, probability = np.r_[0, time], np.r_[0, probability]
            low, high = np.r_[0, low], np.r_[high[0], high]
        if time[-1] < end:
            time = np.r_[time, end]
            probability, low, high = (np.r_[part, part[-1]] for part in (probability, low, high))
        style: dict[str, Any] = {"color": SERIES[place], "zorder": 3}
        axes.fill_between(time, low, high, step="post", color=SERIES[place], alpha=0.2, linewidth=0)
        axes.step(time, probability, where="post", linestyle=DASHES[place % 5], label=name, **style)

    def finish(axes: Axes) -> None:
        axes.set_xlim(0, end)
        axes.set_ylim(0, 1)
        axes.set_xlabel(f"time{after} [s]")
        axes.set_ylabel("probability of being at rest")

    balls = runs.balls_of(results)
    medians = sweep.numbers(["time_to_rest_p50_s"])["time_to_rest_p50_s"]
    told = [
        f"{sweep.named(row)}"
        + (
            f"half of the runs that did not fail are at rest by {medians[row]:.3f} s{after}"
            if np.isfinite(medians[row])
            else "less than half of the runs that did not fail come to rest"
        )
        for row in curves
    ]
    left_out = sweep.failures_left_out(list(curves))
    if left_out:
        left_out += " The bands include the extremes that all of them rest immediately or never."
    moving = {0: "block comes", 1: "ball comes"}.get(balls, "balls come")
    return lay_out(
        _panels(sweep, list(curves), draw, finish),
        title=f"When the {moving} to rest",
        caption=f"Probability of being at rest by time t{after} (Kaplan-Meier; runs that still move at the end are "
        f"censored), with pointwise 95 % bands.{left_out}{sweep.left_out(list(curves))}",
        alternative=words.listed(told),
        width=width,
        sheet=sheet,
        legend_title=sweep.short_names,
    )


def amplitudes(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws the empirical distribution function of the table's amplitude at the end of the runs, for each point.

    All runs with an amplitude count, whether at rest or moving; moving runs have a root-mean-square amplitude. The
    abscissa is the amplitude divided by that of the run's own machine without balls; values below 1 mean that the balls
    reduce the vibration. For the block it is the amplitude [m]. Errors are not drawn: the fraction p of n runs has
    the standard error sqrt(p (1 − p) / n).

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show. Raises
    FiguresError if the directory has no `runs.parquet` or no run has an amplitude.
    """
    results = Directory(directory)
    sweep = Sweep(results)
    balls = runs.balls_of(results) > 0
    rows = sweep.details(points)
    column = "relative_amplitude" if balls else "amplitude_m"
    sample = runs.read(results, sweep, rows, [column], _MOST_AMPLITUDES)
    worse = "worse_than_without_balls_fraction"
    more = sweep.numbers([worse])[worse] if balls else np.full(len(sweep), np.nan)
    curves: dict[int, Numbers] = {}
    for row in rows:
        values = sample[column][sample["point_id"] == sweep.ids[row]].astype(float)
        values = np.sort(values[np.isfinite(values)])
        # Runs without any vibration count, but have no place on a logarithmic axis.
        if np.any(values > 0) or (values.size and not balls):
            curves[row] = values
    if not curves:
        raise results.table("runs").nothing("no run of these points has an amplitude", "choose other points")

    def draw(axes: Axes, row: int, name: str, place: int) -> None:
        values = curves[row]
        part = np.arange(1, values.size + 1) / values.size
        still = int(np.sum(values <= 0)) if balls else 0
        kept = [still + place for place in evenly(values.size - still, _MOST_STEPS)]
        x, y = np.r_[values[still], values[kept]], np.r_[still / values.size, part[kept]]
        axes.step(x, y, where="post", color=SERIES[place], linestyle=DASHES[place % 5], label=name, zorder=3)

    def finish(axes: Axes) -> None:
        axes.set_ylim(0, 1)
        axes.set_ylabel("fraction of runs with less")
        axes.set_xlabel("amplitude at the end [m]")
        if balls:
            axes.set_xscale("log")
            axes.set_xlabel("amplitude / amplitude without balls")
            axes.axvline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 2)), zorder=2)
            axes.annotate(
                "without balls",
                (1.0, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(0, 2),
                textcoords="offset points",
                ha="center",
                va="bottom",
            )

    def fact(row: int) -> str:
        values = curves[row]
        if balls:
            return f"{sweep.named(row)}{100 * more[row]:.1f} % of the runs vibrate more than without balls"
        median = words.significant(float(values[(values.size - 1) // 2]))
        return f"{sweep.named(row)}half of the runs have {median} m or less"

    sampled = sample.subsample.replace("are shown", "are counted")
    return lay_out(
        _panels(sweep, list(curves), draw, finish, ruled=balls),
        title="Amplitude of the table at the end" if balls else "Amplitude of the block at the end",
        caption="Fraction of a point's runs with a smaller amplitude at the end; all runs with an amplitude count, "
        f"whether at rest or moving.{sweep.failures_left_out(list(curves))}{sweep.left_out(list(curves))}{sampled}",
        alternative=words.listed([fact(row) for row in curves]),
        width=width,
        sheet=sheet,
        legend_title=sweep.short_names,
    )
