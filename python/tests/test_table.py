"""Tables: Arrow's interface, without a copy, and Python's lists."""

import gc

import duckdb
import pandas
import polars
import pyarrow
import pytest
from conftest import bits

import stickslip


@pytest.fixture(scope="module")
def runs(small):
    return small.run().runs


def test_no_copy_is_made(runs):
    first, second = pyarrow.table(runs), pyarrow.table(runs)
    for name in ("amplitude_m", "run_id", "initial_beta_1"):
        mine, other = (table[name].chunk(0).buffers()[1].address for table in (first, second))
        assert mine == other


def test_what_was_handed_over_outlives_the_table(small):
    results = small.run()
    copy = results.runs.to_dict()
    table = pyarrow.table(results.runs)
    column = table["amplitude_m"]
    del results, table
    gc.collect()
    assert column.to_pylist() == copy["amplitude_m"]


def test_capsules_that_nobody_takes_are_freed(runs):
    for _ in range(100):
        runs.__arrow_c_stream__()
        runs.__arrow_c_schema__()
    capsule = runs.__arrow_c_stream__(None)
    assert "arrow_array_stream" in repr(capsule)
    assert pyarrow.schema(runs) == pyarrow.table(runs).schema


def test_readers_agree(runs):
    lists = runs.to_dict()
    assert list(lists) == runs.column_names
    assert runs.num_columns == len(lists)
    arrow = runs.to_pyarrow()
    assert arrow.to_pydict() == lists
    assert runs.to_polars().to_dict(as_series=False) == lists
    frame = runs.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and len(frame) == len(runs)
    assert frame["label"].tolist() == lists["label"] == runs["label"]
    assert duckdb.sql("select count(*), sum(run_id) from runs").fetchall()[0] == (96, sum(range(96)))
    assert polars.DataFrame(runs).height == 96


def test_every_kind_of_column(small):
    results = small.run()
    for name in ("runs", "points", "time_to_rest", "cycles", "equilibria", "equilibrium_histogram"):
        table = getattr(results, name)
        assert table.to_dict() == table.to_pyarrow().to_pydict()
        assert repr(table).startswith(f"<stickslip.Table of {len(table)} row")
    assert bits(pyarrow.table(results.points)).num_rows == 4


def test_a_table_of_several_batches():
    study = stickslip.Study.from_text("""
schema: 1
name: many
seed: 4
model: {kind: block_on_spring}
sweep: [{grid: {friction_coefficient: [0.2, 0.5]}}]
initial_conditions: {design: {monte_carlo: {samples: 70000}}}
simulation: {end_time_s: 0.02}
""")
    results = study.run()
    arrow = pyarrow.table(results.runs)
    assert arrow["run_id"].num_chunks > 1
    assert arrow["run_id"].to_pylist() == list(range(140_000))
    labels = {entry["values"]: entry["counts"] for entry in arrow["label"].value_counts().to_pylist()}
    assert labels == {label: runs for label, runs in results.labels.items() if runs}
    assert len(labels) > 1
    assert dict(results.runs.to_pandas()["label"].value_counts()) == labels
    assert results.runs.to_polars()["label"].cast(polars.String).to_list() == arrow["label"].to_pylist()


def test_units_and_meanings(runs):
    assert runs.units["amplitude_m"] == "m"
    assert runs.units["label"] is None
    assert "how the run ended" in runs.meanings["label"]
    assert set(runs.units) == set(runs.meanings) == set(runs.column_names)


def test_columns_that_are_not_there(runs):
    with pytest.raises(KeyError, match="amplitude_m"):
        runs["amplitude"]
    assert "amplitude_m" in runs and "amplitude" not in runs and 0 not in runs
    # A row, and a loop over rows.
    for call in (lambda: runs[0], lambda: runs[:3], lambda: list(runs)):
        with pytest.raises(TypeError, match=r"column: wrong type(?s:.*)`to_pandas\(\)` and `to_polars\(\)` have rows"):
            call()
