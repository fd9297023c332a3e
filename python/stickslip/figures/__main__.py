"""`python -m stickslip.figures` is the command `stickslip-figures`."""

import sys

from .command import main

if __name__ == "__main__":
    sys.exit(main())
