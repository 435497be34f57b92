"""Coefficients of points of codimension two of cycles: those of the return map, by the functions for maps.

CPC, GPD and CH are stated as rates, as b, c and d of LPC, PD and NS are, in the same coordinate xi and time t:

    CPC   xi' = c xi^3,                    c = c_map a^2 / T
    GPD   xi' = e xi^5,                    e = -e_map a^4 / T        (the map is w -> -w - T e w^5 + ...)
    CH    |xi|' = l2 |xi|^5,               l2 = l2_map a^4 / T       (|w| -> |w| + T l2 |w|^5 + ...)

where w = a xi: a is the length of the eigenfunction v across the cycle at the section, in the length of the map's
eigenvector. R1 to R4, LPPD, LPNS, PDNS and NSNS have the coefficients of the return map in xi (De Witte, Della Rossa,
Govaerts and Kuznetsov, SIAM J. Appl. Dyn. Syst. 12 (2013) 722, have those of the flow: p_jk / T, and the same theta,
delta and s): what is stated does not depend on the section, but for the phase of v there, which B and D of R3 and R4
have, and the sign of the map's eigenvector of multiplier 1 (e of LPPD; f200, f011 and g110 of LPNS).

They are computed on two meshes, the point being located on each (`of_return_maps` has the errors).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from contin.continuation.outcome import Verified
from contin.normalforms.result import NO_FORM
from contin.problems.algebraic_states import massless
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.normal_forms.normal_form import eigenfunction
from contin.problems.orbits.normal_forms.of_return_maps import MeasuredMap, coefficients_of
from contin.problems.orbits.normal_forms.return_map import Collocated, ReturnMap
from contin.special.table import special_type

if TYPE_CHECKING:
    from contin.systems.protocol import System


def has_coefficients(type_: str, system: System) -> bool:
    """Whether there are any for points of this type; of states without mass there is no return map."""
    return bool(special_type(type_).powers) and not massless(system).any()


def with_coefficients(point: Verified, theta: float, coarse: OrbitLinear, fine: OrbitLinear) -> Verified:
    """The point with coefficients and their errors, or the remark why they could not be computed.

    theta : the angle of the critical multiplier.  coarse, fine : the cycle on two meshes.
    """
    try:
        form = _form(point.type, theta, coarse, fine)
    except NO_FORM as reason:
        return replace(point, remark=f"{point.type}: its normal form could not be computed ({reason})")
    return replace(point, normal_form=form)


def _form(type_: str, theta: float, coarse: OrbitLinear, fine: OrbitLinear) -> dict[str, object]:
    first = ReturnMap(Collocated(coarse))
    second = ReturnMap(Collocated(fine), like=first)
    return coefficients_of(type_, theta, (_measured(coarse, first), _measured(fine, second)))


def _measured(linear: OrbitLinear, returns: ReturnMap) -> MeasuredMap:
    return MeasuredMap(returns.jet(), linear.profile.period, lambda rho, _: _length(linear, returns, rho))


def _length(linear: OrbitLinear, returns: ReturnMap, rho: complex) -> float:
    """Of the eigenfunction across the cycle at the section, in that of a unit vector there."""
    real = abs(rho.imag) < np.finfo(float).eps * 8.0
    v = eigenfunction(linear, float(np.sign(rho.real)) if real else rho)
    return float(np.linalg.norm(returns.coordinates(v[0] / linear.sizes)))
