"""Responses of designs: every input format gives the same table as the program."""

import csv

import numpy
import pandas
import polars
import pyarrow
import pytest
from conftest import ROOT, SMALL, assert_same

import stickslip

PATH = ROOT / "studies/design.yaml"


@pytest.fixture(scope="module")
def text():
    text = PATH.read_text()
    assert "samples: 64" in text
    return text.replace("samples: 64", "samples: 6")


@pytest.fixture(scope="module")
def study(text):
    return stickslip.Study.from_text(text)


@pytest.fixture(scope="module")
def designs():
    with open(ROOT / "studies/designs.csv") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [
            {"speed_rad_s": float(row["speed_rad_s"]), "balls": int(row["balls"]), "material": row["material"]}
            for row in rows
        ]


@pytest.fixture(scope="module")
def answers(program, text, tmp_path_factory):
    folder = tmp_path_factory.mktemp("evaluate")
    (folder / "design.yaml").write_text(text)
    out = folder / "responses.parquet"
    program("evaluate", folder / "design.yaml", "--designs", ROOT / "studies/designs.csv", "--out", out, "--quiet")
    return out


def columns(designs):
    return {name: [row[name] for row in designs] for name in designs[0]}


def forms(designs):
    by_column = columns(designs)
    table = pyarrow.table(by_column)
    words = table.set_column(2, "material", table["material"].dictionary_encode())
    arrays = {name: numpy.array(values) for name, values in by_column.items()}
    frame = pandas.DataFrame(by_column)
    return {
        "rows": designs,
        "generator": (row for row in designs),
        "columns": by_column,
        "arrays": arrays,
        "other order": {name: by_column[name] for name in reversed(by_column)},
        "pyarrow": table,
        "words": words,
        "batches": pyarrow.Table.from_batches(table.to_batches(max_chunksize=3)),
        "polars": polars.DataFrame(by_column),
        "pandas": frame,
        "categories": frame.astype({"material": "category"}),
        "own table": None,
    }


@pytest.mark.parametrize("threads", [1, 3])
def test_answers_are_those_of_the_program(study, designs, answers, threads):
    table = study.evaluate(designs, threads=threads)
    assert_same(table, answers)
    assert table["discontinuous"].count(None) == 0


@pytest.mark.parametrize("form", list(forms([{"material": "steel", "balls": 1, "speed_rad_s": 1.0}] * 3)))
def test_designs_come_as_anything(study, designs, answers, form):
    first = study.evaluate(designs)
    assert_same(study.evaluate(ROOT / "studies/designs.csv"), answers)
    given = forms(designs)[form] if form != "own table" else first.to_pyarrow().select(list(designs[0]))
    assert_same(study.evaluate(given), answers)


class Frame(dict):
    """A dataframe of pandas without pyarrow."""

    def __arrow_c_stream__(self, requested_schema=None):
        raise ImportError("pyarrow is missing")


class Broken:
    """An object that does not give what it promises."""

    def __arrow_c_stream__(self, requested_schema=None):
        return self


def test_tables_that_cannot_be_handed_over(study, designs, answers):
    assert_same(study.evaluate(Frame(columns(designs))), answers)
    with pytest.raises(TypeError):
        study.evaluate(Broken())
    # A capsule of another kind.
    Broken.__arrow_c_stream__ = lambda self, requested_schema=None: study.evaluate(designs).__arrow_c_schema__()
    with pytest.raises(ValueError):
        study.evaluate(Broken())


class Interrupted:
    """An object in whose code Ctrl-C strikes."""

    def __float__(self):
        raise KeyboardInterrupt

    __iter__ = __len__ = keys = __length_hint__ = __float__


def test_an_interruption_on_the_way_is_not_lost(study, designs):
    struck = Interrupted()
    for given in [struck, [struck], [{**designs[0], "balls": struck}], {"balls": [struck]}, {"balls": struck}]:
        with pytest.raises(KeyboardInterrupt):
            study.evaluate(given)


