"""One machine: its equilibrium set, and one run with its motion."""

import math

import numpy
import pyarrow.parquet
import pytest
from conftest import bits

import stickslip

MACHINE = {"speed_rad_s": -191.6372, "friction_coefficient": 2.75e-3, "balls": 2}

STUDY = """
schema: 1
name: {name}
seed: 0
model:
  kind: ball_balancer
  parameters: {{speed_rad_s: -191.6372, friction_coefficient: 2.75e-3, balls: {balls}}}
initial_conditions: {{design: {design}}}
simulation: {{end_time_s: 3}}
"""


@pytest.mark.parametrize("balls, option", [(1, ("grid", 64)), (2, ("grid", 48)), (3, ("samples", 1024))])
def test_the_set_is_that_of_the_program(program, tmp_path, balls, option):
    study = tmp_path / "study.yaml"
    study.write_text(STUDY.format(name="equilibrium_set", balls=balls, design="{monte_carlo: {samples: 1}}"))
    name, number = option
    program("equilibria", study, f"--{name}", number, "--quiet", "--out", tmp_path / "out")
    found = stickslip.equilibrium_set(**{**MACHINE, "balls": balls, name: number}, threads=2)
    for table, file in [("positions", "equilibrium_positions"), ("summary", "equilibrium_set_summary"), ("frictionless", "frictionless_equilibria")]:
        mine = getattr(found, table).to_pyarrow()
        theirs = pyarrow.parquet.read_table(tmp_path / f"out/{file}.parquet")
        assert bits(mine).equals(bits(theirs))
    assert [found.fraction] == found.summary["fraction"]
    assert [found.components] == found.summary["components"]
    assert (found.components is None) == (balls == 3)


def test_defaults_are_those_of_the_thesis():
    found = stickslip.equilibrium_set(speed_rad_s=-216.3772, positions=False)
    assert found.positions is None
    assert (round(found.fraction, 4), found.components) == (0.77, 1)
    low = stickslip.equilibrium_set(speed_rad_s=-216.3772, friction_coefficient=2.75e-4)
    assert (round(low.fraction, 4), low.components) == (0.0174, 6)
    assert len(low.positions) == 512 * 512
    assert sum(low.positions["in_set"]) / 512**2 == low.fraction


def test_a_simulation_is_a_run_of_a_study(tmp_path):
    start = {"x": 0.01, "beta_1": 1.0, "beta_2": 4.0, "y_dot": 0.02, "beta_dot_1": 0.5, "beta_dot_2": -0.3}
    found = stickslip.simulate(start, simulation={"end_time_s": 3}, **MACHINE)
    columns = ["x", "y", "beta_1", "beta_2", "x_dot", "y_dot", "beta_dot_1", "beta_dot_2"]
    row = [start.get(name, 0) for name in columns]
    design = f"{{table: {{columns: {columns}, rows: [{row}]}}}}".replace("'", "")
    study = stickslip.Study.from_text(STUDY.format(name="simulate", balls=2, design=design))
    assert found.run.to_dict() == study.run().runs.to_dict()
    study.run(tmp_path / "results")
    assert [found.label] == found.run["label"] and [found.evidence] == found.run["evidence"]


def test_the_motion_is_that_of_a_replay(program, tmp_path):
    design = "{table: {columns: [x, y, beta_1, beta_2, x_dot, y_dot, beta_dot_1, beta_dot_2], rows: [[0, 0, 1, 4, 0, 0, 0.5, -0.3]]}}"
    path = tmp_path / "study.yaml"
    path.write_text(STUDY.format(name="simulate", balls=2, design=design))
    program("run", path, "--quiet", "--out", tmp_path / "results")
    start = {"beta_1": 1.0, "beta_2": 4, "beta_dot_1": 0.5, "beta_dot_2": -0.3}
    for times, option in [(None, []), (numpy.linspace(0, 2, 5), ["--times", "0:2:5"])]:
        out = tmp_path / f"motion-{len(option)}"
        program("replay", tmp_path / "results", 0, "--out", out, *option)
        found = stickslip.simulate(start, times_s=times, simulation={"end_time_s": 3}, **MACHINE)
        for table in ["trajectory", "switches"]:
            theirs = pyarrow.parquet.read_table(out / f"{table}.parquet")
            assert bits(getattr(found, table).to_pyarrow()).equals(bits(theirs))
        assert len(found.trajectory) > 4 and len(found.switches) > 0
        if times is not None:
            assert found.trajectory["time_s"] == pytest.approx(times)


