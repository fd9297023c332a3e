"""The points of a sweep, with their parameters, their names, and the selection of those shown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import words
from .tables import Directory, Numbers, Table

__all__ = ["MOST_DETAILS", "Sweep", "evenly", "listed"]

#: Largest number of points that have a panel or a curve each.
MOST_DETAILS = 24


def evenly(count: int, most: int) -> list[int]:
    """Returns at most ``most`` of the indices below ``count``, nearly equidistant, with the first and the last."""
    if count <= most or most < 2:
        return list(range(count))
    return [place * (count - 1) // (most - 1) for place in range(most)]


class Sweep:
    """The points of a study, from a table with one row per point."""

    def __init__(self, directory: Directory, name: str, first: str) -> None:
        self.directory = directory
        self.table: Table = directory.table(name)
        self.table.need([first])
        own = self.table.columns[: self.table.columns.index(first)]
        self.parameters = [column for column in own if column != "point_id"]
        read = self.table.read([*(["point_id"] if "point_id" in own else []), *self.parameters])
        #: The values of the swept parameters in the units in which the study shows them.
        self.values = {column: self._in_shown_unit(column, read[column]) for column in self.parameters}
        self.ids: NDArray[Any] = read.get("point_id", np.zeros(self.table.rows, dtype=np.int64)).astype(
            np.int64
        )
        if not len(self.ids):
            raise self.table.error("it has no rows", "repeat the study, because none of its runs has finished")

    def __len__(self) -> int:
        return len(self.ids)

    def numbers(self, columns: Sequence[str]) -> dict[str, Numbers]:
        """Returns columns with one number per point."""
        return {name: values.astype(float) for name, values in self.table.read(columns).items()}

    @property
    def amplitude(self) -> str:
        """The label of an axis of amplitudes: `amplitude [µm]`."""
        return words.axis("amplitude", self.table.vibration[0])

    def unit(self, column: str) -> str:
        """Returns the unit in which the study shows a swept parameter."""
        return self.table.shown(column)[0]

    def _in_shown_unit(self, column: str, values: NDArray[Any]) -> NDArray[Any]:
        si = self.table.shown(column)[1]
        return values if si == 1.0 else np.array([float(f"{value / si:.12g}") for value in values])

    def _words(self, column: str) -> str:
        return words.parameter(column, self.table.unit(column))

    def title(self, row: int) -> str:
        """Returns the parameters of a point: `speed −216.3772 rad/s, friction coefficient 0.00275`."""
        parts = [
            f"{self._words(column)} {words.number(self.values[column][row])}\u00a0{self.unit(column)}".strip()
            for column in self.parameters
        ]
        if not self.parameters:
            return f"point {self.ids[row]}" if len(self) > 1 else ""
        return ", ".join(parts)

    def named(self, row: int) -> str:
        """Returns the parameters of a point with a colon, to precede a fact about it."""
        title = self.title(row)
        return f"{title}: " if title else ""

    def details(self, points: Optional[Sequence[int]]) -> list[int]:
        """Returns the rows shown in detail: the requested points, or at most `MOST_DETAILS` equidistant ones."""
        if points is None:
            return evenly(len(self), MOST_DETAILS)
        points = listed(points)
        places = {int(point): row for row, point in enumerate(self.ids)}
        missing = [point for point in points if point not in places]
        if missing or not points:
            raise self.table.error(
                f"it has no point {missing[0]!r}" if missing else "`points` names none",
                f"points are {self.ids[0]} to {self.ids[-1]}",
            )
        return [places[point] for point in points]

    def left_out(self, shown: Sequence[int]) -> str:
        """Returns the sentence of the caption about omitted points; empty if all are shown."""
        if len(shown) == len(self):
            return ""
        return f" {len(shown)} of {len(self)} points are shown."


def listed(points: Any) -> list[int]:
    """Returns the numbers of points that a figure is asked to show."""
    if isinstance(points, str) or not isinstance(points, Iterable):
        raise TypeError(
            f"points: wrong type\n  found:   a value of type {type(points).__name__}\n"
            "  allowed: a list of numbers of points, such as [0, 3]"
        )
    return list(points)
