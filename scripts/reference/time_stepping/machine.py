"""The machine of a run: SI parameters, their defaults, and the non-dimensional numbers of the equations.

"Thesis" means *Modeling and Analysis of an Automatic Balancing Unit with Dry Friction* (TU Eindhoven). Lengths are
divided by the ring's radius L, masses by the total mass M, and time is multiplied by omega_n = sqrt(k / M) (thesis
appendix B.6).
"""

import math
from typing import NamedTuple

import numpy as np

# Thesis table 3.2, with repaired scanning errors.
DEFAULTS = {
    "table_mass_kg": 3.24e-1,
    "stiffness_n_m": 1.07e4,
    "damping_n_s_m": 1.28,
    "ring_radius_m": 1.15e-2,
    "imbalance_mass_kg": 5.6e-5,
    "imbalance_radius_m": 3.7e-2,
    "speed_rad_s": -216.3772,
    "normal_force": "lagrange",
}
BALL_DEFAULTS = {
    "ball_mass_kg": 1.4e-4,
    "ball_diameter_m": 3.0e-3,
    "friction_coefficient": 2.75e-3,
}
SPHERE = 0.1  # the polar inertia of a homogeneous sphere over m d^2

# Positions in the vector `scalars`.
OMEGA, ZETA, IMBALANCE, ROLLING = range(4)


class Machine(NamedTuple):
    """The non-dimensional machine. `scalars` holds omega, zeta, m_I e, and 1 or 0: the factor of the rolling term in
    the normal force (`lagrange` or `newton`)."""

    scalars: np.ndarray
    mass: np.ndarray
    diameter: np.ndarray
    friction: np.ndarray
    omega_n: float


def of_ball(name, ball):
    """Returns the name of a parameter of one ball, counted from 1: ball_mass_2_kg, friction_coefficient_2."""
    for unit in ("_kg", "_m"):
        if name.endswith(unit):
            return f"{name.removesuffix(unit)}_{ball}{unit}"
    return f"{name}_{ball}"


def machine(balls, values=None):
    """Returns the machine with SI values by name. The value of a single ball precedes that of all balls."""
    values = values or {}

    def one(name):
        return values.get(name, DEFAULTS[name])

    def each(name):
        common = values.get(name, BALL_DEFAULTS[name])
        own = (values.get(of_ball(name, ball), common) for ball in range(1, balls + 1))
        return np.array([float(value) for value in own])

    masses, length = each("ball_mass_kg"), one("ring_radius_m")
    total = one("table_mass_kg") + one("imbalance_mass_kg") + masses.sum()
    omega_n = math.sqrt(one("stiffness_n_m") / total)
    scalars = np.zeros(4)
    scalars[OMEGA] = one("speed_rad_s") / omega_n
    scalars[ZETA] = one("damping_n_s_m") / (2.0 * total * omega_n)
    scalars[IMBALANCE] = one("imbalance_mass_kg") / total * one("imbalance_radius_m") / length
    scalars[ROLLING] = 1.0 if one("normal_force") == "lagrange" else 0.0
    diameters = each("ball_diameter_m") / length
    return Machine(scalars, masses / total, diameters, each("friction_coefficient"), omega_n)
