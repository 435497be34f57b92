"""Modes of a large system that are too fast for the mesh of its orbits: their multipliers are the method's, not theirs.

A mode exp(l t) that is nearly linear along the orbit gains exp(l T) over the period; Radau's formula of order 5 gives
it the product of R(l h) over the intervals h, R the (2, 3) Pade approximation of exp. Where |l h| is above one they
differ, and an unstable oscillation is damped: the orbit is called stable (Hairer and Wanner 1996, IV.3, IV.5).
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.machine import elementary

MOST: Final = 400  # states of which all eigenvalues are computed for this
MATTERS: Final = 0.2  # modulus of a multiplier, by either reckoning, below which its size is of no interest
TOLD: Final = 0.05  # relative error of a modulus


def remark(rates: NDArray[np.complex128], period: float, h: Array) -> str:
    """A note on modes with these rates (eigenvalues of the Jacobian on the orbit) on intervals h (N,); else empty.

    h : as parts of the period.
    """
    fast = rates[rates.imag * period * h.max() > 1.0]
    if not fast.size:
        return ""
    z = fast[:, None] * (period * h)
    top, bottom = 1.0 + z * (0.4 + z * 0.05), 1.0 - z * (0.6 - z * (0.15 - z / 60.0))
    theirs = np.minimum(fast.real * period, 700.0)
    computed = np.sum(elementary.log(np.abs(top / bottom)), axis=1)
    wrong = (np.abs(computed - theirs) > TOLD) & (np.maximum(computed, theirs) > elementary.log(MATTERS))
    if not wrong.any():
        return ""
    k = int(np.argmax(np.where(wrong, np.abs(computed - theirs), -1.0)))
    have, want = (float(elementary.exp(x)) for x in (max(computed[k], -700.0), theirs[k]))
    lost = ", so that the orbits may not be stable" if want > 1.0 > have else ""
    return (
        f"oscillations faster than the mesh have wrong multipliers: one of frequency {fast[k].imag:.4g} has modulus "
        f"{have:.2g} there, about {want:.4g} by its rate{lost} (pairs like it: {int(wrong.sum())}; intervals are "
        f"{period * float(h.max()):.3g} long): write more `intervals` in `settings`"
    )
