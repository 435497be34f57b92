"""Rings of pitchfork cells: at the first symmetry-breaking point a circle of directions solves the leading equations.

u_k' = p u_k - u_k^3 + c (u_k+1 + u_k-1 - 2 u_k), k mod n: the wave number 1 becomes unstable at p = 2 c (1 - cos(2 pi
/n)) with a kernel of dimension 2. The symmetry D_n x Z_2 (u -> -u) makes the angular equation ~ sin(m t) with m = n for
even n and 2 n for odd n, from order m - 1 on (4 for n = 4, which is cubic): m branches, 2 m halves, one of each
direction with a reflection (Golubitsky, Stewart and Schaeffer 1988, ch. XIII.5).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import contin

COUPLING = 0.2


@dataclass(frozen=True)
class Ring:
    """The ring in coordinates u = size Q v, Q orthogonal."""

    cells: int
    size: float = 1.0
    seed: int | None = None  # of Q; None: no rotation

    @property
    def at(self) -> float:
        """The branch point."""
        return float(2.0 * COUPLING * (1.0 - np.cos(2.0 * np.pi / self.cells)))

    @property
    def far(self) -> float:
        """Where the branches are large: those of many cells are told apart there only; four have others from 1.5 on."""
        return (1.4 if self.cells == 4 else 1.9) * self.at

    @property
    def branches(self) -> int:
        """How many cross the trivial one there."""
        return self.cells if self.cells % 2 == 0 else 2 * self.cells

    @property
    def matrix(self) -> np.ndarray:
        if self.seed is None:
            return self.size * np.eye(self.cells)
        random = np.random.default_rng(self.seed).normal(size=(self.cells, self.cells))
        return self.size * np.linalg.qr(random)[0]

    def model(self, at: float) -> contin.Model:
        n, matrix = self.cells, self.matrix
        inverse = np.linalg.inv(matrix)
        cells = {f"u{k}": _sum(matrix[k], [f"v{j}" for j in range(n)]) for k in range(n)}
        fields = {f"f{k}": f"p*u{k} - u{k}^3 + {COUPLING}*(u{(k + 1) % n} + u{(k - 1) % n} - 2*u{k})" for k in range(n)}
        equations = {f"v{j}": _sum(inverse[j], list(fields)) for j in range(n)}
        return contin.Model(
            "ring", states=dict.fromkeys(equations, 0.0), parameters={"p": at}, definitions={**cells, **fields},
            equations=equations,
        )  # fmt: skip

    def diagram(self):
        """From below the branch point to where the branches are large; secondary branch points are not followed."""
        bounds = (0.5 * self.at, self.far)
        start = dict.fromkeys((f"v{k}" for k in range(self.cells)), 0.0)
        return contin.diagram(
            self.model(bounds[0]), "p", bounds, start=start, budget={"branches": 1 + self.branches}
        )  # fmt: skip

    def cells_of(self, states: np.ndarray) -> np.ndarray:
        return np.asarray(states @ self.matrix.T)


def _sum(weights: np.ndarray, names: list[str]) -> str:
    return " + ".join(f"({float(w)!r})*{name}" for w, name in zip(weights, names, strict=True) if w != 0.0)
