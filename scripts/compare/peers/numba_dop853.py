"""One step of DOP853 (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.5-6), its error and its
dense output, with SciPy's coefficients unrolled into straight code for numba."""

import numba as nb
import numpy as np
from scipy.integrate._ivp import dop853_coefficients as table

OPTIONS = {"fastmath": True, "error_model": "numpy"}


def combination(row):
    """Returns source code of a linear combination of stages, without zero coefficients."""
    return " + ".join(f"{float(a)!r} * k[{j}, i]" for j, a in enumerate(row) if a != 0.0)


def stages(first, last):
    """Returns source code that computes the stages from `first` to `last`, each from those before."""
    for stage in range(first, last):
        yield f"    for i in range(8): tmp[i] = y[i] + h * ({combination(table.A[stage, :stage])})"
        yield f"    derivative(tmp, s1, s2, p, k[{stage}])"


def compiled(derivative):
    """Returns `attempt`, `error` and `interpolant` for a right-hand side compiled by numba."""
    source = "\n".join(
        ["def attempt(y, h, s1, s2, p, k, tmp, end):", *stages(1, 12),
         f"    for i in range(8): end[i] = y[i] + h * ({combination(table.B)})",
         "    return derivative(end, s1, s2, p, k[12])",
         "def error(y, end, h, k, scale):",
         "    fifth, third = 0.0, 0.0",
         "    for i in range(8):",
         f"        a = ({combination(table.E5)}) / scale[i]",
         f"        b = ({combination(table.E3)}) / scale[i]",
         "        fifth += a * a; third += b * b",
         "    return h * fifth / np.sqrt((fifth + 0.01 * third) * 8.0 + 1e-300)",
         "def interpolant(y, end, h, s1, s2, p, k, tmp, f):", *stages(13, 16),
         "    for i in range(8):",
         "        f[0, i] = end[i] - y[i]",
         "        f[1, i] = h * k[0, i] - f[0, i]",
         "        f[2, i] = 2.0 * f[0, i] - h * (k[12, i] + k[0, i])",
         *(f"        f[{3 + j}, i] = h * ({combination(row)})" for j, row in enumerate(table.D))]
    )  # fmt: skip
    names = {"derivative": derivative, "np": np}
    exec(source, names)
    return [nb.njit(**OPTIONS)(names[name]) for name in ("attempt", "error", "interpolant")]


@nb.njit(**OPTIONS)
def evaluate(y, f, theta, out):
    """Returns the state at the fraction `theta` of a step, from its interpolant `f`."""
    for i in range(8):
        value = 0.0
        for j in range(6, -1, -1):
            value = (value + f[j, i]) * (theta if j % 2 == 0 else 1.0 - theta)
        out[i] = value + y[i]
