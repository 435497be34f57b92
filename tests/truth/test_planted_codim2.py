"""Points of codimension two that are planted on curves in two parameters: each is found within its errors, or noted."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest

import contin
from tests.truth import codim2_of_flows as flows
from tests.truth import codim2_of_maps as maps
from tests.truth.ledger import Expected, Ledger
from tests.truth.planted_curves import BOX, Core, Event, Hidden

GAPS = [10.0**-k for k in range(1, 10)]
ROUNDING = 4e-16  # of places that are of order 1, as planted
SECOND = 1e-7  # how far off the second parameter may be where its error is not stated
MOST = 8  # states


def hidden(
    random: np.random.Generator, cores: Iterable[Core], most: int = MOST, worst: float = 3.0
) -> Iterator[Hidden]:
    """The cores in up to `most` states, in coordinates of condition up to 10^worst."""
    for core in cores:
        few = len(core.equations)
        size = int(random.integers(few, max(most, few) + 1))
        system = Hidden(core, size, 10.0 ** random.uniform(0.0, worst), int(random.integers(10**6)))
        if system.is_clear:
            yield system


def judge(ledger: Ledger, system: Hidden, switching: bool = False) -> None:
    core = system.core
    try:
        curve = system.curve()
    except (contin.ContinError, LookupError) as error:
        ledger.failed(core.name, str(system), error)
        return
    expected = [Expected(e.type, float(system.exact_place(e.at)[0]), _further(system, e)) for e in system.expected()]
    ledger.judge(core.name, str(system), curve, expected, "p", 2.0, slack=ROUNDING)
    if switching:
        for point in curve.points:
            complaint = _switched(core, point)
            if complaint:
                ledger.count(core.name, str(system), "missed", f"{point.label}: {complaint}")


def _further(system: Hidden, event: Event) -> Callable[[object], str]:
    def complaint(point) -> str:
        off = abs(point.values["q"] - system.exact_place(event.at)[1])
        allowed = point.errors["q"] + ROUNDING if "q" in point.errors else SECOND
        return event.check(point, system) if off <= allowed else f"q is off by {off:.1e}, stated {allowed:.1e}"

    return complaint


def _switched(core: Core, point) -> str:
    """What is wrong with the other curves through a point, which `core.born` names: they begin there."""
    seeds = point.locus(("p", "q"))
    types = [seed.problem.locus for seed in seeds]
    wanted = list(core.born.get(point.type, ()))
    if types[: len(wanted)] != wanted:
        return f"its curves are {types}, not {wanted}"
    for seed in seeds[: len(wanted)]:
        if seed.problem.locus not in ("LP", "HB", "BP", "PD", "NS"):
            continue
        other = contin.continuation(seed, ("p", "q"), BOX)
        away = np.hypot(*(np.asarray(other.columns[k]) - point.values[k] for k in ("p", "q")))
        if not (len(other) > 3 and away.min() < 1e-8 and away.max() > 0.05):
            distances = f"{away.min():.1e} to {away.max():.1e} from it"
            return f"the curve of {seed.problem.locus} through it has {len(other)} rows, {distances}: {other.ends}"
    return ""


def judged(systems: Iterable[Hidden], switching: bool = False) -> Ledger:
    ledger = Ledger()
    for system in systems:
        judge(ledger, system, switching)
    return ledger


@pytest.mark.seldom
def test_points_of_codimension_two_and_the_curves_that_leave_them():
    cores = list(flows.alone(np.random.default_rng(4)))[1::2]  # the long version takes them all
    systems = hidden(np.random.default_rng(5), cores, most=3)
    judged(systems, switching=True).assert_clean()


@pytest.mark.seldom
def test_points_of_codimension_two_of_maps():
    cores = list(maps.alone(np.random.default_rng(3)))[1::2]  # the long version takes them all
    judged(hidden(np.random.default_rng(5), cores, most=2)).assert_clean()


def test_two_points_of_maps_close_together_are_told_apart_or_noted():
    cores = list(maps.close(np.random.default_rng(6), 1e-5))[1::2]
    judged(hidden(np.random.default_rng(7), cores, most=2)).assert_clean()


@pytest.mark.parametrize("gap", [1e-4, 1e-9])
def test_two_points_close_together_are_told_apart_or_noted(gap):
    cores = list(flows.close(np.random.default_rng(6), gap))[gap < 1e-6 :: 2]
    judged(hidden(np.random.default_rng(7), cores, most=2)).assert_clean()


def test_two_generalised_hopf_points_within_one_step_are_both_found():
    """Their test had one size but for its sign: two zeros within a step were not seen."""
    random = np.random.default_rng(1)
    curve = Hidden(flows.bautin(random, 1e-3), 2, 2.0, 3).curve()
    assert [p.type for p in curve.points] == ["GH", "GH"]


@pytest.mark.long
def test_points_of_codimension_two_of_many_systems(tmp_path):
    """Writes its table to the folder CONTIN_TRUTH_TABLES, where that is set, as it goes on."""
    rounds = int(os.environ.get("CONTIN_TRUTH_ROUNDS", "12"))
    path = Path(os.environ.get("CONTIN_TRUTH_TABLES", tmp_path)) / "codim2.md"
    ledger, random = Ledger(), np.random.default_rng(2026)
    for round_ in range(rounds):
        for family in (flows, maps):
            for system in hidden(random, family.alone(random)):
                judge(ledger, system, switching=True)
            for gap in GAPS:
                for system in hidden(random, family.close(random, gap)):
                    judge(ledger, system)
        facts = {"machine": "tests/truth/test_planted_codim2.py", "rounds": str(round_ + 1)}
        ledger.write(path, facts | {"version": contin.__version__})
    ledger.assert_clean()
