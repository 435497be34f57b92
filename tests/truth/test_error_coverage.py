"""The error that a label states covers its true error: random systems at 40 digits, degenerate ones in closed form.

Every label of a random system is refined in mpmath (`exact_labels`); of a degenerate one its place is planted. A place
farther off than `error`, or a coefficient than its entry in `errors`, is wrong; so is a sign stated that is not so.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

import contin
from tests.truth.exact_labels import COEFFICIENTS, Formulas, refined
from tests.truth.random_systems import Planted, degenerate, random_system, with_hopf

RANGE = (-1.0, 1.0)
PLACES = 1e-9  # from the planted place: nearer, a label is that one; else its error must say so
SETTINGS = {"steps": 400}
CLEAR = 1e3  # a coefficient this many times its stated error is not called degenerate


@dataclass(eq=False)
class Tally:
    """Labels by type: how many, how many of them could be refined, how many beyond the stated error."""

    counts: dict[str, Counter[str]] = field(default_factory=dict)
    worst: dict[str, float] = field(default_factory=dict)
    complaints: list[str] = field(default_factory=list)

    def add(self, type_: str, kind: str) -> None:
        self.counts.setdefault(type_, Counter())[kind] += 1

    def compare(self, type_: str, what: str, where: str, off: float, stated: float) -> None:
        self.add(type_, f"{what}s")
        ratio = off / stated if stated > 0.0 else (0.0 if off == 0.0 else np.inf)
        self.worst[f"{type_} {what}"] = max(ratio, self.worst.get(f"{type_} {what}", 0.0))
        if not off <= stated:
            self.add(type_, f"{what}s beyond")
            self.complaints.append(f"{where}: {what} off by {off:.2e}, stated {stated:.2e}")

    def table(self) -> str:
        head = "| type | labels | places | beyond | worst | coefficients | beyond | worst |\n" + "|---" * 8 + "|"
        rows = []
        for type_, c in sorted(self.counts.items()):
            worst = [f"{self.worst.get(f'{type_} {w}', 0.0):.2f}" for w in ("place", "coefficient")]
            rows.append(
                f"| {type_} | {c['labels']} | {c['places']} | {c['places beyond']} | {worst[0]} | "
                f"{c['coefficients']} | {c['coefficients beyond']} | {worst[1]} |"
            )
        return "\n".join([head, *rows])

    def write(self, path: Path) -> None:
        path.write_text("\n".join([f"version: {contin.__version__}", "", self.table(), "", *self.complaints]) + "\n")


def judge_point(tally: Tally, system: Formulas, name: str, point, free: tuple[str, ...]) -> None:
    """A label of a random system against 40 digits."""
    tally.add(point.type, "labels")
    values = [point.values[s.name] for s in system.states] + [point.values[p] for p in free]
    exact = refined(system, point.type, values, len(free))
    where = f"{name}: {point.label} at {free[0]} = {point.values[free[0]]:.12g}"
    if exact.z is None:
        return
    off = abs(float(exact.z[system.n] - values[system.n]))
    tally.compare(point.type, "place", where, off, point.error)
    if exact.coefficient is not None:
        judge_coefficient(tally, point, where, float(exact.coefficient))


def judge_coefficient(tally: Tally, point, where: str, exact: float) -> None:
    key = COEFFICIENTS[point.type][0]
    form = point.normal_form
    if key not in form:
        return
    value = form[key][0] if isinstance(form[key], list) else form[key]
    stated = form.get("errors", {}).get(key)
    if stated is None:
        tally.add(point.type, "unstated")
        tally.complaints.append(f"{where}: no error of {key}")
        return
    tally.compare(point.type, "coefficient", where, abs(value - exact), stated)
    word = form.get("criticality")
    if word is None:
        return
    sign = exact * (-1.0 if point.type == "PD" else 1.0)
    right = "supercritical" if sign < 0.0 else "subcritical"
    if word not in (right, "degenerate") or (word == "degenerate" and abs(exact) > CLEAR * stated):
        tally.add(point.type, "coefficients beyond")
        tally.complaints.append(f"{where}: {word} for {key} = {exact:.3g} (stated error {stated:.1e})")


def lines(seed: int, count: int) -> Iterator[tuple[str, Formulas]]:
    for k in range(count):
        generator = np.random.default_rng([seed, k])
        n = int(generator.integers(1, 5))
        which = k % 3
        if which == 0 and n > 1:
            yield f"Hopf {seed}.{k}", with_hopf(generator, n)
        elif which == 1:
            yield f"map {seed}.{k}", random_system(generator, min(n, 3), "map")
        else:
            yield f"flow {seed}.{k}", random_system(generator, n)


def follow_line(tally: Tally, name: str, system: Formulas) -> None:
    """Labels on the branch through the origin."""
    model = system.model({"p": 0.0})
    start = contin.equilibrium(model, {s.name: 0.0 for s in system.states}, {"p": 0.0})
    branch = contin.continuation(start, "p", RANGE, settings=SETTINGS)
    for point in branch.points:
        if point.type in ("LP", "HB", "PD", "NS"):
            judge_point(tally, system, name, point, ("p",))


def follow_loci(tally: Tally, name: str, system: Formulas) -> None:
    """Labels on the curves of the branch's points in two parameters."""
    model = system.model({"p": 0.0, "q": 0.0})
    start = contin.equilibrium(model, {s.name: 0.0 for s in system.states}, {"p": 0.0, "q": 0.0})
    branch = contin.continuation(start, "p", RANGE, settings=SETTINGS)
    seen: set[str] = set()
    for point in branch.points:
        if point.type not in ("LP", "HB", "PD", "NS") or point.type in seen:
            continue
        seen.add(point.type)
        curve = contin.continuation(
            point.locus(("p", "q")), ("p", "q"), {"p": (-2.0, 2.0), "q": (-2.0, 2.0)}, settings={"steps": 150}
        )
        for special in curve.points:
            if special.type in ("CP", "BT", "GH", "ZH", "HH", "GPD", "CH", "LPPD", "R1", "R2", "R3", "R4"):
                judge_point(tally, system, f"{name} {point.type}", special, ("p", "q"))


