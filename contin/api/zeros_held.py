"""Totals that are conserved because some parameters are 0: a flux that is switched off, a mutant.

With those parameters held at 0 the law holds for all others, and the model can be reduced by it; nothing can be
continued in them then.
"""

from __future__ import annotations

from typing import Final

from contin.api.fixed_totals import for_branches
from contin.model.model import Model
from contin.records import Record
from contin.symbolic.passes.conserved_laws import LARGEST, conserved_laws
from contin.symbolic.passes.fix_parameters import fix_parameters

MOST: Final = 40  # parameters that are 0


def with_zeros_held(model: object, parameters: Record | None = None) -> tuple[Model, list[str]] | None:
    """The model with the fewest parameters held at 0 that bring new laws, and their names; None where none does."""
    if not isinstance(model, Model) or not model.conserved or model.totals or len(model.states) > LARGEST:
        return None
    values = model.default_parameters(dict(parameters or {}))
    zeros = [n for n, v in values.items() if v == 0.0]
    if not 0 < len(zeros) <= MOST or model.averaging is not None:
        return None
    wanted = _count(model, zeros)
    if wanted <= _count(model, []):
        return None
    for name in list(zeros):
        fewer = [n for n in zeros if n != name]
        if _count(model, fewer) == wanted:
            zeros = fewer
    return for_branches(_held(model, zeros)), zeros


def _held(model: Model, zeros: list[str]) -> Model:
    return fix_parameters(model, dict.fromkeys(zeros, 0)) if zeros else model


def _count(model: Model, zeros: list[str]) -> int:
    return len(conserved_laws(_held(model, zeros)))
