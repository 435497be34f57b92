"""Singular solutions of boundary-value problems: derivatives by intervals, block elimination; dense matrices."""

from __future__ import annotations

import numpy as np
import pytest

from contin.bvp.boundary_problem import BoundaryProblem
from contin.bvp.two_point import two_point
from contin.loci.augmented.boundary import BoundaryBase
from contin.loci.augmented.of_boundary import boundary_base, start
from contin.model.model import Model

BEAM = Model(
    "beam", kind="bvp", states={"w": 0.1, "a": 0}, parameters={"p": 9.8, "k": 0.3, "q": 0.2, "r": 0.1},
    equations={"w": "a", "a": "-p*sin(w) - k*w^2 + q*cos(3*t) - r*a*w"},
    conditions=["w(start) = r*a(end)", "w(end) + k*a(end)^2 = p*q/9"],
)  # fmt: skip


def somewhere(type_: str, places: tuple[str, ...], seed: int) -> tuple[BoundaryBase, np.ndarray, np.ndarray]:
    """A base, any z on a mesh of different intervals, and any metric."""
    two = two_point(BEAM, ())
    base_values = np.array([9.8, 0.3, 0.2, 0.1])
    problem = BoundaryProblem(two, base_values, 0)
    random = np.random.default_rng(seed)
    h = random.uniform(0.5, 1.5, 4)
    u = random.normal(size=((4 * problem.points + 1) * 2)) * 0.3
    z = np.concatenate([u, [1.0], h / h.sum(), [9.8]])
    base = boundary_base(problem, z, type_, places)
    full = start(base, z)
    return base, full, np.where(np.arange(full.size) < u.size, random.uniform(0.5, 2.0, full.size), 1.0)


@pytest.mark.parametrize("seed", range(2))
def test_derivatives_by_intervals_are_those_of_differences(seed):
    base, z, scale = somewhere("LP", ("p", "q"), seed)
    where = base.where(z)
    mesh = base.on_mesh(base.profile(z).h, scale[where])
    y, step = z[where] / scale[where], 1e-6
    here = mesh.at(y)
    slopes = np.column_stack([
        (mesh.at(y + step * e).residual - mesh.at(y - step * e).residual) / (2 * step) for e in np.eye(len(y))
    ])  # fmt: skip
    matrix = np.hstack([here.slope.toarray(), here.columns])
    assert np.abs(matrix - slopes).max() < 1e-7
    w = np.random.default_rng(seed + 9).normal(size=here.size)
    assert np.abs(here.pulled(w) - w @ matrix).max() < 1e-12


@pytest.mark.parametrize("type_", ["LP", "BP"])
@pytest.mark.parametrize("places", [("p", "q"), ("p", "q", "k")])
def test_block_elimination_solves_the_whole_system_and_knows_its_sign(type_, places):
    base, z, scale = somewhere(type_, places, 3)
    count = len(places) - 1
    rows = np.random.default_rng(4).normal(size=(count, z.size))
    base = base.settled(z, scale)
    there = base.linearise(z, scale, rows)
    where = there.where
    mesh = base.on_mesh(base.profile(z).h, np.delete(scale[where], base.unfolding(z)))
    here = mesh.at(np.delete(z[where] / scale[where], base.unfolding(z)))
    unfolding = [base.borders_at(z, scale).left[:, None]] if type_ == "BP" else []
    top = np.hstack([here.slope.toarray(), *unfolding, here.columns])
    whole = np.vstack([top, there.found.gradient, rows[:, where]])
    sign, size = np.linalg.slogdet(whole)
    assert there.sign == sign
    assert there.log_determinant == pytest.approx(size, abs=1e-9)
    right = np.random.default_rng(5).normal(size=len(whole))
    still = z.size - len(where)
    longer = np.concatenate([right[: len(whole) - count], np.zeros(still), right[len(whole) - count :]])
    assert there.solve(longer)[where] == pytest.approx(np.linalg.solve(whole, right), rel=1e-9)
