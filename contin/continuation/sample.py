"""Points of a curve, and what a march gives: rows, and why it stopped."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contin.abi import Array


class Stop(Enum):
    """Why a march returned, in the order of the kernels' codes (`contin.kernels.algebraic`).

    On EVENT, DIP, BOUND, LOOP and CORNER the last row lies beyond what was seen.
    """

    LIMIT = "limit"
    EVENT = "event"
    DIP = "dip"
    BOUND = "bound"
    CORRECTOR = "corrector"
    NOT_FINITE = "not finite"
    RESCALE = "rescale"
    LOOP = "loop"
    CORNER = "corner"


STOPS: Final = tuple(Stop)  # by the code that a kernel returns


def opposite(a: ArrayLike, b: ArrayLike) -> Any:
    """Where a and b differ in sign, neither of them zero; a product would leave the range of numbers in some units."""
    return np.sign(a) * np.sign(b) < 0.0


@dataclass(frozen=True, eq=False, init=False)
class Sample:
    """A point of the curve with all that is measured there."""

    z: Array  # (N,) unknowns, the varying parameter last
    tangent: Array  # (N,) unit tangent in scaled unknowns
    tests: Array  # (k,) test functions; a sign change is an event
    unstable: int  # eigenvalues or multipliers on the unstable side
    eigenvalues: NDArray[np.complex128]

    def __init__(
        self, z: Array, tangent: Array, tests: Array, unstable: int, eigenvalues: NDArray[np.complex128]
    ) -> None:
        own = self.__dict__  # every point that is looked at is one: a third of the time of a frozen class's own way
        own["z"], own["tangent"], own["tests"], own["unstable"] = z, tangent, tests, unstable
        own["eigenvalues"] = eigenvalues


@dataclass(frozen=True, eq=False)
class Chunk:
    """Rows 0 .. m of a march (row 0 repeats where it began) and why it stopped."""

    z: Array
    tangents: Array
    tests: Array
    unstable: NDArray[np.int64]
    eigenvalues: NDArray[np.complex128]
    lengths: Array  # lengths[k]: the step that led to row k
    stop: Stop
    next_step: float
    reference: float  # normalises the determinant-like test; belongs to this chunk's frame
    dipped: int  # which test dipped, where stop is DIP
    evaluations: int
    detail: str = ""  # in words, where the march failed
    crossed: tuple[int, ...] = ()  # rows of curves in two parameters before which another curve crosses
    gauge: object = None  # see `Frame`; made anew from the rows of a chunk that was kept in a file

    def __len__(self) -> int:
        return len(self.z)

    def sample(self, row: int) -> Sample:
        return Sample(self.z[row], self.tangents[row], self.tests[row], int(self.unstable[row]), self.eigenvalues[row])

    def cut(self, rows: int, stop: Stop, next_step: float) -> Chunk:
        """The first rows, as a march that stopped there would have given them."""
        return replace(
            self, z=self.z[:rows], tangents=self.tangents[:rows], tests=self.tests[:rows],
            unstable=self.unstable[:rows], eigenvalues=self.eigenvalues[:rows], lengths=self.lengths[:rows],
            stop=stop, next_step=next_step,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Frame:
    """A metric (`scale`), with what the equations near a chunk's rows are written with.

    reference : normalises the determinant-like test.  gauge : whatever a problem chooses once for a chunk (borders, the
    orbit of a phase condition, the sense of null vectors): `march` returns it with its rows, and gets that of the chunk
    before, to which signs refer. Without one (None) a problem chooses at the point that it is asked about.
    """

    scale: Array
    reference: float = 0.0
    gauge: object = None
