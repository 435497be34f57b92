"""Eigenfunctions of an orbit's multipliers: solutions of v' = f_u(u(t), p) v with v(T) = rho v(0).

On a mesh they solve that boundary-value problem, bordered where it is singular (as the normal forms do): small
multipliers are no worse than large ones. |v(0)| = 1 in the 2-norm, its component of largest modulus real and positive.
Of a multiplier that occurs several times one eigenfunction is given for each time it occurs, and they may be equal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.normal_forms.normal_form import Variation

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations


def eigenfunctions(problem: OrbitEquations, z: Array, multipliers: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """(k, times, n) at the nodes of the orbit's mesh; NaN for a multiplier that is not known."""
    profile = problem.profile(z)
    value = float(z[-1])
    scale = problem.initial_scale(z, (value - 1.0, value + 1.0))
    linear = OrbitLinear(problem, z, scale, z)
    found = np.full((len(multipliers), *profile.u.shape), np.nan, complex)
    for k, rho in enumerate(multipliers):
        if np.isfinite(rho):
            real = rho.imag == 0.0
            w = Variation(linear, float(rho.real) if real else complex(rho)).null[0]
            found[k] = normalised(np.asarray(w, complex))
    return found


def normalised(w: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """w (times, n), of unit length and with a real largest component at the first time."""
    first = w[0]
    largest = first[np.argmax(np.abs(first))]
    size = np.linalg.norm(first)
    return np.asarray(w * (np.conj(largest) / abs(largest) / size)) if size > 0.0 else w
