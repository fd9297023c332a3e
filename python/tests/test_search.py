"""Optimisations, inferences and checks: the results of the program."""

import csv
import json
import warnings

import polars
import pytest
from conftest import ROOT, SMALL, assert_same

import stickslip

# One half swing of a block on a spring is the shortest stop (tests/cli/optimize.rs).
BLOCK = {
    "schema": 1,
    "name": "block",
    "seed": 1,
    "model": {"kind": "block_on_spring"},
    "initial_conditions": {"box": {"position_m": [0.045, 0.045]}, "design": {"monte_carlo": {"samples": 1}}},
    "simulation": {"method": "event"},
    "design": {"stiffness_n_m": {"from": 30, "to": 200}},
    "responses": {"stop": "median_time_to_rest", "soon": {"at_rest_by_s": 0.5}},
    "optimize": {"minimize": "stop", "designs": 12},
}

IDENTIFY = {
    "schema": 1,
    "name": "small",
    "seed": 3,
    "model": {"kind": "ball_balancer"},
    "sweep": [{"grid": {"speed_rad_s": [-140]}}],
    "initial_conditions": {"design": {"monte_carlo": {"samples": 12}}},
    "simulation": {"endings": "rest"},
    "identify": {
        "parameters": {"friction_coefficient": {"from": 1.0e-3, "to": 6.0e-3, "spacing": "logarithmic"}},
        "start_designs": 8,
        "designs": 9,
        "posterior_samples": 200,
    },
}


@pytest.fixture(scope="module")
def measured():
    """The measurements of the shipped table at the speed of the study."""
    with (ROOT / "studies/rests.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if float(row["speed_rad_s"]) == -140]
    return [{name: float(value) for name, value in row.items()} for row in rows[:10]]


def test_an_optimisation_is_that_of_the_program(program, tmp_path):
    study = stickslip.Study.from_dict(BLOCK)
    (tmp_path / "block.yaml").write_text(study.yaml)
    program("optimize", tmp_path / "block.yaml", "--quiet", "--out", tmp_path / "theirs")
    summary = json.loads((tmp_path / "theirs/optimum.json").read_text())
    for optimum in (study.optimize(threads=2), study.optimize(tmp_path / "mine")):
        assert optimum.summary == summary
        assert (optimum.unmet_limits, optimum.failed_runs, optimum.pareto) == (None, 0, None)
        for table in ("evaluations", "finalists", "sensitivities"):
            assert_same(getattr(optimum, table), tmp_path / f"theirs/{table}.parquet")
        assert repr(optimum).startswith("<stickslip.Optimum after 12 designs>\n") and "stiffness_n_m" in repr(optimum)
    assert optimum.directory == tmp_path / "mine"
    assert optimum.report() == tmp_path / "mine-report.html"
    # The program continues the search.
    program("optimize", tmp_path / "block.yaml", "--quiet", "--out", tmp_path / "mine")


def test_an_optimisation_in_memory(tmp_path):
    optimum = stickslip.Study.from_dict(BLOCK).optimize()
    assert optimum.directory is None
    assert "stiffness_n_m" in optimum.report(tmp_path / "page.html").read_text()
    with pytest.raises(stickslip.StudyError, match="no name for the page"):
        optimum.report()
    best = optimum.summary["best"]["values"]["stiffness_n_m"]
    assert 55 < best < 66.67


def test_limits_that_no_design_meets():
    keys = {**BLOCK, "optimize": {"minimize": "stop", "designs": 8, "subject_to": {"stop": {"at_most": 0.1}}}}
    optimum = stickslip.Study.from_dict(keys).optimize()
    assert len(optimum.unmet_limits) == 1 and "stop" in optimum.unmet_limits[0]


def test_two_objectives():
    goal = {"minimize": ["stop", "soon"], "designs": 9, "finalists": 2, "final_samples": 2}
    optimum = stickslip.Study.from_dict({**BLOCK, "optimize": goal}).optimize()
    assert len(optimum.pareto) > 0 and "stiffness_n_m" in optimum.pareto.column_names


def test_studies_without_a_goal(small, tmp_path):
    with pytest.raises(stickslip.StudyError, match="`optimize` is missing"):
        small.optimize()
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="holds no search"):
        stickslip.Study.from_dict(BLOCK).optimize(tmp_path)
    with pytest.raises(stickslip.StudyError, match="out: an empty path"):
        stickslip.Study.from_dict(BLOCK).optimize("")
    with pytest.raises(stickslip.StudyError, match="`identify` is missing"):
        small.identify([])


