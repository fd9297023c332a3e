"""Question 3: how much slower do contact, runout and tolerances make the limit cycles?"""

import numpy as np

from . import statistics
from .cells import number, table
from .style import DASHES, FORCES, MARKS, SERIES, Panel, lay_out, speed

STUDIES = ("cycle-speed-no-contact", "cycle-speed", "cycle-tolerances")
SPEEDS = (-247.3, -309.15)
TOLERATED = {
    "stiffness_n_m": "stiffness",
    "table_mass_kg": "mass of the table",
    "ball_mass_kg": "mass of the balls",
    "imbalance_mass_kg": "imbalance",
    "damping_n_s_m": "damping",
    "ring_radius_m": "radius of the ring",
}
DEFAULT_CONTACT, DEFAULT_FRICTION = 0.1, 2.75e-3


def _mean(run):
    return (run["ball_speed_1_rad_s"] + run["ball_speed_2_rad_s"]) / 2


def _runs(results, name, *columns):
    wanted = ("normal_force", "speed_rad_s", "label", "ball_speed_1_rad_s", "ball_speed_2_rad_s", *columns)
    read = results[name].read("runs", *wanted)
    return [dict(zip(read, row)) for row in zip(*read.values())]


def _speeds(results):
    """Mean speeds of the balls by normal force and speed of the disc, for each change of the machine."""
    reference = {(run["normal_force"], run["speed_rad_s"]): _mean(run) for run in _runs(results, STUDIES[0])}
    factors = (
        "contact_friction_coefficient",
        "ring_runout_m",
        "ring_runout_angle_rad",
        "friction_coefficient",
    )
    found = {}
    for run in _runs(results, STUDIES[1], *factors):
        key = (run["normal_force"], run["speed_rad_s"])
        contact, runout, angle, friction = (float(run[name]) for name in factors)
        if runout > 0:
            what = ("runout", runout, round(angle, 3))
        elif friction != DEFAULT_FRICTION:
            what = ("friction", friction)
        else:
            what = ("contact", contact)
        # A machine without a limit cycle has no speed.
        found.setdefault(what, {})[key] = np.nan if run["label"] == "equilibrium" else _mean(run)
    return reference, found


def _tolerances(results):
    """Mean speeds of the balls and drawn parameters of the runs that move, by normal force and speed of the disc."""
    found = {}
    for run in _runs(results, STUDIES[2], *TOLERATED):
        if run["label"] not in ("equilibrium", "failed"):
            found.setdefault((run["normal_force"], run["speed_rad_s"]), []).append(
                (_mean(run), *(float(run[name]) for name in TOLERATED))
            )
    return {key: np.array(rows) for key, rows in found.items()}


def _slopes(rows):
    """Changes of the mean speed in rad/s per percent of each parameter, by least squares."""
    relative = 100 * (rows[:, 1:] / rows[:, 1:].mean(axis=0) - 1)
    design = np.column_stack([np.ones(len(rows)), relative])
    return np.linalg.lstsq(design, rows[:, 0], rcond=None)[0][1:]


def values(results):
    reference, found = _speeds(results)
    tolerances = _tolerances(results)
    keys = [(force, at) for at in SPEEDS for force in FORCES]
    base = found[("contact", DEFAULT_CONTACT)]
    rows = [
        ["without contact, side by side: mean speed, rad/s", *(number(reference[key], 2) for key in keys)],
        ["with contact, μ_b = 0.1: mean speed, rad/s", *(number(base[key], 2) for key in keys)],
    ]

    def change(words, own, against):
        changes = [own[key] - against[key] for key in keys]
        rows.append([words, *("comes to rest" if np.isnan(one) else number(one, 2) for one in changes)])

    for coefficient in (0.0, 0.05, 0.1, 0.15, 0.3):
        what = found[("contact", coefficient)]
        change(f"contact, μ_b = {coefficient:g}: change by contact", what, reference)
    for runout in (1e-5, 3e-5, 1e-4):
        of = [what for what in found if what[0] == "runout" and what[1] == runout]
        slowest = {key: min(found[what][key] for what in of) for key in keys}
        change(f"runout {1e6 * runout:.0f} µm, slowest of four directions: change", slowest, base)
    for friction in (1.4e-3, 4e-3, 5.5e-3):
        change(
            f"friction of the ring {friction:g} instead of {DEFAULT_FRICTION:g}: change",
            found[("friction", friction)],
            base,
        )
    numbers = {}
    spread = []
    for key in keys:
        own = tolerances[key][:, 0]
        # The limits are those of 95 % of the machines.
        low, middle, high = np.quantile(own - base[key], [0.025, 0.5, 0.975])
        spread.append(number((middle, low, high), 2))
    rows.append(["tolerances: change, median and range of 95 % of the machines", *spread])
    slopes = {key: [] for key in keys}
    for place, words in enumerate(TOLERATED.values()):
        cells = []
        for key in keys:
            estimate = statistics.bootstrap(
                tolerances[key], lambda own, place=place: _slopes(own)[place], 500
            )
            slopes[key].append(estimate)
            cells.append(number(estimate, 3))
        rows.append([f"{words} 1 % larger: change", *cells])
    for force in FORCES:
        key = (force, -247.3)
        contact = found[("contact", DEFAULT_CONTACT)][key] - reference[key]
        numbers[f"cycles-contact-{force}"] = number(-contact, 2)
        numbers[f"cycles-contact-309-{force}"] = number(
            -(base[(force, -309.15)] - reference[(force, -309.15)]), 2
        )
        numbers[f"cycles-relative-{force}"] = number(-100 * contact / reference[key], 2)
        numbers[f"cycles-stiffness-{force}"] = number(
            tuple(-one for one in np.array(slopes[key][0])[[0, 2, 1]]), 2
        )
        low, high = np.quantile(tolerances[key][:, 0] - base[key], [0.025, 0.975])
        numbers[f"cycles-tolerance-{force}"] = number((high - low) / 2, 2)
        numbers[f"cycles-model-{force}"] = number(reference[key], 2)
    head = ["", *(f"{at:.2f} rad/s, {force}" for force, at in keys)]
    return {"cycles": table(head, rows)}, numbers


