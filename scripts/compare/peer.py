"""The peers: their packages, how they are started, and how they are called."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
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
    arguments: list = field(default_factory=list)
    python: list = field(default_factory=list)  # packages of PyPI
    header: str = ""  # a C++ header and the Debian package that has it
    package: str = ""
    libraries: list = field(default_factory=list)
    works: tuple = ("w1", "w2")  # the works that it is written for

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
        libraries = [f"-l{name}" for name in self.libraries]
        subprocess.run(["g++", *FLAGS, "-o", program, HERE / self.source, *libraries], check=True)
        return [program]


TOOLS = {
    "scipy-lsoda": Tool(
        "scipy_peer.py", "SciPy LSODA", ["LSODA"], python=["numpy", "scipy", "numba"]
    ),
    "scipy-dop853": Tool(
        "scipy_peer.py", "SciPy DOP853", ["DOP853"], python=["numpy", "scipy", "numba"]
    ),
    "numba": Tool("numba_peer.py", "numba DOP853", python=["numpy", "scipy", "numba"]),
    "boost": Tool(
        "boost.cpp", "Boost.odeint", header="boost/numeric/odeint.hpp", package="libboost-dev",
        works=("w1", "w2", "w3", "w4"),
    ),
    "cvode": Tool(
        "cvode.cpp",
        "SUNDIALS CVODE",
        header="cvode/cvode.h",
        package="libsundials-dev",
        libraries=["sundials_cvode", "sundials_nvecserial"],
    ),
    "heyoka": Tool(
        "heyoka_peer.py",
        "heyoka, 8 lanes",
        python=["numpy", "numba", "heyoka"],
        works=("w1", "w2", "w3", "w4"),
    ),
}


class Peer:
    """A running peer on the cases of one work: a process that answers lines."""

    def __init__(self, tool, command, work):
        self.title, self.runs = tool.title, work.runs
        self.errors = work.cases.with_suffix(f".{Path(tool.source).stem}.log")
        with self.errors.open("w") as errors:
            self.process = subprocess.Popen(
                [*command, work.cases, *tool.arguments],
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
