"""Whether two branches of a boundary-value problem meet at a point of the reduced equation, or pass it apart.

Where mu_1 = mu_2 = 0, mu itself is zero at a branch point (`contin.problems.sparse.reduced_equation`); of an imperfect
one, as of u'' + q u - u^3 = eps, it is eps' part along the left null vector p: no branches meet. Two other reasons for
a remainder are told from that: the rounding of F, and the error of a mesh, which falls on a finer one.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.abi import Array
from contin.bvp.on_mesh import OnMesh

CONSISTENT: Final = 20.0  # times its rounding errors: what may be left of mu
BESIDE: Final = 1e-9  # of the unknowns' sizes: so near F is linear but for its rounding
SAMPLES: Final = 3
EPSILON: Final = float(np.finfo(float).eps)
FALLEN: Final = 0.25  # part that a mesh of twice as many intervals leaves of an error of the mesh: at most 2^-m


Place = tuple[OnMesh, Array, Array | None]  # a mesh, x on it, and there the left null vector p (n,) of F_u, if known


def imperfection(at: Place, finer: Place, sizes: Array) -> float:
    """What is left of the reduced equation where that is neither rounding nor an error of the mesh; else 0.

    finer : the same on a mesh of twice as many intervals.  sizes : of the functions, (problem.n,).
    """
    if at[2] is None or finer[2] is None:
        return 0.0
    mu, noise = _remainder(at[0], at[1], at[2], sizes)
    if not mu > CONSISTENT * noise:
        return 0.0
    again, rounding = _remainder(finer[0], finer[1], finer[2], sizes)
    return again if again > max(FALLEN * mu, CONSISTENT * rounding) else 0.0


def _remainder(mesh: OnMesh, x: Array, left: Array, sizes: Array) -> tuple[float, float]:
    """|<p, F(x)>| on a scale that all meshes share, and how large it is by rounding. NaN where F is not finite."""
    here = mesh.at(x)
    if here is None:
        return np.nan, np.nan
    n, m = mesh.problem.n, mesh.problem.points
    weights = np.abs(left)
    shared = float(weights @ np.concatenate([(np.repeat(mesh.h, m)[:, None] * sizes).ravel(), sizes]))
    noise = EPSILON * (here.linear.magnitude(np.abs(x[:-1])) + np.abs(here.slope * x[-1]))
    beside, generator = OnMesh(mesh.problem, mesh.h), np.random.default_rng(17)
    size = np.tile(sizes, mesh.n // n)
    for _ in range(SAMPLES):
        step = BESIDE * size * generator.uniform(-1.0, 1.0, mesh.n)
        ahead, behind = (beside.residual(np.append(x[:-1] + s * step, x[-1])) for s in (1.0, -1.0))
        odd = np.abs(0.5 * (ahead - behind) - here.linear.apply(step))
        noise = np.maximum(noise, odd)
    return abs(float(left @ here.residual)) / shared, float(weights @ noise) / shared
