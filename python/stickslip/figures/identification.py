"""Draws the posterior of inferred parameters, and measured and predicted positions of rest."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator
from numpy.typing import NDArray

from . import words
from .panels import MOST_PANELS, Panel, angle_axis, lay_out
from .paper import INK, SERIES, TYPE_PT, Paper, Width
from .sweep import Sweep, evenly, listed
from .tables import Directory, Numbers, Source

__all__ = ["identification"]

#: Colours of what is inferred or predicted, and of what is measured.
_INFERRED, _MEASURED = SERIES[0], SERIES[1]
_PALE = "#b2d2e8"
#: Colour of the half of a torus in which the smaller angle would exceed the larger.
_UNUSED = "#f0f0f0"
#: Number of bins in a 95 % interval, and the fewest and the most bins in the range of a prior.
_BINS_IN_INTERVAL, _FEWEST_BINS, _MOST_BINS = 20, 25, 200
#: Number of bins in a turn.
_ANGLE_BINS = 24
#: Largest number of samples drawn as dots.
_MOST_SAMPLES = 4_000
#: Largest number of letters in a line of a parameter's name at an axis.
_LABEL_LETTERS = 20
_SPACE = "\u00a0"


@dataclass(frozen=True)
class _Parameter:
    """An inferred parameter with the range of its prior and the marginal of its posterior."""

    name: str
    unit: str
    prior: tuple[float, float]
    is_logarithmic: bool
    median: float
    interval: tuple[float, float]
    is_identified: bool
    samples: Numbers

    @property
    def power(self) -> int:
        """The power of ten that numbers on a linear axis are given in: 0 unless they are small or large."""
        largest = max(abs(end) for end in self.prior)
        if self.is_logarithmic or largest == 0 or 1e-2 <= largest < 1e4:
            return 0
        return int(np.floor(np.log10(largest)))

    @property
    def label(self) -> str:
        """The name with the unit and the power of ten, on short lines."""
        tens = f"10{words.superscript(self.power)}" if self.power else ""
        return "\n".join(textwrap.wrap(words.axis(self.name, f"{tens} {self.unit}".strip()), _LABEL_LETTERS))

    @property
    def result(self) -> str:
        """The median and the interval with the unit: `0.0028 (0.0026 to 0.003)`."""
        low, high = (f"{end:.3g}" for end in self.interval)
        text = f"{self.median:.3g} ({low}{_SPACE}to{_SPACE}{high})".replace("-", "−")
        return f"{text}{_SPACE}{self.unit}".strip()

    def scaled(self, values: Any) -> Any:
        """Returns values on the scale on which the prior is uniform."""
        return np.log(values) if self.is_logarithmic else np.asarray(values, dtype=float)

    def histogram(self) -> tuple[Numbers, Numbers]:
        """Returns the edges of bins over the range of the prior, and posterior over prior density in each."""
        low, high = self.scaled(self.prior)
        width = np.ptp(self.scaled(self.interval)) / _BINS_IN_INTERVAL
        bins = int(np.clip(np.ceil((high - low) / max(width, 1e-300)), _FEWEST_BINS, _MOST_BINS))
        found, edges = np.histogram(self.scaled(self.samples), bins=bins, range=(low, high))
        edges = np.exp(edges) if self.is_logarithmic else edges
        return edges, found * bins / max(len(self.samples), 1)

    def near(self) -> tuple[float, float]:
        """Returns the range of the samples with margins, or that of the prior where it is hardly larger."""
        low, high = self.scaled(self.prior)
        first, last = self.scaled(np.array([self.samples.min(), self.samples.max()]))
        margin = 0.08 * (last - first) or 0.05 * (high - low)
        if last - first < 0.5 * (high - low):
            low, high = max(low, first - margin), min(high, last + margin)
        ends = np.exp([low, high]) if self.is_logarithmic else (low, high)
        return float(ends[0]), float(ends[1])

    def axis(self, axes: Axes, which: str, limits: tuple[float, float], is_narrow: bool) -> None:
        """Sets an axis of a panel to this parameter."""
        if self.is_logarithmic:
            getattr(axes, f"set_{which}scale")("log")
        getattr(axes, f"set_{which}lim")(*limits)
        getattr(axes, f"set_{which}label")(self.label)
        axis = axes.xaxis if which == "x" else axes.yaxis
        if self.is_logarithmic:
            axis.set_major_locator(FixedLocator(_few_ticks(*limits, 0.42 if is_narrow else 0.3)))
            axis.set_minor_locator(NullLocator())
        else:
            axis.set_major_locator(MaxNLocator(2 if is_narrow else 4, steps=[1, 2, 5, 10]))
            power = self.power
            if power:
                axis.set_major_formatter(FuncFormatter(lambda value, _: words.number(value / 10.0**power)))


def _few_ticks(low: float, high: float, apart: float) -> list[float]:
    """Returns few round ticks of a logarithmic axis, ``apart`` of its length from each other."""
    powers = range(int(np.floor(np.log10(low))), int(np.ceil(np.log10(high))) + 1)
    for factors in ((1,), (1, 3), (1, 2, 5), range(1, 10)):
        found = [factor * 10.0**power for power in powers for factor in factors]
        found = [tick for tick in found if 0.999 * low <= tick <= 1.001 * high]
        if len(found) >= 3:
            break
    else:
        found = [float(tick) for tick in MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high)]
        found = [tick for tick in found if low <= tick <= high]
    kept = found[:1]
    for tick in found[1:]:
        if np.log(tick / kept[-1]) >= apart * np.log(high / low):
            kept.append(tick)
    return kept


@dataclass(frozen=True)
class _Site:
    """A point and stage with measured runs."""

    title: str
    measured: Numbers
    predicted: Numbers
    rests: int
    moving: int
    predicted_fraction: float
    p_value: float

    @property
    def facts(self) -> list[str]:
        """The probability of such a deviation, and the rests measured and predicted."""
        return [
            f"p{_SPACE}={_SPACE}{self.p_value:.3f}",
            f"rests{_SPACE}{self.rests}{_SPACE}of{_SPACE}{self.rests + self.moving}",
            f"predicted{_SPACE}{100 * self.predicted_fraction:.0f}{_SPACE}%",
        ]

    @property
    def long_title(self) -> str:
        """The title with these facts."""
        return f"{self.title}\n{'; '.join([*self.facts[1:], self.facts[0]])}"

    @property
    def told(self) -> str:
        """The same facts in a sentence."""
        return (
            f"{self.title}: {self.rests} of {self.rests + self.moving} measured runs are at rest, predicted "
            f"{100 * self.predicted_fraction:.0f} %, p = {self.p_value:.3f}"
        )


class _Identification:
    """The tables of `stickslip identify`."""

    def __init__(self, directory: Source) -> None:
        self.directory = Directory(directory)
        self.posterior = self.directory.table("posterior")
        self.summary = self.directory.object("identification")

    def _said(self, found: Any, *keys: str) -> Any:
        """Returns a value of `identification.json`."""
        for key in keys:
            if not isinstance(found, Mapping) or key not in found:
                raise self.directory.error(
                    "identification.json",
                    f"it has no {'.'.join(keys)}",
                    "write the directory with the version of stickslip that contains this module",
                )
            found = found[key]
        return found

    @cached_property
    def parameters(self) -> list[_Parameter]:
        """The inferred parameters."""
        about = self.posterior.about.get("options", {}).get("identify", {}).get("parameters", {})
        columns = self.posterior.columns
        samples = self.posterior.read(columns)
        found = {self._said(one, "parameter"): one for one in self._said(self.summary, "parameters")}
        if list(found) != columns or not self.posterior.rows:
            raise self.posterior.error(
                "it has not the parameters of identification.json", "repeat `stickslip identify`"
            )

        def parameter(column: str, one: Any) -> _Parameter:
            low, high = (float(end) for end in self._said(one, "prior"))
            unit = self.posterior.unit(column)
            spacing = about.get(column, {}).get("spacing")
            return _Parameter(
                words.parameter(column, unit),
                unit,
                (low, high),
                spacing == "logarithmic" and low > 0,
                float(self._said(one, "median")),
                (float(self._said(one, "low")), float(self._said(one, "high"))),
                bool(self._said(one, "identified")),
                samples[column].astype(float),
            )

        return [parameter(column, one) for column, one in found.items()]

    def correlation(self, first: int, second: int) -> float:
        """Returns the correlation of two parameters."""
        return float(self._said(self.summary, "correlations")[first][second])

    @cached_property
    def verdict(self) -> str:
        """Whether the model explains the measured runs, in words."""
        does = "does not explain" if self._said(self.summary, "fit", "rejected") else "explains"
        numbers = self.fit.numbers(["measured_rests", "measured_moving"])
        runs = sum(int(values.sum()) for values in numbers.values())
        p_value = float(self._said(self.summary, "fit", "p_value"))
        return f"The model {does} the {runs} measured runs (p{_SPACE}={_SPACE}{p_value:.3f})."

    @cached_property
    def fit(self) -> Sweep:
        """The points and stages with measured runs."""
        return Sweep(self.directory, "fit", "stage")

    @cached_property
    def balls(self) -> int:
        """The number of balls."""
        columns = self.directory.table("positions").columns
        return sum(1 for name in columns if name.startswith("beta_"))

    def rows(self, points: Optional[Sequence[int]]) -> list[int]:
        """Returns the rows of the points and stages shown."""
        ids = self.fit.ids.tolist()
        points = None if points is None else listed(points)
        for point in points or ():
            if point not in ids:
                raise self.fit.table.error(
                    f"it has no point {point!r}", f"points are {', '.join(map(str, sorted(set(ids))))}"
                )
        chosen = [row for row, point in enumerate(ids) if points is None or point in points]
        return [chosen[place] for place in evenly(len(chosen), MOST_PANELS)]

    def sites(self, rows: Sequence[int]) -> list[_Site]:
        """Returns points and stages with their positions of rest."""
        stages = self.fit.numbers(["stage"])["stage"]
        counts = self.fit.numbers(["measured_rests", "measured_moving", "predicted_rest_fraction", "p_value"])
        angles = [f"beta_{ball}_rad" for ball in range(1, self.balls + 1)]
        read = self.directory.table("positions").read(["source", "point_id", "stage", "at_rest", *angles])
        is_measured = read["source"] == "measured"
        turned = [np.mod(read[name].astype(float), 2 * np.pi) for name in angles]
        positions = np.sort(np.column_stack(turned), axis=1) if angles else np.empty((len(is_measured), 0))

        def site(row: int) -> _Site:
            here = (read["point_id"] == self.fit.ids[row]) & (read["stage"] == stages[row])
            here &= read["at_rest"].astype(bool)
            title = self.fit.title(row)
            if len(np.unique(stages)) > 1:
                title = f"{title}, stage {stages[row]:.0f}".removeprefix(", ")
            return _Site(
                title or "all measured runs",
                positions[here & is_measured],
                positions[here & ~is_measured],
                int(counts["measured_rests"][row]),
                int(counts["measured_moving"][row]),
                float(counts["predicted_rest_fraction"][row]),
                float(counts["p_value"][row]),
            )

        return [site(row) for row in rows]


def _marginal(parameter: _Parameter, is_narrow: bool) -> Panel:
    """Returns the panel of the posterior of a parameter; ``is_narrow``: there is room for few ticks."""

    def draw(axes: Axes) -> None:
        edges, ratio = parameter.histogram()
        axes.stairs(ratio, edges, fill=True, color=_PALE, zorder=1)
        axes.stairs(ratio, edges, color=_INFERRED, linewidth=0.8, zorder=2)
        axes.axhline(1.0, color=INK, linewidth=0.9, linestyle=(0, (4, 1.6)), zorder=3)
        top = 1.25 * max(float(ratio.max()), 1.0)
        # The interval is a bar above the posterior.
        axes.plot(
            parameter.interval, [0.9 * top] * 2, color=INK, linewidth=1.1, solid_capstyle="butt", zorder=4
        )
        for end in parameter.interval:
            axes.plot([end] * 2, [0, 0.925 * top], color=INK, linewidth=0.6, zorder=4)
        axes.plot([parameter.median], [0.9 * top], color=INK, marker="o", markersize=3.5, zorder=5)
        if not parameter.is_identified:
            axes.text(
                0.5,
                0.06,
                "not identified",
                transform=axes.transAxes,
                ha="center",
                weight="bold",
                zorder=6,
                bbox={"facecolor": "white", "edgecolor": INK, "linewidth": 0.6, "pad": 2.0},
            )
        parameter.axis(axes, "x", parameter.prior, is_narrow)
        axes.set_ylim(0, top)
        axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
        axes.set_ylabel("density / prior's")

    return Panel(draw, parameter.result, 1.0)


def _pair(across: _Parameter, up: _Parameter, correlation: float, is_narrow: bool) -> Panel:
    """Returns the panel of the samples of two parameters."""
    one_in = -(-len(across.samples) // _MOST_SAMPLES)

    def draw(axes: Axes) -> None:
        axes.plot(
            across.samples[::one_in],
            up.samples[::one_in],
            linestyle="none",
            marker="o",
            markersize=1.4,
            markeredgewidth=0,
            color=_INFERRED,
            alpha=0.35,
            rasterized=True,
        )
        for values, line in ((across.interval, axes.axvline), (up.interval, axes.axhline)):
            for end in values:
                line(end, color=INK, linewidth=0.6, zorder=3)
        across.axis(axes, "x", across.near(), is_narrow)
        up.axis(axes, "y", up.near(), is_narrow)

    return Panel(draw, f"correlation {correlation:.2f}".replace("-", "−"), 1.0)


def _torus(site: _Site, is_narrow: bool) -> Panel:
    """Returns the panel of two balls: the smaller and the larger angle of each run at rest."""

    def draw(axes: Axes) -> None:
        turn = 2 * np.pi
        axes.fill([0, turn, turn], [0, 0, turn], color=_UNUSED, linewidth=0, zorder=0)
        axes.plot(
            *site.predicted.T,
            linestyle="none",
            marker="o",
            markersize=2.2,
            markeredgewidth=0,
            color=_INFERRED,
            alpha=0.3,
            rasterized=True,
            zorder=1,
        )
        axes.plot(
            *site.measured.T,
            linestyle="none",
            marker="D",
            markersize=2.9,
            markeredgewidth=0.4,
            markeredgecolor="white",
            color=_MEASURED,
            clip_on=False,
            zorder=4,
        )
        for line, fact in enumerate(() if is_narrow else reversed(site.facts)):
            up = 4.0 + 1.2 * TYPE_PT * line
            axes.annotate(
                fact,
                (1, 0),
                xycoords="axes fraction",
                xytext=(-4, up),
                textcoords="offset points",
                ha="right",
            )
        angle_axis(axes, "x", "smaller angle")
        angle_axis(axes, "y", "larger angle")
        if is_narrow:
            axes.set_xticks([0, np.pi, turn], ["0", "π", "2π"])
            axes.set_yticks([0, np.pi, turn], ["0", "π", "2π"])

    return Panel(draw, site.long_title if is_narrow else site.title, 1.0)


def _angles(site: _Site, balls: int) -> Panel:
    """Returns the panel of the angles of all balls of each run at rest."""

    def percentages(positions: Numbers) -> tuple[Numbers, NDArray[Any]]:
        found, edges = np.histogram(positions.ravel(), bins=_ANGLE_BINS, range=(0, 2 * np.pi))
        return 100 * found / max(positions.size, 1), edges

    def draw(axes: Axes) -> None:
        axes.stairs(*percentages(site.predicted), fill=True, color=_PALE)
        axes.stairs(*percentages(site.predicted), color=_INFERRED, linewidth=0.8)
        axes.stairs(*percentages(site.measured), color=_MEASURED, linewidth=1.3, zorder=3)
        angle_axis(axes, "x", "angle of the ball" if balls == 1 else "angle of each ball")
        axes.set_ylabel("balls at rest per bin [%]")

    return Panel(draw, site.long_title, 1.0)


def _keys(balls: int) -> list[Any]:
    """Returns the entries of the legend."""
    nothing: tuple[list[float], list[float]] = ([], [])
    dot: dict[str, Any] = {"linestyle": "none", "markeredgewidth": 0.0}
    found: list[Any] = [
        Patch(facecolor=_PALE, edgecolor=_INFERRED, linewidth=0.8, label="posterior"),
        Line2D(*nothing, color=INK, linewidth=0.9, linestyle=(0, (4, 1.6)), label="prior"),
        Line2D(*nothing, color=INK, linewidth=1.1, marker="o", label="median, 95 % interval"),
    ]
    if balls == 2:
        return [
            *found,
            Line2D(*nothing, **dot, marker="D", color=_MEASURED, label="measured rest"),
            Line2D(*nothing, **dot, marker="o", markersize=3, color=_INFERRED, label="predicted rest"),
        ]
    return [
        *found,
        Line2D(*nothing, color=_MEASURED, linewidth=1.3, label="measured rests"),
        Patch(facecolor=_PALE, edgecolor=_INFERRED, linewidth=0.8, label="predicted rests"),
    ]


def _places(parameters: int, sites: int, columns: int) -> list[tuple[int, int]]:
    """Returns the places of the panels: posteriors in a lower triangle, points beside and below."""
    triangle = [(row, column) for row in range(parameters) for column in range(row + 1)]
    beside = [(row, column) for row in range(parameters) for column in range(parameters, columns)]
    below = [(parameters + row, column) for row in range(sites) for column in range(columns)]
    return [*triangle, *[*beside, *below][:sites]]


def _legend(keys: Sequence[Any], verdict: str) -> Panel:
    """Returns a panel without axes that contains the legend."""

    def draw(axes: Axes) -> None:
        axes.set_axis_off()
        axes.legend(
            handles=keys,
            loc="upper left",
            bbox_to_anchor=(-0.2, 1.05),
            title="\n".join(textwrap.wrap(verdict, 26)),
            alignment="left",
        )

    return Panel(draw, aspect=1.0, lettered=False)


def _told(parameters: Sequence[_Parameter]) -> str:
    """Returns the medians and intervals in a sentence."""
    told = [
        f"{one.name}: median and 95 % interval {one.result}"
        + ("" if one.is_identified else ", not identified")
        for one in parameters
    ]
    return words.listed(told)


def _caption(balls: int, parameters: int) -> str:
    text = "Posterior density of each parameter over its prior density, in the range of the prior."
    if parameters > 1:
        text += " Dots: samples of the posterior, with the 95 % intervals as lines."
    if balls == 2:
        return (
            f"{text} Runs at rest: the smaller and the larger of both angles from the imbalance, because balls are not "
            "told apart; the grey half remains empty. Predicted rests contain the error of the measurements."
        )
    return f"{text} Runs at rest: the angles of all balls. Predicted rests contain the error of the measurements."


def identification(
    directory: Source,
    *,
    width: Optional[Width] = None,
    points: Optional[Sequence[int]] = None,
) -> Paper:
    """Draws inferred parameters, and measured and predicted positions of rest [rad].

    Each parameter has a histogram of its posterior over the range of its prior; the ordinate is the posterior density
    over the prior density (1: the measurements say nothing). Black: the median and the 95 % interval. "not identified":
    the interval is hardly narrower than the prior's. Each pair of parameters has a panel of samples of the posterior,
    near these samples, with the 95 % intervals as lines.

    Each point of the sweep (and stage) with measured runs has a panel. Balls are not told apart: for two balls, each
    run at rest is a dot at the smaller and the larger of its two angles from 0 to 2π, so that the grey half remains
    empty. For other numbers of balls, a histogram of the angles of all balls. Predicted are runs of the posterior
    predictive distribution with the error of the measurements. p is the probability of a deviation at least as
    large if the model is true.

    ``width``: "single" (90 mm) or "double" (180 mm); ``points``: numbers of the points to show, by default at most
    twelve points and stages. Raises FiguresError if the directory was not written by `stickslip identify`.
    """
    found = _Identification(directory)
    parameters = found.parameters
    rows = found.rows(points)
    sites = found.sites(rows)
    count = len(parameters)
    is_narrow = count > (1 if width == "single" else 4)
    panels: list[Panel] = []
    for place, parameter in enumerate(parameters):
        panels += [
            _pair(other, parameter, found.correlation(place, before), is_narrow)
            for before, other in enumerate(parameters[:place])
        ]
        panels.append(_marginal(parameter, is_narrow))
    panels += [_torus(site, is_narrow) if found.balls == 2 else _angles(site, found.balls) for site in sites]
    columns = count + (0 if width == "single" else {1: 2, 2: min(2, -(-len(sites) // 2))}.get(count, 0))
    places = _places(count, len(sites), columns)
    keys, verdict = _keys(found.balls), found.verdict
    if count > 1:
        # The legend has its place in the empty half of the triangle.
        panels.append(_legend(keys, verdict))
        places.append((0, 1))
    else:
        panels[0].keys = keys
    return lay_out(
        panels,
        title="Inferred parameters",
        caption=_caption(found.balls, count) + found.fit.left_out(rows),
        alternative=" ".join([_told(parameters), words.listed([site.told for site in sites]), verdict]),
        width=width or "double",
        places=places,
        legend_title="\n".join(textwrap.wrap(verdict, 46 if width == "single" else 100))
        if count == 1
        else "",
    )
