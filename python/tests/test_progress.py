"""Progress: bars of tqdm on standard error, and nothing without being asked."""

import subprocess
import sys

import pytest

import stickslip


def test_a_bar_on_standard_error(small, capsys):
    small.run(progress=True)
    shown = capsys.readouterr()
    assert shown.out == ""
    # The last state of the bar.
    last = shown.err.strip().split("\r")[-1]
    assert last.startswith("small: 100%") and "96/96" in last and "failed=" in last
    small.run()
    assert capsys.readouterr().err == ""


def test_designs_and_directories_too(small, tmp_path, capsys):
    small.evaluate([{"friction_coefficient": 2e-3}, {"friction_coefficient": 1e-3}], progress=True)
    assert "192/192" in capsys.readouterr().err
    small.run(tmp_path, progress=True)
    assert "96/96" in capsys.readouterr().err


def test_a_search_has_a_bar_for_each_part(capsys):
    from test_search import BLOCK

    goal = {"minimize": "stop", "designs": 10, "start_designs": 6}
    stickslip.Study.from_dict({**BLOCK, "optimize": goal}).optimize(progress=True)
    shown = capsys.readouterr().err
    assert "6/6" in shown and "4/4" in shown


def test_without_tqdm():
    """A module of this name that cannot be imported stands for one that is not installed."""
    code = f"""
import sys
sys.modules["tqdm"] = sys.modules["tqdm.auto"] = None
import stickslip
study = stickslip.Study.from_text({stickslip.Study.from_text(SMALLEST).yaml!r})
study.run()
study.run(progress=True)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 1
    assert 'ModuleNotFoundError: progress=True needs tqdm: pip install "stickslip[progress]"' in done.stderr


SMALLEST = """
schema: 1
name: smallest
seed: 1
model: {kind: block_on_spring}
initial_conditions: {design: {monte_carlo: {samples: 1}}}
simulation: {end_time_s: 0.1}
"""


def test_an_exception_of_the_bar_ends_the_computation(monkeypatch):
    import stickslip._progress
    from conftest import ENDLESS

    def broken(self, *counts):
        raise RuntimeError("no terminal")

    monkeypatch.setattr(stickslip._progress.Bars, "draw", broken)
    with pytest.raises(RuntimeError, match="no terminal"):
        stickslip.Study.from_text(ENDLESS).run(progress=True)
