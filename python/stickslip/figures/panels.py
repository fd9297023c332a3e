"""Lays out panels on a sheet, with letters and a common legend."""

from __future__ import annotations

import re
import textwrap
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Callable, Optional

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator, ScalarFormatter

from . import words
from .paper import WIDTHS_MM, Paper, Width, style

__all__ = ["MOST_PANELS", "Panel", "angle_axis", "lay_out", "named_axis", "own_legend", "own_rows"]

#: Largest number of panels on one sheet.
MOST_PANELS = 12
_INCH_MM = 25.4
#: The legend of one panel has two columns if no name has more characters than this.
_SHORT_NAME = 20
_QUARTERS = ("0", "π/2", "π", "3π/2", "2π")


@dataclass
class Panel:
    """A panel: the function that draws it, its title and its shape."""

    draw: Callable[[Axes], Optional[ScalarMappable]]
    title: str = ""
    #: Height over width.
    aspect: float = 0.75
    #: Space between the axes and the title, points.
    above: float = 0.0
    #: The label of the colour bar, which is drawn if `draw` returns a mappable.
    scale: str = ""
    #: Additional legend entries without data in this panel.
    keys: Sequence[Any] = field(default_factory=tuple)
    #: Whether the axes are three-dimensional.
    in_space: bool = False
    #: Whether the title begins with a letter.
    lettered: bool = True


def angle_axis(axes: Axes, which: str, name: str) -> None:
    """Sets an axis to one turn, with ticks at its quarters."""
    quarters = [place * np.pi / 2 for place in range(5)]
    if which == "x":
        axes.set_xlim(0, 2 * np.pi)
        axes.set_xticks(quarters, _QUARTERS)
        axes.set_xlabel(f"{name} [rad]")
    else:
        axes.set_ylim(0, 2 * np.pi)
        axes.set_yticks(quarters, _QUARTERS)
        axes.set_ylabel(f"{name} [rad]")


def named_axis(axes: Axes, names: Sequence[str], label: str) -> None:
    """Sets an abscissa of names; long names are rotated."""
    axes.set_xlim(-0.5, len(names) - 0.5)
    axes.xaxis.set_major_locator(FixedLocator(list(range(len(names)))))
    axes.xaxis.set_minor_locator(NullLocator())
    turned = max((len(name) for name in names), default=0) * len(names) > 45
    axes.set_xticks(
        range(len(names)),
        list(names),
        rotation=45 if turned else 0,
        ha="right" if turned else "center",
        rotation_mode="anchor" if turned else "default",
    )
    axes.set_xlabel(label)


