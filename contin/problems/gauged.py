"""Equations with parts that are chosen for a stretch of a curve, see `contin.continuation.sample.Frame`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Self


class Gauged:
    """A dataclass with a field `gauge`: what is chosen, None before."""

    gauge: Any

    @property
    def is_settled(self) -> bool:
        """True where all is chosen that there is to choose."""
        return self.gauge is not None

    def gauged(self, gauge: Any) -> Self:
        """The same equations with what was chosen for a stretch of the curve, if anything was."""
        return self if gauge is None else replace(self, gauge=gauge)  # type: ignore[type-var]
