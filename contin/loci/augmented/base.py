"""What a curve of special solutions asks of the equations that it rests on."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.loci.augmented.elimination import Bordered, Scalars


class OfSolutions(Protocol):
    """The problem that the equations are taken from."""

    @property
    def system(self) -> Any: ...
    @property
    def formulas(self) -> object: ...

    def constants(self) -> dict[str, float]: ...

    def default_range(self, parameter: str) -> tuple[float, float] | None: ...


class Base(ABC):
    """Equations E(z) = 0, z = (unknowns, parameters, the last one first), fewer than unknowns.

    Where the points are special by themselves (folds, ...), E holds the scalars that say so, too.
    """

    has_stability = True

    if TYPE_CHECKING:  # a field of each

        @property
        def problem(self) -> OfSolutions:
            """The problem whose equations are taken."""

    @property
    def system(self) -> Any:
        """The compiled model."""
        return self.problem.system

    @property
    @abstractmethod
    def angle_periods(self) -> Array: ...

    @property
    @abstractmethod
    def identifying(self) -> NDArray[np.bool_]: ...

    @property
    @abstractmethod
    def growing(self) -> NDArray[np.bool_]: ...

    def constants(self) -> dict[str, float]:
        return self.problem.constants()

    def default_range(self, parameter: str) -> tuple[float, float] | None:
        return self.problem.default_range(parameter)

    @property
    @abstractmethod
    def names(self) -> tuple[str, ...]:
        """Of the varying parameters, which stand behind the unknowns of the solution, the last unknown first."""

    @property
    def varying(self) -> int:
        return len(self.names)

    @property
    @abstractmethod
    def conditions(self) -> int:
        """How many of the parameters it takes to meet E: none for solutions themselves, one for folds, ..."""

    @abstractmethod
    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        """The metric; ranges of the parameters, the last unknown first."""

    @property
    def gauge(self) -> Any:
        """What is chosen for a stretch of a curve (borders, the orbit of a phase condition); most have nothing."""
        return None

    @property
    def is_settled(self) -> bool:
        """True where all is chosen that there is to choose."""
        return True

    def gauged(self, gauge: Any) -> Self:
        """The same equations with what was chosen elsewhere, if anything was."""
        return self

    def settled(self, z: Array, scale: Array) -> Self:
        """The same equations with borders that fit at z, upon which nothing depends but the signs of tests."""
        return self

    @abstractmethod
    def linearise(self, z: Array, scale: Array, rows: Array) -> Bordered | None:
        """E and E' with these rows below it; None where they are not finite."""

    @abstractmethod
    def columns(self, z: Array) -> dict[str, Array]: ...

    def column(self, name: str, z: Array) -> Array:
        """One of them; without the others where these cost more."""
        return self.columns(z)[name]

    @abstractmethod
    def column_names(self) -> tuple[str, ...]: ...

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on, the number of unstable eigenvalues without the critical ones, and all of them."""
        return np.zeros(0), 0, np.zeros(0, complex)

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return ()

    def test_of(self, curve: str, type_: str) -> int | None:
        return None

    def types(self, curve: str) -> Sequence[str]:
        """The types of points that are looked for on a curve."""
        return ()

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        """The function that vanishes at a point of this type on a curve, around a sample; or why there is none."""
        return f"{type_} is not looked for on curves of {curve}"

    def described(self, type_: str, point: Verified, scale: Array) -> Outcome:
        """A point with eigenvalues and normal form."""
        return point

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return values

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        return None

    def corrected(self, z: Array) -> Self:
        """Equations that are nearer to what is meant than these (which hold on truncated ones, say), by solution z."""
        return self

    def touching(self, curve: Any, z: Array, frame: Frame) -> Verified | None:
        """The point of another type that a supposed cusp z of `curve` is, where it touches another one."""
        return None

    def remarks(self, curve: Problem, z: Array) -> Sequence[str]:
        """Notes on the whole curve with rows z."""
        return ()

    def describe_failure(self, z: Array) -> str:
        return ""