def test_times_after_the_end_are_named():
    start = {"position_m": 0.35}
    block = {"mass_kg": 1, "stiffness_n_m": 100, "normal_force_n": 10, "friction_coefficient": 1.0}
    found = stickslip.simulate(start, times_s=[0, 0.1, 50, 60], model="block_on_spring", **block)
    assert found.trajectory["time_s"] == pytest.approx([0, 0.1])
    assert found.left_out_times_s == [50, 60] and 0.1 < found.end_time_s < 50
    assert repr(found).endswith("2 instants; 2 times after the end are left out>")
    assert "times after the end" not in repr(stickslip.simulate(start, times_s=[0], model="block_on_spring", **block))
    every = stickslip.simulate(start, model="block_on_spring", **block)
    assert every.left_out_times_s == [] and every.end_time_s == found.end_time_s
    # The table of switches is that of the whole run, whatever the times are.
    assert every.switches.to_dict() == found.switches.to_dict() != {}
    assert found.differences is None


def test_contact_of_a_simulation():
    start = {"beta_1": 1.0, "beta_2": 2.0, "beta_dot_1": 0.8}
    machine = {"speed_rad_s": -173.1803, "simulation": {"end_time_s": 2}}
    found = stickslip.simulate(start, contact={"restitution": 0.5}, **machine)
    impacts = [phase for phase in found.touches["from"] if phase == "open"]
    assert len(impacts) == found.run["impacts"][0] > 0
    assert min(found.trajectory["gap_1_2_rad"]) > -1e-9 and "touching_2_1" in found.trajectory.column_names
    plain = stickslip.simulate(start, **machine)
    assert plain.touches is None and "gap_1_2_rad" not in plain.trajectory.column_names


def test_the_set_of_balls_that_touch():
    found = stickslip.equilibrium_set(contact={}, speed_rad_s=-173.1803, grid=256, positions=False)
    assert found.summary["touching_fraction"] == pytest.approx([0.406], abs=0.001)


def test_a_disc_that_starts():
    start, profile = {"beta_1": 1.0, "beta_2": 4.0}, [{"ramp": {"from_rad_s": -31, "over_s": 2}}]
    found = stickslip.simulate(start, speed_rad_s=-160, speed_profile=profile)
    same = stickslip.simulate(start, speed_rad_s=-160, protocol="startup")
    assert found.run.to_dict() == same.run.to_dict() and found.end_time_s > 2
    kick = [{"kick": {"at_s": 1, "speed_m_s": 0.01, "direction_rad": 0}}]
    assert stickslip.simulate(start, speed_rad_s=-160, disturbances=kick).end_time_s > 1
    with pytest.raises(stickslip.StudyError, match="model.parameters.protocol"):
        stickslip.equilibrium_set(protocol="startup")


def test_a_block_comes_to_rest():
    found = stickslip.simulate(
        {"position_m": 0.35},
        model="block_on_spring",
        mass_kg=1,
        stiffness_n_m=100,
        normal_force_n=10,
        friction_coefficient=1.0,
    )
    # Half a swing about 0.1 m to -0.15 m, and one about -0.1 m.
    assert found.label == "equilibrium"
    assert found.run["end_position_m"] == pytest.approx([-0.05], abs=1e-6)
    assert found.run["time_to_rest_s"] == pytest.approx([2 * math.pi / 10], abs=1e-6)


