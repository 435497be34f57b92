"""One entry for the engine: the normal form of a verified special point by its type code."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from contin.normalforms.bogdanov_takens import bogdanov_takens
from contin.normalforms.directions import any_branch_point
from contin.normalforms.fold import cusp, fold
from contin.normalforms.hopf import generalised_hopf, hopf
from contin.normalforms.hopf_hopf import hopf_hopf
from contin.normalforms.jet import Jet
from contin.normalforms.map_resonances import (
    chenciner,
    generalised_flip,
    resonance_1_1,
    resonance_1_2,
    resonance_1_3,
    resonance_1_4,
)
from contin.normalforms.maps import neimark_sacker, period_doubling
from contin.normalforms.result import NormalForm, NotThisTypeError
from contin.normalforms.static import StateError
from contin.normalforms.zero_hopf import zero_hopf

ORDER: Final[Mapping[str, int]] = {  # highest order of the forms that the type needs
    "LP": 3, "BP": 3, "CP": 3, "HB": 3, "BT": 3, "ZH": 3, "HH": 3, "GH": 5,
    "PD": 3, "NS": 3, "R1": 2, "R2": 3, "R3": 3, "R4": 3, "GPD": 5, "CH": 5,
}  # fmt: skip
_OSCILLATORY: Final[Mapping[str, Callable[[Jet, float | None], NormalForm]]] = {
    "HB": hopf,
    "GH": generalised_hopf,
    "NS": neimark_sacker,
    "CH": chenciner,
}
_PLAIN: Final[Mapping[str, Callable[[Jet], NormalForm]]] = {
    "CP": cusp,
    "HH": hopf_hopf,
    "PD": period_doubling,
    "GPD": generalised_flip,
    "R1": resonance_1_1,
    "R2": resonance_1_2,
    "R3": resonance_1_3,
    "R4": resonance_1_4,
}


def normal_form(
    type_: str,
    jet: Jet,
    *,
    frequency: float | None = None,
    kernel: int | None = None,
    state_error: StateError = None,
) -> NormalForm:
    """Normal form of a special point of an equilibrium (jet.kind flow) or a fixed point (map) by its type code.

    `frequency` is omega (HB, GH, ZH) or theta (NS, CH) where it is known from the defining system, `kernel` the
    dimension of the kernel at a BP, `state_error` the estimated error of u0 (a length, or one for each state), which
    decides whether a quadratic coefficient is zero. The jet needs forms up to ORDER[type_], and one active parameter
    for BP. Raises `ValueError` for a type without a normal form here, and `ZeroDivisionError` or numpy's `LinAlgError`
    where the point is more degenerate than its type.
    """
    if type_ == "LP":
        return fold(jet, state_error=state_error)
    if type_ == "BP":
        return any_branch_point(jet, kernel=kernel, state_error=state_error)
    if type_ == "BT":
        return bogdanov_takens(jet, state_error=state_error)
    if type_ == "ZH":
        return zero_hopf(jet, frequency, state_error=state_error)
    if type_ in _OSCILLATORY:
        return _OSCILLATORY[type_](jet, frequency)
    if type_ in _PLAIN:
        return _PLAIN[type_](jet)
    raise NotThisTypeError(f"no normal form for type {type_!r} here; known: {', '.join(ORDER)}")
