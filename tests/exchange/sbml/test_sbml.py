"""SBML models with solutions in closed form, feature by feature; what has no equal is refused by name.

MathML is written by libsbml from formulas, the models are written here.
"""

import math
from pathlib import Path

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.exchange import registry
from contin.exchange.imported import UnsupportedError
from contin.model.yaml_loader import load_model_text

libsbml = pytest.importorskip("libsbml")

HEADS = {
    1: '<sbml xmlns="http://www.sbml.org/sbml/level1" level="1" version="2">',
    2: '<sbml xmlns="http://www.sbml.org/sbml/level2/version5" level="2" version="5">',
    3: '<sbml xmlns="http://www.sbml.org/sbml/level3/version2/core" level="3" version="2">',
}
MATH = 'xmlns="http://www.w3.org/1998/Math/MathML"'


def mathml(formula: str) -> str:
    """The <math> element of a formula in libsbml's notation, or of MathML."""
    if formula.startswith("<"):
        return f"<math {MATH}>{formula}</math>"
    text = libsbml.writeMathMLToString(libsbml.parseL3Formula(formula))
    return text[text.index("<math") :]


def compartment(name="C", size=1.0, constant="true", dimensions=3) -> str:
    extent = "" if size is None else f'size="{size}"'
    return f'<compartment id="{name}" {extent} spatialDimensions="{dimensions}" constant="{constant}"/>'


def species(name, amount=None, concentration=None, hosu="false", boundary="false", constant="false", more="") -> str:
    given = f'initialAmount="{amount}"' if amount is not None else ""
    given += f' initialConcentration="{concentration}"' if concentration is not None else ""
    return (
        f'<species id="{name}" compartment="C" {given} hasOnlySubstanceUnits="{hosu}" boundaryCondition="{boundary}" '
        f'constant="{constant}" {more}/>'
    )


def parameter(name, value=None, constant="true") -> str:
    given = "" if value is None else f'value="{value}"'
    return f'<parameter id="{name}" {given} constant="{constant}"/>'


def rule(kind, variable, formula) -> str:
    return f'<{kind}Rule variable="{variable}">{mathml(formula)}</{kind}Rule>'


def assignment(symbol, formula) -> str:
    return f'<initialAssignment symbol="{symbol}">{mathml(formula)}</initialAssignment>'


def side(tag, references) -> str:
    inside = "".join(r if r.startswith("<") else reference(r) for r in references)
    return f"<listOf{tag}>{inside}</listOf{tag}>" if references else ""


def reference(name, stoichiometry=1, more='constant="true"') -> str:
    return f'<speciesReference species="{name}" stoichiometry="{stoichiometry}" {more}/>'


def reaction(name, left, right, formula, local="", more='reversible="false"') -> str:
    law = f"<kineticLaw>{mathml(formula)}{local}</kineticLaw>"
    return f'<reaction id="{name}" {more}>{side("Reactants", left)}{side("Products", right)}{law}</reaction>'


def function(name, arguments, formula) -> str:
    inside = mathml(f"lambda({', '.join([*arguments, formula])})")
    return f'<functionDefinition id="{name}">{inside}</functionDefinition>'


def event(name, trigger, sets, initial="true", more="") -> str:
    inside = "".join(f'<eventAssignment variable="{k}">{mathml(f)}</eventAssignment>' for k, f in sets.items())
    return (
        f'<event id="{name}" useValuesFromTriggerTime="true"><trigger initialValue="{initial}" persistent="true">'
        f"{mathml(trigger)}</trigger>{more}<listOfEventAssignments>{inside}</listOfEventAssignments></event>"
    )


def model_text(level=3, attributes="", **lists) -> str:
    order = ("FunctionDefinitions", "Compartments", "Species", "Parameters", "InitialAssignments", "Rules")
    order = (*order, "Constraints", "Reactions", "Events")
    inside = "".join(f"<listOf{k}>{''.join(lists[k])}</listOf{k}>" for k in order if lists.get(k))
    return f'<?xml version="1.0" encoding="UTF-8"?>{HEADS[level]}<model id="m" {attributes}>{inside}</model></sbml>'


