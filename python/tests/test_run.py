"""Studies that are run: the tables are the program's, to the last bit."""

import hashlib
import pickle
import threading

import pytest
from conftest import ROOT, SMALL, assert_same

import stickslip

TABLES = ["runs", "points", "time_to_rest", "cycles", "equilibria", "equilibrium_histogram"]


def files(folder):
    """Returns the hashes of a directory's tables; the manifest and the division into chunks depend on time."""
    paths = [folder / f"{table}.parquet" for table in TABLES] + [folder / "study.yaml"]
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in paths}


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_tables_in_memory_are_those_of_the_program(small, small_results, threads):
    results = small.run(threads=threads)
    assert results.directory is None
    for table in TABLES:
        assert_same(getattr(results, table), small_results / f"{table}.parquet")
    assert sum(results.labels.values()) == small.run_count == len(results.runs)
    assert results.labels["equilibrium"] == len(results.equilibria) > 0
    assert results.labels["failed"] > 0


def test_a_directory_is_that_of_the_program(small, small_results, tmp_path):
    results = small.run(tmp_path / "out", threads=2)
    assert results.directory == tmp_path / "out"
    assert files(tmp_path / "out") == files(small_results)
    for table in TABLES:
        assert_same(getattr(results, table), small_results / f"{table}.parquet")
    again = small.run(out=str(tmp_path / "out"))
    assert again.labels == results.labels
    assert again.runs.to_dict() == results.runs.to_dict()
    # The program takes it for its own.
    assert files(tmp_path / "out") == files(small_results)


def test_all_runs_of_a_block(program, tmp_path):
    path = ROOT / "studies/block-on-belt.yaml"
    program("run", path, "--quiet", "--out", tmp_path / "program")
    results = stickslip.Study.from_yaml(path).run()
    for table in TABLES:
        assert_same(getattr(results, table), tmp_path / f"program/{table}.parquet")


STARTS = """
schema: 1
name: start
seed: 1
model:
  kind: ball_balancer
  speed_profile: [{ramp: {from_rad_s: -100, over_s: 0.2}}, {hold_s: 0.2}]
initial_conditions: {design: {monte_carlo: {samples: 4}}}
"""


def test_stages_of_a_disc_that_starts(small, program, tmp_path):
    (tmp_path / "start.yaml").write_text(STARTS)
    program("run", tmp_path / "start.yaml", "--quiet", "--out", tmp_path / "program")
    study = stickslip.Study.from_text(STARTS)
    for results in (study.run(), study.run(tmp_path / "out")):
        assert_same(results.stages, tmp_path / "program/stages.parquet")
        assert results.stages["kind"] == ["ramp", "hold"] * 4
    assert small.run().stages is None


def test_a_directory_of_something_else_is_left_alone(small, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="allowed:"):
        small.run(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    file = tmp_path / "mine.txt"
    with pytest.raises(OSError, match="cannot be used as output directory"):
        small.run(file)


def test_an_empty_path_is_no_directory(small, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(stickslip.StudyError, match="out: an empty path"):
        small.run("")
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(stickslip.StudyError, match="allowed:"):
        small.run("")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_study_file_of_the_user_is_left_alone(small, tmp_path):
    (tmp_path / "study.yaml").write_text("# mine\n" + SMALL)
    with pytest.raises(FileExistsError, match="a study.yaml that is not what this study writes"):
        small.run(tmp_path)
    assert (tmp_path / "study.yaml").read_text() == "# mine\n" + SMALL
    assert [path.name for path in tmp_path.iterdir()] == ["study.yaml"]


def test_another_study_needs_recompute(small, tmp_path):
    small.run(tmp_path)
    other = stickslip.Study.from_text(SMALL.replace("seed: 5", "seed: 6"))
    with pytest.raises(FileExistsError, match="seed"):
        other.run(tmp_path)
    results = other.run(tmp_path, recompute=True)
    assert len(results.runs) == other.run_count
    assert list((tmp_path / "earlier").iterdir())


def test_a_changed_file_is_named(small, tmp_path):
    results = small.run(tmp_path)
    file = tmp_path / "runs.parquet"
    whole = file.read_bytes()
    file.write_bytes(whole[:-1])
    with pytest.raises(OSError, match="runs.parquet"):
        results.runs


def test_damage_never_ends_python(small, tmp_path):
    small.run(tmp_path)
    file = tmp_path / "runs.parquet"
    whole = file.read_bytes()
    steps = range(0, len(whole), len(whole) // 60)
    refused = 0
    for place, results in [(place, small.run(tmp_path)) for place in steps]:
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :])
        try:
            assert len(results.runs) == small.run_count
        except OSError as error:
            assert "runs.parquet" in str(error)
            refused += 1
    assert refused > 5


def test_what_a_study_says_of_itself(small):
    assert (small.name, small.seed, small.point_count) == ("small", 5, 4)
    assert small.run_count == 96
    assert small.variables == ["friction_coefficient"]
    assert small.responses == ["vibration"]
    copies = [pickle.loads(pickle.dumps(small)), stickslip.Study.from_text(small.yaml)]
    for copy in copies:
        assert (copy.hash, copy.yaml, copy.responses) == (small.hash, small.yaml, small.responses)
    assert "small" in repr(small) and "96" in repr(small)


def test_tables_of_a_text_lie_in_its_folder(tmp_path):
    (tmp_path / "speeds.csv").write_text("speed_rad_s\n-160\n-170\n")
    text = SMALL.replace(
        "grid: {speed_rad_s: [-160.8103, -216.3772], normal_force: [lagrange, newton]}",
        "table: speeds.csv",
    )
    assert stickslip.Study.from_text(text, folder=tmp_path).point_count == 2
    with pytest.raises(stickslip.StudyError, match="speeds.csv"):
        stickslip.Study.from_text(text)
    (tmp_path / "studies").mkdir()
    study = tmp_path / "studies/study.yaml"
    study.write_text(text.replace("speeds.csv", "../speeds.csv"))
    with pytest.raises(stickslip.StudyError, match="outside"):
        stickslip.Study.from_yaml(study)
    assert stickslip.Study.from_yaml(study, tables=[tmp_path]).point_count == 2


def test_other_threads_may_run_studies_too(small):
    expected = small.run().runs.to_dict()
    found = []
    workers = [threading.Thread(target=lambda: found.append(small.run().runs.to_dict())) for _ in range(3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert found == [expected] * 3
