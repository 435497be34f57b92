"""The equations of a model, or of a user's function, as trajectories need them."""

from __future__ import annotations

from typing import Any

from contin.errors import InputError
from contin.lowering import compile_system
from contin.lowering.system import compile_in_time
from contin.model.model import Model


def in_time(model: Any, steps_of_our_own: bool = True) -> Any:
    """Of a flow that may use the time, or a map; of a function behind addresses where our own steps are taken."""
    if isinstance(model, Model):
        return compile_in_time(model)
    return model.in_kernels if steps_of_our_own and model.kind == "flow" else model.system()


def autonomous(model: Any) -> Any:
    """Of a flow whose steady states are looked for."""
    return compile_system(model) if isinstance(model, Model) else in_time(model)


def need_formulas(model: Any, what: str, instead: str) -> None:
    """Raises InputError for a Python function where `what` is written in the names of a model's formulas."""
    if not isinstance(model, Model):
        raise InputError(f"{what}: {model.name!r} is a Python function, which has no formulas; {instead}")
