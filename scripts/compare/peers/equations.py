"""The balancer's equations for two identical balls, compiled by numba for heyoka.

State `y`: x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2. Phase `s` of a ball: 0 sticks,
1 or -1 slips in that direction. All values are dimensionless (src/model/equations.rs derives them).
"""

import math

import numba as nb
import numpy as np

SPEED, DAMPING, IMBALANCE, MASS, DIAMETER, INERTIA, FRICTION, DRAG, ROLLING = range(9)
# The acceleration and the duration of the ramp with which the disc starts, and the angle at which two balls touch with
# their law of contact; zeros without them.
ACCELERATION, RAMP_TIME, CONTACT_ANGLE, RESTITUTION, BALL_FRICTION = range(9, 14)
TURN = 2.0 * math.pi
# Tolerance of the friction limit against rounding: within it a resting ball does not break away.
SLACK = 2e-13


def read_cases(path):
    """Reads parameters, end time and start states from the file that cases.py writes."""
    with open(path) as file:
        head = [float(value) for value in file.readline().split()]
        starts = np.loadtxt(file, ndmin=2)
    return np.array(head[:14]), head[14], starts


def equations(changes):
    """Compiles the equations of motion, for a disc whose speed is constant or changes."""

    @nb.njit(fastmath=True, error_model="numpy")
    def derivative(y, s1, s2, p, out):
        """Writes the time derivative to `out`; returns normal and friction forces of both balls. While the speed of the
            disc changes, p[SPEED] is its value at the time."""
        omega, zeta, mass = p[SPEED], p[DAMPING], p[MASS]
        mobility = 1.0 / (1.0 + 4.0 * p[INERTIA])
        linear = p[ROLLING] * 2.0 * p[INERTIA] * p[DIAMETER] * omega
        quadratic = p[ROLLING] * -4.0 * p[INERTIA]
        free1, free2 = s1 * s1, s2 * s2
        mu1, mu2 = p[FRICTION] * s1, p[FRICTION] * s2
        sine1, cosine1 = math.sin(y[2]), math.cos(y[2])
        sine2, cosine2 = math.sin(y[3]), math.cos(y[3])
        v1, v2 = y[6], y[7]
        drag1, drag2 = p[DRAG] * v1, p[DRAG] * v2
        alpha = p[ACCELERATION] if changes else 0.0
        euler = (1.0 - 2.0 * p[INERTIA] * p[DIAMETER]) * alpha
        w1, w2 = (omega + v1) * (omega + v1), (omega + v2) * (omega + v2)
        pressed1 = w1 - (linear + quadratic * v1) * v1
        pressed2 = w2 - (linear + quadratic * v2) * v2
        mobile1, mobile2 = mass * mobility * free1, mass * mobility * free2
        x1, y1 = mobile1 * (sine1 + mu1 * cosine1), mobile1 * (mu1 * sine1 - cosine1)
        x2, y2 = mobile2 * (sine2 + mu2 * cosine2), mobile2 * (mu2 * sine2 - cosine2)
        held1 = mobile1 * (mu1 * pressed1 + drag1 + euler) - mass * alpha
        held2 = mobile2 * (mu2 * pressed2 + drag2 + euler) - mass * alpha
        damping_x = 2.0 * zeta * (y[4] - omega * y[1])
        damping_y = 2.0 * zeta * (y[5] + omega * y[0])
        force_x = (
            p[IMBALANCE] * omega * omega - y[0] - damping_x
            + mass * (cosine1 * w1 + cosine2 * w2) - sine1 * held1 - sine2 * held2
        )  # fmt: skip
        force_y = (
            -y[1] - damping_y - p[IMBALANCE] * alpha
            + mass * (sine1 * w1 + sine2 * w2) + cosine1 * held1 + cosine2 * held2
        )  # fmt: skip
        a, b = 1.0 - sine1 * x1 - sine2 * x2, -sine1 * y1 - sine2 * y2
        c, d = cosine1 * x1 + cosine2 * x2, 1.0 + cosine1 * y1 + cosine2 * y2
        inverse = 1.0 / (a * d - b * c)
        a_x = (d * force_x - b * force_y) * inverse
        a_y = (a * force_y - c * force_x) * inverse
        along1 = sine1 * a_x - cosine1 * a_y - euler
        along2 = sine2 * a_x - cosine2 * a_y - euler
        normal1 = pressed1 - cosine1 * a_x - sine1 * a_y
        normal2 = pressed2 - cosine2 * a_x - sine2 * a_y
        slip1, slip2 = mu1 * normal1 + drag1, mu2 * normal2 + drag2
        out[0], out[1] = y[4], y[5]
        out[2], out[3] = free1 * v1, free2 * v2
        out[4] = a_x + 2.0 * omega * y[5] + omega * omega * y[0] + alpha * y[1]
        out[5] = a_y - 2.0 * omega * y[4] + omega * omega * y[1] - alpha * y[0]
        out[6] = free1 * mobility * (along1 - slip1)
        out[7] = free2 * mobility * (along2 - slip2)
        friction1 = slip1 if free1 > 0.0 else along1
        friction2 = slip2 if free2 > 0.0 else along2
        return normal1, normal2, friction1, friction2

    return derivative


