"""Integrates the runs of a table of cases by time stepping, with contact between the balls, and writes their endings.

The table is one of tests/data, the output of `stickslip expand`, or runs.parquet of a directory of results. Its columns
contain start states (beta_1 or initial_beta_1, ...) and those parameters that differ between runs; `--set` gives the other
parameters. Prints a summary.
"""

import argparse
import os
import sys
import time

import runs


def constants(settings):
    """Returns parameters by name from NAME=VALUE."""
    pairs = [setting.partition("=") for setting in settings]
    wrong = [name for name, equals, value in pairs if not (equals and value)]
    if wrong:
        raise ValueError(f"--set {wrong[0]}: found no value; allowed: NAME=VALUE")
    return {name: value for name, _, value in pairs}


def parse():
    parser = argparse.ArgumentParser(prog="time_stepping", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("cases", metavar="CASES", help="table of cases, .csv or .parquet")
    add("--out", metavar="FILE", help="table to write, .csv or .parquet")
    add("--compact", action="store_true", help="write few digits, and neither start states nor numbers about the integration")
    add("--set", metavar="NAME=VALUE", action="append", default=[],
        help="a parameter of all runs that the table does not contain, such as speed_rad_s=-173.1803 or ball_mass_2_kg=1e-4")
    add("--rows", type=int, metavar="N", help="only the first N rows")
    add("--no-contact", action="store_true", help="balls pass through each other, and start states stay as they are")
    add("--starts", choices=("map", "keep"), default="map",
        help="map sampled angles to positions without overlap (default), or keep them; overlap is then an error")
    add("--restitution", type=float, default=0.36, help="of impacts between balls (default: 0.36)")
    add("--ball-friction", type=float, default=0.0, help="coefficient of friction between balls (default: 0)")
    add("--ring-impulse", action="store_true", help="impacts include the friction impulse of the ring")
    add("--step", type=float, default=5e-3, help="step in non-dimensional time (default: 5e-3)")
    add("--end-time", type=float, default=16.5, metavar="S", help="end time in seconds (default: 16.5)")
    add("--tail", type=float, default=0.2, help="last part of a run for mean speeds, as a fraction (default: 0.2)")
    add("--to-the-end", action="store_true", help="do not end a run at rest before the end time")
    add("--threads", type=int, default=os.cpu_count(), help="default: all cores")
    return parser.parse_args()


def main():
    args = parse()
    begun = time.perf_counter()
    try:
        rows = runs.read(args.cases)[: args.rows]
        if not rows:
            raise ValueError(f"{args.cases}: no rows")
        cases = [runs.case(row, constants(args.set)) for row in rows]
        options = runs.Options(
            contact=not args.no_contact, map_starts=args.starts == "map", restitution=args.restitution,
            ball_friction=args.ball_friction, ring_impulse=args.ring_impulse, step=args.step, end_time_s=args.end_time,
            tail=args.tail, until_rest=not args.to_the_end)
        results = runs.compute(cases, options, args.threads)
    except (OSError, ValueError) as error:
        sys.exit(f"time_stepping: {error}")
    if args.out:
        table = [runs.compact(one) for one in results] if args.compact else results
        keys = ("run_id", "point_id")
        identities = [{key: int(row[key]) for key in keys if key in row} for row in rows]
        runs.write(args.out, [{"row": index, **identity, **one}
                              for index, (identity, one) in enumerate(zip(identities, table))])
    print(runs.summary(results))
    print(f"{time.perf_counter() - begun:.1f} s")


main()
