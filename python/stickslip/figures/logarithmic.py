"""Draws measurements of time, memory and error on logarithmic axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator

from .panels import Panel, lay_out
from .paper import DASHES, MARKS, SERIES, Paper

__all__ = ["Curve", "Curves", "logarithmic"]


@dataclass
class Curve:
    """Points joined by a line; points with a coordinate that is not positive are omitted."""

    points: Sequence[tuple[float, float]]
    #: The legend entry; empty for no entry.
    name: str = ""
    #: The index of the colour and mark; by default the index of the curve.
    colour: Optional[int] = None
    dashed: bool = False


@dataclass
class Curves:
    """A panel of curves, with the labels of its axes."""

    title: str
    x: str
    y: str
    curves: Sequence[Curve]


def logarithmic(panels: Sequence[Curves], *, columns: int, title: str, caption: str = "") -> Paper:
    """Draws panels of curves on logarithmic axes, 180 mm wide."""

    def panel(of: Curves) -> Panel:
        def draw(axes: Axes) -> None:
            for place, curve in enumerate(of.curves):
                number = place if curve.colour is None else curve.colour
                points = [point for point in curve.points if min(point) > 0]
                style: dict[str, Any] = {"linestyle": DASHES[1] if curve.dashed else "-"}
                axes.plot(
                    [x for x, _ in points],
                    [y for _, y in points],
                    color=SERIES[number % len(SERIES)],
                    marker=MARKS[number % len(MARKS)],
                    markerfacecolor="white",
                    label=curve.name,
                    **style,
                )
            axes.set(xscale="log", yscale="log", xlabel=of.x, ylabel=of.y)
            axes.margins(0.05, 0.1)
            for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
                # Over few decades, ticks at 1, 2 and 5 times each power of ten.
                if high / low < 300:
                    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.grid(color="#e4e4e4", linewidth=0.4)
            axes.set_axisbelow(True)

        return Panel(draw, of.title)

    alternative = f"Curves of {', '.join(f'{of.y} over {of.x}' for of in panels)}."
    return lay_out(
        [panel(of) for of in panels],
        title=title,
        caption=caption,
        alternative=alternative,
        width="double",
        columns=columns,
    )
