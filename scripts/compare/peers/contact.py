"""Two balls that cannot pass through each other, compiled by numba: forces, impacts, and the decisions where they
touch. Corresponds to touching_balls.hpp and holding.hpp.

Mode `m`: phases of both balls as in equations.py, and which ball is ahead of two that touch: 1 the second one, -1 the
first one, 0 if none touch. Forces are over the mass of a ball.
"""

import math
from itertools import combinations

import numba as nb
import numpy as np
from equations import (
    BALL_FRICTION, CONTACT_ANGLE, DAMPING, DIAMETER, FRICTION, IMBALANCE, INERTIA, MASS, RESTITUTION,
    ROLLING, SLACK, SPEED, TURN, decide,
)  # fmt: skip

# An impact that is slower than this ends in lasting contact.
LASTING_APPROACH = 1e-6
# Phases of the ball behind and of the one ahead of two at rest, and whether they stay in touch.
WAYS = np.array([
    (0.0, 0.0, 1.0), (1.0, 1.0, 1.0), (-1.0, -1.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0),
    (-1.0, 1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, -1.0, 0.0),
])  # fmt: skip


def holding_sums(p):
    """Returns weights of the four inequalities that hold two balls which stick and touch (see holding.hpp): the reserve
    of friction is the least of the sums."""
    mu, ball_friction = p[FRICTION], p[BALL_FRICTION]
    tangent = math.tan(0.5 * p[CONTACT_ANGLE])
    lever = 1.0 / math.cos(0.5 * p[CONTACT_ANGLE]) + tangent
    out, inward = 1.0 + mu * tangent, 1.0 - mu * tangent
    rows = [
        (-out, mu - lever), (inward, lever + mu), (inward, -lever - mu), (-out, lever - mu),
        (-ball_friction, 1.0), (-ball_friction, -1.0),
    ]  # fmt: skip
    sums = []
    for three in combinations(range(6), 3):
        a, b, c = (np.array(rows[row]) for row in three)
        weights = np.array([np.linalg.det([b, c]), np.linalg.det([c, a]), np.linalg.det([a, b])])
        if (weights * weights[0] > 0.0).all():
            sum_of = np.zeros(6)
            sum_of[list(three)] = weights
            sums.append(sum_of[:4] / sum_of[:4].sum())
    return np.array(sums)


@nb.njit
def couple(m, p, coupled):
    """Writes how the accelerations of both balls answer to the forces along the ring of both, as rows of a matrix."""
    mobility = 1.0 / (1.0 + 4.0 * p[INERTIA])
    coupled[:] = 0.0
    if m[2] == 0.0 or m[0] == 0.0:
        coupled[0], coupled[3] = mobility * m[0] * m[0], mobility * m[1] * m[1]
        return
    tangent = math.tan(0.5 * p[CONTACT_ANGLE])
    lever = 1.0 / math.cos(0.5 * p[CONTACT_ANGLE]) + tangent
    retards = p[BALL_FRICTION] * lever + p[FRICTION] * tangent
    skew = -m[0] * m[2] * retards / (1.0 - p[FRICTION] * p[BALL_FRICTION])
    coupled[0] = coupled[2] = 0.5 * mobility * (1.0 + skew)
    coupled[1] = coupled[3] = 0.5 * mobility * (1.0 - skew)


@nb.njit
def forces_on_balls(y, m, p, coupled, out):
    """Writes normal forces, friction forces and accelerations of both balls; returns the force between them."""
    omega, mass, zeta = p[SPEED], p[MASS], p[DAMPING]
    couple(m, p, coupled)
    s1, c1, s2, c2 = math.sin(y[2]), math.cos(y[2]), math.sin(y[3]), math.cos(y[3])
    mu1, mu2 = p[FRICTION] * m[0], p[FRICTION] * m[1]
    linear = p[ROLLING] * 2.0 * p[INERTIA] * p[DIAMETER] * omega
    quadratic = p[ROLLING] * -4.0 * p[INERTIA]
    w1, w2 = (omega + y[6]) ** 2, (omega + y[7]) ** 2
    pressed1 = w1 - (linear + quadratic * y[6]) * y[6]
    pressed2 = w2 - (linear + quadratic * y[7]) * y[7]
    x1, y1, held1 = s1 + mu1 * c1, mu1 * s1 - c1, mu1 * pressed1
    x2, y2, held2 = s2 + mu2 * c2, mu2 * s2 - c2, mu2 * pressed2
    k11, k12, k21, k22 = coupled
    x1, x2 = k11 * x1 + k12 * x2, k21 * x1 + k22 * x2
    y1, y2 = k11 * y1 + k12 * y2, k21 * y1 + k22 * y2
    held1, held2 = k11 * held1 + k12 * held2, k21 * held1 + k22 * held2
    force_x = p[IMBALANCE] * omega * omega - y[0] - 2.0 * zeta * (y[4] - omega * y[1])
    force_y = -y[1] - 2.0 * zeta * (y[5] + omega * y[0])
    force_x += mass * (c1 * w1 + c2 * w2 - s1 * held1 - s2 * held2)
    force_y += mass * (s1 * w1 + s2 * w2 + c1 * held1 + c2 * held2)
    a, b = 1.0 - mass * (s1 * x1 + s2 * x2), -mass * (s1 * y1 + s2 * y2)
    c, d = mass * (c1 * x1 + c2 * x2), 1.0 + mass * (c1 * y1 + c2 * y2)
    inverse = 1.0 / (a * d - b * c)
    a_x, a_y = (d * force_x - b * force_y) * inverse, (a * force_y - c * force_x) * inverse
    normal1, normal2 = pressed1 - c1 * a_x - s1 * a_y, pressed2 - c2 * a_x - s2 * a_y
    along1, along2 = s1 * a_x - c1 * a_y, s2 * a_x - c2 * a_y
    net1, net2 = along1 - mu1 * normal1, along2 - mu2 * normal2
    out[4], out[5] = k11 * net1 + k12 * net2, k21 * net1 + k22 * net2
    between = 0.0
    if m[2] != 0.0 and m[0] != 0.0:
        between = 0.5 * m[2] * (net1 - net2) / (1.0 - p[FRICTION] * p[BALL_FRICTION])
        tangent, skew = math.tan(0.5 * p[CONTACT_ANGLE]), m[2] * m[0] * p[BALL_FRICTION]
        normal1 += (tangent - skew) * between
        normal2 += (tangent + skew) * between
    out[0], out[1] = normal1, normal2
    out[2] = along1 if m[0] == 0.0 else mu1 * normal1
    out[3] = along2 if m[1] == 0.0 else mu2 * normal2
    return between


