"""Flows with a mass matrix: closed forms, pencils of matrices, and the same flow with and without algebraic states."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigvals
from scipy.optimize import brentq

import contin
from contin.errors import InputError, NotFiniteError
from contin.model.yaml_loader import load_model_text

BRUSSELATOR = {
    "name": "brusselator", "states": {"x": 1, "y": 1}, "parameters": {"B": 1},
    "equations": {"x": "1 - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
}  # fmt: skip
LORENZ = {
    "name": "lorenz", "states": {"x": 0, "y": 0, "z": 0}, "parameters": {"r": 0.5},
    "equations": {"x": "10*(y - x)", "y": "r*x - y - x*z", "z": "x*y - 8/3*z"},
}  # fmt: skip
PREDATORS = {
    "name": "predators", "states": {"x": 3, "y": 2}, "parameters": {"a": 0.3, "d": 0.1},
    "equations": {"x": "x - x*y/(1 + a*x) - 0.01*x^2", "y": "-y + x*y/(1 + a*x) - d*y^2"},
}  # fmt: skip
CYCLES = {
    "name": "cycles", "states": {"x": 0, "y": 0}, "parameters": {"mu": -0.1, "b": 1},
    "equations": {
        "x": "mu*x - y + (x + 0.3*x^2)*(b*(x^2 + y^2) - (x^2 + y^2)^2)",
        "y": "x + mu*y + y*(b*(x^2 + y^2) - (x^2 + y^2)^2) + 0.2*x*y",
    },
}  # fmt: skip
ROESSLER = {
    "name": "roessler", "states": {"x": 0, "y": 0, "z": 0}, "parameters": {"c": 1, "a": 0.2},
    "equations": {"x": "-y - z", "y": "x + a*y", "z": "0.2 + z*(x - c)"},
}  # fmt: skip


def with_algebraic(model: dict[str, Any], part: str) -> dict[str, Any]:
    """The same flow with a state w that an implicit equation makes equal to a part of its formulas."""
    written = {name: text.replace(part, "w") for name, text in model["equations"].items()}
    assert written != model["equations"]
    implicit = f"w + w^3/5 - ({part}) - ({part})^3/5"
    return model | {
        "states": model["states"] | {"w": 0.1}, "equations": written | {"w": implicit}, "mass": {"w": 0},
    }  # fmt: skip


def numbers(form: dict[str, Any]) -> dict[str, Any]:
    return {k: v for k, v in form.items() if k not in ("errors", "criticality", "kind")}


def assert_same_values(found: Any, known: Any) -> None:
    """Two sets of complex numbers, paired by the nearest."""
    left = list(known)
    assert len(found) == len(left)
    for value in found:
        nearest = min(left, key=lambda other: abs(other - value))
        assert abs(nearest - value) < 1e-6  # rows of a branch are solutions to the tolerance of the march
        left.remove(nearest)


def assert_alike(plain: Iterable[Any], algebraic: Iterable[Any], digits: float = 1e-8) -> list[str]:
    """Labels, places, coefficients with their words, and eigenvalues are the same."""
    seen = []
    for one, other in zip(plain, algebraic, strict=True):
        assert [p.label for p in one.points] == [p.label for p in other.points]
        for a, b in zip(one.points, other.points, strict=True):
            seen.append(a.type)
            for name in one.parameters:
                assert b.values[name] == pytest.approx(a.values[name], abs=digits)
            for key, value in numbers(a.normal_form).items():
                if key != "at":
                    np.testing.assert_allclose(b.normal_form[key], value, rtol=1e-6, atol=digits)
            for word in ("criticality", "kind"):
                assert a.normal_form.get(word) == b.normal_form.get(word)
            if a.type != "HOM":
                np.testing.assert_allclose(sorted(np.abs(b.eigenvalues)), sorted(np.abs(a.eigenvalues)), atol=1e-4)
        assert one.columns["unstable"].max() == other.columns["unstable"].max()
    return seen


@pytest.mark.seldom
def test_an_algebraic_state_changes_no_label_and_no_coefficient_of_equilibria_and_their_curves():
    def runs(model: Any) -> list[Any]:
        line = contin.continuation(contin.equilibrium(model), "a", (0.01, 0.8))
        box = {"a": (0.01, 0.8), "d": (0.001, 1)}
        return [line, *(contin.continuation(line[label].locus(), ("a", "d"), box) for label in ("LP1", "HB1"))]

    seen = assert_alike(*(runs(contin.Model(**m)) for m in (PREDATORS, with_algebraic(PREDATORS, "x*y/(1 + a*x)"))))
    assert {"LP", "HB", "BT"} <= set(seen)


def test_an_algebraic_state_changes_no_branch_point_no_orbit_and_no_homoclinic_one():
    def runs(model: Any) -> list[Any]:
        rest = contin.continuation(contin.equilibrium(model), "r", (0, 30))
        fork = contin.continuation(rest["BP1"].switch(), "r", (0, 30))
        return [rest, fork, contin.continuation(fork["HB1"].switch(), "r", (10, 30))]

    seen = assert_alike(*(runs(contin.Model(**m)) for m in (LORENZ, with_algebraic(LORENZ, "x*y"))))
    assert seen == ["BP", "HB", "HB", "HOM"]


@pytest.mark.seldom
def test_an_algebraic_state_changes_no_fold_of_cycles_and_no_generalised_hopf_point():
    def runs(model: Any) -> list[Any]:
        rest = contin.continuation(contin.equilibrium(model), "mu", (-1, 1))
        family = contin.continuation(rest["HB1"].switch(), "mu", (-1, 1))
        return [rest, family, contin.continuation(rest["HB1"].locus(), ("mu", "b"), {"mu": (-1, 1), "b": (-1, 1.5)})]

    part = "(b*(x^2 + y^2) - (x^2 + y^2)^2)"
    seen = assert_alike(*(runs(contin.Model(**m)) for m in (CYCLES, with_algebraic(CYCLES, part))))
    assert seen == ["HB", "LPC", "GH"]


def test_an_algebraic_state_changes_no_period_doubling():
    def runs(model: Any) -> list[Any]:
        rest = contin.continuation(contin.equilibrium(model), "c", (0.9, 4))
        start = contin.periodic_orbit(model, {"x": 2, "y": 0, "z": 0}, {"c": 2.5}, transient=200)
        family = contin.continuation(start, "c", (2.4, 3))
        assert rest.points == ()
        return [family]

    seen = assert_alike(*(runs(contin.Model(**m)) for m in (ROESSLER, with_algebraic(ROESSLER, "z*(x - c)"))), 1e-6)
    assert seen == ["PD"]


def test_colpitts_oscillator_has_its_hopf_point_at_one_whatever_its_quality():
    """lambda^3 + lambda^2/Q + lambda + g/Q = 0 has the roots +-i at g = 1."""
    for quality in (0.8, 1.4):
        model = contin.Model(
            name="colpitts", states={"x": 0, "y": 0, "z": 0, "w": 0}, parameters={"g": 0.5, "Q": quality, "k": 0.3},
            mass={"w": 0},
            equations={
                "x": "g/(Q*(1 - k))*(z - w)", "y": "g/(Q*k)*z", "z": "-Q*k*(1 - k)/g*(x + y) - z/Q",
                "w": "w + 1 - exp(-y)",
            },
        )  # fmt: skip
        line = contin.continuation(contin.equilibrium(model), "g", (0.5, 3))
        assert [p.type for p in line.points] == ["HB"]
        assert line["HB1"].values["g"] == pytest.approx(1.0, abs=1e-12)
        assert line["HB1"].normal_form["omega"] == pytest.approx(1.0, abs=1e-12)


def test_a_machine_at_an_infinite_bus_has_the_eigenvalues_of_its_pencil_and_its_load_limit():
    """Swing equation and the power balance at a load bus (angle theta, voltage V), with both states algebraic."""
    equations = {
        "delta": "omega", "omega": "P - 0.2*omega - 2*V*sin(delta - theta)",
        "theta": "2*V*sin(delta - theta) - 4*V*sin(theta) - p",
        "V": "2*V*cos(delta - theta) + 4*V*cos(theta) - 6*V^2 - q",
    }  # fmt: skip
    model = contin.Model(
        name="bus", states={"delta": 0.5, "omega": 0, "theta": 0.1, "V": 1}, mass={"omega": 0.3, "theta": 0, "V": 0},
        parameters={"P": 0.8, "p": 0.5, "q": 0.1}, equations=equations,
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "q", (0.1, 3))
    fold, rows = line["LP1"], [0, len(line.columns["q"]) // 2]
    for row in rows:
        d, t, v = (line.columns[name][row] for name in ("delta", "theta", "V"))
        s, c = np.sin(d - t), np.cos(d - t)
        a = np.array([
            [0, 1, 0, 0], [-2 * v * c, -0.2, 2 * v * c, -2 * s],
            [2 * v * c, 0, -2 * v * c - 4 * v * np.cos(t), 2 * s - 4 * np.sin(t)],
            [-2 * v * s, 0, 2 * v * s - 4 * v * np.sin(t), 2 * c + 4 * np.cos(t) - 12 * v],
        ])  # fmt: skip
        pencil = eigvals(a, np.diag([1.0, 0.3, 0.0, 0.0]))
        finite = pencil[np.isfinite(pencil) & (np.abs(pencil) < 1e6)]
        assert_same_values(line.eigenvalues[row], finite)
    # at rest V^2 and q are those of a line to a machine that feeds P: q is largest where dq/dV = 0 along the power flow
    assert fold.values["omega"] == pytest.approx(0.0, abs=1e-12)

    def reactive(v: float) -> float:
        d = np.arcsin(0.8 / (2 * v))
        t = np.arcsin((0.8 - 0.5) / (4 * v))
        return float(2 * v * np.cos(d) + 4 * v * np.cos(t) - 6 * v * v)

    top = brentq(lambda v: (reactive(v + 1e-6) - reactive(v - 1e-6)) / 2e-6, 0.42, 0.99, xtol=1e-13)
    assert fold.values["q"] == pytest.approx(reactive(top), abs=1e-9)
    assert fold.values["V"] == pytest.approx(top, abs=1e-6)


def test_a_small_mass_in_place_of_none_moves_the_hopf_point_by_its_first_order():
    base = with_algebraic(BRUSSELATOR, "x^2*y")
    reduced = contin.continuation(contin.equilibrium(contin.Model(**base)), "B", (0, 4))["HB1"].values["B"]
    assert reduced == pytest.approx(2.0, abs=1e-12)
    moved = []
    for mass in (-1e-3, -5e-4):  # negative: the equation as written falls towards w where the mass is
        model = contin.Model(**base | {"mass": {"w": mass}})
        line = contin.continuation(contin.equilibrium(model), "B", (0, 4))
        moved.append(line["HB1"].values["B"] - reduced)
        q, l1 = line["HB1"].vectors["q"], line["HB1"].normal_form["l1"]  # with a mass, w counts in |q| = 1
        assert l1 / np.linalg.norm(q[:2]) ** 2 == pytest.approx(-0.5, abs=0.01)
    assert moved[0] / moved[1] == pytest.approx(2.0, abs=0.05)


def test_a_mass_that_is_zero_at_the_defaults_alone_is_a_mass():
    model = contin.Model(**with_algebraic(BRUSSELATOR, "x^2*y") | {"parameters": {"B": 1, "e": 0}, "mass": {"w": "e"}})
    line = contin.continuation(contin.equilibrium(model, parameters={"e": -1e-3}), "B", (0, 4))
    assert line["HB1"].values["B"] == pytest.approx(2.0, abs=5e-3)
    with pytest.raises(NotFiniteError, match=r"division by zero, 'e' = 0.*the mass of w vanishes.*`mass: {w: 0}`"):
        contin.equilibrium(model)


@pytest.mark.parametrize(("mass", "bounds", "unit"), [
    ({"y": "e"}, (-1, 1), 1.0), ({"y": "e"}, (0, 10), 1.0),
    ({"y": "e", "z": "2*e"}, (-1, 1), 1.0), ({"y": {"y": "e", "z": 0.1}, "z": {"y": 0.1, "z": "e"}}, (-1, 1), 1.0),
    ({"y": "e/1e-9"}, (-1, 1), 1e-9),
])  # fmt: skip
def test_a_branch_ends_in_words_where_a_mass_vanishes(mass, bounds, unit):
    """m(e) y' = y - y^3/3 - z + .5: the state does not move with e, every row has the eigenvalues of its pencil."""
    model = contin.Model(
        name="relaxation", states={"y": -1, "z": 0}, parameters={"e": 0.7 * unit}, mass=mass,
        equations={"y": "y - y^3/3 - z + 0.5", "z": "y + 0.7 - 0.8*z"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "e", (bounds[0] * unit, bounds[1] * unit))
    zero = 0.1 * unit if isinstance(mass["y"], dict) else 0.0  # e^2 = .01
    assert "mass of y" in line.ends[0].text
    assert line.ends[0].data["at"]["e"] == pytest.approx(zero, abs=1e-9 * unit)
    assert line.columns["e"][0] > zero
    assert line.columns["e"][0] == pytest.approx(zero, abs=1e-5 * unit)
    assert line.unexplained == 0
    y = line.columns["y"][0]
    a = np.array([[1 - y * y, -1.0], [1.0, -0.8]])
    for row in (0, len(line) // 2):
        e = line.columns["e"][row] / unit
        m = {1: np.diag([e, 1]), 2: np.array([[e, 0.1], [0.1, e]])}[2 if zero else 1]
        m = np.diag([e, 2 * e]) if "z" in mass and not zero else m
        assert line.columns["unstable"][row] == np.sum(np.linalg.eigvals(np.linalg.solve(m, a)).real > 0)


@pytest.mark.parametrize(("mass", "matrix"), [
    ({"x": {"x": 1, "y": "c"}, "y": {"x": 0.2, "y": 2}}, [[1, 0.5], [0.2, 2]]),
    ({"x": 3, "y": "c"}, [[3, 0], [0, 0.5]]),
])  # fmt: skip
def test_an_invertible_matrix_gives_the_eigenvalues_of_its_pencil(mass: Any, matrix: Any):
    model = contin.Model(**BRUSSELATOR | {"parameters": {"B": 1, "c": 0.5}, "mass": mass})
    line = contin.continuation(contin.equilibrium(model), "B", (0, 4))
    for row in (0, -1):
        b, x, y = (float(line.columns[name][row]) for name in ("B", "x", "y"))
        a = np.array([[-(b + 1) + 2 * x * y, x * x], [b - 2 * x * y, -x * x]])
        assert_same_values(line.eigenvalues[row], eigvals(a, np.array(matrix, dtype=float)))


def test_a_singular_matrix_that_couples_derivatives_has_its_finite_eigenvalues():
    model = contin.Model(
        name="coupled", states={"x": 1, "y": 1, "u": 0}, parameters={"B": 1},
        mass={"x": {"x": 1, "y": 1}, "y": 0}, equations={"x": "B - x - u", "y": "y^3 + y - x", "u": "x - 0.3*u"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "B", (0, 4))
    y = float(line.columns["y"][0])
    a = np.array([[-1, 0, -1], [-1, 3 * y * y + 1, 0], [1, 0, -0.3]])
    pencil = eigvals(a, np.array([[1.0, 1, 0], [0, 0, 0], [0, 0, 1]]))
    assert_same_values(line.eigenvalues[0], pencil[np.abs(pencil) < 1e8])


def test_trajectories_of_a_forced_flow_are_those_of_its_algebraic_states_solved_at_each_time():
    model = contin.Model(
        name="forced", states={"x": 1, "v": 0, "w": 0}, parameters={"om": 1.3}, forcing={"period": "2*pi/om"},
        mass={"w": 0},
        equations={"x": "v", "v": "w - 0.2*v + 0.5*cos(om*t)", "w": "w + x + x^3 + 0.1*w^3*(1.5 + cos(om*t))"},
    )  # fmt: skip
    found = contin.simulate(model, {"x": 1, "v": 0, "w": 3}, time=20, samples=5)
    assert found.note == "consistent initial values: w = -1.36466"

    def rate(t: float, u: Any) -> list[float]:
        w = brentq(lambda w: w + u[0] + u[0] ** 3 + 0.1 * w**3 * (1.5 + np.cos(1.3 * t)), -50, 50, xtol=1e-14)
        return [u[1], w - 0.2 * u[1] + 0.5 * np.cos(1.3 * t)]

    other = solve_ivp(rate, (0, 20), [1, 0], "DOP853", t_eval=found.t, rtol=1e-10, atol=1e-12).y.T
    np.testing.assert_allclose(found.states[:, :2], other, atol=1e-6)
    w, x = found.states[:, 2], found.states[:, 0]
    np.testing.assert_allclose(w + x + x**3 + 0.1 * w**3 * (1.5 + np.cos(1.3 * found.t)), 0.0, atol=1e-9)


def test_a_branch_ends_where_an_eigenvalue_passes_through_infinity():
    model = contin.Model(
        name="singular", states={"x": 1, "z": 2}, parameters={"p": 1}, mass={"z": 0},
        equations={"x": "p - x + 0.3*z", "z": "z^2 - x - 1"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-4, 4))  # z = 0 at x = p = -1
    assert [p.type for p in line.points] == ["LP"]
    assert abs(line.ends[0].data["at"]["p"] + 1.0) <= line.ends[0].data["error"] < 1e-3
    assert "singularity-induced" in line.ends[0].text
    assert line.unexplained == 0


def test_where_the_index_rises_is_stated_with_its_error():
    """z = p, and 1 - z^2 = 0: at 1, beside which the tangent of the last row is off by a fifth, and at -1."""
    model = contin.Model(
        name="cubic", states={"x": -0.458, "z": 0.5}, parameters={"p": 0.5}, mass={"z": 0},
        equations={"x": "p - z", "z": "x - z^3/3 + z"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "p", (-2, 3))
    for end, exact in zip(line.ends, (-1.0, 1.0), strict=True):
        assert abs(end.data["at"]["p"] - exact) <= end.data["error"] < 1e-3


@pytest.mark.parametrize(("equations", "named"), [
    ({"x": "y", "y": "-x + w", "w": "x - y"}, "equation w does"),
    ({"x": "y + w", "y": "w - v", "w": "x + v", "v": "y + v"}, "equations w, v do"),
    ({"x": "y", "y": "-x", "w": "w - v", "v": "2*v - 2*w + x"}, "equations w, v do"),
])  # fmt: skip
def test_a_higher_index_is_refused_with_the_equations(equations: dict[str, str], named: str):
    states = dict.fromkeys(equations, 1)
    model = contin.Model(
        name="high", states=states, parameters={"p": 1}, mass={k: 0 for k in ("w", "v") if k in states},
        equations=equations,
    )  # fmt: skip
    with pytest.raises(InputError, match=f"index is above 1: the algebraic {named}"):
        contin.equilibrium(model)


def test_the_unit_of_time_changes_the_rates_alone():
    fast = with_algebraic(BRUSSELATOR, "x^2*y")
    fast = fast | {"equations": {k: v if k == "w" else f"1e9*({v})" for k, v in fast["equations"].items()}}
    line = contin.continuation(contin.equilibrium(contin.Model(**fast)), "B", (0, 4))
    assert line["HB1"].normal_form["l1"] == pytest.approx(-0.5, abs=1e-9)
    assert line["HB1"].normal_form["omega"] == pytest.approx(1e9, rel=1e-12)
    family = contin.continuation(line["HB1"].switch(), "B", (2, 3))
    assert family.eigenvalues[-1, 0] == pytest.approx(1.0, abs=1e-6)
    assert family.eigenvalues.shape[1] == 2


def test_a_model_file_keeps_its_matrix():
    model = contin.Model(**BRUSSELATOR | {"mass": {"x": {"x": 1, "y": "B"}, "y": 0}})
    again = load_model_text(model.text(), model.name, False)
    assert again == model


def test_a_branch_ends_before_corrections_are_rounding_where_the_index_rises():
    """Van der Pol's slow manifold: rests at x = a, which cross its fold at 1, where what is divided by vanishes."""
    model = contin.Model(
        name="relaxed", states={"x": 1.5, "y": -0.375}, parameters={"a": 1.5}, mass={"x": 0},
        equations={"x": "y - (x^3/3 - x)", "y": "a - x"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "a", (-2, 2))
    assert line.ends[0].reason == "bound"
    assert line.ends[0].data["at"]["a"] == pytest.approx(1.0, abs=1e-6)
    assert not line.points
    assert line.unexplained == 0
    assert np.abs(line.columns["x"] - line.columns["a"]).max() < 1e-6  # Newton's tolerance
    assert not line.columns["unstable"].any()
