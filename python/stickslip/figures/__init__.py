"""Draws figures for papers from the Parquet tables of stickslip with matplotlib.

>>> from stickslip import figures
>>> figure = figures.time_to_rest("results/night", width="single")
>>> figure.savefig("time-to-rest.pdf")

Each function reads a directory of results and returns a matplotlib figure, 90 mm or 180 mm wide, with 8-point type.
Its axes and artists can be changed as in any matplotlib figure. `stickslip-figures DIR` draws all figures. The module
requires matplotlib, numpy and pyarrow (`pip install "stickslip[figures]"`), but no compiled part of this package.
"""

from importlib.util import find_spec as _find_spec

for _name in ("matplotlib", "numpy", "pyarrow"):
    if _find_spec(_name) is None:
        raise ModuleNotFoundError(
            f'stickslip.figures needs {_name}: pip install "stickslip[figures]"', name=_name
        )

from .attraction import basins
from .branches import frictionless_branches
from .curves import amplitudes, time_to_rest
from .cycles import limit_cycle_branches
from .endings import diagnostics, ending_fractions
from .identification import identification
from .maps import label_map
from .trajectory import motion
from .preferred import preferred_equilibria
from .sets import equilibrium_set
from .paper import Paper, style
from .surface import equilibrium_surface
from .tables import FiguresError

__all__ = [
    "FiguresError",
    "Paper",
    "amplitudes",
    "basins",
    "diagnostics",
    "ending_fractions",
    "equilibrium_set",
    "equilibrium_surface",
    "frictionless_branches",
    "identification",
    "label_map",
    "limit_cycle_branches",
    "motion",
    "preferred_equilibria",
    "style",
    "time_to_rest",
]
