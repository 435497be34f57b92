"""What labels and families cost, in evaluations: the part that Python's time follows."""

from __future__ import annotations

from collections import Counter

import pytest

import contin
from contin.kernels import collocation_march
from contin.lowering.system import CompiledSystem
from contin.model.model import Model


@pytest.fixture(scope="module")
def brusselator():
    return Model(
        "brusselator", states={"x": 1, "y": 1.5}, parameters={"B": 1.5, "A": 1},
        equations={"x": "A - (B + 1)*x + x^2*y", "y": "B*x - x^2*y"},
    )  # fmt: skip


def counted(monkeypatch: pytest.MonkeyPatch, *names: str) -> Counter[str]:
    """How often these methods of compiled systems are called from now on."""
    calls: Counter[str] = Counter()
    for name in names:
        method = getattr(CompiledSystem, name)

        def spy(self, *arguments, name=name, method=method):
            calls[name] += 1
            return method(self, *arguments)

        monkeypatch.setattr(CompiledSystem, name, spy)
    return calls


def test_a_label_takes_few_calls_of_the_equations(brusselator, monkeypatch):
    start = contin.equilibrium(brusselator)
    plain = counted(monkeypatch, "jacobian", "jacobians", "derivative", "derivatives", "gradient")
    contin.continuation(start, "B", (1.5, 1.9), direction="up")
    without = plain.copy()
    plain.clear()
    line = contin.continuation(start, "B", (1.5, 2.4), direction="up")
    assert [point.label for point in line.points] == ["HB1"]
    label = plain - without
    assert label.total() <= 36, label  # measured: 26


def test_multipliers_of_a_dissipative_family_are_not_computed_again_for_notes(brusselator, monkeypatch):
    born = contin.continuation(contin.equilibrium(brusselator), "B", (1.5, 3))["HB1"]
    modes: Counter[int] = Counter()
    follow = collocation_march.follow

    def spy(*arguments):
        modes[arguments[0]] += 1
        return follow(*arguments)

    monkeypatch.setattr(collocation_march, "follow", spy)
    family = contin.continuation(born.switch(), "B", (1.5, 3), settings={"steps": 20, "intervals": 20})
    assert len(family.z) > 10
    assert modes[collocation_march.MARCH] > 0
    assert modes[collocation_march.STABILITY] == 0