def read(tmp_path: Path, **parts):
    file = tmp_path / "m.xml"
    file.write_text(model_text(**parts))
    model = registry.model_of(registry.read(file), file)
    again = load_model_text(model.text())  # the model file says the same
    assert again.equations == model.equations
    assert again.labels == model.labels
    return again


def simulated(tmp_path, time=2.0, samples=9, **parts):
    found = contin.simulate(read(tmp_path, **parts), time=time, samples=samples, rtol=1e-10)
    assert found.complete, found
    return {"t": found.t, **found.table}


def test_decay_in_a_compartment_of_size_4(tmp_path):
    k = '<listOfLocalParameters><localParameter id="k" value="3"/></listOfLocalParameters>'
    got = simulated(
        tmp_path, Compartments=[compartment(size=4)], Parameters=[parameter("k", 7)],
        Species=[species("A", amount=2), species("B", concentration=1)],
        Reactions=[reaction("R", ["A"], [reference("B", 2)], "k*A", k)],
    )  # fmt: skip
    a = 0.5 * np.exp(-0.75 * got["t"])  # dA/dt = -3 A/4
    np.testing.assert_allclose(got["A"], a, rtol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 4 * a, rtol=1e-8)
    np.testing.assert_allclose(got["B"], 1 + 2 * (0.5 - a), rtol=1e-8)
    np.testing.assert_allclose(got["concentration_B"], got["B"])
    np.testing.assert_allclose(got["R"], 3 * a, rtol=1e-8)
    assert (got["k"] == 7).all()
    assert (got["C"] == 4).all()


def test_events_reset_what_nothing_else_changes_and_compartments_keep_amounts(tmp_path):
    """p' = 1 falls by 2 wherever p > 1.5 and time > 1.7; k counts; C shrinks at 0.25, and the amount of A stays."""
    got = simulated(
        tmp_path, time=6.0, samples=61, Compartments=[compartment(size=4, constant="false")],
        Species=[species("A", concentration=3)],
        Parameters=[parameter("p", 0, "false"), parameter("k", 0, "false")], Rules=[rule("rate", "p", "1")],
        Events=[
            event("fall", "p > 1.5 && time > 1.7", {"p": "p - 2", "k": "k + 1"}),
            event("shrink", "!(time < 0.25)", {"C": "C/2"}),
        ],
    )  # fmt: skip
    falls = np.array([1.7, 3.5, 5.5])
    count = (got["t"][:, None] > falls + 1e-9).sum(axis=1)
    away = np.abs(got["t"][:, None] - falls).min(axis=1) > 1e-6
    np.testing.assert_array_equal(got["k"][away], count[away])
    np.testing.assert_allclose(got["p"][away], (got["t"] - 2 * count)[away], atol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 12.0)
    np.testing.assert_allclose(got["A"], np.where(got["t"] > 0.25, 6.0, 3.0))


def test_amounts_are_states_where_only_substance_units_count(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=4)],
        Species=[species("A", concentration=2, hosu="true"), species("B", amount=3, hosu="true", boundary="true")],
        Reactions=[reaction("R", ["A", "B"], [], "0.5*A")],
    )  # fmt: skip
    np.testing.assert_allclose(got["A"], 8 * np.exp(-0.5 * got["t"]), rtol=1e-8)
    np.testing.assert_allclose(got["concentration_A"], got["A"] / 4)
    assert (got["B"] == 3).all()


