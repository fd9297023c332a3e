"""What figures show: marks at coordinates, axes, words; and the command that draws them."""

import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import matplotlib
import numpy as np
import pyarrow.parquet
import pytest
import small_tables
from matplotlib.colors import to_hex

from stickslip import figures
from stickslip.figures import attraction, command, machine, paper, runs, trajectory
from stickslip.figures.logarithmic import Curve, Curves, logarithmic
from stickslip.figures.maps import edges

PACKAGE = Path(figures.__file__).parents[2]


@pytest.fixture
def results(tmp_path):
    return small_tables.results(tmp_path / "results")


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


def bars(container):
    """Lower and upper ends of the intervals of a series."""
    (segments,) = (bar.get_segments() for bar in container[2])
    return [[float(low), float(high)] for (_, low), (_, high) in segments]


def test_preferred_equilibria_are_dots_over_the_histogram(results):
    figure = figures.preferred_equilibria(results)
    assert titles(figure) == ["(a) speed −200 rad/s: 2 of 4 at rest", "(b) speed −210 rad/s: 1 of 4 at rest"]
    first, second = panels(figure)
    assert dots(first) == [[1.0, 4.0], [2.0, 5.0]] and dots(second) == [[5.0, 2.0]]
    # Rows belong to ball 2, values are in per cent; identical balls have no order.
    cells = first.collections[0].get_array()
    assert cells.shape == (4, 4)
    shown = {(row, column): cells[row, column] for row, column in zip(*np.nonzero(~cells.mask))}
    assert shown == {(2, 0): 50.0, (0, 2): 50.0, (3, 1): 50.0, (1, 3): 50.0}
    assert first.get_xlim() == first.get_ylim() == (0, 2 * np.pi)
    assert [text.get_text() for text in second.get_xticklabels()] == ["0", "π/2", "π", "3π/2", "2π"]
    assert "2 of 4 runs came to rest, and 25 % of all positions are equilibria" in figure.alternative.replace(
        "\u00a0", " "
    )


def test_preferred_equilibria_over_their_set(results, tmp_path):
    sets = small_tables.equilibria(tmp_path / "sets", parts=3)
    figure = figures.preferred_equilibria(results, equilibria=sets, points=[1])
    (axes,) = panels(figure)
    assert dots(axes, "#000000") == [[5.0, 2.0]]
    assert entries(figure) == [
        "run at rest",
        "edge of the equilibrium set",
        "stable without friction",
        "unstable without friction",
    ]
    # Identical balls: the exchanged positions are drawn, too.
    assert sorted(dots(axes, paper.SERIES[1])) == [[2.5, 3.5], [3.5, 2.5]]


def test_sets_of_another_study_are_refused(results, tmp_path):
    sets = small_tables.equilibria(tmp_path / "sets", study_hash="1" * 64)
    with pytest.raises(figures.FiguresError, match=r"another study.*stickslip equilibria .*study\.yaml"):
        figures.preferred_equilibria(results, equilibria=sets)
    with pytest.raises(ValueError, match="equilibria="):
        figures.preferred_equilibria(results, background="set")


def test_ending_fractions(results):
    figure = figures.ending_fractions(results)
    (axes,) = panels(figure)
    assert entries(figure) == ["equilibrium", "limit cycle", "undecided", "failed"]
    series = {container.get_label(): container for container in axes.containers}
    assert series["equilibrium"][0].get_xydata().tolist() == [[-210.0, 0.25], [-200.0, 0.5]]
    assert bars(series["equilibrium"]) == [[0.125, 0.625], [0.25, 0.75]]
    assert series["failed"][0].get_ydata().tolist() == [0.5, 0.0]
    assert bars(series["failed"]) == [[0.4, 0.6], [0.0, 0.1]]
    assert axes.get_xlabel() == "speed [rad/s]" and axes.get_ylim() == (0, 1)
    # In black and white, too: marks and dashes differ.
    looks = [(line.get_marker(), line.get_linestyle()) for line, *_ in series.values()]
    assert len({mark for mark, _ in looks}) == 4
    assert "between 0.250 and 0.500" in figure.alternative


