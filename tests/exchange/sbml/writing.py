"""SBML documents written part by part, and what contin reads of them; MathML is written by libsbml from formulas."""

from pathlib import Path

import pytest

import contin
from contin.exchange import registry
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
