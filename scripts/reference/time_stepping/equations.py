"""The smooth forces of the table and the balls, the response of the balls to impulses, energy and momentum.

The coordinates x, y (ring's centre) and beta_i (angle of ball i from the imbalance) are those of the rotating disc
(thesis chapter 3 and appendix B). A state is (x, y, beta_1, ..., x_dot, y_dot, beta_dot_1, ...). With s = sin beta_i,
c = cos beta_i, w = omega + beta_dot_i and the absolute acceleration of the ring's centre

    a_x = x_ddot - 2 omega y_dot - omega^2 x        a_y = y_ddot + 2 omega x_dot - omega^2 y

the equations of motion are

    a_x + x + 2 zeta (x_dot - omega y) = m_I e omega^2 + sum m ( s beta_ddot + c w^2)
    a_y + y + 2 zeta (y_dot + omega x) =                 sum m (-c beta_ddot + s w^2)
    (1 + 4 J) beta_ddot = s a_x - c a_y - f_w
    f_n = w^2 - c a_x - s a_y - r,    r = 2 J d omega beta_dot - 4 J beta_dot^2  (lagrange)  or  0  (newton)

with the friction force f_w and the normal force f_n of the ring on a ball, both over its mass.
"""

import numba as nb
import numpy as np

from machine import IMBALANCE, OMEGA, ROLLING, SPHERE, ZETA

INERTIA = 1.0 + 4.0 * SPHERE  # a rolling ball's inertia over m


@nb.njit
def frame_acceleration(scalars, position, velocity):
    """Returns a_x - x_ddot and a_y - y_ddot."""
    omega = scalars[OMEGA]
    along = -2.0 * omega * velocity[1] - omega * omega * position[0]
    across = 2.0 * omega * velocity[0] - omega * omega * position[1]
    return along, across


@nb.njit
def table_force(scalars, mass, position, velocity, sine, cosine):
    """Returns the accelerations of the table if all beta_ddot are zero."""
    omega, zeta = scalars[OMEGA], scalars[ZETA]
    along, across = frame_acceleration(scalars, position, velocity)
    x = -along - position[0] - 2.0 * zeta * (velocity[0] - omega * position[1])
    y = -across - position[1] - 2.0 * zeta * (velocity[1] + omega * position[0])
    x += scalars[IMBALANCE] * omega * omega
    for i in range(len(mass)):
        w = omega + velocity[2 + i]
        x += mass[i] * cosine[i] * w * w
        y += mass[i] * sine[i] * w * w
    return x, y


@nb.njit
def static_normal(scalars, diameter, i, along, across, velocity, sine, cosine):
    """Returns the part of f_n of ball i that contains no x_ddot and no y_ddot."""
    omega, speed = scalars[OMEGA], velocity[2 + i]
    w = omega + speed
    rolling = 2.0 * SPHERE * diameter[i] * omega * speed - 4.0 * SPHERE * speed * speed
    return w * w - cosine[i] * along - sine[i] * across - scalars[ROLLING] * rolling


@nb.njit
def response(mass, sine, cosine, out):
    """Fills `out` with the changes of all ball speeds per unit impulse on each ball, while the table is free.

    This is the inverse of m_i A_ij with A_ij = (1 + 4 J) delta_ij - m_j cos(beta_i - beta_j). The second term has rank
    two, so that a system of two equations suffices (Woodbury's formula).
    """
    n = len(mass)
    cc, cs, ss = 1.0, 0.0, 1.0
    for i in range(n):
        cc -= mass[i] * cosine[i] * cosine[i] / INERTIA
        cs -= mass[i] * cosine[i] * sine[i] / INERTIA
        ss -= mass[i] * sine[i] * sine[i] / INERTIA
    determinant = cc * ss - cs * cs
    for i in range(n):
        for j in range(n):
            a = (ss * cosine[j] - cs * sine[j]) / determinant
            b = (cc * sine[j] - cs * cosine[j]) / determinant
            out[i, j] = (cosine[i] * a + sine[i] * b) / (INERTIA * INERTIA)
        out[i, i] += 1.0 / (INERTIA * mass[i])


def energy(machine, state):
    """Returns the Jacobi integral. It is constant without damping and friction, because the Lagrange function of the
    disc's coordinates does not contain the time."""
    n = len(machine.mass)
    omega = machine.scalars[OMEGA]
    (x, y), beta = state[:2], state[2 : 2 + n]
    (u, v), speed = state[2 + n : 4 + n], state[4 + n :]
    relative = u + 1j * v + 1j * speed * np.exp(1j * beta)
    free = 1.0 - machine.mass.sum()
    kinetic = 0.5 * free * (u * u + v * v) + 0.5 * machine.mass @ abs(relative) ** 2
    kinetic += 2.0 * SPHERE * machine.mass @ speed**2
    centre = machine.scalars[IMBALANCE] + machine.mass @ np.exp(1j * beta)
    centrifugal = 0.5 * (x * x + y * y) + x * centre.real + y * centre.imag
    return kinetic + 0.5 * (x * x + y * y) - omega**2 * centrifugal


def momentum(machine, state):
    """Returns the absolute linear momentum of table and balls, as a complex number in the directions of the disc."""
    n = len(machine.mass)
    omega = machine.scalars[OMEGA]
    place, speed = complex(*state[:2]), complex(*state[2 + n : 4 + n])
    balls = machine.mass * (omega + state[4 + n :]) * np.exp(1j * state[2 : 2 + n])
    return speed + 1j * omega * (place + machine.scalars[IMBALANCE]) + 1j * balls.sum()
