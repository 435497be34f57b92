"""One contract: every verb against every kind of system, as the table of docs/user-functions.md says."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator

import contin

DOCS = Path(__file__).parents[2] / "docs" / "user-functions.md"
VALUES = {"A": 1.0, "B": 1.0}
NAMES = {"states": ["x", "y"], "ranges": {"A": (0.5, 2.0), "B": (0.5, 3.0)}}


def brusselator(u, p):
    x, y = u
    return np.array([p["A"] - (p["B"] + 1) * x + x**2 * y, p["B"] * x - x**2 * y])


def slopes(u, p):
    x, y = u
    return np.array([[-(p["B"] + 1) + 2 * x * y, x * x], [p["B"] - 2 * x * y, -x * x]])


def henon(u, p):
    return np.array([1 - p["A"] * u[0] ** 2 + u[1], p["B"] * u[0]])


def function(jacobian=None, **more):
    return contin.FunctionProblem(brusselator, [1.0, 1.0], VALUES, jacobian, **NAMES, **more)


MASS = np.array([[1.0, 0.2], [0.1, 2.0]])


def with_mass():
    """M u' = M F, with a sparse Jacobian, so that M is kept."""
    return contin.FunctionProblem(
        lambda u, p: MASS @ brusselator(u, p), [1.0, 1.0], VALUES, lambda u, p: sp.csc_matrix(MASS @ slopes(u, p)),
        mass=MASS, **NAMES,
    )  # fmt: skip


def algebraic():
    """The same flow with w = x^2 y as a third state, of index 1."""
    names = {"states": ["x", "y", "w"], "ranges": NAMES["ranges"]}

    def residual(u, p):
        x, y, w = u
        return np.array([p["A"] - (p["B"] + 1) * x + w, p["B"] * x - w, w - x**2 * y])

    return contin.FunctionProblem(residual, [1.0, 1.0, 1.0], VALUES, mass=[1.0, 1.0, 0.0], **names)


class Elsewhere:
    """An array of another module: it refuses to be made one of numpy's."""

    def __init__(self, numbers):
        self.numbers = np.array(numbers)

    def __array__(self, *arguments, **options):
        raise TypeError("implicit conversion")

    def __getitem__(self, place):
        return Elsewhere(self.numbers[place])

    def __add__(self, other):
        return Elsewhere(self.numbers + getattr(other, "numbers", other))

    def __mul__(self, other):
        return Elsewhere(self.numbers * getattr(other, "numbers", other))

    __rmul__, __radd__ = __mul__, __add__


def stacked(*parts):
    return Elsewhere([part.numbers for part in parts])


def elsewhere():
    """The flow with arrays of its own, and its Jacobian by products alone."""

    def residual(u, p):
        x, y = u[0], u[1]
        assert isinstance(u, Elsewhere)
        return stacked(p["A"] + (-p["B"] - 1) * x + x * x * y, p["B"] * x + -1 * (x * x * y))

    def product(u, p):
        x, y = u[0], u[1]

        def along(v):
            change = 2 * x * y * v[0] + x * x * v[1]
            return stacked((-p["B"] - 1) * v[0] + change, p["B"] * v[0] + -1 * change)

        return along

    arrays = (Elsewhere, lambda given: given.numbers)
    return contin.FunctionProblem(residual, [1.0, 1.0], VALUES, product, arrays=arrays, **NAMES)


KINDS = {
    "formulas": lambda: contin.load("classics/brusselator"),
    "value only": function,
    "dense": lambda: function(slopes),
    "pattern": lambda: function(sparsity=np.ones((2, 2))),
    "sparse": lambda: function(lambda u, p: sp.csc_matrix(slopes(u, p))),
    "matrix-free": lambda: function(
        lambda u, p: LinearOperator((2, 2), matvec=lambda v: slopes(u, p) @ v, dtype=float)
    ),
    "other arrays": elsewhere,
    "mass": with_mass,
    "singular mass": algebraic,
    "map": lambda: contin.FunctionProblem(
        henon, [0.7, 0.2], {"A": 0.2, "B": 0.3}, kind="map", states=["x", "y"], ranges={"A": (0, 0.6), "B": (0.2, 0.4)}
    ),
}


@lru_cache(maxsize=1)
def line(model):
    if model.kind == "map":
        return contin.continuation(model, "A", (0.1, 0.6))
    return contin.continuation(contin.equilibrium(model, {"x": 1, "y": 1}, VALUES), "B", (0.5, 3.0))


def first(model):
    return next(point for point in line(model).points if point.type in ("HB", "PD"))


def born(model, steps=6):
    parameter = "A" if model.kind == "map" else "B"
    return contin.continuation(first(model).switch(), parameter, (0.1, 3.0), settings={"steps": steps})


def curve(model):
    return contin.continuation(
        first(model).locus(["A", "B"]), ["A", "B"], {"A": (0.1, 2), "B": (0.1, 5)}, settings={"steps": 2}
    )


def cycle(model):
    if model.kind == "map":
        return contin.equilibrium(model, {"x": 0.97, "y": -0.02}, {"A": 0.9}, period=2)
    return contin.periodic_orbit(model, {"x": 1.3, "y": 1.2}, {"A": 1.0, "B": 2.5})


