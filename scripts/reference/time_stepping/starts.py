"""Start states in which no balls overlap: the order of balls on the ring, their gaps, and the map of sampled angles."""

import math

import numpy as np

TURN = 2.0 * math.pi


def least_angle(first, second):
    """Returns the angle between two balls that touch, from their diameters over the ring's radius."""
    return 2.0 * math.asin((first + second) / 4.0)


def order_on_ring(beta):
    """Returns the indices of the balls in the order of the ring, beginning with ball 1."""
    offsets = np.mod(np.asarray(beta) - beta[0], TURN)
    offsets[0] = -1.0
    return np.argsort(offsets, kind="stable")


def neighbours(order, diameter):
    """Returns the pairs (behind, ahead) of neighbours on the ring and their least angles. Two balls have two pairs."""
    if len(order) < 2:
        return np.zeros((0, 2), np.int64), np.zeros(0)
    pairs = np.column_stack([order, np.roll(order, -1)]).astype(np.int64)
    angles = [least_angle(diameter[i], diameter[j]) for i, j in pairs]
    return pairs, np.array(angles)


def unwrapped(beta, order):
    """Returns the angles plus whole turns, so that they increase in the order of the ring within one turn."""
    beta = np.asarray(beta, float)
    out = beta[0] + np.mod(beta - beta[0], TURN)
    out[order[0]] = beta[0]
    return out


def gaps(beta, pairs, angles):
    """Returns the gaps between neighbours, in radians, for unwrapped angles."""
    if len(pairs) == 0:
        return np.zeros(0)
    out = beta[pairs[:, 1]] - beta[pairs[:, 0]] - angles
    out[-1] += TURN  # from the last ball over the whole turn to the first
    return out


def apart(beta, diameter):
    """Maps sampled angles to angles without overlap.

    Ball 1 keeps its angle. The offsets of the other balls from ball 1 in [0, 2 pi) are sorted, multiplied by
    (2 pi - S) / (2 pi), where S is the sum of the least angles between all neighbours, and increased by the least
    angles of all pairs between ball 1 and the ball. The map preserves the order of the balls. It maps a uniform
    sample of angles to a uniform sample of all positions without overlap, because its Jacobian is constant for balls
    in the same order.
    """
    beta = np.asarray(beta, float)
    if len(beta) < 2:
        return beta.copy()
    order = order_on_ring(beta)
    _, angles = neighbours(order, diameter)
    if angles.sum() > TURN:
        raise ValueError(f"the balls need {angles.sum():.4f} rad of the ring's {TURN:.4f} rad")
    offsets = np.mod(beta - beta[0], TURN)
    offsets[order[0]] = 0.0
    out = beta[0] + offsets * (TURN - angles.sum()) / TURN
    out[order[1:]] += np.cumsum(angles)[:-1]
    return out
