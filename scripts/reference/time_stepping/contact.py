"""One step's nonlinear complementarity problem: ring friction, contacts between balls, and friction in the contacts.

The unknowns of a step are impulses in the direction of the ring: p_i of the friction between the ring and ball i, over
its mass; P_k >= 0 of the normal force in contact k between the ball behind (i) and the ball ahead (j); and q_k of the
friction in that contact. With the speeds u after the step and S of `equations.response`

    u = u_free + S G,    G_i gains -m_i p_i,   -P_k - kappa_k q_k if i is behind,   +P_k - kappa_k q_k if i is ahead

    p_i in mu_i N_i / m_i Sgn(u_i)                          Coulomb's law on the ring, with the normal impulse N_i
    0 <= P_k  perpendicular to  u_j - u_i + e g_k >= 0      Newton's law of impact, with the gap's speed g_k before
    q_k in mu_b P_k Sgn(u_i + u_j)                          Coulomb's law in the contact

kappa = 1 / cos(D / 2) + tan(D / 2) and D is the angle between touching balls. Both balls roll in the same sense, so that
their surfaces slide on each other with a speed proportional to u_i + u_j. The contact presses both balls on the ring: N_i
gains tan(D / 2) P_k - q_k if i is behind, and tan(D / 2) P_k + q_k if i is ahead. Sgn(0) is the interval [-1, 1].

The solver is projected Gauss-Seidel with warm start (M. Jean 1999, doi:10.1016/S0045-7825(98)00383-1).
"""

import numba as nb

SWEEPS = 5000
SOLVED = 1e-13  # change of all speeds in one sweep
STICKS = 1e-12  # a smaller speed is a rounding error of a ball that sticks


@nb.njit(error_model="numpy")
def limited(value, limit):
    return min(max(value, -limit), limit)


@nb.njit(error_model="numpy")
def push(speeds, S, ball, impulse):
    """Adds the effect of an impulse on one ball to all speeds."""
    for i in range(len(speeds)):
        speeds[i] += S[i, ball] * impulse


@nb.njit(error_model="numpy")
def ring_normals(static, table, mass, sine, cosine, before, speeds, contacts, tangent, P, q, out):
    """Fills `out` with the normal impulses of the ring on the balls. `table` is the table's change of velocity at
    constant ball speeds. A ball that the impulses lift off the ring has a normal impulse of zero."""
    dx, dy = table
    for i in range(len(mass)):
        dx += mass[i] * sine[i] * (speeds[i] - before[i])
        dy -= mass[i] * cosine[i] * (speeds[i] - before[i])
    for i in range(len(mass)):
        out[i] = mass[i] * (static[i] - cosine[i] * dx - sine[i] * dy)
    for k in range(len(contacts)):
        out[contacts[k, 0]] += tangent[k] * P[k] - q[k]
        out[contacts[k, 1]] += tangent[k] * P[k] + q[k]
    lifted = False
    for i in range(len(mass)):
        if out[i] < 0.0:
            out[i] = 0.0
            lifted = True
    return lifted


@nb.njit(error_model="numpy")
def solve(S, before, speeds, mass, friction, normals, fixed_normals, static, table, sine, cosine,
          contacts, tangent, kappa, active, bounce, ball_friction, p, P, q):
    """Solves the problem of one step. Speeds begin as u_free and end as the speeds after the step; p, P and q begin as
    a guess. `bounce` is e g_k. If `fixed_normals`, the ring's normal impulses are those in `normals` and do not follow the
    contacts.

    Returns the number of sweeps, negative if they did not converge, and whether a ball lifts off the ring.
    """
    n = len(mass)
    for i in range(n):
        push(speeds, S, i, -mass[i] * p[i])
    for k in range(len(contacts)):
        if not active[k]:
            P[k] = 0.0
            q[k] = 0.0
        push(speeds, S, contacts[k, 0], -P[k] - kappa[k] * q[k])
        push(speeds, S, contacts[k, 1], P[k] - kappa[k] * q[k])
    lifted = False
    for sweep in range(SWEEPS):
        change = 0.0
        if not fixed_normals:
            lifted = ring_normals(static, table, mass, sine, cosine, before, speeds, contacts, tangent, P, q, normals)
        for k in range(len(contacts)):
            if not active[k]:
                continue
            i, j = contacts[k, 0], contacts[k, 1]
            stiff = S[i, i] + S[j, j] - S[i, j] - S[j, i]
            apart = speeds[j] - speeds[i] + bounce[k]
            new = max(0.0, P[k] - apart / stiff)
            if new != P[k]:
                change = max(change, abs(new - P[k]) * stiff)
                push(speeds, S, i, P[k] - new)
                push(speeds, S, j, new - P[k])
                P[k] = new
            if ball_friction > 0.0:
                stiff = kappa[k] * (S[i, i] + S[j, j] + S[i, j] + S[j, i])
                new = limited(q[k] + (speeds[i] + speeds[j]) / stiff, ball_friction * P[k])
                if new != q[k]:
                    change = max(change, abs(new - q[k]) * stiff)
                    push(speeds, S, i, kappa[k] * (q[k] - new))
                    push(speeds, S, j, kappa[k] * (q[k] - new))
                    q[k] = new
        for i in range(n):
            new = limited(p[i] + speeds[i] / (mass[i] * S[i, i]), friction[i] * normals[i] / mass[i])
            if new != p[i]:
                change = max(change, abs(new - p[i]))
                push(speeds, S, i, mass[i] * (p[i] - new))
                p[i] = new
        if change < SOLVED:
            for i in range(n):
                if abs(speeds[i]) < STICKS:
                    speeds[i] = 0.0
            return sweep + 1, lifted
    return -SWEEPS, lifted
