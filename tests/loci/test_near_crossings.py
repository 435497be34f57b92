"""Curves of orbits, large systems, boundary values, connections and in three parameters turn off beside another one.

As `tests/loci/equilibria/test_near_crossings.py`: g = q^2 - p^2 - e = 0 from (-2, 2) turns at (0, sqrt(e)) and stays at
q > 0. All of these curves went on along their line, onto the other half of the hyperbola, from e = 1e-6 on, silently.
"""

import numpy as np
import pytest
import scipy.sparse as sp

import contin
from contin.bvp.from_guess import boundary_guess
from contin.model.model import Model
from tests.loci.equilibria.planes import amplitude
from tests.loci.orbits.test_codim_two import CIRCLE, SQUARE, twisted

G = "(q^2 - p^2 - e)"
START = {"p": -1.0, "q": 1.2}
BOX = {"p": (-2, 2), "q": (-2, 2)}
ORBITS = {  # type, equations, the orbit's radius and value of further states at p = -1, q = 1.2
    "LPC": ("LPC", {**CIRCLE, "x": f"{G} - x^2"}, 1.0, (0.44**0.5,)),
    "LPC, r' = r (g - (r^2 - 1)^2)": (
        "LPC", {"a": f"({G} - (a^2 + b^2 - 1)^2)*a - b", "b": f"({G} - (a^2 + b^2 - 1)^2)*b + a"},
        (1.0 + 0.44**0.5) ** 0.5, (),
    ),
    "PD": ("PD", {**CIRCLE, **twisted(f"-{G} - {SQUARE}", "-1")}, 1.0, (0.0, 0.0)),
    "NS": (
        "NS", {**CIRCLE, **dict(zip("cd", amplitude("c", "d", f"-{G} - (c^2 + d^2)", "0.3"), strict=True))}, 1.0,
        (0.0, 0.0),
    ),
    "BPC": ("BPC", {**CIRCLE, "x": f"x*({G} - x^2)"}, 1.0, (0.0,)),
    "BPC, transcritical": ("BPC", {**CIRCLE, "x": f"x*({G} - x)"}, 1.0, (0.0,)),
}  # fmt: skip


def curve_of_orbits(name, e, **settings):
    type_, equations, radius, others = ORBITS[name]
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    points = np.column_stack([radius * np.cos(t), radius * np.sin(t), *(np.full(101, x) for x in others)])
    states = dict(zip(equations, points[0], strict=True))
    model = Model("beside", states=states, parameters={**START, "e": e}, equations=equations)
    orbit = contin.periodic_orbit(model, points, period=2.0 * np.pi)
    family = contin.continuation(orbit, "p", (-1.6, -0.5), settings={"stop_at": (type_,), **settings})
    return contin.continuation(family[f"{type_}1"].locus(("p", "q")), ("p", "q"), BOX, settings=settings or None)


def stays(found, gap, at=1e-9):
    """Whether a curve is the upper half of the hyperbola, whole and without a note."""
    p, q = found.columns["p"], found.columns["q"]
    np.testing.assert_allclose(q, np.sqrt(p * p + gap * gap), rtol=1e-6, atol=at)
    assert p.max() - p.min() > 3.9
    assert {end.reason for end in found.ends} == {"bound"}
    assert len(p) < 120
    return found.notes == ()


@pytest.mark.parametrize("gap", [pytest.param(1e-2, marks=pytest.mark.long), 1e-3, 1e-5])
@pytest.mark.parametrize("name", list(ORBITS))
def test_a_curve_of_orbits_turns_off_beside_another_one(name, gap):
    assert stays(curve_of_orbits(name, gap * gap), gap, 1e-3 * gap)


@pytest.mark.parametrize("name", list(ORBITS))
def test_a_curve_of_orbits_that_another_one_crosses_says_so(name):
    found = curve_of_orbits(name, 0.0)
    np.testing.assert_allclose(found.columns["q"], -found.columns["p"], atol=1e-6)
    assert any("another curve crosses this one" in note for note in found.notes)
    assert found.unexplained == 0


@pytest.mark.parametrize("name", ["LPC", "BPC", *(pytest.param(n, marks=pytest.mark.long) for n in ("PD", "NS"))])
@pytest.mark.seldom
def test_a_curve_by_shooting_turns_off_beside_another_one(name):
    assert stays(curve_of_orbits(name, 1e-6, method="shooting"), 1e-3)


