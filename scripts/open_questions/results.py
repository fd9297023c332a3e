"""Runs the studies and reads their tables."""

import hashlib
import json
import subprocess
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent.parent
FOLDER = ROOT / "studies/open-questions"


class Results:
    """The results of one study, computed if necessary."""

    def __init__(self, name, program, out, threads):
        from stickslip.figures.tables import Directory

        self.name = name
        self.study = FOLDER / f"{name}.yaml"
        self.path = Path(out) / name
        begun = time.monotonic()
        command = [program, "run", self.study, "--threads", str(threads), "--quiet", "--out", self.path]
        # Exit code 3: some runs failed, which is part of the answers.
        code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
        if code not in (0, 3):
            raise SystemExit(f"{self.study}: exit code {code}")
        self.seconds = time.monotonic() - begun
        self.directory = Directory(self.path)

    def about(self):
        """What the record says about the study, so that a stale record fails."""
        manifest = json.loads((self.path / "manifest.json").read_text())
        resolved = (self.path / "study.yaml").read_bytes()
        return {
            "study": self.study.relative_to(ROOT).as_posix(),
            "resolved_study_sha256": hashlib.sha256(resolved).hexdigest(),
            "model_version": manifest["model_version"],
        }

    def read(self, table, *columns):
        """Columns of a table as arrays."""
        return self.directory.table(table).read(list(columns))

    def points(self, *columns):
        """Columns of points.parquet, a dictionary for each point."""
        read = self.read("points", *columns)
        return [dict(zip(read, row)) for row in zip(*read.values())]

    def stages(self):
        """For each stage, an array with one row per run that has it: run, point, at rest (1, 0), both angles, balls
        that the kick lifts off."""
        read = self.read(
            "stages", "run_id", "point_id", "stage", "at_rest", "beta_1_rad", "beta_2_rad", "lifted_off"
        )
        at_rest = np.array([value is not None and bool(value) for value in read["at_rest"]])
        rows = np.column_stack(
            [
                read["run_id"],
                read["point_id"],
                at_rest,
                read["beta_1_rad"],
                read["beta_2_rad"],
                read["lifted_off"],
            ]
        ).astype(float)
        return {stage: rows[read["stage"] == stage] for stage in np.unique(read["stage"])}

    def rests(self, point):
        """Angles of both balls of the runs of a point that come to rest."""
        read = self._rests()
        of = read["point_id"] == point
        return np.column_stack([read["beta_1_rad"][of], read["beta_2_rad"][of]])

    def amplitudes(self, point):
        """Amplitudes of the runs of a point that did not fail."""
        read = self.read("runs", "point_id", "amplitude_m")
        own = read["amplitude_m"][read["point_id"] == point]
        return own[np.isfinite(own)]

    def _rests(self):
        if not hasattr(self, "_read"):
            self._read = self.read("equilibria", "point_id", "beta_1_rad", "beta_2_rad")
        return self._read
