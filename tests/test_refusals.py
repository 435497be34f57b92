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
