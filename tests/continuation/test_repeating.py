"""Families that turn round for ever, each time with a longer period."""

from types import SimpleNamespace

import numpy as np
import pytest

from contin import api
from contin.continuation.ends.repeating import until_repeating
from contin.model.model import Model


def snake(limits, ratio, gain, count):
    """(parameter, period) of folds that approach two limits in turn, geometrically."""
    return [(limits[k % 2] + (-1) ** k * 0.2 * ratio ** (k // 2), 20.0 + 0.5 * gain * k) for k in range(count)]


def followed(folds):
    """Rows up to which a family with these folds is followed, one fold a segment, and its end."""
    arm = SimpleNamespace(
        end=None, problem=SimpleNamespace(kind="orbit", parameters=("p",), columns=lambda z: {"period": z[:, 0]})
    )
    arm.is_over = lambda: arm.end is not None
    marks = [SimpleNamespace(point=SimpleNamespace(type="LPC", z=np.array([period, p]))) for p, period in folds]
    return len(list(until_repeating([SimpleNamespace(found=(mark,)) for mark in marks], arm))), arm.end


def test_limits_and_gain_of_a_geometric_sequence_are_foretold_exactly():
    count, end = followed(snake((3.0, 2.0), 0.27, 14.0, 30))
    assert count == 8
    assert end.reason == "homoclinic"
    assert end.data["between"] == pytest.approx([2.0, 3.0], abs=1e-12)
    assert end.data["cycle"]["period"] == pytest.approx(14.0)


@pytest.mark.parametrize(
    "folds",
    [
        snake((2.0, 2.0), 0.27, 14.0, 30),  # to one value: beside a saddle-focus, which has an end of its own
        snake((3.0, 2.0), 0.9, 14.0, 30),  # hardly converging
        [(p, 20.0 + 3.0 * 1.3**k) for k, (p, _) in enumerate(snake((3.0, 2.0), 0.27, 14.0, 30))],  # growing gains
        snake((3.0, 2.0), 0.27, 14.0, 7),
    ],
)
def test_other_sequences_of_folds_are_followed(folds):
    assert followed(folds) == (len(folds), None)


@pytest.mark.long
def test_spike_adding_of_the_hindmarsh_rose_equations_ends_between_two_tangencies():
    """The folds accumulate at I = 5.25863 and 5.28590."""
    model = Model(
        "neuron", states={"x": 1.2, "y": -6.0, "z": 5.0}, parameters={"I": 5.6},
        equations={"x": "y - x^3 + 3*x^2 - z + I", "y": "1 - 5*x^2 - y", "z": "0.01*(4*(x + 1.6) - z)"},
    )  # fmt: skip
    line = api.continuation(api.equilibrium(model), "I", (5.0, 6.0))
    family = api.continuation(line["HB1"].switch(), "I", (5.0, 6.0))
    assert family.ends[1].reason == "homoclinic"
    assert family.ends[1].data["between"] == pytest.approx([5.25863, 5.28590], abs=5e-5)
    assert sum(p.type == "LPC" for p in family.points) < 12
