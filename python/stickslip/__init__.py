"""Parallel parameter studies and Monte Carlo for mechanical systems with dry friction.

``Study.from_yaml("study.yaml")`` reads a study; ``study.run()`` gives its tables, ``study.evaluate(designs)``
its responses at designs. ``simulate`` and ``equilibrium_set`` serve one machine without a study. All tables are
Arrow tables in memory, which pyarrow, Polars, pandas and DuckDB take as they are.
"""

from ._stickslip import (
    EquilibriumSet,
    Results,
    Simulation,
    Study,
    StudyError,
    Table,
    __version__,
    equilibrium_set,
    simulate,
)

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
