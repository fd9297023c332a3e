"""The style of the figures, that of stickslip.figures."""

import sys

from .results import ROOT

sys.path.insert(0, str(ROOT / "python"))

import numpy as np  # noqa: E402
from stickslip.figures.panels import Panel, angle_axis, lay_out  # noqa: E402
from stickslip.figures.paper import DASHES, FAINT, INK, MARKS, SCALE, SERIES  # noqa: E402

FORCES = ("lagrange", "newton")
__all__ = [
    "DASHES",
    "FAINT",
    "FORCES",
    "INK",
    "MARKS",
    "SCALE",
    "SERIES",
    "Panel",
    "angle_axis",
    "bars",
    "lay_out",
    "scatter",
    "speed",
]


def speed(value):
    """A speed of the disc in a title."""
    return f"{value:.0f} rad/s".replace("-", "−")


def bars(axes, x, estimates, place, label=None, dashed=False):
    """A curve through estimates with intervals; one that is not known is left out."""
    known = [(at, *one) for at, one in zip(x, estimates) if one[0] is not None and one[0] == one[0]]
    if not known:
        return
    at, value, low, high = (np.array(column, dtype=float) for column in zip(*known))
    axes.errorbar(
        at,
        value,
        yerr=[np.maximum(value - low, 0), np.maximum(high - value, 0)],
        color=SERIES[place],
        linestyle=DASHES[1] if dashed else DASHES[0],
        marker=MARKS[place],
        markerfacecolor="white" if dashed else SERIES[place],
        elinewidth=0.7,
        label=label,
    )


def scatter(rests):
    """A panel of rests in the plane of both angles, in both orders of the balls."""

    def draw(axes):
        both = np.concatenate([rests, rests[:, ::-1]]) if len(rests) else np.empty((0, 2))
        axes.plot(
            both[:, 0],
            both[:, 1],
            linestyle="none",
            marker="o",
            markersize=1.3,
            color=INK,
            markeredgewidth=0,
            rasterized=True,
        )
        angle_axis(axes, "x", "angle of ball 1")
        angle_axis(axes, "y", "angle of ball 2")

    return draw
