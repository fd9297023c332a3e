"""The command `stickslip-figures`, which draws the figures of a directory of results."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any, Callable, Optional

from . import equilibrium_set, equilibrium_surface, frictionless_branches, identification, motion
from .drawn import draw_figure, read_figures
from .paper import FORMATS, WIDTHS_MM, Paper
from .tables import Directory, FiguresError

__all__ = ["FIGURES", "main"]

Drawing = Callable[..., Paper]

#: The figures of tables by name, each with the table that it requires. All other directories have the figures of the report.
FIGURES: dict[str, tuple[Drawing, str]] = {
    "equilibrium-set": (equilibrium_set, "equilibrium_positions"),
    "equilibrium-surface": (equilibrium_surface, "equilibrium_positions"),
    "frictionless-branches": (frictionless_branches, "frictionless_equilibria"),
    "motion": (motion, "trajectory"),
    "identification": (identification, "posterior"),
}

_DESCRIPTION = "Draws figures for papers from a directory of results, and prints their paths."
_EPILOG = """\
Examples:
  stickslip-figures results/night                      writes results/night-figures/*.svg
  stickslip-figures results/night --format pdf --only time-to-rest exceedance
  stickslip-figures results/night --points 0 3 --width double --out paper/figures

DIR is a directory written by `stickslip run`, `optimize`, `equilibria`, `replay` or `identify`. Of results and of a
search, the figures are those of `stickslip report DIR`. Figures that the results cannot show are omitted; with --only, an
error states the reason. Identical results and versions of matplotlib give identical bytes. Exit codes: 0 success; 1 the
results cannot be read; 2 wrong usage.
"""


def _dpi(text: str) -> int:
    """Parses a number of dots per inch."""
    dpi = int(text) if text.isascii() and text.isdigit() else 0
    if not 50 <= dpi <= 2400:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 50 to 2400")
    return dpi


def _number(text: str) -> int:
    """Parses the number of a point."""
    if not text.isascii() or not text.isdigit():
        raise argparse.ArgumentTypeError(f"{text!r} is not the number of a point, such as 0")
    return int(text)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="stickslip-figures",
        description=_DESCRIPTION,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("directory", metavar="DIR", help="directory of results")
    parser.add_argument("--out", metavar="DIR", help="directory for the figures [default: DIR-figures]")
    parser.add_argument("--format", choices=FORMATS, default="svg", help="[default: svg]")
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", help="figures to draw, by the names of their files without a number"
    )
    parser.add_argument(
        "--points", nargs="+", type=_number, metavar="N", help="points of the sweep to show [default: at most 24]"
    )
    parser.add_argument(
        "--width",
        choices=list(WIDTHS_MM),
        help="90 mm or 180 mm [default: double for several panels]",
    )
    parser.add_argument(
        "--dpi",
        type=_dpi,
        default=300,
        help="dots per inch of PNG, and of dense dots in SVG and PDF [default: 300]",
    )
    return parser


def _sheets(name: str, draw: Drawing) -> list[tuple[str, Paper]]:
    """Draws all sheets of a figure and returns them with their file names."""
    first = draw()
    if first.sheets == 1:
        return [(name, first)]
    others = [draw(sheet=sheet) for sheet in range(2, first.sheets + 1)]
    return [(f"{name}-{number}", paper) for number, paper in enumerate([first, *others], 1)]


def _wanted(arguments: argparse.Namespace, there: Sequence[str], known: Iterable[str]) -> list[str]:
    """Returns the names of the figures to draw: those that are there, or the requested ones, which must be known."""
    for name in arguments.only or []:
        if name not in known:
            raise FiguresError(
                arguments.directory, "", f"there is no figure {name!r} of these results", f"they have {', '.join(there)}"
            )
    return list(arguments.only or there)


def _drawn(arguments: argparse.Namespace) -> list[tuple[str, Paper]]:
    """Draws the requested figures, or all that the results can show."""
    directory = Directory(arguments.directory)
    own = [name for name, (_, table) in FIGURES.items() if directory.has(table)]
    drawn: list[tuple[str, Paper]] = []
    if not own:
        figures = {one["id"]: one for one in read_figures(directory.path, arguments.points)}
        for name in _wanted(arguments, list(figures), figures):
            drawn += _sheets(name, partial(draw_figure, figures[name], width=arguments.width))
        return drawn
    why_not: list[FiguresError] = []
    for name in _wanted(arguments, own, FIGURES):
        draw, _ = FIGURES[name]
        has_points = arguments.points is not None and "points" in signature(draw).parameters
        options: dict[str, Any] = {"points": arguments.points} if has_points else {}
        try:
            drawn += _sheets(name, partial(draw, directory.path, width=arguments.width, **options))
        except FiguresError as error:
            if arguments.only or not error.cannot_show:
                raise
            why_not.append(error)
    if not drawn:
        raise why_not[0]
    return drawn


def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Runs the command and returns its exit code."""
    parsed = _parser().parse_args(arguments)
    directory = Path(parsed.directory)
    out = (
        Path(parsed.out)
        if parsed.out
        else directory.resolve().with_name(f"{directory.resolve().name}-figures")
    )
    try:
        drawn = _drawn(parsed)
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    try:
        out.mkdir(parents=True, exist_ok=True)
        for name, paper in drawn:
            file = out / f"{name}.{parsed.format}"
            paper.savefig(file, dpi=parsed.dpi)
            print(file)
    except OSError as error:
        print(
            f"error: {out}: {error.strerror or error}; choose another directory with --out", file=sys.stderr
        )
        return 1
    return 0
