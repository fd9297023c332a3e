"""Figures of the report, drawn for print: each mark at its coordinates, legends, sheets, files, and the command."""

import base64
import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import matplotlib
import numpy as np
import pyarrow.parquet
import pytest
import small_tables
from matplotlib.colors import to_hex
from test_figures import panels, titles

import stickslip
from stickslip import figures
from stickslip.figures import command, paper
from stickslip.figures.drawn import column, draw_figure, read_figures


def axis(name="speed", unit="rad/s", ends=None, kind="linear", **more):
    return {"name": name, "unit": unit, "range": ends, "kind": kind, **more}


def layer(mark, name="one", colour=None, **more):
    return {"name": name, "colour": colour or {"series": 1}, "mark": mark, **more}


def drawn(layers, x=None, y=None, scale=None, others=(), **options):
    """Draws a figure of one panel and of others."""
    panel = {"title": "", "part": "", "x": x or axis(), "y": y or axis(), "scale": scale, "layers": layers}
    figure = {"id": "a", "title": "t", "caption": "c", "alternative": "a", "panels": [panel, *others]}
    return draw_figure(figure, **options)


def handles(legend):
    return {text.get_text(): handle for text, handle in zip(legend.get_texts(), legend.legend_handles)}


def test_lines_steps_bands_and_rules():
    band = layer("band", x=[0, 1, 2], low=[0, 1, 1], high=[1, 2, 2], steps=True)
    rules = [layer("rule", name="", colour="ink", upright=upright, at=0.5, label="here") for upright in (True, False)]
    line = layer("line", name="two", colour="faint", points=[0, 0, None, None, 2, 1], dashed=True)
    figure = drawn([band, layer("steps", points=[0, 0, 1, 1]), line, *rules])
    (axes,) = panels(figure)
    steps, dashed, upright, level = axes.lines
    assert steps.get_xydata().tolist() == [[0, 0], [1, 1]] and steps.get_drawstyle() == "steps-post"
    assert to_hex(steps.get_color()) == paper.SERIES[1] and not dashed.get_linestyle() == "-"
    assert np.isnan(dashed.get_xydata()[1]).all()
    assert upright.get_xdata() == [0.5, 0.5] and level.get_ydata() == [0.5, 0.5]
    assert [text.get_text() for text in axes.texts] == ["here", "here"]
    (area,) = axes.collections
    assert area.get_paths()[0].get_extents().bounds == (0, 0, 2, 2)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("speed [rad/s]", "speed [rad/s]")
    shown = handles(figure.legends[0])
    assert list(shown) == ["one", "two"] and shown["one"].get_color() == paper.SERIES[1]


def test_dots_and_intervals_of_a_name_have_one_legend_entry():
    x, y = [1.0, 2.0], [0.25, 0.5]
    intervals = layer("intervals", colour="equilibrium", x=x, low=[0.0, None], high=[0.5, None])
    dots = layer("dots", colour="equilibrium", symbol="triangle", x=x, y=y, tooltips={})
    nothing = layer("dots", name="none", symbol="disc", x=[], y=[], tooltips={})
    figure = drawn([intervals, dots, nothing], y=axis("fraction", "", [0, 1]))
    (axes,) = panels(figure)
    (container,) = axes.containers
    # An interval without known ends is not drawn.
    assert [bar.tolist() for bar in container[2][0].get_segments()] == [[[1.0, 0.0], [1.0, 0.5]]]
    assert axes.lines[-1].get_xydata().tolist() == [[1.0, 0.25], [2.0, 0.5]]
    assert axes.get_ylim() == (0, 1) and axes.get_ylabel() == "fraction"
    (entry,) = figure.legends[0].legend_handles
    assert entry.get_marker() == "^" and to_hex(entry.get_color()) == paper.LABELS["equilibrium"][0]


