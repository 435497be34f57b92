"""The problem of a point that was read from a file: its names, its orbit, and how its solution is found again."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.errors import InputError


class WithEigenfunctions(Protocol):
    """An orbit with its equations."""

    @property
    def eigenfunctions(self) -> NDArray[np.complex128]: ...


class Computed(Protocol):
    """A labelled point as it was computed, with its equations."""

    @property
    def orbit(self) -> WithEigenfunctions: ...


@dataclass(frozen=True, eq=False)
class StoredProfile:
    """One period of an orbit: `times` in [0, 1], values `u` (times, states)."""

    times: Array
    u: Array
    period: float


@dataclass(frozen=True)
class StoredSystem:
    """The names of the states."""

    state_names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class StoredProblem:
    """The names of a point from a file, and the columns `t` and states of its orbit; it has no equations."""

    kind: str
    parameters: tuple[str, ...]
    where: str
    orbit: Mapping[str, Sequence[float | None]] | None
    solution: Callable[[], Computed] | None = None  # reads the point as it was computed, with its equations

    def computed(self) -> Computed:
        """The point as it was computed; InputError where the file does not have it."""
        if self.solution is None:
            raise InputError(
                f"{self.where} was read from a file that holds numbers and no equations: save to a .contin file, or "
                "compute its branch again (contin.continuation)"
            )
        return self.solution()

    @property
    def system(self) -> StoredSystem:
        return StoredSystem(tuple(name for name in self.orbit or {} if name != "t"))

    def profile(self, z: Array) -> StoredProfile:
        """The orbit that the file keeps; InputError where it keeps none."""
        if not self.orbit:
            what = "saved without its orbit (save to .contin, or --orbits)" if self.kind == "orbit" else "no orbit"
            raise InputError(f"{self.where} is {what}")
        t = np.array(self.orbit["t"], dtype=float)
        u = np.column_stack([np.array(self.orbit[name], dtype=float) for name in self.system.state_names])
        return StoredProfile((t - t[0]) / (t[-1] - t[0]), u, float(t[-1] - t[0]))
