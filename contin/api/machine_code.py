"""The machine code of a model, made once."""

from __future__ import annotations

from contextlib import suppress
from typing import Any
from weakref import WeakKeyDictionary

from contin.problems.functions.problem import FunctionProblem
from contin.problems.sparse.from_model import is_large

_compiled: WeakKeyDictionary[Any, Any] = WeakKeyDictionary()


def compiled(model: Any) -> Any:
    """The machine code of a model (of a user function: its derivatives), made once per model object."""
    from contin.lowering import compile_system

    try:
        return _compiled[model]
    except (KeyError, TypeError):
        system = model.system() if isinstance(model, FunctionProblem) else compile_system(model)
        with suppress(TypeError):  # an object that cannot be a weak key is compiled anew
            _compiled[model] = system
        return system


def prepare(model: Any) -> None:
    """Make what every run of a model needs: its machine code, of large sparse ones their formulas by shapes."""
    if not is_large(model):
        compiled(model)