def test_points_that_are_no_numbers_stand_side_by_side(tmp_path):
    small_tables.points(
        tmp_path, {"normal_force": ["lagrange", "newton"]}, [[3, 0, 0, 1, 0], [1, 0, 0, 3, 0]]
    )
    (axes,) = panels(figures.ending_fractions(tmp_path))
    assert [text.get_text() for text in axes.get_xticklabels()] == ["lagrange", "newton"]
    assert axes.containers[0][0].get_xydata().tolist() == [[0.0, 0.75], [1.0, 0.25]]
    assert axes.get_xlabel() == "normal force"


def test_time_to_rest(results):
    figure = figures.time_to_rest(results)
    (axes,) = panels(figure)
    first, second = axes.lines
    assert first.get_xydata().tolist() == [[0.0, 0.0], [1.0, 0.25], [2.0, 0.5], [10.0, 0.5], [16.5, 0.5]]
    assert second.get_xydata().tolist() == [[0.0, 0.0], [3.0, 0.5], [10.0, 0.5], [16.5, 0.5]]
    assert first.get_drawstyle() == "steps-post" and first.get_linestyle() != second.get_linestyle()
    # Half of the runs of the second point failed: at rest at once, or never.
    band = axes.collections[1].get_paths()[0].vertices
    assert band[:, 1].min() == 0.0 and band[:, 1].max() == pytest.approx(0.8 * 0.5 + 0.5)
    assert entries(figure) == ["−200", "−210 (2 failed)"]
    assert figure.legends[0].get_title().get_text() == "speed [rad/s]"
    # To the end time of the study, where nothing happens any more.
    assert axes.get_xlim() == (0, 16.5)
    assert "Failed runs are left out: 2 of 4 at speed −210" in figure.caption


def test_amplitudes(results):
    figure = figures.amplitudes(results)
    (axes,) = panels(figure)
    curve = axes.lines[0].get_xydata()
    assert curve[:, 0] == pytest.approx([0.5, 0.5, 0.9, 2.0])
    assert curve[:, 1].tolist() == [0.25, 0.5, 0.75, 1.0]
    assert axes.get_xscale() == "log" and axes.get_xlabel() == "amplitude / amplitude without balls"
    assert "25.0 % of the runs vibrate more than without balls" in figure.alternative
    assert [line.get_xdata() for line in axes.lines][-1] == [1.0, 1.0]


def test_many_curves_are_in_several_panels(tmp_path):
    count = 14
    small_tables.points(
        tmp_path, {"speed_rad_s": [-200.0 - k for k in range(count)]}, [[4, 0, 0, 0, 0]] * count
    )
    small_tables.write(
        tmp_path,
        "time_to_rest",
        {
            "point_id": list(range(count)),
            "time_s": [1.0] * count,
            "probability_at_rest": [0.5] * count,
            "ci_low": [0.4] * count,
            "ci_high": [0.6] * count,
        },
    )
    small_tables.write(tmp_path, "runs", {"run_id": [0], "beta_1_rad": [0.0]})
    figure = figures.time_to_rest(tmp_path)
    assert titles(figure) == ["(a) points 0 to 4", "(b) points 5 to 9", "(c) points 10 to 13"]
    own = [[text.get_text() for text in axes.get_legend().get_texts()] for axes in panels(figure)]
    assert own[1] == ["−205", "−206", "−207", "−208", "−209"] and not figure.legends


def test_basins(results, monkeypatch):
    figure = figures.basins(results)
    # Six pairs of coordinates at each of two points.
    assert len(panels(figure)) == 12 and figure.sheets == 1
    first = panels(figure)[0]
    assert dots(first, paper.LABELS["equilibrium"][0]) == [[2.5, 3.5], [2.75, 3.75]]
    assert dots(first, paper.LABELS["undecided"][0]) == [[3.25, 4.25]]
    assert dots(panels(figure)[6], "#000000") == [[4.0, 5.0], [4.25, 5.25]]
    assert first.get_xlabel() == "β₁ at the start [rad]"
    assert panels(figure)[3].get_ylabel() == "y\u0307 at the start"
    assert entries(figure) == ["equilibrium", "limit cycle", "undecided", "failed"]
    assert "3 equilibrium, 1 limit cycle, 2 undecided, 2 failed" in figure.alternative
    monkeypatch.setattr(attraction, "_MOST_DOTS", 24)
    few = figures.basins(results)
    shown = int(re.search(r"Subsample: (\d+) of 8 runs are shown, about one in 2\.", few.caption)[1])
    assert shown == np.count_nonzero(runs.scattered(np.arange(8), 2)) < 8
    assert few.legends[0].get_title().get_text() == f"subsample: {shown} of 8 runs"
    # The one pair of angles at both points has a dot for each run.
    assert len(dots(panels(few)[0])) + len(dots(panels(few)[6])) == shown


