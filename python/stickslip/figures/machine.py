"""Computes the natural frequency of a ball balancer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Optional

__all__ = ["natural_frequency_rad_s"]


def natural_frequency_rad_s(parameters: Mapping[str, float]) -> Optional[float]:
    """Returns the natural frequency with all balls, rad/s (thesis section 3.4); None if a parameter is missing."""
    try:
        balls = parameters["balls"] * parameters["ball_mass_kg"]
        mass = parameters["table_mass_kg"] + parameters["imbalance_mass_kg"] + balls
        return math.sqrt(parameters["stiffness_n_m"] / mass)
    except (KeyError, ValueError, ZeroDivisionError):
        return None
