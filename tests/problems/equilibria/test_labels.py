"""Exact sets of labels: nothing missed, nothing invented, whatever the settings, units and order of the states."""

import numpy as np
import pytest

from contin.problems.equilibria import defining
from tests.problems.cases import ALL
from tests.problems.follow import assert_labels, reasons


@pytest.mark.parametrize("name", ALL)
def test_labels_are_exactly_those_of_the_closed_form(name):
    case = ALL[name]
    branch = case.follow()
    assert_labels(branch, case.expected)
    assert reasons(branch) == case.ends
    for point in branch.points:
        p = point.values[branch.parameters[0]]
        kernel = next((k for at, k in case.kernels.items() if abs(at - p) < 1e-9), 1)
        also = next((a for at, a in case.also.items() if abs(at - p) < 1e-9), ())
        assert point.vectors.get("kernel", 1) == kernel
        assert point.also == also


def test_equations_without_a_value_have_no_special_point():
    """Newton's method on a defining system ends, without an error, where the equations are not finite."""
    assert np.isnan(defining.singular_basis(np.full((2, 3), np.nan), 1)[1]).all()
    assert defining.singular_basis(np.full((2, 3), np.nan), 1)[1].shape == (3, 2)
