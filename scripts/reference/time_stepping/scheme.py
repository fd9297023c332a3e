"""The time-stepping scheme of Moreau and Jean on the level of velocities and impulses, and the runs.

J. J. Moreau 1988, doi:10.1007/978-3-7091-2624-0_1; M. Jean 1999, doi:10.1016/S0045-7825(98)00383-1; Acary and Brogliato
2008, doi:10.1007/978-3-540-75392-6. One step of length h from (q, v) to (q', v'):

    q_m = q + h/2 v                                   middle position; its closed contacts (gap <= 0) are active
    M(q_m) (v' - v) = h F(q_m, v + w (v' - v)) + impulses, which obey the laws of `contact` with v'
    q'  = q_m + h/2 v' + (w - 1/2) h (v' - v)

Smooth forces F are taken at the mean velocity (w = 1/2), and the step is repeated with the new mean until v' no longer
changes. Without events the scheme is symmetric and has order 2. It locates no event: an impact, a stop or a break-away
happens in the step that contains it.

An impact is the exception to w = 1/2, which is not part of the scheme of Moreau and Jean. If the gap became zero a time t
before the middle of the step, w = 1/2 + t/h. Balls and table then move as if their velocities had changed at that time, and
the law of impact takes the speeds of approach and separation at that time. This makes the error about ten times smaller.
"""

import math

import numba as nb
import numpy as np

import contact
from equations import frame_acceleration, response, static_normal, table_force
from machine import OMEGA, ZETA

REPEATS = 50
UNCHANGED = 1e-12  # change of the speeds by a repetition
# Below this speed of approach a closed contact persists instead of bouncing, unless the restitution is 1. The sequence of
# ever smaller bounces ends here.
IMPACT_SPEED = 1e-6
# Impacts slower than SLOW times the step happen at the middle of the step, so that small bounces end in a closed contact.
SLOW = 0.2
# A run is at rest if no ball is faster than STILL for STILL_TIME, and ends if the table's vibration is also below QUIET.
STILL, STILL_TIME, QUIET = 1e-6, 50.0, 1e-7

# Positions in the vector of results.
RESULTS = 11
(END_TIME, AT_REST, IMPACTS, LIFTED, UNSOLVED, DAMPING_WORK, RING_WORK, CONTACT_WORK, BALL_WORK, LEAST_GAP,
 STILL_FOR) = range(RESULTS)


@nb.njit
def vibration(scalars, mass, state):
    """Bounds the table's acceleration relative to its rest point with balls at rest (thesis eqs. 5.3-5.5)."""
    n = len(mass)
    omega, zeta = scalars[OMEGA], scalars[ZETA]
    force = scalars[2] + 0j
    for i in range(n):
        force += mass[i] * np.exp(1j * state[2 + i])
    rest = omega * omega * force / (1.0 - omega * omega + 2j * zeta * omega)
    place = state[0] + 1j * state[1] - rest
    speed = state[2 + n] + 1j * state[3 + n] + 1j * omega * place
    return abs(place) + 2.0 * zeta * abs(speed)


@nb.njit
def gap(state, contacts, angles, k):
    turn = 2.0 * math.pi if k == len(contacts) - 1 else 0.0
    return state[2 + contacts[k, 1]] - state[2 + contacts[k, 0]] - angles[k] + turn


