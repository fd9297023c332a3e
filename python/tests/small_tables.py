"""Small tables as the program writes them, for tests of what figures show."""

import json

import numpy as np
import pyarrow
import pyarrow.parquet

HASH = "0" * 64
LABELS = ("equilibrium", "limit_cycle", "periodic", "creep", "quasi_periodic", "irregular", "undecided", "failed")
PARAMETERS = """\
model:
  kind: ball_balancer
  parameters:
    table_mass_kg: 0.324
    stiffness_n_m: 10700.0
    damping_n_s_m: 1.28
    imbalance_mass_kg: 0.000056
    imbalance_radius_m: 0.037
    balls: 2
    ball_mass_kg: 0.00014
    speed_rad_s: -216.3772
simulation:
  end_time_s: 16.5
"""
UNITS = {
    "speed_rad_s": "rad/s",
    "friction_coefficient": "1",
    "contact_friction_coefficient": "1",
    "ball_mass_kg": "kg",
    "initial_beta_1": "rad",
    "initial_beta_2": "rad",
}


def write(folder, name, columns, options=None, study_hash=HASH):
    """Writes a table with units and provenance; `columns` are lists by name."""
    fields, arrays = [], []
    for column, values in columns.items():
        array = pyarrow.array(values)
        if column in ("label", "kind", "stability"):
            array = array.dictionary_encode()
        metadata = {"unit": UNITS[column]} if column in UNITS else None
        fields.append(pyarrow.field(column, array.type, metadata=metadata))
        arrays.append(array)
    about = {"study": "small", "study_hash": study_hash, "version": "0.1.0", "study_yaml": PARAMETERS}
    about["options"] = options or {}
    schema = pyarrow.schema(fields, metadata={"stickslip": json.dumps(about)})
    path = folder / f"{name}.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    pyarrow.parquet.write_table(pyarrow.table(arrays, schema=schema), path)
    return path


def equilibria(folder, side=64, parts=1, study_hash=HASH, samples=None):
    """The set `cos(β₁ - β₂) <= 0` with the amplitude 10 µm (1 + cos β₁ cos β₂), at two points of a sweep."""
    angles = np.arange(side) * 2 * np.pi / side
    first, second = (grid.ravel() for grid in np.meshgrid(angles, angles, indexing="ij"))
    both = {"beta_1_rad": np.tile(first, 2), "beta_2_rad": np.tile(second, 2)}
    columns = {
        "point_id": np.repeat([0, 1], side * side),
        "speed_rad_s": np.repeat([-200.0, -210.0], side * side),
        **both,
        "amplitude_m": 1e-5 * (1 + np.cos(both["beta_1_rad"]) * np.cos(both["beta_2_rad"])),
        "friction_margin": -np.cos(both["beta_1_rad"] - both["beta_2_rad"]),
    }
    options = {"samples": samples}
    if parts == 1:
        write(folder, "equilibrium_positions", columns, options, study_hash)
    else:
        for part, rows in enumerate(np.array_split(np.arange(2 * side * side), parts)):
            some = {name: values[rows] for name, values in columns.items()}
            write(folder / "equilibrium_positions.parquet", f"part-{part:05}", some, options, study_hash)
    write(
        folder,
        "equilibrium_set_summary",
        {
            "point_id": [0, 1],
            "speed_rad_s": [-200.0, -210.0],
            "grid_positions": [side * side] * 2,
            "fraction": [0.5, 0.5],
            "amplitude_max_m": [2e-5, 2e-5],
            "amplitude_without_balls_m": [2e-5, 1.2e-5],
        },
        options,
        study_hash,
    )
    write(
        folder,
        "frictionless_equilibria",
        {
            "point_id": [0, 0, 1],
            "speed_rad_s": [-200.0, -200.0, -210.0],
            "kind": ["b1", "a1_plus", "b1"],
            "stability": ["stable", "unstable", "stable"],
            "beta_1_rad": [2.0, 3.0, 2.5],
            "beta_2_rad": [4.0, 3.0, 3.5],
        },
        options,
        study_hash,
    )
    return folder


#: Inferred parameters: the range of the prior, whether its spacing is logarithmic, and the interval.
INFERRED = {
    "friction_coefficient": (1e-3, 6e-3, True, (2e-3, 4e-3)),
    "contact_friction_coefficient": (0.0, 0.3, False, (0.01, 0.29)),
    "ball_mass_kg": (1e-4, 2e-4, False, (1.2e-4, 1.4e-4)),
}


def identification(folder, parameters=2, balls=2, stages=1):
    """An inference: samples that fill the intervals evenly, and two points; the second has two moving runs.

    At both points, two runs were measured at rest. Four runs are predicted, and one of these moves.
    """
    names = list(INFERRED)[:parameters]
    shares = np.arange(1000) / 999
    samples, found, listed = {}, [], {}
    for place, name in enumerate(names):
        low, high, logarithmic, (first, last) = INFERRED[name]
        share = shares if place == 0 else np.roll(shares[::-1], 250 * place)
        samples[name] = (first + share * (last - first)).tolist()
        listed[name] = {"from": low, "to": high, **({"spacing": "logarithmic"} if logarithmic else {})}
        middle = (first + last) / 2
        identified = last - first < 0.8 * (high - low)
        facts = {"parameter": name, "unit": UNITS[name], "prior": [low, high], "median": middle}
        found.append({**facts, "low": first, "high": last, "identified": identified})
    about = {"identify": {"parameters": listed}}
    write(folder, "posterior", samples, about)
    sites = [(point, stage) for point in (0, 1) for stage in range(1, stages + 1)]
    points_of, stages_of = ([site[place] for site in sites] for place in (0, 1))
    swept = {"speed_rad_s": [-160.0 - 40 * point for point in points_of]}
    columns = {"point_id": points_of, **swept, "stage": stages_of, "measured_rests": [2] * len(sites)}
    columns["measured_moving"] = [2 * point for point in points_of]
    columns["predicted_rest_fraction"] = [0.75] * len(sites)
    columns["p_value"] = [0.5 - 0.498 * point for point in points_of]
    write(folder, "fit", columns, about)
    rows = []
    for point, stage in sites:
        moving = [("measured", point, stage, None)] * (2 * point) + [("predicted", point, stage, None)]
        seen = [("measured", place) for place in (1.0, 4.0)] + [("predicted", 2.0 + k) for k in range(3)]
        rows += [(source, point, stage, place + point) for source, place in seen] + moving
    names = ("source", "point_id", "stage", "at_rest")
    columns = {name: [row[place] for row in rows] for place, name in enumerate(names[:3])}
    columns["at_rest"] = [row[3] is not None for row in rows]
    for ball in range(balls):
        # The angles of later balls are smaller, and the last ones are below 0.
        places = [None if row[3] is None else row[3] - 1.5 * ball for row in rows]
        columns[f"beta_{ball + 1}_rad"] = pyarrow.array(places, pyarrow.float64())
    write(folder, "positions", columns, about)
    summary = {"parameters": found, "fit": {"p_value": 0.004, "rejected": True}}
    summary["correlations"] = (
        np.corrcoef([samples[name] for name in samples]).reshape(parameters, -1).tolist()
    )
    (folder / "identification.json").write_text(json.dumps(summary))
    return folder
