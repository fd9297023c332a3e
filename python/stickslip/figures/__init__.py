"""Draws figures for papers with matplotlib.

>>> from stickslip import figures
>>> figure = figures.draw("results/night", "time-to-rest", width="single")
>>> figure.savefig("time-to-rest.pdf")

``draw`` draws the figures of the page that `stickslip report` writes, for the results of a study and of a search;
``names`` lists them. The other functions draw the tables of `stickslip equilibria`, `replay` and `identify`. Each returns a
matplotlib figure, 90 mm or 180 mm wide, with 8-point type, whose axes and artists can be changed as in any matplotlib
figure. `stickslip-figures DIR` draws all figures. The module requires matplotlib, numpy and pyarrow
(`pip install "stickslip[figures]"`).
"""

from importlib.util import find_spec as _find_spec

for _name in ("matplotlib", "numpy", "pyarrow"):
    if _find_spec(_name) is None:
        raise ModuleNotFoundError(
            f'stickslip.figures needs {_name}: pip install "stickslip[figures]"', name=_name
        )

from .branches import frictionless_branches
from .drawn import draw, names
from .identification import identification
from .trajectory import motion
from .sets import equilibrium_set
from .paper import Paper, style
from .surface import equilibrium_surface
from .tables import FiguresError

__all__ = [
    "FiguresError",
    "Paper",
    "draw",
    "equilibrium_set",
    "equilibrium_surface",
    "frictionless_branches",
    "identification",
    "motion",
    "names",
    "style",
]