@nb.njit(nogil=True, error_model="numpy")
def run(state, h, steps, scalars, mass, diameter, friction, contacts, angles, law, until_rest, tail, results, speeds_out):
    """Integrates one run in place. `law` is restitution and friction between the balls. Fills `results` and the mean
    speeds over the last `tail` steps."""
    n, k_max = len(mass), len(contacts)
    restitution, ball_friction = law
    v, new, middle = state[2 + n :].copy(), state[2 + n :].copy(), state[2 + n :].copy()
    last = v.copy()
    position = state[: 2 + n]
    sine, cosine, static = np.zeros(n), np.zeros(n), np.zeros(n)
    free, speeds, normals = np.zeros(n), np.zeros(n), np.zeros(n)
    S = np.zeros((n, n))
    p, P, q = np.zeros(n), np.zeros(k_max), np.zeros(k_max)
    first_p, first_P, first_q = np.zeros(n), np.zeros(k_max), np.zeros(k_max)
    active, persistent = np.zeros(k_max, np.bool_), np.zeros(k_max, np.bool_)
    rates, late = np.zeros(k_max), np.zeros(k_max)
    bounce, threshold = np.zeros(k_max), IMPACT_SPEED if restitution < 1.0 else 0.0
    tangent, kappa = np.tan(0.5 * angles), 1.0 / np.cos(0.5 * angles) + np.tan(0.5 * angles)
    still = 0.0
    angles_at_tail = position[2:].copy()
    results[:] = 0.0
    results[LEAST_GAP] = math.inf if k_max == 0 else min([gap(position, contacts, angles, k) for k in range(k_max)])
    done = steps
    for step in range(steps):
        if step == steps - tail:
            angles_at_tail[:] = position[2:]
        position += 0.5 * h * v
        for i in range(n):
            sine[i], cosine[i] = math.sin(position[2 + i]), math.cos(position[2 + i])
        response(mass, sine, cosine, S)
        impacts, weight = 0, 0.5
        for k in range(k_max):
            least = gap(position, contacts, angles, k)
            results[LEAST_GAP] = min(results[LEAST_GAP], least)
            active[k] = least <= 0.0
            rate = v[2 + contacts[k, 1]] - v[2 + contacts[k, 0]]
            hits = active[k] and rate < -threshold
            bounce[k] = restitution * rate if hits or rate > 0.0 else 0.0
            persistent[k] = active[k] and not hits
            impacts += hits
            rates[k], late[k] = rate, -1.0
            if hits and rate < -SLOW * h:
                late[k] = min(least / rate, h)
                weight = max(weight, 0.5 + late[k] / h)
        results[IMPACTS] += impacts
        new[:] = v + (v - last)
        last[:] = v
        solved, lifted = False, False
        for _ in range(REPEATS):
            middle[:] = v + weight * (new - v)
            along, across = frame_acceleration(scalars, position, middle)
            x, y = table_force(scalars, mass, position, middle, sine, cosine)
            free[:] = v[2:]
            for i in range(n):
                static[i] = h * static_normal(scalars, diameter, i, along, across, middle, sine, cosine)
                drive = mass[i] * h * (sine[i] * (along + x) - cosine[i] * (across + y))
                contact.push(free, S, i, drive)
            for k in range(k_max):
                if late[k] >= 0.0:
                    pull = (free[contacts[k, 1]] - free[contacts[k, 0]] - rates[k]) / h
                    before = rates[k] + pull * (0.5 * h - late[k])
                    bounce[k] = min(0.0, restitution * before - pull * (0.5 * h + late[k]))
            speeds[:] = free
            fixed = impacts > 0
            if fixed:
                # The normal impulses of the ring without those of the impacts.
                first_p[:], first_P[:], first_q[:] = p, P, q
                contact.solve(S, v[2:], speeds, mass, friction, normals, False, static, (h * x, h * y), sine, cosine,
                              contacts, tangent, kappa, persistent, bounce, ball_friction, first_p, first_P, first_q)
                speeds[:] = free
            sweeps, lifted = contact.solve(
                S, v[2:], speeds, mass, friction, normals, fixed, static, (h * x, h * y), sine, cosine,
                contacts, tangent, kappa, active, bounce, ball_friction, p, P, q)
            if fixed:
                lifted = contact.ring_normals(static, (h * x, h * y), mass, sine, cosine, v[2:], speeds, contacts, tangent,
                                              P, q, normals)
            dx, dy = h * x, h * y
            for i in range(n):
                dx += mass[i] * sine[i] * (speeds[i] - v[2 + i])
                dy -= mass[i] * cosine[i] * (speeds[i] - v[2 + i])
            change = max(abs(v[0] + dx - new[0]), abs(v[1] + dy - new[1]))
            for i in range(n):
                change = max(change, abs(speeds[i] - new[2 + i]))
            new[0], new[1] = v[0] + dx, v[1] + dy
            new[2:] = speeds
            if change < UNCHANGED:
                solved = sweeps > 0
                break
        results[UNSOLVED] += not solved
        results[LIFTED] += lifted
        middle[:] = 0.5 * (v + new)
        drag_x = middle[0] - scalars[OMEGA] * position[1]
        drag_y = middle[1] + scalars[OMEGA] * position[0]
        results[DAMPING_WORK] -= 2.0 * scalars[ZETA] * h * (middle[0] * drag_x + middle[1] * drag_y)
        fastest = 0.0
        for i in range(n):
            results[RING_WORK] -= mass[i] * p[i] * middle[2 + i]
            fastest = max(fastest, abs(new[2 + i]))
        for k in range(k_max):
            i, j = 2 + contacts[k, 0], 2 + contacts[k, 1]
            results[CONTACT_WORK] += P[k] * (middle[j] - middle[i])
            results[BALL_WORK] -= kappa[k] * q[k] * (middle[i] + middle[j])
        position += 0.5 * h * new + (weight - 0.5) * h * (new - v)
        v[:] = new
        still = still + h if fastest < STILL else 0.0
        if until_rest and still >= STILL_TIME and step % 100 == 0:
            state[2 + n :] = v
            if vibration(scalars, mass, state) < QUIET:
                done = step + 1
                break
    state[2 + n :] = v
    results[END_TIME] = done * h
    results[STILL_FOR] = still
    results[AT_REST] = still >= STILL_TIME
    if done < steps or tail == 0:
        speeds_out[:] = v[2:]  # at rest, or without a window
    else:
        speeds_out[:] = (position[2:] - angles_at_tail) / (tail * h)
