"""Tests of the clients for OpenMDAO, pymoo and SALib, on reduced studies."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from SALib.analyze import sobol as analyse
from SALib.sample import sobol as sample

from clients_under_test import BLOCK, HERE, ROOT, Clients, stop_s

# A shell starts commands in the background with Ctrl-C ignored, which child processes inherit.
signal.signal(signal.SIGINT, signal.default_int_handler)


class TestOpenMDAO(Clients):
    ARGUMENTS = (
        "--minimise vibration --at-least quiet=0.7 --fix balls=2 --samples 6 --evaluations 12"
    )

    def test_experiment_and_search(self):
        arguments = (self.balancer, *self.ARGUMENTS.split(), "--fix", "material=steel")
        text = self.client("openmdao", *arguments, "--record", self.folder)
        design, values = self.found(text, self.balancer)
        self.assertEqual((design["balls"], design["material"]), (2, "steel"))
        first, second = map(float, re.findall(r"best of \d+: (\S+)", text))
        self.assertLess(second, first, "COBYLA improves on the experiment")
        self.assertAlmostEqual(values["vibration"], second, delta=1e-5 * second)
        self.assertGreaterEqual(values["quiet"], 0.7)
        self.assertTrue((self.folder / "experiment.sql").exists())
        # Equal seeds give equal designs.
        self.assertEqual(self.client("openmdao", *arguments), text)

    def test_choices_are_refused(self):
        text = self.client("openmdao", self.balancer, *self.ARGUMENTS.split(), code=1)
        self.assertIn("material: takes some values only; --fix it", text)
        for fixed, allowed in [
            ("balls=9", "a whole number from 1 to 3"),
            ("balls=1.5", "a whole number from 1 to 3"),
            ("material=steal", "steel, ceramic"),
            ("speed_rad_s=fast", "a number from -260 to -140"),
        ]:
            arguments = (self.balancer, *self.ARGUMENTS.split(), "--fix", fixed)
            text = self.client("openmdao", *arguments, code=1)
            self.assertIn(f"found {fixed.split('=')[1]}", text.replace(".0,", ","))
            self.assertIn(f"allowed {allowed}\n", text)
        wrong = (
            self.balancer,
            "--minimise",
            "vibrations",
            "--fix",
            "balls=2",
            "--fix",
            "material=steel",
        )
        text = self.client("openmdao", *wrong, code=1)
        self.assertIn("vibrations: not a response", text)


class TestPymoo(Clients):
    ARGUMENTS = "--minimise vibration --at-least quiet=0.8 --population 10 --generations 4"

    def test_mixed_variables(self):
        text = self.client("pymoo", self.balancer, *self.ARGUMENTS.split())
        design, values = self.found(text, self.balancer)
        self.assertTrue(text.startswith("40 designs\n"), text)
        self.assertIn(design["balls"], (1, 2, 3))
        self.assertIn(design["material"], ("steel", "ceramic"))
        self.assertGreaterEqual(values["quiet"], 0.8)
        # At least as good as all designs of the table that meet the constraint.
        lines = (ROOT / "studies/designs.csv").read_text().splitlines()
        others = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        self.assertEqual(len(others), 8)
        kept = []
        for other in others:
            numbers = {
                **other,
                "speed_rad_s": float(other["speed_rad_s"]),
                "balls": int(other["balls"]),
            }
            answer = self.evaluate(self.balancer, json.dumps(numbers))
            if answer["quiet"]["value"] >= 0.8:
                kept.append(answer["vibration"]["value"])
        self.assertTrue(kept)
        self.assertLessEqual(values["vibration"], min(kept))
        self.assertEqual(self.client("pymoo", self.balancer, *self.ARGUMENTS.split()), text)
        self.assertNotEqual(
            self.client("pymoo", self.balancer, *self.ARGUMENTS.split(), "--seed", 2), text
        )

    def test_constraints_and_counts_are_numbers(self):
        for client in ("pymoo", "openmdao"):
            goal = (self.balancer, "--minimise", "vibration")
            for least in ("much", "nan"):
                said = self.client(client, *goal, "--at-least", f"quiet={least}", code=1)
                self.assertIn(f"{client}: --at-least quiet={least}: not a constraint", said)
            option = "--population" if client == "pymoo" else "--samples"
            said = self.client(client, *goal, option, 0, code=2)
            self.assertIn(f"argument {option}: '0' is not a whole number from 1", said)

    def test_constraints_that_nothing_keeps(self):
        arguments = (
            "--minimise",
            "vibration",
            "--at-least",
            "quiet=2",
            "--population",
            4,
            "--generations",
            1,
        )
        text = self.client("pymoo", self.balancer, *arguments, code=1)
        self.assertIn("no design meets the constraints", text)

    def test_an_interrupt_leaves_nothing_behind(self):
        command = [
            sys.executable,
            HERE / "pymoo",
            self.balancer,
            "--minimise",
            "vibration",
            "--generations",
            "100000",
        ]
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        deadline = time.monotonic() + 60
        server = None
        while server is None and time.monotonic() < deadline:
            for child in children.read_text().split():
                if b"\0--designs\0" in Path(f"/proc/{child}/cmdline").read_bytes():
                    server = child
            time.sleep(0.05)
        self.assertIsNotNone(server)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertFalse(Path(f"/proc/{server}").exists())


class TestSALib(Clients):
    def read(self, path):
        with open(path, newline="") as file:
            return {
                row.pop("input"): {key: float(value) for key, value in row.items()}
                for row in csv.DictReader(file)
            }

    def test_indices_are_those_of_the_closed_form(self):
        out = self.folder / "indices.csv"
        text = self.client("salib", self.block, "--response", "stop", "--samples", 64, "--out", out)
        found = self.read(out)
        names = ["stiffness_n_m", "friction_coefficient", "mass_kg"]
        self.assertEqual(list(found), names)
        bounds = [[40, 200], [0.05, 0.2], [0.5, 2]]
        problem = {"num_vars": 3, "names": names, "bounds": bounds}
        designs = sample.sample(problem, 64, calc_second_order=False, seed=1)
        stops = np.array([stop_s(*design) for design in designs])
        expected = analyse.analyze(problem, stops, calc_second_order=False, seed=1)
        for index, name in enumerate(names):
            row = found[name]
            self.assertIn(name, text)
            for kind in ("S1", "ST"):
                middle, half = expected[kind][index], expected[f"{kind}_conf"][index]
                self.assertAlmostEqual(row[kind], middle, delta=1e-6)
                self.assertAlmostEqual(row[f"{kind}_low"], middle - half, delta=1e-6)
                self.assertAlmostEqual(row[f"{kind}_high"], middle + half, delta=1e-6)
                self.assertGreater(half, 0)
        again = self.folder / "again.csv"
        self.client("salib", self.block, "--response", "stop", "--samples", 64, "--out", again)
        self.assertEqual(again.read_bytes(), out.read_bytes())

    def test_indices_agree_with_optimize(self):
        block = "optimize: {minimize: stop, designs: 10, sensitivity: {from: runs, samples: 128}}\n"
        study = self.write("optimize.yaml", BLOCK + block)
        command = [os.environ["STICKSLIP"], "optimize", study, "--quiet", "--out", "own"]
        subprocess.run(command, cwd=self.folder, check=True, stdout=subprocess.DEVNULL)
        own = json.loads((self.folder / "own/optimum.json").read_text())["sensitivities"]
        out = self.folder / "indices.csv"
        self.client("salib", study, "--response", "stop", "--samples", 128, "--out", out)
        found = self.read(out)
        self.assertEqual(len(own), len(found))
        for row in own:
            self.assertEqual((row["response"], row["source"]), ("stop", "runs"))
            theirs = found[row["variable"]]
            for ours, kind in ((row["first_order"], "S1"), (row["total"], "ST")):
                apart = max(ours["low"] - theirs[f"{kind}_high"], theirs[f"{kind}_low"] - ours["high"])
                self.assertLess(apart, 0.0, f"{row['variable']} {kind}: {ours} {theirs}")
                self.assertLess(ours["high"] - ours["low"], 0.6)

    def test_any_study(self):
        arguments = (self.balancer, "--response", "vibration", "--samples", 8)
        text = self.client("salib", *arguments, code=1)
        self.assertIn("material: a choice; --fix it: steel, ceramic", text)
        out = self.folder / "indices.csv"
        self.client("salib", *arguments, "--fix", "material=steel", "--out", out)
        self.assertEqual(list(self.read(out)), ["speed_rad_s", "balls"])
        text = self.client("salib", *arguments, "--fix", "colour=red", code=1)
        self.assertIn("colour: not a variable of", text)
        text = self.client("salib", self.block, "--response", "amplitude", "--samples", 4, code=1)
        self.assertIn("amplitude is 0.0 at all 20 designs: no variance", text)
