"""Results on disk and in memory: opened, replayed, reported and drawn."""

import pickle
import subprocess

import matplotlib.figure
import pyarrow.parquet
import pytest
from conftest import ENDLESS, assert_same, bits
from test_command import COMMAND
from test_run import STARTS, TABLES

import stickslip
from stickslip import figures


def test_finished_results(small, small_results):
    results = stickslip.open(small_results)
    assert (results.directory, results.complete) == (small_results, True)
    assert results.study.hash == small.hash
    assert results.labels == small.run().labels
    for table in TABLES:
        assert_same(getattr(results, table), small_results / f"{table}.parquet")
    assert repr(results).startswith("<stickslip.Results of small, in ")
    assert "96 runs, 4 points; " in repr(results)
    copy = pickle.loads(pickle.dumps(results))
    assert (copy.directory, copy.labels) == (small_results, results.labels)
    with pytest.raises(TypeError, match="allowed: results of study.run\\(directory\\)"):
        pickle.dumps(small.run())


def test_units_of_the_study(tmp_path, program):
    """The summary and the figures are in the units in which the study is written; the tables are in SI units."""
    text = (
        "schema: 1\nname: rpm\nseed: 5\nmodel: {kind: ball_balancer, parameters: {balls: 1}}\n"
        "units: {vibration: mm}\n"
        "sweep: [{grid: {speed: [-1500 rpm, -2000 rpm]}}]\n"
        "initial_conditions: {design: {monte_carlo: {samples: 8}}}\nsimulation: {end_time_s: 0.5}\n"
    )
    study = stickslip.Study.from_text(text)
    in_memory = study.run()
    in_files = study.run(tmp_path / "out")
    summary = in_memory.summary()
    assert summary == in_files.summary() == in_files._repr_markdown_()
    assert summary in program("summary", tmp_path / "out", "--format", "markdown").stdout
    assert "| speed [rpm] |" in summary and "-1500" in summary and "[mm]" in summary
    assert min(in_files.points["speed_rad_s"]) == pytest.approx(-209.4395102)
    figure = in_files.plot("fractions")
    assert figure.axes[0].get_xlabel() == "speed [rpm]"
    assert figure.axes[0].lines[0].get_xdata() == pytest.approx([-2000.0, -1500.0])
    titles = [axes.get_title(loc="left") for axes in in_files.plot("basins").axes]
    assert any("−2000 rpm" in title for title in titles), titles


def files(folder):
    return {path.relative_to(folder): path.stat().st_size for path in folder.rglob("*") if path.is_file()}


def test_interrupted_results(program, tmp_path):
    (tmp_path / "study.yaml").write_text(ENDLESS.replace("1000000000", "100000"))
    out = tmp_path / "out"
    program("run", tmp_path / "study.yaml", "--quiet", "--out", out, "--max-seconds", 1, "--chunk", 8, code=130)
    before = files(out)
    results = stickslip.open(str(out))
    assert not results.complete and results.directory == out
    assert 0 < len(results.runs) == sum(results.labels.values()) < 100_000
    assert f"{len(results.runs)} runs of at most 100000, not complete" in repr(results)
    assert results.replay(results.runs["run_id"][0]).differences == []
    assert results.replay(99_999).differences is None
    assert files(out) == before


def test_results_of_a_study_that_was_killed(tmp_path):
    (tmp_path / "study.yaml").write_text(ENDLESS)
    out = tmp_path / "out"
    process = subprocess.Popen(
        [*COMMAND, "run", str(tmp_path / "study.yaml"), "--quiet", "--out", str(out), "--chunk", "8"]
    )
    while len(list(out.glob("chunks/*/*"))) < 3:
        assert process.poll() is None
    process.kill()
    process.wait()
    before = files(out)
    results = stickslip.open(out)
    assert not results.complete and len(results.runs) > 0
    assert results.plot("time_to_rest").axes
    assert "<html" in results.report(tmp_path / "page.html").read_text()
    assert files(out) == before


def test_other_directories(tmp_path):
    with pytest.raises(stickslip.StudyError, match="does not exist"):
        stickslip.open(tmp_path / "none")
    with pytest.raises(FileExistsError, match="holds no results of `stickslip run`"):
        stickslip.open(tmp_path)
    with pytest.raises(TypeError):
        stickslip.open(3)


def test_a_replay_is_that_of_the_program(program, small_results, tmp_path):
    results = stickslip.open(small_results)
    program("replay", small_results, 5, "--times", "0:2:9", "--out", tmp_path / "theirs")
    times = [2 * step / 8 for step in range(9)]
    found = results.replay(5, times_s=times, out=tmp_path / "mine")
    assert found.differences == []
    assert found.run["run_id"] == [5] and found.label == results.runs["label"][5]
    for table in ("trajectory", "switches"):
        assert_same(getattr(found, table), tmp_path / f"theirs/{table}.parquet")
        theirs, mine = (pyarrow.parquet.read_table(tmp_path / f"{one}/{table}.parquet") for one in ("theirs", "mine"))
        assert bits(mine).equals(bits(theirs))
    assert (tmp_path / "mine/replay.html").exists()
    with pytest.raises(FileExistsError, match="not empty"):
        results.replay(5, out=tmp_path / "mine")


