"""The command `stickslip`: the program's command line, which runs in this process."""

from __future__ import annotations

import signal
import sys
from importlib import import_module

__all__ = ["main"]


def main() -> int:
    """Runs the program with the arguments of this process and returns its exit code."""
    program = import_module("._stickslip", __package__)._command
    # The program handles Ctrl-C itself; where it does not, Ctrl-C ends it, as it ends any program.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return int(program(["stickslip", *sys.argv[1:]]))


if __name__ == "__main__":
    sys.exit(main())
