"""Formats names, values and coordinates for readers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Union

__all__ = [
    "axis",
    "listed",
    "number",
    "parameter",
    "superscript",
]


def superscript(value: int) -> str:
    """Formats a number as a superscript."""
    return str(value).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def number(value: Union[float, str]) -> str:
    """Formats a value with a true minus sign."""
    return value if isinstance(value, str) else f"{value:.10g}".replace("-", "−")


def axis(name: str, unit: str) -> str:
    """Returns the label of an axis: `speed [rad/s]`."""
    return f"{name} [{unit}]" if unit else name


def parameter(column: str, unit: str) -> str:
    """Returns the name of a parameter in words: `speed` for `speed_rad_s`."""
    suffix = re.sub(r"[^a-z0-9]", "_", unit.lower())
    if suffix and column.endswith(f"_{suffix}"):
        column = column[: -len(suffix) - 1]
    return column.replace("_", " ")


def listed(parts: Sequence[str]) -> str:
    """Joins facts to a sentence; empty without facts."""
    return "; ".join(parts) + "." if parts else ""
