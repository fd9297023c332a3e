"""Draws the amplitude over the equilibrium set as a surface."""

from __future__ import annotations

from typing import Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D

from .panels import Panel, lay_out
from .sets import EquilibriumSets, nice
from .paper import SCALE, SERIES, Paper, Width
from .tables import Source

__all__ = ["equilibrium_surface"]

#: Number of cells per axis.
_CELLS = 128


def equilibrium_surface(directory: Source, *, width: Optional[Width] = None, point: int = 0) -> Paper:
    """Draws the amplitude over the equilibrium set of two balls as a surface over their angles [rad].

    The amplitude is in the unit of the study. Positions in the holes are not equilibria. The dashed plane is the amplitude of the same machine without balls, if
    it is bounded. The amplitudes are closed forms without statistical errors, drawn on a
    grid of 128 cells per axis. See figure 5.2 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm); ``point``: number of the point to show. Raises
    FiguresError if the directory was not written by `stickslip equilibria` for a study with two balls.
    """
    sets = EquilibriumSets(directory)
    (row,) = sets.sweep.details([point])
    grid = sets.grid(row)
    angle, amplitude = grid.closed(grid.amplitude, _CELLS)
    _, margin = grid.closed(grid.margin, _CELLS)
    highest = float(amplitude[margin >= 0].max()) if np.any(margin >= 0) else float(amplitude.max())
    step = nice(highest / 6)
    top = step * np.ceil(highest / step - 1e-9)
    unit, si = sets.sweep.table.vibration
    column = "amplitude_without_balls_m"
    without = float(sets.sweep.numbers([column])[column][row]) / si
    keys = []
    if without <= top:
        name = f"amplitude without balls: {without:.4g} {unit}"
        keys = [Line2D([], [], color=SERIES[1], linestyle=(0, (4, 2)), label=name)]

    def draw(axes: Axes) -> ScalarMappable:
        first, second = np.meshgrid(angle, angle, indexing="ij")
        held = np.where(margin >= 0, amplitude, np.nan)
        norm = Normalize(0.0, top)
        axes.plot_surface(  # type: ignore[attr-defined]
            first,
            second,
            held,
            rcount=_CELLS,
            ccount=_CELLS,
            facecolors=SCALE(norm(amplitude)),
            linewidth=0,
            antialiased=False,
            shade=False,
            rasterized=True,
        )
        axes.plot_wireframe(  # type: ignore[attr-defined]
            first,
            second,
            held + 0.004 * top,
            rcount=16,
            ccount=16,
            colors="#606060",
            linewidth=0.3,
            rasterized=True,
        )
        for handle in keys:
            corners = 2 * np.pi * np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
            axes.plot(
                corners[:, 0],
                corners[:, 1],
                np.full(5, without),
                color=handle.get_color(),
                linestyle=(0, (4, 2)),
                zorder=10,
            )
        quarters = [place * np.pi / 2 for place in range(5)]
        for which in ("x", "y"):
            axes.set(**{f"{which}lim": (0, 2 * np.pi)})
            getattr(axes, f"set_{which}ticks")(quarters, ("0", "π/2", "π", "3π/2", "2π"))
        axes.set(xlabel="angle of ball 1 [rad]", ylabel="angle of ball 2 [rad]", zlim=(0, top))
        axes.set_zlabel("")  # type: ignore[attr-defined]
        axes.view_init(elev=32, azim=-62)  # type: ignore[attr-defined]
        axes.set_box_aspect((4, 4, 2.6), zoom=0.95)  # type: ignore[arg-type, call-arg]
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):  # type: ignore[attr-defined]
            axis.set_pane_color((1, 1, 1, 0))  # type: ignore[union-attr]
            axis._axinfo["grid"].update(color="#d8d8d8", linewidth=0.4)  # type: ignore[union-attr]
        axes.tick_params(pad=-2)
        axes.xaxis.labelpad = axes.yaxis.labelpad = -4
        return ScalarMappable(norm, SCALE)

    said = f" Without balls it is {without:.4g} {unit}." if np.isfinite(without) else ""
    title = sets.sweep.title(row)
    return lay_out(
        [Panel(draw, title, scale=sets.sweep.amplitude, keys=keys, in_space=True)],
        title="Amplitude over the equilibrium set",
        caption="Amplitude of the table over the angles at which dry friction holds both balls; dashed: amplitude "
        "without balls.",
        alternative=f"The amplitude goes up to {highest:.4g} {unit}.{said}",
        width=width,
    )