def test_a_replay_in_memory_has_no_row_to_compare(small, small_results):
    found = small.run().replay(5)
    assert found.differences is None
    assert found.trajectory.to_dict() == stickslip.open(small_results).replay(5).trajectory.to_dict()
    for results in (small.run(), stickslip.open(small_results)):
        with pytest.raises(stickslip.StudyError, match="run 96 of a study with 96 runs"):
            results.replay(96)
    for run_id in (-1, 2**70):
        with pytest.raises(stickslip.StudyError, match="run_id: (?s:.*)a whole number from 0 to 95"):
            small.run().replay(run_id)
    with pytest.raises(TypeError, match="run_id: wrong type\n  found:   a value of type float"):
        small.run().replay(3.0)


def test_a_replay_refuses_a_changed_table(small, tmp_path):
    small.run(tmp_path / "out")
    results = stickslip.open(tmp_path / "out")
    assert results.replay(3).differences == []
    # A changed table is refused before anything is compared.
    file = tmp_path / "out/runs.parquet"
    pyarrow.parquet.write_table(pyarrow.parquet.read_table(file), file)
    with pytest.raises(OSError, match="runs.parquet"):
        results.replay(3)


def test_a_report_is_that_of_the_program(program, small, small_results, tmp_path):
    page = stickslip.open(small_results).report(tmp_path / "mine.html")
    assert page == tmp_path / "mine.html"
    program("report", small_results, "--out", tmp_path / "theirs.html")
    assert page.read_bytes() == (tmp_path / "theirs.html").read_bytes()
    results = small.run(tmp_path / "out")
    assert results.report() == tmp_path / "out-report.html"
    with pytest.raises(stickslip.StudyError, match=r"study.run\(directory\)"):
        small.run().report(tmp_path / "memory.html")


def test_figures_are_those_of_the_directory(small, small_results, tmp_path):
    """Whether tables are in memory or in files, the figure has the same bytes."""
    in_memory = small.run()
    assert figures.names(in_memory) == figures.names(small_results)
    for name in ("time-to-rest", "exceedance", "diagnostics", "preferred-equilibria"):
        saved = []
        for number, figure in enumerate(
            [figures.draw(small_results, name), in_memory.plot(name), stickslip.open(small_results).plot(name)]
        ):
            assert isinstance(figure, matplotlib.figure.Figure)
            figure.savefig(tmp_path / f"{number}.svg")
            saved.append((tmp_path / f"{number}.svg").read_bytes())
        assert saved[0] == saved[1] == saved[2], name


def test_options_and_errors_of_figures(small):
    results = small.run()
    assert results.plot(width="single", points=[0]).get_figwidth() == pytest.approx(90 / 25.4)
    with pytest.raises(figures.FiguresError, match="no figure 'identification' of these results; they have .*time-to-rest"):
        results.plot("identification")
    with pytest.raises(stickslip.StudyError, match="points: these results have no such point\n  found:   9\n"):
        results.plot(points=[9])
    with pytest.raises(figures.FiguresError, match="results in memory"):
        stickslip.equilibrium_set(grid=16, positions=False).plot()


def test_figures_of_one_machine():
    motion = stickslip.simulate({"beta_1": 1.0, "beta_2": 2.0, "beta_dot_1": 0.8}, contact={}, simulation={"end_time_s": 1})
    assert motion.plot(width="single").axes
    found = stickslip.equilibrium_set(speed_rad_s=-216.3772, grid=32)
    assert found.plot().axes and found.plot("equilibrium_surface").axes


def test_stages_of_opened_results(tmp_path):
    stickslip.Study.from_text(STARTS).run(tmp_path / "out")
    results = stickslip.open(tmp_path / "out")
    assert_same(results.stages, tmp_path / "out/stages.parquet")


def test_tables_that_results_in_memory_lack():
    results = stickslip.equilibrium_set(grid=16, positions=False)
    for draw, table, call in [
        (figures.motion, "trajectory", r"`stickslip.simulate\(\)` or `results.replay\(\)`"),
        (figures.equilibrium_set, "equilibrium_positions", r"`stickslip.equilibrium_set\(positions=True\)`"),
        (figures.identification, "posterior", r"`study.identify\(measured\)`"),
    ]:
        with pytest.raises(figures.FiguresError, match=f"{table}.parquet: these results have no such table; {call} has it"):
            draw(results)
