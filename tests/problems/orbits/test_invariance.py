"""Families of orbits do not depend on units, the order of states, the sense of the parameter or the unit of time."""

from dataclasses import dataclass

import numpy as np
import pytest

from contin import api
from contin.model.model import Model


@dataclass(frozen=True)
class Case:
    """Equations in the states' names, and the run: from the first Hopf point of the line."""

    states: dict
    equations: dict
    parameter: str
    value: float
    bounds: tuple
    constants: dict


LURE = Case({"x": 0, "y": 0, "z": 0}, {"x": "y", "y": "z", "z": "-al*z - y - x + x^2"}, "al", 1.5, (0.5, 1.5), {})
NERVE = Case(
    {"v": -1.2, "w": -0.6}, {"v": "v - v^3/3 - w + I", "w": "eps*(v + 0.7 - 0.8*w)"}, "I", 0.0, (-0.5, 2.0),
    {"eps": 0.08},
)  # fmt: skip
ENZYME = Case(
    {"s": 45.56, "a": 177.8},
    {"s": "110 - s - rho*s*a/(1 + s + s^2/10)", "a": "(500 - a)/5 - rho*s*a/(1 + s + s^2/10)"}, "rho", 2.0, (0.5, 20.0),
    {},
)  # fmt: skip
LORENZ = Case(
    {"x": 6.0, "y": 6.0, "z": 14.0}, {"x": "10*(y - x)", "y": "rho*x - y - x*z", "z": "x*y - 8/3*z"}, "rho", 15.0,
    (10.0, 30.0), {},
)  # fmt: skip
CASES = pytest.mark.parametrize("case", [LURE, NERVE, ENZYME, LORENZ], ids=["lure", "nerve", "enzyme", "lorenz"])


def family(case, units=None, time=1.0, order=None, sign=1.0):
    """The family with state = unit * (state in the new units), new time = time * t, parameter = sign * new one."""
    units = units or dict.fromkeys(case.states, 1.0)
    order = order or list(case.states)
    old = {f"{name}_": f"{units[name]!r}*{name}" for name in case.states} | {f"{case.parameter}_": f"{sign}*q"}

    def renamed(text):
        for name in sorted([*case.states, case.parameter], key=len, reverse=True):
            text = " ".join(f"{name}_" if part == name else part for part in spaced(text))
        return text

    equations = {name: f"({renamed(case.equations[name])})/({units[name]!r}*{time!r})" for name in order}
    model = Model(
        "case", states={name: float(case.states[name]) / units[name] for name in order},
        parameters={"q": sign * case.value, **case.constants}, definitions=old, equations=equations,
    )  # fmt: skip
    bounds = tuple(sorted(sign * b for b in case.bounds))
    line = api.continuation(api.equilibrium(model), "q", bounds)
    hopf = sorted((p for p in line.points if p.type == "HB"), key=lambda p: sign * p.values["q"])[0]
    return api.continuation(hopf.switch(), "q", bounds)


def spaced(text):
    for sign in "()+-*/^,":
        text = text.replace(sign, f" {sign} ")
    return text.split()


def seen(branch, sign=1.0, time=1.0):
    """Types, parameters and periods of the labelled points, reason and place of the end."""
    ends = [(e.reason, e.data.get("at", {}).get("q")) for e in branch.ends if e.reason != "start"]
    points = [p for p in branch.points if p.type != "HOM"]
    types = [p.type for p in points]
    numbers = np.array([(sign * p.values["q"], p.values["period"] / time) for p in points]).reshape(-1, 2)
    return types, numbers, [reason for reason, _ in ends], [sign * at for _, at in ends if at is not None]


def assert_same(a, b):
    assert a[0] == b[0]
    np.testing.assert_allclose(a[1][:, 0], b[1][:, 0], rtol=2e-9)
    np.testing.assert_allclose(a[1][:, 1], b[1][:, 1], rtol=1e-6)  # hardly determined where the family is steep
    assert a[2] == b[2]
    np.testing.assert_allclose(a[3], b[3], rtol=1e-7)


@pytest.fixture(scope="module")
def plain():
    kept = {}

    def of(case):
        return kept.get(tuple(case.equations.values())) or kept.setdefault(
            tuple(case.equations.values()), seen(family(case))
        )

    return of


@CASES
def test_units_of_states_and_time(case, plain):
    generator = np.random.default_rng(5 + len(case.equations))
    units = {name: float(10.0 ** generator.uniform(-4, 4)) for name in case.states}
    time = float(10.0 ** generator.uniform(-3, 3))
    assert_same(seen(family(case, units, time), time=time), plain(case))


@CASES
def test_order_of_states_and_sense_of_the_parameter(case, plain):
    assert_same(seen(family(case, order=list(reversed(case.states)), sign=-1.0), sign=-1.0), plain(case))
