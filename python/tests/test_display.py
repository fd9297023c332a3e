"""Tables as people see them: values, units and shape, within bounds."""

import re
from html.parser import HTMLParser

import pytest

import stickslip


@pytest.fixture(scope="module")
def points(small):
    return small.run().points


def test_text_has_values_units_and_shape(points):
    lines = repr(points).splitlines()
    assert lines[0] == f"<stickslip.Table of 4 rows and {points.num_columns} columns>"
    assert lines[1].split()[:2] == ["point_id", "speed_rad_s"]
    assert "rad/s" in lines[2].split()
    assert [line.split()[1] for line in lines[3:7]] == ["-160.81", "-160.81", "-216.377", "-216.377"]
    # Numbers are aligned on the right, under the end of the name.
    end = lines[1].index("speed_rad_s") + len("speed_rad_s")
    assert {line[end - 1 : end + 2].strip() for line in lines[3:5]} == {"1"}
    assert {line[end - 1 : end + 2].strip() for line in lines[5:7]} == {"7"}
    shown = len(lines[1].split())
    assert f"{points.num_columns - shown} further columns: {points.column_names[shown]}" in lines[7]
    assert max(map(len, lines)) < 200


def test_the_middle_of_a_long_table_is_left_out(small):
    runs = small.run().runs
    lines = repr(runs).splitlines()
    numbers = [line.split()[0] for line in lines[3:14]]
    assert numbers == ["0", "1", "2", "3", "4", "…", "91", "92", "93", "94", "95"]


class Cells(HTMLParser):
    """The cells of a table, by rows."""

    def __init__(self, text):
        super().__init__()
        self.rows, self.titles, self.open = [], [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.titles.append(dict(attributes).get("title"))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data


def test_html_is_a_bounded_table(small):
    runs = small.run().runs
    html = Cells(runs._repr_html_())
    assert html.rows[0][:2] == runs.column_names[:2] and html.rows[0][-1] == "…"
    assert len(html.rows) == 2 + 11 and {len(row) for row in html.rows} == {25}
    assert html.titles[0] == runs.meanings["run_id"]
    assert html.rows[2][0] == "0" and html.rows[-1][0] == "95"


def test_text_of_files_is_escaped():
    """Names of choices come from the user and are shown as they are, not interpreted."""
    study = stickslip.Study.from_dict(
        {
            "schema": 1,
            "name": "names",
            "seed": 1,
            "model": {"kind": "block_on_spring"},
            "initial_conditions": {"design": {"monte_carlo": {"samples": 1}}},
            "simulation": {"end_time_s": 0.1},
            "design": {"spring": {"choices": {"soft": {"stiffness_n_m": 10}, "stiff": {"stiffness_n_m": 90}}}},
            "responses": {"soon": {"at_rest_by_s": 0.1}},
        }
    )
    answers = study.evaluate([{"spring": "soft"}])
    assert "soft" in repr(answers) and "soft" in answers._repr_html_()

    class Hostile:
        num_rows = num_columns = 1
        units, meanings = {"<b>": '"<i>"'}, {"<b>": "\"'><script>"}

        def __len__(self):
            return 1

        def _rows(self, first, count):
            return {"<b>": ["<script>alert(1)</script>\x1b[31m"]}

    from stickslip import _display

    assert "<script" not in _display.html(Hostile()) and "&lt;script" in _display.html(Hostile())
    assert "\x1b" not in _display.text(Hostile()) + _display.html(Hostile())


def test_tables_without_rows(small):
    cycles = stickslip.Study.from_text(small.yaml).run().cycles
    empty = cycles if len(cycles) == 0 else stickslip.simulate({}, simulation={"end_time_s": 0.001}).switches
    assert re.match(r"<stickslip.Table of 0 rows and \d+ columns>", repr(empty))
    assert Cells(empty._repr_html_()).rows[0][0] == empty.column_names[0]


def test_rows_of_several_batches():
    study = stickslip.Study.from_dict(
        {
            "schema": 1,
            "name": "many",
            "seed": 4,
            "model": {"kind": "block_on_spring"},
            "initial_conditions": {"design": {"monte_carlo": {"samples": 70_000}}},
            "simulation": {"end_time_s": 0.001},
        }
    )
    runs = study.run().runs
    assert runs._rows(65_534, 4)["run_id"] == [65_534, 65_535, 65_536, 65_537]
    assert runs._rows(69_999, 5)["run_id"] == [69_999]
    assert runs._rows(70_000, 1)["run_id"] == []
