"""Curves of folds of canards, whose critical multiplier is lost in rounding while others vanish."""

import numpy as np
import pytest

import contin
from contin.kernels.special_orbits.memory import LPC, PD
from contin.kernels.special_orbits.tests import special_tests
from contin.problems.orbits.linearised.multipliers import without, without_critical


@pytest.mark.parametrize("lost", [0.3, 2.000001, 14.9, 1e8])
@pytest.mark.parametrize(("kind", "critical"), [(LPC, 1.0), (PD, -1.0)])
def test_a_multiplier_that_vanishes_is_not_the_critical_one(lost, kind, critical):
    """Of (2, 1e-28) for (1, 1e-28) the other was 1e-28 + 2 - 1: an R1 at every 2, and one unstable beyond."""
    values = np.array([lost * critical, 1e-28], complex)
    assert without_critical(values, critical).tolist() == [1e-28]
    assert without(values, (critical,)).tolist() == [1e-28]
    tests = np.empty(6)
    others = np.empty(2), np.empty(2)
    unstable = special_tests(
        kind, values.real.copy(), values.imag.copy(), 0.0, 1.0, *others, np.empty(4), tests
    )  # fmt: skip
    assert (unstable, others[0][0]) == (0, 1e-28)


@pytest.mark.parametrize("apart", [1e-3, -1e-2, 0.1])
def test_beside_the_critical_one_their_sum_tells_the_other(apart):
    """Two that meet are off by rounding over their distance, in opposite senses."""
    values = np.array([1.0 + 1e-5, 1.0 + apart - 1e-5], complex)
    assert without_critical(values, 1.0)[0] == pytest.approx(1.0 + apart, abs=1e-15)


def test_folds_of_canards_of_a_bursting_neuron():
    """Hindmarsh and Rose's equations at r = 0.05: two R1 with errors of 0.3 and 1,000 rows of creeping, 63 s."""
    model = contin.Model(
        "bursts", states={"x": -1.3, "y": -7, "z": 0}, parameters={"I": 0, "b": 3},
        equations={"x": "y - x^3 + b*x^2 - z + I", "y": "1 - 5*x^2 - y", "z": "0.05*(4*(x + 1.6) - z)"},
    )  # fmt: skip
    line = contin.continuation(contin.equilibrium(model), "I", (-4, 4))
    cycles = contin.continuation(line["HB1"].switch(), "I", (-4, 4))
    folds = contin.continuation(
        cycles["LPC1"].locus(), ("I", "b"), {"I": (-4, 4), "b": (1.3, 4)}, settings={"steps": 200}
    )
    assert [point.type for point in folds.points] == []
    assert [end.reason for end in folds.ends] == ["bound", "hopf"]
    assert np.all(folds.columns["unstable"] == 0)
    (note,) = folds.notes  # the column of multipliers has 2 or 1e8 for 1, which it did not say
    assert note.startswith("multipliers are not accurate: one that is known comes out as ")
    assert len(folds) < 120
