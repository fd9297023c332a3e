"""Writes the recorded runs with contact between the balls, tests/data/contact_*.csv, and prints what they show.

The runs begin at the start states of tests/data/reference_*.csv, moved apart so that no balls overlap.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "time_stepping"))
import runs  # noqa: E402

DATA = Path(__file__).parents[2] / "tests" / "data"
SPEEDS = (173.1803, 160.8103, 216.3772)  # the motor rotates clockwise
LAWS = ((0.5, 0.0), (0.36, 0.1))  # restitution, friction between the balls


def name(speed, law):
    """Returns the name of a recorded table."""
    return f"contact_{speed:.4f}_e{law[0]:g}_mu{law[1]:g}.csv"


def moving_pairs(results):
    """Returns a text about the mean speeds of the runs that move."""
    speeds = [[one["ball_speed_1_rad_s"], one["ball_speed_2_rad_s"]] for one in results if one["label"] == "moving"]
    if not speeds:
        return "no moving runs"
    middle, low, high = np.median(speeds), np.min(speeds), np.max(speeds)
    return f"mean speeds of moving runs: median {middle:.3f}, from {low:.3f} to {high:.3f} rad/s"


def study(speed, law, args):
    """Integrates the runs of one table, writes it and prints what it shows."""
    begun = time.process_time()
    rows = runs.read(DATA / f"reference_{speed:.4f}.csv")[: args.rows]
    cases = [runs.case(row, -speed) for row in rows]
    options = runs.Options(restitution=law[0], ball_friction=law[1])
    results = runs.compute(cases, options, args.threads)
    print(f"\n{-speed} rad/s, restitution {law[0]:g}, friction between balls {law[1]:g}")
    print(runs.summary(results))
    times = [one["time_to_rest_s"] for one in results if one["label"] == "equilibrium"]
    depth = min(one["least_gap_rad"] for one in results)
    print(f"{moving_pairs(results)}; median time to rest {np.median(times):.3f} s; least gap {depth:.1e} rad; "
          f"{time.process_time() - begun:.0f} s of processor time", flush=True)
    table = [{"row": index, **runs.compact(one)} for index, one in enumerate(results)]
    runs.write(Path(args.out) / name(speed, law), table)


def main():
    parser = argparse.ArgumentParser(prog="contact_tables.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--out", metavar="DIR", required=True, help="folder of the tables, such as tests/data")
    add("--speeds", type=float, nargs="+", default=SPEEDS, metavar="S", help="magnitudes of the motor speeds in rad/s")
    add("--rows", type=int, metavar="N", help="only the first N runs of each table")
    add("--threads", type=int, default=1, help="default: 1")
    args = parser.parse_args()
    for speed in args.speeds:
        for law in LAWS:
            study(speed, law, args)


main()
