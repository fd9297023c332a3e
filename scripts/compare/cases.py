"""The cases of a workload: machine and start states, expanded from the study by the program."""

import csv
import io
import math
import subprocess
from dataclasses import dataclass
from pathlib import Path

import yaml

COORDINATES = ("x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2")


@dataclass
class Work:
    """A workload that every tool computes."""

    name: str
    study: Path  # a study with exactly these cases, for the program
    one: Path  # a study with only the first case
    cases: Path  # these cases as numbers, for the peers
    smooth: bool  # no dry friction: no events, errors of final states count
    contact: bool  # balls touch
    ramp: bool  # the speed of the disc rises
    relative: float  # the study's tolerance
    absolute: float
    end_time: float  # non-dimensional
    runs: int


def prepare(stickslip, study, runs, folder):
    """Writes the cases of `runs` runs of a study into a folder, as a study and as numbers.

        With fewer runs than the study has, the cases are every n-th case of the study; with more, each cell has more
        samples.
        """
    text = yaml.safe_load(Path(study).read_text())
    design = text["initial_conditions"]["design"]["stratified"]
    cells = design["parts_per_axis"] ** len(COORDINATES)
    design["samples_per_cell"] = math.ceil(runs / cells)
    whole = folder / f"{text['name']}-all.yaml"
    whole.write_text(yaml.safe_dump(text))
    states = expanded(stickslip, whole)
    states = [states[i * len(states) // runs] for i in range(runs)]

    name = text["name"]
    selected = with_states(text, states, folder / f"{name}.yaml")
    one = with_states(text, states[:1], folder / f"{name}-one.yaml")
    resolved = resolve(stickslip, one, folder)
    model, simulation = resolved["model"], resolved["simulation"]
    numbers, natural = without_dimensions(model)
    end_time = simulation["end_time_s"] * natural
    cases = folder / f"{name}.txt"
    lines = [numbers + [end_time, runs], *states]
    cases.write_text("".join(" ".join(str(value) for value in line) + "\n" for line in lines))
    tolerance = simulation["tolerance"]
    return Work(
        name=name,
        study=selected,
        one=one,
        cases=cases,
        smooth=model["friction"] != "coulomb",
        contact=model["contact"] != "none",
        ramp=bool(model.get("speed_profile")),
        relative=float(tolerance["relative"]),
        absolute=float(tolerance["absolute"]),
        end_time=end_time,
        runs=runs,
    )


def with_states(text, states, study):
    """Writes a study with these start states."""
    table = study.with_suffix(".csv")
    with table.open("w", newline="") as file:
        csv.writer(file).writerows([COORDINATES, *states])
    text["initial_conditions"]["design"] = {"table": table.name}
    study.write_text(yaml.safe_dump(text))
    return study


def expanded(stickslip, study):
    """Returns start states in the program's notation, whose decimals give exactly the program's numbers."""
    written = subprocess.run(
        [stickslip, "expand", study], check=True, capture_output=True, text=True
    ).stdout
    rows = csv.DictReader(io.StringIO(written))
    return [[row[f"initial_{name}"] for name in COORDINATES] for row in rows]


def resolve(stickslip, study, folder):
    """Returns the study with all defaults, which the program writes to its results."""
    results = folder / f"{study.stem}-resolved"
    command = [stickslip, "run", study, "--quiet", "--out", results]
    subprocess.run(command, check=True)
    return yaml.safe_load((results / "study.yaml").read_text())


def without_dimensions(model):
    """Returns the dimensionless machine (lengths over L, times times omega_n, masses over the total mass): speed,
        damping ratio, imbalance, ball mass, diameter, inertia, friction coefficient, viscous drag, rolling term (1 or
        0), those of the ramp and of the contact; and the natural frequency in rad/s."""
    given = {name: value for name, value in model["parameters"].items()}
    if given["balls"] != 2:
        raise SystemExit("compare: the peers support two identical balls only")
    total = given["table_mass_kg"] + given["imbalance_mass_kg"] + 2 * given["ball_mass_kg"]
    natural = math.sqrt(given["stiffness_n_m"] / total)
    radius = given["ring_radius_m"]
    friction, coefficient, drag = model["friction"], given["friction_coefficient"], 0.0
    if friction != "coulomb":
        coefficient = 0.0
        drag = friction["viscous"]["viscous_coefficient_n_s_m"] / (given["ball_mass_kg"] * natural)
    numbers = [
        given["speed_rad_s"] / natural,
        given["damping_n_s_m"] / (2 * total * natural),
        given["imbalance_mass_kg"] / total * given["imbalance_radius_m"] / radius,
        given["ball_mass_kg"] / total,
        given["ball_diameter_m"] / radius,
        0.1,
        coefficient,
        drag,
        1.0 if model["normal_force"] == "lagrange" else 0.0,
        *ramp(model, natural),
        *contact(model, given["ball_diameter_m"] / radius),
    ]
    return numbers, natural


def ramp(model, natural):
    """Returns acceleration and duration of the ramp with which the disc starts, without dimensions; zeros without one."""
    profile = model.get("speed_profile")
    if not profile:
        return 0.0, 0.0
    first, *others = (part["ramp"] for part in profile if "ramp" in part)
    if others or len(profile) != 1:
        raise SystemExit("compare: the peers support a single ramp only")
    change = model["parameters"]["speed_rad_s"] - first["from_rad_s"]
    return change / first["over_s"] / natural**2, first["over_s"] * natural


def contact(model, diameter):
    """Returns the angle at which two balls touch, restitution, and the friction coefficient of two balls; zeros without
        contact."""
    law = model["contact"]
    if law == "none":
        return 0.0, 0.0, 0.0
    return 2.0 * math.asin(0.5 * diameter), law["restitution"], law["friction_coefficient"]
