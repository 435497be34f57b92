"""Whether the directions in which a connecting orbit leaves a saddle, or arrives, are still told from the others.

Where it leaves along the strong ones of several (a front that is pushed), its linear space ends to be defined where a
strong and a weak eigenvalue come together: beyond, other directions are the strong ones.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array

if TYPE_CHECKING:
    from contin.homoclinic.connection_layout import ConnectionLayout

SEPARATE: Final = 1e-2  # of the sum of both rates: as near together, orbits along both look alike on any interval


def mixed(curve: ConnectionLayout, z: Array) -> str | None:
    """Why the equations mean nothing at z, in words; None where they do."""
    p, ends = curve.full_parameters(z), curve.equilibria(z)
    for k, count in ((0, curve.stable_count), (-1, curve.n - curve.unstable_count)):
        if not 0 < count < curve.n or (k == -1 and curve.reversor is not None):
            continue
        matrix = np.asarray(curve.orbits.system.jacobian(ends[k], p)[1])[:, : curve.n]
        if not np.all(np.isfinite(matrix)):
            continue
        rates = np.sort(np.linalg.eigvals(matrix).real)
        below, above = float(rates[count - 1]), float(rates[count])
        if below * above > 0.0 and above - below <= SEPARATE * abs(above + below):
            return (
                f"the {'first' if k == 0 else 'last'} equilibrium's rates {below:.6g} and {above:.6g} come together, "
                "between which the directions that the orbit takes are told from the others: they are others beyond"
            )
    return None
