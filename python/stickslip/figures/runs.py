"""Reads columns of the runs of a study, or of a random subsample of very many runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from .sweep import MOST_DETAILS, Sweep, evenly
from .tables import Directory

__all__ = ["MOST_DOTS", "Sample", "balls_at", "balls_of", "points_of_one_number", "read", "scattered"]

#: Approximate largest number of runs drawn as dots.
MOST_DOTS = 100_000
#: Largest number of dots drawn as vectors; more are rasterized to limit the file size.
MOST_VECTOR_DOTS = 2_000


def scattered(run_id: NDArray[Any], one_in: int) -> NDArray[np.bool_]:
    """Returns which runs belong to a subsample of about one in ``one_in`` runs.

    The hash of a run's number decides (the finaliser of SplitMix64, G. L. Steele, D. Lea and C. H. Flood, OOPSLA
    2014, doi:10.1145/2660193.2660195). Equally spaced runs would fall repeatedly into the same strata of a
    stratified design.
    """
    with np.errstate(over="ignore"):
        mixed = run_id.astype(np.uint64) + np.uint64(0x9E37_79B9_7F4A_7C15)
        mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58_476D_1CE4_E5B9)
        mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D0_49BB_1331_11EB)
    return np.asarray((mixed ^ (mixed >> np.uint64(31))) % np.uint64(max(one_in, 1)) == 0)


@dataclass
class Sample:
    """Columns of the runs that are shown."""

    columns: dict[str, NDArray[Any]]
    #: Number of runs of the points shown.
    of: int
    #: The sample contains about one in this number of runs.
    one_in: int

    def __len__(self) -> int:
        return len(self.columns["run_id"])

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    def where(self, mask: NDArray[np.bool_]) -> Sample:
        """Returns the runs selected by a mask."""
        return Sample({name: values[mask] for name, values in self.columns.items()}, self.of, self.one_in)

    @property
    def subsample(self) -> str:
        """The sentence of the caption about a subsample; empty if the sample contains all runs."""
        if self.one_in <= 1:
            return ""
        return f" Subsample: {len(self):,} of {self.of:,} runs are shown, about one in {self.one_in}."

    @property
    def label(self) -> str:
        """The legend title of a subsample; empty if the sample contains all runs."""
        return f"subsample: {len(self):,} of {self.of:,} runs" if self.one_in > 1 else ""


def balls_of(directory: Directory) -> int:
    """Returns the number of balls, which is the largest one if the sweep sets it; 0 for the block."""
    columns = directory.table("runs").columns
    return sum(1 for name in columns if name.startswith("beta_") and name.endswith("_rad"))


def balls_at(directory: Directory, sweep: Sweep, row: int) -> int:
    """Returns the number of balls at a point; 0 for the block."""
    swept = sweep.values.get("balls")
    return balls_of(directory) if swept is None else int(swept[row])


def points_of_one_number(
    directory: Directory, sweep: Sweep, points: Optional[Sequence[int]]
) -> tuple[int, list[int]]:
    """Returns a number of balls, and the rows of the points shown, which have this number."""
    numbers = [balls_at(directory, sweep, row) for row in range(len(sweep))]
    if points is None and len(set(numbers)) > 1:
        balls = 2 if 2 in numbers else max(numbers)
        points = [int(sweep.ids[row]) for row, number in enumerate(numbers) if number == balls]
        points = [points[place] for place in evenly(len(points), MOST_DETAILS)]
    rows = sweep.details(points)
    shown = sorted({numbers[row] for row in rows})
    if len(shown) > 1:
        raise sweep.table.error(
            f"the points have {shown[0]} to {shown[-1]} balls", "choose points with one number of balls"
        )
    return (shown[0] if shown else 0), rows


def read(
    directory: Directory, sweep: Sweep, rows: Sequence[int], columns: Sequence[str], most: int = MOST_DOTS
) -> Sample:
    """Reads columns of the runs of some points, about ``most`` runs at most."""
    of = int(sum(sweep.runs[row] for row in rows))
    one_in = max(1, -(-of // max(most, 1)))
    points = np.array([sweep.ids[row] for row in rows])
    wanted = ["run_id", "point_id", *columns]
    parts: list[dict[str, NDArray[Any]]] = []
    for batch in directory.table("runs").batches(wanted):
        shown = np.isin(batch["point_id"], points) & scattered(batch["run_id"], one_in)
        parts.append({name: values[shown] for name, values in batch.items()})
    held = {name: np.concatenate([part[name] for part in parts]) if parts else np.empty(0) for name in wanted}
    return Sample(held, of, one_in)
