"""Branch points whose kernel has dimension k > 1: every real branch through them, from the reduced equations.

With y = (x, dp), x in R^k, three scalings occur (Golubitsky, Stewart and Schaeffer, Singularities and Groups in
Bifurcation Theory II, 1988):

    quadratic   T2[y, y] = 0                        x ~ s, dp ~ s      the quadratic terms in x do not vanish
    cubic       dp M x + T3[x, x, x]/6 = 0          x ~ s, dp ~ s^2    they vanish (a symmetry); M = T2[., x, dp]
    fold        a01 dp + T2[x, x]/2 = 0             x ~ s, dp ~ s^2    F_p is not in the range of F_u
"""

from __future__ import annotations

import numpy as np

from contin.errors import InputError
from contin.machine import elementary
from contin.normalforms.branching import Direction
from contin.normalforms.jet import Real
from contin.normalforms.polynomial_roots import SINGULAR, Root, distance, sphere_roots
from contin.normalforms.reduction import Reduction
from contin.normalforms.static import StateError, quadratic_error, state, state_lengths

OUTSIDE = 1e-7  # <p, F_p> above this fraction of its summands: F_p is not in the range of F_u
LINK = 0.3  # points of a continuum closer than this are connected (400 starts lie denser, up to a sphere)
SCATTER = 1e-3  # copies of a root closer than this are one
AT_ONCE = 64  # points of a front whose neighbours are looked for together
LARGEST = 8  # dimensions of a kernel; of more, `sphere_roots` has too few starts for up to 3^k branches
CONTINUUM = "solutions form a continuum (a continuous symmetry): one representative"
REPEATED = "repeated direction: higher orders decide whether it is one branch, several or none"


class LargeKernelError(InputError, np.linalg.LinAlgError):
    """A kernel of more dimensions than branches are looked for in."""


def require_countable(k: int) -> None:
    """Raises `LargeKernelError` where the branches of a reduced equation of k unknowns could not all be found."""
    if k > LARGEST:
        raise LargeKernelError(
            f"a kernel of dimension {k} has up to 3^{k} branches, which are not looked for beyond dimension {LARGEST}"
        )


def multiple_directions(r: Reduction, *, state_error: StateError = None) -> list[Direction]:
    """All branches at a branch point with a k-dimensional kernel; curves, so one for each pair +-x.

    Primary is the branch along which the parameter moves with speed and the kernel stays nearest to rest.
    """
    require_countable(r.k)
    scaling = scaling_of(r, state_error)
    if scaling == "fold":
        return _fold(r)
    return _cubic(r) if scaling == "cubic" else _quadratic(r)


def scaling_of(r: Reduction, state_error: StateError = None) -> str:
    """Which of the three scalings holds: 'fold', 'quadratic' or 'cubic'."""
    if np.any(np.abs(r.a01) > _slope_error(r, state_error)):
        return "fold"
    quadratic = np.abs(r.T2[:, : r.k, : r.k])
    errors = [max(quadratic_error(r.jet, r.left[:, j], q, q, state_error) for q in r.right.T) for j in range(r.k)]
    return "cubic" if np.all(quadratic.max(axis=(1, 2)) <= 2.0 * np.array(errors)) else "quadratic"


def _slope_error(r: Reduction, state_error: StateError) -> Real:
    """Estimated error of a01 = <p, F_p>: cancellation over the components, and what an error of u0 makes through F_up.

    Where F_p is nothing but rounding (u0 does not move with the parameter), only the second tells that it is zero.
    """
    jet, move = r.jet, np.eye(r.jet.n + 1)[-1]
    summands = np.abs(r.left.T) @ np.abs(jet.form(move))
    lengths, eye = state_lengths(jet, state_error), np.eye(jet.n)
    mixed = np.array([jet.form(state(jet, eye[i]), move) for i in range(jet.n)])  # (n, n): row i is F_up e_i
    return np.asarray(OUTSIDE * summands + np.abs(mixed @ r.left).T @ lengths)