def test_scattered_runs_are_in_all_cells():
    """Counts are binomial; 6 standard deviations would be exceeded once in 10^8."""
    for cells, one_in in ((2, 2), (3, 3), (256, 2), (6561, 7)):
        expected = 300_000 / one_in / cells
        found = np.count_nonzero(runs.scattered(np.arange(0, 300_000, cells), one_in))
        assert abs(found - expected) < 6 * np.sqrt(expected) + 1
    assert np.all(runs.scattered(np.arange(100), 1))


def test_limit_cycle_branches(results):
    figure = figures.limit_cycle_branches(results)
    named = {axes.get_ylabel(): axes for axes in panels(figure)}
    assert list(named) == [
        "fraction of the runs",
        "period [s]",
        "RMS amplitude [µm]",
        "speed of ball 1 [rad/s]",
        "largest multiplier",
    ]
    assert entries(figure) == ["class −1|0:SB"]
    fraction, amplitude = (
        named[name].containers[0] for name in ("fraction of the runs", "RMS amplitude [µm]")
    )
    assert fraction[0].get_xydata().tolist() == [[-210.0, 0.75], [-200.0, 0.25]]
    assert np.array(bars(fraction)) == pytest.approx(np.array([[0.3, 0.95], [0.05, 0.7]]))
    assert amplitude[0].get_ydata() == pytest.approx([2.0, 1.0])
    small_tables.write(results, "cycles", {"point_id": [7], "class": ["0"], "runs": [1]})
    with pytest.raises(figures.FiguresError, match="no run of these points ended in a limit cycle"):
        figures.limit_cycle_branches(results)


def test_diagnostics(results):
    figure = figures.diagnostics(results)
    (axes,) = panels(figure)
    series = {container.get_label(): container[0] for container in axes.containers}
    assert series["failed"].get_xydata().tolist() == [[0.0, 0.0], [1.0, 0.5]]
    assert series["undecided"].get_ydata().tolist() == [0.25, 0.25]
    assert series["flips, of audited runs"].get_xydata().tolist() == [[0.16, 0.25]]
    assert figure.alternative.startswith("2 runs failed, 2 runs are undecided. 1 of 4 audited runs")


def test_label_map(tmp_path):
    grid = [(speed, friction) for friction in (1e-3, 2e-3, 4e-3) for speed in (-220.0, -210.0, -190.0)]
    swept = {"speed_rad_s": [speed for speed, _ in grid], "friction_coefficient": [f for _, f in grid]}
    small_tables.points(tmp_path, swept, [[place, 0, 0, 10 - place, 0] for place in range(9)])
    figure = figures.label_map(tmp_path)
    assert titles(figure) == [
        "(a) fraction of runs in equilibrium",
        "(b) median time to rest",
        "(c) median of amplitude / amplitude without balls",
        "(d) fraction of positions in the equilibrium set",
    ]
    first, times, amplitude, _ = (axes.collections[0] for axes in panels(figure))
    assert np.array(first.get_array()) == pytest.approx(np.arange(9).reshape(3, 3) / 10)
    assert first.get_clim() == (0.0, 1.0)
    # Only one point has a median; the others are left white.
    assert times.get_array().mask.sum() == 8 and times.get_array()[0, 0] == 1.5
    assert np.all(np.array(amplitude.get_array()) == 2.0)
    bottom = panels(figure)[2]
    assert (bottom.get_xlabel(), bottom.get_ylabel()) == ("speed [rad/s]", "friction coefficient")
    assert bottom.get_xlim() == (-225.0, -180.0) and bottom.get_ylim() == (0.0005, 0.005)


def test_words_at_ticks(tmp_path):
    values = [1e-6, 2e-6, 5e-4, 2e-2]
    small_tables.points(tmp_path, {"friction_coefficient": values}, [[4, 0, 0, 0, 0]] * 4)
    (axes,) = panels(figures.ending_fractions(tmp_path))
    assert axes.get_xscale() == "log"
    said = [axes.xaxis.get_major_formatter()(value) for value in (1e-5, 2e-5, 0.01, 200.0)]
    assert said == ["10⁻⁵", "2·10⁻⁵", "0.01", "200"]


