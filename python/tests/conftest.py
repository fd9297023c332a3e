"""What tests share: the program to compare with, studies, and tables compared to the last bit."""

import os
import signal
import subprocess
from pathlib import Path

import pyarrow
import pyarrow.parquet
import pytest

import stickslip

ROOT = Path(__file__).resolve().parents[2]

# A shell starts commands in the background with Ctrl-C ignored. The tests of interruptions need Python's own handler, which
# child processes start with as well.
signal.signal(signal.SIGINT, signal.default_int_handler)

SMALL = """
schema: 1
name: small
seed: 5
model: {kind: ball_balancer}
sweep:
  - grid: {speed_rad_s: [-160.8103, -216.3772], normal_force: [lagrange, newton]}
uncertain: {imbalance_mass_kg: {uniform: {min: 4.0e-5, max: 7.0e-5}}}
initial_conditions: {design: {stratified: {parts_per_axis: 1, samples_per_cell: 24}}}
simulation: {end_time_s: 6}
audit: {fraction: 0.1}
design: {friction_coefficient: {from: 1.0e-3, to: 3.0e-3}}
responses: {vibration: {amplitude_mean: {relative: true}}}
"""

# More runs than anybody waits for.
ENDLESS = """
schema: 1
name: endless
seed: 5
model: {kind: ball_balancer}
initial_conditions: {design: {monte_carlo: {samples: 1000000000}}}
design: {speed_rad_s: {from: -260, to: -140}}
responses: {vibration: {amplitude_mean: {relative: true}}}
optimize: {minimize: vibration}
identify: {parameters: {friction_coefficient: {from: 1.0e-3, to: 6.0e-3}}}
"""


@pytest.fixture(scope="session")
def program():
    """Calls the program with arguments."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    path = os.environ.get("STICKSLIP", target / "release/stickslip")

    def call(*arguments, code=0):
        command = [str(path), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == code, done.stderr
        return done

    return call


@pytest.fixture(scope="session")
def small():
    return stickslip.Study.from_text(SMALL)


@pytest.fixture(scope="session")
def small_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("small") / "small.yaml"
    path.write_text(SMALL)
    return path


@pytest.fixture(scope="session")
def small_results(program, small_file):
    """What the program makes of the small study."""
    out = small_file.parent / "results"
    # Some runs fail, which are rows like any others.
    program("run", small_file, "--quiet", "--out", out, code=3)
    return out


def bits(table):
    """A table in which numbers are what they are in memory, and words are text."""
    columns = {}
    for name, column in zip(table.column_names, table.columns):
        if pyarrow.types.is_dictionary(column.type):
            column = column.cast(pyarrow.string())
        column = column.combine_chunks()
        if pyarrow.types.is_float64(column.type):
            column = column.view(pyarrow.int64())
        columns[name] = column
    return pyarrow.table(columns)


def assert_same(table, path):
    """The table is that of a file: names, types, units, provenance and every bit."""
    mine, file = pyarrow.table(table), pyarrow.parquet.read_table(path)
    assert mine.num_rows == len(table)
    assert mine.schema.equals(file.schema, check_metadata=False)
    for name in file.schema.names:
        metadata = dict(file.schema.field(name).metadata)
        metadata.pop(b"PARQUET:field_id", None)
        assert dict(mine.schema.field(name).metadata) == metadata
    about = pyarrow.parquet.read_metadata(path).metadata
    assert mine.schema.metadata[b"stickslip"] == about[b"stickslip"]
    assert bits(mine).equals(bits(file))