def _quadratic(r: Reduction) -> list[Direction]:
    """Roots of T2[y, y] = 0; y2 across y solves T2[y, y2] = -T3[y, y, y]/6."""
    k = r.k
    unit = np.ones(k + 1)
    unit[-1] = _ratio(r.T2[:, :k, :k], r.T2[:, :k, k])  # dp = unit[-1] eta: both kinds of terms of one size
    T2 = r.T2 * unit[:, None] * unit
    T2 = T2 / np.abs(T2).max()

    def equations(y: Real) -> tuple[Real, Real]:
        return np.einsum("aij,si,sj->sa", T2, y, y), 2.0 * np.einsum("aij,sj->sai", T2, y)

    roots = sphere_roots(equations, np.ones(k + 1), -np.ones(k + 1))
    found = []
    for root, note in _representatives(roots, 2**k, -np.ones(k + 1)):
        y = root.y * unit
        y = np.where(np.abs(root.y) < 1e-9, 0.0, y)
        y = y / np.linalg.norm(y @ r.lifted)
        cubic = np.einsum("aijk,i,j,k->a", r.T3, y, y, y)
        system = np.vstack([np.einsum("aij,j->ai", r.T2, y), y / elementary.square(unit)])
        y2 = np.linalg.lstsq(system, np.append(-cubic / 6.0, 0.0), rcond=1e-10)[0]
        found.append(_direction(r, y, y2, note))
    return _ordered(found)


def _cubic(r: Reduction) -> list[Direction]:
    """The branch x = -M^-1 a02 dp/2 and the roots of dp M x + T3[x, x, x]/6 = 0."""
    k = r.k
    M = r.T2[:, :k, k]
    cubic = r.T3[:, :k, :k, :k]
    size_m, size_c = float(np.abs(M).max()), float(np.abs(cubic).max()) / 6.0
    trunk = np.append(np.linalg.lstsq(M, -0.5 * r.T2[:, k, k], rcond=1e-10)[0], 1.0)
    trunk = trunk / np.linalg.norm(trunk @ r.lifted)
    vanishing = size_c == 0.0 or np.linalg.svd(M, compute_uv=False)[-1] <= SINGULAR * size_m
    found = [_direction(r, trunk, _trunk_bend(r, trunk), REPEATED if vanishing else "")]
    if size_m == 0.0 or size_c == 0.0:
        return found
    M_unit, C_unit = M / size_m, cubic / (6.0 * size_c)

    def equations(y: Real) -> tuple[Real, Real]:
        x, d = y[:, :k], y[:, k]
        cx = np.einsum("aijl,si,sj,sl->sa", C_unit, x, x, x)
        slope = 3.0 * np.einsum("aijl,sj,sl->sai", C_unit, x, x) + d[:, None, None] * M_unit
        mx = x @ M_unit.T
        return cx + d[:, None] * mx, np.concatenate([slope, mx[:, :, None]], axis=2)

    mirror = np.append(-np.ones(k), 1.0)
    roots = sphere_roots(equations, np.append(np.ones(k), 0.0), mirror)
    for root, note in _representatives(roots, 3**k, mirror):
        x = np.where(np.abs(root.y[:k]) < 1e-9, 0.0, root.y[:k])
        y = np.append(x / np.linalg.norm(x @ r.right.T), 0.0)
        stretch = float(np.sum(y[:k] * y[:k])) / float(x @ x)
        y2 = np.append(np.zeros(k), root.y[k] * size_c / size_m * stretch)
        found.append(_direction(r, y, y2, note))
    return found[:1] + _signed(found[1:])


