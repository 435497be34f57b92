"""Fields on an interval, a circle and a rectangle take every verb that sparse functions take, or say why not."""

from functools import lru_cache
from itertools import islice

import numpy as np
import pytest

import contin
from contin.problems.algebraic_states import massless

DOMAINS = {
    "interval": {"x": {"to": "pi", "points": 6}},
    "circle": {"x": {"to": "2*pi", "points": 6, "method": "fourier"}},
    "rectangle": {"x": {"to": "pi", "points": 4}, "y": {"to": "3", "points": 4}},
}

BEYOND = {"interval": 1.2, "circle": 0.4, "rectangle": 2.2}  # the first Hopf point


@lru_cache(maxsize=3)
def landau(kind):
    """A complex field whose rest has a supercritical Hopf point."""
    lap = "lap" if kind == "rectangle" else "dxx"
    more = {} if kind == "circle" else {"boundary": {"all": ["u = 0", "v = 0"]}}
    return contin.load({
        "name": kind, "kind": "pde", "domain": DOMAINS[kind], "fields": {"u": 0, "v": 0},
        "parameters": {"mu": {"value": -0.5, "range": [-0.5, BEYOND[kind]]}, "A": {"value": 0.5, "range": [0.4, 0.6]}},
        "equations": {
            "u": f"mu*u - v + {lap}(u) - A*{lap}(v) - (u^2 + v^2)*u",
            "v": f"mu*v + u + {lap}(v) + A*{lap}(u) - (u^2 + v^2)*v",
        },
        **more,
    })  # fmt: skip


@lru_cache(maxsize=3)
def line(model):
    return contin.continuation(model, "mu")


def born(model):
    return contin.continuation(line(model)["HB1"].switch(), "mu", settings={"steps": 2, "intervals": 6})


def box(model, **more):
    return contin.phase(model, ["mu", "A"], {"mu": (-0.5, -0.4), "A": (0.45, 0.5)}, settings={"steps": 5}, **more)


TAKEN = {
    "equilibrium": contin.equilibrium,
    "find_start": contin.find_start,
    "continuation": line,
    "switch": born,
    "locus": lambda m: contin.continuation(line(m)["HB1"].locus(["mu", "A"]), ["mu", "A"], settings={"steps": 2}),
    "simulate": lambda m: contin.simulate(m, time=0.5, samples=3),
    "simulate, stiff": lambda m: contin.simulate(m, time=0.5, samples=3, method="Radau"),
    "scan": lambda m: contin.scan(m, {"mu": [-0.5]}),
    "diagram": lambda m: contin.diagram(m, "mu", (-0.5, -0.3), settings={"steps": 10}),
    "phase": box,
    "survey": lambda m: contin.survey(m, names=["mu"], processes=1),
    "plot": lambda m: line(m).plot(),
    "walk": lambda m: list(islice(contin.walk(m, "mu"), 2)),
    "deflated": lambda m: contin.deflated(m, "mu", (-0.5, -0.4), samples=1, tries=1, settings={"steps": 2}),
    "draw": lambda m: contin.draw(line(m)),
}
REFUSED = {
    "find_equilibria": (contin.find_equilibria, "states without names"),
    "simulate, until": (lambda m: contin.simulate(m, time=0.5, until="u > 10"), "has no formulas"),
    "plane": (lambda m: contin.plane(m, "u", "v"), "have none"),
    "average": (contin.average, "only a model of formulas"),
    "connection": (lambda m: contin.connection(m, {"u": 1.0}), "given by formulas"),
    "manifold": (lambda m: contin.manifold(m, {"u": 0.0, "v": 0.0}, length=1.0), "given by formulas"),
    "torus": (lambda m: contin.torus(m, "mu", (0.1, 2.0)), "given by formulas"),
    "boundary_problem": (contin.boundary_problem, "kind: bvp"),
}


@pytest.mark.parametrize(
    "kind", [pytest.param("interval", marks=pytest.mark.long), "circle", "rectangle"]
)  # differences on an interval are those on a rectangle
@pytest.mark.seldom
def test_fields_take_verbs_or_say_why_not(kind):
    model = landau(kind)
    for verb, call in TAKEN.items():
        assert str(call(model)), verb
    for verb, (call, words) in REFUSED.items():
        with pytest.raises(contin.ContinError) as refused:
            call(model)
        assert words in str(refused.value), verb


