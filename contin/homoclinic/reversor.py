"""Reversible flows, f(R u) = -R f(u) with R u = A u + c an involution, and orbits that R maps onto themselves.

A symmetric orbit crosses the fixed space of R, {u = R u}, once; half of it is solved for, from the saddle to there:

    L(x0)^T (u(0) - x0) = 0,      M u(1) = d

with M u = d the fixed space (M with orthonormal rows). The other half is its image, in the reversed sense of time.
Without a phase condition: such a half is isolated on the unstable manifold. (Vanderbauwhede and Fiedler 1992;
Champneys 1998.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array
from contin.errors import InputError
from contin.model.evaluate import evaluate_all
from contin.model.expression import Expression, symbol
from contin.problems.orbits.mesh.layout import Profile

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

SAMPLES: Final = 12
TRIES: Final = 40
EXACT: Final = 1e-8  # of the larger side, by which the equations may miss reversibility


@dataclass(frozen=True, eq=False)
class Reversor:
    """R u = matrix @ u + shift, and its fixed space rows @ u = value, (m, n) and (m,)."""

    matrix: Array
    shift: Array
    rows: Array
    value: Array

    @classmethod
    def of(cls, matrix: Array, shift: Array) -> Reversor:
        left, sizes, right = np.linalg.svd(np.eye(len(shift)) - matrix)
        count = int(np.sum(sizes > 1e-9))
        rows = right[:count]
        return cls(matrix, shift, rows, (left[:, :count].T @ shift) / sizes[:count])

    def image(self, u: Array) -> Array:
        """Of states in rows (or one)."""
        return np.asarray(u @ self.matrix.T + self.shift)

    def missed(self, u: Array, sizes: Array) -> Array:
        """By how much states (..., n) miss the fixed space, (..., m), in units of the states' sizes."""
        return np.asarray((u @ self.rows.T - self.value) / self.lengths(sizes))

    def lengths(self, sizes: Array) -> Array:
        """Natural sizes of the rows (m,)."""
        return np.asarray(np.abs(self.rows) @ sizes)

    def whole(self, half: Profile) -> Profile:
        """The orbit with its image."""
        u = np.vstack([half.u, self.image(half.u[-2::-1])])
        return replace(half, u=u, period=2.0 * half.period, h=0.5 * np.concatenate([half.h, half.h[::-1]]))


def reversor_of(system: CompiledSystem, p: Array, images: Mapping[str, Expression]) -> Reversor:
    """From formulas for the images of states (others stay as they are), checked against the equations at p.

    Raises InputError: not affine, no involution, or the flow is not reversible with it, with the equation that fails.
    """
    names, n = list(system.state_names), system.n
    known = dict(zip(system.parameter_names, (float(x) for x in p), strict=False))
    formulas = [images.get(name, symbol(name)) for name in names]

    def at(u: Array) -> Array:
        return np.array(evaluate_all(formulas, known | dict(zip(names, map(float, u), strict=True))), dtype=float)

    shift = at(np.zeros(n))
    matrix = np.stack([at(unit) - shift for unit in np.eye(n)], axis=1)
    generator = np.random.default_rng(5)
    for u in generator.normal(size=(3, n)):
        if not np.allclose(at(u), matrix @ u + shift, rtol=1e-9, atol=1e-12 * (1.0 + float(np.abs(shift).max()))):
            raise InputError("reversor: each image must be linear in the states (with constants added)")
    twice = np.abs(matrix @ matrix - np.eye(n)).max(), np.abs(matrix @ shift + shift).max()
    if max(twice) > 1e-9 * (1.0 + float(np.abs(shift).max())):
        raise InputError("reversor: it must be an involution: applied twice, every state is itself again")
    found = Reversor.of(matrix, shift)
    if not len(found.rows) or len(found.rows) == n:
        raise InputError("reversor: its fixed space must be neither everything nor a point")
    _check(system, p, found, generator)
    return found


def _check(system: CompiledSystem, p: Array, reversor: Reversor, generator: np.random.Generator) -> None:
    """f(R u) = -A f(u) at random states."""
    done = 0
    for attempt in range(TRIES):
        u = (1.0 if attempt < TRIES // 2 else 0.1) * generator.normal(size=system.n)
        here, there = (np.asarray(system.value(v, p)) for v in (u, reversor.image(u)))
        if not (np.all(np.isfinite(here)) and np.all(np.isfinite(there))):
            continue
        expected = -reversor.matrix @ here
        gap = np.abs(there - expected) / np.maximum(np.maximum(np.abs(there), np.abs(expected)), 1e-9)
        worst = int(np.argmax(gap))
        if gap[worst] > EXACT:
            raise InputError(
                f"reversor: the flow is not reversible with it: the equation of {system.state_names[worst]} gives "
                f"{there[worst]:.6g} at the image of a state, where {expected[worst]:.6g} is needed"
            )
        done += 1
        if done == SAMPLES:
            return