def _fold(r: Reduction) -> list[Direction]:
    """Curves with T2[x, x] parallel to a01; dp = -s^2 <a01, T2[x, x]>/(2 |a01|^2)."""
    k = r.k
    across = np.linalg.svd(r.a01[None, :])[2][1:]  # normal to a01
    B = np.einsum("ba,aij->bij", across, r.T2[:, :k, :k])
    size = float(np.abs(B).max())
    if size == 0.0:
        return []
    B = B / size

    def equations(y: Real) -> tuple[Real, Real]:
        return np.einsum("aij,si,sj->sa", B, y, y), 2.0 * np.einsum("aij,sj->sai", B, y)

    found = []
    for root, note in _representatives(sphere_roots(equations, np.ones(k), -np.ones(k)), 2**k, -np.ones(k)):
        x = root.y / np.linalg.norm(root.y @ r.right.T)
        bend = -0.5 * float(r.a01 @ np.einsum("aij,i,j->a", r.T2[:, :k, :k], x, x)) / float(r.a01 @ r.a01)
        found.append(_direction(r, np.append(x, 0.0), np.append(np.zeros(k), bend), note))
    return _signed(found)


def _trunk_bend(r: Reduction, y: Real) -> Real:
    """x2 of the branch that moves with the parameter: T2[y, (x2, 0)] = -T3[y, y, y]/6."""
    cubic = np.einsum("aijk,i,j,k->a", r.T3, y, y, y)
    system = np.einsum("aij,j->ai", r.T2, y)[:, : r.k]
    return np.append(np.linalg.lstsq(system, -cubic / 6.0, rcond=1e-10)[0], 0.0)


def _ratio(a: Real, b: Real) -> float:
    top, bottom = float(np.abs(a).max()), float(np.abs(b).max())
    return top / bottom if top > 0.0 and bottom > 0.0 else 1.0


def _representatives(roots: list[Root], most: int, mirror: Real) -> list[tuple[Root, str]]:
    """Isolated roots, and one of each connected continuum (recognised by more loose roots than Bezout's number).

    Newton's method leaves copies of a repeated root scattered about it, as it converges linearly there.
    """
    isolated = [(root, "") for root in roots if root.free == 0]
    loose = _first_of_groups([root for root in roots if root.free > 0], SCATTER, mirror)
    if len(loose) <= most:
        return isolated + [(root, REPEATED) for root in loose]
    return isolated + [(root, CONTINUUM) for root in _first_of_groups(loose, LINK, mirror)]


def _first_of_groups(roots: list[Root], link: float, mirror: Real) -> list[Root]:
    """One root, the first, of each group that is connected by steps shorter than `link`."""
    points = np.array([root.y for root in roots])
    first = []
    left = np.arange(len(roots))
    while left.size:
        front, left = left[:1], left[1:]
        first.append(roots[front[0]])
        while front.size and left.size:
            here, front = points[front[:AT_ONCE]], front[AT_ONCE:]
            near = np.any(distance(points[left, None], here, mirror) < link, axis=1)
            front, left = np.append(front, left[near]), left[~near]
    return first


def _direction(r: Reduction, y: Real, y2: Real, note: str) -> Direction:
    tangent, curvature = r.predictor(y, y2)
    return Direction(tangent, curvature, bool(y[-1] == 0.0), False, note)


def _signed(found: list[Direction]) -> list[Direction]:
    """Each tangent with its first component of largest modulus positive: the sign of a +- pair is fixed."""
    signed = []
    for d in found:
        size = np.abs(d.tangent)
        lead = d.tangent[int(np.argmax(size >= (1.0 - 1e-6) * size.max()))]
        signed.append(Direction(d.tangent if lead > 0 else -d.tangent, d.curvature, d.vertical, d.primary, d.note))
    return signed


def _ordered(found: list[Direction]) -> list[Direction]:
    """The branch most aligned with the parameter first; tangents point to growing parameter."""
    up = [
        Direction(d.tangent if d.tangent[-1] > 0 else -d.tangent, d.curvature, d.vertical, d.primary, d.note)
        if d.tangent[-1] != 0.0
        else _signed([d])[0]
        for d in found
    ]
    return sorted(up, key=lambda d: -abs(d.tangent[-1]))
