"""Intervals and tests. All intervals have a level of 95 %, and all random numbers a fixed seed."""

import math

import numpy as np

Z = 1.959963984540054
SEED = 5000


def wilson(count, total):
    """A fraction and Wilson's interval."""
    if total == 0:
        return math.nan, 0.0, 1.0
    fraction, square = count / total, Z * Z / total
    middle = fraction + square / 2
    half = Z * math.sqrt(fraction * (1 - fraction) / total + square / (4 * total))
    low = 0.0 if count == 0 else (middle - half) / (1 + square)
    high = 1.0 if count == total else (middle + half) / (1 + square)
    return fraction, low, high


def bootstrap(values, statistic, repeats=2000):
    """A statistic of independent rows, and the 2.5 and 97.5 % quantiles of its bootstrap."""
    values = np.asarray(values)
    if len(values) < 2:
        return math.nan, None, None
    draws = np.random.default_rng(SEED)
    found = [statistic(values[draws.integers(0, len(values), len(values))]) for _ in range(repeats)]
    low, high = np.quantile(found, [0.025, 0.975])
    return float(statistic(values)), float(low), float(high)


def fisher(first, of_first, second, of_second):
    """The two-sided p-value of Fisher's exact test that two fractions are equal."""
    total, successes = of_first + of_second, first + second

    def logarithm(count):
        def choose(n, k):
            return math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1)

        return choose(of_first, count) + choose(of_second, successes - count) - choose(total, successes)

    counts = range(max(0, successes - of_second), min(of_first, successes) + 1)
    every = np.exp([logarithm(count) for count in counts])
    return min(1.0, float(every[every <= math.exp(logarithm(first)) * (1 + 1e-9)].sum()))


def holm(p_values):
    """Holm's adjusted p-values of a family of tests; None stays None."""
    known = sorted((p, place) for place, p in enumerate(p_values) if p is not None)
    adjusted, largest = [None] * len(p_values), 0.0
    for rank, (p, place) in enumerate(known):
        largest = max(largest, min(1.0, (len(known) - rank) * p))
        adjusted[place] = largest
    return adjusted


def turn(angle):
    """The size of an angle modulo a turn, from 0 to π."""
    return np.abs((angle + np.pi) % (2 * np.pi) - np.pi)


def apart(first, second):
    """Distances between positions of two alike balls: root of the sum of the squares of the differences, for the
    exchange of the balls that makes it smaller."""
    one, other = first[:, None, :], second[None, :, :]
    straight = turn(one[..., 0] - other[..., 0]) ** 2 + turn(one[..., 1] - other[..., 1]) ** 2
    crossed = turn(one[..., 0] - other[..., 1]) ** 2 + turn(one[..., 1] - other[..., 0]) ** 2
    return np.sqrt(np.minimum(straight, crossed))


def _interval(estimate, variance):
    half = Z * math.sqrt(max(variance, 0.0))
    return float(estimate), float(estimate - half), float(estimate + half)


def _variance(left_out):
    count = len(left_out)
    return (count - 1) / count * float(((left_out - left_out.mean()) ** 2).sum())


def mean_of_pairs(values):
    """The mean of a symmetric matrix outside its diagonal, with the interval of a jackknife over rows."""
    count = len(values)
    if count < 3:
        return math.nan, None, None
    values = values - np.diag(np.diag(values))
    rows = values.sum(1)
    left_out = (rows.sum() - 2 * rows) / ((count - 1) * (count - 2))
    return _interval(rows.sum() / (count * (count - 1)), _variance(left_out))


def energy(first, second, permutations=9999):
    """Compares two samples of positions: the coefficient of the energy distance with the interval of a jackknife, and
    the p-value of a permutation test.

    The coefficient is 0 for equal distributions and 1 for two different points. It is an unbiased estimate divided by
    the mean distance between the samples, and may therefore be slightly negative."""
    n, m = len(first), len(second)
    if min(n, m) < 5:
        return (math.nan, None, None), None
    both = apart(np.concatenate([first, second]), np.concatenate([first, second]))

    def coefficient(within_first, within_second, between):
        return 1 - (within_first + within_second) / (2 * between)

    xx, yy, xy = both[:n, :n], both[n:, n:], both[:n, n:]
    within_x, within_y, between = xx.sum(), yy.sum(), xy.sum()
    value = coefficient(within_x / (n * (n - 1)), within_y / (m * (m - 1)), between / (n * m))
    without_x = coefficient(
        (within_x - 2 * xx.sum(1)) / ((n - 1) * (n - 2)),
        within_y / (m * (m - 1)),
        (between - xy.sum(1)) / ((n - 1) * m),
    )
    without_y = coefficient(
        within_x / (n * (n - 1)),
        (within_y - 2 * yy.sum(1)) / ((m - 1) * (m - 2)),
        (between - xy.sum(0)) / (n * (m - 1)),
    )
    draws = np.random.default_rng(SEED)
    chosen = np.zeros((permutations, n + m))
    for row in chosen:
        row[draws.permutation(n + m)[:n]] = 1
    within_first = ((chosen @ both) * chosen).sum(1)
    within_second = (((1 - chosen) @ both) * (1 - chosen)).sum(1)
    across = (both.sum() - within_first - within_second) / 2
    permuted = coefficient(within_first / (n * (n - 1)), within_second / (m * (m - 1)), across / (n * m))
    p = (1 + int((permuted >= value - 1e-12).sum())) / (1 + permutations)
    return _interval(value, _variance(without_x) + _variance(without_y)), p


def _entropy(counts):
    shares = counts[counts > 0] / counts.sum()
    return -float((shares * np.log(shares)).sum())


def effective_cells(positions, parts=12):
    """The exponential of the entropy of positions over pairs of equal arcs, in any order, with the interval of a
    jackknife, which also removes most of the bias of small samples."""
    count = len(positions)
    if count < 20:
        return math.nan, None, None
    arcs = np.sort(np.minimum((positions / (2 * np.pi / parts)).astype(int), parts - 1), axis=1)
    cells, inverse, counts = np.unique(
        arcs[:, 0] * parts + arcs[:, 1], return_inverse=True, return_counts=True
    )
    entropy = _entropy(counts)
    less = np.empty(len(cells))
    for place in range(len(cells)):
        fewer = counts.copy()
        fewer[place] -= 1
        less[place] = _entropy(fewer)
    left_out = less[inverse]
    value, low, high = _interval(count * entropy - (count - 1) * left_out.mean(), _variance(left_out))
    return math.exp(value), math.exp(low), math.exp(high)
