"""What went wrong with a user's function last, and where: said where a branch ends close to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array
from contin.records import Fields

NEAR: Final = 2e-2  # relative distance (that of the widest difference) up to which a failure explains why a branch ends
SHOWN: Final = 6  # states


@dataclass(frozen=True, eq=False)
class Trouble:
    """`text` at the states u (n,) and parameters p (m,)."""

    text: str
    u: Array
    p: Array

    def is_near(self, u: Array, p: Array) -> bool:
        """Whether it was close to another point, relative to the largest of its numbers."""
        size = max(float(np.abs(u).max()), float(np.abs(p).max()), 1e-300)
        apart = max(float(np.abs(self.u - u).max()), float(np.abs(self.p - p).max()))
        return apart < NEAR * size

    def told(self, named: Fields) -> str:
        """In words; named : its parameters by name."""
        where = ", ".join(f"{x:.6g}" for x in self.u[:SHOWN]) + (", ..." if len(self.u) > SHOWN else "")
        return f"{self.text}, at u = ({where}), " + ", ".join(f"{k} = {v:.10g}" for k, v in named.items())
