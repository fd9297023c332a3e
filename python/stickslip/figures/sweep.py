"""The points of a sweep, with their parameters, their names, and the selection of those shown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from . import words
from .tables import Directory, Numbers, Table

__all__ = ["LABELS", "MOST_DETAILS", "Axis", "Sweep", "evenly", "listed"]

#: The labels of runs, in the order of the tables' columns.
LABELS = ("equilibrium", "limit_cycle", "creep", "quasi_periodic", "irregular", "undecided", "failed")
#: Largest number of points that have a panel or a curve each.
MOST_DETAILS = 24


@dataclass(frozen=True)
class Axis:
    """A swept parameter with a finite number at every point."""

    column: str
    name: str
    unit: str
    values: Numbers

    @property
    def label(self) -> str:
        """The name of the axis with its unit."""
        return words.axis(self.name, self.unit)

    @property
    def distinct(self) -> Numbers:
        """The distinct values, ascending."""
        return np.unique(self.values)

    @property
    def logarithmic(self) -> bool:
        """Whether the values belong on a logarithmic axis; see `by_decades`."""
        return by_decades(self.distinct)

    @property
    def limits(self) -> tuple[float, float]:
        """A range slightly wider than the values."""
        low, high = self.distinct[0], self.distinct[-1]
        if self.logarithmic:
            factor = (high / low) ** 0.04
            return float(low / factor), float(high * factor)
        margin = 0.04 * (high - low) or 1.0
        return float(low - margin), float(high + margin)


def by_decades(values: Numbers) -> bool:
    """Whether ascending values span two decades or more and at least half are below a fifth of the largest."""
    low, high = values[0], values[-1]
    few = np.count_nonzero(values < 0.2 * high)
    return bool(low > 0 and high / low >= 100 and 2 * few >= len(values))


def evenly(count: int, most: int) -> list[int]:
    """Returns at most ``most`` of the indices below ``count``, nearly equidistant, with the first and the last."""
    if count <= most or most < 2:
        return list(range(count))
    return [place * (count - 1) // (most - 1) for place in range(most)]


class Sweep:
    """The points of a study, from a table with one row per point."""

    def __init__(self, directory: Directory, name: str = "points", first: str = "runs") -> None:
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

    @cached_property
    def runs(self) -> Numbers:
        """Number of finished runs of each point."""
        return self.numbers(["runs"])["runs"]

    @cached_property
    def failed(self) -> Numbers:
        """Number of failed runs of each point."""
        return self.numbers(["failed_runs"])["failed_runs"]

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

    def title(self, row: int, without: Iterable[str] = ()) -> str:
        """Returns the parameters of a point: `speed −216.3772 rad/s, friction coefficient 0.00275`."""
        skipped = set(without)
        parts = [
            f"{self._words(column)} {words.number(self.values[column][row])}\u00a0{self.unit(column)}".strip()
            for column in self.parameters
            if column not in skipped
        ]
        if not self.parameters:
            return f"point {self.ids[row]}" if len(self) > 1 else ""
        return ", ".join(parts)

    def named(self, row: int) -> str:
        """Returns the parameters of a point with a colon, to precede a fact about it."""
        title = self.title(row)
        return f"{title}: " if title else ""

    def short(self, row: int) -> str:
        """Returns the parameter values of a point without names: `−216.3772, 0.00275`."""
        if not self.parameters:
            return f"point {self.ids[row]}"
        return ", ".join(words.number(self.values[column][row]) for column in self.parameters)

    @property
    def short_names(self) -> str:
        """The names and units of the values in `short`: `speed [rad/s], friction coefficient`."""
        return ", ".join(words.axis(self._words(column), self.unit(column)) for column in self.parameters)

    def axes(self, least: int) -> list[Axis]:
        """Returns the swept numeric parameters with at least ``least`` values, by descending number of values."""
        found = []
        for column in self.parameters:
            values = self.values[column]
            if values.dtype.kind not in "fiu" or not np.all(np.isfinite(values.astype(float))):
                continue
            axis = Axis(column, self._words(column), self.unit(column), values.astype(float))
            if len(axis.distinct) >= least:
                found.append(axis)
        return sorted(found, key=lambda axis: -len(axis.distinct))

    def groups(self, without: Sequence[str]) -> dict[str, list[int]]:
        """Groups the rows that differ only in the given parameters; returns them by their common title."""
        groups: dict[str, list[int]] = {}
        for row in range(len(self)):
            groups.setdefault(self.title(row, without), []).append(row)
        return {"": rows for rows in groups.values()} if len(groups) == 1 else groups

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

    def failures_left_out(self, shown: Sequence[int]) -> str:
        """Returns the sentence of the caption about failed runs, which the figure omits."""
        some = [row for row in shown if self.failed[row] > 0]
        if not some:
            return ""
        if len(some) > 6:
            return f" Failed runs are left out; {len(some)} points have some."
        parts = [
            f"{self.failed[row]:.0f} of {self.runs[row]:.0f}"
            + (f" at {self.title(row)}" if self.title(row) else "")
            for row in some
        ]
        other = ", none at the other points" if len(some) < len(shown) else ""
        return f" Failed runs are left out: {'; '.join(parts)}{other}."


def listed(points: Any) -> list[int]:
    """Returns the numbers of points that a figure is asked to show."""
    if isinstance(points, str) or not isinstance(points, Iterable):
        raise TypeError(
            f"points: wrong type\n  found:   a value of type {type(points).__name__}\n"
            "  allowed: a list of numbers of points, such as [0, 3]"
        )
    return list(points)
