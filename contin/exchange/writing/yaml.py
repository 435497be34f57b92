"""Models as contin's own model files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contin.exchange.imported import Exported

if TYPE_CHECKING:
    from contin.model.model import Model


def write(model: Model) -> Exported:
    """The model file."""
    return Exported(model.text())
