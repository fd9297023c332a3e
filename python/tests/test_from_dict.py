"""Studies from dictionaries: the same studies, and errors that name the path of the key."""

import itertools
from pathlib import Path

import numpy
import pandas
import polars
import pyarrow
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
    with pytest.raises(TypeError, match="keys: wrong type of a name\n  found:   1, a name of type int"):
        stickslip.Study.from_dict({1: 2})
    with pytest.raises(TypeError, match="model.parameters: wrong type of a name\n  found:   None, "):
        stickslip.Study.from_dict({**KEYS, "model": {"kind": "ball_balancer", "parameters": {None: 1}}})


def with_speeds(speeds):
    return {**KEYS, "sweep": [{"grid": {"speed_rad_s": speeds}}]}


def test_arrays_and_series_are_lists():
    speeds = [-160.0, -216.0]
    hashes = {
        stickslip.Study.from_dict(with_speeds(given)).hash
        for given in [
            speeds,
            numpy.array(speeds),
            pandas.Series(speeds),
            pandas.Series(speeds, index=[7, 8]),
            polars.Series(speeds),
            pyarrow.array(speeds),
            (speed for speed in speeds),
        ]
    }
    assert len(hashes) == 1
    assert stickslip.Study.from_dict(with_speeds(pandas.Series([-160.0]))).point_count == 1
    sweep = [{"zip": pandas.DataFrame({"speed_rad_s": speeds, "ball_mass_kg": [1e-4, 2e-4]})}]
    assert stickslip.Study.from_dict({**KEYS, "sweep": sweep}).point_count == 2


def test_scalars_of_numpy_keep_their_types():
    relative = {"amplitude_mean": {"relative": numpy.bool_(True)}}
    assert stickslip.Study.from_dict({**KEYS, "responses": {"vibration": relative}}).yaml == stickslip.Study.from_text(SMALL).yaml
    # Dataframes hold whole numbers as floats.
    assert stickslip.Study.from_dict({**KEYS, "seed": numpy.float64(5)}).seed == 5
    with pytest.raises(stickslip.StudyError, match="`seed`: wrong type"):
        stickslip.Study.from_dict({**KEYS, "seed": 5.5})
    with pytest.raises(stickslip.StudyError, match=r"`sweep\[0\].grid.speed_rad_s\[0\]`"):
        stickslip.Study.from_dict(with_speeds(numpy.array([True])))


@pytest.mark.parametrize(
    "value, problem",
    [
        (b"abc", "a value of type bytes"),
        ({-160, -216}, "a list, because a set has no order"),
        (numpy.array([-160 + 1j]), "a value of type complex"),
    ],
)
def test_types_that_are_easily_mistaken(value, problem):
    with pytest.raises(TypeError, match=rf"sweep\[0\].grid.speed_rad_s(?:\[0\])?: wrong type(?s:.*){problem}"):
        stickslip.Study.from_dict(with_speeds(value))


def test_values_without_an_end():
    """Python reports what would otherwise fill the stack or the memory."""
    loop = {"kind": "ball_balancer"}
    loop["parameters"] = loop
    deep = []
    for _ in range(100_000):
        deep = [deep]
    for keys in ({**KEYS, "model": loop}, {**KEYS, "sweep": deep}):
        with pytest.raises(stickslip.StudyError, match="nested too deeply\n  found:   more than 24 levels") as raised:
            stickslip.Study.from_dict(keys)
        assert raised.value.key.startswith(("model.parameters.parameters", "sweep[0][0]"))
    with pytest.raises(stickslip.StudyError, match="too many\n  found:   more, from a repeat"):
        stickslip.Study.from_dict(with_speeds(itertools.repeat(-160)))
    with pytest.raises(stickslip.StudyError, match="seed: out of range"):
        stickslip.Study.from_dict({**KEYS, "seed": 10**400})
    with pytest.raises(stickslip.StudyError, match="name: text that is not Unicode"):
        stickslip.Study.from_dict({**KEYS, "name": "\ud800"})
    with pytest.raises(stickslip.StudyError, match="keys: text that is not Unicode\n  found:   '.ud800'"):
        stickslip.Study.from_dict({**KEYS, "\ud800": 1})
    while deep:
        # Python's own end of a deep list needs the stack, too.
        deep = deep.pop()


def test_other_ways_to_a_study_are_named():
    for call in (lambda: stickslip.Study(KEYS), lambda: stickslip.Study("study.yaml"), lambda: stickslip.Study(path=1)):
        with pytest.raises(TypeError, match=r"Study\.from_yaml\(path\), Study\.from_text\(text\) or Study\.from_dict\(keys\)"):
            call()
    with pytest.raises(TypeError, match=r"tables: wrong type(?s:.*)a list of directories"):
        stickslip.Study.from_dict(KEYS, tables="folder")
    with pytest.raises(stickslip.StudyError, match="an existing directory in `tables`"):
        stickslip.Study.from_dict(KEYS, tables=["/nonexistent"])
    with pytest.raises(stickslip.StudyError, match="path: an empty path"):
        stickslip.Study.from_yaml("")


def test_tables_lie_in_the_folder(tmp_path):
    (tmp_path / "speeds.csv").write_text("speed_rad_s\n-160\n-170\n-180\n")
    keys = {**KEYS, "sweep": [{"table": Path("speeds.csv")}]}
    assert stickslip.Study.from_dict(keys, folder=tmp_path).point_count == 3
    with pytest.raises(stickslip.StudyError, match="speeds.csv"):
        stickslip.Study.from_dict(keys)
