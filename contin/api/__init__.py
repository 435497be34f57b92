"""The verbs of contin, each imported when it is first used: a run of equilibria needs no phase diagrams."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from contin.api.auto_start import find_start
    from contin.api.boundary import boundary_problem
    from contin.api.branches import continuation, walk
    from contin.api.connections import connecting_orbit, connection
    from contin.api.deflations import deflated
    from contin.api.diagrams import diagram, phase
    from contin.api.machine_code import compiled, prepare
    from contin.api.manifolds import manifold
    from contin.api.orbit_starts import periodic_orbit
    from contin.api.pictures import draw
    from contin.api.searches import find_equilibria
    from contin.api.solutions import solution
    from contin.api.starts import equilibrium
    from contin.api.surveys import survey
    from contin.api.tori import torus

_HOMES = {
    "boundary_problem": "boundary",
    "compiled": "machine_code",
    "connecting_orbit": "connections",
    "connection": "connections",
    "continuation": "branches",
    "deflated": "deflations",
    "diagram": "diagrams",
    "draw": "pictures",
    "equilibrium": "starts",
    "find_equilibria": "searches",
    "find_start": "auto_start",
    "manifold": "manifolds",
    "periodic_orbit": "orbit_starts",
    "phase": "diagrams",
    "prepare": "machine_code",
    "solution": "solutions",
    "survey": "surveys",
    "torus": "tori",
    "walk": "branches",
}

__all__ = [
    "boundary_problem",
    "compiled",
    "connecting_orbit",
    "connection",
    "continuation",
    "deflated",
    "diagram",
    "draw",
    "equilibrium",
    "find_equilibria",
    "find_start",
    "manifold",
    "periodic_orbit",
    "phase",
    "prepare",
    "solution",
    "survey",
    "torus",
    "walk",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'contin.api' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"contin.api.{_HOMES[name]}"), name)
    return value
