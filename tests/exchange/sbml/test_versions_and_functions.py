"""SBML: formulas of all levels, functions, identifiers and values."""

import math

import numpy as np

import contin
from tests.exchange.sbml.writing import (
    HEADS,
    compartment,
    function,
    mathml,
    parameter,
    reaction,
    reference,
    rule,
    simulated,
    species,
)


def test_level_2_has_formulas_for_stoichiometries(tmp_path):
    inside = f"<stoichiometryMath>{mathml('2*k + time')}</stoichiometryMath>"
    varying = f'<speciesReference species="A">{inside}</speciesReference>'
    got = simulated(
        tmp_path, level=2, Compartments=['<compartment id="C" size="2"/>'], Parameters=[parameter("k", 3)],
        Species=[species("A", amount=0), species("B", amount=1)],
        Reactions=[reaction("R", [reference("B", 0.5, "")], [varying], "1")],
    )  # fmt: skip
    np.testing.assert_allclose(got["amount_A"], 6 * got["t"] + got["t"] ** 2 / 2, atol=1e-9)
    np.testing.assert_allclose(got["amount_B"], 1 - 0.5 * got["t"], atol=1e-9)


def test_level_1_has_formulas_as_text(tmp_path):
    local = '<listOfParameters><parameter name="k" value="2"/></listOfParameters>'
    law = f'<kineticLaw formula="k*A*C">{local}</kineticLaw>'
    text = (
        f'<?xml version="1.0"?>{HEADS[1]}<model name="m"><listOfCompartments><compartment name="C" volume="2"/>'
        '</listOfCompartments><listOfSpecies><species name="A" compartment="C" initialAmount="3"/></listOfSpecies>'
        '<listOfReactions><reaction name="R"><listOfReactants><speciesReference species="A"/></listOfReactants>'
        f"{law}</reaction></listOfReactions></model></sbml>"
    )
    file = tmp_path / "one.xml"
    file.write_text(text)
    found = contin.simulate(contin.load(str(file)), time=1.0, samples=3, rtol=1e-10)
    np.testing.assert_allclose(found.table["amount_A"], 3 * np.exp(-2 * found.t), rtol=1e-8)


def test_functions_are_inserted_with_their_own_arguments(tmp_path):
    got = simulated(
        tmp_path, Parameters=[parameter("x", 5), parameter("y", constant="false"), parameter("z", constant="false")],
        FunctionDefinitions=[
            function("f", ["x", "y"], "x - 2*y"), function("g", ["y"], "f(y, x2(y))"), function("x2", ["u"], "u^2"),
            function("c", [], "4"),
        ],
        Rules=[rule("assignment", "y", "g(x)"), rule("assignment", "z", "c()")],
    )  # fmt: skip
    assert got["y"][0] == 5 - 2 * 25
    assert got["z"][0] == 4


