"""Every result shows itself: a picture where there is one to draw, its labels, nothing unescaped."""

import base64
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import contin
from contin.errors import InputError
from tests.plot.sample import hysteresis

SPIRAL = {
    "name": "ring",
    "title": "ring <b>",
    "states": {"x": 0.5, "y": 0.0},
    "parameters": {"mu": {"value": 0.25, "range": [-1, 1]}},
    "equations": {"x": "mu*x - y - x*(x^2 + y^2)", "y": "x + mu*y - y*(x^2 + y^2)"},
}


class Wellformed(HTMLParser):
    """Tags that are opened and never closed, or the other way."""

    def __init__(self, text):
        super().__init__()
        self.stack, self.wrong = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag not in ("img", "br"):
            self.stack.append(tag)

    def handle_endtag(self, tag):
        if not self.stack or self.stack.pop() != tag:
            self.wrong.append(tag)


def images(page):
    return [base64.b64decode(data) for data in re.findall(r'src="data:image/png;base64,([^"]+)"', page)]


@pytest.fixture(scope="module")
def diagram():
    return contin.diagram(contin.load(SPIRAL), "mu", (-1.0, 1.0))


def check(page, pictures):
    parser = Wellformed(page)
    assert not parser.wrong
    assert not parser.stack
    assert len(images(page)) == pictures
    assert all(data.startswith(b"\x89PNG") and len(data) > 5000 for data in images(page))
    assert "ring <b>" not in page


def test_a_diagram_its_branches_and_points_show_themselves(diagram):
    cycles = next(branch for branch in diagram if branch.kind == "orbit")
    point = diagram.branches[0].points[0]
    for shown, pictures in ((diagram, 1), (cycles, 1), (point, 1)):
        check(shown._repr_html_(), pictures)
    assert "HB1" in diagram._repr_html_()
    assert "l1" in point._repr_html_()


def test_figures_show_themselves_without_a_magic_word(diagram):
    assert diagram.plot()._repr_png_().startswith(b"\x89PNG")


def test_models_show_their_equations_and_simulations_their_course():
    model = contin.load(SPIRAL)
    page = model._repr_html_()
    check(page, 0)
    assert page.count(r"\begin{align*}") == 1
    assert "ring &lt;b&gt;" in page
    check(contin.simulate(model, time=20)._repr_html_(), 1)
    check(contin.sweep(model, "mu", (-0.5, 0.5), steps=4)._repr_html_(), 1)


@pytest.mark.seldom
def test_the_orbit_at_a_row_is_the_circle_of_the_closed_form(diagram):
    """r = sqrt(mu), period 2 pi, multiplier exp(-2 mu 2 pi)."""
    cycles = next(branch for branch in diagram if branch.kind == "orbit")
    row = int(np.argmin(np.abs(cycles.columns["mu"] - 0.2)))
    orbit, mu = cycles.orbit(row), cycles.columns["mu"][row]
    assert np.hypot(orbit.columns["x"], orbit.columns["y"]) == pytest.approx(np.sqrt(mu), abs=1e-8)
    assert orbit.period == pytest.approx(2 * np.pi, abs=1e-9)
    assert sorted(np.abs(orbit.multipliers)) == pytest.approx([np.exp(-4 * np.pi * mu), 1.0], abs=1e-5)
    assert list(orbit.to_dataframe().columns) == ["t", "x", "y"]
    check(orbit._repr_html_(), 1)
    assert len(cycles.orbit(-1).t) == len(cycles.orbit(len(cycles) - 1).t)


def test_an_orbit_of_what_is_none_is_refused_in_words(diagram):
    with pytest.raises(InputError, match="no periodic orbit"):
        _ = diagram.branches[0].points[0].orbit
    with pytest.raises(IndexError, match="rows 0 to"):
        diagram.branches[0].orbit(10**6)


def test_branches_in_memory_draw_into_axes_of_the_user(diagram):
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    assert diagram.plot(ax=axes, legend=False) is axes.figure
    assert axes.get_xlabel() == "\u03bc"
    assert axes.get_legend() is None
    assert hysteresis()[0].plot(y="x").axes[0].get_ylabel() == "x"


@pytest.mark.parametrize("n", [2, 60])
@pytest.mark.seldom
def test_branches_of_functions_without_names_of_states_show_themselves(n):
    def rate(u, p):
        return p["p"] - u**2

    problem = contin.FunctionProblem(rate, np.ones(n), {"p": 1.0}, ranges={"p": (0.2, 2.0)})
    branch = contin.continuation(problem, "p", (0.2, 2.0))
    check(branch._repr_html_(), 1 if n == 2 else 0)
    assert ("no picture" in branch._repr_html_()) == (n == 60)


def test_solutions_and_surveys_show_themselves_and_are_told_in_a_line():
    model = contin.load("brusselator")
    rest = contin.equilibrium(model, parameters={"B": 1.5})
    cycle = contin.periodic_orbit(model, {"x": 2.0, "y": 1.0}, {"B": 3.0})
    saw = contin.Model(
        "saw", states={"v": 0.0}, parameters={"I": 1.0}, equations={"v": "I"},
        events=[{"when": "v - 1", "direction": "up", "set": {"v": 0}}],
    )  # fmt: skip
    jumping, survey = contin.periodic_orbit(saw), contin.survey(model, processes=1)
    assert "x</td>" in rest._repr_html_()
    for shown in (cycle, jumping, survey):
        assert "data:image/png" in shown._repr_html_()
    told = [rest, *contin.find_equilibria(model), cycle, jumping, survey, contin.simulate(model, time=1.0)]
    assert all(len(repr(one)) < 200 and "\n" not in repr(one) for one in told)
    assert repr(rest).startswith("<equilibrium x = 1")
