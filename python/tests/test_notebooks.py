"""The notebooks of the documentation have the outputs that their text quotes."""

import json
import subprocess
import sys

from conftest import ROOT


def test_outputs_are_those_of_an_execution():
    names = sorted(path.stem for path in (ROOT / "docs/notebooks").glob("*.ipynb"))
    assert names == ["first-study", "identification", "optimisation", "reading-tables"]
    done = subprocess.run([sys.executable, ROOT / "scripts/notebooks", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_notebook_shows_results():
    for path in (ROOT / "docs/notebooks").glob("*.ipynb"):
        cells = json.loads(path.read_text())["cells"]
        outputs = [output for cell in cells for output in cell.get("outputs", [])]
        kinds = {kind for output in outputs for kind in output.get("data", {})}
        assert "text/html" in kinds, path
        assert not [output for output in outputs if output["output_type"] == "error"], path
