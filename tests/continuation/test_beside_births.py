"""What happens next to where a branch is born, or crosses others, is labelled, or a note says that it could not be.

x' = x (p + b x - x^2): the branch p = x^2 - b x is born at the transcritical point p = 0 and turns at x = b/2, where
p = -b^2/4.
"""

import numpy as np
import pytest
import scipy.sparse

import contin
from contin import api

SLOPES = [0.1, 1e-2, 3e-3, 1e-4, 1e-6]


def of_formulas(b):
    return api.equilibrium(
        contin.Model(
            "crossing", states={name: {"value": 0.0, "scale": 1} for name in ("x", "w")}, parameters={"p": -0.5},
            equations={"x": f"x*(p + {b}*x - x^2) + 0.2*w", "w": "-w"},
        )
    )  # fmt: skip


def of_functions(b):
    def rates(u, p):
        return np.array([u[0] * (p["p"] + b * u[0] - u[0] ** 2) + 0.2 * u[1], -u[1]])

    def jacobian(u, p):
        return scipy.sparse.csc_matrix([[p["p"] + 2.0 * b * u[0] - 3.0 * u[0] ** 2, 0.2], [0.0, -1.0]])

    return contin.FunctionProblem(rates, np.zeros(2), {"p": -0.5}, jacobian)


@pytest.mark.parametrize("start", [of_formulas, of_functions])
@pytest.mark.parametrize("b", SLOPES)
def test_of_equilibria(start, b):
    line = api.continuation(start(b), "p", (-1.0, 1.0))
    (born,) = [line["BP1"].switch()] if not isinstance(line["BP1"].switch(), list) else line["BP1"].switch()
    branch = api.continuation(born, "p", (-1.0, 1.0))
    folds = [point for point in branch.points if point.type == "LP"]
    if not folds:
        assert any("fold nearer to the start" in note for note in branch.notes)
        assert b**2 / 4 < 1e-11
        return
    (fold,) = folds
    assert abs(fold.values["p"] + b**2 / 4) <= fold.error + 1e-16
    at = np.abs(branch.columns["p"] - fold.values["p"]).argmin()
    assert at not in (0, len(branch) - 1)


def circles(rate, start, bounds):
    """The family of turning circles of radius 1, beside which radii 1 + s move with s' = `rate`."""
    model = contin.Model(
        "circles", states={"x": 1.0, "y": 0.0}, parameters={"p": start},
        definitions={"r": "sqrt(x^2 + y^2)", "s": "r - 1", "g": f"({rate})/r"},
        equations={"x": "g*x - y", "y": "g*y + x"},
    )  # fmt: skip
    return api.continuation(api.periodic_orbit(model, {"x": 1.0, "y": 0.0}), "p", bounds)


@pytest.mark.parametrize("b", [0.1, 1e-2, 1e-3])
def test_of_cycles(b):
    """Radii 1 + s of a turning circle, s' = s (p + b s - s^2)."""
    family = circles(f"s*(p + {b}*s - s^2)", -0.5, (-0.6, 0.6))
    crossing = next(point for point in family.points if point.type == "BPC")
    born = crossing.switch()
    branch = api.continuation(born if not isinstance(born, list) else born[0], "p", (-0.2, 0.2))
    (fold,) = [point for point in branch.points if point.type == "LPC"]
    assert abs(fold.values["p"] + b**2 / 4) <= fold.error + 1e-16


def flow(states, equations):
    named = {name: {"value": 0.0, "scale": 1} for name in states}
    return contin.Model("beside", states=named, parameters={"p": -0.5}, equations=equations)


def only(starts):
    return starts[0] if isinstance(starts, list) else starts


