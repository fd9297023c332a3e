"""Known answers about impacts, contacts and start states, without the thesis's machine or in single steps of it."""

import math

import numpy as np
import pytest

import equations
import runs
import scheme
import starts
from machine import machine

FREE = {"damping_n_s_m": 0.0, "friction_coefficient": 0.0, "normal_force": "newton"}
TINY = 1e-9  # a step in which forces do nothing


def touching(one, beta, speeds, table=(0.0, 0.0)):
    """Returns a state of two balls in contact, ball 2 ahead of ball 1."""
    ahead = beta + starts.least_angle(*one.diameter) - 1e-12
    return np.array([0.01, -0.02, beta, ahead, *table, *speeds])


def impact(one, state, **law):
    """Returns the state after one step with an impact, and the numbers of the step."""
    options = runs.Options(map_starts=False, step=TINY, end_time_s=TINY / one.omega_n, until_rest=False, **law)
    made = runs.motion(one, state, options)
    assert made.results[scheme.UNSOLVED] == 0
    return made.end, made.results


def matrix(one, state):
    """Returns A of A_ij = (1 + 4 J) delta_ij - m_j cos(beta_i - beta_j)."""
    beta = state[2 : 2 + len(one.mass)]
    return 1.4 * np.eye(len(beta)) - one.mass * np.cos(beta[:, None] - beta)


def test_equal_balls_exchange_speeds():
    one = machine(2, FREE)
    worst = 0.0
    for before in ((0.5, -0.3), (0.9, 0.2), (0.4, 0.0)):
        after, results = impact(one, touching(one, 1.0, before), restitution=1.0)
        assert results[scheme.IMPACTS] == 1
        worst = max(worst, abs(after[6] - before[1]), abs(after[7] - before[0]))
    print(f"error of exchanged speeds {worst:.1e}")
    assert worst < 2e-9


def test_restitution_and_lost_energy():
    one = machine(2, FREE | {"ball_mass_2_kg": 3e-4, "ball_diameter_2_m": 4e-3})
    state = touching(one, 2.0, (0.5, -0.3), (0.02, 0.01))
    for restitution in (0.0, 0.36, 1.0):
        after, _ = impact(one, state, restitution=restitution)
        assert abs((after[7] - after[6]) - restitution * 0.8) < 1e-9
        direction = np.array([-1.0, 1.0])
        reduced = np.linalg.solve(one.mass[:, None] * matrix(one, state), direction)
        lost = 0.5 * (1.0 - restitution**2) * 0.8**2 / (direction @ reduced)
        error = equations.energy(one, state) - equations.energy(one, after) - lost
        print(f"restitution {restitution}: lost energy {lost:.6e}, error {error:.1e}")
        assert abs(error) < 1e-12


@pytest.mark.parametrize("balls", [2, 3, 8])
def test_momentum_of_table_and_balls(balls):
    """The impulses of an impact are internal: those of the contact, and those of the ring on the table."""
    values = FREE | {"ball_mass_2_kg": 3e-3, "table_mass_kg": 0.05, "ball_diameter_2_m": 2e-3}
    one = machine(balls, values)
    rng = np.random.default_rng(3)
    state = np.zeros(4 + 2 * balls)
    _, least = starts.neighbours(np.arange(balls), one.diameter)
    state[3 : 2 + balls] = np.cumsum(least)[:-1] - 1e-13
    state[4 + balls :] = np.sort(rng.uniform(-1.0, 1.0, balls))[::-1]  # every ball approaches the ball ahead
    after, results = impact(one, state, restitution=0.36, ball_friction=0.1)
    assert results[scheme.IMPACTS] == balls - 1
    jump = equations.momentum(one, after) - equations.momentum(one, state)
    table = complex(*after[2 + balls : 4 + balls]) - complex(*state[2 + balls : 4 + balls])
    print(f"{balls} balls: table's jump {abs(table):.2e}, change of momentum {abs(jump):.1e}")
    assert abs(table) > 1e-4 and abs(jump) < 1e-8


def test_friction_in_an_impact():
    """Sliding: the impulses on both balls, relative to the normal impulse, are -1 - s mu kappa and 1 - s mu kappa.
    Sticking: the sum of the speeds becomes zero, with less friction than in sliding."""
    one = machine(2, FREE)
    half = 0.5 * starts.least_angle(*one.diameter)
    kappa = 1.0 / math.cos(half) + math.tan(half)
    assert abs(kappa - 1.140) < 5e-4
    for sign in (1.0, -1.0):
        state = touching(one, 1.0, (0.9, 0.4) if sign > 0.0 else (-0.4, -0.9))
        after, _ = impact(one, state, restitution=0.36, ball_friction=0.1)
        impulses = one.mass * (matrix(one, state) @ (after[6:] - state[6:]))
        ratio = impulses[0] / impulses[1]
        assert abs(ratio - (-1.0 - sign * 0.1 * kappa) / (1.0 - sign * 0.1 * kappa)) < 1e-6
    after, _ = impact(one, touching(one, 1.0, (0.5, -0.48)), restitution=0.36, ball_friction=0.1)
    assert abs(after[6] + after[7]) < 1e-9


