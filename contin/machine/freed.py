"""Memory that is freed stays in the process, up to some 32 MB, where the C library would give it back to the system.

A family of orbits makes arrays of a megabyte, one after the other. The GNU C library returns free memory at the end of
its heap beyond twice the largest block that it was ever given back, and every page that is asked for again is cleared
by the system first: 1,800 pages in a family of 300 planar orbits, a fifth of its time.
"""

from __future__ import annotations

from typing import Final

import numpy as np

LARGE: Final = 2**21  # numbers: 16 MB, the largest block but one that counts


def keep_freed() -> None:
    """From now on. The block is never written to, so no page of it is ever there; other C libraries take no notice."""
    np.empty(LARGE)