def test_a_map_needs_two_parameters(results):
    with pytest.raises(figures.FiguresError, match=r"points\.parquet: 0 of its swept.*ending_fractions"):
        figures.label_map(results)


def test_cells_touch():
    assert edges(np.array([1.0, 2.0, 4.0])).tolist() == [0.5, 1.5, 3.0, 5.0]
    middle = np.sqrt(10.0)
    assert edges(np.array([1e-4, 1e-3, 1e-2])) == pytest.approx(np.array([1e-4, 1e-3, 1e-2, 1e-1]) / middle)


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


def test_directories_without_an_identification(results, tmp_path, capsys):
    with pytest.raises(
        figures.FiguresError, match=r"posterior\.parquet: the table is not there; `stickslip id"
    ):
        figures.identification(results)
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


def test_more_than_twelve_panels_are_on_several_sheets(tmp_path):
    small_tables.points(
        tmp_path,
        {"speed_rad_s": [-200.0 - k for k in range(30)]},
        [[4, 0, 0, 0, 0]] * 30,
    )
    some = list(range(30))
    small_tables.write(
        tmp_path,
        "runs",
        {
            "run_id": some,
            "point_id": some,
            "label": ["equilibrium"] * 30,
            "beta_1_rad": [0.1 * k for k in some],
            "beta_2_rad": [1.0] * 30,
        },
    )
    first, second = (
        figures.preferred_equilibria(tmp_path, background="none", sheet=sheet) for sheet in (1, 2)
    )
    assert (len(panels(first)), len(panels(second)), first.sheets) == (12, 12, 2)
    assert titles(first)[0].startswith("(a) speed −200 ") and titles(second)[-1].startswith("(x) speed −229 ")
    assert "24 of 30 points are shown." in first.caption
    (one,) = panels(figures.preferred_equilibria(tmp_path, background="none", points=[7]))
    assert dots(one) == [[pytest.approx(0.7), 1.0]]
    with pytest.raises(ValueError, match="sheet=3: there are 2"):
        figures.preferred_equilibria(tmp_path, background="none", sheet=3)
    with pytest.raises(figures.FiguresError, match="no point 30; points are 0 to 29"):
        figures.preferred_equilibria(tmp_path, points=[30])


def test_the_package_has_its_figures():
    """An import of the package is enough, and does not need matplotlib."""
    code = "import sys, stickslip; assert 'matplotlib' not in sys.modules; print(stickslip.figures.time_to_rest.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "time_to_rest\n"), done.stderr


def test_arguments_of_wrong_types_are_named(results):
    for source in (None, 3, {"points": 1}):
        with pytest.raises(TypeError, match="directory: wrong type\n(?s:.*)results such as those of study.run"):
            figures.time_to_rest(source)
    for points in (0, "a", 1.5):
        with pytest.raises(TypeError, match="points: wrong type\n(?s:.*)a list of numbers of points"):
            figures.time_to_rest(results, points=points)
    with pytest.raises(figures.FiguresError, match="`points` names none; points are 0 to"):
        figures.time_to_rest(results, points=[])


def test_errors_say_where_what_and_the_remedy(results, tmp_path):
    with pytest.raises(figures.FiguresError, match="there is no such directory") as caught:
        figures.time_to_rest(tmp_path / "nowhere")
    assert caught.value.directory == tmp_path / "nowhere" and isinstance(caught.value, ValueError)
    with pytest.raises(
        figures.FiguresError, match=r"trajectory\.parquet: the table is not there; `stickslip replay"
    ):
        figures.motion(results)
    small_tables.write(results, "time_to_rest", {"point_id": [0], "time_s": [1.0]})
    with pytest.raises(
        figures.FiguresError, match="no columns probability_at_rest, ci_low, ci_high .*0\\.1\\.0"
    ):
        figures.time_to_rest(results)
    (results / "runs.parquet").write_bytes(b"PAR1 nothing")
    with pytest.raises(figures.FiguresError, match=r"runs\.parquet: it cannot be read"):
        figures.basins(results)
    (results / "manifest.json").write_text('{"files": {"runs.parquet": {"bytes": 5}}}')
    with pytest.raises(figures.FiguresError, match=r"points\.parquet: it is not on the directory's list"):
        figures.ending_fractions(results)
    listed = hashlib.sha256((results / "points.parquet").read_bytes()).hexdigest()
    (results / "manifest.json").write_text(f'{{"files": {{"points.parquet": {{"sha256": "{listed}"}}}}}}')
    assert len(panels(figures.ending_fractions(results))) == 1
    small_tables.points(results, {"speed_rad_s": [-200.0]}, [[1, 0, 0, 0, 0]])
    with pytest.raises(figures.FiguresError, match="it is not the file that was written"):
        figures.ending_fractions(results)
    with pytest.raises(ValueError, match="width='triple': allowed are 'single', 'double'"):
        (results / "manifest.json").unlink()
        figures.ending_fractions(results, width="triple")


