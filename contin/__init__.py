"""contin: numerical continuation and bifurcation analysis of models written as formulas.

The verbs are imported when they are first used (PEP 562), so `import contin` takes a few milliseconds.
"""

from importlib import import_module as _import_module
from typing import Any

from contin._version import __version__

_EXPORTS = {
    "ContinError": "contin.errors",
    "FunctionProblem": "contin.problems.function",
    "InputError": "contin.errors",
    "Model": "contin.model.model",
    "load": "contin.model.registry",
}

__all__ = ["__version__", *_EXPORTS]


def __getattr__(name: str) -> Any:
    if name not in _EXPORTS:
        raise AttributeError(f"module 'contin' has no attribute {name!r}")
    value = getattr(_import_module(_EXPORTS[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
