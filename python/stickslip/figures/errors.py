"""The errors of figures, and where tables come from, which is the remedy for a missing one."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Union

__all__ = ["CALLS", "COMMANDS", "FiguresError", "NothingToShowError"]

#: The command that writes each table.
COMMANDS: Mapping[str, str] = {
    "equilibrium_positions": "stickslip equilibria STUDY --out DIR (without --no-set)",
    "equilibrium_set_summary": "stickslip equilibria STUDY --out DIR",
    "frictionless_equilibria": "stickslip equilibria STUDY --out DIR",
    "trajectory": "stickslip replay RESULTS RUN_ID --out DIR",
    "touches": "stickslip replay RESULTS RUN_ID --out DIR",
    "posterior": "stickslip identify STUDY --measured FILE --out DIR",
    "fit": "stickslip identify STUDY --measured FILE --out DIR",
    "positions": "stickslip identify STUDY --measured FILE --out DIR",
    "identification": "stickslip identify STUDY --measured FILE --out DIR",
}

#: The call in Python whose results have each table.
CALLS: Mapping[str, str] = {
    "equilibrium_positions": "`stickslip.equilibrium_set(positions=True)`",
    "equilibrium_set_summary": "`stickslip.equilibrium_set()`",
    "frictionless_equilibria": "`stickslip.equilibrium_set()`",
    "trajectory": "`stickslip.simulate()` or `results.replay()`",
    "touches": "a simulation with `contact`",
    **dict.fromkeys(("posterior", "fit", "positions", "identification"), "`study.identify(measured)`"),
}


class FiguresError(ValueError):
    """The error of a figure that cannot be drawn, with the directory, the file, the problem and the remedy."""

    #: Whether the tables are valid but contain nothing that the figure shows.
    cannot_show: bool = False

    def __init__(self, directory: Union[str, PathLike[str]], file: str, problem: str, remedy: str) -> None:
        self.directory = Path(directory)
        self.file = file
        self.problem = problem
        self.remedy = remedy
        super().__init__(f"{self.directory / file}: {problem}; {remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.directory, self.file, self.problem, self.remedy)


class NothingToShowError(FiguresError):
    """The error of a figure whose tables are valid but contain nothing to show."""

    cannot_show = True
