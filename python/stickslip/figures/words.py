"""Names of parameters, values and coordinates as a reader writes them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Union

__all__ = ["axis", "coordinate", "label", "listed", "number", "parameter", "significant", "subscript"]


def subscript(value: int) -> str:
    """A number below the line."""
    return str(value).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))


def number(value: Union[float, str]) -> str:
    """A value as it was given, with a minus sign and not a hyphen."""
    return value if isinstance(value, str) else f"{value:.10g}".replace("-", "−")


def significant(value: float) -> str:
    """A number with four significant digits."""
    return f"{value:.4g}".replace("-", "−")


def axis(name: str, unit: str) -> str:
    """The name of an axis: `speed [rad/s]`."""
    return f"{name} [{unit}]" if unit else name


def parameter(column: str, unit: str) -> str:
    """A parameter in words: `speed` for `speed_rad_s`."""
    suffix = re.sub(r"[^a-z0-9]", "_", unit.lower())
    if suffix and column.endswith(f"_{suffix}"):
        column = column[: -len(suffix) - 1]
    return column.replace("_", " ")


def label(name: str) -> str:
    """A label as a legend says it."""
    return name.replace("_", " ")


def coordinate(column: str) -> str:
    """A coordinate of a start state: `β̇₁` for `initial_beta_dot_1`."""
    parts = column.removeprefix("initial_").split("_")
    letter = "β" if parts[0] == "beta" else parts[0]
    ball = "".join(subscript(int(part)) for part in parts if part.isdigit())
    return letter + ("\u0307" if "dot" in parts else "") + ball


def listed(parts: Sequence[str]) -> str:
    """Facts in a row, as a sentence; empty where there are none."""
    return "; ".join(parts) + "." if parts else ""