def test_files_are_the_same_bytes_again(results, tmp_path):
    for kind in ("svg", "pdf", "png"):
        first, second = tmp_path / f"first.{kind}", tmp_path / f"second.{kind}"
        figures.time_to_rest(results).savefig(first)
        # Whatever the reader's own settings are.
        with matplotlib.rc_context({"font.size": 20.0, "svg.fonttype": "path", "svg.hashsalt": None}):
            figures.time_to_rest(results).savefig(second)
        assert first.read_bytes() == second.read_bytes(), kind
    code = "from stickslip import figures; import sys; figures.time_to_rest(sys.argv[1]).savefig(sys.argv[2])"
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE), "PYTHONHASHSEED": "7", "SOURCE_DATE_EPOCH": "1"}
    third = tmp_path / "third.svg"
    subprocess.run([sys.executable, "-c", code, results, third], env=environment, check=True)
    assert third.read_bytes() == (tmp_path / "first.svg").read_bytes()


def test_svg_has_words_a_title_and_a_description(results, tmp_path):
    figure = figures.time_to_rest(results, width="single")
    figure.savefig(tmp_path / "figure.svg")
    text = (tmp_path / "figure.svg").read_text()
    assert re.search(">probability of being at rest</(text|tspan)>", text) and "8px" in text
    assert '<title id="title">When the balls come to rest</title>' in text
    assert '<desc id="description">speed −200' in text and 'aria-labelledby="title description"' in text
    assert re.search(r'<svg [^>]*width="255\.118\d*pt"', text) and "dc:date" not in text
    assert figure.get_size_inches()[0] * 25.4 == pytest.approx(90)
    assert figures.time_to_rest(results, width="double").get_size_inches()[0] * 25.4 == pytest.approx(180)


def test_the_command_draws_what_there_is(results, tmp_path, capsys):
    out = tmp_path / "drawn"
    assert command.main([str(results), "--out", str(out), "--format", "svg"]) == 0
    printed = capsys.readouterr().out.splitlines()
    names = [Path(line).name for line in printed]
    assert names == [
        "preferred-equilibria.svg",
        "ending-fractions.svg",
        "time-to-rest.svg",
        "amplitudes.svg",
        "basins.svg",
        "limit-cycle-branches.svg",
        "diagnostics.svg",
    ]
    assert sorted(path.name for path in out.iterdir()) == sorted(names)
    assert all(Path(line).read_text().startswith("<?xml") for line in printed)
    assert command.main([str(replay(tmp_path / "motion")), "--format", "png"]) == 0
    assert (tmp_path / "motion-figures/motion.png").read_bytes().startswith(b"\x89PNG")
    sets = small_tables.equilibria(tmp_path / "sets")
    arguments = [str(results), "--only", "preferred-equilibria", "--equilibria", str(sets), "--out", str(out)]
    assert command.main(arguments) == 0
    assert "edge of the equilibrium set" in (out / "preferred-equilibria.svg").read_text()


def test_figures_of_missing_tables_are_omitted(tmp_path, capsys):
    """`stickslip equilibria --no-set` writes no positions: the figures of the set are omitted."""
    directory = small_tables.equilibria(tmp_path / "sets")
    (directory / "equilibrium_positions.parquet").unlink()
    assert command.main([str(directory), "--only", "equilibrium-set"]) == 1
    assert "equilibrium_positions" in capsys.readouterr().err
    assert command.main([str(directory), "--out", str(tmp_path / "drawn")]) == 1
    # Two speeds are no branches, so that there is nothing left to draw; the error says why.
    assert "equilibrium_positions" not in capsys.readouterr().err


