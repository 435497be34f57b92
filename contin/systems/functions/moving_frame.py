"""What problems ask of the frame that a function is seen from: how far it moves, and where it is hardly defined."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from contin.abi import Array

WEAK: Final = 0.05  # of its largest value over an orbit: a phase that falls so far moves the frame ever faster


@dataclass(frozen=True, eq=False)
class MovingFrame:
    """`rate` is what is recorded of the frame; its integral over a period is how far an orbit returns moved.

    weight : states (K, n) -> (K,), which is 0 where the frame has no phase.  remedy : what to do about that.
    """

    rate: str
    weight: Callable[[Array], Array]
    remedy: str

    @property
    def column(self) -> str:
        """Of families of orbits."""
        return f"{self.rate}.integral"

    def weakness(self, states: Array) -> str | None:
        """In words, where the phase of the frame is nearly undefined at one of the states (K, n) of an orbit."""
        size = self.weight(states)
        turn = bool((size > 0.0).any() and (size < 0.0).any())
        least = 0.0 if turn else float(np.abs(size).min() / max(float(np.abs(size).max()), 1e-300))
        if least > WEAK:
            return None
        fallen = "changes its sign" if turn else f"falls to {least:.2g} of its largest value"
        return (
            f"the phase that the moving frame keeps is hardly defined at a moment of the orbit ({fallen}): the frame "
            f"moves ever faster there, and a family ends where it is 0; {self.remedy}"
        )

