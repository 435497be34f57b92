"""Numbers by which curves of special points decide alike, each with its reason; those of one place stand there.

Sizes are relative to what they are compared with: the largest modulus of eigenvalues, the largest rate of f_u in scaled
states, the metric.
"""

from __future__ import annotations

from typing import Final

REAL: Final = 1e-9  # (of the largest modulus) an eigenvalue with less imaginary part is real
FORCED: Final = 1e-9  # (of the largest rate) an unfolding parameter below this is zero
FORCED_AT_POINTS: Final = 1e-8  # ... at points of codimension two, which are less well conditioned
ILL_CONDITIONED: Final = 1e-4  # (scaled) an estimated error above this locates nothing
RESIDUAL_LIMIT: Final = 1e-7  # (scaled) an equation that is not brought below this has no solution there
# A tolerance that takes the first correction. It brings a guess to the periodic orbits, the second one brings these to
# the special ones, and may be as large: next to generalised Hopf points one is no measure of the other.
ONE_CORRECTION: Final = 1e300