derivative = equations(changes=False)


def decisions(derivative):
    """Compiles the decisions between stick and slip, for some equations of motion."""

    @nb.njit
    def decide(y, s, stays, p, scratch):
        """Lets balls that stick break away where friction cannot hold them. The ball `stays` sticks in any case."""
        for _ in range(4):
            forces = derivative(y, s[0], s[1], p, scratch)
            changed = False
            for i in range(2):
                limit = p[FRICTION] * forces[i] + SLACK
                if s[i] == 0.0 and i != stays and abs(forces[2 + i]) > limit:
                    s[i] = math.copysign(1.0, forces[2 + i])
                    changed = True
            if not changed:
                break

    @nb.njit
    def after_event(y, s, ball, at_once, p, scratch):
        """Decides the phases of both balls after an event. `at_once`: the ball stops at the instant of its break-away,
            and sticks."""
        for i in range(2):
            y[2 + i] -= TURN * math.floor(y[2 + i] / TURN)
        if s[ball] == 0.0:
            forces = derivative(y, s[0], s[1], p, scratch)
            s[ball] = math.copysign(1.0, forces[2 + ball])
        else:
            s[ball] = 0.0
            y[6 + ball] = 0.0
        decide(y, s, ball if at_once else -1, p, scratch)

    return decide, after_event


decide, after_event = decisions(derivative)


@nb.njit
def set_in_motion(y, s):
    """Gives balls that break away a negligible speed, because heyoka does not detect a guard that starts at
        exactly zero and rises and falls in the same step."""
    for i in range(2):
        if s[i] != 0.0 and y[6 + i] == 0.0:
            y[6 + i] = 1e-16 * s[i]


@nb.njit
def rest(y, p):
    """Returns the table's rest point while both balls stick at `y`, and the largest distance from it (squared, in phase
        space) at which neither ball ever breaks away (src/model/certificate.rs)."""
    omega, zeta = p[SPEED], p[DAMPING]
    sine1, cosine1 = math.sin(y[2]), math.cos(y[2])
    sine2, cosine2 = math.sin(y[3]), math.cos(y[3])
    force_x = p[IMBALANCE] + p[MASS] * (cosine1 + cosine2)
    force_y = p[MASS] * (sine1 + sine2)
    real, imaginary = 1.0 - omega * omega, 2.0 * zeta * omega
    scale = omega * omega / (real * real + imaginary * imaginary)
    x0 = scale * (real * force_x + imaginary * force_y)
    y0 = scale * (real * force_y - imaginary * force_x)
    bound1 = acceleration_allowed(sine1, cosine1, x0, y0, p)
    bound2 = acceleration_allowed(sine2, cosine2, x0, y0, p)
    bound = min(bound1, bound2)
    if bound <= 0.0:
        return x0, y0, -1.0
    return x0, y0, bound * bound / (1.0 + 4.0 * zeta * zeta)


@nb.njit
def acceleration_allowed(sine, cosine, x0, y0, p):
    """Returns the acceleration of the table beyond rest that a ball's friction limit covers."""
    square = p[SPEED] * p[SPEED]
    normal = square * (1.0 + cosine * x0 + sine * y0)
    friction = square * abs(sine * x0 - cosine * y0)
    return (p[FRICTION] * normal - friction) / (1.0 + p[FRICTION])


@nb.njit
def distance_squared(y, x0, y0, p):
    """Returns the distance of the table from its rest point in phase space, squared."""
    u, v = y[0] - x0, y[1] - y0
    u_dot, v_dot = y[4] - p[SPEED] * v, y[5] + p[SPEED] * u
    return u * u + v * v + u_dot * u_dot + v_dot * v_dot
