"""The peers: their packages, how they are started, and how they are called."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent / "peers"
# Vectorized loops over two balls take up to 1.8 times as long.
FLAGS = ["-O3", "-march=native", "-ffast-math", "-fno-finite-math-only", "-fno-tree-vectorize"]
FLAGS += ["-std=c++17"]
ONE_THREAD = {
    name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
}


class PeerFailed(Exception):
    """A peer that stopped before it answered."""


@dataclass
class Tool:
    """A peer: its program in `peers/` and the packages that it needs."""

    source: str
    title: str
    python: tuple = ()  # packages of PyPI
    header: str = ""  # a C++ header and the Debian package that has it
    package: str = ""

    def missing(self):
        """Returns the names of the packages to install."""
        absent = [name for name in self.python if importlib.util.find_spec(name) is None]
        if self.header:
            if shutil.which("g++") is None:
                return ["g++"]
            test = subprocess.run(
                ["g++", "-E", "-x", "c++", "-"],
                input=f"#include <{self.header}>\n",
                capture_output=True,
                text=True,
            )
            if test.returncode != 0:
                absent.append(self.package)
        return absent

    def command(self, folder):
        """Returns the command that starts the peer, compiled into `folder` if needed."""
        if not self.header:
            return [sys.executable, HERE / self.source]
        program = folder / Path(self.source).stem
        subprocess.run(["g++", *FLAGS, "-o", program, HERE / self.source], check=True)
        return [program]


TOOLS = {
    "boost": Tool(
        "boost.cpp", "Boost.odeint", header="boost/numeric/odeint.hpp", package="libboost-dev"
    ),
    "heyoka": Tool("heyoka_peer.py", "heyoka, 8 lanes", python=("numpy", "numba", "heyoka")),
}


class Peer:
    """A running peer on the cases of one work: a process that answers lines."""

    def __init__(self, tool, command, work):
        self.title, self.runs = tool.title, work.runs
        self.errors = work.cases.with_suffix(f".{Path(tool.source).stem}.log")
        with self.errors.open("w") as errors:
            self.process = subprocess.Popen(
                [*command, work.cases],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                env=os.environ | ONE_THREAD,
            )

    def ask(self, line):
        """Sends a command and waits for the answer."""
        try:
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass  # it has stopped, and the missing answer is reported below
        answer = self.process.stdout.readline()
        if not answer:
            said = self.errors.read_text().strip().split("\n")
            raise PeerFailed(f"{self.title} stopped: {said[-1] or 'no message'}")
        return json.loads(answer)

    def run(self, relative, absolute):
        """Returns the results of all runs with this tolerance; `cpu_s` is the CPU time per run in seconds."""
        result = self.ask(f"run {relative!r} {absolute!r}")
        result["cpu_s"] /= self.runs
        return result

    def close(self):
        self.process.stdin.close()
        self.process.wait()
