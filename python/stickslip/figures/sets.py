"""Draws the equilibrium set of two balls and their equilibria without friction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .panels import Panel, angle_axis, lay_out
from .paper import FAINT, INK, SCALE, SERIES, Paper, Width
from .sweep import Sweep
from .tables import Directory, Numbers, Source

__all__ = ["EquilibriumSets", "Grid", "equilibrium_set"]

#: Largest number of cells per axis; more are invisible and make large files.
_MOST_CELLS = 256
#: Approximate largest number of amplitude bands.
_BANDS = 12


@dataclass
class Grid:
    """Positions on a grid over one turn: rows belong to angles of ball 1, columns to angles of ball 2."""

    amplitude: Numbers
    margin: Numbers

    @property
    def identical_balls(self) -> bool:
        """Whether the balls are identical, so that exchanging them changes nothing."""
        return bool(np.allclose(self.amplitude, self.amplitude.T, rtol=1e-6, atol=1e-9))

    def closed(self, values: Numbers, most: int = _MOST_CELLS) -> tuple[Numbers, Numbers]:
        """Returns the angles and values of a coarser grid that contains both 0 and 2π."""
        step = max(1, -(-len(values) // most))
        some = np.pad(values[::step, ::step], ((0, 1), (0, 1)), mode="wrap")
        return np.linspace(0.0, 2 * np.pi, len(some)), some

    def levels(self) -> Numbers:
        """Returns equidistant amplitudes that enclose the set's, with a step of 1, 2 or 5 times a power of ten."""
        held = self.amplitude[self.margin >= 0]
        held = held if held.size else self.amplitude
        low, high = float(held.min()), float(held.max())
        step = nice(max((high - low) / _BANDS, 1e-9 * high, 1e-30))
        return step * np.arange(np.floor(low / step), np.floor(high / step) + 2)


def nice(step: float) -> float:
    """Returns the least of 1, 2 and 5 times a power of ten that is at least 0.95 times the step."""
    power = 10.0 ** np.floor(np.log10(step))
    return float(next((factor * power for factor in (1, 2, 5) if factor * power >= 0.95 * step), 10 * power))


def _widened(held: NDArray[np.bool_], cells: int = 6) -> NDArray[np.bool_]:
    """Returns the set widened by a number of cells in every direction; the grid is periodic."""
    wide = held.copy()
    for axis in (0, 1):
        wide = np.logical_or.reduce([np.roll(wide, by, axis) for by in range(-cells, cells + 1)])
    return wide


