"""Reads and verifies the tables of a results directory."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from os import PathLike
from pathlib import Path
from typing import Any, Optional, Protocol, Union

import numpy as np
import pyarrow as pa  # type: ignore[import-untyped]
import pyarrow.parquet as pq  # type: ignore[import-untyped]
from numpy.typing import NDArray

from .errors import CALLS, COMMANDS, FiguresError, NothingToShowError

__all__ = ["Directory", "FiguresError", "Results", "Source", "Table"]


class Results(Protocol):
    """Results of `stickslip` in Python, such as those of ``study.run()``."""

    def _source(self) -> Any:
        """Returns the tables by name, or the directory that contains them."""


Source = Union[str, PathLike[str], Results]
Numbers = NDArray[np.float64]

#: The largest number of rows that are read at once.
_BATCH = 65_536


class Directory:
    """A directory written by `stickslip run`, `equilibria`, `replay` or `identify`, or the same tables in memory."""

    def __init__(self, source: Source) -> None:
        if not isinstance(source, (str, PathLike)) and not hasattr(source, "_source"):
            raise TypeError(
                f"directory: wrong type\n  found:   a value of type {type(source).__name__}\n"
                "  allowed: a directory of results, or results such as those of study.run()"
            )
        found = source if isinstance(source, (str, PathLike)) else source._source()
        self._memory: Mapping[str, Any] = found if isinstance(found, Mapping) else {}
        if self._memory:
            self.path = Path("results in memory")
            return
        path = self.path = Path(found)
        if not self.path.is_dir():
            problem = "there is no such directory" if not self.path.exists() else "it is not a directory"
            raise FiguresError(path, "", problem, "give a directory written by `stickslip run`")

    def has(self, name: str) -> bool:
        """Returns whether the directory contains a table."""
        return name in self._memory or (self.path / f"{name}.parquet").exists()

    @cached_property
    def _listed(self) -> Optional[dict[str, Any]]:
        """The listed files with their hashes, or None if the directory has no list."""
        for name in ("manifest.json", "files.json"):
            file = self.path / name
            if file.exists():
                try:
                    return dict(json.loads(file.read_text(encoding="utf-8")).get("files", {}))
                except (OSError, ValueError, AttributeError, TypeError) as error:
                    raise FiguresError(
                        self.path, name, f"it cannot be read ({error})", "write the directory anew"
                    ) from error
        return None

    def table(self, name: str) -> Table:
        """Opens a table, which is a file or a directory of parts, and verifies its hashes."""
        path = self.path / f"{name}.parquet"
        if name in self._memory:
            return Table(self.path, path.name, [_InMemory(pa.table(self._memory[name]))])
        if self._memory:
            raise FiguresError(
                self.path, path.name, "these results have no such table", f"{CALLS[name]} has it"
            )
        if not path.exists():
            raise FiguresError(
                self.path, path.name, "the table is not there", f"`{COMMANDS[name]}` writes it"
            )
        files = sorted(path.glob("part-*.parquet")) if path.is_dir() else [path]
        if not files:
            raise FiguresError(
                self.path, path.name, "the directory has no parts", f"`{COMMANDS[name]}` writes them"
            )
        for file in files:
            self._verify(file, name)
        try:
            return Table(self.path, path.name, [_InFile(pq.ParquetFile(file)) for file in files])
        except (OSError, pa.ArrowException) as error:
            raise self.error(path.name, f"it cannot be read ({error})", "write the directory anew") from error

    def object(self, name: str) -> dict[str, Any]:
        """Reads a JSON file with an object, and verifies its hash."""
        path = self.path / f"{name}.json"
        if not path.exists():
            raise self.error(path.name, "the file is not there", f"`{COMMANDS[name]}` writes it")
        self._verify(path, name)
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise self.error(path.name, f"it cannot be read ({error})", "write the directory anew") from error
        if not isinstance(found, dict):
            raise self.error(path.name, "it is no object", "write the directory anew")
        return found

    def error(self, file: str, problem: str, remedy: str) -> FiguresError:
        """Returns an error about a file of this directory."""
        return FiguresError(self.path, file, problem, remedy)

    def _verify(self, file: Path, name: str) -> None:
        """Raises FiguresError if a file is not listed, or has changed."""
        listed = self._listed
        if listed is None:
            return
        key = file.relative_to(self.path).as_posix()
        again = f"finish or repeat `{COMMANDS[name]}`"
        if key not in listed:
            raise self.error(key, "it is not on the directory's list of files", again)
        if listed[key].get("sha256") not in (None, _sha256(file, file.stat().st_mtime_ns)):
            raise self.error(key, "it is not the file that was written", again)


@lru_cache(maxsize=256)
def _sha256(file: Path, changed_ns: int) -> str:
    """Returns the hash of a file; the modification time invalidates the cache."""
    del changed_ns
    found = hashlib.sha256()
    with file.open("rb") as content:
        while block := content.read(1 << 20):
            found.update(block)
    return found.hexdigest()


class _Part(Protocol):
    """A part of a table: its columns, its rows, and what it says of itself."""

    schema: Any
    rows: int
    about: Mapping[bytes, bytes]

    def batches(self, columns: list[str]) -> Iterator[Any]:
        """Yields record batches of some columns."""


class _InFile:
    """A part of a table in a Parquet file."""

    def __init__(self, file: Any) -> None:
        self._file = file
        self.schema = file.schema_arrow
        self.rows = int(file.metadata.num_rows)
        self.about: Mapping[bytes, bytes] = file.metadata.metadata or {}

    def batches(self, columns: list[str]) -> Iterator[Any]:
        yield from self._file.iter_batches(columns=columns, batch_size=_BATCH)


class _InMemory:
    """A table in memory."""

    def __init__(self, table: Any) -> None:
        self._table = table
        self.schema = table.schema
        self.rows = int(table.num_rows)
        self.about: Mapping[bytes, bytes] = table.schema.metadata or {}

    def batches(self, columns: list[str]) -> Iterator[Any]:
        yield from self._table.select(columns).to_batches(max_chunksize=_BATCH)


class Table:
    """A table with its columns, their units and its provenance."""

    def __init__(self, directory: Path, name: str, parts: Sequence[_Part]) -> None:
        self.directory = directory
        self.name = name
        self._parts = parts
        self.schema = parts[0].schema

    def error(self, problem: str, remedy: str) -> FiguresError:
        """Returns an error about this table."""
        return FiguresError(self.directory, self.name, problem, remedy)

    def nothing(self, problem: str, remedy: str) -> NothingToShowError:
        """Returns the error of a valid table with nothing to show."""
        return NothingToShowError(self.directory, self.name, problem, remedy)

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self.schema.names)

    @property
    def rows(self) -> int:
        """The number of rows."""
        return sum(part.rows for part in self._parts)

    @cached_property
    def about(self) -> dict[str, Any]:
        """The provenance in the metadata: study, seed, version and options; empty if there is none."""
        text = self._parts[0].about.get(b"stickslip", b"{}")
        try:
            about = json.loads(text)
        except ValueError:
            return {}
        return about if isinstance(about, dict) else {}

    @property
    def study(self) -> str:
        """The name of the study."""
        return str(self.about.get("study", self.directory.name))

    @cached_property
    def parameters(self) -> dict[str, float]:
        """The numeric model parameters of the study without its sweep."""
        found = re.findall(r"^ +(\w+): ([-+.\deE]+)$", str(self.about.get("study_yaml", "")), re.MULTILINE)
        numbers: dict[str, float] = {}
        for name, value in found:
            try:
                numbers.setdefault(name, float(value))
            except ValueError:
                continue
        return numbers

    def unit(self, column: str) -> str:
        """Returns the unit of a column; empty for a dimensionless number."""
        unit = (self.schema.field(column).metadata or {}).get(b"unit", b"").decode()
        return "" if unit.split(" ")[:1] == ["1"] else unit

    def shown(self, column: str) -> tuple[str, float]:
        """Returns the unit in which the study shows a swept parameter, and the value of this unit in SI."""
        chosen = self.about.get("shown_units", {}).get("parameters", {}).get(column)
        return (str(chosen[0]), float(chosen[1])) if chosen else (self.unit(column), 1.0)

    @property
    def speed(self) -> tuple[str, float]:
        """The unit in which the study shows speeds of rotation, and its value in rad/s."""
        symbol, si = self.about.get("shown_units", {}).get("speed", ("rad/s", 1.0))
        return str(symbol), float(si)

    @property
    def vibration(self) -> tuple[str, float]:
        """The unit in which the study shows amplitudes, and its value in m."""
        symbol, si = self.about.get("shown_units", {}).get("vibration", ("µm", 1e-6))
        return str(symbol), float(si)

    def need(self, columns: Sequence[str]) -> None:
        """Raises FiguresError if a column is missing."""
        missing = [column for column in columns if column not in self.schema.names]
        if missing:
            words = "columns" if len(missing) > 1 else "column"
            version = self.about.get("version", "unknown")
            raise self.error(
                f"it has no {words} {', '.join(missing)} (written by stickslip {version})",
                "write the tables with the version of stickslip that contains this module",
            )

    def batches(self, columns: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
        """Yields columns as arrays of at most 65,536 rows; missing numbers are NaN."""
        self.need(columns)
        try:
            for part in self._parts:
                for batch in part.batches(list(columns)):
                    yield {name: _array(batch.column(name)) for name in columns}
        except (OSError, pa.ArrowException) as error:
            raise self.error(f"it cannot be read ({error})", "write the directory anew") from error

    def read(self, columns: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Returns whole columns as arrays."""
        parts = list(self.batches(columns))
        if not parts:
            return {name: np.empty(0) for name in columns}
        return {name: np.concatenate([part[name] for part in parts]) for name in columns}


def _array(column: pa.Array) -> NDArray[Any]:
    if pa.types.is_dictionary(column.type):
        column = column.cast(pa.string())
    if pa.types.is_floating(column.type) or (pa.types.is_integer(column.type) and column.null_count):
        return np.asarray(column.cast(pa.float64()).to_numpy(zero_copy_only=False), dtype=np.float64)
    return np.asarray(column.to_numpy(zero_copy_only=False))
