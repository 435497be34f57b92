"""Every march decides by the same rules: the rows of each are judged again, one by one, and compared with one another.

A march may take a step only where its path turns by no more than the settings allow and no longer than the step before
and its turn permit; it goes on after a row only where nothing happened on the way there, and stops where something did,
for that reason.
"""

from __future__ import annotations

import numpy as np
import pytest

import contin
from contin.continuation.corrector import EQUILIBRIA, IN_TWO_PARAMETERS, Decisions
from contin.continuation.sample import Chunk, Stop
from contin.kernels import steering
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.model.model import Model
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.shooting.shot_orbits import ShootingProblem
from tests.problems.follow import model

ROUNDED = 1.0 + 1e-9  # of a step's length
CIRCLE = model({"x": "1 - x^2 - p^2"}, {"x": 1.0}, {"p": 0.0})
PITCHFORK = model({"x": "p*x - x^3 + q"}, {"x": 0.0}, {"p": -1.0, "q": 0.0})
FOLD = model({"x": "p + x^2 - x^4", "y": "x - y"}, {"x": -1.3, "y": -1.3}, {"p": 1.0})
CUSP = model({"x": "q + p*x - x^3", "y": "x - 2*y"}, {"x": 1.2, "y": 0.6}, {"q": 0.0, "p": 1.0})
BAUTIN = Model(
    "bautin", states={"x": 0.0, "y": 0.0}, parameters={"p": 0.5}, definitions={"s": "x^2 + y^2"},
    equations={"x": "x*(p + s - s^2) - y", "y": "x + y*(p + s - s^2)"},
)  # fmt: skip


class Recorded:
    """What a march was asked, and its chunk."""

    def __init__(self, arguments: tuple, chunk: Chunk) -> None:
        (self.origin, self.before, self.length, self.frame, self.step, self.limit, self.bounds, self.settings,
         self.loop) = arguments  # fmt: skip
        self.chunk = chunk


def recorded(monkeypatch, kind, run) -> list[Recorded]:
    """All marches of problems of one kind, in a run."""
    march, found = kind.march, []

    def recording(self, *arguments):
        chunk = march(self, *arguments)
        found.append(Recorded(arguments, chunk))
        return chunk

    monkeypatch.setattr(kind, "march", recording)
    run()
    return found


def happenings(m: Recorded, decisions: Decisions, walls, k: int) -> set[Stop]:
    """What row k of a march is a reason to stop for."""
    c, last = m.chunk, k - 1
    found = set()
    if any(not low <= c.z[k, index] <= high for index, low, high in walls):
        found.add(Stop.BOUND)
    a, b = c.tests[last, decisions.dips :], c.tests[k, decisions.dips :]
    if np.any((a * b < 0.0) | ((a == 0.0) != (b == 0.0))) or (not decisions.dips and c.unstable[k] != c.unstable[last]):
        found.add(Stop.EVENT)
    known = m.before is not None and m.length > 0.0
    if last > 0 or known:
        tests, h = (c.tests[last - 1], c.lengths[last]) if last > 0 else (m.before.tests, m.length)
        if (
            steering.dipping(
                c.tests[k].copy(), c.tests[last : last + 1].copy(), 0, tests.copy(), decisions.dips, h, c.lengths[k]
            )
            >= 0
        ):
            found.add(Stop.DIP)
    return found


def judge(m: Recorded, decisions: Decisions = EQUILIBRIA, walls=None) -> int:
    """Asserts that every row of a march was decided as the rules say; the number of rows that were judged."""
    c, s = m.chunk, m.settings
    walls = [(-1, *m.bounds)] if walls is None else walls
    target = np.radians(s.max_angle) / 2.5
    for k in range(1, len(c)):
        h, turn = c.lengths[k], float(np.clip(c.tangents[k - 1] @ c.tangents[k], -1.0, 1.0))
        corner = c.stop is Stop.CORNER and k == len(c) - 1
        assert turn >= np.cos(np.radians(s.max_angle)) - 1e-12 or h <= max(s.min_step, steering.SHORTEST) or corner
        assert h <= s.max_step * ROUNDED
        if k > 1:
            angle = float(np.arccos(np.clip(c.tangents[k - 2] @ c.tangents[k - 1], -1.0, 1.0)))
            allowed = min(steering.GROWTH, target / max(angle, 1e-12))
            assert h <= max(c.lengths[k - 1] * max(allowed, steering.SHRINK), s.min_step) * (1.0 + 1e-6)
        found = happenings(m, decisions, walls, k)
        if k < len(c) - 1:
            assert not found, (k, found)
        elif c.stop in (Stop.BOUND, Stop.EVENT, Stop.DIP):
            assert c.stop is min(found, key=[Stop.BOUND, Stop.EVENT, Stop.DIP].index)
        elif c.stop is not Stop.CORNER:
            assert not found
    return len(c) - 1


@pytest.mark.parametrize(
    ("system", "bounds", "labels"),
    [(CIRCLE, (-2.0, 2.0), ["LP", "LP"]), (PITCHFORK, (-1.5, 1.0), ["BP"]), (FOLD, (-1.0, 1.5), ["LP", "LP", "LP"])],
    ids=["circle", "pitchfork", "fold"],
)
def test_rows_of_equilibria_are_decided_by_the_rules(system, bounds, labels, monkeypatch):
    branches = []
    marches = recorded(
        monkeypatch, EquilibriumProblem,
        lambda: branches.append(contin.continuation(contin.equilibrium(system), "p", bounds)),
    )  # fmt: skip
    assert [p.type for p in branches[0].points] == labels
    assert sum(judge(m) for m in marches) > 20


@pytest.mark.parametrize("kind", [OrbitProblem, ShootingProblem])
def test_rows_of_families_of_orbits_are_decided_by_the_rules(kind, monkeypatch):
    line = contin.continuation(contin.equilibrium(BAUTIN), "p", (-0.5, 0.6))
    method = {"method": "shooting"} if kind is ShootingProblem else {}
    marches = recorded(
        monkeypatch, kind, lambda: contin.continuation(line["HB1"].switch(), "p", (-0.5, 0.5), settings=method)
    )
    assert sum(judge(m) for m in marches) > 10


def cusp(u, p):
    """The equations of `CUSP`."""
    return np.array([p["q"] + p["p"] * u[0] - u[0] * u[0] * u[0], u[0] - 2.0 * u[1]])


FUNCTION = contin.FunctionProblem(cusp, [1.2, 0.6], {"q": 0.0, "p": 1.0}, states=["x", "y"])


@pytest.mark.parametrize("system", [CUSP, FUNCTION], ids=["machine code", "Python"])
def test_rows_of_a_curve_of_folds_are_decided_by_the_rules(system, monkeypatch):
    line = contin.continuation(contin.equilibrium(system), "q", (-1.0, 1.0))
    bounds = {"q": (-1.0, 1.0), "p": (-1.0, 2.0)}
    walls = [(-2, *bounds["p"]), (-1, *bounds["q"])]
    curves = []
    marches = recorded(
        monkeypatch, LocusProblem,
        lambda: curves.append(contin.continuation(line["LP1"].locus(), ("q", "p"), bounds)),
    )  # fmt: skip
    assert [p.type for p in curves[0].points] == ["CP"]
    assert sum(judge(m, IN_TWO_PARAMETERS, walls) for m in marches) > 20
