"""Parallel parameter studies and Monte Carlo for mechanical systems with dry friction.

``Study.from_yaml("study.yaml")`` reads a study, and ``Study.from_dict(keys)`` creates one. ``study.run()`` returns its
result tables, ``study.evaluate(designs)`` estimates its responses for designs, ``study.optimize()`` searches for the best
design, and ``study.identify(measured)`` infers parameters. ``open(directory)`` reads results on disk. ``simulate`` and
``equilibrium_set`` compute one machine without a study. ``System`` describes a machine by formulas, and derives them from
energies in SymPy. All tables are Arrow tables in memory, which pyarrow, Polars, pandas and DuckDB read directly.
``stickslip.figures`` draws figures for papers from results and from their directories.
"""

from importlib import import_module as _import_module

__all__ = [
    "EquilibriumSet",
    "Identification",
    "Optimum",
    "Results",
    "Simulation",
    "Study",
    "StudyError",
    "System",
    "Table",
    "__version__",
    "equilibrium_set",
    "open",
    "simulate",
]


def __getattr__(name):
    # The compiled part, systems, and the figures, which need matplotlib, are loaded on first use.
    if name == "figures":
        return _import_module(".figures", __name__)
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = ".system" if name == "System" else "._stickslip"
    value = globals()[name] = getattr(_import_module(module, __name__), name)
    return value


def __dir__():
    return sorted({*globals(), *__all__})
