"""The protocol between a Python peer and the runner: a command per line on standard input, a JSON line back.

check FILE              derivatives and forces of the states in FILE
run RELATIVE ABSOLUTE   all cases with this tolerance; `cpu_s` is the process's own CPU time
"""

import json
import sys
import time

import numpy as np
from equations import read_cases


def serve(make):
    """Answers commands with a peer that `make` creates from parameters, end time and start states: `forces(y, s1, s2, ...)`
        returns 8 derivatives, two normal and two friction forces, `prepare(relative, absolute)` compiles the rest, and
        `run(relative, absolute)` returns `rest`, `time`, `state` and counts."""
    parameters, end_time, starts = read_cases(sys.argv[1])
    peer = make(parameters, end_time, starts)
    for line in sys.stdin:
        command, *arguments = line.split()
        if command == "check":
            points = np.loadtxt(arguments[0], ndmin=2)
            values = [peer.forces(row[:8], *row[8:]) for row in points]
            answer = {"values": np.array(values).tolist()}
        else:
            tolerance = [float(value) for value in arguments]
            peer.prepare(*tolerance)
            before = time.process_time()
            result = peer.run(*tolerance)
            answer = {"cpu_s": time.process_time() - before}
            for name, value in result.items():
                answer[name] = value.tolist() if isinstance(value, np.ndarray) else value
        print(json.dumps(answer), flush=True)
