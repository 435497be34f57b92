"""Hopf points at which symmetry makes several pairs of eigenvalues cross together: one family for every pattern.

The equivariant Hopf theorem (Golubitsky, Stewart and Schaeffer, Singularities and Groups in Bifurcation Theory II, ch.
XVI) gives a family for each vector q of the critical eigenspace that a symmetry S multiplies by a phase factor,
S q = e^{i phi} q, and no other vector beside it: orbits with S u(t) = u(t + phi / omega). Three coupled cells have a
rotating wave and two patterns in which two cells agree up to the phase.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contin.continuation.branch import SpecialPoint
from contin.continuation.seed import Seed
from contin.machine import elementary
from contin.normalforms.jet import Jet
from contin.problems.equilibria.critical_actions import critical_actions
from contin.problems.orbits.linearised.linear import OrbitLinear

if TYPE_CHECKING:
    from contin.problems.equilibria.equilibrium import EquilibriumProblem

SIMPLE = 1e-3  # distance of two phase factors from which they are two
SAME = 1e-3  # 1 - cosine up to which two patterns are one

STEPS = 4  # of Newton's method to an orbit
NEGLIGIBLE = 1e-6  # singular values this small beside the largest are taken as zero there
SOLVED = 1e-9  # scaled residual of the orbit
LARGEST = 1500  # unknowns of dense matrices

Complex = NDArray[np.complex128]


def _normalised(q: Complex, p: Complex, product: complex) -> tuple[Complex, Complex]:
    """(q, p) with |q| = 1, its largest component positive, and <p, M q> = 1 for `product` that they have now."""
    factor = elementary.exp(-1j * elementary.angle(q[np.argmax(np.abs(q))])) / np.linalg.norm(q)
    return q * factor, p / np.conj(product * factor)


def patterns(
    equilibria: EquilibriumProblem, point: SpecialPoint, jet: Jet, omega: float
) -> list[tuple[Complex, Complex]]:
    """(q, p) of every pattern, |q| = 1, <p, M q> = 1, one of those that symmetries map onto each other.

    Where symmetries tell none apart, one vector of the eigenspace.
    """
    count, sizes = int(point.vectors["kernel"]), point.scale[:-1]
    critical = critical_actions(equilibria, point.z, sizes, jet, omega, count)
    basis, dual, actions = critical.basis, critical.dual, critical.matrices
    found: list[Complex] = []
    pairs = []
    for action in actions:
        values, vectors = np.linalg.eig(action)
        covectors = np.linalg.inv(vectors)
        for k, value in enumerate(values):
            if np.min(np.abs(np.delete(values, k) - value), initial=2.0) < SIMPLE:
                continue
            c = vectors[:, k] / np.linalg.norm(vectors[:, k])
            images = [c, *(a @ c for a in actions)]
            cosines = [abs(np.vdot(i, other)) / float(np.linalg.norm(i)) for i in images for other in found]
            if max(cosines, default=0.0) > 1.0 - SAME:
                continue
            found.append(c)
            pairs.append(_normalised(basis @ c, dual @ covectors[k].conj(), complex(covectors[k] @ c)))
    return pairs or [_normalised(basis[:, -1], dual[:, -1], 1.0)]


def through_an_orbit(seed: Seed, size: float) -> Seed:
    """The seed with the curvature that leads exactly to the orbit at the scaled distance `size`.

    Up to third order some patterns lie in a continuum, on which Newton's matrix is singular: steps of least length.
    """
    assert seed.direction is not None
    assert seed.curvature is not None
    assert seed.scale is not None
    problem: Any = seed.problem
    z = seed.z + seed.scale * (size * seed.direction + 0.5 * elementary.square(size) * seed.curvature)
    linear = OrbitLinear(problem, z, seed.scale, z)
    x, row = linear.unknowns, seed.direction[linear.unknowns]
    if len(x) > LARGEST:
        return seed
    for _ in range(STEPS):
        length = float(row @ ((z - seed.z) / seed.scale)[x])
        matrix = np.vstack([linear.jacobian.toarray(), row])
        step = np.linalg.lstsq(matrix, -np.append(linear.residual, length - size), rcond=NEGLIGIBLE)[0]
        z = z.copy()
        z[x] += step * seed.scale[x]
        linear = OrbitLinear(problem, z, seed.scale, linear.reference)
    if float(np.abs(linear.residual).max()) > SOLVED:
        return seed
    curvature = 2.0 / elementary.square(size) * ((z - seed.z) / seed.scale - size * seed.direction)
    return replace(seed, curvature=curvature, reach=size)
