"""Small stand-ins for models: what `compile_system` reads, and nothing else."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from contin.lowering import CompiledSystem, compile_system
from contin.model.expression import Expression, call, symbol
from contin.model.parser import parse


@dataclass(frozen=True)
class Equations:
    state_names: tuple[str, ...]
    parameter_names: tuple[str, ...]
    equations: tuple[Expression, ...]
    observables: Mapping[str, Expression] = field(default_factory=dict)
    kind: str = "flow"
    forcing: object = None
    limits: tuple[object, ...] = ()
    symmetries: tuple = ()
    name: str = "trial"


def equations(states: Mapping[str, str], parameters: Sequence[str] = (), observables=None, forcing=None) -> Equations:
    """{state: right-hand side} as texts."""
    names = [*states, *parameters, *(["t"] if forcing is not None else [])]
    scope = {name: symbol(name) for name in names}
    return Equations(
        tuple(states),
        tuple(parameters),
        tuple(parse(text, scope) for text in states.values()),
        {name: parse(text, scope) for name, text in (observables or {}).items()},
        forcing=forcing,
    )


def compiled(states: Mapping[str, str], parameters: Sequence[str] = (), **options) -> CompiledSystem:
    return compile_system(equations(states, parameters, **options))


def oscillator_network(n: int, neighbours: int) -> Equations:
    """n phase oscillators, each coupled to the next ones by sines of differences; neighbours = n - 1 is all to all."""
    x, coupling = [symbol(f"x{i}") for i in range(n)], symbol("K")
    rates = [symbol(f"w{i}") for i in range(n)]
    rows = tuple(
        rates[i]
        + coupling * sum((call("sin", x[(i + k) % n] - x[i]) for k in range(1, neighbours + 1)), start=symbol("K") * 0)
        for i in range(n)
    )
    return Equations(tuple(f"x{i}" for i in range(n)), ("K", *(f"w{i}" for i in range(n))), rows)


def bits(values) -> bytes:
    """For comparisons to the last bit."""
    return np.ascontiguousarray(values, dtype=float).tobytes()
