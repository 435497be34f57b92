"""The machine code of a model, made once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary, ref

from contin.api.fixed_totals import for_branches
from contin.lowering import compile_system
from contin.model.kept import kept_with
from contin.problems.sparse.from_model import is_large
from contin.systems.functions.function_problem import FunctionProblem, in_kernels

if TYPE_CHECKING:
    from contin.model.model import Model

_compiled: WeakKeyDictionary[Any, ref[Any]] = WeakKeyDictionary()  # of equal models one serves all


def compiled(model: Any) -> Any:
    """The machine code of a model (of a user function: its derivatives), made once, freed with its last user."""
    return kept_with(model, "machine_code", lambda: _made_for(model))


def _made_for(model: Any) -> Any:
    try:
        known = _compiled.get(model)
    except TypeError:  # an object that cannot be a weak key
        return model.system() if isinstance(model, FunctionProblem) else compile_system(model)
    system = None if known is None else known()
    if system is None:
        system = model.system() if isinstance(model, FunctionProblem) else compile_system(model)
        _compiled[model] = ref(system)
    return system


def for_orbits(model: Any) -> Any:
    """The same with addresses: a user's function behind callbacks."""
    return in_kernels(compiled(model))


def prepare(model: Model) -> None:
    """Make what every run of a model needs: its machine code, of large sparse ones their formulas by shapes."""
    model = for_branches(model)
    jumps = bool(getattr(model, "events", ()))  # whose orbits make their own
    if getattr(model, "interval", None) is None and not jumps and not is_large(model):
        compiled(model)