def test_rasters_cells_and_bars():
    scale = {"name": "amplitude [µm]", "range": [0.0, 4.0]}
    angle = axis("angle of ball 1", "rad", [0, 2 * np.pi], "angle")
    raster = layer("raster", name="", colour="scale", size=[3, 2], values=[0, 1, 2, 3, None, 4])
    figure = drawn([raster], angle, angle, scale)
    (image,) = panels(figure)[0].images
    shown = image.get_array()
    # Rows begin at the lower edge; a value that is missing leaves its place white.
    assert shown.filled(-1).tolist() == [[0, 1, 2], [3, -1, 4]] and image.origin == "lower"
    assert image.get_clim() == (0.0, 4.0) and figure.axes[1].get_ylabel() == "amplitude [µm]"
    assert [text.get_text() for text in panels(figure)[0].get_xticklabels()] == ["0", "π/2", "π", "3π/2", "2π"]

    cells = layer("cells", name="", colour="scale", edges=[0, 1, 0, 1, 1, 2, 0, 1], values=[3.0, None], tooltips={})
    logarithmic = axis("friction coefficient", "", [1e-3, 1e-1], "logarithmic")
    (axes,) = panels(drawn([cells], axis(ends=[0, 2]), logarithmic, scale))
    (drawn_cells,) = axes.collections
    assert len(drawn_cells.get_paths()) == 1 and drawn_cells.get_array().tolist() == [3.0]
    assert axes.get_yscale() == "log" and axes.get_ylim() == (1e-3, 1e-1)
    said = [axes.yaxis.get_major_formatter()(value) for value in (1e-5, 2e-5, 0.01, 200.0)]
    assert said == ["10⁻⁵", "2·10⁻⁵", "0.01", "200"]

    bars = layer("bars", x=[-0.2, 0.8], y=[0.5, -0.5], width=0.34, tooltips={})
    (axes,) = panels(drawn([bars], axis("", "", [-0.5, 1.5], "names", names=["mass", "radius"])))
    assert [bar.get_height() for bar in axes.patches] == [0.5, -0.5]
    assert [text.get_text() for text in axes.get_xticklabels()] == ["mass", "radius"]


def test_packed_columns():
    def packed(key, values, kind):
        return {key: base64.b64encode(np.array(values, dtype=kind).tobytes()).decode(), "from": -1.0, "to": 1.0}

    for found in (
        column([0.5, None]),
        column(packed("f", [0.5, np.nan], "<f4")),
        column(packed("w", [49150.5, 65535], "<u2")),
    ):
        assert found == pytest.approx(np.array([0.5, np.nan]), abs=2e-5, nan_ok=True)
    assert column(packed("b", [0, 127, 254, 255], "u1")) == pytest.approx(np.array([-1, 0, 1, np.nan]), nan_ok=True)
    assert column(packed("u", [7, 4_000_000_000], "<u4")).tolist() == [7, 4_000_000_000]


def test_equal_marks_with_other_names_have_their_own_legends():
    def panel(name):
        steps = layer("steps", name=name, points=[0, 0, 1, 1])
        return {"title": name, "part": "part", "x": axis(), "y": axis(), "scale": None, "layers": [steps]}

    figure = drawn([layer("steps", name="a", points=[0, 0, 1, 1])], others=[panel("b"), panel("c")])
    assert not figure.legends
    assert [axes.get_legend().get_texts()[0].get_text() for axes in panels(figure)] == ["a", "b", "c"]
    assert titles(figure) == ["(a)", "(b) b – part", "(c) c – part"]
    assert len(drawn([layer("steps", name="b", points=[0, 0, 1, 1])], others=[panel("b")]).legends) == 1


def test_more_than_twelve_panels_are_on_several_sheets():
    dots = layer("dots", symbol="dot", x=[1.0], y=[2.0], tooltips={})
    others = [
        {"title": f"point {k}", "part": "", "x": axis(), "y": axis(), "scale": None, "layers": [dots]} for k in range(1, 30)
    ]
    sheets = [drawn([dots], others=others, sheet=sheet) for sheet in (1, 2, 3)]
    assert [(len(panels(one)), one.sheets) for one in sheets] == [(12, 3), (12, 3), (6, 3)]
    assert titles(sheets[2])[-1] == "(ad) point 29"
    with pytest.raises(ValueError, match="sheet=4: there are 3"):
        drawn([dots], others=others, sheet=4)
    with pytest.raises(ValueError, match="width='triple': allowed are 'single', 'double'"):
        drawn([dots], width="triple")


