"""contin: numerical continuation and bifurcation analysis of models written as formulas.

The verbs are imported when they are first used (PEP 562), so `import contin` takes a few milliseconds.
"""

import sys as _sys
from importlib import import_module as _import_module
from types import ModuleType as _ModuleType
from typing import Any

from contin._version import __version__

_EXPORTS = {
    "ContinError": "contin.errors",
    "FunctionProblem": "contin.systems.functions.function_problem",
    "InputError": "contin.errors",
    "Model": "contin.model.model",
    "average": "contin.symbolic.averaging.average",
    "boundary_problem": "contin.api",
    "continuation": "contin.api",
    "deflated": "contin.api",
    "diagram": "contin.api",
    "draw": "contin.api",
    "equilibrium": "contin.api",
    "find_equilibria": "contin.api",
    "find_start": "contin.api",
    "from_autograd": "contin.systems.functions.automatic",
    "from_casadi": "contin.systems.functions.automatic",
    "from_jax": "contin.systems.functions.automatic",
    "from_petsc": "contin.systems.functions.petsc",
    "load": "contin.model.registry",
    "multigrid": "contin.linalg.multigrid",
    "lyapunov": "contin.exponents.lyapunov",
    "manifold": "contin.api",
    "periodic_orbit": "contin.api",
    "connecting_orbit": "contin.api",
    "connection": "contin.api",
    "phase": "contin.api",
    "plane": "contin.plane.portrait",
    "read": "contin.api.reading",
    "scan": "contin.simulate.scan",
    "simulate": "contin.simulate.run",
    "survey": "contin.api",
    "sweep": "contin.simulate.sweep",
    "torus": "contin.api",
    "walk": "contin.api",
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


class _Package(_ModuleType):
    """The verbs `continuation`, `diagram`, `plane` and `simulate` are named as subpackages are: as attributes they win.

    Importing a subpackage sets it as an attribute of its parent; `from contin.diagram.x import` needs no attribute.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _EXPORTS and isinstance(value, _ModuleType)):
            super().__setattr__(name, value)


_sys.modules[__name__].__class__ = _Package
