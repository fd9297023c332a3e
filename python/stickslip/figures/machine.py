"""Computes the amplitude without balls and the natural frequency of a ball balancer."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Optional

__all__ = ["amplitude_without_balls_m", "natural_frequency_rad_s"]


def amplitude_without_balls_m(parameters: Mapping[str, float]) -> Optional[float]:
    """Returns the table's amplitude without balls in m, or None if a parameter is missing."""
    try:
        speed = parameters["speed_rad_s"]
        mass = parameters["table_mass_kg"] + parameters["imbalance_mass_kg"]
        force = parameters["imbalance_mass_kg"] * parameters["imbalance_radius_m"] * speed**2
        stiffness = parameters["stiffness_n_m"] - mass * speed**2
        resistance = math.hypot(stiffness, parameters["damping_n_s_m"] * speed)
    except KeyError:
        return None
    return force / resistance if resistance > 0 else None


def natural_frequency_rad_s(parameters: Mapping[str, float]) -> Optional[float]:
    """Returns the natural frequency with all balls, rad/s (thesis section 3.4); None if a parameter is missing."""
    try:
        balls = parameters["balls"] * parameters["ball_mass_kg"]
        mass = parameters["table_mass_kg"] + parameters["imbalance_mass_kg"] + balls
        return math.sqrt(parameters["stiffness_n_m"] / mass)
    except (KeyError, ValueError, ZeroDivisionError):
        return None
