"""The wheel in an environment of its own, without a Rust toolchain: the README's example and the command."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT


@pytest.fixture(scope="module")
def clean(tmp_path_factory):
    """An environment with the wheel and what the example needs; calls its programs without any other on the path."""
    wheel = os.environ.get("STICKSLIP_WHEEL")
    assert wheel, "scripts/python/test builds the wheel and sets STICKSLIP_WHEEL"
    folder = tmp_path_factory.mktemp("clean")
    subprocess.run([sys.executable, "-m", "venv", str(folder / "venv")], check=True)
    install = [folder / "venv/bin/python", "-m", "pip", "--disable-pip-version-check", "--quiet", "install"]
    subprocess.run([*install, "--no-deps", wheel], check=True)
    subprocess.run([*install, "polars"], check=True)
    (folder / "studies").symlink_to(ROOT / "studies")
    # Nothing but the environment: neither cargo nor a compiler.
    environment = {"PATH": str(folder / "venv/bin"), "HOME": str(folder)}

    def call(program, *arguments):
        command = [str(folder / "venv/bin" / program), *arguments]
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


def test_one_wheel_serves_all_versions_of_python():
    name = Path(os.environ["STICKSLIP_WHEEL"]).name
    assert re.fullmatch(r"stickslip-[\d.]+-cp39-abi3-\w+\.whl", name)


def test_the_example_of_the_readme(clean):
    (example,) = re.findall(r"```python\n(import stickslip\n.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    printed = clean("python", "-c", example)
    assert "equilibrium_fraction" in printed or "point_id" in printed
    assert re.search(r"^\[\d+\.\d+\]$", printed, re.MULTILINE)


def test_the_command(clean):
    assert clean("stickslip", "--version").startswith("stickslip ")
    assert clean("stickslip", "run", "studies/block-on-belt.yaml", "--out", "results", "--quiet") == ""
    assert clean("stickslip", "report", "results") == "results-report.html\n"
