"""Question 5: can a start of the disc make the positions of rest predictable?"""

import numpy as np

from . import statistics
from .cells import number, percent, table
from .statics import TOUCHING, uniform_rests
from .style import FORCES, Panel, lay_out, scatter

STUDIES = ("predictability-search", "predictability", "predictability-exact")
STARTS = ("plain ramp", "least vibration", "most rests", "selected")
PROFILE = ("ramp_to_1_rad_s", "ramp_over_2_s", "ramp_to_2_rad_s", "ramp_over_3_s")
#: Two runs end at the same place if their positions are nearer than this.
NEAR = np.pi / 6


def _coincidence(rests, runs):
    """The probability that two runs both come to rest, and within `NEAR` of each other, with a jackknife over runs."""
    near = np.zeros((runs, runs))
    near[: len(rests), : len(rests)] = statistics.apart(rests, rests) < NEAR
    return statistics.mean_of_pairs(near)


def selected(search):
    """The profile of the search whose runs coincide most often, on average over both normal forces."""
    found = {}
    for point in search.points("point_id", "runs", "normal_force", *PROFILE):
        profile = tuple(float(point[name]) for name in PROFILE)
        found.setdefault(profile, []).append(
            _coincidence(search.rests(point["point_id"]), int(point["runs"]))[0]
        )
    return max(found, key=lambda profile: sum(found[profile])), len(found)


def _measures(results):
    rows = []
    for place, point in enumerate(
        results.points("point_id", "runs", "equilibrium_runs", "normal_force", *PROFILE)
    ):
        rests, runs = results.rests(point["point_id"]), int(point["runs"])
        rows.append(
            {
                "start": STARTS[place % len(STARTS)],
                "force": point["normal_force"],
                "profile": tuple(float(point[name]) for name in PROFILE),
                "rests": rests,
                "rest": statistics.wilson(int(point["equilibrium_runs"]), runs),
                "same": _coincidence(rests, runs),
                "distance": statistics.mean_of_pairs(statistics.apart(rests, rests)),
                "cells": statistics.effective_cells(rests),
                "amplitude": statistics.bootstrap(results.amplitudes(point["point_id"]), np.median, 500),
                "worst": statistics.bootstrap(
                    results.amplitudes(point["point_id"]), lambda own: np.quantile(own, 0.95), 500
                ),
            }
        )
    return rows


def values(results):
    search, scattered, exact = (results[name] for name in STUDIES)
    best, profiles = selected(search)
    rows, numbers = [], {}
    for study, machine in ((scattered, "scatter"), (exact, "exact")):
        for one in _measures(study):
            if one["start"] == "selected" and one["profile"] != best:
                raise SystemExit(f"{study.study}: the selected start is {best}, not {one['profile']}")
            rows.append(
                [
                    machine,
                    one["start"],
                    one["force"],
                    percent(one["rest"], 1),
                    number(one["distance"], 2),
                    number(one["cells"], 1),
                    percent(one["same"], 1),
                    *(number(tuple(1e6 * v for v in one[name]), 1) for name in ("amplitude", "worst")),
                ]
            )
    draws = np.random.default_rng(statistics.SEED)
    anywhere = draws.uniform(0, 2 * np.pi, (1500, 2))
    anywhere = anywhere[statistics.turn(anywhere[:, 0] - anywhere[:, 1]) > TOUCHING]
    held = uniform_rests(-216.3772, 1000)[:, 2:]
    for name, places in (("any position", anywhere), ("any position of the set", held)):
        distances = statistics.apart(places, places)
        rows.append(
            [
                "",
                name,
                "",
                "",
                number(statistics.mean_of_pairs(distances), 2),
                number(statistics.effective_cells(places), 1),
                percent(statistics.mean_of_pairs((distances < NEAR) * 1.0), 1),
                "",
                "",
            ]
        )
    of = {one["force"]: one for one in _measures(scattered) if one["start"] == "selected"}
    plain = {one["force"]: one for one in _measures(scattered) if one["start"] == "plain ramp"}
    for force in FORCES:
        numbers[f"predictability-rest-{force}"] = percent(of[force]["rest"], 1)
        numbers[f"predictability-plain-{force}"] = percent(plain[force]["rest"], 1)
        numbers[f"predictability-same-{force}"] = percent(of[force]["same"], 1)
        numbers[f"predictability-amplitude-{force}"] = number(
            tuple(1e6 * v for v in of[force]["amplitude"]), 0
        )
        numbers[f"predictability-worst-{force}"] = number(tuple(1e6 * v for v in of[force]["worst"]), 0)
        numbers[f"predictability-plain-worst-{force}"] = number(
            tuple(1e6 * v for v in plain[force]["worst"]), 0
        )
        numbers[f"predictability-plain-amplitude-{force}"] = number(
            tuple(1e6 * v for v in plain[force]["amplitude"]), 0
        )
        numbers[f"predictability-distance-{force}"] = number(of[force]["distance"], 2)
    numbers["predictability-starts"] = number(profiles, 0)
    for name, value, digits in zip(("to-1", "over-2", "to-2", "over-3"), best, (0, 2, 0, 1)):
        numbers[f"predictability-{name}"] = number(abs(value), digits)
    head = [
        "machine",
        "start",
        "normal force",
        "at rest, %",
        "distance of two rests, rad",
        "effective cells",
        "two runs at one place, %",
        "median amplitude, µm",
        "95 % quantile, µm",
    ]
    return {"predictability": table(head, rows)}, numbers


def figure(results):
    panels = []
    for force in FORCES:
        for one in _measures(results["predictability"]):
            if one["force"] == force:
                panels.append(
                    Panel(scatter(one["rests"]), f"{one['start']}, {force}: {len(one['rests'])} rests", 1.0)
                )
    return lay_out(
        panels,
        columns=4,
        width="double",
        title="Rests after four starts of the disc",
        caption="Each dot is the position of rest of a run at -216.3772 rad/s, in both orders of the balls.",
        alternative="Eight panels: rests after four starts of the disc, with both normal forces.",
    )
