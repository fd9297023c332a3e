"""`python -m stickslip.figures` is the command `stickslip-figures`."""

import sys

from .command import main

sys.exit(main())
