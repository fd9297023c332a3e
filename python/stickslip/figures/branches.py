"""Draws the frictionless equilibria over the speed of the disc."""

from __future__ import annotations

from typing import Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .machine import natural_frequency_rad_s
from .panels import Panel, angle_axis, lay_out
from .paper import FAINT, INK, SERIES, Paper, Width
from .tables import Directory, Numbers, Source

__all__ = ["frictionless_branches"]

#: Approximate number of circles on a branch that covers all speeds.
_CIRCLES = 30
_DASHED = (0, (5, 1.8))
#: Names of the kinds, as in the thesis.
_KINDS = {
    "a1_plus": "A1+",
    "a1_minus": "A1−",
    "a2": "A2",
    "b1": "B1",
    "other": "on one line",
    "everywhere": "everywhere",
}


def frictionless_branches(directory: Source, *, width: Optional[Width] = None, sheet: int = 1) -> Paper:
    """Draws the ball angles [rad] of the equilibria without dry friction over the speed of the disc.

    Each kind has a panel: A1+ and A1− with all balls together, A2 with two balls opposite each other, B1
    balanced, and further kinds for three or more balls. Stable branches are solid; unstable branches are dashed
    with circles. The dashed vertical line is the natural frequency. The angles are closed forms without
    statistical errors. See figure 5.1 of the thesis.

    ``width``: "single" (90 mm) or "double" (180 mm). Raises FiguresError if the directory has no
    `frictionless_equilibria.parquet` with three or more speeds (`stickslip equilibria --speeds=FROM:TO:N`).
    """
    table = Directory(directory).table("frictionless_equilibria")
    table.need(["speed_rad_s", "kind", "stability"])
    own = table.columns[: table.columns.index("kind")]
    other = [column for column in own if column not in ("point_id", "speed_rad_s")]
    remedy = "repeat `stickslip equilibria` with --speeds=FROM:TO:N, or sweep only the speed"
    if other:
        raise table.nothing(f"it is also swept over {', '.join(other)}", remedy)
    angles = [name for name in table.columns if name.startswith("beta_") and name.endswith("_rad")]
    read = table.read(["speed_rad_s", "kind", "stability", *angles])
    unit, si = table.speed
    read["speed_rad_s"] = read["speed_rad_s"] / si
    speeds = np.unique(read["speed_rad_s"])
    if speeds.size < 3:
        raise table.nothing(f"it has {speeds.size} speeds, and branches need three", remedy)
    # The speed's magnitude increases to the right for either direction of rotation.
    clockwise = bool(speeds[-1] <= 0)
    sign = -1.0 if clockwise else 1.0
    natural_rad_s = natural_frequency_rad_s(table.parameters)
    natural = None if natural_rad_s is None else natural_rad_s / si
    beta = np.array([read[name].astype(float) for name in angles])
    exists = np.all(np.isfinite(beta), axis=0)
    stable = read["stability"] == "stable"
    kinds = [kind for kind in _KINDS if np.any((read["kind"] == kind) & exists)]
    if not kinds:
        raise table.nothing("it has no equilibria with determined ball angles", remedy)
    keys = [
        Line2D([], [], color=INK, label="stable"),
        Line2D([], [], color=INK, linestyle=_DASHED, marker="o", markerfacecolor="white", label="unstable"),
    ]
    panels = []
    for kind in kinds:
        of = (read["kind"] == kind) & exists
        together = bool(np.all(beta[:, of] == beta[:1, of]))

        def draw(axes: Axes, of: NDArray[np.bool_] = of, together: bool = together) -> None:
            for ball in range(1 if together else len(angles)):
                colour = SERIES[2] if together else SERIES[ball % len(SERIES)]
                name = "all balls together" if together else f"ball {ball + 1}"
                for kept, dashes in ((of & stable, "-"), (of & ~stable, _DASHED)):
                    place = np.searchsorted(speeds, read["speed_rad_s"][kept])
                    order = np.argsort(sign * place, kind="stable")
                    place, angle = place[order], beta[ball, kept][order]
                    x, y = _connected(place, sign * speeds[place], angle)
                    axes.plot(x, y, color=colour, linestyle=dashes)
                    if dashes != "-":
                        every = max(1, -(-speeds.size // _CIRCLES))
                        few = place % every == every // 2
                        if not np.any(few):
                            continue
                        axes.plot(
                            sign * speeds[place[few]],
                            angle[few],
                            linestyle="none",
                            marker="o",
                            color=colour,
                            markerfacecolor="white",
                            markersize=3.2,
                            clip_on=False,
                            zorder=3,
                        )
                axes.plot([], [], color=colour, label=name)
            angle_axis(axes, "y", "angle of the balls")
            axes.set_xlim(float(np.min(sign * speeds)), float(np.max(sign * speeds)))
            axes.set_xlabel(f"speed of the disc {'−ω' if clockwise else 'ω'} [{unit}]")
            if natural is not None:
                axes.axvline(natural, color=FAINT, linewidth=0.7, linestyle=(0, (4, 2)), zorder=1)
                axes.annotate(
                    "ωₙ",
                    (natural, 1.0),
                    xycoords=("data", "axes fraction"),
                    xytext=(0, 2),
                    textcoords="offset points",
                    ha="center",
                    va="bottom",
                )

        panels.append(Panel(draw, _KINDS[kind], keys=keys))
    told = [
        f"{_KINDS[kind]} is stable at {np.count_nonzero((read['kind'] == kind) & stable)} of the "
        f"{np.count_nonzero(read['kind'] == kind)} speeds at which it exists"
        for kind in kinds
    ]
    return lay_out(
        panels,
        title="Equilibria without dry friction over the speed of the disc",
        caption="Angles of the balls at rest without dry friction: A1+ and A1− all balls together, A2 balls opposite "
        "each other, B1 balanced. Solid: stable; dashed with circles: unstable; ωₙ: natural frequency.",
        alternative=f"{'; '.join(told)}; of {speeds.size} speeds.",
        width=width,
        sheet=sheet,
    )


def _connected(place: NDArray[np.int64], x: Numbers, y: Numbers) -> tuple[Numbers, Numbers]:
    """Returns a line through points at neighbouring speeds, broken at missing speeds and where an angle wraps."""
    gaps = np.flatnonzero((np.abs(np.diff(place)) > 1) | (np.abs(np.diff(y)) > np.pi)) + 1
    return np.insert(x, gaps, np.nan), np.insert(y, gaps, np.nan)
