"""Pitchforks whose branch is narrow in the metric: at its top a step leads onto the trivial branch, nearly parallel.

x' = x (f(x) - a) with f even and largest at 0: the branch a = f(x) meets x = 0 at a = f(0) = 4, where it turns. Beyond,
both are stable or both unstable, so that no test changes its sign when a step has gone from one to the other.
"""

import numpy as np
import pytest

import contin
from contin.continuation.gone_over import gone_over

ENDS = [1e-4, 1.5e-3, 0.012, 0.046, 0.3]  # beyond the pitchfork
FORMS = {
    "atan": "atan(4*x) - a*x", "tanh": "a*x - tanh(4*x)", "exp": "x*(4*exp(-9*x^2) - a)",
    "rational": "4*x/(1 + x^2) - a*x",
}  # fmt: skip


@pytest.mark.parametrize("beyond", ENDS)
@pytest.mark.parametrize("name", FORMS)
def test_the_top_of_a_pitchfork_is_not_passed_by(name, beyond):
    model = contin.load({"name": name, "states": {"x": 2.0}, "parameters": {"a": 0.8}, "equations": {"x": FORMS[name]}})
    start = contin.equilibrium(model, {"x": 0.4} if name == "exp" else {"x": 2.0})
    branch = contin.continuation(start, "a", (0.4, 4.0 + beyond))
    labels = [(p.type, p.values["a"], p.error) for p in branch.points]
    assert [type_ for type_, *_ in labels] == ["BP"]
    assert abs(labels[0][1] - 4.0) <= labels[0][2] + 1e-14
    assert not branch.notes
    assert np.abs(branch.columns["x"]).min() < 1e-6 or branch.columns["x"].min() < 0.0 < branch.columns["x"].max()


@pytest.mark.parametrize("beyond", [1e-3, 0.046])
def test_a_pitchfork_on_a_needle_of_a_wide_branch_is_not_passed_by(beyond):
    """x (1 + 3 exp(-(40 x)^2/9) - a) - 0.02 x^3: |x| is up to 12 along the branch, and 1/40 at its top."""
    equation = "x*(1 + 3*exp(-(40*x)^2/9) - a) - 0.02*x^3"
    parts = {"name": "needle", "states": {"x": 2.0}, "parameters": {"a": 0.8}, "equations": {"x": equation}}
    model = contin.load(parts)
    branch = contin.continuation(contin.equilibrium(model), "a", (-2.0, 4.0 + beyond))
    assert any(p.type == "BP" and abs(p.values["a"] - 4.0) <= p.error + 1e-14 for p in branch.points)


@pytest.mark.seldom
def test_an_amplitude_that_falls_to_zero_does_so_at_the_pitchfork():
    """x'' + x = eps (-a x' + atan(4 x')), averaged: the amplitude vanishes at a = 4, not at the end of the range."""
    model = contin.load(
        {
            "name": "one", "states": {"x": 3.0, "y": 0.0}, "parameters": {"a": 0.8, "eps": 0.01},
            "equations": {"x": "y", "y": "-x + eps*(atan(4*y) - a*y)"},
            "averaging": {"small": "eps", "oscillators": [{"position": "x", "velocity": "y"}]},
        }
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(contin.average(model, "polar"), {"r": 2.0}), "a", (0.4, 4.04))
    (pitchfork,) = branch.points
    assert pitchfork.type == "BP"
    assert abs(pitchfork.values["a"] - 4.0) <= pitchfork.error + 1e-11
    assert "at a = 4," in branch.ends[1].text


def test_a_look_back_that_itself_leads_to_another_branch_says_nothing():
    """Rows of x^2 = a, where a state is zero but for rounding: from a = 9e-5, Newton at a = 9e-4 leads to x = 0."""
    equations = {"x": "x*(a - x^2)", "y": "-y"}
    model = contin.load({"name": "one", "states": {"x": 1, "y": 0}, "parameters": {"a": 1}, "equations": equations})
    problem = contin.continuation(contin.equilibrium(model), "a", (0.5, 1.5)).problem
    x = np.sqrt(np.array([0.05, 0.024, 6.4e-3, 9e-5, 3e-5, 1e-5]))
    rows = np.column_stack([x, [3e-15, 3e-15, 3e-15, 3e-15, 1e-17, 1e-17], x * x])
    tangents = np.column_stack([-np.ones_like(x), np.zeros_like(x), -2.0 * x])
    for over in ([], [2]):
        assert gone_over(problem, rows, tangents, 0, set(), np.ones(3), 1e-8) == over
        rows[3:, 0] = tangents[3:, 0] = 0.0  # of the branch x = 0, which is another one at a = 0.024
