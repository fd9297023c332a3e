"""The program itself: cost and results of its runs."""

import os
import shutil
import subprocess

import numpy as np
import yaml
from pyarrow import parquet


class Engine:
    """The program on one work, with some settings of the simulation."""

    def __init__(self, stickslip, work, folder, title, settings):
        self.stickslip, self.work, self.folder = stickslip, work, folder
        self.title, self.settings = title, settings

    def study(self, source, relative, absolute):
        """Returns a study of the work with this tolerance."""
        text = yaml.safe_load(source.read_text())
        text["simulation"]["tolerance"] = {"relative": relative, "absolute": absolute}
        text["simulation"] |= self.settings
        name = "-".join([source.stem, *self.settings.values(), str(relative)])
        path = self.folder / f"{name}.yaml"
        path.write_text(yaml.safe_dump(text))
        return path

    def run(self, relative, absolute):
        """Returns endings from the tables of the program, and CPU time per run."""
        study = self.study(self.work.study, relative, absolute)
        one = self.study(self.work.one, relative, absolute)
        out = self.folder / f"{study.stem}-out"
        shutil.rmtree(out, ignore_errors=True)
        command = [self.stickslip, "run", study, "--threads", "1", "--quiet", "--out", out]
        subprocess.run(command, check=True)
        runs = parquet.read_table(out / "runs.parquet").to_pydict()
        state = np.full((self.work.runs, 8), np.nan)
        state[:, 2], state[:, 3] = runs["beta_1_rad"], runs["beta_2_rad"]
        return {
            "cpu_s": self.cpu_s_per_run(study, one),
            "rest": [label == "equilibrium" for label in runs["label"]],
            "state": state,
            "steps": sum(runs["steps"]) + sum(runs["rejected_steps"]),
            "events": sum(runs["switches"]),
        }

    def cpu_s_per_run(self, study, one):
        """Returns the CPU time (user and system) of the program on one thread, less that with a single run."""
        command = [self.stickslip, "verify", "--threads", "1", "--quiet"]
        whole, single = cpu_s([*command, study]), cpu_s([*command, one])
        return (whole - single) / (self.work.runs - 1)

    def close(self):
        """Does nothing; there is no process to end."""


def cpu_s(command):
    """Returns the CPU time of a command, user and system, s."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 4):  # 4: an expectation is not met, with fewer runs
        raise SystemExit(f"compare: {command[0]} ended with {process.returncode}")
    return usage.ru_utime + usage.ru_stime