@nb.njit
def reserve(out, ahead, p, sums):
    """Returns the reserve of friction of two balls that stick and touch, for their normal and friction forces."""
    behind = 0 if ahead > 0.0 else 1
    front = 1 - behind
    first, second = p[FRICTION] * out[behind], p[FRICTION] * out[front]
    bounds = (
        first - out[2 + behind], first + out[2 + behind],
        second - out[2 + front], second + out[2 + front],
    )  # fmt: skip
    least = np.inf
    for k in range(len(sums)):
        total = 0.0
        for row in range(4):
            total += sums[k, row] * bounds[row]
        least = min(least, total)
    return least


@nb.njit
def assume(m, side, way):
    """Sets the mode of two balls at rest to one of `WAYS`."""
    front = 1 if side > 0.0 else 0
    m[1 - front], m[front], m[2] = WAYS[way, 0], WAYS[way, 1], side * WAYS[way, 2]


@nb.njit
def least_reserve(y, m, side, p, sums, coupled, out):
    """Returns the least of all quantities that must not be negative for the assumed mode of two balls at rest."""
    between = forces_on_balls(y, m, p, coupled, out)
    if m[2] != 0.0 and m[0] == 0.0:
        return reserve(out, side, p, sums)
    least = between if m[2] != 0.0 else side * (out[5] - out[4])
    for i in range(2):
        stick = p[FRICTION] * out[i] - abs(out[2 + i])
        least = min(least, stick if m[i] == 0.0 else m[i] * out[4 + i])
    return least


@nb.njit
def decide_in_touch(y, m, p, sums, coupled, out):
    """Decides between stick and slip, touch and separation, of two balls at rest that touch: the first way that meets all
    conditions up to rounding, or else the one that fails them least."""
    side, best, most = m[2], 0, -np.inf
    for way in range(len(WAYS)):
        assume(m, side, way)
        least = least_reserve(y, m, side, p, sums, coupled, out)
        if least > most:
            best, most = way, least
        if most >= -0.1 * SLACK:
            break
    assume(m, side, best)


@nb.njit
def meet(y, m, p, sums, coupled, out):
    """Computes the impact of both balls by Newton's law, with Coulomb friction between them, and decides their phases."""
    angle, mass = p[CONTACT_ANGLE], p[MASS]
    side = 1.0 if y[3] - y[2] < math.pi else -1.0
    y[3] = y[2] + (angle if side > 0.0 else TURN - angle)
    opening, rolling = side * (y[7] - y[6]), y[6] + y[7]
    lasts = -opening < LASTING_APPROACH
    after = 0.0 if lasts else -p[RESTITUTION] * opening
    own, other = 1.0 + 4.0 * p[INERTIA] - mass, mass * math.cos(angle)
    impulse = 0.5 * (own + other) * (after - opening)
    lever = 1.0 / math.cos(0.5 * angle) + math.tan(0.5 * angle)
    slowed = 2.0 * lever * p[BALL_FRICTION] * impulse / (own - other)
    left = math.copysign(max(0.0, abs(rolling) - slowed), rolling)
    for i in range(2):
        speed = 0.5 * (left + side * after * (2.0 * i - 1.0))
        y[4] += mass * math.sin(y[2 + i]) * (speed - y[6 + i])
        y[5] -= mass * math.cos(y[2 + i]) * (speed - y[6 + i])
        y[6 + i] = speed
        m[i] = np.sign(speed)
    m[2] = side if lasts else 0.0
    if not lasts:
        decide(y, m, -1, p, out)
    elif m[0] == 0.0:
        decide_in_touch(y, m, p, sums, coupled, out)
    elif forces_on_balls(y, m, p, coupled, out) < -SLACK:
        m[2] = 0.0