NEAR = [1e-2, 1e-4, 1e-6, 1e-9]


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("e", NEAR)
def test_hopf_point_beside_the_birth_of_equilibria(e, power):
    """x = p or x^2 = p is born at p = 0; y and z lose stability at x = e."""
    model = flow("xyz", {
        "x": f"x*(p - x^{power})", "y": f"(x - {e})*y - z - y*(y^2 + z^2)", "z": f"y + (x - {e})*z - z*(y^2 + z^2)",
    })  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-0.5, 0.5))
    branch = api.continuation(only(line["BP1"].switch()), "p", (-0.5, 0.5))
    if e < 1e-8 and not branch.points:
        return  # nearer to the axis than an eigenvalue's error may be
    (point,) = branch.points
    assert point.type == "HB"
    assert abs(point.values["x"] - e) <= max(1e-3 * e, 1e-10)
    assert abs(point.values["p"] - e**power) <= point.error + 1e-16


@pytest.mark.parametrize("e", [1e-2, 1e-4, 1e-6])
def test_hopf_point_beside_the_birth_of_equilibria_of_functions(e):
    def rates(u, p):
        x, y, z = u
        size = y**2 + z**2
        return np.array([x * (p["p"] - x), (x - e) * y - z - y * size, y + (x - e) * z - z * size])

    def jacobian(u, p):
        x, y, z = u
        return scipy.sparse.csc_matrix([
            [p["p"] - 2 * x, 0, 0], [y, x - e - 3 * y**2 - z**2, -1 - 2 * y * z],
            [z, 1 - 2 * y * z, x - e - y**2 - 3 * z**2],
        ])  # fmt: skip

    start = api.equilibrium(contin.FunctionProblem(rates, np.zeros(3), {"p": -0.5}, jacobian))
    line = api.continuation(start, "p", (-0.5, 0.5))
    branch = api.continuation(only(line["BP1"].switch()), "p", (-0.5, 0.5))
    (point,) = branch.points
    assert point.type == "HB"
    assert abs(point.values["p"] - e) <= point.error + 1e-16


@pytest.mark.parametrize("e", [1e-2, 1e-4, 1e-6])
def test_branch_point_beside_the_birth_of_equilibria(e):
    """y loses stability at x = e, with one eigenvalue."""
    model = flow("xy", {"x": "x*(p - x)", "y": f"(x - {e})*y - y^3"})
    line = api.continuation(api.equilibrium(model), "p", (-0.5, 0.5))
    branch = api.continuation(only(line["BP1"].switch()), "p", (-0.5, 0.5))
    (point,) = [point for point in branch.points if abs(point.values["p"]) > 0.5 * e]
    assert point.type == "BP"
    assert abs(point.values["p"] - e) <= point.error + 1e-16


@pytest.mark.parametrize("method", ["collocation", "shooting"])
@pytest.mark.parametrize("e", [1e-2, 1e-4, 1e-6])
def test_torus_beside_the_birth_of_cycles(e, method):
    """Cycles of radius sqrt(p) with a pair of multipliers exp(2 pi (p - e) +- 2 pi i 0.3)."""
    r2 = "(x^2 + y^2)"
    model = flow("xyuv", {
        "x": f"(p - {r2})*x - y", "y": f"x + (p - {r2})*y",
        "u": f"({r2} - {e})*u - 0.3*v - u*(u^2 + v^2)", "v": f"0.3*u + ({r2} - {e})*v - v*(u^2 + v^2)",
    })  # fmt: skip
    line = api.continuation(api.equilibrium(model), "p", (-0.5, 0.5))
    family = api.continuation(only(line["HB1"].switch()), "p", (-0.5, 0.5), settings={"method": method})
    (point,) = family.points
    assert point.type == "NS"
    assert abs(point.values["p"] - e) <= 3 * point.error + 1e-12


@pytest.mark.parametrize("e", [0.05, 1e-2, 1e-3])
def test_three_crossings_of_cycles_within_a_step_are_labelled_or_a_note_says_so(e):
    """Radii 1 + s, s' = s g - s^3 with g = 10 p (p - e) (p + e)."""
    family = circles(f"s*10*p*(p - {e})*(p + {e}) - s^3", -0.53, (-0.53, 0.6))
    found = [point for point in family.points if point.type == "BPC"]
    for point in found:
        assert min(abs(point.values["p"] - at) for at in (-e, 0.0, e)) <= 3 * point.error
    assert len(found) == 3 or any("may lie closer" in note or "others lie closer" in note for note in family.notes)
    assert len(found) == 3 or e < 1e-2
