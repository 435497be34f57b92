"""The parts of equations whose states drive each other, along an orbit, and the multipliers of each part by itself.

Where f_u is block triangular (a state that only follows others, or only drives them), so is the monodromy matrix, and
its eigenvalues are those of its diagonal blocks. The couplings do not enter, however large they are: along a canard
they grow by a hundred powers of ten where the multipliers are of order 1, and a product of matrices loses these.

A part of one state has the multiplier exp(int f_u dt). The part that moves by itself holds the trivial multiplier; of
two states, the other one is exp(int trace f_u dt) (Liouville).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.kernels.collocation_basis import basis
from contin.kernels.floquet import deflate, multipliers
from contin.machine import elementary
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.problems.orbits.linearised.linear import OrbitLinear

LARGEST: Final = 690.0  # of |log mu|, so that mu is a number
AT_REST: Final = 1e-9  # way in a period (relative to the states' sizes) of a state that is constant to rounding

Multipliers = NDArray[np.complex128]


def by_parts(linear: OrbitLinear) -> Multipliers | None:
    """Nontrivial multipliers (n - 1,) of an orbit of autonomous equations, the largest first.

    None where all states drive each other and there are more than two, or where several parts move by themselves.
    """
    profile, derivatives = linear.profile, linear.state_derivatives  # (N, m, n, n)
    driven = np.any(derivatives != 0.0, axis=(0, 1))  # [k, q]: q drives k
    parts = _parts(driven)
    if len(parts) == 1 and profile.n > 2:
        return None
    sizes = linear.problem.state_sizes(profile)
    moving = profile.period * np.max(np.abs(linear.field), axis=0) > AT_REST * sizes
    own = [part for part in parts if moving[part].any() and not moving[_drivers(driven, part)].any()]
    if len(own) != 1:
        return None
    found: list[complex] = []
    for part in parts:
        trivial = part is own[0]
        block = derivatives[:, :, part[:, None], part]
        if len(part) == 1 + trivial:
            found.append(_liouville(profile, block))
        elif len(part) > trivial:
            field = linear.field[: -1 : profile.m][:, part] if trivial else None
            several = _of_product(_transitions(profile, block), field)
            if several is None:
                return None
            found.extend(several)
    values = np.array(found, complex)
    order = np.lexsort((-values.imag, -np.abs(values)))
    return values[order] if np.all(np.isfinite(values)) else None


def _parts(driven: NDArray[np.bool_]) -> list[NDArray[np.intp]]:
    """States that drive each other, directly or through others (strongly connected components)."""
    reached = driven | np.eye(len(driven), dtype=bool)
    while True:  # paths of twice the length
        longer = reached @ reached
        if np.array_equal(longer, reached):
            break
        reached = longer
    together = reached & reached.T
    first = together.argmax(axis=1)  # the first state of each one's part
    return [np.flatnonzero(first == k) for k in range(len(driven)) if first[k] == k]


def _drivers(driven: NDArray[np.bool_], part: NDArray[np.intp]) -> NDArray[np.intp]:
    """The states outside a part that drive it directly."""
    outside = np.asarray(driven[part].any(axis=0))
    outside[part] = False
    return np.flatnonzero(outside)


def _liouville(profile: Profile, block: Array) -> float:
    """exp(T int_0^1 trace f_u), by the quadrature of the collocation points; block (N, m, k, k)."""
    trace = np.trace(block, axis1=2, axis2=3)
    growth = profile.period * float(profile.h @ trace @ basis(profile.m).gauss_weights)
    return float(elementary.exp(np.clip(growth, -LARGEST, LARGEST)))


def _transitions(profile: Profile, block: Array) -> Vector:
    """v(x_(i+1)) = M_i v(x_i) of the collocation equations of v' = T f_u v, (N, k, k)."""
    scheme, (count, m, k, _) = basis(profile.m), block.shape
    rows = -np.einsum("i,cj,ickq->ickjq", profile.h * profile.period, scheme.values, block)
    rows += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(k))
    matrix = rows.reshape(count, m * k, (m + 1) * k)
    inner = np.linalg.solve(matrix[:, :, k:], -matrix[:, :, :k])
    return np.ascontiguousarray(inner[:, -k:])


def _of_product(transitions: Vector, field: Array | None) -> Multipliers | None:
    """Eigenvalues of the product of M_i, without the one of f (N, k) where a field is given."""
    size, skip = transitions.shape[1], 0
    if field is not None:
        skip = 1
        if not np.isfinite(deflate(transitions, np.ascontiguousarray(field))):
            return None
    re, im = (np.full(size - skip, np.nan) for _ in range(2))
    start = np.full((size - skip, size - skip), np.nan)
    return re + 1j * im if multipliers(transitions, skip, start, re, im) else None
