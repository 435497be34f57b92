"""Numbers by which several kinds of solutions decide alike, each with its reason; those of one place stand there.

Sizes are relative to what they are compared with: the metric, the states' sizes, the largest eigenvalue.
"""

from __future__ import annotations

from typing import Final

RESIDUAL_LIMIT: Final = 1e-8  # (scaled) a defining system that cannot be brought below this is not satisfied
RESIDUAL_LIMIT_OF_LARGE: Final = 1e-7  # ... on meshes, and with factors of large matrices
SETTLED: Final = 1e-13  # (scaled) a correction below this is rounding
STALLED: Final = 1e-7  # (scaled) a correction that no longer falls must be below this to be one, beside singular points
ONE_FIXED: Final = 1e-11  # (scaled) of Newton's steps with one unknown held
PROBE_TOLERANCE: Final = 1e-10  # (scaled) of Newton's steps to points beside those of a march
ONE_POINT: Final = 1e-7  # relative distance of parameters below which two points of curves on meshes are one
ONE_PASSAGE: Final = 1e-6  # of the states' sizes: two halves of an orbit this near are two passages of one
STAYS_ONE: Final = 1e-6  # distance from 1 of a multiplier that stays 1 along a family
CRITICAL: Final = 1e-5  # an eigenvalue this small beside the largest takes part in a compound event
SHEARLESS: Final = 1e-7  # change of the period across a fold, as a part of its terms, up to which there is none