def test_concentrations_follow_a_compartment_that_grows(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=2, constant="false")],
        Species=[species("A", concentration=3), species("B", amount=1, boundary="true"), species("S", concentration=1)],
        Rules=[rule("rate", "C", "C"), rule("rate", "S", "0.5")],
        Reactions=[reaction("R", ["A"], [], "A*C")],
    )  # fmt: skip
    size = 2 * np.exp(got["t"])
    np.testing.assert_allclose(got["C"], size, rtol=1e-8)
    np.testing.assert_allclose(got["amount_A"], 6 * np.exp(-got["t"]), rtol=1e-8)  # d amount/dt = -A C = -amount
    np.testing.assert_allclose(got["A"], 6 * np.exp(-got["t"]) / size, rtol=1e-8)
    np.testing.assert_allclose(got["B"], 1 / size, rtol=1e-8)
    np.testing.assert_allclose(got["S"], 1 + 0.5 * got["t"], rtol=1e-8)  # the rule is one of the concentration
    np.testing.assert_allclose(got["amount_S"], got["S"] * size, rtol=1e-8)


def test_without_extent_a_species_is_an_amount(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=None, dimensions=0)], Species=[species("A", amount=2)],
        Reactions=[reaction("R", ["A"], [], "A")],
    )  # fmt: skip
    np.testing.assert_allclose(got["A"], 2 * np.exp(-got["t"]), rtol=1e-8)


def test_values_at_the_start_are_worked_out_in_the_order_of_their_needs(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment(size=9)],
        Parameters=[
            parameter("p", 1), parameter("q"), parameter("r", constant="false"), parameter("s", constant="false"),
            parameter("y", 0, "false"),
        ],
        Species=[species("A", amount=5), species("B", concentration=1)],
        InitialAssignments=[
            assignment("p", "q + 1"), assignment("q", "2*r"), assignment("C", "q/3"), assignment("B", "p + time"),
            assignment("y", "R"),
        ],
        Rules=[rule("assignment", "r", "s + time"), rule("assignment", "s", "3"), rule("rate", "y", "1")],
        Reactions=[reaction("R", [], ["A"], "6*p")],
    )  # fmt: skip
    t = got["t"]
    np.testing.assert_allclose(got["r"], 3 + t)
    assert got["q"][0] == 6
    assert got["p"][0] == 7
    assert got["C"][0] == 2
    assert got["B"][0] == 7
    np.testing.assert_allclose(got["A"], 5 / 2 + 42 * t / 2, rtol=1e-9)
    np.testing.assert_allclose(got["y"], 42 + t, rtol=1e-9)


def test_initial_values_in_a_circle_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"in a circle: (p -> q -> p|q -> p -> q)"):
        read(tmp_path, Parameters=[parameter("p"), parameter("q")],
             InitialAssignments=[assignment("p", "q"), assignment("q", "p")])  # fmt: skip


def test_conversion_factors_scale_what_reactions_do(tmp_path):
    got = simulated(
        tmp_path, attributes='conversionFactor="f"', Compartments=[compartment(size=2)],
        Parameters=[parameter("f", 3), parameter("g", 5)],
        Species=[species("A", amount=1), species("B", amount=1, more='conversionFactor="g"')],
        Reactions=[reaction("R", [], ["A", "B"], "1")],
    )  # fmt: skip
    np.testing.assert_allclose(got["amount_A"], 1 + 3 * got["t"], rtol=1e-9)
    np.testing.assert_allclose(got["amount_B"], 1 + 5 * got["t"], rtol=1e-9)


def test_stoichiometries_are_symbols_of_level_3(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment()], Parameters=[parameter("k", 2)],
        Species=[species("A", amount=1), species("B", amount=0), species("D", amount=0)],
        InitialAssignments=[assignment("n", "3*k")],
        Rules=[rule("assignment", "o", "time"), rule("rate", "p", "n")],
        Reactions=[reaction("R", [], [
            reference("A", 1, 'id="n" constant="true"'), reference("B", 1, 'id="o" constant="false"'),
            reference("D", 4, 'id="p" constant="false"')], "k")],
    )  # fmt: skip
    t = got["t"]
    np.testing.assert_allclose(got["A"], 1 + 12 * t, rtol=1e-9)
    np.testing.assert_allclose(got["B"], t**2, atol=1e-9)
    np.testing.assert_allclose(got["D"], 2 * (4 * t + 3 * t**2), atol=1e-9)
    assert (got["n"] == 6).all()
    np.testing.assert_allclose(got["p"], 4 + 6 * t, rtol=1e-9)


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


