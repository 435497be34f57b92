"""Curves of planted bifurcations of orbits, hidden in larger systems: sparse Jacobians, patterns, products.

A flow of a few states drives a chain with diffusion, one way, and plane rotations of neighbours hide both: curves and
multipliers are those of the few states, and the chain's.
"""

from dataclasses import dataclass, field

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import LinearOperator

import contin
from contin.continuation.branch import Parent
from contin.continuation.march import null_vector
from contin.loci.augmented.of_large_orbits import curve_of
from contin.problems.large_orbits.from_starts import FromStarts
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.layout import OnPoints
from contin.problems.large_orbits.radau import C, Trajectory
from tests.problems.large_orbits.cycles import crossing, planted

INTERVALS, MESH = 6, 2e-3


@dataclass
class Hidden:
    """n states; calls of the Jacobian and of products with it are counted."""

    n: int
    kind: str
    core: contin.FunctionProblem
    jacobians: int = 0
    products: int = 0
    turn: sparse.csc_matrix = field(init=False)

    def __post_init__(self):
        generator = np.random.default_rng(3)
        self.turn = sparse.identity(self.n, format="csc")
        for first in (0, 1):
            angles = generator.uniform(0.5, 2.5, (self.n - first) // 2)
            blocks = [[[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]] for t in angles]
            rest = self.n - first - 2 * len(angles)
            self.turn = sparse.block_diag([*np.ones((first, 1, 1)), *blocks, *np.ones((rest, 1, 1))]) @ self.turn
        few = self.core.n
        k = self.n - few
        chain = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(k, k)) * (k + 1) ** 2 / 50 - sparse.identity(k)
        driven = sparse.csc_matrix((np.ones(few), (range(few), range(few))), shape=(k, few))
        self.linear = sparse.bmat([[sparse.csc_matrix((few, few)), None], [driven, chain]], format="csc")
        inside = abs(self.linear) + sparse.block_diag([np.ones((few, few)), sparse.identity(k)])
        self.pattern = (abs(self.turn) @ inside @ abs(self.turn.T)).toarray() > 0.0

    def residual(self, u, p):
        z, few = self.turn.T @ u, self.core.n
        rate = self.linear @ z
        rate[:few] = self.core.residual(z[:few], p)
        rate[few:] += -0.1 * z[few:] ** 3
        return self.turn @ rate

    def matrix(self, u, p):
        few = self.core.n
        z = self.turn.T @ u
        inner = self.linear.toarray()
        inner[:few, :few] += self.core.jacobian(z[:few], p).toarray()
        inner[range(few, self.n), range(few, self.n)] -= 0.3 * z[few:] ** 2
        turn = self.turn.toarray()
        return sparse.csc_matrix(np.where(self.pattern, turn @ inner @ turn.T, 0.0))

    def jacobian(self, u, p):
        self.jacobians += 1
        matrix = self.matrix(u, p)
        if self.kind == "sparse":
            return matrix

        def product(v):
            self.products += 1
            return matrix @ v

        return LinearOperator(matrix.shape, matvec=product, dtype=float)

    def orbit(self, square, parameters, layout=None):
        """The family in the first of the parameters and its orbit with x^2 + y^2 = `square`, of period 2 pi."""
        model = contin.FunctionProblem(self.residual, np.zeros(self.n), parameters, self.jacobian)
        system = contin.equilibrium(model).system
        times = 2 * np.pi * ((np.arange(INTERVALS)[:, None] + C) / INTERVALS).ravel()
        u = np.zeros((len(times), self.n))
        u[:, 0], u[:, 1] = np.sqrt(square) * np.cos(times), np.sqrt(square) * np.sin(times)
        values = np.array(list(parameters.values()))
        orbits = LargeOrbitProblem(system, values, 0, OnPoints(INTERVALS) if layout is None else layout)
        z = orbits.vector(Trajectory((self.turn @ u.T).T.reshape(INTERVALS, 3, self.n), 2 * np.pi), values[0])
        return orbits, orbits.at_parameter(z, values[0], orbits.initial_scale(z, (0.0, 1.0)))


@pytest.mark.parametrize(
    ("kind", "type_", "mu", "slope", "sets"),
    [("sparse", "PD", 0.25, 0.75, 3), ("sparse", "NS", 0.3, 1.0, 5), ("operator", "PD", 0.25, 0.75, 3)],
)
def test_the_slope_of_a_curve_takes_jacobians_beside_the_orbit_once_for_all_directions(kind, type_, mu, slope, sets):
    """mu = (1/2 + a)^2 (1 - a) of PD, 3/10 + a of NS; one set of Jacobians at the orbit, two beside it (of NS four)."""
    hidden = Hidden(24, kind, planted(-1, 0, exact=True))
    orbits, z = hidden.orbit(mu, {"mu": mu, "a": 0.0})
    seed = curve_of(orbits, z, type_, ("mu", "a"), Parent("orbits", type_))
    scale = seed.problem.initial_scale(seed.z, (0.0, 1.0))
    near = seed.problem.near(seed.z, scale)
    hidden.jacobians = hidden.products = 0
    tangent = null_vector(near, seed.z, scale, np.ones(seed.z.size), 2)
    moved = (scale * tangent)[-2:]
    assert moved[1] / moved[0] == pytest.approx(slope, abs=MESH)
    points = 3 * INTERVALS
    assert hidden.jacobians <= sets * points
    if kind == "operator":  # the matrix by n products, or as many as there are colours; directions by two each
        assert hidden.products <= (hidden.n + 2 * 2 * 3) * points


