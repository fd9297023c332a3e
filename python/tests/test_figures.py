"""What figures of equilibria, motions and identifications show: marks at coordinates, axes, words."""

import hashlib
import json
import re

import numpy as np
import pyarrow.parquet
import pytest
import small_tables
from matplotlib.colors import to_hex

from stickslip import figures
from stickslip.figures import command, machine, paper, trajectory
from stickslip.figures.logarithmic import Curve, Curves, logarithmic


def panels(figure):
    """Axes without colour bars."""
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def titles(figure):
    return [axes.get_title("left").replace("\n", " ").replace("\u00a0", " ") for axes in panels(figure)]


def entries(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def dots(axes, colour=None):
    """Coordinates of marks that no line joins."""
    found = [
        np.column_stack(line.get_data())
        for line in axes.lines
        if line.get_linestyle() == "None" and (colour is None or to_hex(line.get_color()) == colour)
    ]
    return np.concatenate(found).tolist() if found else []


@pytest.mark.parametrize("parts", [1, 3])
def test_equilibrium_set(tmp_path, parts):
    sets = small_tables.equilibria(tmp_path / "sets", parts=parts)
    figure = figures.equilibrium_set(sets)
    assert titles(figure) == ["(a) speed −200 rad/s", "(b) speed −210 rad/s"]
    first, second = panels(figure)
    # The edge is where the angles differ by an odd multiple of a quarter turn.
    edge = np.concatenate([path.vertices for path in first.collections[-1].get_paths()])
    assert len(edge) > 100 and np.abs(np.cos(edge[:, 0] - edge[:, 1])).max() < 0.01
    # In the set the amplitude goes from 0 to 15 µm, in steps of 2 µm.
    levels = first.collections[0].levels
    assert levels == pytest.approx(np.arange(0, 18, 2))
    assert sorted(dots(first)) == [[2.0, 4.0], [3.0, 3.0], [4.0, 2.0]]
    stars, circles = (line for line in first.lines if line.get_linestyle() == "None")
    assert (stars.get_marker(), circles.get_marker()) == ("*", "o") and len(stars.get_xdata()) == 2
    assert "50.0 % of all positions are equilibria" in figure.alternative


def test_the_abscissa_is_ball_1(tmp_path):
    """Different balls: dry friction holds them only if ball 1 is in the first half of the turn."""
    sets = small_tables.equilibria(tmp_path / "sets")
    path = sets / "equilibrium_positions.parquet"
    table = pyarrow.parquet.read_table(path)
    margin = np.sin(table["beta_1_rad"].to_numpy() + 0.3)
    place = table.column_names.index("friction_margin")
    table = table.set_column(place, "friction_margin", pyarrow.array(margin))
    amplitude = 1e-5 * (2 + np.cos(table["beta_1_rad"].to_numpy()))
    place = table.column_names.index("amplitude_m")
    pyarrow.parquet.write_table(table.set_column(place, "amplitude_m", pyarrow.array(amplitude)), path)
    (axes,) = panels(figures.equilibrium_set(sets, points=[0]))
    edge = np.concatenate([path.vertices for path in axes.collections[-1].get_paths()])
    assert np.abs(np.sin(edge[:, 0] + 0.3)).max() < 0.01 and np.ptp(edge[:, 1]) > 6
    # Different balls are not exchanged.
    assert sorted(dots(axes)) == [[2.0, 4.0], [3.0, 3.0]]


def test_sets_that_have_no_picture(tmp_path):
    sets = small_tables.equilibria(tmp_path / "sets", samples=1000)
    with pytest.raises(figures.FiguresError, match="random samples.*--samples"):
        figures.equilibrium_set(sets)
    (sets / "equilibrium_positions.parquet").unlink()
    with pytest.raises(figures.FiguresError, match="without --no-set"):
        figures.equilibrium_set(sets)


def test_equilibrium_surface(tmp_path):
    sets = small_tables.equilibria(tmp_path / "sets")
    figure = figures.equilibrium_surface(sets, point=1)
    (axes,) = panels(figure)
    assert axes.get_zlim() == pytest.approx((0.0, 15.0)) and axes.get_xlim()[1] == pytest.approx(
        2 * np.pi, rel=0.05
    )
    assert "goes up to 15 µm" in figure.alternative
    assert "Without balls it is 12 µm." in figure.alternative
    assert entries(figure) == ["amplitude without balls: 12 µm"]


def test_numbers_of_the_machine():
    """The thesis's machine, from its table 3.2 by hand."""
    numbers = re.findall(r"(\w+): ([-\d.]+)$", small_tables.PARAMETERS, re.MULTILINE)
    parameters = {name: float(value) for name, value in numbers}
    assert machine.natural_frequency_rad_s(parameters) == pytest.approx(181.6327, abs=1e-3)
    assert machine.natural_frequency_rad_s({}) is None


def test_frictionless_branches(tmp_path):
    speeds = [-150.0, -160.0, -170.0, -190.0]
    small_tables.write(
        tmp_path,
        "frictionless_equilibria",
        {
            "speed_rad_s": [*speeds, -150.0, -160.0, -170.0],
            "kind": ["b1"] * 4 + ["a1_plus"] * 3,
            "stability": ["unstable", "unstable", "unstable", "stable"] + ["stable"] * 3,
            "beta_1_rad": [2.0, 2.0, 2.0, 2.0, 0.1, 0.2, 6.2],
            "beta_2_rad": [4.0, 4.0, 4.0, 4.0, 0.1, 0.2, 6.2],
        },
    )
    figure = figures.frictionless_branches(tmp_path)
    assert titles(figure) == ["(a) A1+", "(b) B1"]
    together, balanced = panels(figure)
    # Faster to the right; broken where the angle goes round.
    stable = together.lines[0].get_xydata()
    assert stable[:2].tolist() == [[150.0, 0.1], [160.0, 0.2]] and np.all(np.isnan(stable[2]))
    assert stable[3].tolist() == [170.0, 6.2]
    solid, dashed = (line for line in balanced.lines[:2])
    assert solid.get_xydata().tolist() == [[190.0, 2.0]] and dashed.get_xdata().tolist() == [150, 160, 170]
    assert solid.get_linestyle() == "-" != dashed.get_linestyle()
    assert balanced.get_xlim() == (150.0, 190.0) and balanced.get_xlabel() == "speed of the disc −ω [rad/s]"
    assert entries(figure) == ["stable", "unstable", "all balls together", "ball 1", "ball 2"]
    rule = [line for line in together.lines if len(line.get_xdata()) == 2 and line.get_ydata() == [0, 1]]
    assert rule[0].get_xdata()[0] == pytest.approx(181.6327, abs=1e-3)
    assert "B1 is stable at 1 of the 4 speeds" in figure.alternative


def test_branches_need_several_speeds(tmp_path):
    sets = small_tables.equilibria(tmp_path / "sets")
    with pytest.raises(figures.FiguresError, match="2 speeds.*--speeds=FROM:TO:N"):
        figures.frictionless_branches(sets)


def replay(folder, beta=(0.5, 0.7), rows=5):
    time = np.linspace(1.0, 2.0, rows)
    small_tables.write(
        folder,
        "trajectory",
        {
            "time_s": time,
            "x_m": 1e-6 * np.sin(50 * time),
            "y_m": 2e-6 * time,
            **{f"beta_{ball}_rad": (place + 4 * time) % (2 * np.pi) for ball, place in enumerate(beta, 1)},
            **{f"beta_unwrapped_{ball}_rad": place + 4 * time for ball, place in enumerate(beta, 1)},
            **{f"ball_speed_{ball}_rad_s": 4.0 + 0 * time for ball, _ in enumerate(beta, 1)},
        },
        {"run_id": 17},
    )
    return folder


def test_motion(tmp_path):
    figure = figures.motion(replay(tmp_path))
    angles, speeds, across, up = panels(figure)
    assert angles.get_xlim() == (1.0, 2.0) and figure.title == "Motion: Run 17 of small"
    assert up.lines[0].get_xydata() == pytest.approx(
        np.array([[1, 2], [1.25, 2.5], [1.5, 3], [1.75, 3.5], [2, 4]])
    )
    assert [axes.get_ylabel() for axes in panels(figure)] == [
        "angle of the balls [rad]",
        "speed of the balls [rad/s]",
        "x of the table [µm]",
        "y of the table [µm]",
    ]
    # Broken where the angle goes round, once here.
    assert len(angles.lines) == 2 and np.isnan(angles.lines[0].get_ydata()).sum() == 1
    assert entries(figure) == ["ball 1", "ball 2"]
    beside = figures.motion(replay(tmp_path, (0.5, 0.5)))
    assert entries(beside) == ["balls 1 and 2, side by side"] and len(panels(beside)[0].lines) == 1



def shown_texts(figure):
    """Returns the labels of axes, the entries of the legend and the labels of ticks within the axes."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            yield axis.label
            yield from (tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high)
    yield from (text for legend in figure.legends for text in legend.get_texts())


@pytest.mark.parametrize("width", ["single", "double"])
def test_labels_of_a_motion_do_not_overlap(tmp_path, width):
    figure = figures.motion(replay(tmp_path), width=width)
    with figures.style():
        figure.draw_without_rendering()
    texts = [text for text in shown_texts(figure) if text.get_visible() and text.get_text()]
    # Boxes of text are larger than its letters.
    boxes = [(text.get_text(), text.get_window_extent().padded(-2)) for text in texts]
    over = [
        (one, other)
        for place, (one, box) in enumerate(boxes)
        for other, another in boxes[:place]
        if box.overlaps(another)
    ]
    assert len(boxes) > 20 and over == []


def test_contact_of_a_motion(tmp_path):
    folder = replay(tmp_path, (0.5, 0.7), 9)
    plain = figures.motion(folder)
    assert entries(plain) == ["ball 1", "ball 2"] and "Crosses" not in plain.caption
    trajectory_table = pyarrow.parquet.read_table(folder / "trajectory.parquet")
    columns = {name: trajectory_table[name].to_pylist() for name in trajectory_table.column_names}
    closed = [False] * 3 + [True] * 4 + [False] * 2
    columns.update(touching_1_2=closed, touching_2_1=[False] * 9, gap_1_2_rad=[0.1] * 9)
    small_tables.write(folder, "trajectory", columns, {"run_id": 17})
    small_tables.write(
        folder,
        "touches",
        {
            "time_s": [0.5, 1.125, 1.375, 1.875],
            "ball_behind": [1, 1, 1, 1],
            "ball_ahead": [2, 2, 2, 2],
            "from": ["open", "open", "open", "closed"],
            "to": ["open", "open", "closed", "open"],
            "beta_behind_rad": [0.1, 1.0, 6.2, 1.0],
            "beta_ahead_rad": [0.3, 1.4, 0.2, 1.4],
        },
    )
    figure = figures.motion(folder)
    assert entries(figure) == ["ball 1", "ball 2", "balls touch", "impact"]
    assert "Wide grey: two balls touch. Crosses: impacts." in figure.caption
    angles, speeds, *_ = panels(figure)
    wide = [line for line in angles.lines if line.get_linewidth() == 4]
    assert len(wide) == 2 and len(speeds.lines) == 2
    for line, place in zip(wide, (0.5, 0.7)):
        x, y = np.array(line.get_xdata(), float), np.array(line.get_ydata(), float)
        seen = ~np.isnan(y)
        assert x[seen] == pytest.approx([1.375, 1.5, 1.625, 1.75])
        assert y[seen] == pytest.approx((place + 4 * x[seen]) % (2 * np.pi))
    # The impacts in the interval of the figure lie halfway between the balls, also across the angle 0.
    crosses = [line for line in angles.lines if line.get_marker() == "x"]
    middle = (6.2 + (0.2 + 2 * np.pi - 6.2) / 2) % (2 * np.pi)
    assert crosses[0].get_xydata() == pytest.approx(np.array([[1.125, 1.2], [1.375, middle]]))


def words_in(axes):
    """Words inside of the axes."""
    return [text.get_text().replace("\u00a0", " ") for text in axes.texts]


def steps(axes):
    """Heights and edges of the last histogram of the axes."""
    return axes.patches[-1].get_data()


def test_identification(tmp_path):
    figure = figures.identification(small_tables.identification(tmp_path))
    friction, pair, contact, first, second, legend = panels(figure)
    assert titles(figure) == [
        "(a) 0.003 (0.002 to 0.004)",
        "(b) correlation 0.13",
        "(c) 0.15 (0.01 to 0.29)",
        "(d) speed −160 rad/s",
        "(e) speed −200 rad/s",
        "",
    ]
    # Posteriors over the prior's range; density over prior density has the mean 1 where the prior is uniform.
    assert friction.get_xlim() == (1e-3, 6e-3) and friction.get_xscale() == "log"
    assert contact.get_xlim() == (0.0, 0.3) and contact.get_xscale() == "linear"
    for axes in (friction, contact):
        ratio, edges, _ = steps(axes)
        scaled = np.log(edges) if axes is friction else edges
        assert np.average(ratio, weights=np.diff(scaled)) == pytest.approx(1.0)
        assert axes.get_ylabel() == "density / prior's"
    ratio, edges, _ = steps(friction)
    assert np.all(ratio[(edges[1:] < 2e-3) | (edges[:-1] > 4e-3)] == 0) and ratio.max() > 3
    prior, interval = friction.lines[:2]
    assert list(prior.get_ydata()) == [1.0, 1.0] and list(interval.get_xdata()) == [2e-3, 4e-3]
    assert words_in(friction) == [] and words_in(contact) == ["not identified"]
    # Samples with the earlier parameter on the abscissa.
    samples = np.array(dots(pair))
    assert len(samples) == 1000 and 2e-3 <= samples[:, 0].min() < samples[:, 0].max() <= 4e-3
    assert pair.lines[0].get_rasterized() and pair.get_ylabel() == "contact friction\ncoefficient"
    # The smaller and the larger angle of each run at rest; -0.5 is 2π - 0.5.
    seen, predicted = (dots(first, colour) for colour in (paper.SERIES[1], paper.SERIES[0]))
    assert np.array(seen) == pytest.approx(np.array([[1.0, 2 * np.pi - 0.5], [2.5, 4.0]]))
    assert predicted == [[0.5, 2.0], [1.5, 3.0], [2.5, 4.0]]
    assert words_in(first) == ["predicted 75 %", "rests 2 of 2", "p = 0.500"]
    assert words_in(second) == ["predicted 75 %", "rests 2 of 4", "p = 0.002"]
    assert first.get_xlim() == (0, 2 * np.pi) and second.get_xlabel() == "smaller angle [rad]"
    said = legend.get_legend()
    assert [text.get_text() for text in said.get_texts()][-2:] == ["measured rest", "predicted rest"]
    verdict = "The model does not explain the 6 measured runs (p = 0.004)."
    assert said.get_title().get_text().replace("\n", " ").replace("\u00a0", " ") == verdict
    told = figure.alternative.replace("\u00a0", " ")
    assert "95 % interval 0.15 (0.01 to 0.29), not identified" in told and told.endswith(verdict)
    assert "speed −200 rad/s: 2 of 4 measured runs are at rest, predicted 75 %, p = 0.002" in told


def test_identification_of_other_numbers_of_balls(tmp_path):
    one = small_tables.identification(tmp_path / "one", parameters=1, balls=1)
    figure = figures.identification(one, width="single")
    _, first, second = panels(figure)
    assert titles(figure)[1] == "(b) speed −160 rad/s rests 2 of 2; predicted 75 %; p = 0.500"
    found, edges, _ = steps(first)
    assert found[np.searchsorted(edges, [1.0, 4.0]) - 1].tolist() == [50.0, 50.0] and found.sum() == 100.0
    assert entries(figure)[-2:] == ["measured rests", "predicted rests"]
    three = small_tables.identification(tmp_path / "three", parameters=3, balls=3, stages=2)
    figure = figures.identification(three, points=[1])
    shown = titles(figure)
    assert shown[6:8] == [
        f"({letter}) speed −200 rad/s, stage {stage} rests 2 of 4; predicted 75 %; p = 0.002"
        for letter, stage in (("g", 1), ("h", 2))
    ]
    assert len(shown) == 9 and "2 of 4 points are shown" in figure.caption
    assert steps(panels(figure)[-2])[0].sum() == pytest.approx(100.0)
    # Small numbers have their power of ten at the name of the axis.
    mass = panels(figure)[5]
    assert mass.get_xlabel() == "ball mass [10⁻⁴ kg]" and mass.xaxis.get_major_formatter()(1.5e-4) == "1.5"
    with pytest.raises(figures.FiguresError, match="no point 2; points are 0, 1"):
        figures.identification(three, points=[2])


def test_many_measured_points_are_thinned(tmp_path):
    folder = small_tables.identification(tmp_path, parameters=1, stages=8)
    figure = figures.identification(folder)
    assert len(panels(figure)) == 13 and "12 of 16 points are shown" in figure.caption


def test_directories_without_an_identification(tmp_path, capsys):
    with pytest.raises(
        figures.FiguresError, match=r"posterior\.parquet: the table is not there; `stickslip id"
    ):
        figures.identification(small_tables.equilibria(tmp_path / "sets"))
    folder = small_tables.identification(tmp_path / "inferred")
    summary = (folder / "identification.json").read_text()
    for text, problem in (
        ("{", "it cannot be read"),
        ("[]", "it is no object"),
        ("{}", "it has no parameters"),
        (summary.replace('"rejected"', '"other"'), r"it has no fit\.rejected"),
        (summary.replace("contact_friction", "other"), "not the parameters of identification.json"),
    ):
        (folder / "identification.json").write_text(text)
        with pytest.raises(figures.FiguresError, match=problem):
            figures.identification(folder)
    (folder / "identification.json").unlink()
    assert command.main([str(folder)]) == 1
    assert "identification.json: the file is not there; `stickslip identify" in capsys.readouterr().err
    (folder / "identification.json").write_text(summary)
    names = ("posterior.parquet", "fit.parquet", "positions.parquet", "identification.json")
    hashes = {name: {"sha256": hashlib.sha256((folder / name).read_bytes()).hexdigest()} for name in names}
    (folder / "files.json").write_text(json.dumps({"files": hashes}))
    assert command.main([str(folder), "--out", str(tmp_path / "drawn")]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'drawn/identification.svg'}\n"
    (folder / "identification.json").write_text(summary + " ")
    with pytest.raises(
        figures.FiguresError, match=r"identification\.json: it is not the file that was written"
    ):
        figures.identification(folder)


def test_a_long_motion_keeps_its_extremes():
    time = np.linspace(0, 1, 100_001)
    values = np.sin(2000 * time)
    values[54_321] = 7.0
    x, y = trajectory.thinned(time, values)
    assert len(x) < 5000 and y.max() == 7.0 and x[np.argmax(y)] == time[54_321]
    assert np.all(np.diff(x) > 0) and (x[0], x[-1]) == (0.0, 1.0)


def test_figures_of_missing_tables_are_omitted(tmp_path, capsys):
    """`stickslip equilibria --no-set` writes no positions: the figures of the set are omitted."""
    directory = small_tables.equilibria(tmp_path / "sets")
    (directory / "equilibrium_positions.parquet").unlink()
    assert command.main([str(directory), "--only", "equilibrium-set"]) == 1
    assert "equilibrium_positions" in capsys.readouterr().err
    assert command.main([str(directory), "--out", str(tmp_path / "drawn")]) == 1
    # Two speeds are no branches, so that there is nothing left to draw; the error says why.
    assert "equilibrium_positions" not in capsys.readouterr().err


def test_ticks_of_logarithmic_axes_are_short():
    curve = Curve([(1e-2, 1e-5), (1e4, 2e-5)])
    (axes,) = panels(logarithmic([Curves("", "x", "y", [curve])], columns=1, title="ticks"))
    shown = [axes.xaxis.get_major_formatter()(10.0**power) for power in (-4, -3, 0, 3, 4, 6)]
    assert shown == ["10⁻⁴", "0.001", "1", "1000", "10⁴", "10⁶"]
    assert [axes.yaxis.get_major_formatter()(value) for value in (2e-5, 0.5, 20000)] == ["2·10⁻⁵", "0.5", "2·10⁴"]
