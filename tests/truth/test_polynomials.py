"""All solutions and folds of random polynomial systems against elimination: an independent count at every parameter."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

import contin
from contin.errors import NoSolutionError
from tests.diagram.crossings import solutions
from tests.truth.polynomials import RANGE, random_polynomial

VALUES = [-0.93, -0.55, -0.17, 0.21, 0.59, 0.87]
SAME = 1e-9
SIZE = 60.0  # of the box that is searched


def judged(seed: int, n: int, degree: int) -> tuple[Counter[str], list[str]]:
    """Counts and complaints of one system: passages of the diagram at some values, and its folds and branch points."""
    generator = np.random.default_rng([seed, n, degree])
    system = random_polynomial(generator, n, degree)
    counts: Counter[str] = Counter(systems=1)
    complaints: list[str] = []
    folds = system.singular()
    states = dict.fromkeys(system.equations, 0.0)
    model = contin.Model("polynomial", states=states, parameters={"p": RANGE[0]}, equations=system.equations)
    box = dict.fromkeys(states, (-SIZE, SIZE))
    where = f"seed {seed}, n = {n}, degree {degree}, {system.equations}"
    try:
        diagrams = contin.diagram(model, "p", RANGE, start="all", box=box, orbits=False)
    except NoSolutionError:  # there are none at the values that are searched: said, not silent
        counts["none"] += 1
        return counts, complaints
    for value in VALUES:
        if min((abs(value - f) for f in folds), default=1.0) < 1e-3:
            continue
        expected, found = system.roots(value), np.sort(solutions(diagrams, value).reshape(-1, n)[:, 0])
        within = system.within(expected, value, SIZE)
        missing = [x for x in within if np.abs(found - x).min(initial=1.0) > SAME * (1.0 + abs(x))]
        extra = [x for x in found if np.abs(expected - x).min(initial=1.0) > SAME * (1.0 + abs(x))]
        counts.update(expected=len(within), found=len(within) - len(missing), spurious=len(extra))
        if len(found) > len(expected) and not extra:
            counts["twice"] += 1
            complaints.append(f"{where}: a solution is met twice at p = {value}")
        if missing or extra:
            counts["missed" if missing else "spurious"] += len(missing)
            complaints.append(f"{where}: at p = {value} missing {missing}, extra {extra}; {diagrams.notes}")
    for branch in diagrams:
        for point in branch.points:
            if point.type == "HB":  # no singular value
                continue
            off = min((abs(point.values["p"] - f) for f in folds), default=1.0)
            counts["labels"] += 1
            if off > point.error + 1e-13:
                counts["wrong"] += 1
                complaints.append(f"{where}: {branch.name}.{point.label} is off a singular value by {off:.1e}")
    return counts, complaints


@pytest.mark.parametrize(("n", "degree"), [(1, 3), (1, 4), (2, 3)])
def test_every_root_is_on_a_branch_and_every_label_is_a_root_of_the_discriminant(n, degree):
    found = [text for seed in range(2) for text in judged(seed, n, degree)[1]]
    assert found == []


@pytest.mark.long
def test_every_root_of_many_polynomials_is_on_a_branch():
    total: dict[str, Counter[str]] = {}
    complaints: list[str] = []
    for n, degree in ((1, 2), (1, 3), (1, 4), (2, 2), (2, 3), (2, 4)):
        for seed in range(100, 150):
            counts, texts = judged(seed, n, degree)
            total.setdefault(f"n = {n}, degree {degree}", Counter()).update(counts)
            complaints += texts
    print(total)
    assert complaints == []