@pytest.mark.seldom
def test_orbits_that_simulations_settle_on_are_those_born_at_the_hopf_point():
    """a exp(i t) of the whole circle, a^2 = mu, whose frequency is 1; both have the columns of the fields."""
    model = landau("circle")
    orbit = contin.periodic_orbit(model, {"u": 0.5, "v": 0}, {"mu": 0.25})
    assert "of 12 states" in str(orbit)
    family = contin.continuation(orbit, "mu", (0.2, 0.3), settings={"steps": 1})
    columns = family.columns
    assert columns["u.max.max"] == pytest.approx(columns["mu"] ** 0.5, rel=1e-4)
    assert columns["period"] == pytest.approx(6.283185307, rel=1e-6)
    assert set(born(model).columns) <= set(columns)


@pytest.mark.seldom
def test_functions_whose_states_have_no_names_have_columns_of_their_norm():
    n = 52

    def ring(u, p):
        x, y = u[: n // 2], u[n // 2 :]
        square = x * x + y * y
        pulled = [x.mean() - x, y.mean() - y]
        return [*(p["mu"] * x - y - square * x + pulled[0]), *(x + p["mu"] * y - square * y + pulled[1])]

    function = contin.FunctionProblem(ring, [0.5] * (n // 2) + [0.0] * (n // 2), {"mu": 0.25})
    orbit = contin.periodic_orbit(function, intervals=10)
    family = contin.continuation(orbit, "mu", (0.24, 0.26), settings={"steps": 1, "intervals": 10})
    assert family.columns["norm.max"] == pytest.approx((family.columns["mu"] / 2.0) ** 0.5, rel=1e-5)


def test_simulations_of_fields_that_come_to_rest_say_so_and_all_their_states_have_mass():
    model = landau("circle")
    with pytest.raises(contin.ContinError, match=r"comes to rest at an equilibrium \(of 12 states"):
        contin.periodic_orbit(model, {"u": 0.01, "v": 0.0}, {"mu": -0.5})
    assert massless(model.in_kernels).tolist() == [False] * 12  # () made means of eigenfunctions 0, and folds nameless


@pytest.mark.long
def test_folds_of_simulated_orbits_of_fields_have_the_normal_form_of_the_same_formulas():
    """Two inner nodes, both with r' = r (mu - 9 + r^2 - r^4) where they are alike: folded at mu = 9 - 1/4."""
    growth, found = "(mu + {0}^2 + {1}^2 - ({0}^2 + {1}^2)^2)", []
    here = growth.format("u", "v")
    field = contin.load({
        "name": "nodes", "kind": "pde", "domain": {"x": {"to": 1, "points": 4}}, "fields": {"u": 0, "v": 0},
        "parameters": {"mu": 9.0}, "boundary": {"all": ["u = 0", "v = 0"]},
        "equations": {"u": f"{here}*u - v + dxx(u)", "v": f"{here}*v + u + dxx(v)"},
    })  # fmt: skip
    one, other = growth.format("u", "v"), growth.format("w", "z")
    formulas = contin.load({
        "name": "nodes", "states": {"u": 1.0, "v": 0.0, "w": 1.0, "z": 0.0}, "parameters": {"mu": 9.0},
        "equations": {
            "u": f"{one}*u - v + 9*(w - 2*u)", "v": f"{one}*v + u + 9*(z - 2*v)",
            "w": f"{other}*w - z + 9*(u - 2*w)", "z": f"{other}*z + w + 9*(v - 2*z)",
        },
    })  # fmt: skip
    for model in (field, formulas):
        t = np.linspace(0.0, 2.0 * np.pi, 33)
        cycle = 0.775 * np.array([np.cos(t), np.sin(t)])
        samples = np.vstack([cycle, cycle]).T  # u, v at each node
        orbit = contin.periodic_orbit(model, samples, {"mu": 8.76}, times=t, intervals=6)
        line = contin.continuation(orbit, "mu", (8.7, 8.765), settings={"stop_at": ("LPC",), "intervals": 6})
        fold = line["LPC1"]
        assert fold.values["mu"] == pytest.approx(8.75, abs=1e-6)
        found.append(abs(fold.normal_form["b"]))
    assert found[0] == pytest.approx(found[1], rel=1e-4)