@pytest.mark.parametrize("type_", ["LP", "HB"])
@pytest.mark.seldom
def test_a_curve_of_a_sparse_system_turns_off_beside_another_one(type_):
    """States beyond the first one or two are x_k' = x_(k-1)/10 - x_k."""
    n, few = 12, 1 if type_ == "LP" else 2
    line = np.diag(np.full(n, -1.0)) + np.diag(np.full(n - 1, 0.1), -1)

    def residual(u, p):
        g, r2 = p["q"] ** 2 - p["p"] ** 2 - 1e-6, u[0] ** 2 + u[1] ** 2
        pair = [-g * u[0] - u[1] - u[0] * r2, u[0] - g * u[1] - u[1] * r2]
        return np.concatenate([[g - u[0] ** 2] if few == 1 else pair, 0.1 * u[few - 1 : -1] - u[few:]])

    def jacobian(u, p):
        g, (x, y) = p["q"] ** 2 - p["p"] ** 2 - 1e-6, u[:2]
        matrix = line.copy()
        if few == 1:
            matrix[0, 0] = -2.0 * x
        else:
            matrix[:2, :2] = [[-g - 3 * x * x - y * y, -1 - 2 * x * y], [1 - 2 * x * y, -g - x * x - 3 * y * y]]
        return sp.csc_array(matrix)

    start = (0.44**0.5 if few == 1 else 0.0) * 0.1 ** np.arange(n)
    problem = contin.FunctionProblem(residual, start, START, jacobian=jacobian)
    branch = contin.continuation(contin.equilibrium(problem), "p", (-2, 0))
    assert stays(contin.continuation(branch[f"{type_}1"].locus(("p", "q")), ("p", "q"), BOX), 1e-3)


@pytest.mark.parametrize("type_", ["CP", "BT", "GH"])
def test_a_curve_in_three_parameters_turns_off_beside_another_one(type_):
    rate = f"{G}*(x^2 + y^2) - (x^2 + y^2)^2"
    equations, first, x = {
        "CP": ({"x": f"a + {G}*x - x^3"}, "LP", 1.4),
        "BT": ({"x": "y", "y": f"a + {G}*y - x^2 + x*y"}, "LP", 1.0),
        "GH": ({"x": f"a*x - y + x*({rate})", "y": f"x + a*y + y*({rate})"}, "HB", 0.0),
    }[type_]
    states = dict.fromkeys(equations, 0.0) | {"x": x}
    model = Model("beside", states=states, parameters={"a": 1.0, **START, "e": 1e-6}, equations=equations)
    line = contin.continuation(contin.equilibrium(model), "a", (-2, 2))
    two = contin.continuation(line[f"{first}1"].locus(("a", "p")), ("a", "p"), {"a": (-4, 4), "p": (-2, 0)})
    names = ("a", "p", "q")
    assert stays(contin.continuation(two[f"{type_}1"].locus(names), names, {"a": (-4, 4), **BOX}), 1e-3)


@pytest.mark.parametrize("type_", ["LP", "BP"])
@pytest.mark.seldom
def test_a_curve_of_boundary_values_turns_off_beside_another_one(type_):
    """u' = 0 with g = u^2, or u g = u^3."""
    condition = f"{G} - u(start)*u(end) = 0" if type_ == "LP" else f"u(start)*{G} - u(end)^3 = 0"
    model = Model(
        "beside", kind="bvp", states={"u": 0}, equations={"u": "0"}, conditions=[condition],
        parameters={**START, "e": 1e-6}, starts={"there": {"u": 0.44**0.5 if type_ == "LP" else 0.0}},
    )  # fmt: skip
    coarse = {"intervals": 3, "points": 3, "max_step": 0.2}
    line = contin.continuation(boundary_guess(model, "there"), "p", (-2, 0), settings=coarse)
    found = contin.continuation(line[f"{type_}1"].locus(("p", "q")), ("p", "q"), BOX, settings=coarse)
    assert stays(found, 1e-3)


@pytest.mark.seldom
def test_a_curve_of_connections_turns_off_beside_another_one():
    """The loop x^2 (1 - x) = y^2 of `tests/homoclinic/test_connections.py`, which there is at g = 0."""
    equations = {"x": "a*x + y - a*x^2 + m*x*(2 - 3*x)", "y": "x + a*y - 1.5*x^2 - 1.5*a*x*y - 2*m*y"}
    model = Model(
        "beside", states={"x": 0.6, "y": 0}, parameters={**START, "a": -0.25, "e": 1e-6}, definitions={"m": G},
        equations=equations,
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-1.6, -0.3))
    family = contin.continuation(line["HB1"].switch(), "p", (-1.6, -0.3))
    assert stays(contin.continuation(family["HOM1"].locus(("p", "q")), ("p", "q"), BOX), 1e-3)