def test_numbers_of_numpy():
    own = {"speed_rad_s": numpy.float32(-200), "balls": numpy.int64(1), "friction_coefficient": numpy.float64(1e-3)}
    found = stickslip.equilibrium_set(**own, grid=64)
    same = stickslip.equilibrium_set(speed_rad_s=-200, balls=1, friction_coefficient=1e-3, grid=64)
    assert found.summary.to_dict() == same.summary.to_dict()


def test_own_balls_and_laws():
    found = stickslip.simulate(
        {"beta_1": 1},
        balls=[{"mass_kg": 1.4e-4}, {"mass_kg": 2e-4}],
        friction={"stribeck": {"static_friction_coefficient": 4e-3, "stribeck_speed_rad_s": 0.0}},
        normal_force="newton",
        simulation={"end_time_s": 0.1, "method": "event"},
    )
    assert found.label in ("undecided", "equilibrium")


def test_what_makes_no_sense():
    wrong = [
        (lambda: stickslip.equilibrium_set(speed_rad=-200), "speed_rad_s \\(did you mean this"),
        (lambda: stickslip.equilibrium_set(speed_rad_s="fast"), "speed_rad_s"),
        (lambda: stickslip.equilibrium_set(speed_rad_s=math.nan), "finite"),
        (lambda: stickslip.equilibrium_set(table_mass_kg=-1), "table_mass_kg"),
        (lambda: stickslip.equilibrium_set(grid=7), "grid: out of range"),
        (lambda: stickslip.equilibrium_set(grid=10**6), "too fine"),
        (lambda: stickslip.equilibrium_set(grid=64, balls=3), "one ball or two"),
        (lambda: stickslip.equilibrium_set(samples=1000, balls=3), "power of two"),
        (lambda: stickslip.equilibrium_set(ball_damping=0), "ball_damping"),
        (lambda: stickslip.equilibrium_set(threads=0), "threads"),
        (lambda: stickslip.simulate({"bta_1": 0}), r"start.bta_1: unknown coordinate(?s:.*)beta_1 \(did you mean this\?\)"),
        (lambda: stickslip.simulate({"beta_1": "east"}), "start.beta_1: not a number"),
        (lambda: stickslip.simulate({"beta_2": [1.0]}), "start.beta_2: wrong type"),
        (lambda: stickslip.equilibrium_set(grid=10**30), "grid: out of range"),
        (lambda: stickslip.simulate({}, times_s=[1, 1]), "ascend"),
        (lambda: stickslip.simulate({}, times_s=[-1]), "from 0"),
        (lambda: stickslip.simulate({}, times_s=[math.nan]), "from 0"),
        (lambda: stickslip.simulate({}, model="pendulum"), "ball_balancer"),
        (lambda: stickslip.simulate({}, simulation={"end_time": 3}), "end_time_s"),
    ]
    for call, text in wrong:
        with pytest.raises(stickslip.StudyError, match=text):
            call()
    for call in [
        lambda: stickslip.equilibrium_set(speed_rad_s=object()),
        lambda: stickslip.simulate(3.0, speed_rad_s={1: 2}),
        lambda: stickslip.simulate([1, 2]),
        lambda: stickslip.simulate({}, times_s=["late"]),
        lambda: stickslip.simulate({}, times_s=[True]),
        lambda: stickslip.simulate({}, times_s="late"),
        lambda: stickslip.simulate({}, times_s=3),
        lambda: stickslip.equilibrium_set(grid=64.0),
    ]:
        with pytest.raises(TypeError, match="wrong type"):
            call()
    with pytest.raises(stickslip.StudyError) as raised:
        stickslip.simulate({}, speed_rad_s=-200, table_mas_kg=0.3)
    assert raised.value.key == "model.parameters.table_mas_kg"
    assert "table_mas_kg: 0.3" in str(raised.value)
