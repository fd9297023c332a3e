"""Draws preferred equilibria: the positions at which the runs come to rest."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Literal, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D

from . import runs, words
from .panels import Panel, angle_axis, lay_out
from .sets import EquilibriumSets
from .paper import INK, LABELS, Paper, Width
from .sweep import Sweep
from .tables import Directory, FiguresError, Source, Table

__all__ = ["preferred_equilibria"]

#: Largest number of pairs of balls shown.
_MOST_PAIRS = 6
_COUNTS = LinearSegmentedColormap.from_list("stickslip-counts", ["#e3eef6", "#56b4e9", "#0072b2"])
Background = Literal["set", "histogram", "none"]


def preferred_equilibria(
    directory: Source,
    *,
    equilibria: Optional[Source] = None,
    background: Optional[Background] = None,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws preferred equilibria: the angles from the imbalance [rad] at which the balls of each run came to rest.

    For two balls, each run at rest is a dot. If ``equilibria`` is the directory of `stickslip equilibria` for
    the same study (stored in the results as `study.yaml`), the background is the equilibrium set with the
    amplitude of the table, in the unit of the study; otherwise it is the histogram of
    `equilibrium_histogram.parquet`, the percentage of the point's runs at rest in each bin [%]. For more
    balls, each pair has a panel. For one ball, the axes are its angle and the amplitude; for a block, the
    position [m] and the time to rest [s]. `equilibrium_histogram.parquet` contains the confidence intervals
    of the bins. See figures 5.7 to 5.9 of the thesis.

    If the sweep sets the number of balls, all points shown must have the same number; without ``points``, these are the
    points with two balls, or with the largest number.

    ``background``: "set", "histogram" or "none" instead of the default; ``width``: "single" (90 mm) or
    "double" (180 mm); ``points``: numbers of the points to show; ``sheet``: which sheet of twelve panels, from 1.
    Above 100,000 runs it plots a labelled subsample. Raises FiguresError if no run came to rest
    (unless there are two balls), or if ``equilibria`` belongs to another study.
    """
    results = Directory(directory)
    sweep = Sweep(results)
    balls, rows = runs.points_of_one_number(results, sweep, points)
    if background not in (None, "set", "histogram", "none"):
        raise ValueError(f"background={background!r}: allowed are 'set', 'histogram', 'none'")
    if background == "set" and equilibria is None:
        raise ValueError("background='set' needs equilibria=, the directory of `stickslip equilibria`")
    behind = background or ("set" if equilibria is not None else "histogram")
    behind = behind if balls == 2 else "none"
    sets = EquilibriumSets(equilibria) if equilibria is not None and behind == "set" else None
    if sets is not None and sets.positions.about.get("study_hash") != sweep.table.about.get("study_hash"):
        raise FiguresError(
            sets.directory.path,
            sets.positions.name,
            f"it belongs to another study than {results.path}",
            f"repeat `stickslip equilibria {results.path / 'study.yaml'} --out DIR`",
        )
    places = [f"beta_{ball}_rad" for ball in range(1, balls + 1)] or _first_place(results.table("runs"))
    more = {0: ["time_to_rest_s"], 1: ["amplitude_m"]}.get(balls, [])
    sample = runs.read(results, sweep, rows, ["label", *places, *more])
    at_rest = sample.where(sample["label"] == "equilibrium")
    if not len(at_rest) and balls != 2:
        raise sweep.table.nothing("no run came to rest", "draw `ending_fractions` to see how the runs ended")
    rasterized = len(at_rest) > runs.MOST_VECTOR_DOTS
    colour = INK if balls > 1 else LABELS["equilibrium"][0]
    size = 1.1 if behind == "set" or balls > 2 else 1.6
    dot = Line2D(
        [],
        [],
        linestyle="none",
        marker="o",
        markersize=2,
        color=colour,
        markeredgewidth=0,
        label="run at rest",
    )
    counts = sweep.numbers(["equilibrium_runs"])["equilibrium_runs"]
    pairs = list(combinations(range(balls), 2))[:_MOST_PAIRS] if balls > 1 else [(0, 0)]
    panels = []
    for row in rows:
        for pair in pairs:

            def draw(axes: Axes, row: int = row, pair: tuple[int, int] = pair) -> Optional[ScalarMappable]:
                of_point = at_rest["point_id"] == sweep.ids[row]
                mappable = None
                if sets is not None:
                    mappable = sets.draw(axes, _same_point(sets, sweep, row), rasterized=True)
                elif behind == "histogram":
                    mappable = _histogram(axes, results, int(sweep.ids[row]))
                first = at_rest[places[pair[0]]][of_point].astype(float)
                second = at_rest[(more or places)[pair[1] if not more else 0]][of_point].astype(float)
                axes.plot(
                    first,
                    second / sweep.table.vibration[1] if balls == 1 else second,
                    linestyle="none",
                    marker="o",
                    markersize=size,
                    color=colour,
                    markeredgewidth=0,
                    rasterized=rasterized,
                    zorder=2,
                )
                if balls == 0:
                    axes.set(xlabel=words.axis("position at rest", results.table("runs").unit(places[0])), ylabel="time to rest [s]")
                else:
                    angle_axis(axes, "x", f"angle of ball {pair[0] + 1}")
                    if balls == 1:
                        axes.set_ylabel(sweep.amplitude)
                    else:
                        angle_axis(axes, "y", f"angle of ball {pair[1] + 1}")
                return mappable

            said = f"{counts[row]:.0f} of {sweep.runs[row]:.0f} at rest".replace(" ", "\u00a0")
            if balls > 2:
                said += f", β{words.subscript(pair[0] + 1)} and β{words.subscript(pair[1] + 1)}"
            amplitude = (sets.sweep if sets is not None else sweep).amplitude
            scale = {"set": amplitude, "histogram": "runs at rest per bin [%]"}.get(behind, "")
            keys = [dot, *(sets.keys() if sets is not None else [])]
            aspect = 1.0 if balls > 1 else 0.75
            panels.append(Panel(draw, sweep.named(row) + said, aspect, scale=scale, keys=keys))
    fractions = sweep.numbers(["set_fraction"])["set_fraction"] if balls else np.full(len(sweep), np.nan)
    told = []
    for row in rows:
        fact = f"{sweep.named(row)}{counts[row]:.0f} of {sweep.runs[row]:.0f} runs came to rest"
        if np.isfinite(fractions[row]):
            fact += f", and {100 * fractions[row]:.0f} % of all positions are equilibria"
        told.append(fact)
    return lay_out(
        panels,
        title="Where the system comes to rest" if balls == 0 else "Preferred equilibria",
        caption=_caption(balls, behind) + sweep.left_out(rows) + sample.subsample,
        alternative=words.listed(told),
        width=width,
        sheet=sheet,
        legend_title=sample.label,
    )