VERBS = {
    "equilibrium": contin.equilibrium,
    "find_equilibria": lambda m: contin.find_equilibria(m, box=dict.fromkeys(m.state_names, (0.1, 3)), starts=4),
    "find_start": contin.find_start,
    "continuation": line,
    "switch": lambda m: born(m, 1),
    "locus": curve,
    "cycle": cycle,
    "simulate": lambda m: contin.simulate(m, time=10.0, samples=20),
    "simulate, until": lambda m: contin.simulate(m, time=10.0, until="x > 10"),
    "simulate, stiff": lambda m: contin.simulate(m, time=10.0, method="Radau", samples=20),
    "sweep": lambda m: contin.sweep(m, "A", (0.6, 0.8), steps=1),
    "lyapunov": lambda m: contin.lyapunov(m, time=1.0, transient=0.0, count=1),
    "scan": lambda m: contin.scan(m, {"A": [0.3, 0.6]}),
    "diagram": lambda m: contin.diagram(m, "A", (0.1, 0.6) if m.kind == "map" else (0.5, 1.5), settings={"steps": 10}),
    "phase": lambda m: contin.phase(
        m, ["A", "B"], {"A": (0.8, 0.9), "B": (0.25, 0.35)}, orbits=False, settings={"steps": 5}
    ),
    "survey": lambda m: contin.survey(m, names=["A"], processes=1),
    "plane": lambda m: contin.plane(m, "x", "y", x_range=(0.7, 0.8), y_range=(0.2, 0.3)),
    "plot": lambda m: line(m).plot(),
    "average": contin.average,
    "walk": lambda m: list(islice(contin.walk(m, "A", (0.1, 1.5)), 3)),
    "deflated": lambda m: contin.deflated(m, "A", (0.1, 1.2), samples=1, tries=1, settings={"steps": 2}),
    "draw": lambda m: contin.draw(line(m)),
    "connection": lambda m: contin.connection(m, {"x": 1.0, "y": 1.0}),
    "manifold": lambda m: contin.manifold(
        m, {"x": 1.0, "y": 1.0}, VALUES | {"B": 2.5}, length=1.0, spacing=1.0, samples=20
    ),
    "torus": lambda m: contin.torus(m, "A", (0.1, 2.0), start={"x": 1.3, "y": 1.2}),
    "boundary_problem": contin.boundary_problem,
}


ELSEWHERE = {  # what takes no system, or makes one
    "__version__", "ContinError", "InputError", "FunctionProblem", "Model", "load", "read",
    "from_autograd", "from_casadi", "from_jax", "from_petsc", "multigrid",
}  # fmt: skip


def table() -> dict[tuple[str, str], bool]:
    """(verb, kind) -> whether the docs say that it works."""
    rows = [
        [cell.strip(" `") for cell in row.strip("|\n").split("|")]
        for row in DOCS.read_text().splitlines() if row.startswith("| ")
    ]  # fmt: skip
    head = next(row for row in rows if row[0] == "verb")
    return {
        (row[0], kind): cell == "yes"
        for row in rows if row[0] in VERBS for kind, cell in zip(head[1:], row[1:], strict=True)
    }  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_verb_takes_this_kind_of_system_or_says_why_not(kind, monkeypatch):
    monkeypatch.setattr(import_module("contin.plane.portrait"), "CELLS_OF_FUNCTIONS", 12)  # coarse nullclines do
    said = table()
    assert {verb for verb, _ in said} == set(VERBS), "a verb without a row"
    assert set(contin.__all__) - ELSEWHERE <= set(VERBS) | {"periodic_orbit", "connecting_orbit"}
    model = KINDS[kind]()
    for verb, call in VERBS.items():
        if said[verb, kind]:
            call(model)
            continue
        with pytest.raises(contin.InputError) as refused:
            call(model)
        assert len(str(refused.value)) > 30, (verb, kind)


@pytest.mark.parametrize("kind", ["value only", "dense"])
def test_orbits_of_a_function_are_those_of_the_formulas(kind):
    orbits = [born(KINDS[name]()) for name in ("formulas", kind)]
    for name in ("period", "x.max", "B"):
        np.testing.assert_allclose(orbits[1].columns[name], orbits[0].columns[name], rtol=1e-7)


@pytest.mark.parametrize("kind", ["value only", "pattern", "sparse", "matrix-free"])
def test_trajectories_of_a_function_are_those_of_the_formulas(kind):
    given = {"start": {"x": 1.3, "y": 1.2}, "parameters": {"A": 1.0, "B": 2.5}, "time": 10.0, "samples": 50}
    exact = contin.simulate(KINDS["formulas"](), **given, rtol=1e-12)
    for method in ("DOP853", "Radau"):
        found = contin.simulate(KINDS[kind](), **given, method=method)
        np.testing.assert_allclose(found.states, exact.states, rtol=1e-5)


def test_what_python_raises_in_a_callback_is_raised_again():
    class GoneError(BaseException):
        pass

    calls = []

    def residual(u, p):
        calls.append(1)
        if len(calls) > 400:
            raise GoneError
        return np.array([u[1], p["mu"] * (1 - u[0] ** 2) * u[1] - u[0]])

    model = contin.FunctionProblem(residual, [1.0, 0.0], {"mu": 1.0}, states=["x", "y"])
    with pytest.raises(GoneError):
        contin.simulate(model, time=1000.0)
