"""Runs the program and its peers on the same cases in turn, and prints one table per work."""

import argparse
import importlib.util
import json
import statistics
import sys
import tempfile
from pathlib import Path
from subprocess import CalledProcessError

MISSING = [
    package
    for module, package in (("numpy", "numpy"), ("yaml", "pyyaml"), ("pyarrow", "pyarrow"))
    if importlib.util.find_spec(module) is None
]
if MISSING:
    sys.exit(f"compare: {sys.executable} lacks {' '.join(MISSING)}; install with pip, by name")

from cases import prepare
from check import worst_difference
from engine import Engine
from peer import TOOLS, Peer, PeerFailed
from reference import Reference, ladder
from table import print_table

ROOT = Path(__file__).resolve().parents[2]
WORKS = ("w1", "w2", "w3", "w4")
EXAMPLES = """examples:
  scripts/compare/run                                  everything, some ten minutes
  scripts/compare/run --runs 32 --repeat 1             a first look
  scripts/compare/run --runs 16 --works w3             balls that touch, as a test
  scripts/compare/run --works w1 --json table.json
  PYTHON=.venv/bin/python scripts/compare/run          with the packages of a virtual environment
"""
# The program with its default settings, with the exact motion, and with only the work that the peers do.
SAME_WORK = "stickslip-same-work"
OWN = {
    SAME_WORK: ("stickslip, event, rest only", {"method": "event", "endings": "rest"}),
    "stickslip-event": ("stickslip, event", {"method": "event"}),
    "stickslip": ("stickslip", {}),
}
OWN_SMOOTH = {
    SAME_WORK: ("stickslip, rest only", {"endings": "rest"}),
    "stickslip": OWN["stickslip"],
}
# A tool that takes longer than this for all runs of a work runs only once, s.
SLOW = 20.0
# Agreement of the right-hand sides of all tools.
ROUNDING = 1e-12


def arguments():
    parser = argparse.ArgumentParser(
        prog="scripts/compare/run", description=__doc__, epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    names = ", ".join(TOOLS)
    add = parser.add_argument
    add("--runs", type=int, default=256, metavar="N", help="runs of each work [256]")
    add("--repeat", type=int, default=5, metavar="K", help="rounds; medians are printed [5]")
    add("--only", metavar="NAME,...", help=f"peers to compare with: {names} [all]")
    add("--works", default=",".join(WORKS), metavar="NAME,...",
        help=f"works to compare on: {', '.join(WORKS)} [all]")  # fmt: skip
    add("--stickslip", default=str(ROOT / "target/release/stickslip"), metavar="PATH",
        help="the program [target/release/stickslip]")  # fmt: skip
    add("--json", metavar="FILE", help="also write the tables as JSON; - for standard output")
    given = parser.parse_args()
    given.only = given.only.split(",") if given.only else list(TOOLS)
    given.works = given.works.split(",")
    for name in set(given.only) - set(TOOLS):
        parser.error(f"--only: there is no peer {name}; there are {names}")
    for name in set(given.works) - set(WORKS):
        parser.error(f"--works: there is no work {name}; there are {', '.join(WORKS)}")
    if given.runs < 2 or given.repeat < 1:
        parser.error("at least 2 runs and 1 round")
    if not Path(given.stickslip).is_file():
        parser.error(
            f"no {given.stickslip}: build it with cargo build --release, or --stickslip PATH"
        )
    return given


def say(text):
    print(text, file=sys.stderr, flush=True)


def available(names, folder):
    """Returns the commands of the available peers, and prints what the others lack."""
    commands = {}
    for name in names:
        absent = TOOLS[name].missing()
        if absent:
            say(f"without {name}: not installed: {', '.join(absent)}")
        else:
            say(f"preparing {name}")
            try:
                commands[name] = TOOLS[name].command(folder)
            except CalledProcessError:
                say(f"without {name}: it does not compile (see above)")
    return commands


def started(commands, work, folder):
    """Starts the peers and checks their right-hand sides."""
    peers = {}
    for name, command in commands.items():
        peer = Peer(TOOLS[name], command, work)
        try:
            difference = worst_difference(peer, work, folder)
        except PeerFailed as failed:
            say(f"without {name}: {failed}")
            continue
        if difference > ROUNDING:
            say(f"without {name}: its right-hand side is wrong by {difference:.1e}")
            continue
        peers[name] = peer
    return peers


def compared(work, commands, given, folder):
    """Returns the rows of the table of one work."""
    engines = {
        name: Engine(given.stickslip, work, folder, title, settings)
        for name, (title, settings) in (OWN_SMOOTH if work.smooth else OWN).items()
    }
    peers = started(commands, work, folder)
    say(f"{work.name}: reference")
    reference = Reference(work, given.stickslip, folder)
    tools, rows = engines | peers, {}
    tolerances, times = {}, {}
    for name, tool in list(tools.items()):
        say(f"{work.name}: {name}")
        try:
            relative, result = ladder(tool, work, reference)
        except PeerFailed as failed:
            say(f"without {name}: {failed}")
            del tools[name]
            continue
        tolerances[name], times[name] = relative, [result["cpu_s"]]
        rows[name] = {"tool": tool.title, "relative_tolerance": relative}
        rows[name] |= reference.errors(result)
        for count in ("evaluations", "steps", "events"):
            rows[name][count] = result[count] / work.runs if result.get(count) else None
    for round_number in range(1, given.repeat):
        say(f"{work.name}: round {round_number + 1} of {given.repeat}")
        for name, tool in tools.items():
            if times[name][0] * work.runs >= SLOW:
                continue
            relative = tolerances[name]
            try:
                times[name].append(tool.run(relative, 0.01 * relative)["cpu_s"])
            except PeerFailed as failed:
                say(f"{name}, fewer rounds: {failed}")
    for name, tool in tools.items():
        rows[name]["cpu_ms_per_run"] = 1e3 * statistics.median(times[name])
        rows[name]["rounds"] = len(times[name])
        tool.close()
    own = rows[SAME_WORK]["cpu_ms_per_run"]
    for row in rows.values():
        row["ratio"] = row["cpu_ms_per_run"] / own
    return {"work": work.name, "runs": work.runs, "reference": reference.about, "rows": rows}


def main():
    given = arguments()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        commands = available(given.only, folder)
        tables = []
        for name in given.works:
            work = prepare(given.stickslip, ROOT / f"benches/{name}.yaml", given.runs, folder)
            tables.append(compared(work, commands, given, folder))
    quiet = given.json == "-"
    for table in tables:
        if not quiet:
            print_table(table)
    if given.json:
        text = json.dumps(tables, indent=2) + "\n"
        sys.stdout.write(text) if quiet else Path(given.json).write_text(text)


if __name__ == "__main__":
    try:
        main()
    except CalledProcessError as failed:
        command = " ".join(str(word) for word in failed.cmd)
        sys.exit(f"compare: ended with {failed.returncode}: {command}")
    except KeyboardInterrupt:
        sys.exit(130)
