"""Where a family of periodic orbits ends."""

from __future__ import annotations

from typing import Any

from contin.continuation.branch import End
from contin.continuation.problem import Frame, Sample
from contin.continuation.settings import Settings


def ending(
    problem: Any, origin: Sample, before: Sample | None, frame: Frame, settings: Settings
) -> tuple[End, Sample | None] | None:
    """The end that has been reached, and a last row for it."""
    return None
