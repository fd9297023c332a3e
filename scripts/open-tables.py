#!/usr/bin/env python3
"""Opens the tables of a study with pandas, Polars and DuckDB and checks that all three read the same values.

    pip install pandas pyarrow polars duckdb
    python scripts/open-tables.py results/preferred-equilibria

Prints one line per reader. The exit code is 1 if the values differ or a reader cannot read a table, and 2 if there are
no tables.
"""

import math
import sys
from pathlib import Path

import duckdb
import pandas
import polars

TABLES = ("runs", "points", "time_to_rest", "cycles", "equilibria")


def with_pandas(directory):
    """Returns the values read by pandas (with pyarrow)."""
    tables = (pandas.read_parquet(directory / f"{name}.parquet") for name in TABLES)
    runs, points, rest, cycles, equilibria = tables
    labels = runs["label"].value_counts()
    return {
        "rows": [len(runs), len(points), len(rest), len(cycles), len(equilibria)],
        "labels": {str(label): int(count) for label, count in labels.items() if count > 0},
        "runs of all points": int(points["runs"].sum()),
        "sum of end_time_s": float(runs["end_time_s"].sum()),
        "runs that came to rest": int(rest["came_to_rest"].sum()),
        "runs on classes of cycles": int(cycles["runs"].sum()),
        "sum of multipliers": float(sum(sum(row) for row in cycles["multipliers"].dropna())),
        "sum of amplitude_m": float(equilibria["amplitude_m"].sum()),
    }


def with_polars(directory):
    """Returns the values read by Polars."""
    tables = (polars.read_parquet(directory / f"{name}.parquet") for name in TABLES)
    runs, points, rest, cycles, equilibria = tables
    labels = runs.group_by("label").len()
    return {
        "rows": [runs.height, points.height, rest.height, cycles.height, equilibria.height],
        "labels": {str(label): count for label, count in labels.iter_rows()},
        "runs of all points": points["runs"].sum(),
        "sum of end_time_s": runs["end_time_s"].sum(),
        "runs that came to rest": rest["came_to_rest"].sum(),
        "runs on classes of cycles": cycles["runs"].sum(),
        "sum of multipliers": cycles["multipliers"].list.sum().sum(),
        "sum of amplitude_m": equilibria["amplitude_m"].sum(),
    }


def with_duckdb(directory):
    """Returns the values read by DuckDB."""
    connection = duckdb.connect()

    def ask(table, columns, rest=""):
        path = directory / f"{table}.parquet"
        path = str(path / "*.parquet" if path.is_dir() else path)
        question = f"select {columns} from read_parquet($path) {rest}"
        return connection.execute(question, {"path": path}).fetchall()

    labels = ask("runs", "label, count(*)", "group by label")
    return {
        "rows": [ask(table, "count(*)")[0][0] for table in TABLES],
        "labels": {str(label): count for label, count in labels},
        "runs of all points": int(ask("points", "coalesce(sum(runs), 0)")[0][0]),
        "sum of end_time_s": ask("runs", "coalesce(sum(end_time_s), 0)")[0][0],
        "runs that came to rest": int(ask("time_to_rest", "coalesce(sum(came_to_rest), 0)")[0][0]),
        "runs on classes of cycles": int(ask("cycles", "coalesce(sum(runs), 0)")[0][0]),
        "sum of multipliers": ask("cycles", "coalesce(sum(list_sum(multipliers)), 0)")[0][0],
        "sum of amplitude_m": ask("equilibria", "coalesce(sum(amplitude_m), 0)")[0][0],
    }


READERS = {
    f"pandas {pandas.__version__}": with_pandas,
    f"polars {polars.__version__}": with_polars,
    f"duckdb {duckdb.__version__}": with_duckdb,
}


def same(left, right):
    """Returns whether values are equal; sums may differ after nine digits."""
    if isinstance(left, float) or isinstance(right, float):
        return math.isclose(left, right, rel_tol=1e-9, abs_tol=1e-300)
    return left == right


def main(arguments):
    """Compares the readers; returns the exit code."""
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    directory = Path(arguments[0])
    missing = [name for name in TABLES if not (directory / f"{name}.parquet").exists()]
    if missing:
        print(f"{directory}: {missing[0]}.parquet is missing", file=sys.stderr)
        return 2
    first = None
    differences = 0
    for reader, read in READERS.items():
        found = read(directory)
        rows = ", ".join(f"{count} {name}" for name, count in zip(TABLES, found["rows"]))
        labels = ", ".join(f"{label} {count}" for label, count in sorted(found["labels"].items()))
        print(f"{reader}: {rows}; {labels}; end times add up to {found['sum of end_time_s']:.9g} s")
        first = first or found
        for what, value in found.items():
            if not same(first[what], value):
                differences += 1
                print(f"  {what}: {value}; the first reader has {first[what]}", file=sys.stderr)
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
