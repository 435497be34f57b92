"""A user's rotation u' = G u of a function's states, and the mode that a frame turns with.

With y^T G = i w y^T (w > 0) the number z = y^T u turns as z' = i w z, whatever the rest of the state does: the phase of
a state is arg z, defined where its mode z is not 0 (the first-Fourier-mode slice of Budanur, Cvitanovic, Davidchack
and Siminos, Phys. Rev. Lett. 114 (2015) 084102, with the mode that is largest).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array, Vector
from contin.errors import InputError
from contin.linalg.vectors import dot, norm
from contin.machine import elementary

LARGEST: Final = 1000  # states that a block of G mixes, up to which its modes are computed
ROUNDING: Final = 1e-8  # of the largest rate: real parts of eigenvalues, and rates that are one
KEPT: Final = 1e-9  # of the rate of a random state: one that turns more slowly is kept by the rotation


@dataclass(frozen=True, eq=False)
class Mode:
    """The covectors a, b (n,) and the rate w of a mode z = (a + i b) u: z' = i w z along the rotation."""

    a: Array
    b: Array
    rate: float

    def value(self, u: Array) -> NDArray[np.complex128]:
        """z of states (..., n)."""
        return np.asarray(u @ self.a + 1j * (u @ self.b))


@dataclass(frozen=True, eq=False)
class Rotation:
    """G (n, n): an array, a sparse matrix or a `LinearOperator`; `like` (n,): a wave of one mode, where it is given."""

    generator: Any
    n: int
    like: Array | None = None

    @classmethod
    def of(cls, given: Any, n: int) -> Rotation:
        """From G, or a pair (G, like). Raises InputError where they are none."""
        from scipy.sparse import csr_matrix, issparse
        from scipy.sparse.linalg import LinearOperator

        generator, like = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
        if not isinstance(generator, LinearOperator):
            try:
                generator = csr_matrix(generator if issparse(generator) else np.asarray(generator, dtype=float))
            except (TypeError, ValueError) as error:
                raise InputError(f"rotation must be a matrix G of u' = G u, or a pair (G, wave): {error}") from None
        if generator.shape != (n, n):
            raise InputError(f"rotation must be a matrix ({n}, {n}), of u' = G u; got {generator.shape}")
        if like is not None:
            like = np.asarray(like, dtype=float).ravel()
            if like.shape != (n,) or not np.all(np.isfinite(like)):
                raise InputError(f"rotation: the wave must have {n} finite components; got {like.size}")
        return cls(generator, n, like)

    def along(self, u: Vector) -> Vector:
        """G u, real or complex."""
        if np.iscomplexobj(u):
            return np.asarray(self.generator @ u.real) + 1j * np.asarray(self.generator @ u.imag)
        return np.asarray(self.generator @ u)

    @cached_property
    def rate(self) -> float:
        """The rate at which a random state turns."""
        u = np.random.default_rng(1).normal(size=self.n)
        return norm(self.along(u)) / norm(u)

    def moves(self, u: Array) -> bool:
        """False for a state that the rotation keeps."""
        return norm(self.along(u)) > KEPT * self.rate * norm(u)

    def turned(self, u: Array, angle: float) -> Array:
        """exp(angle G) u."""
        from scipy.sparse.linalg import expm_multiply

        return np.asarray(u if angle == 0.0 else expm_multiply(angle * self.generator, u, traceA=0.0))

    def mode_of(self, states: Array) -> Mode:
        """The mode for states (K, n).

        Of one state the largest; of an orbit's samples that in whose frame they close best (a mode of twice the slowest
        rate leaves half a turn open), of like ones the largest where it is smallest.
        """
        if self.like is not None:
            return self._given(self.like)
        best, least = None, (np.inf, 0.0)
        for rate, basis in self._modes():
            parts = states @ basis
            direction = np.linalg.svd(parts, full_matrices=False)[2][0].conj()
            smallest = float(np.abs(parts @ direction).min())
            if not smallest > KEPT * norm(states[0]):
                continue
            mode = _with_one_phase(basis @ direction, rate)
            gap = 0.0
            if len(states) > 1:
                ends = self.in_phase(states[[0, -1]], mode, np.unwrap(elementary.angle(mode.value(states)))[[0, -1]])
                gap = norm(ends[1] - ends[0])
            if gap < 0.5 * least[0] or (gap <= 2.0 * least[0] and smallest > least[1]):
                best, least = mode, (gap, smallest)
        if best is None:
            raise InputError("rotation: no mode of it is other than 0 in the start")
        return best

    def in_phase(self, states: Array, mode: Mode, phases: Array | None = None) -> Array:
        """States (K, n) turned back by their phases, which go on from one to the next."""
        phases = np.unwrap(elementary.angle(mode.value(states))) if phases is None else phases
        return np.array([self.turned(u, -float(x) / mode.rate) for u, x in zip(states, phases, strict=True)])

    def _given(self, like: Array) -> Mode:
        """<w, u>/|w| + i <G w, u>/|G w| of a wave w with G G w = -c w and G^T w = -G w."""
        turned = self.along(like)
        size = norm(turned)
        rate = size / norm(like) if like.any() else 0.0
        if not size > KEPT * self.rate * norm(like):
            raise InputError("rotation: the given wave is not moved by it")
        gap = norm(self.along(turned) + rate * rate * like)
        if gap > ROUNDING * rate * size:
            raise InputError(
                "rotation: the given wave is not of one mode, G G w = -c w (a sine along the circle is): its two sides "
                f"differ by {gap / (rate * size):.1g} of their size"
            )
        u = np.random.default_rng(4).normal(size=self.n)
        there = self.along(u)
        if abs(dot(like, there) + dot(turned, u)) > ROUNDING * (norm(like) * norm(there) + size * norm(u)):
            raise InputError(
                "rotation: on a given wave G must be skew-symmetric, <w, G u> = -<G w, u>: give none"
            )
        return Mode(like / norm(like), turned / size, rate)

    def _modes(self) -> Iterator[tuple[float, Vector]]:
        """Rates w > 0, each with an orthonormal basis (n, k) of the y with y^T G = i w y^T."""
        found = list(self._by_blocks)
        found.sort(key=lambda one: one[0])
        top = found[-1][0] if found else 0.0
        while found:
            rate = found[0][0]
            alike = [one for one in found if one[0] - rate <= ROUNDING * top]
            found = found[len(alike) :]
            columns = np.zeros((self.n, len(alike)), complex)
            for k, (_, places, y) in enumerate(alike):
                columns[places, k] = y
            yield rate, np.linalg.qr(columns)[0]

    @cached_property
    def _by_blocks(self) -> list[tuple[float, Any, Vector]]:
        """(w, places, y[places]) of every block of states that G mixes."""
        from scipy.sparse.csgraph import connected_components
        from scipy.sparse.linalg import LinearOperator

        if isinstance(self.generator, LinearOperator):
            raise InputError("rotation: a LinearOperator needs a wave of one mode beside it: rotation=(G, wave)")
        found: list[tuple[float, Any, Vector]] = []
        count, labels = connected_components(self.generator, directed=True, connection="weak")
        order = np.argsort(labels, kind="stable")
        for places in np.split(order, np.cumsum(np.bincount(labels, minlength=count))[:-1]):
            if len(places) > LARGEST:
                raise InputError(
                    f"rotation: G mixes {len(places)} states, of which modes are computed up to {LARGEST}: give a wave "
                    "of one mode beside it, such as a sine along the circle: rotation=(G, wave)"
                )
            block = self.generator[places][:, places].toarray()
            values, vectors = np.linalg.eig(block.T)
            if np.any(np.abs(values.real) > ROUNDING * max(float(np.abs(values).max(initial=0.0)), 1e-300)):
                raise InputError("rotation: G has eigenvalues off the imaginary axis: exp(t G) does not return")
            for k in np.flatnonzero(values.imag > ROUNDING * float(np.abs(values).max(initial=0.0))):
                found.append((float(values[k].imag), places, vectors[:, k]))
        return found


def _with_one_phase(y: Vector, rate: float) -> Mode:
    """The mode y, of one phase for all starts."""
    first = y[int(np.flatnonzero(np.abs(y) > 0.5 * np.abs(y).max())[0])]
    y = y * (np.abs(first) / first) / norm(np.abs(y))
    return Mode(y.real.copy(), y.imag.copy(), rate)
