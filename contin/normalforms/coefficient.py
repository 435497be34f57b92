"""A coefficient that was computed twice, with its error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

ROUNDING: Final = 1e-10  # error of a coefficient beside the sum of the moduli of its terms
KNOWN: Final = 0.1  # part of the terms that an error may be
SAFETY: Final = 2.0  # the better of two approximations has an error of its own


@dataclass(frozen=True)
class Coefficient:
    """A coefficient, and the sum of the moduli of the terms that it is the sum of."""

    value: complex
    size: float
    signed: bool = True  # False where the sign of the coordinate is arbitrary, and with it that of the coefficient
    noise: float = 0.0  # what rounding of the derivatives themselves leaves

    def is_known(self, error: float) -> bool:
        """False where the error is as large as the terms themselves: of null vectors orthogonal to each other, say."""
        return bool(error <= KNOWN * self.size)  # NaN is not known either

    def error(self, finer: Coefficient) -> float:
        """From the same coefficient by another discretisation (a finer mesh, a longer difference)."""
        noise = max(self.noise, finer.noise)
        return ROUNDING * max(self.size, finer.size) + SAFETY * self._apart(finer) + noise

    def with_noise_from(self, other: Coefficient) -> Coefficient:
        """The same with the change to `other` as noise, which has other differences for its derivatives."""
        return replace(self, noise=SAFETY * self._apart(other))

    def _apart(self, other: Coefficient) -> float:
        moved = abs(self.value - other.value)
        return moved if self.signed else min(moved, abs(self.value + other.value))
