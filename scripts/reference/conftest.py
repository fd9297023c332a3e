"""Makes the modules of time_stepping importable for the tests."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "time_stepping"))
