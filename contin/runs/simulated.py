"""What a run's simulations gave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from contin.records import Record


@dataclass(frozen=True, eq=False)
class Simulated:
    """The entries `simulations` and `sweep` of the result document; not `complete` where one did not run to its end."""

    found: Record
    complete: bool
    notes: Sequence[str]
