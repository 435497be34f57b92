"""What stands for the problem of a point that was read from a file: names, and its orbit where it was kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from contin.abi import Array
from contin.errors import InputError


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


def refuse_stored(problem: object, where: str) -> None:
    """InputError where a point comes from a file: nothing can be followed from it."""
    if isinstance(problem, StoredProblem):
        raise InputError(
            f"{where} was read from a file, which holds numbers and no equations: compute its branch again "
            "(contin.continuation), and follow the point of that"
        )
