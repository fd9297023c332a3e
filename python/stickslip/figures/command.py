"""The command `stickslip-figures`, which draws the figures of a directory of results."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Callable, Optional

from . import (
    amplitudes,
    basins,
    diagnostics,
    ending_fractions,
    equilibrium_set,
    equilibrium_surface,
    frictionless_branches,
    identification,
    label_map,
    limit_cycle_branches,
    motion,
    preferred_equilibria,
    time_to_rest,
)
from .paper import FORMATS, WIDTHS_MM, Paper
from .tables import Directory, FiguresError

__all__ = ["FIGURES", "main"]

Drawing = Callable[..., Paper]

#: The figures by name, each with the table that it requires.
FIGURES: dict[str, tuple[Drawing, str]] = {
    "preferred-equilibria": (preferred_equilibria, "points"),
    "ending-fractions": (ending_fractions, "points"),
    "label-map": (label_map, "points"),
    "time-to-rest": (time_to_rest, "points"),
    "amplitudes": (amplitudes, "points"),
    "basins": (basins, "points"),
    "limit-cycle-branches": (limit_cycle_branches, "points"),
    "diagnostics": (diagnostics, "points"),
    "equilibrium-set": (equilibrium_set, "equilibrium_positions"),
    "equilibrium-surface": (equilibrium_surface, "equilibrium_positions"),
    "frictionless-branches": (frictionless_branches, "frictionless_equilibria"),
    "motion": (motion, "trajectory"),
    "identification": (identification, "posterior"),
}

_DESCRIPTION = "Draws figures for papers from the tables of a results directory, and prints their paths."
_EPILOG = """\
Examples:
  stickslip-figures results/night                      writes results/night-figures/*.svg
  stickslip-figures results/night --format pdf --only time-to-rest amplitudes
  stickslip-figures results/night --equilibria results/night-equilibria
  stickslip-figures results/night --width double --out paper/figures

DIR is a directory written by `stickslip run`, `stickslip equilibria`, `stickslip replay` or `stickslip identify`.
Figures that its tables cannot show are omitted; with --only, an error states the reason. Identical tables and
versions of matplotlib give identical bytes. Exit codes: 0 success; 1 a table cannot be read; 2 wrong usage.
"""


def _dpi(text: str) -> int:
    """Parses a number of dots per inch."""
    dpi = int(text) if text.isascii() and text.isdigit() else 0
    if not 50 <= dpi <= 2400:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 50 to 2400")
    return dpi


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
        "--only", nargs="+", choices=list(FIGURES), metavar="NAME", help=f"figures to draw: {', '.join(FIGURES)}"
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
    parser.add_argument(
        "--equilibria",
        metavar="DIR",
        help="directory of `stickslip equilibria` for the same study, the background of preferred-equilibria",
    )
    return parser


def _sheets(draw: Drawing, name: str, directory: Path, options: dict[str, Any]) -> list[tuple[str, Paper]]:
    """Draws all sheets of a figure and returns them with their file names."""
    first = draw(directory, **options)
    if first.sheets == 1:
        return [(name, first)]
    others = [draw(directory, **options, sheet=sheet) for sheet in range(2, first.sheets + 1)]
    return [(f"{name}-{number}", paper) for number, paper in enumerate([first, *others], 1)]


def _drawn(arguments: argparse.Namespace) -> list[tuple[str, Paper]]:
    """Draws the requested figures, or all that the tables can show."""
    directory = Directory(arguments.directory)
    tables = {table for _, table in FIGURES.values()}
    if not any(directory.has(table) for table in tables):
        raise FiguresError(
            directory.path,
            "",
            "there is nothing to draw here: no points.parquet, equilibrium_positions.parquet, "
            "frictionless_equilibria.parquet, trajectory.parquet or posterior.parquet",
            "give a directory written by `stickslip run`, `equilibria`, `replay` or `identify`",
        )
    drawn: list[tuple[str, Paper]] = []
    why_not: list[FiguresError] = []
    for name in arguments.only or FIGURES:
        draw, table = FIGURES[name]
        if not arguments.only and not directory.has(table):
            continue
        options: dict[str, Any] = {"width": arguments.width}
        if arguments.equilibria is not None and name == "preferred-equilibria":
            options["equilibria"] = arguments.equilibria
        try:
            drawn += _sheets(draw, name, directory.path, options)
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
        out.mkdir(parents=True, exist_ok=True)
        for name, paper in drawn:
            file = out / f"{name}.{parsed.format}"
            paper.savefig(file, dpi=parsed.dpi)
            print(file)
    except FiguresError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except OSError as error:
        print(
            f"error: {out}: {error.strerror or error}; choose another directory with --out", file=sys.stderr
        )
        return 1
    return 0
