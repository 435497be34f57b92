"""Branches that meet the trivial branch at a corner, or at the top of a needle: never passed by without a word.

x' = x (f(|x|) - a): the branch a = f(|x|) meets x = 0, which is a switching surface, at a = f(0), where it turns. On
the surface every a is a solution, so that the corner's a is a limit of the branch's own points.
"""

import pytest

import contin

CORNERS = {
    "rational": "4*x/(1 + abs(x)) - a*x", "exp": "x*(4*exp(-abs(x)) - a)", "cubic": "x*(4 - abs(x) - 0.1*x^2 - a)",
}  # fmt: skip
NEEDLES = {"tanh": "a*x - tanh(K*x)", "atan": "atan(K*x) - a*x", "corner": "K*x/(1 + abs(K*x)) - a*x"}


def _followed(equation: str, to: float, x: float = 2.0):
    parts = {"name": "one", "states": {"x": x}, "parameters": {"a": 0.8}, "equations": {"x": equation}}
    return contin.continuation(contin.equilibrium(contin.load(parts)), "a", (0.1, to))


@pytest.mark.parametrize("beyond", [1e-4, 1.5e-3, 0.046, 0.3])
@pytest.mark.parametrize("form", CORNERS)
def test_a_pitchfork_at_a_corner_is_the_limit_of_its_own_branch(form, beyond):
    branch = _followed(CORNERS[form], 4.0 + beyond)
    (corner,) = branch.points
    assert (corner.type, corner.normal_form["kind"]) == ("LP", "nonsmooth")
    assert abs(corner.values["a"] - 4.0) <= corner.error < 1e-10
    assert branch.columns["x"].min() < -1.0  # goes on to the mirror image
    assert branch.unexplained == 0
    assert any("another branch lies in the surface" in note for note in branch.notes)


def test_a_corner_between_two_states_on_the_surface_of_one():
    parts = {
        "name": "two", "states": {"x": 2.0, "y": 2.0}, "parameters": {"a": 0.8},
        "equations": {"x": "x*(4*exp(-abs(x)) - 0.1*y - a)", "y": "x^2 + 0.3*x + 1 - y"},
    }  # fmt: skip
    branch = contin.continuation(contin.equilibrium(contin.load(parts)), "a", (0.4, 4.1))
    corner = next(p for p in branch.points if p.normal_form.get("kind") == "nonsmooth")  # y = 1 there: a = 4 - 0.1
    assert abs(corner.values["a"] - 3.9) <= corner.error < 1e-10


@pytest.mark.parametrize("k", [300.0, 1e4, 1e6])
@pytest.mark.parametrize("beyond", [1e-4, 1e-2, 0.3])
@pytest.mark.parametrize("form", NEEDLES)
def test_the_top_of_a_needle_is_labelled_or_told(form, beyond, k):
    branch = _followed(NEEDLES[form].replace("K", repr(k)), k * (1.0 + beyond), x=1.0)
    labelled = [p for p in branch.points if p.type in ("BP", "LP")]
    assert all(abs(p.values["a"] - k) <= p.error for p in labelled)
    failed = any(end.reason == "corrector" for end in branch.ends)
    assert labelled or failed or (branch.unexplained and branch.notes)


@pytest.mark.parametrize("k", [4.0, 30.0])
@pytest.mark.parametrize("beyond", [1e-4, 1e-2, 0.3])
@pytest.mark.parametrize("form", NEEDLES)
def test_where_the_trivial_branch_lies_makes_no_difference(form, beyond, k):
    """x = 1 in place of x = 0."""
    branch = _followed(NEEDLES[form].replace("x", "(x - 1)").replace("K", repr(k)), k * (1.0 + beyond))
    labelled = [p for p in branch.points if p.type in ("BP", "LP")]
    assert all(abs(p.values["a"] - k) <= p.error for p in labelled)
    failed = any(end.reason == "corrector" for end in branch.ends)
    assert labelled or failed or (branch.unexplained and branch.notes)


@pytest.mark.parametrize("equation", ["max(0, 3 - a) - x", "exp(-30*a) - x", "2/(1 + (a/2)^40) - x"])
def test_states_that_vanish_on_their_own_branch_are_no_reason_for_a_note(equation):
    branch = _followed(equation, 8.0)
    assert branch.columns["x"][-1] < 1e-12
    assert (branch.notes, branch.unexplained) == ((), 0)