def test_missing_mathematics_has_no_effect(tmp_path):
    got = simulated(
        tmp_path, Compartments=[compartment()], Species=[species("A", amount=2)], Parameters=[parameter("p", 3)],
        InitialAssignments=['<initialAssignment symbol="p"/>'], Rules=['<rateRule variable="p"/>'],
        Reactions=['<reaction id="R" reversible="false"><listOfReactants><speciesReference species="A" '
                   'stoichiometry="1" constant="true"/></listOfReactants><kineticLaw/></reaction>'],
    )  # fmt: skip
    assert (got["A"] == 2).all()
    assert (got["p"] == 3).all()


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"Events": [event("boom", "time > 1", {"q": "1"}, more=f"<delay>{mathml('1')}</delay>")]},
         "a <delay> of <event> 'boom'"),
        ({"Events": [event("boom", "time > 1", {"q": "1"}, more=f"<priority>{mathml('1')}</priority>")]},
         "a <priority> of <event> 'boom'"),
        ({"Events": [event("boom", "q == 1", {"q": "1"})]}, "only <, <=, >, >=, and, or, not"),
        ({"Events": [event("boom", "time >= 0", {"q": "1"}, initial="false")]}, "happens at time 0"),
        ({"Rules": [f'<algebraicRule>{mathml("p - 1")}</algebraicRule>']}, "<algebraicRule> is not supported"),
        ({"Rules": [rule("rate", "p", "delay(p, 1)")]}, "rule of p: <csymbol> delay is not supported"),
        ({"Rules": [rule("rate", "p", "rateOf(q)")]}, "rule of p: <csymbol> rateOf is not supported"),
    ],
)  # fmt: skip
def test_what_has_no_equal_is_named(tmp_path, parts, message):
    with pytest.raises(UnsupportedError, match=message):
        read(tmp_path, Parameters=[parameter("p", 1, "false"), parameter("q", 1, "false")], **parts)


def test_packages_are_named(tmp_path):
    file = tmp_path / "m.xml"
    space = 'xmlns:comp="http://www.sbml.org/sbml/level3/version1/comp/version1" comp:required="true"'
    file.write_text(model_text().replace("<sbml ", f"<sbml {space} "))
    assert registry.read(file).notes == ("the package comp is not read",)  # nothing of it is used
    submodel = '<comp:listOfSubmodels><comp:submodel comp:id="s" comp:modelRef="m2"/></comp:listOfSubmodels>'
    file.write_text(file.read_text().replace("</model>", f"{submodel}</model>"))
    with pytest.raises(UnsupportedError, match="the package comp of SBML is not supported"):
        registry.read(file)


def test_what_is_no_sbml_is_said(tmp_path):
    file = tmp_path / "m.xml"
    file.write_text("<sbml><model></sbml>")
    with pytest.raises(InputError, match="not a valid SBML file: line"):
        registry.read(file)


def test_an_imported_model_is_continued(tmp_path):
    """The Schloegl model as a network: x' = 3 x^2 - x^3 - 2 x + b has folds at b = -+2/(3 sqrt 3)."""
    model = read(
        tmp_path, Compartments=[compartment()], Species=[species("x", amount=0.5)], Parameters=[parameter("b", 0)],
        Reactions=[reaction("in", [], ["x"], "b + 3*x^2"), reaction("out", ["x"], [], "x^3 + 2*x")],
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "b", (-1, 1))
    folds = sorted(p.values["b"] for p in line.points if p.type == "LP")
    np.testing.assert_allclose(folds, [-2 / 3**1.5, 2 / 3**1.5], atol=1e-9)
