"""Cells alike, each coupled to all others: on the branch of equal cells n - 1 eigenvalues vanish together.

x_i' = p - 1 + x_i/2 + a x_i^2 - x_i^3 + k sum of the other x_j: with all x_i = x, J has the eigenvalues
f'(x) + (n - 1) k (a fold where it vanishes) and f'(x) - k, n - 1 times (a branch point with that kernel).
"""

from __future__ import annotations

import random

import numpy as np
import pytest

from contin import api
from contin.model.model import Model


def check(seed: int) -> None:
    r = random.Random(seed)
    n, a, k = r.choice([3, 3, 4, 5]), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0)
    half = r.uniform(1.5, 3.0) + 40.0  # of the range: steps fall elsewhere with another one
    names = [f"x{i}" for i in range(n)]

    def at(x: float) -> float:
        return 1.0 - 0.5 * x - a * x * x + x**3 - k * (n - 1) * x

    equations = {
        x: f"p - 1 + 0.5*{x} + {a!r}*{x}^2 - {x}^3 + {k!r}*({' + '.join(y for y in names if y != x)})" for x in names
    }
    half = max(half, abs(at(3.0)) + 1.0)
    model = Model("cells", states=dict.fromkeys(names, 3.0), parameters={"p": at(3.0)}, equations=equations)
    branch = api.continuation(api.equilibrium(model), "p", (-half, half))
    places = {"BP": [-3.0, 2.0 * a, 0.5 - k], "LP": [-3.0, 2.0 * a, 0.5 + (n - 1) * k]}
    roots = {type_: [float(x.real) for x in np.roots(c) if abs(x.imag) < 1e-12] for type_, c in places.items()}
    expected = sorted((type_, at(x)) for type_, found in roots.items() for x in found)
    points = sorted(branch.points, key=lambda p: (p.type, p.values["p"]))
    assert [p.type for p in points] == [type_ for type_, _ in expected], (seed, points)
    for point, (type_, value) in zip(points, expected, strict=True):
        assert abs(point.values["p"] - value) <= max(point.error, 1e-14), (seed, point, value)
        if type_ == "BP":
            assert (point.normal_form["kind"], point.normal_form["kernel"]) == ("multiple", n - 1), (seed, point)
    assert branch.unexplained == 0


@pytest.mark.parametrize("seed", [2, pytest.param(6, marks=pytest.mark.long), 8])
def test_branch_points_of_cells_alike(seed):
    check(seed)


@pytest.mark.long
def test_many_cells_alike():
    for seed in range(100, 400):
        check(seed)
