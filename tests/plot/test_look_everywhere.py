"""The options of a picture are done for results of every kind: in Python, from run files and from the command."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import contin
from contin.cli.look_options import written_look
from contin.errors import InputError
from contin.plot import scan, survey, sweep
from contin.plot.look import Look
from tests.cli.calls import call

SWEPT = {
    "p": np.array([0.5, 1.0, 2.0, 2.0, 1.0, 0.5]), "direction": np.array([1, 1, 1, -1, -1, -1]),
    **{f"{q}.{what}": np.arange(6.0) + 1 for q in ("u", "v") for what in ("min", "mean", "max")},
}  # fmt: skip
SCANNED = {
    "model": {"title": "cells"},
    "scan": {
        "axes": {"a": [1.0, 10.0, 100.0], "b": [0.0, 1.0]}, "starts": ["low", "high"], "classes": {"on": "", "off": ""}
    },
    "columns": {
        "a": [1.0, 10.0, 100.0] * 4, "b": ([0.0] * 3 + [1.0] * 3) * 2, "start": ["low"] * 6 + ["high"] * 6,
        "class": ["on", "off", "off", "on", "on", "off"] * 2,
    },
}  # fmt: skip
SURVEYED = {
    "model": "m", "factor": 10.0, "attractors": {"rest": {}, "cycle": {}},
    "survey": {
        "attractor": ["rest", "rest", "cycle"], "parameter": ["k", "q", "k"], "value": [1.0, 2.0, 1.0],
        "below": [0.1, 0.2, 0.5], "below.type": ["", "", "LPC"], "below.end": ["bound", "bound", ""],
        "above": [3.0, 20.0, 10.0], "above.type": ["HB", "", ""], "above.end": ["", "bound", "bound"],
    },
}  # fmt: skip
LOOK = {"size": (4, 3), "title": "mine", "style": {"axes.labelsize": 17}}
DRAWN = {
    "sweep": lambda ax=None, **more: sweep.figure(SWEPT, "p", ["u", "v"], look=Look.of(LOOK | more), ax=ax),
    "scan": lambda ax=None, **more: scan.drawn(SCANNED, ax, {"start": "low", **LOOK, **more}),
    "survey": lambda ax=None, **more: survey.figure(SURVEYED, look=Look.of(LOOK | more), ax=ax, attractor="rest"),
}
AXES = {"sweep": ("p", "u"), "scan": ("a", "b"), "survey": ("ratio",)}


@pytest.mark.parametrize("kind", DRAWN)
def test_size_title_style_limits_and_legend_are_the_users(kind):
    across = AXES[kind][0]
    drawing = DRAWN[kind](limits={across: (1.0, 2.0)}, log=across)
    [axes] = drawing.axes
    assert (axes.get_xlim(), axes.get_xscale()) == ((1.0, 2.0), "log")
    assert tuple(drawing.get_size_inches()) == (4.0, 3.0)
    assert drawing.get_suptitle() == "mine"
    assert axes.xaxis.label.get_size() == 17
    assert len(drawing.legends) == 1
    assert not DRAWN[kind](legend=False).legends
    assert DRAWN[kind](legend="inside").axes[0].get_legend() is not None


@pytest.mark.parametrize("kind", DRAWN)
def test_axes_of_the_user_are_drawn_into(kind):
    mine = Figure()
    left, right = mine.subplots(1, 2)
    assert DRAWN[kind](ax=right) is mine
    assert right.has_data()
    assert not left.has_data()
    assert right.get_title() == "mine"
    assert len(mine.axes) == 2


@pytest.mark.parametrize("kind", DRAWN)
def test_columns_that_no_axis_shows_are_refused(kind):
    with pytest.raises(InputError, match="no axis shows 'nobody'"):
        DRAWN[kind](limits={"nobody": (0, 1)})
    with pytest.raises(InputError, match="nobody"):
        DRAWN[kind](y=["nobody"])
    with pytest.raises(InputError, match="nobody"):
        DRAWN[kind](x="nobody")


def test_several_quantities_have_a_panel_each():
    assert [ax.get_ylabel() for ax in DRAWN["sweep"](y=["v", "u"]).axes] == ["v", "u"]


def test_cells_of_a_logarithmic_axis_meet_between_the_logarithms():
    [mesh] = DRAWN["scan"](log="a").axes[0].collections
    np.testing.assert_allclose(mesh.get_coordinates()[0, :, 0], 10.0 ** np.array([-0.5, 0.5, 1.5, 2.5]))
    with pytest.raises(InputError, match="logarithms need values above 0"):
        DRAWN["scan"](log="b")


def test_one_axes_takes_one_start_and_one_attractor():
    with pytest.raises(InputError, match=r"2 \(low, high\)"):
        scan.drawn(SCANNED, Figure().subplots(), {})
    with pytest.raises(InputError, match=r"2 \(rest, cycle\)"):
        survey.figure(SURVEYED, ax=Figure().subplots())


def test_labels_of_a_survey_are_written_where_they_are_wanted():
    def words(**look):
        return [text.get_text() for text in survey.figure(SURVEYED, look=Look.of(look)).axes[0].texts]

    assert words() == ["HB"]
    assert words(labels=["LPC"]) == words(labels=False) == []


@pytest.mark.seldom
def test_run_and_scan_files_say_it_of_simulations_sweeps_and_scans(tmp_path):
    (tmp_path / "m.yaml").write_text(
        """contin: 1
