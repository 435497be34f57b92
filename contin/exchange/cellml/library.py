"""Myokit, which reads CellML. Two processes that import it at once for the first time both make its folder."""

from __future__ import annotations

try:
    import myokit
except FileExistsError:  # the other one was first: the folder is there now
    import myokit
from myokit.formats.cellml import v1, v2

__all__ = ["myokit", "v1", "v2"]
