"""States that are no numbers: not a number or infinite at the start, or driven by what is so all the time.

They do not take part in the integration. Infinity stays infinite while its rate is finite; a finite state whose rate
is infinite (not a number) wherever one looks is that at once. A rate that is infinite only at the start, such as
1/sqrt(t), is none of these: the integrator says where it cannot go.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.model.expression import number, substitute, symbol

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem
    from contin.model.model import Model

LOOKS: Final = 4  # places near the start at which a rate is looked at
NEAR: Final = 0.1


@dataclass(frozen=True, eq=False)
class Held:
    """Which states move (n,), and what all are after the start: (n,), finite exactly where they move."""

    moving: NDArray[np.bool_]
    after: Array

    def reduced(self, model: Model) -> Model:
        """The model of the states that move, the others put in as constants."""
        constants = {
            symbol(s.name): number(float(v))
            for s, v, moves in zip(model.states, self.after, self.moving, strict=True)
            if not moves
        }
        kept = [k for k in range(len(model.states)) if self.moving[k]]
        equations = substitute([model.equations[k] for k in kept], constants)
        return model.replace(
            states=tuple(model.states[k] for k in kept), equations=tuple(equations), observables={}, symmetries=(),
            rotation={}, starts=(), averaging=None, limits=(), expect=(), labels={},
        )  # fmt: skip

    def filled(self, times: Array, u: Array, states: Array) -> Array:
        """States (T, n) at the times from those that move (T, count); at time 0 all are u."""
        rows = np.tile(self.after, (len(times), 1))
        rows[:, self.moving] = states
        rows[times == 0.0] = u
        return rows


def held_states(system: CompiledSystem, u: Array, p: Array, duration: float) -> Held:
    """Looks for states that do not move as numbers do from u (n,) at p (m,)."""
    looks = _looks(u, duration)
    after = u.copy()
    while True:
        rates = np.array([_rate(system, np.where(np.isfinite(after), v, after), p, t) for v, t in looks])
        bad = ~np.isfinite(rates).any(axis=0)
        changed = np.where(bad, after + rates[0], after)
        if np.array_equal(changed, after, equal_nan=True):
            return Held(np.isfinite(after), after)
        after = changed


def _looks(u: Array, duration: float) -> list[tuple[Array, float]]:
    generator = np.random.default_rng(1)
    places = [(u, 0.0)]
    for _ in range(LOOKS):
        moved = u * (1.0 + NEAR * generator.uniform(-1.0, 1.0, u.size)) + 1e-3 * generator.uniform(0.1, 1.0, u.size)
        places.append((moved, NEAR * duration * float(generator.uniform(0.1, 1.0))))
    return places


def _rate(system: CompiledSystem, u: Array, p: Array, t: float) -> Array:
    return np.asarray(system.value(u, np.append(p, t) if system.is_forced else p), dtype=float)


def finite_at_start(system: CompiledSystem, u: Array, p: Array) -> bool:
    """True where all states and their rates are finite at the start."""
    return bool(np.isfinite(u).all() and np.isfinite(_rate(system, u, p, 0.0)).all())
