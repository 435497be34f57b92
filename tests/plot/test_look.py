"""What the user says of a picture is done, and what cannot be done is refused in words."""

import numpy as np
import pytest
from matplotlib import rc_context

from contin.errors import InputError
from contin.plot.bounded import bounded
from contin.plot.figure import figure
from contin.plot.look import Look
from contin.plot.series import from_branches, panels
from contin.plot.typeset import axis_label, typeset
from tests.plot.sample import branch, hysteresis, special


def drawn(branches, **options):
    look = Look.of(options)
    drawing = figure(panels(from_branches(branches), x=look.x, y=look.y), look=look)
    drawing.draw_without_rendering()
    return drawing


def words(axes):
    return sorted(text.get_text() for text in axes.texts if text.get_visible())


def test_limits_size_title_labels_and_style_are_the_users():
    drawing = drawn(
        hysteresis(), limits={"x": [-3, 3]}, size=[3, 2], title="mine", labels=False, legend="none",
        style={"axes.labelsize": 17},
    )  # fmt: skip
    [axes] = drawing.axes
    assert axes.get_ylim() == (-3.0, 3.0)
    assert tuple(drawing.get_size_inches()) == (3.0, 2.0)
    assert drawing.get_suptitle() == "mine"
    assert not words(axes)
    assert not drawing.legends
    assert axes.xaxis.label.get_size() == 17


def test_rc_parameters_that_the_user_changed_stay():
    with rc_context({"axes.labelsize": 19, "axes.spines.top": True}):
        [axes] = drawn(hysteresis()).axes
        assert axes.xaxis.label.get_size() == 19
    [axes] = drawn(hysteresis()).axes
    assert axes.xaxis.label.get_size() == 10


def test_labels_move_with_limits_that_are_set_afterwards():
    drawing = drawn(hysteresis())
    [axes] = drawing.axes
    assert words(axes) == ["LP1", "LP2"]
    places = sorted(text.get_window_extent().x0 for text in axes.texts)
    axes.set_xlim(0.0, 1.0)
    drawing.draw_without_rendering()
    assert len(words(axes)) < 2 or sorted(text.get_window_extent().x0 for text in axes.texts) != places


def test_a_logarithmic_axis_shows_the_same_rows():
    p = np.linspace(0.5, 4, 40)
    [axes] = drawn([branch("b", {"p": p, "x": p**2, "stable": p < 2})], log=["p", "x"]).axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"colour": 1}, "no option 'colour'"),
        ({"log": ["z"]}, "log: no axis shows 'z'"),
        ({"limits": {"x": [2, 1]}}, "low < high"),
        ({"size": [0, 1]}, "inches"),
        ({"legend": "above"}, "below, inside, none"),
        ({"style": {"no.such": 1}}, "no rcParam"),
        ({"style": {"font.size": "huge?"}}, "font.size"),
    ],
)
def test_what_cannot_be_is_refused_in_words(options, message):
    with pytest.raises(InputError, match=message):
        drawn(hysteresis(), **options)


def test_a_branch_that_runs_to_infinity_does_not_flatten_the_others():
    p = np.linspace(0.0, 1.0, 200)
    flat = branch("flat", {"p": p, "x": np.sin(3 * p), "stable": p < 2})
    pole = branch("pole", {"p": 1 - p**8, "x": 1 / (p**8 + 1e-9), "stable": p < 2})
    [axes] = drawn([flat, pole]).axes
    low, high = axes.get_ylim()
    assert high < 1e3  # of 1e9
    assert low <= 0.0
    assert high >= 1.0


def test_limits_hold_every_mark_and_all_of_what_is_bounded():
    x, y = np.linspace(0, 1, 50), np.linspace(0, 5, 50)
    assert bounded([(x, y)], np.empty(0)) is None
    runaway = (np.full(50, 1.0), np.logspace(0, 9, 50))
    low, high = bounded([(x, y), runaway], np.array([40.0]))
    assert low <= 0.0
    assert 40.0 <= high < 1e3


def test_curves_in_two_parameters_are_not_projected_beside_branches_in_one():
    p = np.linspace(0, 1, 20)
    line = branch("line", {"p": p, "x": p, "stable": p < 2})
    locus = branch("curve", {"p": p, "q": p**2, "x": p}, parameters=("p", "q"), locus="LP")
    shown = panels(from_branches([line, locus]), x="p", y="x")
    assert [[curve.name for curve in panel.curves] for panel in shown] == [["line"]]
    assert len(panels(from_branches([locus]), x="p", y="x")) == 1  # alone it is what was asked for


def test_a_curve_under_another_is_seen():
    p = np.linspace(0, 1, 60)
    one, same = (branch(name, {"p": p, "x": p**2, "stable": p < 2}) for name in "ab")
    [axes] = drawn([one, same]).axes
    assert max(line.get_linewidth() for line in axes.get_lines()) > 5
    [axes] = drawn([one]).axes
    assert max(line.get_linewidth() for line in axes.get_lines()) < 5


@pytest.mark.seldom
def test_a_legend_takes_a_quarter_of_the_height_at_most():
    p = np.linspace(0, 1, 30)
    codes = "LP BP HB PD NS UZ HOM LPC BPC CP BT GH ZH HH".split()
    many = [
        branch(f"a-long-name-of-a-branch-{k}", {"p": p, "x": p + k, "stable": p < 0.5},
               [special(code, f"{code}1", 3 + i, {}) for i, code in enumerate(codes)])
        for k in range(8)
    ]  # fmt: skip
    drawing = drawn(many)
    height = sum(legend.get_window_extent().height for legend in drawing.legends)
    assert height <= 0.27 * drawing.bbox.height


def test_names_are_typeset_in_plain_characters():
    assert typeset("mu") == "\u03bc"
    assert typeset("x_1") == "x\u2081"
    assert typeset("mu_c") == "\u03bc_c"
    assert typeset("gNa") == "gNa"
    assert typeset("x12.max") == "x\u2081\u2082.max"
    assert axis_label("tau", {"tau": "ms"}, ", max") == "\u03c4, max (ms)"
