#!/usr/bin/env python3
"""Checks that pandas, Polars and DuckDB read the same values as pyarrow from all tables of a directory of results.

    pip install pandas pyarrow polars duckdb
    python scripts/open-tables.py results/preferred-equilibria

Tables are files or, if they are large, directories of files. Each reader reads one column at a time, in the stored order,
and the runs with a late rest by a condition, for which readers skip parts of the file. The exit code is 1 with a message
that names table, column and reader if values differ, and 2 if there are no tables.
"""

import sys
from pathlib import Path

import duckdb
import pandas
import polars
import pyarrow.compute as compute
import pyarrow.dataset as dataset


def files(table):
    """Returns the name of all files of a table for DuckDB and Polars."""
    return str(table / "*.parquet" if table.is_dir() else table)


def with_pandas(table, column):
    return pandas.read_parquet(table, columns=[column])[column]


def with_polars(table, column):
    return polars.scan_parquet(files(table)).select(column).collect()[column].to_pandas()


def with_duckdb(table, column):
    return duckdb.sql(f"select \"{column}\" from '{files(table)}'").df()[column]


def late_rests(runs, seconds):
    """Returns the number of runs that rest after a time, by reader."""
    late = (dataset.field("label") == "equilibrium") & (dataset.field("time_to_rest_s") > seconds)
    of_polars = (polars.col("label") == "equilibrium") & (polars.col("time_to_rest_s") > seconds)
    condition = f"label = 'equilibrium' and time_to_rest_s > {seconds!r}"
    return {
        "pyarrow": dataset.dataset(runs).count_rows(filter=late),
        "pandas": len(pandas.read_parquet(runs, columns=["run_id"], filters=late)),
        "polars": polars.scan_parquet(files(runs)).filter(of_polars).select(polars.len()).collect().item(),
        "duckdb": duckdb.sql(f"select count(*) from '{files(runs)}' where {condition}").fetchall()[0][0],
    }


def compare(table):
    """Compares all columns of a table."""
    whole = dataset.dataset(table)
    for column in whole.schema.names:
        expected = whole.to_table(columns=[column])[column].to_pandas()
        for read in (with_pandas, with_polars, with_duckdb):
            try:
                # Readers have their own types for words, lists and missing numbers.
                pandas.testing.assert_series_equal(
                    read(table, column).astype(object).where(lambda values: values.notna(), None),
                    expected.astype(object).where(lambda values: values.notna(), None),
                    check_exact=True,
                )
            except AssertionError as error:
                sys.exit(f"{table}: {column} {read.__name__.replace('_', ' ')} differs from pyarrow: {error}")
    print(f"{table.name}: {whole.count_rows()} rows and {len(whole.schema)} columns are equal in all readers")


def main(arguments):
    """Compares the readers; returns the exit code."""
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    tables = sorted(Path(arguments[0]).glob("*.parquet"))
    if not tables:
        print(f"{arguments[0]}: there are no tables", file=sys.stderr)
        return 2
    for table in tables:
        compare(table)
    runs = Path(arguments[0]) / "runs.parquet"
    times = dataset.dataset(runs).to_table(columns=["time_to_rest_s"])["time_to_rest_s"]
    found = late_rests(runs, compute.quantile(times, 0.5)[0].as_py())
    print("late rests:", ", ".join(f"{reader} {count}" for reader, count in found.items()))
    return 0 if len(set(found.values())) == 1 and found["pyarrow"] > 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
