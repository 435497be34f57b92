"""Branches that nearly cross, and tops of needles: what is labelled is there, and what is passed by is told.

u'' + q u - u^k = eps, u(0) = u(1) = 0: at eps = 0 the trivial solution is crossed at q = pi^2; at any other eps the
branch that comes near that point turns away from it, and reaches amplitudes of order one.
"""

import pytest

import contin


def _problem(states, parameters, equations, conditions):
    return contin.load({
        "name": "one", "kind": "bvp", "time": {"name": "t"}, "states": states, "parameters": parameters,
        "equations": equations, "conditions": conditions,
    })  # fmt: skip


LONG = pytest.mark.long


@pytest.mark.parametrize(
    ("eps", "power"),
    [
        (1e-10, 2), (1e-9, 3), (1e-7, 2),
        *(pytest.param(eps, power, marks=LONG) for eps, power in ((1e-10, 3), (1e-9, 2), (1e-7, 3))),
    ],
)  # fmt: skip
@pytest.mark.seldom
def test_a_branch_that_turns_away_from_a_crossing_is_followed_and_has_no_label(power, eps):
    size = {"value": 0, "scale": 1}
    model = _problem(
        {"u": size, "v": size}, {"q": 9.0}, {"u": "v", "v": f"-q*u + u^{power} - {eps}"}, ["u(start) = 0", "u(end) = 0"]
    )
    branch = contin.continuation(contin.boundary_problem(model), "q", (9, 11), direction="up")
    assert [p.type for p in branch.points] == []
    assert branch.columns["u.max"][-1] > 0.5
    assert branch.unexplained == 0


@pytest.mark.parametrize(("shape", "k"), [("tanh", 4.0), ("atan", 300.0)])
@pytest.mark.parametrize("shift", [0, 1])
def test_the_top_of_a_needle_is_labelled_or_told(shape, k, shift):
    """A constant function w with shape(k w) = a w: the branch ends on w = 0 at a = k, for which it went on along."""
    w = f"(w(start) - {shift})"
    model = _problem({"w": 1.0 + shift}, {"a": 0.8}, {"w": "0*w"}, [f"{shape}({k}*{w}) = a*{w}"])
    branch = contin.continuation(contin.boundary_problem(model), "a", (0.5, 1.01 * k))
    labelled = [p for p in branch.points if p.type in ("BP", "LP")]
    assert all(abs(p.values["a"] - k) <= p.error for p in labelled)
    assert labelled or (branch.unexplained and branch.notes)
