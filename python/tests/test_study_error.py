"""What is wrong with a study: Python says what the program says."""

import pytest
from conftest import SMALL

import stickslip


@pytest.mark.parametrize(
    "text",
    [
        SMALL.replace("seed: 5", "sed: 5"),
        SMALL.replace("kind: ball_balancer", "kind: pendulum"),
        SMALL.replace("-160.8103", "fast"),
        SMALL.replace("schema: 1", "schema: 2"),
        "[",
        "",
        "a: &a [*a]",
        "name: \x00",
    ],
)
def test_same_text(program, tmp_path, text):
    path = tmp_path / "study.yaml"
    path.write_text(text)
    said = program("check", path, code=2).stderr
    with pytest.raises(stickslip.StudyError) as raised:
        stickslip.Study.from_yaml(path)
    assert f"error: {raised.value}\n" == said
    with pytest.raises(stickslip.StudyError) as in_text:
        stickslip.Study.from_text(text, folder=tmp_path)
    assert str(in_text.value) == str(raised.value).replace("study.yaml", "<text>")


def test_parts(tmp_path):
    with pytest.raises(ValueError) as raised:
        stickslip.Study.from_text(SMALL.replace("seed: 5", "sed: 5"))
    error = raised.value
    assert (error.file, error.line, error.column) == ("<text>", 4, 1)
    assert (error.key, error.problem) == ("sed", "unknown key")
    assert error.found == "sed" and "seed" in error.allowed
    with pytest.raises(stickslip.StudyError) as missing:
        stickslip.Study.from_yaml(tmp_path / "none.yaml")
    assert missing.value.file == str(tmp_path / "none.yaml")
    assert (missing.value.line, missing.value.key) == (None, None)
    assert stickslip.StudyError("own").problem is None


def test_numbers_of_threads(small):
    for threads in (0, -1, 1025):
        with pytest.raises(stickslip.StudyError, match="from 1 to 1024"):
            small.run(threads=threads)
        with pytest.raises(stickslip.StudyError, match=f"found:   {threads}"):
            small.evaluate({"friction_coefficient": 2e-3}, threads=threads)
    for wrong in ("all", 2.0, True):
        with pytest.raises(TypeError, match="threads: wrong type(?s:.*)a whole number from 1 to 1024"):
            small.run(threads=wrong)
    with pytest.raises(stickslip.StudyError, match="threads: out of range") as raised:
        small.run(threads=10**30)
    error = raised.value
    assert (error.key, error.problem, error.found) == ("threads", "out of range", str(10**30))
    assert error.allowed == "a whole number from 1 to 1024"


def test_remedies_are_those_of_python(small, tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="another directory, as `out`, or this one removed") as raised:
        small.run(tmp_path)
    assert "--" not in str(raised.value)
    results = small.run(tmp_path / "out")
    with pytest.raises(FileExistsError, match="a new path or an unchanged report, as `out`"):
        results.report(tmp_path / "mine.txt")
    other = stickslip.Study.from_text(SMALL.replace("seed: 5", "seed: 6"))
    with pytest.raises(FileExistsError, match="or `recompute=True`, which moves"):
        other.run(tmp_path / "out")
    with pytest.raises(stickslip.StudyError, match="`samples` for three balls or more"):
        stickslip.equilibrium_set(balls=3, grid=64)


def test_empty_paths(small, tmp_path):
    results = small.run(tmp_path / "out")
    for call, argument in [
        (lambda: stickslip.open(""), "directory"),
        (lambda: results.report(""), "out"),
        (lambda: results.replay(0, out=""), "out"),
    ]:
        with pytest.raises(stickslip.StudyError, match=f"{argument}: an empty path"):
            call()
