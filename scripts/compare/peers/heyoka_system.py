"""The balancer's equations of motion as expressions for heyoka. The phases of the balls are parameters, so that the
runs of a batch can differ."""

import heyoka as hy
from equations import (
    ACCELERATION, DAMPING, DIAMETER, DRAG, FRICTION, IMBALANCE, INERTIA, MASS, RAMP_TIME, ROLLING,
    SPEED,
)  # fmt: skip

NAMES = ("x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2")


def apart(p, phases):
    """Returns how balls that move for themselves answer to the forces along the ring."""
    mobility = float(1.0 / (1.0 + 4.0 * p[INERTIA]))
    if p[FRICTION] == 0.0:
        return lambda forces: [mobility * force for force in forces]
    return lambda forces: [
        mobility * phase * phase * force for phase, force in zip(phases, forces)
    ]


def system(p, phases, respond, changes=False):
    """Returns the equations of motion, and normal, friction and net forces on each ball, without the force between balls
    that touch. `respond` returns accelerations of both balls by forces along the ring; `changes`: the disc starts."""
    x, y, *beta, x_dot, y_dot, v1, v2 = hy.make_vars(*NAMES)
    omega, zeta, mass, mu = (float(p[i]) for i in (SPEED, DAMPING, MASS, FRICTION))
    alpha = float(p[ACCELERATION]) if changes else 0.0
    if changes:
        omega = float(p[SPEED] - p[ACCELERATION] * p[RAMP_TIME]) + alpha * hy.time
    euler = float(1.0 - 2.0 * p[INERTIA] * p[DIAMETER]) * alpha
    linear = float(p[ROLLING] * 2.0 * p[INERTIA] * p[DIAMETER]) * omega
    quadratic = float(p[ROLLING] * -4.0 * p[INERTIA])
    force_x = float(p[IMBALANCE]) * omega * omega - x - 2.0 * zeta * (x_dot - omega * y)
    force_y = -y - 2.0 * zeta * (y_dot + omega * x) - float(p[IMBALANCE]) * alpha
    balls, rows = [], []
    for angle, v, phase in zip(beta, (v1, v2), phases):
        s, c = hy.sin(angle), hy.cos(angle)
        w = (omega + v) * (omega + v)
        pressed = w - (linear + quadratic * v) * v
        signed = 0.0 if mu == 0.0 else mu * phase
        viscous = float(p[DRAG]) * v
        rows.append((s + signed * c, signed * s - c, signed * pressed + viscous + euler))
        force_x += mass * c * w
        force_y += mass * s * w
        balls.append((s, c, pressed, v, phase, signed, viscous))
    matrix = [[1.0, 0.0], [0.0, 1.0]]
    for (s, c, *_), along_x, along_y, held in zip(balls, *(respond(part) for part in zip(*rows))):
        matrix[0][0] -= mass * s * along_x
        matrix[0][1] -= mass * s * along_y
        matrix[1][0] += mass * c * along_x
        matrix[1][1] += mass * c * along_y
        force_x -= mass * s * (held - alpha)
        force_y += mass * c * (held - alpha)
    (a, b), (c, d) = matrix
    inverse = 1.0 / (a * d - b * c)
    a_x, a_y = (d * force_x - b * force_y) * inverse, (a * force_y - c * force_x) * inverse
    normals, frictions, nets, moving = [], [], [], []
    for s, c, pressed, v, phase, signed, viscous in balls:
        along = s * a_x - c * a_y - euler
        normal = pressed - c * a_x - s * a_y
        slip = signed * normal + viscous
        free = 1.0 if mu == 0.0 else phase * phase
        normals.append(normal)
        frictions.append(free * slip + (1.0 - free) * along)
        nets.append(along - slip)
        moving.append(free * v)
    turning_x = a_x + 2.0 * omega * y_dot + omega * omega * x + alpha * y
    turning_y = a_y - 2.0 * omega * x_dot + omega * omega * y - alpha * x
    rates = (x_dot, y_dot, *moving, turning_x, turning_y, *respond(nets))
    return list(zip((x, y, *beta, x_dot, y_dot, v1, v2), rates)), normals, frictions, nets


def distance_squared(p, x0, y0):
    """Returns the distance of the table from its rest point in phase space, squared."""
    x, y, *_, x_dot, y_dot, _, _ = hy.make_vars(*NAMES)
    u, v = x - x0, y - y0
    u_dot, v_dot = x_dot - float(p[SPEED]) * v, y_dot + float(p[SPEED]) * u
    return u * u + v * v + u_dot * u_dot + v_dot * v_dot