VALUES = {  # of formulas in x = 0.6 and n = 7
    "sin(x) + cos(x) + tan(x)": np.sin(0.6) + np.cos(0.6) + np.tan(0.6),
    "sec(x) + csc(x) + cot(x)": 1 / np.cos(0.6) + 1 / np.sin(0.6) + 1 / np.tan(0.6),
    "sinh(x)*cosh(x)*tanh(x)": np.sinh(0.6) ** 2,
    "sech(x) + csch(x) + coth(x)": 1 / np.cosh(0.6) + 1 / np.sinh(0.6) + 1 / np.tanh(0.6),
    "arcsin(x) + arccos(x)": np.pi / 2,
    "arctan(x) + arccot(x)": np.pi / 2,
    "arcsec(1/x) - arccos(x)": 0.0,
    "arccsc(1/x) - arcsin(x)": 0.0,
    "arcsinh(x) + arccosh(n) + arctanh(x)": np.arcsinh(0.6) + np.arccosh(7) + np.arctanh(0.6),
    "arcsech(x) + arccsch(x) + arccoth(n)": np.arccosh(1 / 0.6) + np.arcsinh(1 / 0.6) + np.arctanh(1 / 7),
    "exp(x) + ln(x) + log10(x) + log(3, x)": np.exp(0.6) + np.log(0.6) + np.log10(0.6) + np.log(0.6) / np.log(3),
    "sqrt(x) + root(3, n) + n^x + pow(x, 2)": 0.6**0.5 + 7 ** (1 / 3) + 7**0.6 + 0.36,
    "floor(-x) + 10*ceil(x) + 100*abs(-x)": -1 + 10 + 60,
    "factorial(n)": 5040,
    "max(x, n, 3) + 10*min(x, n, -2)": 7 - 20,
    "quotient(-n, 2) + 10*quotient(n, 2)": -3 + 30,
    "rem(-n, 4) + 10*rem(n, -4)": -3 + 30,
    "piecewise(1, x > 1, 2, n == 7, 3)": 2,
    "piecewise(1, x > 1)": math.nan,
    "piecewise(1, implies(x > 1, n < 0), 0)": 1,
    "piecewise(1, xor(true, true, true), 0) + piecewise(2, xor(true, x < 1), 0)": 1,
    "piecewise(1, x < 1 && n >= 7 || false, 0)": 1,
    "piecewise(1, !(n != 7), 0)": 1,
    "piecewise(1, n, 0) + piecewise(10, x - 0.6, 0)": 1,
    "(x < n) + 2": 3,
    "pi + exponentiale": np.pi + np.e,
    "avogadro/1e23": 6.02214179,
    "1/0": math.inf,
    "INF + n": math.inf,
    "NaN": math.nan,
    "0^0": 1,
    "<apply><lt/><cn>1</cn><cn>2</cn><cn>2</cn></apply>": 0,
    "<apply><plus/></apply>": 0,
    "<apply><times/><cn type='rational'>1<sep/>4</cn><cn type='e-notation'>1.2<sep/>3</cn></apply>": 300,
    "<cn xmlns:s='http://www.sbml.org/sbml/level3/version2/core' s:units='mole'> 2.5 </cn>": 2.5,
}


def test_every_function_of_mathml(tmp_path):
    names = {f"v{k}": formula for k, formula in enumerate(VALUES)}
    got = simulated(
        tmp_path, Parameters=[parameter("x", 0.6), parameter("n", 7), *(parameter(v, constant="false") for v in names)],
        Rules=[rule("assignment", name, formula) for name, formula in names.items()],
    )  # fmt: skip
    for (name, formula), value in zip(names.items(), VALUES.values(), strict=True):
        np.testing.assert_allclose(got[name][0], value, rtol=1e-14, atol=1e-14, err_msg=formula)


def test_identifiers_may_be_words_of_the_grammar(tmp_path):
    names = ["t", "pi", "e", "sin", "if", "not", "period", "stable", "parameters", "lambda", "time", "True", "y"]
    got = simulated(
        tmp_path, Parameters=[*(parameter(n, k + 2) for k, n in enumerate(names)), parameter("x", 0, "false")],
        Rules=[rule("rate", "x", "<apply><plus/>" + "".join(f"<ci>{n}</ci>" for n in names) + "</apply>")],
    )  # fmt: skip
    for k, name in enumerate(names):
        assert (got[name] == k + 2).all(), name
    total = sum(range(2, 2 + len(names)))
    np.testing.assert_allclose(got["x"][-1], 2.0 * total, rtol=1e-9)


def test_values_that_are_no_numbers(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment()], Species=[species("A"), species("B", amount=1)],
        Parameters=[parameter("p", "INF"), parameter("q", "-INF"), parameter("r", "NaN"), parameter("s")],
        Reactions=[reaction("R", [], ["A"], "1"), reaction("Q", ["B"], [], "B")],
    )  # fmt: skip
    assert (got["p"] == np.inf).all()
    assert (got["q"] == -np.inf).all()
    assert np.isnan([got["r"], got["s"], got["A"]]).all()
    np.testing.assert_allclose(got["B"], np.exp(-got["t"]), rtol=1e-8)
