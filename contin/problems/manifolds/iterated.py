"""A one-dimensional manifold of a fixed point of a map or of a forced flow's stroboscopic map, grown by arclength.

With v the eigenvector and m the multiplier (of F^2 where that of F is negative), the points u0 + d v |m|^r, r in
[0, 1), make a fundamental piece, and its k-th image is the next piece but k: a point of the curve has one coordinate
k + r. Steps in it are halved until successive chords turn by less than ANGLE and angle times length stays below BEND of
the length (Hobson, J. Comput. Phys. 104 (1993) 14); chords of SHARP of the length may turn at will. A stable manifold
is grown by the inverse: of formulas solved for by Newton's method, of a flow its trajectories back in time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np

from contin.abi import Array
from contin.linalg.newton import Rules, newton, solution
from contin.linalg.vectors import norm
from contin.machine import elementary
from contin.problems.manifolds.eigenspace import Eigenspace

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

DELTA: Final = 1e-6  # of the length: the fundamental piece's distance from the fixed point
ANGLE: Final = 0.2  # radians
BEND: Final = 2e-4
LARGEST_STEP: Final = 0.02  # of the length
SHARP: Final = 1e-5  # of the length: chords that may turn by any angle, at the tip of a fold
SMALLEST: Final = 1e-9  # step in the coordinate
MOST: Final = 20_000  # points of a branch
NEWTON: Final = Rules(settled=1e-13, stalled=1e-13, budget=20)


@dataclass(frozen=True, eq=False)
class Grown:
    """One branch: arclengths (K,) and states (K, n) from the fixed point on; why it ended, '' at its length."""

    s: Array
    u: Array
    trouble: str


class Mapping(Protocol):
    """A map of states and its inverse: None where there is no image."""

    def image(self, u: Array) -> Array | None: ...

    def preimage(self, u: Array) -> Array | None: ...


@dataclass(frozen=True, eq=False)
class MapCurve:
    """The manifold of the fixed point u0 of a map."""

    mapping: Mapping
    u0: Array
    space: Eigenspace
    length: float
    stable: bool

    def branch(self, sense: float) -> Grown:
        """The branch that leaves along sense * v."""
        multiplier = complex(self.space.values[0]).real
        twice = multiplier < 0.0
        growth = elementary.square(multiplier) if twice else abs(multiplier)
        growth = 1.0 / growth if self.stable else growth
        at, d, v = 0.0, DELTA * self.length, sense * self.space.basis[:, 0]
        moved = self.mapping.preimage if self.stable else self.mapping.image

        def point(x: float) -> Array | None:
            k = int(np.floor(x))
            u: Array | None = self.u0 + d * float(elementary.pow(growth, x - k)) * v
            for _ in range(k * (2 if twice else 1)):
                u = None if u is None else moved(u)
            return u

        points, lengths, step, trouble = [self.u0 + d * v], [d], 0.1, ""
        chord = v
        while lengths[-1] < self.length and len(points) < MOST:
            new = point(at + step)
            if new is not None:
                move = new - points[-1]
                size = float(np.linalg.norm(move))
                turn = float(elementary.acos(np.clip(move @ chord / max(size, 1e-300), -1.0, 1.0)))
                straight = turn < ANGLE and turn * size < BEND * self.length
                good = size < LARGEST_STEP * self.length and (straight or size < SHARP * self.length)
                if good and size > 0.0:
                    points.append(new)
                    lengths.append(lengths[-1] + size)
                    chord, at = move / size, at + step
                    easy = turn < 0.5 * ANGLE and size < 0.5 * LARGEST_STEP * self.length
                    step = min(0.1, 1.5 * step) if easy else step
                    continue
            step *= 0.5
            if step < SMALLEST:
                trouble = "its next point cannot be computed" if new is None else "rounding tells no further points"
                break
        if len(points) >= MOST:
            trouble = f"it took {MOST} points"
        return Grown(np.array(lengths), np.array(points), trouble)


@dataclass(frozen=True, eq=False)
class MapOfFormulas:
    """A model's map at p beside its fixed point u0; `size` is a length to which pre-images are relative."""

    system: CompiledSystem
    u0: Array
    p: Array
    size: float

    def image(self, u: Array) -> Array | None:
        image: Array = np.asarray(self.system.value(u, self.p))
        return image if np.all(np.isfinite(image)) else None

    def preimage(self, u: Array) -> Array | None:
        n = len(u)
        x = self.u0 + np.linalg.solve(self._linear, u - self.u0)

        def correct(x: Array) -> tuple[float, Array] | None:
            f, jacobian = self.system.jacobian(x, self.p)
            step = solution(np.asarray(jacobian)[:, :n], u - np.asarray(f))
            return None if step is None else (norm(step) / max(norm(x + step), DELTA * self.size), x + step)

        found = newton(correct, x, NEWTON)  # None: no pre-image is found from here; the manifold ends, in words
        return None if found is None else found.at

    @property
    def _linear(self) -> Array:
        return np.asarray(self.system.jacobian(self.u0, self.p)[1])[:, : len(self.u0)]