def figure(results):
    reference, found = _speeds(results)
    tolerances = _tolerances(results)
    base = found[("contact", DEFAULT_CONTACT)]
    panels = []
    coefficients = sorted(what[1] for what in found if what[0] == "contact")
    for at in SPEEDS:

        def draw(axes, at=at):
            for place, force in enumerate(FORCES):
                key = (force, at)
                axes.plot(
                    coefficients,
                    [found[("contact", one)][key] for one in coefficients],
                    color=SERIES[place],
                    marker=MARKS[place],
                    label=f"contact, {force}",
                )
                axes.axhline(
                    reference[key], color=SERIES[place], linestyle=DASHES[1], label=f"no contact, {force}"
                )
                low, high = np.quantile(tolerances[key][:, 0], [0.025, 0.975])
                axes.fill_between([0.09, 0.11], low, high, color=SERIES[place], alpha=0.25, linewidth=0)
            axes.set_xlabel("friction between balls μ_b")
            axes.set_ylabel("mean speed of the balls [rad/s]")

        panels.append(Panel(draw, speed(at), 0.75))
    for at in SPEEDS:

        def draw_changes(axes, at=at):
            named = [
                ("contact, μ_b = 0", ("contact", 0.0)),
                ("contact, μ_b = 0.1", ("contact", 0.1)),
                ("contact, μ_b = 0.3", ("contact", 0.3)),
                ("runout 30 µm", ("runout", 3e-5, round(np.pi, 3))),
                ("runout 100 µm", ("runout", 1e-4, round(np.pi, 3))),
                ("friction 1.4e-3", ("friction", 1.4e-3)),
                ("friction 4e-3", ("friction", 4e-3)),
            ]
            for place, force in enumerate(FORCES):
                key = (force, at)
                changes = [
                    found[what][key] - (reference[key] if what[0] == "contact" else base[key])
                    for _, what in named
                ]
                rows = np.arange(len(named)) + 0.2 * (2 * place - 1)
                axes.barh(rows, changes, height=0.36, color=SERIES[place])
                low, high = np.quantile(tolerances[key][:, 0] - base[key], [0.025, 0.975])
                axes.barh(
                    [len(named) + 0.2 * (2 * place - 1)],
                    [high - low],
                    left=[low],
                    height=0.36,
                    color=SERIES[place],
                )
            axes.axvline(0, color="black", linewidth=0.6)
            axes.set_yticks(range(len(named) + 1), [words for words, _ in named] + ["tolerances"])
            axes.invert_yaxis()
            axes.set_xlabel("change of the mean speed [rad/s]")

        panels.append(Panel(draw_changes, f"{speed(at)}: changes", 0.75))
    return lay_out(
        panels,
        columns=2,
        width="double",
        title="Speed of the limit cycles",
        caption="Above: mean speed of both balls relative to the ring over the friction between balls; dashed: the "
        "thesis's model, in which the balls run side by side; bands at 0.1: 95 % of the machines within their "
        "tolerances. Below: change of this speed, by contact from the thesis's model, by the other factors from "
        "contact with μ_b = 0.1.",
        alternative="Four panels: mean speeds at both speeds of the disc, and their changes.",
    )