RADIUS = 0.5


def branch_point(hidden, p, q, layout=None):
    """The seed of the curve of branch points; the circle is found beside them, where its equations are regular."""
    orbits, z = hidden.orbit(0.25, {"p": p + 0.1, "q": q}, layout)
    z[-1] = p
    return curve_of(orbits, z, "BPC", ("p", "q"), Parent("orbits", "BPC"))


@pytest.mark.parametrize(
    ("n", "layout", "angle"),
    [
        (20, None, 0.0), (20, None, 0.5 * np.pi), pytest.param(200, None, 0.9, marks=pytest.mark.seldom),
        pytest.param(20, FromStarts(1), 0.9, marks=pytest.mark.seldom),
    ],
)  # fmt: skip
def test_a_curve_of_branch_points_runs_along_either_parameter(n, layout, angle):
    """p^2 + q^2 = 1/4; at (1/2, 0) it runs along q, at (0, 1/2) along p, in which the family is followed."""
    hidden = Hidden(n, "sparse", crossing())
    seed = branch_point(hidden, RADIUS * np.cos(angle), RADIUS * np.sin(angle), layout)
    scale = seed.problem.initial_scale(seed.z, (-1.0, 1.0))
    near = seed.problem.near(seed.z, scale)
    hidden.jacobians = 0
    tangent = null_vector(near, seed.z, scale, np.ones(seed.z.size), 2)
    moved = (scale * tangent)[-2:] / np.linalg.norm((scale * tangent)[-2:])
    assert abs(moved @ [np.sin(angle), np.cos(angle)]) < 1e-6
    assert abs(tangent[-3]) < 1e-9, "the orbit closes"
    if layout is None:  # at the orbit, and beside it of each of two null vectors
        assert hidden.jacobians <= 5 * 3 * INTERVALS


@pytest.mark.seldom
def test_a_curve_of_branch_points_turns_round():
    """The combinations that are held are chosen anew as its tangent turns, or another curve would seem to cross."""
    hidden = Hidden(8, "sparse", crossing())
    seed = branch_point(hidden, 0.48, 0.14)
    span = {"p": (-1.0, 1.0), "q": (-1.0, 1.0)}
    curve = contin.continuation(seed, ("p", "q"), span, settings={"step": 0.1, "steps": 8})
    assert not curve.points
    assert not any("crosses" in note for note in curve.notes)
    np.testing.assert_allclose(np.hypot(curve.columns["p"], curve.columns["q"]), RADIUS, atol=1e-6)
    assert np.ptp(np.unwrap(np.arctan2(curve.columns["q"], curve.columns["p"]))) >= 0.5 * np.pi


def test_branch_points_that_nothing_forces_have_no_curve():
    """s' = s (k - s) + e: for e other than 0 two folds, or nothing."""

    def residual(u, p):
        x, y, s = u[:3].tolist()
        growth = 0.25 - x * x - y * y
        return np.append([growth * x - y, growth * y + x, s * (p["k"] - s) + p["e"]], -np.arange(1.0, 4.0) * u[3:])

    def jacobian(u, p):
        x, y, s = u[:3].tolist()
        growth = 0.25 - x * x - y * y
        core = [[growth - 2 * x * x, -1 - 2 * x * y, 0], [1 - 2 * x * y, growth - 2 * y * y, 0], [0, 0, p["k"] - 2 * s]]
        return sparse.block_diag([np.array(core), np.diag([-1.0, -2.0, -3.0])], format="csc")

    model = contin.FunctionProblem(residual, np.zeros(6), {"k": 0.0, "e": 0.0}, jacobian)
    times = 2 * np.pi * ((np.arange(INTERVALS)[:, None] + C) / INTERVALS).ravel()
    u = np.zeros((len(times), 6))
    u[:, 0], u[:, 1] = 0.5 * np.cos(times), 0.5 * np.sin(times)
    orbits = LargeOrbitProblem(contin.equilibrium(model).system, np.zeros(2), 0, OnPoints(INTERVALS))
    z = orbits.vector(Trajectory(u.reshape(INTERVALS, 3, 6), 2 * np.pi), 0.0)
    z = orbits.at_parameter(z, 0.0, orbits.initial_scale(z, (-1.0, 1.0)))
    seed = curve_of(orbits, z, "BPC", ("k", "e"), Parent("orbits", "BPC"))
    with pytest.raises(contin.InputError, match="nothing forces"):
        contin.continuation(seed, ("k", "e"), {"k": (-1.0, 1.0), "e": (-1.0, 1.0)})
