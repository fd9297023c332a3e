"""Runs the command `stickslip-figures` as `python -m stickslip.figures`."""

import sys

from .command import main

if __name__ == "__main__":
    sys.exit(main())
