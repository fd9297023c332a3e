"""Runs the examples of docs/clients.md unchanged."""

import os
import re
import subprocess
import sys
from pathlib import Path

from clients_under_test import ROOT, Clients


class TestDocs(Clients):
    def setUp(self):
        super().setUp()
        for name in ("scripts", "studies"):
            (self.folder / name).symlink_to(ROOT / name)
        page = (ROOT / "docs/clients.md").read_text()
        self.blocks = re.findall(r"```(\w+)\n(.*?)```", page, re.DOTALL)

    def run_block(self, command, text):
        """Runs an example with this Python's packages; returns its output."""
        here = str(Path(sys.executable).parent)
        python_path = str(ROOT / "scripts/clients")
        environment = os.environ | {
            "PATH": f"{here}:{os.environ['PATH']}",
            "PYTHONPATH": python_path,
        }
        done = subprocess.run(
            command, input=text, cwd=self.folder, env=environment, capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_commands(self):
        # The first block installs packages.
        commands = [text for kind, text in self.blocks if kind == "sh"][1:]
        self.assertEqual(len(commands), 3)
        openmdao, pymoo, salib = (self.run_block("bash", text) for text in commands)
        study = str(ROOT / "studies/design.yaml")
        self.assertGreaterEqual(self.found(openmdao, study)[1]["quiet"], 0.85)
        self.assertGreaterEqual(self.found(pymoo, study)[1]["quiet"], 0.9)
        self.assertIn("speed_rad_s", salib)
        self.assertTrue((self.folder / "indices.csv").exists())

    def test_help_needs_no_package(self):
        for client in ("dakota", "openmdao", "pymoo", "salib"):
            # Without `site`, Python finds no installed package.
            command = [sys.executable, "-S", str(ROOT / "scripts/clients" / client)]
            done = subprocess.run([*command, "--help"], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            self.assertIn(f"scripts/clients/{client} ", done.stdout)
            if client != "dakota":
                given = ["study.yaml", "--response" if client == "salib" else "--minimise", "a"]
                done = subprocess.run([*command, *given], capture_output=True, text=True)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("allowed: pip install -r scripts/clients/requirements.txt", done.stderr)

    def test_python(self):
        (text,) = (text for kind, text in self.blocks if kind == "python")
        printed = self.run_block([sys.executable, "-"], text + "    print(vibration, quiet)\n")
        self.assertIn("name='speed_rad_s', unit='rad/s', low=-260.0, high=-140.0", printed)
        vibration, quiet = map(float, printed.splitlines()[-1].split())
        self.assertGreater(vibration, 0)
        self.assertTrue(0 <= quiet <= 1)
