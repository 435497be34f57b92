"""How far an orbit that passes near a saddle is from one that ends there, in the parameters too."""

from __future__ import annotations

from typing import Final

import numpy as np

from contin.machine import elementary

NEAR: Final = 0.05  # of its extent: an orbit this close to a saddle moves as the linearised equations say


def beside(gap: float, sides: tuple[float, float]) -> float:
    """exp(-min(r, s) t) of a passage of length t, which comes at the rate s and leaves at the rate r.

    gap : the closest distance, of the orbit's extent.  sides : t_in and t_out, times from and to `NEAR`. The rates are
    log(NEAR / gap) / t_in and log(NEAR / gap) / t_out.
    """
    decades = float(elementary.log(NEAR / max(gap, np.finfo(float).tiny)))
    return float(elementary.exp(-decades / max(sides) * sum(sides)))
