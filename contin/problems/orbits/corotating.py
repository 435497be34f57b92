"""The compiled model in which orbits are followed: in the frame for orbits where equilibria were followed in theirs."""

from __future__ import annotations

from typing import TypeVar, cast

from contin.lowering import compile_system
from contin.lowering.system import CompiledSystem
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.symbolic.passes.corotating import of_orbits
from contin.systems.protocol import System

S = TypeVar("S", bound=System)


def system_of_orbits(system: S) -> S:
    """`system`, or in its place the system in the frame of `of_orbits`: the same states, rest where it was."""
    if not isinstance(system, CompiledSystem) or not isinstance(system.written, Model):
        return system
    model = of_orbits(system.written)
    if model is system.written:
        return system
    return cast(S, kept_with(system, "system of orbits", lambda: compile_system(model)))
