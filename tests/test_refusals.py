"""Mistakes that people bring from other tools: the message says what to write instead."""

import pytest

import contin
from contin.errors import InputError

RING = {
    "name": "ring",
    "states": {"x": 0.5, "y": 0.0},
    "parameters": {"mu": {"value": 0.25, "range": [-1, 1]}},
    "equations": {"x": "mu*x - y - x*(x^2 + y^2)", "y": "x + mu*y - y*(x^2 + y^2)"},
}


def test_refusals_say_what_to_write():
    model = contin.load(RING)
    rest = contin.equilibrium(model)
    with pytest.raises(InputError, match="did you mean 'mu'"):
        contin.continuation(rest, "muu", (-1, 1))
    point = contin.continuation(rest, "mu", (-1, 1))["HB1"]
    with pytest.raises(InputError, match="curve in two parameters: give both"):
        contin.continuation(point.locus(), "mu", (-1, 1))


@pytest.mark.parametrize(
    ("formula", "advice"),
    [
        ("mu - np.exp(x)", r"write exp\(x\)"),
        ("mu - math.sin(x)*2", r"write sin\(x\)"),
        ("numpy.pi*x", "write pi"),
        ("mu - x(t - 1)", "delay equation"),
        ("a.b*x", "an underscore"),
    ],
)
def test_formulas_of_other_languages(formula, advice):
    with pytest.raises(InputError, match=advice):
        contin.load({**RING, "equations": {**RING["equations"], "x": formula}})


@pytest.mark.parametrize(
    ("formula", "feature"),
    [
        ("mu - x(t - 1)", "delay equations are not supported"),
        ("mu - x[t - 1]", "delay equations are not supported"),
        ("mu - delay(x, 1)", "delay equations are not supported"),
        ("mu - x_tau", "delay equations are not supported"),
        ("-x + mu*noise()", "stochastic equations are not supported"),
        ("-x + mu*dW", "stochastic equations are not supported"),
        ("integral(x^2)", "integrals are not supported in equations"),
        ("mu*dxx(x) - x", "derivatives in space need kind: pde"),
        ("mu*laplacian(x)", "derivatives in space need kind: pde"),
        ("x'' + x", "write two states"),
        ("diff(x, t)", "write two states"),
        ("erf(x)", "special functions are not supported"),
    ],
)
def test_what_formulas_cannot_say_is_named(formula, feature):
    with pytest.raises(InputError, match=feature):
        contin.load({**RING, "equations": {**RING["equations"], "x": formula}})


@pytest.mark.parametrize(
    ("extra", "feature"),
    [
        ({"kind": "dde"}, "delay equations are not supported"),
        ({"kind": "ode"}, "write flow"),
        ({"delays": {"tau": 1}}, "delay equations are not supported"),
        ({"noise": {"x": 1}}, "stochastic equations are not supported"),
        ({"boundary": {"all": "u = 0"}}, "kind: pde"),
    ],
)
def test_keys_and_kinds_of_other_problems_are_named(extra, feature):
    with pytest.raises(InputError, match=feature):
        contin.load({**RING, **extra})


def test_a_declared_name_is_never_taken_for_a_delay_or_a_noise():
    states = {"x": 1.0, "x_tau": 0.5, "noise": 0.0}
    equations = {"x": "-x + x_tau", "x_tau": "x - x_tau + dW", "noise": "-noise"}
    model = contin.load({"name": "chain", "states": states, "parameters": {"dW": 0.1}, "equations": equations})
    assert model.state_names == ("x", "x_tau", "noise")


VERBS = {
    "average": contin.average,
    "boundary_problem": contin.boundary_problem,
    "connection": contin.connection,
    "continuation": lambda given: contin.continuation(given, "mu", (0, 1)),
    "deflated": lambda given: contin.deflated(given, "mu", (0, 1)),
    "diagram": lambda given: contin.diagram(given, "mu", (0, 1)),
    "draw": contin.draw,
    "equilibrium": contin.equilibrium,
    "find_equilibria": contin.find_equilibria,
    "find_start": contin.find_start,
    "lyapunov": contin.lyapunov,
    "manifold": lambda given: contin.manifold(given, length=1.0),
    "periodic_orbit": contin.periodic_orbit,
    "phase": lambda given: contin.phase(given, ["mu", "nu"], {"mu": (0, 1), "nu": (0, 1)}),
    "plane": lambda given: contin.plane(given, "x", "y"),
    "scan": lambda given: contin.scan(given, {"mu": [0.0, 1.0]}),
    "simulate": contin.simulate,
    "survey": contin.survey,
    "sweep": lambda given: contin.sweep(given, "mu", (0, 1)),
    "torus": lambda given: contin.torus(given, "mu", (0, 1)),
    "walk": lambda given: next(contin.walk(given, "mu", (0, 1))),
}


@pytest.mark.parametrize("given", ["a-name", RING, lambda u, p: u, None], ids=["name", "mapping", "function", "none"])
def test_every_verb_refuses_what_is_no_model_in_words(given):
    elsewhere = {"average", "lyapunov", "plane", "scan", "simulate", "sweep"}
    assert elsewhere | {*contin.__all__} & {*contin.api.__all__} == {*VERBS, "connecting_orbit"}
    for verb in VERBS.values():
        with pytest.raises(InputError):
            verb(given)


def test_what_is_no_model_is_told_how_to_become_one():
    with pytest.raises(InputError, match=r"got str: load it first: contin.load\('brusselator'\)"):
        contin.equilibrium("brusselator")
    with pytest.raises(InputError, match=r"got function: .* contin.FunctionProblem\(function, u0, parameters\)"):
        contin.simulate(lambda u, p: u)
    line = contin.continuation(contin.equilibrium(contin.load(RING)), "mu", (-1, 1))
    with pytest.raises(InputError, match=r"got SpecialPoint: .* contin.continuation\(point.switch\(\), ...\)"):
        contin.periodic_orbit(line["HB1"])
