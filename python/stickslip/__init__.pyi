"""Type annotations of the package; the docstrings of the compiled module describe each item."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, Union, final

__all__ = [
    "EquilibriumSet",
    "Results",
    "Simulation",
    "Study",
    "StudyError",
    "Table",
    "__version__",
    "equilibrium_set",
    "simulate",
]

__version__: str

_Path = Union[str, PathLike[str]]
_Value = Union[float, str]

class _ArrowStream(Protocol):
    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any: ...

_Designs = Union[
    Iterable[Mapping[str, _Value]],
    Mapping[str, Iterable[_Value]],
    Mapping[str, _Value],
    _ArrowStream,
]

class StudyError(ValueError):
    file: Union[str, None]
    line: Union[int, None]
    column: Union[int, None]
    key: Union[str, None]
    problem: Union[str, None]
    found: Union[str, None]
    allowed: Union[str, None]

@final
class Study:
    @staticmethod
    def from_yaml(path: _Path, *, tables: Sequence[_Path] = ...) -> Study: ...
    @staticmethod
    def from_text(
        text: str, *, folder: Union[_Path, None] = None, tables: Sequence[_Path] = ...
    ) -> Study: ...
    @property
    def name(self) -> str: ...
    @property
    def seed(self) -> int: ...
    @property
    def hash(self) -> str: ...
    @property
    def run_count(self) -> int: ...
    @property
    def point_count(self) -> int: ...
    @property
    def variables(self) -> list[str]: ...
    @property
    def responses(self) -> list[str]: ...
    @property
    def yaml(self) -> str: ...
    def run(
        self,
        out: Union[_Path, None] = None,
        *,
        threads: Union[int, None] = None,
        progress: bool = False,
        recompute: bool = False,
    ) -> Results: ...
    def evaluate(
        self, designs: _Designs, *, threads: Union[int, None] = None, progress: bool = False
    ) -> Table: ...

@final
class Results:
    @property
    def runs(self) -> Table: ...
    @property
    def points(self) -> Table: ...
    @property
    def time_to_rest(self) -> Table: ...
    @property
    def cycles(self) -> Table: ...
    @property
    def equilibria(self) -> Table: ...
    @property
    def equilibrium_histogram(self) -> Table: ...
    @property
    def stages(self) -> Union[Table, None]: ...
    @property
    def labels(self) -> dict[str, int]: ...
    @property
    def directory(self) -> Union[Path, None]: ...

@final
class Table:
    def __arrow_c_schema__(self) -> Any: ...
    def __arrow_c_stream__(self, requested_schema: Any = None) -> Any: ...
    @property
    def num_rows(self) -> int: ...
    @property
    def num_columns(self) -> int: ...
    @property
    def column_names(self) -> list[str]: ...
    @property
    def units(self) -> dict[str, Union[str, None]]: ...
    @property
    def meanings(self) -> dict[str, Union[str, None]]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, name: str, /) -> list[Any]: ...
    def to_dict(self) -> dict[str, list[Any]]: ...
    def to_pyarrow(self) -> Any: ...
    def to_polars(self) -> Any: ...
    def to_pandas(self) -> Any: ...

@final
class EquilibriumSet:
    @property
    def fraction(self) -> float: ...
    @property
    def components(self) -> Union[int, None]: ...
    @property
    def summary(self) -> Table: ...
    @property
    def positions(self) -> Union[Table, None]: ...
    @property
    def frictionless(self) -> Table: ...

@final
class Simulation:
    @property
    def label(self) -> str: ...
    @property
    def evidence(self) -> str: ...
    @property
    def run(self) -> Table: ...
    @property
    def trajectory(self) -> Table: ...
    @property
    def switches(self) -> Table: ...
    @property
    def touches(self) -> Union[Table, None]: ...

def equilibrium_set(
    *,
    grid: Union[int, None] = None,
    samples: Union[int, None] = None,
    ball_damping: float = 1e4,
    positions: bool = True,
    threads: Union[int, None] = None,
    **parameters: Any,
) -> EquilibriumSet: ...
def simulate(
    start: Mapping[str, float],
    *,
    times_s: Union[Iterable[float], None] = None,
    model: str = "ball_balancer",
    simulation: Union[Mapping[str, Any], None] = None,
    **parameters: Any,
) -> Simulation: ...