@pytest.mark.parametrize("friction", [True, False])
def test_energy_balance(friction):
    """The change of energy is the work of the dashpots, the ring's friction, the impacts and the friction in contacts.
    Without friction and with restitution 1, there is none over many impacts."""
    one = machine(3, {"ball_mass_2_kg": 3e-4} if friction else FREE | {"ball_mass_2_kg": 3e-4, "speed_rad_s": -100.0})
    law = {"ball_friction": 0.1} if friction else {"restitution": 1.0}
    state = np.array([0.03, -0.02, 0.5, 2.0, 4.5, 0.01, 0.03, 0.9, -0.8, -0.2])
    errors = []
    for step in (4e-3, 1e-3):
        made = runs.motion(one, state, runs.Options(step=step, end_time_s=1.0, until_rest=False, **law))
        assert made.results[scheme.UNSOLVED] == 0
        dashpots, *works = [made.results[kind] for kind in
                            (scheme.DAMPING_WORK, scheme.RING_WORK, scheme.CONTACT_WORK, scheme.BALL_WORK)]
        change = equations.energy(one, made.end) - equations.energy(one, made.start)
        if friction:
            assert max(works) < 0.0
            errors.append(abs(change - dashpots - sum(works)) / abs(sum(works)))
        else:
            assert made.results[scheme.IMPACTS] > 50
            errors.append(abs(change) / (0.5 * 1.4 * one.mass @ made.start[7:] ** 2))
    print("error of the balance over the work, or over the balls' kinetic energy: "
          + ", ".join(f"{error:.1e}" for error in errors))
    assert errors[-1] < (1e-4 if friction else 1e-3)


def test_start_states_do_not_overlap():
    rng = np.random.default_rng(1)
    for balls in range(1, 9):
        diameter = rng.uniform(0.1, 0.5, balls)
        for _ in range(200):
            beta = rng.uniform(0.0, 2.0 * math.pi, balls)
            order = starts.order_on_ring(beta)
            mapped = starts.apart(beta, diameter)
            assert mapped[0] == beta[0]
            pairs, angles = starts.neighbours(order, diameter)
            assert starts.gaps(mapped, pairs, angles).min(initial=1.0) > -1e-14
            assert (starts.order_on_ring(mapped) == order).all()
    nearly_full = np.full(8, 4.0 * math.sin(math.pi / 8) / 2.0 * 0.999)
    assert starts.apart(rng.uniform(0.0, 6.0, 8), nearly_full)[1] > 0.0
    with pytest.raises(ValueError, match="the balls need"):
        starts.apart(rng.uniform(0.0, 6.0, 8), nearly_full / 0.99)


def test_the_map_keeps_uniform_samples_uniform():
    """Two balls: the mapped offset is uniform between the least angle and 2 pi minus the least angle."""
    rng = np.random.default_rng(2)
    diameter = np.array([0.26, 0.26])
    least = starts.least_angle(*diameter)
    offsets = []
    for _ in range(4000):
        beta = starts.apart(rng.uniform(0.0, 2.0 * math.pi, 2), diameter)
        offsets.append((beta[1] - beta[0] - least) / (2.0 * math.pi - 2.0 * least))
    offsets = np.sort(offsets)
    distance = np.abs(offsets - np.linspace(0.0, 1.0, 4000)).max()
    print(f"Kolmogorov distance {distance:.4f}")
    assert distance < 1.63 / math.sqrt(4000)


def test_a_nearly_full_ring_keeps_its_order():
    one = machine(8, {"ball_diameter_m": 8.5e-3, "friction_coefficient": 1e-3})
    rng = np.random.default_rng(5)
    state = np.concatenate([np.zeros(2), rng.uniform(0.0, 6.28, 8), np.zeros(2), rng.uniform(-1.0, 1.0, 8)])
    options = runs.Options(ball_friction=0.1, step=2e-3, end_time_s=0.3, until_rest=False)
    made = runs.motion(one, state, options)
    print(f"{made.results[scheme.IMPACTS]:.0f} impacts, least gap {made.results[scheme.LEAST_GAP]:.1e}")
    assert made.results[scheme.IMPACTS] > 50 and made.results[scheme.UNSOLVED] == 0
    assert made.results[scheme.LEAST_GAP] > -4.0 * options.step
