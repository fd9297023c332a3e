"""Draws the figures of the report with matplotlib.

The compiled part of the package makes a figure from tables: panels with axes and marks, as JSON. The page of
`stickslip report` draws the same JSON. Long columns in it are packed, see `column`.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from os import PathLike
from typing import Any, Optional, Union

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from .errors import FiguresError
from .paper import DASHES, FAINT, INK, LABELS, SCALE, SERIES, Paper, Width
from .panels import Panel, angle_axis, lay_out, named_axis, own_legend, own_rows
from .sweep import listed
from .words import axis as axis_label

__all__ = ["draw", "names", "read_figures"]

Numbers = NDArray[np.float64]
#: Results in Python, such as those of ``study.run()`` and ``study.optimize()``, or their directory.
Source = Union[str, PathLike[str], Any]
_Specification = Mapping[str, Any]

#: Largest number of dots of a panel that are drawn as vectors; more are rasterized to limit the file size.
_MOST_VECTOR_DOTS = 2_000
#: The number of dots above which they are drawn smaller.
_MANY_DOTS = 300
#: The mark of each symbol and its size in points.
_SYMBOLS: Mapping[str, tuple[str, float]] = {
    "dot": ("o", 1.8),
    "disc": ("o", 3.5),
    "circle": ("o", 4.0),
    "star": ("*", 6.0),
    "cross": ("x", 4.5),
    "diamond": ("D", 3.2),
    "triangle": ("^", 3.8),
    "square": ("s", 3.2),
}


def read_figures(source: Source, points: Optional[Iterable[int]] = None) -> list[_Specification]:
    """Returns the figures of results in Python, or of a directory of results or of a search."""
    chosen = None if points is None else listed(points)
    if isinstance(source, (str, PathLike)):
        found = import_module("stickslip._stickslip")._figures(source, chosen)
    elif hasattr(source, "_figures"):
        found = source._figures(chosen)
    else:
        raise TypeError(
            f"source: wrong type\n  found:   a value of type {type(source).__name__}\n"
            "  allowed: a directory of results, or results such as those of study.run()"
        )
    figures: list[_Specification] = json.loads(found)
    return figures


def names(source: Source) -> list[str]:
    """Returns the names of the figures that results have, in reading order.

    ``source``: a directory of `stickslip run` or `stickslip optimize`, or results such as those of ``study.run()``.
    """
    return [figure["id"] for figure in read_figures(source)]


def draw(
    source: Source,
    figure: str,
    *,
    width: Optional[Width] = None,
    points: Optional[Iterable[int]] = None,
    sheet: int = 1,
) -> Paper:
    """Draws a figure of the page that `stickslip report` writes, for print.

    ``source``: a directory of `stickslip run` or `stickslip optimize`, or results such as those of ``study.run()``;
    ``figure``: its name, such as "time-to-rest", see `names`; ``width``: "single" (90 mm) or "double" (180 mm);
    ``points``: numbers of the points of the sweep to show, by default at most 24 in detail; ``sheet``: which sheet of
    twelve panels, from 1. Axes have the units of the study. The caption says what the figure shows and omits.

    Raises FiguresError if the results have no such figure, and StudyError if there are no such results or points.
    """
    all_figures = read_figures(source, points)
    name = figure.replace("_", "-")
    for one in all_figures:
        if one["id"] == name:
            return draw_figure(one, width=width, sheet=sheet)
    where = source if isinstance(source, (str, PathLike)) else getattr(source, "directory", None) or "results in memory"
    known = ", ".join(one["id"] for one in all_figures)
    raise FiguresError(where, "", f"there is no figure {figure!r} of these results", f"they have {known}")


def draw_figure(figure: _Specification, *, width: Optional[Width] = None, sheet: int = 1) -> Paper:
    """Draws a sheet of a figure."""
    shared = _legend_is_shared(figure["panels"])
    return lay_out(
        [_panel(panel, shared) for panel in figure["panels"]],
        title=figure["title"],
        caption=figure["caption"],
        alternative=figure["alternative"],
        width=width,
        sheet=sheet,
    )


def column(packed: Any) -> Numbers:
    """Returns a column of numbers: a list, or an object with one base64 string of little-endian values.

    ``f``: 32-bit floats; ``u``: 32-bit whole numbers; ``w`` and ``b``: 16-bit and 8-bit steps between ``from`` and
    ``to``, the largest one for a missing value.
    """
    if isinstance(packed, list):
        return np.array(packed, dtype=np.float64)
    kind = next(key for key in ("f", "u", "w", "b") if key in packed)
    types = {"f": "<f4", "u": "<u4", "w": "<u2", "b": "u1"}
    values = np.frombuffer(base64.b64decode(packed[kind]), dtype=types[kind]).astype(np.float64)
    if kind in "fu":
        return values
    last = {"w": 65534.0, "b": 254.0}[kind]
    scaled = packed["from"] + values / last * (packed["to"] - packed["from"])
    return np.where(values > last, np.nan, scaled)


def _pairs(packed: Any) -> Numbers:
    return column(packed).reshape(-1, 2)


def _colour(colour: Any) -> str:
    if isinstance(colour, Mapping):
        return SERIES[colour["series"] % len(SERIES)]
    return {"ink": INK, "faint": FAINT}.get(colour) or LABELS[colour][0]


def _dashes(layer: _Specification) -> Any:
    """Returns the dashes of a line, which distinguish series in black and white."""
    colour = layer["colour"]
    if layer.get("dashed"):
        return DASHES[1]
    return DASHES[colour["series"] % len(DASHES)] if isinstance(colour, Mapping) else DASHES[0]


def _look(layer: _Specification) -> str:
    """Returns what distinguishes the marks of a layer from those of another one."""
    return json.dumps([layer["colour"], layer.get("symbol"), layer.get("dashed")])


def _legend_is_shared(panels: Sequence[_Specification]) -> bool:
    """Whether equal marks have the same name in all panels, so that one legend explains all."""
    named: dict[str, str] = {}
    layers = (layer for panel in panels for layer in panel["layers"] if layer["name"])
    return all(named.setdefault(_look(layer) + layer["mark"], layer["name"]) == layer["name"] for layer in layers)


def _keys(panel: _Specification) -> list[Any]:
    """Returns a legend entry for each name, with the marks of all its layers."""
    found: dict[str, list[_Specification]] = {}
    for layer in panel["layers"]:
        if layer["name"] and not (layer["mark"] == "dots" and not column(layer["x"]).size):
            found.setdefault(layer["name"], []).append(layer)
    keys: list[Any] = []
    for name, layers in found.items():
        marks = {layer["mark"]: layer for layer in layers}
        line = marks.get("line") or marks.get("steps")
        dots = marks.get("dots")
        area = marks.get("bars") or marks.get("band")
        if line is None and dots is None and area is not None:
            keys.append(Patch(color=_colour(area["colour"]), alpha=0.2 if area["mark"] == "band" else 1.0, label=name))
            continue
        key = Line2D([], [], color=_colour(layers[0]["colour"]), linestyle="none", label=name)
        if line is not None:
            key.set_linestyle(_dashes(line))
        if dots is not None:
            key.set(**_mark(dots), color=_colour(dots["colour"]))
            key.set_markersize(max(key.get_markersize(), 3.0))
        keys.append(key)
    return keys


def _mark(layer: _Specification) -> dict[str, Any]:
    """Returns the properties of the dots of a layer."""
    mark, size = _SYMBOLS[layer["symbol"]]
    # Many dots show a density.
    size = 0.7 * size if column(layer["x"]).size > _MANY_DOTS else size
    open_mark = {"markerfacecolor": "none", "markeredgewidth": 0.9}
    own = open_mark if layer["symbol"] == "circle" else {"markeredgewidth": 0.9 if mark == "x" else 0.0}
    return {"marker": mark, "markersize": size, **own}


def _panel(panel: _Specification, shared: bool) -> Panel:
    x, y = panel["x"], panel["y"]
    same_ends = bool(x["unit"]) and x["unit"] == y["unit"] and x["range"] is not None and x["range"] == y["range"]
    square = same_ends or x["kind"] == y["kind"] == "angle"
    keys = _keys(panel)

    def draw_on(axes: Axes) -> Optional[ScalarMappable]:
        mappable = _layers(axes, panel)
        for which, axis in (("x", x), ("y", y)):
            _scale_axis(axes, which, axis)
        if keys and not shared:
            own_legend(axes, keys)
        return mappable

    scale = panel["scale"]["name"] if panel["scale"] else ""
    heading = " – ".join(part for part in (panel["title"], panel["part"]) if part)
    # The title names the quantity already.
    scale = "" if scale == panel["part"] else scale
    above = 10.0 * own_rows(keys) if keys and not shared else 0.0
    return Panel(draw_on, heading, 1.0 if square else 0.7, above, scale=scale, keys=keys if shared else ())


def _scale_axis(axes: Axes, which: str, axis: _Specification) -> None:
    """Sets the kind, the ends and the label of an axis."""
    if axis["kind"] == "angle":
        angle_axis(axes, which, axis["name"])
        return
    label = axis_label(axis["name"], axis["unit"])
    if axis["kind"] == "names" and which == "x":
        named_axis(axes, axis["names"], label)
        return
    ends = {} if axis["range"] is None else dict(zip(("left", "right") if which == "x" else ("bottom", "top"), axis["range"]))
    scale = "log" if axis["kind"] == "logarithmic" else "linear"
    if which == "x":
        axes.set_xscale(scale)
        axes.set_xlim(**ends)
        axes.set_xlabel(label)
    else:
        axes.set_yscale(scale)
        axes.set_ylim(**ends)
        axes.set_ylabel(label)
    if axis["kind"] == "names":
        axes.set_yticks(range(len(axis["names"])), axis["names"])


def _layers(axes: Axes, panel: _Specification) -> Optional[ScalarMappable]:
    """Draws the layers from bottom to top, and returns the mappable of the colour scale if there is one."""
    # An axis that follows from the marks must know its scale before bars and bands are drawn.
    axes.set_xscale("log" if panel["x"]["kind"] == "logarithmic" else "linear")
    axes.set_yscale("log" if panel["y"]["kind"] == "logarithmic" else "linear")
    dots = sum(column(layer["x"]).size for layer in panel["layers"] if layer["mark"] == "dots")
    mappable = None
    for order, layer in enumerate(panel["layers"]):
        drawn = _layer(axes, panel, layer, 2 + order / 100, dots > _MOST_VECTOR_DOTS)
        mappable = drawn or mappable
    return mappable


def _layer(
    axes: Axes, panel: _Specification, layer: _Specification, zorder: float, rasterized: bool
) -> Optional[ScalarMappable]:
    mark = layer["mark"]
    if mark in ("raster", "cells"):
        return _cells(axes, panel, layer)
    colour = _colour(layer["colour"])
    if mark in ("line", "steps"):
        x, y = _pairs(layer["points"]).T
        style = "steps-post" if mark == "steps" else "default"
        axes.plot(x, y, color=colour, linestyle=_dashes(layer), drawstyle=style, zorder=zorder)
    elif mark == "band":
        x, low, high = (column(layer[key]) for key in ("x", "low", "high"))
        step: Any = "post" if layer["steps"] else None
        axes.fill_between(x, low, high, step=step, color=colour, alpha=0.2, linewidth=0, zorder=zorder)
    elif mark == "intervals":
        x, low, high = (column(layer[key]) for key in ("x", "low", "high"))
        known = np.isfinite(low) & np.isfinite(high)
        middle, half = (low + high)[known] / 2, np.maximum(high - low, 0)[known] / 2
        axes.errorbar(
            x[known], middle, half, color=colour, linestyle="none", capsize=2, elinewidth=0.9, capthick=0.9, zorder=zorder
        )
    elif mark == "bars":
        axes.bar(column(layer["x"]), column(layer["y"]), layer["width"], color=colour, zorder=zorder)
        axes.axhline(0.0, color=INK, linewidth=0.6)
    elif mark == "dots":
        x, y = column(layer["x"]), column(layer["y"])
        if not x.size:
            return None
        # A mark on the edge of the axes is drawn in full.
        axes.plot(
            x, y, linestyle="none", color=colour, rasterized=rasterized, clip_on=rasterized, zorder=zorder, **_mark(layer)
        )
    elif mark == "rule":
        _rule(axes, layer, colour)
    return None


def _cells(axes: Axes, panel: _Specification, layer: _Specification) -> ScalarMappable:
    """Draws values as coloured rectangles; a value that is missing leaves its place white."""
    values = column(layer["values"])
    scale = Normalize(*panel["scale"]["range"])
    if layer["mark"] == "raster":
        across, up = layer["size"]
        return axes.imshow(
            np.ma.masked_invalid(values.reshape(up, across)),
            cmap=SCALE,
            norm=scale,
            origin="lower",
            extent=(*panel["x"]["range"], *panel["y"]["range"]),
            aspect="auto",
            interpolation="none",
            zorder=0,
        )
    known = np.isfinite(values)
    left, right, low, high = column(layer["edges"]).reshape(-1, 4)[known].T
    corners = np.stack([np.c_[left, low], np.c_[right, low], np.c_[right, high], np.c_[left, high]], axis=1)
    cells = PolyCollection(list(corners), array=values[known], cmap=SCALE, norm=scale, edgecolors="face", linewidths=0.1)
    axes.add_collection(cells)
    return cells


def _rule(axes: Axes, layer: _Specification, colour: str) -> None:
    """Draws a line across the axes, with its label at its end."""
    line: dict[str, Any] = {"color": colour, "linewidth": 0.8, "linestyle": (0, (4, 2)), "zorder": 2}
    if layer["upright"]:
        axes.axvline(layer["at"], **line)
        place, across, beside = (layer["at"], 1.0), ("data", "axes fraction"), (-2, -2)
    else:
        axes.axhline(layer["at"], **line)
        place, across, beside = (1.0, layer["at"]), ("axes fraction", "data"), (-2, 2)
    axes.annotate(
        layer["label"],
        place,
        xycoords=across,
        xytext=beside,
        textcoords="offset points",
        ha="right",
        va="top" if layer["upright"] else "bottom",
        rotation=90 if layer["upright"] else 0,
    )
