"""Antimony text, through SBML."""

import numpy as np
import pytest

import contin
from contin.errors import InputError
from contin.exchange import registry

pytest.importorskip("antimony")


def test_a_chain_of_decays(tmp_path):
    file = tmp_path / "chain.ant"
    file.write_text("model chain\n A -> B; 2*A\n B -> ; B\n A = 3; B = 0\n double := 2*B\nend\n")
    found = registry.read(file)
    assert found.model["name"] == "chain"
    got = contin.simulate(registry.model_of(found, file), time=2.0, samples=5, rtol=1e-10)
    exact = 6 * (np.exp(-got.t) - np.exp(-2 * got.t))
    np.testing.assert_allclose(got.columns["B"], exact, atol=1e-9)
    np.testing.assert_allclose(got.columns["double"], 2 * exact, atol=1e-9)


def test_mistakes_and_imports_are_named(tmp_path):
    file = tmp_path / "bad.ant"
    file.write_text("A -> ; k*\n")
    with pytest.raises(InputError, match=r"bad\.ant: "):
        registry.read(file)
    file.write_text('import "other.ant"\n')
    with pytest.raises(InputError, match="`import` of other files"):
        registry.read(file)
