"""SBML: what has no equal in contin is refused by name."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.exchange import registry
from contin.exchange.imported import UnsupportedError
from tests.exchange.sbml.writing import (
    compartment,
    event,
    mathml,
    model_text,
    parameter,
    reaction,
    read,
    rule,
    simulated,
    species,
)


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
