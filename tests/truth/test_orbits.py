"""Orbits with planted bifurcations in 2 to 40 states: every label, coefficient and point of codimension two."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

import contin
from tests.truth.ledger import Expected, Ledger
from tests.truth.planted_orbits import CURVES, SIMPLE, WAYS, Hidden, Planted

EVERY_N = (2, 3, 4, 5, 6, 7, 8, 12, 40)


def coefficient_complaint(hidden: Hidden):
    """What is wrong with the normal form of the planted point, '' where nothing is."""

    def complaint(point) -> str:
        form = point.normal_form
        for key, word in hidden.core.words.items():
            if form.get(key) != word:
                return f"{key} is {form.get(key)!r}, not {word!r}"
        if hidden.core.coefficient is None:
            return ""
        name, exact = hidden.core.coefficient[0], hidden.core.coefficient[1](hidden)
        value = form[name][0] if name == "d" else form[name]
        if name == "b":
            value, exact = abs(value), abs(exact)  # signs of b depend on that of the eigenfunction
        off, stated = abs(value - exact), form["errors"][name]
        return "" if off <= stated else f"{name} = {value!r}, not {exact!r}: off by {off:.1e}, stated {stated:.1e}"

    return complaint


def judge_family(ledger: Ledger, hidden: Hidden) -> None:
    core = hidden.core
    expected = [Expected(core.type, core.at, coefficient_complaint(hidden))]
    expected += [Expected(type_, at) for type_, at in core.others]
    try:
        family = hidden.family()
    except contin.ContinError as error:
        ledger.failed(core.name, str(hidden), error)
        return
    ledger.judge(core.name, str(hidden), family, expected, "p", core.range[1] - core.range[0])
    if core.curve is None:
        return
    label, at = core.curve
    low, high = core.box["q"]
    try:
        curve = hidden.curve(family)
    except (contin.ContinError, StopIteration) as error:
        ledger.failed(f"{core.name} on {core.type}", str(hidden), error)
        return
    ledger.judge(f"{core.name} on {core.type}", str(hidden), curve, [Expected(label, at)], "q", high - low)


def judged(systems: Iterable[Hidden]) -> Ledger:
    ledger = Ledger()
    for hidden in systems:
        judge_family(ledger, hidden)
    return ledger


@pytest.mark.parametrize("core", SIMPLE, ids=lambda core: core.name)
def test_coefficients_do_not_depend_on_the_number_of_states_or_coordinates(core):
    few = len(core.equations)
    cases = [(few, "plain"), (max(few, 5), "bent")]  # the long version takes all
    judged(Hidden(core, n, way, n, 1.3, 0.7) for n, way in cases).assert_clean()


@pytest.mark.parametrize("core", CURVES, ids=lambda core: core.name)
@pytest.mark.seldom
def test_points_of_codimension_two_are_found_beside_further_states(core):
    few = len(core.equations)
    judged([Hidden(core, max(few, 5), "rotated", 7)]).assert_clean()


def test_a_planted_fold_of_cycles_is_at_its_place_on_a_fine_mesh():
    """r' = r (p + (r^2 - 1)^2): the fold at p = 0 was 3.5e-13 off on 100 intervals, twice as far as on 50."""
    model = contin.Model(
        "fold", states={"x": 2**0.5, "y": 0}, parameters={"p": -1.0},
        equations={"x": "x*(p + (x^2 + y^2 - 1)^2) - 2.3*y", "y": "y*(p + (x^2 + y^2 - 1)^2) + 2.3*x"},
    )  # fmt: skip
    t = np.linspace(0.0, 2.0 * np.pi / 2.3, 201)
    circle = 2**0.5 * np.column_stack([np.cos(2.3 * t), np.sin(2.3 * t)])
    orbit = contin.periodic_orbit(model, circle, times=t)
    family = contin.continuation(orbit, "p", (-1.0, 0.1), settings={"intervals": 100})
    (fold,) = [point for point in family.points if point.type == "LPC"]
    assert abs(fold.values["p"]) < 1e-14


def long_systems(core: Planted) -> Iterable[Hidden]:
    random = np.random.default_rng(2026)
    few = len(core.equations)
    for n in sorted({max(n, few) for n in EVERY_N}):
        for way in ("rotated",) if n > 12 else WAYS if n == few else WAYS[1:]:
            rate, length = 10.0 ** random.uniform(-2, 2, 2)
            yield Hidden(core, n, way, int(random.integers(10**6)), float(rate), float(length))


@pytest.mark.long
def test_planted_orbits_in_every_number_of_states_and_coordinates(tmp_path):
    """Writes its table to the folder CONTIN_TRUTH_TABLES, where that is set, as it goes on."""
    path = Path(os.environ.get("CONTIN_TRUTH_TABLES", tmp_path)) / "orbits.md"
    ledger = Ledger()
    for core in (*SIMPLE, *CURVES):
        for hidden in long_systems(core):
            judge_family(ledger, hidden)
        ledger.write(path, {"machine": "tests/truth/test_orbits.py", "version": contin.__version__})
    ledger.assert_clean()