def test_figures_of_results_show_their_tables(small_results):
    """The curve of a point is the one in the table; chosen points are the only ones."""
    figure = figures.draw(small_results, "time_to_rest", points=[1])
    (axes,) = panels(figure)
    table = pyarrow.parquet.read_table(small_results / "time_to_rest.parquet").to_pydict()
    of = [row for row, point in enumerate(table["point_id"]) if point == 1]
    (line,) = axes.lines
    assert line.get_drawstyle() == "steps-post"
    expected = [[table["time_s"][row], table["probability_at_rest"][row]] for row in of]
    # The longer coordinates are steps of a 65534th of the range, finer than any printer.
    for point in expected:
        assert np.isclose(line.get_xydata(), point, rtol=0, atol=1e-4).all(axis=1).any(), point
    assert "Kaplan-Meier" in figure.caption and "1 of 4 points are shown" in figure.caption
    with pytest.raises(stickslip.StudyError, match="found:   9"):
        figures.draw(small_results, "time-to-rest", points=[0, 9])


def test_every_figure_of_every_kind_of_results_is_drawn(program, small_results, tmp_path):
    """No figure gives a warning, and each has a title, a caption and words for those who do not see it."""
    (tmp_path / "study.yaml").write_text(
        "schema: 1\nname: numbers\nseed: 5\nmodel: {kind: ball_balancer}\n"
        "sweep: [{grid: {balls: [1, 2, 3], speed_rad_s: [-140, -160.8103]}}]\n"
        "uncertain: {friction_coefficient: {uniform: {min: 2.0e-3, max: 3.0e-3}}}\n"
        "initial_conditions: {design: {monte_carlo: {samples: 16}}}\nsimulation: {end_time_s: 2}\n"
    )
    program("run", tmp_path / "study.yaml", "--out", tmp_path / "out", "--quiet")
    for directory in (small_results, tmp_path / "out"):
        for one in read_figures(directory):
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                figure = draw_figure(one)
            assert figure.title and figure.caption and figure.alternative and panels(figure), one["id"]
    assert {"rank-correlations", "drawn-parameters"} <= set(figures.names(tmp_path / "out"))


def test_figures_of_a_search(program, tmp_path):
    (tmp_path / "study.yaml").write_text(
        "schema: 1\nname: search\nseed: 5\nmodel: {kind: block_on_spring}\n"
        "initial_conditions: {design: {monte_carlo: {samples: 4}}}\n"
        "design: {stiffness_n_m: {from: 1.0, to: 2.0}, mass_kg: {from: 0.5, to: 1.0}}\n"
        "responses: {stop: median_time_to_rest}\noptimize: {minimize: stop, designs: 8}\n"
    )
    found = stickslip.Study.from_yaml(tmp_path / "study.yaml").optimize(tmp_path / "out")
    assert figures.names(found) == figures.names(tmp_path / "out")
    assert "convergence" in figures.names(found) and found.plot(width="single").axes
    assert command.main([str(tmp_path / "out")]) == 0


def test_the_package_has_its_figures():
    """An import of the package is enough, and does not need matplotlib."""
    code = "import sys, stickslip; assert 'matplotlib' not in sys.modules; print(stickslip.figures.draw.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "draw\n"), done.stderr


def test_errors_say_what_and_the_remedy(small_results, tmp_path):
    for source in (None, 3, {"points": 1}):
        with pytest.raises(TypeError, match="source: wrong type\n(?s:.*)results such as those of study.run"):
            figures.draw(source, "map")
    for points in (0, "a", 1.5):
        with pytest.raises(TypeError, match="points: wrong type\n(?s:.*)a list of numbers of points"):
            figures.draw(small_results, "map", points=points)
    with pytest.raises(figures.FiguresError, match="no figure 'nothing' of these results; they have .*time-to-rest") as caught:
        figures.draw(small_results, "nothing")
    assert caught.value.directory == small_results and isinstance(caught.value, ValueError)
    with pytest.raises(stickslip.StudyError, match="nowhere"):
        figures.draw(tmp_path / "nowhere", "map")


