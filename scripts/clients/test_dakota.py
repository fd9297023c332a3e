"""Tests of the driver for Dakota, with recorded pairs of files."""

import json
import math
import subprocess
import sys

from clients_under_test import HERE, ROOT, Clients

DAKOTA = ROOT / "tests/data/dakota"


class TestDakota(Clients):
    STUDY = DAKOTA / "study.yaml"

    def answer(self, text, study=None):
        """Returns the results file for a parameters file, and the output."""
        self.write("params.in", text)
        command = [sys.executable, HERE / "dakota", study or self.STUDY, "params.in", "results.out"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (0, ""), done.stderr)
        self.assertEqual(
            sorted(path.suffix for path in self.folder.iterdir()), [".in", ".out", ".yaml", ".yaml"]
        )
        return (self.folder / "results.out").read_text(), done.stderr

    def pairs(self, text):
        """Returns values by descriptor, parsing each line as Dakota does."""
        return {name: float(value) for value, name in (line.split() for line in text.splitlines())}

    def test_recorded_pairs(self):
        designs = {
            "standard": {"stiffness_n_m": 100, "friction_coefficient": 0.1, "load": "light"},
            "aprepro": {"stiffness_n_m": 64, "friction_coefficient": 0.1, "load": "heavy"},
        }
        stops = {
            "standard": 2 * math.pi * math.sqrt(1 / 100),
            "aprepro": math.pi * math.sqrt(2 / 64),
        }
        for name, design in designs.items():
            recorded = self.pairs((DAKOTA / f"{name}-results.out").read_text())
            text, said = self.answer((DAKOTA / f"{name}-params.in").read_text())
            self.assertEqual(said, "")
            found = self.pairs(text)
            self.assertEqual(list(found), list(recorded))
            for key, value in recorded.items():
                self.assertAlmostEqual(found[key], value, delta=1e-9)
            self.assertAlmostEqual(found["stop"], stops[name], delta=1e-8)
            own = self.evaluate(self.STUDY, json.dumps(design))
            self.assertEqual(found["stop"], own["stop"]["value"])
            by, kind = ("by_high", "high") if name == "standard" else ("by", "value")
            self.assertEqual(found[by], own["by"][kind])

    def test_what_cannot_be_answered_fails(self):
        standard = (DAKOTA / "standard-params.in").read_text()
        aprepro = (DAKOTA / "aprepro-params.in").read_text()
        for text, what in [
            (
                standard.replace("1 ASV_1", "3 ASV_1"),
                "stop: the gradient is asked for (active set 3)",
            ),
            (
                aprepro.replace("ASV_2:by        =                      1", "ASV_2:by = 4"),
                "by: the Hessian",
            ),
            (
                standard.replace("1.000000000000000e+02", "1.000000000000000e+03"),
                "stiffness_n_m: out of range",
            ),
            (standard.replace("light", "none"), "load: not a choice"),
            (standard.replace("friction_coefficient", "friction"), "friction: not a variable"),
            (standard.replace("1.000000000000000e+02", "nan"), "not a request"),
            (
                standard.replace(":stop", ":stopp"),
                "stopp: not a response of the study: stop, by, amplitude",
            ),
            (standard.replace(":stop", ""), "line 6: not an active set of a response"),
            (standard.replace("0 metadata", "1 metadata\n seconds MD_1"), "metadata"),
            (standard + standard, "line 16: more than one evaluation"),
            (
                standard.replace("3 variables", "4 variables"),
                "`functions` or `DAKOTA_FNS` should be here",
            ),
            (
                standard.replace("3 variables", "99 variables"),
                "99 variables, but the file ends before",
            ),
            (standard[: len(standard) // 2], "the end"),
            ("", "the end: `variables`"),
            ("variables\n", "line 1: neither"),
        ]:
            results, said = self.answer(text)
            self.assertEqual(results, "fail\n", what)
            self.assertIn(what, said)
        results, said = self.answer(standard, study="none.yaml")
        self.assertEqual(results, "fail\n")
        self.assertIn("none.yaml", said)

    def test_usage(self):
        said = self.client("dakota", "study.yaml", code=2)
        self.assertIn("usage: dakota STUDY PARAMETERS RESULTS", said)
        self.assertIn("found 1 argument, needs 3", said)
        missing = ("none.in", "results.out")
        self.client("dakota", self.STUDY, *missing)
        self.assertEqual((self.folder / "results.out").read_text(), "fail\n")
        said = self.client("dakota", self.STUDY, "none.in", "none/results.out", code=1)
        self.assertIn("none/results.out: No such file or directory", said)
