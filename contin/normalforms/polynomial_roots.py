"""All real directions that solve a small system of polynomial equations, and whether they form a continuum."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contin.normalforms.jet import Real

SAME = 1e-6  # distance below which two solutions are one
SINGULAR = 1e-5  # singular values of the Jacobian below this fraction of its size count as zero

Equations = Callable[[Real], tuple[Real, Real]]  # (starts, m) -> values (starts, r), Jacobians (starts, r, m)


@dataclass(frozen=True, eq=False)
class Root:
    """A solution, and the number of independent directions in which it can be moved (0: isolated and simple)."""

    y: Real
    free: int


def sphere_roots(equations: Equations, weights: Real, mirror: Real) -> list[Root]:
    """Real solutions y with sum(weights y^2) = 1, one of each pair {y, mirror y}, by Newton from many starts at once.

    The equations must be invariant under `mirror` (entries +-1) and scaled so that all of y is of order one. The
    100 * 2^m starts for m unknowns are drawn with a fixed seed, so the answer is reproducible; Gauss-Newton takes the
    minimum-norm step, which also converges to continua. With 8 pairs in 4 unknowns, a root whose basin takes one per
    cent of the sphere is missed with a chance of 1e-7.
    """
    rng = np.random.default_rng(1)
    m = len(weights)
    y = np.vstack([np.eye(m)[weights > 0], rng.normal(size=(100 * 2 ** min(m, 8), m))])
    y = y / np.sqrt(np.sum(weights * y * y, axis=1, keepdims=True))
    y[:, weights == 0.0] = np.clip(y[:, weights == 0.0], -3.0, 3.0)
    moving = np.arange(len(y))
    for _ in range(60):
        now = y[moving]
        values, jacobians = equations(now)
        values = np.concatenate([values, 0.5 * (np.sum(weights * now * now, axis=1) - 1.0)[:, None]], axis=1)
        jacobians = np.concatenate([jacobians, (weights * now)[:, None, :]], axis=1)
        step = -(np.linalg.pinv(jacobians, rcond=1e-9) @ values[:, :, None])[:, :, 0]
        length = np.linalg.norm(step, axis=1, keepdims=True)
        y[moving] = now + step * np.minimum(1.0, 0.5 / np.maximum(length, 1e-300))
        moving = moving[length[:, 0] > 1e-14 * (1.0 + np.linalg.norm(now, axis=1))]
        if len(moving) == 0:
            break
    values, jacobians = equations(y)
    size = float(np.median(np.abs(jacobians).max(axis=(1, 2))))
    good = np.abs(values).max(axis=1) <= 1e-9 * size
    good &= np.abs(np.sum(weights * y * y, axis=1) - 1.0) < 1e-8
    roots: list[Root] = []
    points, jacobians = y[good], jacobians[good]
    fresh = np.ones(len(points), dtype=bool)  # not yet known as a copy of an earlier one
    for i, point in enumerate(points):
        if not fresh[i]:
            continue
        fresh &= distance(points, point, mirror) >= SAME * float(np.linalg.norm(point))
        spectrum = np.linalg.svd(np.vstack([jacobians[i], size * weights * point]), compute_uv=False)
        roots.append(Root(point, m - int(np.sum(spectrum > SINGULAR * size))))
    return roots


def distance(points: Real, point: Real, mirror: Real) -> Real:
    """Distance of each of the points to {point, mirror point}; broadcast, the last axis is that of the unknowns."""
    near = np.linalg.norm(points - point, axis=-1)
    return np.asarray(np.minimum(near, np.linalg.norm(points - mirror * point, axis=-1)))
