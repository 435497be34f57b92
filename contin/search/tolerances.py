"""Numbers by which searches for starts decide alike, each with its reason; those of one place stand there."""

from __future__ import annotations

from typing import Final

ACCURATE: Final = 1e-12  # (scaled) a correction by Newton's method at which a start is a solution
ACCEPTABLE: Final = 1e-6  # ... or this, where it does not fall any more (a start at a fold: Newton is linear there)
CLOSE: Final = 1e-4  # a return this close, relative to the orbit's extent, is an orbit up to Newton's polish
