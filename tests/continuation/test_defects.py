"""An error that nobody foresaw costs what was being computed, never what was computed before."""

import numpy as np
import pytest

import contin
from contin.continuation.defects import contained, noted
from contin.continuation.seed import Seed
from contin.errors import InputError, NoSolutionError, NotFiniteError
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from tests.problems.follow import labels, model

FOLD = model({"x": "p - x^2"}, {"x": 1.0}, {"p": 1.0})  # x^2 = p, a fold at p = 0
RANGE = (-0.5, 4.0)
NOT_A_NUMBER = np.full((2, 2), np.nan)


def singular_values(*_):
    return np.linalg.svd(NOT_A_NUMBER)


def test_an_arm_keeps_the_rows_before_the_chunk_that_fails(monkeypatch):
    march, calls = EquilibriumProblem.march, []

    def failing(self, *arguments):
        calls.append(1)
        return march(self, *arguments) if len(calls) < 3 else singular_values()

    monkeypatch.setattr(EquilibriumProblem, "march", failing)
    monkeypatch.setattr(EquilibriumProblem, "maximum_chunk", 20)
    branch = contin.continuation(FOLD, "p", RANGE, direction="up", settings={"max_step": 0.01})
    assert len(branch) == 41
    np.testing.assert_allclose(branch.columns["x"] ** 2, branch.columns["p"], rtol=1e-9)
    end = branch.ends[1]
    assert end.reason == "corrector"
    assert "an error inside contin at contin/continuation/arm.py:" in end.text  # not numpy's own line
    assert end.text.endswith("LinAlgError: SVD did not converge")
    assert end.text.startswith(f"after p = {branch.columns['p'][-1]:.10g}, ")
    assert end.text in branch.notes
    assert branch.defects == (end.text,)


def test_a_chunk_keeps_the_rows_before_the_step_in_which_it_fails(monkeypatch):
    whole = contin.continuation(FOLD, "p", RANGE, direction="down")
    monkeypatch.setattr(EquilibriumProblem, "explain", singular_values)
    branch = contin.continuation(FOLD, "p", RANGE, direction="down")
    assert 2 < len(branch) < len(whole)
    assert branch.points == ()
    assert "an error inside contin at contin/continuation/location/isolate.py:" in branch.ends[0].text
    np.testing.assert_array_less(0.0, branch.columns["x"])  # the step over the fold is left out


def test_an_error_in_a_verification_costs_the_label_alone(monkeypatch):
    whole = contin.continuation(FOLD, "p", RANGE, direction="down")
    assert [p.type for p in whole.points] == ["LP"]
    monkeypatch.setattr(EquilibriumProblem, "verify", singular_values)
    monkeypatch.setattr(EquilibriumProblem, "verify_compound", singular_values)
    branch = contin.continuation(FOLD, "p", RANGE, direction="down")
    assert branch.points == ()
    assert branch.ends[0].reason == whole.ends[0].reason == "bound"  # beyond the fold, back at p = 4
    place = "not verified: an error inside contin at contin/continuation/location/isolate.py:"
    assert any(place in note for note in branch.defects)
    assert set(branch.defects) <= set(branch.notes)
    assert whole.defects == ()


def test_what_contin_says_on_purpose_passes():
    told = []
    with pytest.raises(InputError, match="wrong"), contained(told.append):
        raise InputError("wrong")
    with pytest.raises(KeyboardInterrupt), noted(told.append):
        raise KeyboardInterrupt
    with pytest.raises(OSError, match="disk"), noted(told.append):
        raise OSError("disk")
    assert told == []
    with noted(told.append):
        raise NoSolutionError("none")
    assert told == ["none"]


def test_one_failing_start_leaves_the_branches_of_the_others(monkeypatch):
    """x' = p x - x^3: the pitchfork's own branch fails to set out, the trivial one is whole."""
    fork = model({"x": "p*x - x^3"}, {"x": 0.0}, {"p": -1.0})
    whole = contin.diagram(fork, "p", (-1.0, 1.0))
    assert len(whole.branches) == 2
    probe = EquilibriumProblem.probe

    def failing(self, base, length, guess, frame, settings):
        if np.abs(base.tangent[0]) > 0.9:  # along x
            raise FloatingPointError("overflow")
        return probe(self, base, length, guess, frame, settings)

    monkeypatch.setattr(EquilibriumProblem, "probe", failing)
    found = contin.diagram(fork, "p", (-1.0, 1.0))
    assert [b.name for b in found.branches] == [whole.branches[0].name]
    assert labels(found.branches[0]) == labels(whole.branches[0])
    assert any("start/BP1: an error inside contin at contin/" in note for note in found.notes)


def test_states_without_derivatives_start_no_branch_and_say_so():
    """x' = p x - x sqrt(x^2 + y^2), and so y: at rest the derivative of the size does not exist (0/0)."""
    rest = model(
        {"x": "p*x - x*sqrt(x^2 + y^2)", "y": "p*y - y*sqrt(x^2 + y^2)"}, {"x": 0.6, "y": 0.8}, {"p": 1.0}
    )
    problem = contin.equilibrium(rest).problem("p")
    with pytest.raises(NotFiniteError, match="no branch passes here"):
        contin.continuation(Seed(problem, np.array([0.0, 0.0, 1.0])), "p", RANGE)


def test_an_arm_that_leaves_the_domain_of_the_equations_keeps_its_rows(monkeypatch):
    march, calls = EquilibriumProblem.march, []

    def failing(self, *arguments):
        calls.append(1)
        if len(calls) == 3:
            raise NotFiniteError("the logarithm of a negative number")
        return march(self, *arguments)

    monkeypatch.setattr(EquilibriumProblem, "march", failing)
    monkeypatch.setattr(EquilibriumProblem, "maximum_chunk", 20)
    branch = contin.continuation(FOLD, "p", RANGE, direction="up", settings={"max_step": 0.01})
    assert len(branch) == 41
    assert branch.ends[1].text.endswith(", the logarithm of a negative number")