def _first_place(table: Table) -> list[str]:
    """Returns the column with the first coordinate of a system without balls, at the end of a run."""
    return [name for name in table.columns if name.startswith("end_") and name != "end_time_s"][:1]


def _caption(balls: int, behind: str) -> str:
    if balls == 0:
        return "Position and time at which each run came to rest."
    if balls == 1:
        return "Ball angle and amplitude of each run at rest."
    if balls > 2:
        return "Each dot shows the angles at which two balls of a run came to rest."
    return "Each dot shows the angles at which the balls of a run came to rest." + {
        "set": " Colour: amplitude of the nominal machine with the balls at rest there; white: no equilibrium, "
        "because friction cannot hold the balls. Stars and circles: stable and unstable equilibria without friction.",
        "histogram": " Colour: percentage of the point's runs at rest in each bin (in either order for identical balls); "
        "white: none.",
    }.get(behind, "")


def _same_point(sets: EquilibriumSets, sweep: Sweep, row: int) -> int:
    """Returns the row of a point in the equilibrium sets of the same study."""
    return sets.sweep.details([int(sweep.ids[row])])[0]


def _histogram(axes: Axes, results: Directory, point: int) -> Optional[ScalarMappable]:
    """Draws the percentage of a point's runs at rest in each bin; identical balls count in either order."""
    table = results.table("equilibrium_histogram")
    ends = [f"beta_{ball}_{end}_rad" for ball in (1, 2) for end in ("from", "to")]
    read = table.read(["point_id", "fraction", *ends])
    of = read["point_id"] == point
    if not np.any(of):
        return None
    left, right, low, high = (read[name][of].astype(float) for name in ends)
    cells = round(2 * np.pi / float(np.median(right - left)))
    grid = np.full((cells, cells), np.nan)
    size = 2 * np.pi / cells
    across = np.rint(left / size).astype(int) % cells
    up = np.rint(low / size).astype(int) % cells
    grid[up, across] = 100 * read["fraction"][of]
    if np.all(read["beta_1_from_rad"] <= read["beta_2_from_rad"]):
        # Identical balls have no order, so a bin counts both.
        grid[across, up] = 100 * read["fraction"][of]
    edges = np.linspace(0, 2 * np.pi, cells + 1)
    return axes.pcolormesh(
        edges,
        edges,
        np.ma.masked_invalid(np.where(grid > 0, grid, np.nan)),
        cmap=_COUNTS,
        vmin=0,
        rasterized=True,
        zorder=0,
    )
