"""Checks a peer's right-hand side against one linear system for all accelerations and forces, without elimination
by hand (thesis section 3.5; the peers solve for the balls first)."""

import numpy as np


def points(work, parameters, count=200):
    """Returns random states, each with the phases of both balls. With contact, the ball ahead of two that touch
    follows (0 for none, 1 for the second ball, -1 for the first), and with a ramp the time."""
    random = np.random.default_rng(1)
    spread = np.array([0.05, 0.05, 9.0, 9.0, 0.05, 0.05, 1.0, 1.0])
    states = random.uniform(-spread, spread, (count, 8))
    phases = np.ones((count, 2)) if work.smooth else random.integers(-1, 2, (count, 2))
    columns = [states, phases]
    if work.contact:
        touching = random.integers(-1, 2, count)
        both = touching != 0
        states[both, 3] = states[both, 2] + touching[both] * parameters[11]
        states[both, 7] = states[both, 6]
        phases[both, 1] = phases[both, 0]
        columns.append(touching[:, None])
    if work.ramp:
        columns.append(random.uniform(0.0, 2.0 * parameters[10], (count, 1)))
    return np.hstack(columns)


def expected(point, work, parameters):
    """Returns time derivative, normal and friction forces at a point, and with contact the force between the balls,
    over the mass of one."""
    omega, zeta, imbalance, mass, diameter, inertia, mu, drag, rolling = parameters[:9]
    rise, duration, angle, _, ball_friction = parameters[9:14]
    touching = point[10] if work.contact else 0.0
    alpha = 0.0
    if work.ramp and point[10] < duration:
        alpha = rise
        omega += rise * (point[10] - duration)
    x, y, b1, b2, x_dot, y_dot, v1, v2 = point[:8]
    # Unknowns: x_ddot, y_ddot, for each ball beta_ddot, normal force, friction force, and the force between the balls.
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    turning_x = -2 * omega * y_dot - omega**2 * x - alpha * y
    turning_y = 2 * omega * x_dot - omega**2 * y + alpha * x
    matrix[0, 0] = matrix[1, 1] = 1.0
    right[0] = imbalance * omega**2 - turning_x - x - 2 * zeta * (x_dot - omega * y)
    right[1] = -imbalance * alpha - turning_y - y - 2 * zeta * (y_dot + omega * x)
    for i, (beta, v, phase) in enumerate(((b1, v1, point[8]), (b2, v2, point[9]))):
        s, c, w = np.sin(beta), np.cos(beta), omega + v
        normal, friction = 4 + i, 6 + i
        matrix[0, 2 + i], matrix[1, 2 + i] = -mass * s, mass * c
        right[0] += mass * (c * w**2 + s * alpha)
        right[1] += mass * (s * w**2 - c * alpha)
        # Along the ring, across the ring, and the friction law.
        along, across, law = 2 + i, 4 + i, 6 + i
        matrix[along, [0, 1, 2 + i, friction]] = -s, c, 1 + 4 * inertia, 1.0
        right[along] = s * turning_x - c * turning_y - (1 - 2 * inertia * diameter) * alpha
        matrix[across, [0, 1, normal]] = c, s, 1.0
        roll = rolling * (2 * inertia * diameter * omega * v - 4 * inertia * v**2)
        right[across] = w**2 - c * turning_x - s * turning_y - roll
        # The force along the chord between the centres, and friction across it against the rolling of both balls. Their
        # work is that at the point of contact, which moves as the ball rolls on the ring.
        ahead = touching if i == 1 else -touching
        chord = np.array([np.cos(angle / 2), ahead * np.sin(angle / 2)])
        over = np.array([chord[1], -chord[0]])
        force = ahead * (chord - phase * ball_friction * over)
        matrix[along, 8], matrix[across, 8] = -force @ (ahead * over + [1.0, 0.0]), -force[1]
        if phase == 0:
            matrix[law, 2 + i] = 1.0
        else:
            matrix[law, [normal, friction]] = -mu * phase, 1.0
            right[law] = drag * v
    # Balls that touch keep their distance; if both stick, the force is not determined and left out.
    moving_pair = touching != 0 and point[8] != 0
    if moving_pair:
        matrix[8, 2:4] = 1.0, -1.0
    else:
        matrix[8, 8] = 1.0
    x_ddot, y_ddot, *rest, force = np.linalg.solve(matrix, right)
    moving = [v * abs(phase) for v, phase in zip(point[6:8], point[8:10])]
    between = [force * np.cos(angle / 2)] if work.contact else []
    return np.array([x_dot, y_dot, *moving, x_ddot, y_ddot, *rest, *between])


def worst_difference(peer, work, folder):
    """Returns the largest difference of any component at any of the random states."""
    head = work.cases.read_text().split("\n", 1)[0].split()
    parameters = [float(value) for value in head]
    some = points(work, parameters)
    path = folder / f"{work.name}-points.txt"
    np.savetxt(path, some, fmt="%.17g")
    values = np.array(peer.ask(f"check {path}")["values"])
    rows = zip(some, values)
    return max(np.abs(expected(point, work, parameters) - row).max() for point, row in rows)
