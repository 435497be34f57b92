"""What every normal-form function returns, and how far a coefficient can be trusted to differ from zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, TypeAlias

import numpy as np

from contin.abi import Vector
from contin.records import Record

# A coefficient is zero to its estimated error when it is below this fraction of the sum of the moduli of its summands.
# Points are located to about 1e-11 relative and derivatives are exact, so eleven digits can cancel and ten can be
# trusted to have done so.
TRUST = 1e-10
Errors: TypeAlias = Mapping[str, float]  # of coefficients by name
NO_ERRORS: Final[Errors] = MappingProxyType({})
STATE_ERROR = 1e-10  # default estimate of the error of u0, as a fraction of the typical sizes of the states


class NotThisTypeError(ArithmeticError, ValueError):
    """The eigenvalues at hand are not those of a point of this type: there is no such normal form."""


NO_FORM = (NotThisTypeError, ZeroDivisionError, np.linalg.LinAlgError)  # raised by points more so than their type


@dataclass(frozen=True, eq=False)
class NormalForm:
    """Coefficients of a special point under FORMATS' keys, ready for JSON (complex numbers as [re, im])."""

    type: str
    coefficients: Record
    said: str | Callable[[], str]  # in words, or what says it: where errors decide that are computed when read
    vectors: Mapping[str, Vector] = field(default_factory=dict)
    errors: Mapping[str, float] = field(default_factory=dict)  # estimated, of the real coefficients that decide

    @property
    def words(self) -> str:
        """What the point is."""
        return self.said if isinstance(self.said, str) else self.said()


def parts(value: complex) -> list[float]:
    """A complex number as JSON carries it."""
    return [float(value.real), float(value.imag)]


DEGENERATE = "degenerate"


def side(value: float, error: float, positive: str = "> 0", negative: str = "< 0") -> str | None:
    """In words which sign a coefficient has; None where it is zero to its error."""
    if abs(value) <= error:
        return None
    return positive if value > 0.0 else negative


def sense(value: float, error: float) -> str:
    """'supercritical' for a negative coefficient, 'subcritical' for a positive one, 'degenerate' within its error."""
    if abs(value) <= error:
        return "degenerate"
    return "supercritical" if value < 0 else "subcritical"
