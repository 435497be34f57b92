"""The surfaces of a compiled piecewise flow, and how much the equations jump across each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contin.abi import Array
from contin.lowering import compile_system
from contin.lowering.sliding import Surface, held_model, side_model, surfaces_of
from contin.machine import elementary
from contin.model.evaluate import evaluate_all
from contin.model.expression import ZERO
from contin.model.kept import kept_with
from contin.model.model import Model
from contin.symbolic.calculus.derivatives import sparse_jacobian

if TYPE_CHECKING:
    from contin.systems.protocol import System

ROUNDING: Final = 1e-10  # of the terms of the equations: a difference below this is no jump
ASIDE: Final = 1e-10  # of a surface's terms: a distance from it
REMAINS: Final = 1e-3  # of a difference there, as its limit on the surface: less is none
LANDINGS: Final = 6  # Newton steps onto a surface


@dataclass(frozen=True, eq=False)
class Jump:
    """A surface h(u, p) = 0 of a compiled model, and the equations with the formulas of either side."""

    number: int
    surface: Surface
    model: Model

    @cached_property
    def lower(self) -> Any:
        """Compiled, for h < 0."""
        return compile_system(side_model(self.model, self.surface, False), regular=True)

    @cached_property
    def upper(self) -> Any:
        """Compiled, for h > 0."""
        return compile_system(side_model(self.model, self.surface, True), regular=True)

    def side(self, upper: bool) -> Any:
        """Compiled, of one side."""
        return self.upper if upper else self.lower

    def held(self, upper: bool, u: Array, p: Array) -> Any:
        """Compiled: the formulas of one side, and of the side of every other surface on which u is."""
        names = [*self.model.state_names, *self.model.parameter_names]
        at = dict(zip(names, [*u.tolist(), *p.tolist()], strict=True))
        heights = evaluate_all(self.surface.functions, at)
        signs = tuple(1 if h > 0.0 else -1 for h in heights)
        signs = (*signs[: self.number], 1 if upper else -1, *signs[self.number + 1 :])
        if signs not in self._held:
            self._held[signs] = compile_system(held_model(self.model, self.surface, signs), regular=True)
        return self._held[signs]

    @cached_property
    def _held(self) -> dict[tuple[int, ...], Any]:
        return {}

    @cached_property
    def _formulas(self) -> tuple[Any, ...]:
        names = [*self.model.state_names, *self.model.parameter_names]
        slopes = sparse_jacobian([self.surface.function], names)
        return self.surface.function, *(slopes.get((0, j), ZERO) for j in range(len(names)))

    def height(self, u: Array, p: Array) -> tuple[float, Array]:
        """h and its derivatives in the states and all parameters, (n + m,)."""
        names = [*self.model.state_names, *self.model.parameter_names]
        values = evaluate_all(self._formulas, dict(zip(names, [*u.tolist(), *p.tolist()], strict=True)))
        return float(values[0]), np.array(values[1:], dtype=float)

    def nearest(self, u: Array, p: Array) -> Array:
        """The surface's point next to u, relative to the states' own sizes."""
        n, at = len(u), np.array(u, dtype=float)
        for _ in range(LANDINGS):
            h, slope = self.height(at, p)
            way = _across(slope[:n], at)
            square = float(slope[:n] @ way)
            if h == 0.0 or not square > 0.0:
                break
            at = at - h * way / square
        return at

    def is_jump(self, u: Array, p: Array) -> bool:
        """True where the equations jump on the surface, at its point next to u.

        A side that leaves the surface like sqrt(h) differs from the other by the root of h's rounding error, and does
        not jump: differences at distances t, 4 t, 16 t that are j + k t^s have the limit j (Aitken).
        """
        at = self.nearest(u, p)
        terms = np.abs(self.lower.jacobian(at, p)[1][:, : len(at) + len(p)]) @ np.abs(np.concatenate([at, p]))
        below, above = self.lower.value(at, p), self.upper.value(at, p)
        differ = np.abs(above - below) > ROUNDING * (terms + np.abs(below) + np.abs(above))
        if not np.any(differ):
            return False
        slope = self.height(at, p)[1][: len(at)]
        way = _across(slope, at)
        square = float(slope @ way)
        if not square > 0.0:
            return True
        step = way * float(np.abs(slope) @ np.abs(at)) / square
        steps = (times * ASIDE * step for times in (1.0, 4.0, 16.0))
        near, mid, far = (self.upper.value(at + one, p) - self.lower.value(at - one, p) for one in steps)
        bend = far - 2.0 * mid + near
        with np.errstate(divide="ignore", invalid="ignore"):
            limit = np.where(np.abs(bend) > ROUNDING * np.abs(near), near - elementary.square(mid - near) / bend, near)
        return bool(np.any(differ & ~(np.abs(limit) <= REMAINS * np.abs(near))))


def _across(slope: Array, u: Array) -> Array:
    """The direction in which a surface is nearest to u, relative to the states' own sizes."""
    way = slope * elementary.square(np.abs(u))
    return way if float(slope @ way) > 0.0 else slope


def jumps_of(system: System) -> tuple[Jump, ...]:
    """The surfaces of a compiled model of formulas; none of smooth ones and of user functions."""
    model = getattr(system, "model", None)
    iterated = getattr(system, "times", 1) > 1
    if not system.n_switches or not isinstance(model, Model) or model.forcing is not None or iterated:
        return ()
    return kept_with(system, "jumps", lambda: tuple(Jump(k, s, model) for k, s in enumerate(surfaces_of(model))))
