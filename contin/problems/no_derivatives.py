"""What a computation says that needs derivatives where there are none."""

from __future__ import annotations


class NoDerivatives(ValueError):
    """The return map has no second derivatives here, or a trajectory beside the orbit does not return."""
