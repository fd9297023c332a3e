"""Studies from dictionaries: the same studies, and errors that name the path of the key."""

from pathlib import Path

import numpy
import pytest
from conftest import SMALL

import stickslip

KEYS = {
    "schema": 1,
    "name": "small",
    "seed": 5,
    "model": {"kind": "ball_balancer"},
    "sweep": [{"grid": {"speed_rad_s": [-160.8103, -216.3772], "normal_force": ["lagrange", "newton"]}}],
    "uncertain": {"imbalance_mass_kg": {"uniform": {"min": 4.0e-5, "max": 7.0e-5}}},
    "initial_conditions": {"design": {"stratified": {"parts_per_axis": 1, "samples_per_cell": 24}}},
    "simulation": {"end_time_s": 6},
    "audit": {"fraction": 0.1},
    "design": {"friction_coefficient": {"from": 1.0e-3, "to": 3.0e-3}},
    "responses": {"vibration": {"amplitude_mean": {"relative": True}}},
}


def test_the_study_is_that_of_the_file():
    study, written = stickslip.Study.from_dict(KEYS), stickslip.Study.from_text(SMALL)
    assert (study.hash, study.yaml) == (written.hash, written.yaml)


def test_numbers_of_numpy_and_large_seeds():
    speeds = numpy.array([-160.8103, -216.3772])
    grid = {"speed_rad_s": speeds, "normal_force": ("lagrange", "newton")}
    study = stickslip.Study.from_dict({**KEYS, "seed": numpy.int64(5), "sweep": [{"grid": grid}]})
    assert study.hash == stickslip.Study.from_text(SMALL).hash
    assert stickslip.Study.from_dict({**KEYS, "seed": 2**64 - 1}).seed == 2**64 - 1


def test_units_are_text():
    model = {"kind": "ball_balancer", "parameters": {"speed": "-1500 rpm"}}
    study = stickslip.Study.from_dict({**KEYS, "model": model, "sweep": [{"grid": {"normal_force": ["newton"]}}]})
    in_radians = {"kind": "ball_balancer", "parameters": {"speed_rad_s": -1500 * numpy.pi / 30}}
    same = stickslip.Study.from_dict({**KEYS, "model": in_radians, "sweep": [{"grid": {"normal_force": ["newton"]}}]})
    assert study.run().runs["amplitude_m"] == pytest.approx(same.run().runs["amplitude_m"], nan_ok=True)


@pytest.mark.parametrize(
    "change, key, problem",
    [
        ({"sed": 5}, "sed", "unknown key"),
        ({"model": {"kind": "ball_balancer", "parameters": {"table_mas_kg": 1}}}, "model.parameters.table_mas_kg", ""),
        ({"sweep": [{"grid": {"speed_rad_s": ["fast"]}}]}, "sweep[0].grid.speed_rad_s[0]", ""),
        ({"simulation": {"end_time_s": None}}, "simulation.end_time_s", ""),
        ({"a: b\n": 1}, "a: b", "unknown key"),
    ],
)
def test_errors_name_the_path_of_the_key(change, key, problem):
    with pytest.raises(stickslip.StudyError) as raised:
        stickslip.Study.from_dict({**KEYS, **change})
    assert raised.value.file == "<dict>"
    assert key in raised.value.key and problem in raised.value.problem


def test_values_that_no_study_has():
    with pytest.raises(TypeError, match="model.kind: wrong type"):
        stickslip.Study.from_dict({**KEYS, "model": {"kind": object()}})
    with pytest.raises(stickslip.StudyError, match=r"sweep\[0\].grid.speed_rad_s: not a finite number"):
        stickslip.Study.from_dict({**KEYS, "sweep": [{"grid": {"speed_rad_s": float("nan")}}]})
    with pytest.raises(TypeError, match="a dict with the keys of a study file"):
        stickslip.Study.from_dict([KEYS])
    with pytest.raises(TypeError, match="a name of type int"):
        stickslip.Study.from_dict({1: 2})


def test_tables_lie_in_the_folder(tmp_path):
    (tmp_path / "speeds.csv").write_text("speed_rad_s\n-160\n-170\n-180\n")
    keys = {**KEYS, "sweep": [{"table": Path("speeds.csv")}]}
    assert stickslip.Study.from_dict(keys, folder=tmp_path).point_count == 3
    with pytest.raises(stickslip.StudyError, match="speeds.csv"):
        stickslip.Study.from_dict(keys)
