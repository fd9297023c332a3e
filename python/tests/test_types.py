"""Types and docstrings are complete, and the page's examples run."""

import inspect
import os
import re
import runpy
import subprocess
import sys

from conftest import ROOT

import stickslip


def test_stubs_are_those_of_the_module(tmp_path):
    # Figures have no stubs but annotations of their own, which mypy reads.
    (tmp_path / "figures").write_text(r"stickslip\.figures.*")
    command = [sys.executable, "-m", "mypy.stubtest", "stickslip", "--allowlist", "figures"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_python_code_has_its_types(tmp_path):
    modules = ["stickslip._display", "stickslip._lagrange", "stickslip._progress", "stickslip.command", "stickslip.system"]
    options = [part for module in modules for part in ("--module", module)]
    command = [sys.executable, "-m", "mypy", "--strict", "--package", "stickslip.figures", *options]
    environment = {**os.environ, "MYPYPATH": str(ROOT / "python")}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


CALLS = """
import numpy as np
import stickslip

study = stickslip.Study.from_dict({"schema": 1})
design = {"speed_rad_s": -216, "material": "steel"}
study.evaluate(design)
study.evaluate([design, design], threads=np.int64(2))
study.evaluate({"speed_rad_s": np.array([-216.0]), "material": ["steel"]})
results = study.run(threads=2)
results.replay(results.runs["run_id"][0], times_s=np.linspace(0, 1, 5)).plot()
results.replay(np.uint64(3))
stickslip.figures.draw(results, "time-to-rest", width="single", points=[0])
stickslip.Study(design)  # type: ignore[arg-type]
results.plot(figure=3)  # type: ignore[arg-type]
"""


def test_calls_of_users_have_their_types(tmp_path):
    """A needless comment `type: ignore` is an error as well."""
    (tmp_path / "calls.py").write_text(CALLS)
    command = [sys.executable, "-m", "mypy", "--strict", "calls.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_everything_public_has_a_docstring():
    assert stickslip.__doc__
    for name in stickslip.__all__:
        thing = getattr(stickslip, name)
        if name == "__version__":
            continue
        assert thing.__doc__ and thing.__module__ == "stickslip", name
        for member, value in vars(thing).items() if inspect.isclass(thing) else []:
            if not member.startswith("_") and name != "StudyError":
                assert inspect.getdoc(getattr(thing, member)), f"{name}.{member}"


def test_version():
    text = (ROOT / "Cargo.toml").read_text()
    assert f'name = "stickslip"\nversion = "{stickslip.__version__}"' in text


def test_examples_of_the_pages(tmp_path, monkeypatch, capsys):
    page = (ROOT / "docs/python.md").read_text() + (ROOT / "README.md").read_text()
    examples = re.findall(r"<!-- tested: python -->\n```python\n(.*?)```", page, re.DOTALL)
    assert len(examples) == len(re.findall("^(?:import|from) stickslip", page, re.MULTILINE)) == 9
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    for number, example in enumerate(examples):
        path = tmp_path / f"example_{number}.py"
        path.write_text(example)
        runpy.run_path(str(path), run_name="__main__")
    shown = re.findall(r"<!-- printed -->\n```text\n(.*?)```", page, re.DOTALL)
    printed = capsys.readouterr().out
    assert shown and all(block in printed for block in shown)
