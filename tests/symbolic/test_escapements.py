"""Escapements by name."""

import pytest

import contin
from contin.errors import InputError
from contin.symbolic.passes.escapements import OWN
from contin.symbolic.passes.metronomes import metronomes


@pytest.mark.parametrize("name", OWN)
def test_a_named_escapement_is_its_formula_with_its_parameters(name):
    own = OWN[name]
    named, written = metronomes(2, escapement=name), metronomes(2, escapement=own.formula, parameters=own.parameters)
    assert named.equations == written.equations
    assert contin.average(named).equations == contin.average(written).equations


def test_a_name_that_is_none_is_said():
    with pytest.raises(InputError, match="no escapement 'cubik': did you mean"):
        metronomes(2, escapement="cubik")