def test_an_inference_is_that_of_the_program(program, measured, tmp_path):
    study = stickslip.Study.from_dict(IDENTIFY)
    (tmp_path / "study.yaml").write_text(study.yaml)
    frame = polars.DataFrame(measured)
    frame.write_csv(tmp_path / "rests.csv")
    out = tmp_path / "theirs"
    program("identify", tmp_path / "study.yaml", "--measured", tmp_path / "rests.csv", "--quiet", "--out", out)
    summary = json.loads((out / "identification.json").read_text())
    columns = {name: [row[name] for row in measured] for name in measured[0]}
    simulations = out / "simulations"
    given = [tmp_path / "rests.csv", str(tmp_path / "rests.csv"), frame, columns, measured]
    for number, table in enumerate(given):
        # Simulated runs are shared, but for one computation in memory.
        place = {"simulations": simulations} if number else {}
        found = study.identify(table, tmp_path / "mine" if number == 1 else None, **place)
        assert found.summary == summary
        for name in ("posterior", "parameter_sets", "fit", "positions"):
            assert_same(getattr(found, name), out / f"{name}.parquet")
    assert found.failed_runs == 0 and "friction_coefficient" in repr(found)
    assert found.plot(width="single").axes


def test_measurements_that_make_no_sense(measured, tmp_path):
    study = stickslip.Study.from_dict(IDENTIFY)
    with pytest.raises(stickslip.StudyError) as raised:
        study.identify([{**measured[0], "speed_rad_s": -150.0}])
    assert raised.value.file == "measured" and "no point of the sweep" in raised.value.problem
    with pytest.raises(stickslip.StudyError, match="no column std_dev_rad"):
        study.identify({"speed_rad_s": [-140.0], "beta_1_rad": [1.0], "beta_2_rad": [2.0]})
    with pytest.raises(TypeError, match="allowed: a path, a list of dicts"):
        study.identify(3)
    turned = [{**row, "beta_1_rad": 400.0} for row in measured]
    with warnings.catch_warnings(), pytest.raises(UserWarning, match="found:  400 rad\n  remedy: angles in rad"):
        warnings.simplefilter("error")
        study.identify(turned)
    with pytest.raises(stickslip.StudyError, match="none.csv"):
        study.identify(tmp_path / "none.csv")


def test_too_few_simulated_runs_give_a_warning(measured):
    prior = {"friction_coefficient": {"from": 5.0e-3, "to": 9.0e-3}}
    few = {"design": {"monte_carlo": {"samples": 4}}}
    inference = {**IDENTIFY["identify"], "parameters": prior}
    study = stickslip.Study.from_dict({**IDENTIFY, "initial_conditions": few, "identify": inference})
    with pytest.warns(UserWarning, match="identify.designs: too few simulated runs for an accurate posterior of friction"):
        found = study.identify(measured)
    assert any("too few simulated runs" in warning for warning in found.summary["warnings"])


@pytest.mark.parametrize("existence", [False, True])
def test_a_check_is_that_of_the_program(program, tmp_path, existence):
    (tmp_path / "study.yaml").write_text(SMALL)
    option = ["--existence"] if existence else []
    printed = program("check", tmp_path / "study.yaml", "--json", *option).stdout
    study = stickslip.Study.from_yaml(tmp_path / "study.yaml")
    assert study.check(existence=existence) == json.loads(printed)
    assert ("existence" in study.check(existence=existence)) == existence
