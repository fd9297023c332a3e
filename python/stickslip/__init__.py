"""Parallel parameter studies and Monte Carlo for mechanical systems with dry friction.

``Study.from_yaml("study.yaml")`` reads a study; ``study.run()`` gives its tables, ``study.evaluate(designs)``
its responses at designs. ``simulate`` and ``equilibrium_set`` serve one machine without a study. All tables are
Arrow tables in memory, which pyarrow, Polars, pandas and DuckDB take as they are. ``stickslip.figures`` draws
figures for papers from tables in files; it is Python alone, and works without the compiled part.
"""

from importlib import import_module as _import_module

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


def __getattr__(name):
    # The compiled part is loaded when something of it is asked for.
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(_import_module("._stickslip", __name__), name)
    return value


def __dir__():
    return sorted({*globals(), *__all__})