def own_rows(keys: Sequence[Any]) -> int:
    """Returns the number of rows of the legend of one panel."""
    return -(-len(keys) // _own_columns(keys))


def _own_columns(keys: Sequence[Any]) -> int:
    return 2 if max(len(key.get_label()) for key in keys) <= _SHORT_NAME else 1


def own_legend(axes: Axes, keys: Sequence[Any]) -> None:
    """Adds a legend above these axes, for panels whose equal marks have different names."""
    legend = axes.legend(
        handles=list(keys),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.3,
        borderpad=0.0,
        ncols=_own_columns(keys),
        handlelength=1.8,
        columnspacing=0.8,
        labelspacing=0.2,
        alignment="left",
    )
    # The legend must not move the title above it.
    legend.set_in_layout(False)


def _power(exponent: str) -> str:
    """Formats a power of ten: `10⁻⁵` for `-05`."""
    return "10" + words.superscript(int(exponent.replace("−", "-")))


def _plain(value: float) -> str:
    """Formats a positive number at a tick of a logarithmic axis: `0.01`, `2000`, `10⁴`, `2·10⁻⁵`."""
    mantissa, exponent = f"{value:e}".split("e")
    if -4 < int(exponent) < 4:
        return f"{value:g}"
    factor = f"{float(mantissa):g}"
    return ("" if factor == "1" else f"{factor}·") + _power(exponent)


class _Numbers(ScalarFormatter):
    """Formats numbers at ticks, with a common power of ten such as `×10⁻³`."""

    def get_offset(self) -> str:
        """Returns the common power of ten."""
        return re.sub(r"1e(\S+)", lambda match: f"×{_power(match[1])}", super().get_offset())


def _plain_numbers(axes: Axes) -> None:
    """Formats tick labels as plain text, not as formulas."""
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            axis.set_major_formatter(FuncFormatter(lambda value, _: _plain(value)))
            axis.set_minor_formatter(NullFormatter())
        elif type(axis.get_major_formatter()) is ScalarFormatter:
            axis.set_major_formatter(_Numbers())


def _letter(place: int) -> str:
    letters = "abcdefghijklmnopqrstuvwxyz"
    return letters[place] if place < 26 else letters[place // 26 - 1] + letters[place % 26]


def lay_out(
    panels: Sequence[Panel],
    *,
    title: str,
    caption: str,
    alternative: str,
    width: Optional[Width] = None,
    sheet: int = 1,
    columns: Optional[int] = None,
    places: Optional[Sequence[tuple[int, int]]] = None,
    legend_title: str = "",
) -> Paper:
    """Draws panels on a sheet as wide as a journal's column or page, and fits its height.

    ``places`` are the row and column of each panel; all panels are then on one sheet.
    """
    if width is not None and width not in WIDTHS_MM:
        raise ValueError(f"width={width!r}: allowed are {', '.join(map(repr, WIDTHS_MM))}")
    most_panels = MOST_PANELS if places is None else len(panels)
    sheets = -(-len(panels) // most_panels)
    if not 1 <= sheet <= sheets:
        raise ValueError(f"sheet={sheet!r}: there are {sheets}, numbered from 1")
    first = (sheet - 1) * most_panels
    shown = panels[first : first + most_panels]
    size = WIDTHS_MM[width or ("double" if len(shown) > 1 else "single")] / _INCH_MM
    if places is not None:
        columns = 1 + max(column for _, column in places)
    else:
        # Labels of two panels side by side would overlap in a column of a journal.
        most = 3 if size > 5 else 1
        columns = min(most, columns or (2 if len(shown) in (2, 4) else len(shown)), len(shown))
        places = [divmod(place, columns) for place in range(len(shown))]
    rows = 1 + max(row for row, _ in places)
    letters = iter(range(first, first + len(shown)))
    with style():
        across = size / columns
        height = rows * (across * max(panel.aspect for panel in shown) + 0.5) + 0.8
        paper = Paper(figsize=(size, height), layout="compressed")
        paper.title, paper.caption, paper.alternative = title, caption.strip(), alternative
        paper.sheets = sheets
        paper.get_layout_engine().set(w_pad=0.02, h_pad=0.02)  # type: ignore[union-attr, call-arg]
        wide = max(18, int(72 * (across - 0.35) / 4.7))
        drawn: dict[tuple[int, int], Axes] = {}
        for (row, column), panel in zip(places, shown):
            place = row * columns + column + 1
            axes = paper.add_subplot(rows, columns, place, projection="3d" if panel.in_space else None)
            if not panel.in_space:
                axes.set_box_aspect(panel.aspect)
            mappable = panel.draw(axes)
            if mappable is not None:
                beside: Any = {"shrink": 0.75, "pad": 0.16} if panel.in_space else {"pad": 0.03}
                bar = paper.colorbar(mappable, ax=axes, aspect=18, **beside)
                bar.set_label(panel.scale)
                bar.outline.set_linewidth(0.6)
            with_letter = panel.lettered and len(panels) > 1
            lettered = f"({_letter(next(letters))}) {panel.title}" if with_letter else panel.title
            if lettered.strip():
                lines = [part for line in lettered.strip().split("\n") for part in textwrap.wrap(line, wide)]
                axes.set_title("\n".join(lines), pad=4.0 + panel.above)
            drawn[row, column] = axes
        for axes in paper.axes:
            _plain_numbers(axes)
        _label_outer(drawn)
        _legend(paper, shown, list(drawn.values()), legend_title)
        _fit_height(paper)
    return paper


def _label_outer(drawn: Mapping[tuple[int, int], Axes]) -> None:
    """Removes the labels of axes that repeat those of a neighbour."""

    def of_x(axes: Axes) -> Any:
        return axes.get_xlabel(), axes.get_xlim(), axes.get_xscale()

    def of_y(axes: Axes) -> Any:
        return axes.get_ylabel(), axes.get_ylim(), axes.get_yscale()

    inner_x, inner_y = [], []
    for (row, column), axes in drawn.items():
        if axes.name == "3d":
            continue
        below, beside = drawn.get((row + 1, column)), drawn.get((row, column - 1))
        if below is not None and of_x(below) == of_x(axes):
            inner_x.append(axes)
        if beside is not None and of_y(beside) == of_y(axes):
            inner_y.append(axes)
    for axes in inner_x:
        axes.set_xlabel("")
        axes.tick_params(axis="x", which="both", labelbottom=False)
    for axes in inner_y:
        axes.set_ylabel("")
        axes.tick_params(axis="y", which="both", labelleft=False)


def _legend(paper: Paper, panels: Sequence[Panel], drawn: Sequence[Axes], title: str) -> None:
    """Adds a common legend above all panels, with one entry per name."""
    entries: dict[str, Any] = {}
    for panel, axes in zip(panels, drawn):
        for handle in panel.keys:
            entries.setdefault(handle.get_label(), handle)
        for handle, name in zip(*axes.get_legend_handles_labels()):
            entries.setdefault(name, handle)
    if not entries:
        return
    # Use as many columns as fit the width.
    for beside in range(len(entries), 0, -1):
        legend = paper.legend(
            list(entries.values()),
            list(entries),
            loc="outside upper left",
            ncols=beside,
            title=title or None,
            columnspacing=1.2,
            alignment="left",
        )
        if beside == 1 or legend.get_window_extent().width <= paper.bbox.width - 4:
            break
        legend.remove()


def _fit_height(paper: Paper) -> None:
    """Sets the height of a figure to that of its content."""
    engine = paper.get_layout_engine()
    for _ in range(3):
        _execute(engine, paper)
        width, height = paper.get_size_inches()
        used = paper.get_tightbbox().height + 0.06
        if abs(used - height) < 0.01:
            break
        paper.set_size_inches(width, used)
    _execute(engine, paper)
    paper.set_layout_engine("none")


def _execute(engine: Any, paper: Paper) -> None:
    with warnings.catch_warnings():
        if any(axes.name == "3d" for axes in paper.axes):
            # Some versions of matplotlib cannot lay out three-dimensional axes, and leave them in place.
            warnings.filterwarnings("ignore", message="constrained_layout not applied")
        engine.execute(paper)