model: {name: decay, states: {u: 1, v: 2}, parameters: {k: 1}, equations: {u: k - u, v: -v}}
simulate:
  - name: s
    time: 3
    plot: {file: s.svg, y: v, log: [u], title: Hand made, limits: {v: [0.1, 2]}, style: {svg.fonttype: none}}
sweep: {parameter: k, range: [1, 2], steps: 2}
outputs: {plot: {file: k.svg, y: [u, v], title: Up and down, size: [6, 2]}}
"""
    )
    assert call("run", tmp_path / "m.yaml", "--quiet") == 2  # a file sets what changes the look alone
    text = (tmp_path / "m.yaml").read_text().replace(", style: {svg.fonttype: none}", "")
    (tmp_path / "m.yaml").write_text(text)
    assert call("run", tmp_path / "m.yaml", "--quiet") == 0
    assert "Hand made" in (tmp_path / "s.svg").read_text()
    assert "Up and down" in (tmp_path / "k.svg").read_text()
    (tmp_path / "m.yaml").write_text(text.replace("y: v, log: [u]", "y: v, log: [w]"))
    assert call("check", tmp_path / "m.yaml") == 2
    (tmp_path / "g.yaml").write_text(
        """contin: 1
model: {name: decay, states: {u: 1}, parameters: {k: 1}, equations: {u: k - u}}
scan: {axes: {k: [1, 10, 100]}}
outputs: {plot: {file: g.svg, log: [k], title: A scan}}
"""
    )
    assert call("run", tmp_path / "g.yaml", "--quiet") == 0
    assert "A scan" in (tmp_path / "g.svg").read_text()


@pytest.mark.seldom
def test_the_commands_that_draw_take_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shared = ["--title", "From the command", "--size", "4,3", "--quiet"]
    assert call("simulate", "brusselator", "--time", "2", "--plot", "a.svg", "--log", "x", *shared) == 0
    box = ["brusselator", "B", "0.5", "1"]
    assert call("sweep", *box, "--steps", "2", "--plot", "b.svg", "-y", "x", "-y", "y", *shared) == 0
    assert call("diagram", *box, "--plot", "c.svg", "-y", "y", "--limits", "B=0.6,0.7", *shared) == 0
    assert call("survey", "brusselator", "--set", "B=1", "--processes", "1", "--plot", "d.svg", *shared) == 0
    for name in "abcd":
        assert "From the command" in (tmp_path / f"{name}.svg").read_text()
    assert call("simulate", "brusselator", "--plot", "a.svg", "--size", "much") == 2


def test_what_is_typed_is_what_a_run_file_would_hold():
    typed = {"log": ["B"], "limits": ["x=0,8"], "labels": "LP,HB", "size": "7,3", "legend": "below", "title": None}
    assert written_look(typed, "B", ["x"]) == {
        "x": "B", "y": ["x"], "limits": {"x": (0.0, 8.0)}, "log": ("B",), "labels": ("LP", "HB"), "size": (7.0, 3.0)
    }  # fmt: skip


def test_a_phase_plane_is_drawn_as_others_are():
    pendulum = contin.Model("pendulum", states={"q": 0.1, "v": 0.0}, equations={"q": "v", "v": "-sin(q) - v/2"})
    plane = contin.plane(pendulum, "q", "v", x_range=(-2, 2), y_range=(-2, 2))
    mine = Figure().subplots()
    plane.plot(mine, title="swings", limits={"q": (-1, 1)}, legend=False)
    assert (mine.get_title(), mine.get_xlim(), mine.get_legend()) == ("swings", (-1.0, 1.0), None)
    with pytest.raises(InputError, match="drawn over q"):
        plane.plot(x="v")
