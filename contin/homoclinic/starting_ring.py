"""Points beside a saddle at which trajectories along its unstable manifold start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.homoclinic.guesses import LEAVING
from contin.machine import elementary

ANGLES: Final = 128


@dataclass(frozen=True, eq=False)
class Ring:
    """Offsets, of length one along the slowest direction, from which trajectories part evenly when they are far away.

    A faster direction of rate r begins with LEAVING^(r/slowest), so that all have grown alike at a distance of one.
    """

    basis: list[Array]

    @classmethod
    def of(cls, values: NDArray[np.complex128], vectors: NDArray[np.complex128]) -> Ring:
        order = np.argsort(values.real)
        slowest = float(values[order[0]].real)
        basis = []
        for k in order:
            if values[k].imag < 0.0:
                continue
            weight = float(elementary.pow(LEAVING, float(values[k].real) / slowest - 1.0))
            parts = [vectors[:, k].real] if values[k].imag == 0.0 else [vectors[:, k].real, vectors[:, k].imag]
            basis += [weight * part / np.linalg.norm(part) for part in parts]
        return cls(basis)

    @property
    def is_circle(self) -> bool:
        """Both senses of a line otherwise."""
        return len(self.basis) > 1

    @property
    def angles(self) -> list[float]:
        count = ANGLES if self.is_circle else 2
        return [2.0 * np.pi * k / count for k in range(count)]

    def offset(self, angle: float) -> Array:
        """(n,)"""
        along = float(elementary.cos(angle)) * self.basis[0]
        return along + float(elementary.sin(angle)) * self.basis[1] if self.is_circle else along