def test_files_are_the_same_bytes_again(small_results, tmp_path):
    for kind in ("svg", "pdf", "png"):
        first, second = tmp_path / f"first.{kind}", tmp_path / f"second.{kind}"
        figures.draw(small_results, "time-to-rest").savefig(first)
        # Whatever the reader's own settings are.
        with matplotlib.rc_context({"font.size": 20.0, "svg.fonttype": "path", "svg.hashsalt": None}):
            figures.draw(small_results, "time-to-rest").savefig(second)
        assert first.read_bytes() == second.read_bytes(), kind
    code = "from stickslip import figures; import sys; figures.draw(sys.argv[1], 'time-to-rest').savefig(sys.argv[2])"
    environment = {**os.environ, "PYTHONHASHSEED": "7", "SOURCE_DATE_EPOCH": "1"}
    third = tmp_path / "third.svg"
    subprocess.run([sys.executable, "-c", code, small_results, third], env=environment, check=True)
    assert third.read_bytes() == (tmp_path / "first.svg").read_bytes()


def test_svg_has_words_a_title_and_a_description(small_results, tmp_path):
    figure = figures.draw(small_results, "time-to-rest", width="single")
    figure.savefig(tmp_path / "figure.svg")
    text = (tmp_path / "figure.svg").read_text()
    assert re.search(">probability of being at rest</(text|tspan)>", text) and "8px" in text
    assert '<title id="title">When the balls come to rest</title>' in text
    assert '<desc id="description">' in text and 'aria-labelledby="title description"' in text
    assert re.search(r'<svg [^>]*width="255\.118\d*pt"', text) and "dc:date" not in text
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(90)
    wide = figures.draw(small_results, "time-to-rest", width="double")
    assert wide.get_size_inches()[0] * 25.4 == pytest.approx(180)


def test_the_command_draws_what_there_is(small_results, tmp_path, capsys):
    out = tmp_path / "drawn"
    assert command.main([str(small_results), "--out", str(out), "--format", "svg"]) == 0
    printed = [Path(line) for line in capsys.readouterr().out.splitlines()]
    names = {re.sub(r"-\d+$", "", path.stem) for path in printed}
    assert names == set(figures.names(small_results)) and sorted(printed) == sorted(out.iterdir())
    assert all(path.read_text().startswith("<?xml") for path in printed)
    arguments = ["--only", "fractions", "--points", "0", "2", "--format", "png", "--out", str(out)]
    assert command.main([str(small_results), *arguments]) == 0
    assert capsys.readouterr().out == f"{out / 'fractions.png'}\n"


def test_exit_codes_of_the_command(small_results, tmp_path, capsys):
    assert command.main([str(small_results), "--only", "nothing"]) == 1
    assert "no figure 'nothing' of these results; they have" in capsys.readouterr().err
    assert command.main([str(tmp_path)]) == 1
    assert "error: " in capsys.readouterr().err
    (tmp_path / "file").write_text("in the way")
    sets = small_tables.equilibria(tmp_path / "sets")
    assert command.main([str(sets), "--out", str(tmp_path / "file")]) == 1
    assert "choose another directory with --out" in capsys.readouterr().err
    for wrong in ([], ["a", "b"], ["a", "--format", "gif"], ["a", "--points", "x"], ["a", "--dpi", "x"]):
        with pytest.raises(SystemExit) as ended:
            command.main(wrong)
        assert ended.value.code == 2
    with pytest.raises(SystemExit) as ended:
        command.main(["--help"])
    assert ended.value.code == 0 and "Examples:" in capsys.readouterr().out


def test_every_figure_says_what_it_shows():
    for name in figures.__all__:
        assert getattr(figures, name).__doc__, name
    for name, (draw, _) in command.FIGURES.items():
        assert draw.__name__ == name.replace("-", "_")
        assert "FiguresError" in draw.__doc__ and "width" in draw.__doc__ and "[" in draw.__doc__, name
