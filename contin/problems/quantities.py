"""Formulas in states and parameters, compiled with their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contin.abi import Array
from contin.lowering.system import CompiledSystem, compile_system
from contin.model.evaluate import evaluate
from contin.model.expression import ZERO, Expression
from contin.model.model import Model


@dataclass(frozen=True, eq=False)
class Quantities:
    """k formulas of a model; a compiled system of n equations serves for n of them."""

    model: Model
    formulas: tuple[Expression, ...]

    @cached_property
    def _systems(self) -> tuple[CompiledSystem, ...]:
        n = len(self.model.states)
        bare = self.model.replace(
            constraints=None, vanishing=(), mass={}, symmetries=(), limits=(), observables={}, rotation={}
        )
        parts = [self.formulas[k : k + n] for k in range(0, len(self.formulas), n)]
        return tuple(compile_system(bare.replace(equations=(*part, *[ZERO] * (n - len(part))))) for part in parts)

    def at(self, u: Array, p: Array) -> tuple[Array, Array]:
        """Values (k,) and derivatives (k, n + p_size) at one point; p (p_size,)."""
        found = [system.jacobian(u, p) for system in self._systems]
        count = len(self.formulas)
        return np.concatenate([f for f, _ in found])[:count], np.concatenate([j for _, j in found])[:count]

    def along(self, u: Array, p: Array) -> Array:
        """Values (N, k) at N states (N, n) with p (N, p_size)."""
        found = [system.values(np.ascontiguousarray(u), p) for system in self._systems]
        return np.concatenate(found, axis=1)[:, : len(self.formulas)]


def evaluated(residuals: Sequence[Expression], values: dict[str, float]) -> Array:
    """Numbers of formulas whose symbols have these values; NaN where one has none."""
    out = np.full(len(residuals), np.nan)
    for k, residual in enumerate(residuals):
        try:
            out[k] = float(evaluate(residual, values))
        except (ArithmeticError, ValueError):  # outside its domain: no solution there
            continue
    return out
