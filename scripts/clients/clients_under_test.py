"""Fixtures that the tests of the clients share; `scripts/clients/test` runs the tests."""

import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

# A block on a spring that is released 45 mm from the origin; its time of rest has a closed form.
BLOCK = """
schema: 1
name: block
seed: 1
model: {kind: block_on_spring}
initial_conditions: {box: {position_m: [0.045, 0.045]}, design: {monte_carlo: {samples: 1}}}
simulation: {method: event, tolerance: {relative: 1e-12, absolute: 1e-12}}
design:
  stiffness_n_m: {from: 40, to: 200}
  friction_coefficient: {from: 0.05, to: 0.2}
  mass_kg: {from: 0.5, to: 2}
responses: {stop: median_time_to_rest, amplitude: {amplitude_mean: {}}}
"""


def stop_s(stiffness_n_m, friction_coefficient, mass_kg):
    """Returns when the block stops: each half swing shortens the amplitude by two half widths of the rest interval."""
    half_width_m = friction_coefficient * 10.0 / stiffness_n_m
    half_swings = max(0, math.ceil((0.045 / half_width_m - 1) / 2))
    return half_swings * math.pi * math.sqrt(mass_kg / stiffness_n_m)


class Clients(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        # Fewer runs per design.
        text = (ROOT / "studies/design.yaml").read_text()
        self.assertEqual(text.count("samples: 64"), 1)
        self.balancer = self.write("design.yaml", text.replace("samples: 64", "samples: 16"))
        self.block = self.write("block.yaml", BLOCK)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return str(path)

    def client(self, name, *arguments, code=0):
        """Returns the output of a client; its standard error if the client should fail."""
        command = [sys.executable, HERE / name, *map(str, arguments)]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stderr if code else done.stdout

    def evaluate(self, study, design):
        """Returns the program's answer to a design in the format of the clients."""
        command = [os.environ["STICKSLIP"], "evaluate", study, "--designs", "-"]
        done = subprocess.run(
            command, input=design + "\n", capture_output=True, text=True, check=True
        )
        return json.loads(done.stdout)["responses"]

    def found(self, text, study):
        """Returns the design and the values that a client printed, and compares them with the program's."""
        design = re.search("^design: (.*)$", text, re.MULTILINE)[1]
        values = {
            name: float(value) for name, value in re.findall(r"^  (\w+): (\S+)", text, re.MULTILINE)
        }
        own = self.evaluate(study, design)
        self.assertEqual(values, {name: entry["value"] for name, entry in own.items()})
        return json.loads(design), values
