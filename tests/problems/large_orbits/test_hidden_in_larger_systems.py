"""Curves of planted bifurcations of orbits, hidden in larger systems: sparse Jacobians, patterns, products.

A flow of seven states drives a chain with diffusion, one way, and plane rotations of neighbours hide both: curves and
multipliers are those of the seven states, and the chain's.
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
from contin.problems.large_orbits.large_orbit import LargeOrbitProblem
from contin.problems.large_orbits.layout import OnPoints
from contin.problems.large_orbits.radau import C, Trajectory
from tests.problems.large_orbits.cycles import planted

SEVEN, INTERVALS, MESH = 7, 6, 2e-3


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
        k = self.n - SEVEN
        chain = sparse.diags([1.0, -2.0, 1.0], [-1, 0, 1], shape=(k, k)) * (k + 1) ** 2 / 50 - sparse.identity(k)
        driven = sparse.csc_matrix((np.ones(SEVEN), (range(SEVEN), range(SEVEN))), shape=(k, SEVEN))
        self.linear = sparse.bmat([[sparse.csc_matrix((SEVEN, SEVEN)), None], [driven, chain]], format="csc")

    def residual(self, u, p):
        z = self.turn.T @ u
        rate = self.linear @ z
        rate[:SEVEN] = self.core.residual(z[:SEVEN], p)
        rate[SEVEN:] += -0.1 * z[SEVEN:] ** 3
        return self.turn @ rate

    def matrix(self, u, p):
        z = self.turn.T @ u
        own = np.pad(self.core.jacobian(z[:SEVEN], p).toarray(), (0, self.n - SEVEN))
        own[range(SEVEN, self.n), range(SEVEN, self.n)] = -0.3 * z[SEVEN:] ** 2
        return sparse.csc_matrix(self.turn @ (self.linear + sparse.csc_matrix(own)) @ self.turn.T)

    def jacobian(self, u, p):
        self.jacobians += 1
        matrix = self.matrix(u, p)
        if self.kind == "sparse":
            return matrix

        def product(v):
            self.products += 1
            return matrix @ v

        return LinearOperator(matrix.shape, matvec=product, dtype=float)

    def orbit(self, mu):
        """The family and its orbit with x^2 + y^2 = mu."""
        model = contin.FunctionProblem(self.residual, np.zeros(self.n), {"mu": mu, "a": 0.0}, self.jacobian)
        system = contin.equilibrium(model).system
        times = 2 * np.pi * ((np.arange(INTERVALS)[:, None] + C) / INTERVALS).ravel()
        u = np.zeros((len(times), self.n))
        u[:, 0], u[:, 1] = np.sqrt(mu) * np.cos(times), np.sqrt(mu) * np.sin(times)
        orbits = LargeOrbitProblem(system, np.array([mu, 0.0]), 0, OnPoints(INTERVALS))
        z = orbits.vector(Trajectory((self.turn @ u.T).T.reshape(INTERVALS, 3, self.n), 2 * np.pi), mu)
        return orbits, orbits.at_parameter(z, mu, orbits.initial_scale(z, (0.0, 1.0)))


@pytest.mark.parametrize(
    ("kind", "type_", "mu", "slope", "sets"),
    [("sparse", "PD", 0.25, 0.75, 3), ("sparse", "NS", 0.3, 1.0, 5), ("operator", "PD", 0.25, 0.75, 3)],
)
def test_the_slope_of_a_curve_takes_jacobians_beside_the_orbit_once_for_all_directions(kind, type_, mu, slope, sets):
    """mu = (1/2 + a)^2 (1 - a) of PD, 3/10 + a of NS; one set of Jacobians at the orbit, two beside it (of NS four)."""
    hidden = Hidden(24, kind, planted(-1, 0, exact=True))
    orbits, z = hidden.orbit(mu)
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
