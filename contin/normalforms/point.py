"""One entry for the engine: the normal form of a verified special point by its type code."""

from __future__ import annotations

from contin.normalforms.jet import Jet
from contin.normalforms.result import NormalForm, NotThisTypeError
from contin.normalforms.static import StateError
from contin.special.table import function, special_type, table


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
    decides whether a quadratic coefficient is zero. The jet needs forms up to `order` of its row, and one active
    parameter for BP. Raises `ValueError` for a type without a normal form here, and `ZeroDivisionError` or numpy's
    `LinAlgError` where the point is more degenerate than its type.
    """
    row = special_type(type_)
    if not row.normal_form:
        known = ", ".join(code for code, one in table().items() if one.normal_form)
        raise NotThisTypeError(f"no normal form for type {type_!r} here; known: {known}")
    named = {"state_error": state_error, "kernel": kernel}
    further = {name: value for name, value in named.items() if name in row.needs}
    form: NormalForm = function(row.normal_form)(jet, *((frequency,) if "frequency" in row.needs else ()), **further)
    return form
