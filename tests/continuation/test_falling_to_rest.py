"""Branches on which all states fall to zero together, where the equations have no derivative: they end, in words."""

import numpy as np
import pytest

import contin


def coupled(form: str) -> contin.Model:
    """Two van der Pol oscillators, detuned by d, coupled by k (y2 - y1)."""
    pair = contin.Model(
        "pair", states={"x1": 2, "y1": 0, "x2": 2, "y2": 0}, parameters={"eps": 0.01, "k": 0.5, "d": 0.3},
        equations={
            "x1": "y1", "y1": "-x1 + eps*((1 - x1^2)*y1 + d*x1 + k*(y2 - y1))",
            "x2": "y2", "y2": "-x2 + eps*((1 - x2^2)*y2 - d*x2 + k*(y1 - y2))",
        },
        averaging={"small": "eps", "oscillators": [{"position": f"x{i}", "velocity": f"y{i}"} for i in (1, 2)]},
    )  # fmt: skip
    return contin.average(pair, form=form)


def test_locked_oscillators_come_to_rest_in_the_stokes_form():
    """The locked states have r^2 = 4 (1 - k -+ sqrt(k^2 - d^2)): those of the lower sign rest at k = (1 + d^2)/2."""
    start = contin.equilibrium(coupled("stokes"), {"S1": 0, "S2": 8, "S3": -1})
    branch = contin.continuation(start, "k", (0.01, 2.0))
    ends = [end for end in branch.ends if "zero together" in end.text]
    assert [end.reason for end in branch.ends].count("bound") == 2
    assert len(ends) == 1
    assert "cartesian" in ends[0].text
    last = 0 if ends[0] is branch.ends[0] else -1
    assert branch.columns["k"][last] == pytest.approx(0.545, abs=1e-5)
    assert not branch.unexplained
    assert not any("error inside" in note for note in branch.notes)
    k, size = branch.columns["k"], branch.columns["r1"] ** 2
    wanted = 4.0 * (1.0 - k + np.cos(branch.columns["psi"]) * k)
    np.testing.assert_allclose(size, wanted, atol=1e-6)


def test_ratio_dependent_predator_and_prey_die_out_together():
    """x' = x (1 - x) - a x y/(x + y), y' = y (b x/(x + y) - c): x = 1 - a (1 - c/b), y = x (b/c - 1), until x = 0."""
    model = contin.Model(
        "ratio", states={"x": 0.5, "y": 0.5}, parameters={"a": 1.0, "b": 1.0, "c": 0.5},
        equations={"x": "x*(1 - x) - a*x*y/(x + y)", "y": "y*(b*x/(x + y) - c)"},
    )  # fmt: skip
    branch = contin.continuation(contin.equilibrium(model), "a", (0.5, 4.0))
    assert [end.reason for end in branch.ends] == ["bound", "bound"]
    assert "x, y fell to zero together" in branch.ends[1].text
    assert "at a = 2," in branch.ends[1].text
    assert 1.8 < branch.columns["a"][-1] < 2.0
    assert not branch.unexplained
    assert np.all(branch.columns["x"] > 0.0)
    np.testing.assert_allclose(branch.columns["x"], 1.0 - branch.columns["a"] / 2.0, atol=1e-9)