def pairs(seed: int, count: int) -> Iterator[tuple[str, Formulas]]:
    for k in range(count):
        generator = np.random.default_rng([seed, 7, k])
        kind = "map" if k % 3 == 2 else "flow"
        n = int(generator.integers(2, 4 if kind == "map" else 5))
        yield f"{kind} {seed}.7.{k}", random_system(generator, n, kind, 2)


def follow_planted(tally: Tally, planted: Planted, name: str) -> None:
    model = planted.system.model({"p": planted.begin})
    at = {"p": planted.begin}
    start = contin.equilibrium(model, dict(zip(model.state_names, planted.start, strict=True)), at)
    branch = contin.continuation(start, "p", RANGE, settings=SETTINGS)
    type_, left = f"degenerate {planted.type}", [p for p in branch.points if p.type == planted.type]
    for place in planted.at:
        tally.add(type_, "labels")
        mine = [p for p in left if abs(p.values["p"] - place) <= min(abs(p.values["p"] - at) for at in planted.at)]
        if not mine:
            tally.add(type_, "noted" if branch.notes else "missed")
            if not branch.notes:
                tally.complaints.append(f"{name}: no {planted.type} at {place}, no note")
            continue
        point = min(mine, key=lambda p: abs(p.values["p"] - place))
        left.remove(point)
        off = abs(point.values["p"] - place)
        tally.compare(type_, "place", f"{name}: {point.label}", off, point.error)


def measured(seed: int, count: int, loci: int, rounds: int) -> Tally:
    tally = Tally()
    for name, system in lines(seed, count):
        _counted(tally, name, lambda name=name, system=system: follow_line(tally, name, system))
    for name, system in pairs(seed, loci):
        _counted(tally, name, lambda name=name, system=system: follow_loci(tally, name, system))
    for k in range(rounds):
        for planted in degenerate(np.random.default_rng([seed, 9, k])):
            name = f"degenerate {seed}.9.{k} {planted.name}"
            _counted(tally, name, lambda planted=planted, name=name: follow_planted(tally, planted, name))
    return tally


def _counted(tally: Tally, name: str, judge) -> None:
    try:
        judge()
    except contin.ContinError as error:
        tally.complaints.append(f"{name}: {type(error).__name__}: {error}")


def assert_covered(tally: Tally) -> None:
    assert not tally.complaints, "\n".join([tally.table(), *tally.complaints])


def test_stated_errors_cover_true_errors():
    assert_covered(measured(seed=1, count=3, loci=1, rounds=1))


@pytest.mark.long
def test_stated_errors_cover_true_errors_in_many_systems(tmp_path):
    """Writes its table to the folder CONTIN_TRUTH_TABLES, where that is set."""
    tally = measured(seed=2026, count=400, loci=60, rounds=8)
    tally.write(Path(os.environ.get("CONTIN_TRUTH_TABLES", tmp_path)) / "error_coverage.md")
    assert_covered(tally)


def named(systems: Iterable[tuple[str, Formulas]], name: str) -> Formulas:
    """One system of a complaint, to look at it alone."""
    return next(system for key, system in systems if key == name)
