"""Checks a peer's right-hand side against one linear system for all accelerations and forces, without elimination
by hand (thesis section 3.5; the peers solve for the balls first)."""

import numpy as np


def points(smooth, count=200):
    """Returns random states, each with the phases of both balls."""
    random = np.random.default_rng(1)
    spread = np.array([0.05, 0.05, 9.0, 9.0, 0.05, 0.05, 1.0, 1.0])
    states = random.uniform(-spread, spread, (count, 8))
    phases = np.ones((count, 2)) if smooth else random.integers(-1, 2, (count, 2))
    return np.hstack([states, phases])


def expected(point, parameters):
    """Returns time derivative, normal and friction forces at a point."""
    omega, zeta, imbalance, mass, diameter, inertia, mu, drag, rolling = parameters
    x, y, b1, b2, x_dot, y_dot, v1, v2 = point[:8]
    # Unknowns: x_ddot, y_ddot, and for each ball beta_ddot, normal force, friction force.
    matrix, right = np.zeros((8, 8)), np.zeros(8)
    turning_x = -2 * omega * y_dot - omega**2 * x
    turning_y = 2 * omega * x_dot - omega**2 * y
    matrix[0, 0] = matrix[1, 1] = 1.0
    right[0] = imbalance * omega**2 - turning_x - x - 2 * zeta * (x_dot - omega * y)
    right[1] = -turning_y - y - 2 * zeta * (y_dot + omega * x)
    for i, (angle, v, phase) in enumerate(((b1, v1, point[8]), (b2, v2, point[9]))):
        s, c, w = np.sin(angle), np.cos(angle), omega + v
        normal, friction = 4 + i, 6 + i
        matrix[0, 2 + i], matrix[1, 2 + i] = -mass * s, mass * c
        right[0] += mass * c * w**2
        right[1] += mass * s * w**2
        # Along the ring, across the ring, and the friction law.
        along, across, law = 2 + i, 4 + i, 6 + i
        matrix[along, [0, 1, 2 + i, friction]] = -s, c, 1 + 4 * inertia, 1.0
        right[along] = s * turning_x - c * turning_y
        matrix[across, [0, 1, normal]] = c, s, 1.0
        roll = rolling * (2 * inertia * diameter * omega * v - 4 * inertia * v**2)
        right[across] = w**2 - c * turning_x - s * turning_y - roll
        if phase == 0:
            matrix[law, 2 + i] = 1.0
        else:
            matrix[law, [normal, friction]] = -mu * phase, 1.0
            right[law] = drag * v
    x_ddot, y_ddot, *rest = np.linalg.solve(matrix, right)
    moving = [v * abs(phase) for v, phase in zip(point[6:8], point[8:])]
    return np.array([x_dot, y_dot, *moving, x_ddot, y_ddot, *rest])


def worst_difference(peer, work, folder):
    """Returns the largest difference of any component at any of the random states."""
    head = work.cases.read_text().split("\n", 1)[0].split()
    parameters = [float(value) for value in head[:9]]
    some = points(work.smooth)
    path = folder / f"{work.name}-points.txt"
    np.savetxt(path, some, fmt="%.17g")
    values = np.array(peer.ask(f"check {path}")["values"])
    return max(np.abs(expected(point, parameters) - row).max() for point, row in zip(some, values))