def test_one_design(study, designs):
    one = study.evaluate(designs[4])
    assert len(one) == 1
    number = study.evaluate([designs[4]])
    assert one.to_dict() == number.to_dict()
    # A row of a larger table but for its number and its neighbours.
    row = {name: values[4] for name, values in study.evaluate(designs).to_dict().items()}
    for name, value in one.to_dict().items():
        if name not in ("design", "discontinuous"):
            assert value == [row[name]]


def test_each_point_of_a_sweep_has_a_row(small):
    table = small.evaluate({"friction_coefficient": [1e-3, 2e-3, 3e-3]})
    assert table["design"] == [0] * 4 + [1] * 4 + [2] * 4
    assert table["point_id"] == [0, 1, 2, 3] * 3
    assert table["normal_force"] == ["lagrange", "newton"] * 6


def test_same_errors_as_the_program(program, study, designs, text, tmp_path):
    (tmp_path / "design.yaml").write_text(text)
    wrong = {
        "speed_rad_s": [(-300.0, "out of range"), (float("nan"), "not a finite number"), ("fast", "not a number")],
        "balls": [(2.5, "not a whole number"), (4, "out of range")],
        "material": [("steal", "not a choice"), (3, "not a choice")],
    }
    for name, cases in wrong.items():
        for value, problem in cases:
            rows = [*designs[:2], {**designs[2], name: value}]
            with pytest.raises(stickslip.StudyError) as raised:
                study.evaluate(rows)
            assert (raised.value.problem, raised.value.key) == (problem, f"row 3, column {name}")
            path = tmp_path / "designs.csv"
            with open(path, "w", newline="") as file:
                writer = csv.DictWriter(file, list(rows[0]))
                writer.writeheader()
                writer.writerows(rows)
            out = tmp_path / "responses.parquet"
            command = ["evaluate", tmp_path / "design.yaml", "--designs", path, "--out", out]
            said = program(*command, code=2).stderr
            # Both messages have the same parts; only the place differs.
            theirs = said.split(f"`: {problem}", 1)[1].strip()
            if value == value:
                assert str(raised.value) == f"designs: `row 3, column {name}`: {problem}\n  {theirs}"


def test_designs_that_are_none(study, designs):
    full = designs[0]
    for given, problem in [
        ([], "a table without rows"),
        ([{}], "no column speed_rad_s"),
        ([{**full, "sped": 3}], "unknown column"),
        ([full, {"balls": 2, "material": "steel"}], "an empty value"),
        ({**columns(designs), "balls": [1]}, "an empty value"),
        ({**full, "balls": None}, "an empty value"),
        (pyarrow.table({"speed_rad_s": [True]}), "wrong type"),
        (pyarrow.table({"when": pyarrow.array([0], pyarrow.timestamp("s"))}), "unknown column"),
    ]:
        with pytest.raises(stickslip.StudyError) as raised:
            study.evaluate(given)
        assert raised.value.problem == problem
    for given in [3, [3], [full, "steel"], {**full, "balls": True}, {**full, "balls": numpy.True_}, {"balls": [1, [2]]}, {1: [2]}]:
        with pytest.raises(TypeError, match="allowed:"):
            study.evaluate(given)
    with pytest.raises(stickslip.StudyError, match="found:   no columns"):
        study.evaluate({})
    with pytest.raises(stickslip.StudyError, match="allowed: a name that ends in .csv or .parquet$"):
        study.evaluate("steel")
    with pytest.raises(stickslip.StudyError, match="row 1, column material`: text that is not Unicode"):
        study.evaluate({**full, "material": "\ud800"})
    with pytest.raises(TypeError, match="column material"):
        study.evaluate({**columns(designs), "material": "steel"})


def test_studies_without_designs_or_responses():
    for key, text in [("responses", "`responses` is missing"), ("design", "`design` is missing")]:
        lines = [line for line in SMALL.splitlines() if not line.startswith(f"{key}:")]
        study = stickslip.Study.from_text("\n".join(lines))
        with pytest.raises(stickslip.StudyError, match=text):
            study.evaluate([{"friction_coefficient": 2e-3}])