class EquilibriumSets:
    """The tables of `stickslip equilibria`: a grid of positions for each point, and its frictionless equilibria."""

    def __init__(self, directory: Source) -> None:
        self.directory = Directory(directory)
        self.positions = self.directory.table("equilibrium_positions")
        balls = sum(1 for name in self.positions.columns if name.startswith("beta_"))
        if balls != 2:
            raise self.positions.nothing(
                f"its positions have {balls} ball{'s' * (balls != 1)}, and the figure needs two",
                "compute the equilibria of a study with two balls",
            )
        self.positions.need(["point_id", "amplitude_m", "friction_margin"])
        if self.positions.about.get("options", {}).get("samples"):
            raise self.positions.nothing(
                "its positions are random samples, and the figure needs a grid",
                "repeat `stickslip equilibria` without --samples",
            )
        self.sweep = Sweep(self.directory, "equilibrium_set_summary", "grid_positions")
        self.summary = self.sweep.numbers(["fraction", "amplitude_max_m"])

    def grid(self, row: int) -> Grid:
        """Returns the grid of a point."""
        point = self.sweep.ids[row]
        parts = [
            (
                batch["beta_1_rad"][of],
                batch["beta_2_rad"][of],
                batch["amplitude_m"][of],
                batch["friction_margin"][of],
            )
            for batch in self.positions.batches(
                ["point_id", "beta_1_rad", "beta_2_rad", "amplitude_m", "friction_margin"]
            )
            for of in [batch["point_id"] == point]
            if np.any(of)
        ]
        if not parts:
            raise self.positions.error(
                f"it has no positions of point {point}", "repeat `stickslip equilibria`"
            )
        first, second, amplitude, margin = (np.concatenate(column).astype(float) for column in zip(*parts))
        side = round(float(np.sqrt(first.size)))
        if side * side != first.size:
            raise self.positions.error(
                f"its {first.size} positions of point {point} do not form a square grid",
                "repeat `stickslip equilibria`",
            )
        order = np.lexsort((second, first))
        margin = np.nan_to_num(margin, nan=-1e3, neginf=-1e3).clip(min=-1e3)
        amplitude /= self.positions.vibration[1]
        return Grid(amplitude[order].reshape(side, side), margin[order].reshape(side, side))

    def frictionless(self, row: int) -> Optional[dict[str, NDArray[Any]]]:
        """Returns the equilibria without friction of a point, or None without a table of the points."""
        if not self.directory.has("frictionless_equilibria"):
            return None
        table = self.directory.table("frictionless_equilibria")
        if "point_id" not in table.columns:
            return None
        read = table.read(["point_id", "stability", "beta_1_rad", "beta_2_rad"])
        of = (read["point_id"] == self.sweep.ids[row]) & np.isfinite(read["beta_1_rad"].astype(float))
        return {name: values[of] for name, values in read.items()}

    def draw(self, axes: Axes, row: int) -> ScalarMappable:
        """Draws the amplitude in the set of a point, its edge, and the equilibria without friction."""
        grid = self.grid(row)
        levels = grid.levels()
        norm = BoundaryNorm(levels, SCALE.N)
        held = grid.margin >= 0
        if np.any(held):
            # The abscissa is the angle of ball 1. Amplitudes far from the set would be covered and are not drawn.
            angle, amplitude = grid.closed(
                np.where(_widened(held), grid.amplitude, np.nan), _MOST_CELLS // 2
            )
            shown = np.ma.masked_invalid(amplitude.T)
            axes.contourf(angle, angle, shown, levels=levels, cmap=SCALE, norm=norm, zorder=0)
            lines: dict[str, Any] = {"colors": FAINT, "linewidths": 0.4, "linestyles": "-"}
            axes.contour(angle, angle, shown, levels=levels, zorder=0.1, **lines)
        if np.any(held) and not np.all(held):
            angle, margin = grid.closed(grid.margin)
            axes.contourf(angle, angle, margin.T, levels=[-1e9, 0.0], colors="white", zorder=0.2)
            axes.contour(angle, angle, margin.T, levels=[0.0], colors=INK, linewidths=0.9, zorder=0.3)
        found = self.frictionless(row)
        if found is not None:
            for name, mark, size, fill in _STABILITIES:
                stable = found["stability"] == "stable"
                of = stable if name.startswith("stable") else ~stable
                x, y = found["beta_1_rad"][of].astype(float), found["beta_2_rad"][of].astype(float)
                if grid.identical_balls:
                    other = x != y
                    x, y = np.r_[x, y[other]], np.r_[y, x[other]]
                if not x.size:
                    continue
                axes.plot(
                    x,
                    y,
                    linestyle="none",
                    marker=mark,
                    markersize=size,
                    color=SERIES[1],
                    zorder=4,
                    markerfacecolor=fill,
                    markeredgewidth=0.4 if fill != "white" else 1.0,
                    markeredgecolor="white" if fill != "white" else SERIES[1],
                    clip_on=False,
                )
        return ScalarMappable(norm, SCALE)

    def keys(self) -> list[Line2D]:
        """Returns the entries of the legend."""
        found = [Line2D([], [], color=INK, linewidth=0.9, label="edge of the equilibrium set")]
        if self.directory.has("frictionless_equilibria"):
            found += [
                Line2D(
                    [],
                    [],
                    linestyle="none",
                    marker=mark,
                    markersize=size,
                    color=SERIES[1],
                    markerfacecolor=fill,
                    label=name,
                )
                for name, mark, size, fill in _STABILITIES
            ]
        return found


_STABILITIES = (
    ("stable without friction", "*", 7.0, SERIES[1]),
    ("unstable without friction", "o", 3.6, "white"),
)


def equilibrium_set(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws the equilibrium set of two balls: the angles [rad] at which dry friction holds both.

    The colour is the amplitude of the table's vibration, in the unit of the study, with the balls at rest
    there; white positions are not equilibria. Stars and circles are the stable and unstable equilibria
    without friction. Each point of the sweep has a panel. The grid of `equilibrium_positions.parquet`
    contains closed forms without sampling errors and is drawn with at most 256 cells per axis. See figures
    5.3 to 5.5 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show; ``sheet``:
    which sheet of twelve panels, from 1. Raises FiguresError if the directory was not written by
    `stickslip equilibria` for a study with two balls.
    """
    sets = EquilibriumSets(directory)
    rows = sets.sweep.details(points)
    panels = []
    for row in rows:

        def draw(axes: Axes, row: int = row) -> ScalarMappable:
            mappable = sets.draw(axes, row)
            angle_axis(axes, "x", "angle of ball 1")
            angle_axis(axes, "y", "angle of ball 2")
            return mappable

        panels.append(Panel(draw, sets.sweep.title(row), 1.0, scale=sets.sweep.amplitude, keys=sets.keys()))
    told = [
        f"{sets.sweep.named(row)}{100 * sets.summary['fraction'][row]:.1f} % of all positions are equilibria"
        for row in rows
    ]
    return lay_out(
        panels,
        title="Equilibrium set",
        caption="Angles at which dry friction holds both balls. Colour: amplitude of the table; white: no equilibrium. "
        f"Stars and circles: stable and unstable equilibria without friction.{sets.sweep.left_out(rows)}",
        alternative="; ".join(told) + ".",
        width=width,
        sheet=sheet,
    )
