"""Large sparse systems about a zero state: every kernel and every Hopf point at its place."""

import pytest

import contin
from tests.truth.large_alike import planted


def check(seed):
    system = planted(seed)
    known = system.labels()
    line = contin.continuation(system.problem(sparse=True), "lam", (0, known[-1][1] + 0.1))
    found = [(p.type, int(p.vectors.get("kernel", 1)) if p.type == "BP" else 2) for p in line.points]
    assert found == [(type_, kernel) for type_, _, kernel in known]
    for point, (_, place, _) in zip(line.points, known, strict=True):
        assert abs(point.values["lam"] - place) <= max(1e-10, 3 * point.error)


@pytest.mark.parametrize("seed", [11, pytest.param(37, marks=pytest.mark.long)])
@pytest.mark.seldom
def test_labels_are_those_that_were_planted(seed):
    check(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", [s for s in (*range(60), *range(77000, 77060)) if s not in (11, 37)])
def test_labels_are_those_that_were_planted_long(seed):
    check(seed)
