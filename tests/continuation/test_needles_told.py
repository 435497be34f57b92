"""Needles: a branch w that ends in a pitchfork at a = k, so narrow that a step passes its top, is found or noted.

w' = f(k w) - a w with f'(0) = 1, f odd: w = 0 is met at a = k exactly. Nothing is said only where a label lies there.
"""

import pytest

import contin

FORMS = {"tanh": "tanh(k*w)", "atan": "atan(k*w)", "corner": "k*w/(1 + abs(k*w))"}


def needle(form: str, k: float, shift: float) -> str:
    w = f"(w - {shift})"
    return f"{FORMS[form].replace('k', repr(k)).replace('w', w)} - a*{w}"


def is_told(branch, k: float) -> bool:
    points = [p for p in branch.points if p.type in ("BP", "LP", "BPC")]
    labelled = any(abs(p.values["a"] - k) <= p.error + 1e-13 * k for p in points)
    return labelled or branch.unexplained > 0 or any(end.reason in ("corrector", "surface") for end in branch.ends)


@pytest.mark.parametrize(("form", "k", "beyond"), [("tanh", 1e6, 1e-4), ("atan", 1e6, 0.3), ("corner", 1e4, 1e-4)])
@pytest.mark.parametrize("kind", ["flow", "map", "algebraic"])
def test_of_states_in_sizes_of_one(kind, form, k, beyond):
    equation = needle(form, k, 1.0)
    model = contin.load(
        {
            "name": "needle", "kind": kind, "states": {"w": 2.0}, "parameters": {"a": 0.8},
            "equations": {"w": f"w + ({equation})/{2.0 * k!r}" if kind == "map" else equation},
        }
    )  # fmt: skip
    assert is_told(contin.continuation(contin.equilibrium(model), "a", (0.1, k * (1.0 + beyond))), k)


@pytest.mark.parametrize(
    ("form", "k", "shift", "beyond"),
    [("tanh", 1e4, 1.0, 1e-4), ("atan", 1e6, 0.0, 1e-4), ("corner", 1e4, 0.0, 0.01), ("atan", 1e4, 1.0, 0.3)],
)
@pytest.mark.seldom
def test_of_boundary_values(form, k, shift, beyond):
    """Rows changed to and fro between both arms of the needle, or 1e-7 of a function was taken for a mesh's."""
    problem = contin.load(
        {
            "name": "needle", "kind": "bvp", "states": {"w": 1.0 + shift}, "parameters": {"a": 0.8},
            "equations": {"w": "0*w"}, "conditions": [needle(form, k, shift).replace("w", "w(start)") + " = 0"],
        }
    )  # fmt: skip
    start = contin.boundary_problem(problem, {"w": 1.0 + shift})
    assert is_told(contin.continuation(start, "a", (0.1, k * (1.0 + beyond))), k)


def followed(form: str, k: float, method: str, beyond: float):
    """Orbits of a normal form beside the needle."""
    model = contin.Model(
        "needle", states={"x": 1, "y": 0, "w": 1}, parameters={"a": 0.8},
        equations={"x": "x - y - x*(x^2 + y^2)", "y": "x + y - y*(x^2 + y^2)", "w": needle(form, k, 0.0)},
    )  # fmt: skip
    orbit = contin.periodic_orbit(model, method=method)
    return contin.continuation(orbit, "a", (0.1, k * (1.0 + beyond)))


@pytest.mark.parametrize(
    ("form", "method", "beyond"),
    [
        ("tanh", "collocation", 0.01), ("tanh", "shooting", 0.3),
        ("corner", "collocation", 1e-4), ("corner", "shooting", 1e-4),
    ],
)
@pytest.mark.seldom
def test_of_orbits(form, method, beyond):
    k = 1e4
    assert is_told(followed(form, k, method, beyond), k)


@pytest.mark.parametrize("method", ["collocation", "shooting"])
def test_the_top_of_a_wide_needle_is_one_branch_point(method):
    """The parameter turns there along the needle; the other family's rate of change by the parameter is zero."""
    family = followed("tanh", 4.0, method, 0.01)
    assert [point.type for point in family.points] == ["BPC"]
    assert not family.notes
    assert abs(family.points[0].values["a"] - 4.0) <= family.points[0].error < 1e-8