def test_exit_codes_of_the_command(results, tmp_path, capsys):
    assert command.main([str(results), "--only", "label-map"]) == 1
    assert "a map needs two" in capsys.readouterr().err
    assert command.main([str(tmp_path)]) == 1
    assert "there is nothing to draw here" in capsys.readouterr().err
    (results / "runs.parquet").write_bytes(b"PAR1 nothing")
    assert command.main([str(results), "--out", str(tmp_path / "drawn")]) == 1
    assert "it cannot be read" in capsys.readouterr().err and not (tmp_path / "drawn").exists()
    (tmp_path / "file").write_text("in the way")
    assert command.main([str(replay(tmp_path / "motion")), "--out", str(tmp_path / "file")]) == 1
    assert "choose another directory with --out" in capsys.readouterr().err
    for wrong in ([], ["a", "b"], ["a", "--format", "gif"], ["a", "--only", "nothing"], ["a", "--dpi", "x"]):
        with pytest.raises(SystemExit) as ended:
            command.main(wrong)
        assert ended.value.code == 2
    with pytest.raises(SystemExit) as ended:
        command.main(["--help"])
    assert ended.value.code == 0 and "Examples:" in capsys.readouterr().out


def test_no_compiled_part_is_needed(results, tmp_path):
    code = (
        "import sys; sys.modules['stickslip._stickslip'] = None\n"
        "from stickslip.figures.command import main; sys.exit(main(sys.argv[1:]))"
    )
    environment = {**os.environ, "PYTHONPATH": str(PACKAGE)}
    arguments = [results, "--only", "time-to-rest", "--out", tmp_path / "drawn"]
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0 and done.stdout == f"{tmp_path / 'drawn/time-to-rest.svg'}\n", done.stderr


def test_every_figure_says_what_it_shows():
    for name in figures.__all__:
        assert getattr(figures, name).__doc__, name
    for name, (draw, _) in command.FIGURES.items():
        assert draw.__name__ == name.replace("-", "_")
        assert "FiguresError" in draw.__doc__ and "width" in draw.__doc__ and "[" in draw.__doc__, name


NUMBERS_OF_BALLS = """
schema: 1
name: numbers
seed: 5
model: {kind: ball_balancer}
sweep: [{grid: {balls: [1, 2, 3], speed_rad_s: [-140, -160.8103]}}]
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {endings: rest}
"""


def test_points_with_different_numbers_of_balls(tmp_path, program):
    """Positions and start states of points with two balls are shown unless other points are chosen."""
    (tmp_path / "numbers.yaml").write_text(NUMBERS_OF_BALLS)
    program("run", tmp_path / "numbers.yaml", "--out", tmp_path / "out", "--quiet")
    figure = figures.preferred_equilibria(tmp_path / "out")
    speeds = ["−140", "−160.8103"]
    assert titles(figure) == [
        f"({letter}) balls 2, speed {speed} rad/s: 4 of 4 at rest" for letter, speed in zip("ab", speeds)
    ]
    assert len(panels(figures.preferred_equilibria(tmp_path / "out", points=[4]))) == 3
    one = figures.preferred_equilibria(tmp_path / "out", points=[0, 1])
    assert "Ball angle and amplitude of each run at rest." in one.caption
    places = [axes.get_xlabel() for axes in panels(figures.basins(tmp_path / "out", points=[1]))]
    assert any("ball 1" in place or "β" in place for place in places) and not any("₂" in place for place in places)
    for draw in (figures.preferred_equilibria, figures.basins):
        with pytest.raises(figures.FiguresError, match="the points have 1 to 2 balls.*one number of balls"):
            draw(tmp_path / "out", points=[1, 2])


def test_ticks_of_logarithmic_axes_are_short():
    curve = Curve([(1e-2, 1e-5), (1e4, 2e-5)])
    (axes,) = panels(logarithmic([Curves("", "x", "y", [curve])], columns=1, title="ticks"))
    shown = [axes.xaxis.get_major_formatter()(10.0**power) for power in (-4, -3, 0, 3, 4, 6)]
    assert shown == ["10⁻⁴", "0.001", "1", "1000", "10⁴", "10⁶"]
    assert [axes.yaxis.get_major_formatter()(value) for value in (2e-5, 0.5, 20000)] == ["2·10⁻⁵", "0.5", "2·10⁴"]
