"""The verbs of contin."""

from contin.api.branches import continuation, walk
from contin.api.diagrams import diagram, phase
from contin.api.machine_code import compiled, prepare
from contin.api.responses import solution
from contin.api.starts import connecting_orbit, equilibrium, find_equilibria, periodic_orbit

__all__ = [
    "compiled",
    "connecting_orbit",
    "continuation",
    "diagram",
    "equilibrium",
    "find_equilibria",
    "periodic_orbit",
    "phase",
    "prepare",
    "solution",
    "walk",
]
