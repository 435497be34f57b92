"""Labels belong to the system, not to its notation: units, order and names of states, time, settings do not matter."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.problems.cases import ALL, Case
from tests.problems.follow import follow, labels

TANK = Case(
    {"x": "-x + p*(1 - x)*exp(y)", "y": "-y + 14*p*(1 - x)*exp(y) - 2*y"},
    {"x": 0.010387656, "y": 0.048475726}, {"p": 0.01}, (0.005, 0.5), [],
)  # fmt: skip
# x' = y - x^3 + 3x^2 + p - z: three time scales (Hindmarsh and Rose 1984), a = 1, b = 3, c = 1, d = 5, s = 4, x1 = -1.6
BURSTER = Case(
    {"x": "y - x^3 + 3*x^2 + p - z", "y": "1 - 5*x^2 - y", "z": "0.006*(4*(x + 1.6) - z)"},
    {"x": -1.6, "y": -11.8, "z": 0.0}, {"p": 0.0}, (-1.0, 30.0), [],
)  # fmt: skip
# cell cycle oscillator (Tyson 1991, reduced): u' = k4 (v - u)(a + u^2) - k6 u, v' = k - k6 u with k = p
CYCLE = Case(
    {"u": "180*(v - u)*(0.0001 + u^2) - p*u", "v": "0.015 - p*u"}, {"u": 0.03, "v": 0.05}, {"p": 0.5}, (0.2, 4.0), [],
)  # fmt: skip
SYSTEMS = {"tank": TANK, "burster": BURSTER, "cycle": CYCLE}
EXPECTED_TYPES = {"tank": {"LP", "HB"}, "burster": {"HB"}, "cycle": {"HB"}}


def in_other_words(case: Case, factors: list[float], order: list[int]) -> Case:
    """The same system with states in other units, in another order, under other names."""
    names = list(case.states)
    new = {name: f"s{k}" for k, name in enumerate(names)}

    def rewritten(text: str) -> str:
        for name, factor in zip(names, factors, strict=True):
            text = re.sub(rf"\b{name}\b", f"({new[name]}/{factor!r})", text)
        return text

    equations = {new[n]: f"({rewritten(case.equations[n])})*{f!r}" for n, f in zip(names, factors, strict=True)}
    states = {new[n]: case.states[n] * f for n, f in zip(names, factors, strict=True)}
    chosen = [new[names[k]] for k in order]
    return Case(
        {n: equations[n] for n in chosen}, {n: states[n] for n in chosen}, case.parameters, case.range, case.expected
    )


def assert_same(found, wanted, rtol=1e-8):
    assert [t for t, _ in sorted(found)] == [t for t, _ in sorted(wanted)]
    assert [v for _, v in sorted(found)] == pytest.approx([v for _, v in sorted(wanted)], rel=rtol)


def assert_near(branch, expected):
    """The labels of a closed form, to their own error estimates (and no worse than 1e-8)."""
    found = sorted((p.type, p.values["p"], p.error) for p in branch.points)
    wanted = sorted(expected)
    assert [t for t, *_ in found] == [t for t, _ in wanted], branch.notes
    for (_, value, error), (_, exact) in zip(found, wanted, strict=True):
        assert abs(value - exact) <= error + 1e-14
        assert error < 1e-8


@pytest.fixture(scope="module")
def reference():
    found = {name: labels(case.follow()) for name, case in SYSTEMS.items()}
    assert {name: {t for t, _ in points} for name, points in found.items()} == EXPECTED_TYPES
    return found


@pytest.mark.parametrize("name", SYSTEMS)
@settings(max_examples=6)
@given(data=st.data())
def test_units_order_and_names_of_states_change_no_label(name, reference, data):
    case = SYSTEMS[name]
    n = len(case.states)
    powers = data.draw(st.lists(st.integers(-6, 6), min_size=n, max_size=n))
    order = data.draw(st.permutations(range(n)))
    branch = in_other_words(case, [10.0**k for k in powers], order).follow()
    assert_same(labels(branch), reference[name])
    assert branch.notes == ()


@pytest.mark.parametrize("name", SYSTEMS)
@settings(max_examples=10)
@given(
    longest=st.floats(-2.3, 2.0), tolerance=st.floats(-12.0, -2.0), step=st.floats(1e-4, 0.1),
    max_angle=st.floats(3.0, 60.0),
)  # fmt: skip
def test_settings_change_no_label(name, reference, longest, tolerance, step, max_angle):
    """Two of the burster's Hopf points lie 0.025 apart in the metric: steps of 0.08 still tell them apart."""
    max_step = min(10.0**longest, 0.08 if name == "burster" else 100.0)
    chosen = {"max_step": max_step, "tolerance": 10.0**tolerance, "step": step, "max_angle": max_angle}
    assert_same(labels(SYSTEMS[name].follow(settings=chosen)), reference[name])


@pytest.mark.parametrize("name", SYSTEMS)
def test_unit_of_time_changes_no_label(name, reference):
    case = SYSTEMS[name]
    for factor in (1e-6, 1e6):
        slow = {n: f"({text})*{factor!r}" for n, text in case.equations.items()}
        assert_same(labels(follow(slow, case.states, case.parameters, case.range)), reference[name])


@pytest.mark.parametrize("name", SYSTEMS)
def test_labels_are_the_same_from_the_other_end_of_the_branch(name, reference):
    case = SYSTEMS[name]
    branch = case.follow()
    last = branch.z[0]
    states = dict(zip(case.states, last[:-1], strict=True))
    back = follow(case.equations, states, {"p": last[-1]}, case.range)
    assert_same(labels(back), reference[name])


CLOSED_FORMS = [
    name
    for name, case in ALL.items()
    if all(isinstance(v, float) for v in case.states.values()) and not name.startswith("slow and fast")  # 1e18 in all
]


@pytest.mark.parametrize("name", [n for n in CLOSED_FORMS if len(ALL[n].states) < 5])
def test_closed_forms_hold_in_units_a_million_apart(name):
    case = ALL[name]
    rng = np.random.default_rng(len(name))
    n = len(case.states)
    factors = [float(f) for f in 10.0 ** rng.choice([-6.0, -3.0, 0.0, 3.0, 6.0], n)]
    branch = in_other_words(case, factors, list(rng.permutation(n))).follow()
    assert_near(branch, case.expected)


@pytest.mark.parametrize("max_step", [0.03, 1.0])
@pytest.mark.parametrize("name", [n for n in ALL if len(ALL[n].states) < 5])
def test_closed_forms_hold_for_short_and_long_steps(name, max_step):
    case = ALL[name]
    branch = case.follow(settings={"max_step": max_step})
    assert_near(branch, case.expected)
