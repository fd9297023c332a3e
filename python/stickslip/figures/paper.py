"""The style of figures, with widths, type, colours and marks, and reproducible files."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import IO, Any, Literal, Union
from xml.sax.saxutils import escape

import matplotlib as mpl
from cycler import cycler
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

__all__ = ["Paper", "Width", "WIDTHS_MM", "FORMATS", "style"]

Width = Literal["single", "double"]

#: Widths of a journal's column and of its page, mm.
WIDTHS_MM: Mapping[Width, float] = {"single": 90.0, "double": 180.0}
#: File formats of figures.
FORMATS = ("svg", "pdf", "png")
#: The size of all type, points.
TYPE_PT = 8.0

#: Colours of series: Okabe and Ito's, which colour-blind readers can distinguish, and two more.
SERIES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#464646", "#785e1e")
INK, FAINT = "black", "#828282"
#: Dashes and marks of series, which distinguish them in black and white.
DASHES: tuple[Any, ...] = ("-", (0, (5, 1.8)), (0, (1.2, 1.6)), (0, (6, 1.6, 1.2, 1.6)), (0, (9, 2, 2.5, 2)))
MARKS = ("o", "^", "s", "D", "v", "P", "X", "*")

#: Colour, mark and dashes of each label.
LABELS: Mapping[str, tuple[str, str, Any]] = {
    "equilibrium": (SERIES[0], "o", DASHES[0]),
    "limit_cycle": (SERIES[1], "^", DASHES[1]),
    "periodic": (SERIES[5], "P", DASHES[3]),
    "creep": (SERIES[4], "*", DASHES[2]),
    "quasi_periodic": (SERIES[2], "v", DASHES[1]),
    "irregular": (SERIES[3], "s", DASHES[2]),
    "undecided": ("#969696", "D", DASHES[3]),
    "failed": ("black", "x", DASHES[4]),
}


def _scale() -> LinearSegmentedColormap:
    """Returns viridis from yellow to blue, lightened so that black dots remain visible."""
    viridis = mpl.colormaps["viridis"]
    pale = [tuple(0.65 * part + 0.35 for part in viridis(1.0 - 0.1 * step)[:3]) for step in range(7)]
    return LinearSegmentedColormap.from_list("stickslip", pale)


#: The colours of amplitudes and fractions, from pale to dark.
SCALE = _scale()

_STYLE: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": TYPE_PT,
    "axes.titlesize": TYPE_PT,
    "axes.labelsize": TYPE_PT,
    "xtick.labelsize": TYPE_PT,
    "ytick.labelsize": TYPE_PT,
    "legend.fontsize": TYPE_PT,
    "legend.title_fontsize": TYPE_PT,
    "figure.titlesize": TYPE_PT,
    "axes.titlelocation": "left",
    "axes.titlepad": 4.0,
    "axes.linewidth": 0.6,
    "axes.formatter.limits": (-3, 4),
    "axes.formatter.useoffset": False,
    "axes.prop_cycle": cycler(color=list(SERIES)),
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.5,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "legend.borderaxespad": 0.0,
    "figure.dpi": 150.0,
    "savefig.dpi": 300.0,
    # SVG contains text as text, and files do not depend on the time or on random numbers.
    "svg.fonttype": "none",
    "svg.hashsalt": "stickslip",
    "pdf.fonttype": 42,
}


#: Coordinates in an SVG file, and their digits after the second, which are invisible.
_DRAWN = re.compile(r' d="[^"]*"|<use [^>]*>')
_LONG = re.compile(r"(\d\.\d\d)\d+")


@contextmanager
def style() -> Iterator[None]:
    """Applies the style of papers in place of the user's matplotlib settings."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_STYLE)
        yield


class Paper(Figure):
    """A matplotlib figure for a paper: it draws and saves itself in the style of this package.

    ``title`` names the figure, ``caption`` explains it and states omissions, and ``alternative`` is a text for readers
    who cannot see it. Files contain these texts as metadata. ``sheets`` is the number of figures over which the
    panels are distributed (keyword ``sheet``).
    """

    title: str = ""
    caption: str = ""
    alternative: str = ""
    sheets: int = 1

    def draw(self, renderer: Any) -> None:
        """Draws the figure in the style of this package."""
        with style():
            super().draw(renderer)

    def savefig(
        self, fname: Union[str, PathLike[str], IO[Any]], *, transparent: Any = None, **options: Any
    ) -> None:
        """Writes the figure; identical figures and versions of matplotlib give identical bytes."""
        kind = options.pop("format", None)
        if kind is None:
            kind = Path(fname).suffix[1:] if isinstance(fname, (str, PathLike)) else "png"
        options.setdefault("metadata", self._metadata(kind))
        written = io.BytesIO()
        with style():
            super().savefig(written, transparent=transparent, format=kind or "png", **options)
        content = self._described(written.getvalue()) if kind == "svg" else written.getvalue()
        if isinstance(fname, (str, PathLike)):
            Path(fname).write_bytes(content)
        else:
            fname.write(content)

    def _repr_svg_(self) -> str:
        """Returns the figure as SVG for notebooks."""
        written = io.BytesIO()
        self.savefig(written, format="svg")
        return written.getvalue().decode()

    def _metadata(self, kind: str) -> dict[str, Any]:
        words = " ".join(part for part in (self.alternative, self.caption) if part)
        if kind == "svg":
            return {"Date": None, "Title": self.title}
        if kind == "pdf":
            return {"CreationDate": None, "ModDate": None, "Title": self.title, "Subject": words}
        return {"Title": self.title, "Description": words} if kind == "png" else {}

    def _described(self, svg: bytes) -> bytes:
        """Adds a title and a description for screen readers."""
        words = escape(" ".join(part for part in (self.alternative, self.caption) if part))
        text = _DRAWN.sub(lambda drawn: _LONG.sub(r"\1", drawn[0]), svg.decode())
        text = text.replace("<svg ", '<svg role="img" aria-labelledby="title description" ', 1)
        named = f'<title id="title">{escape(self.title)}</title>\n <desc id="description">{words}</desc>'
        text, found = re.subn(r"<title>.*?</title>", lambda _: named, text, count=1, flags=re.DOTALL)
        if not found:
            text = re.sub(r"(<svg [^>]*>)", lambda match: f"{match[1]}\n {named}", text, count=1)
        return text.encode()
