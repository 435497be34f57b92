"""Solutions under conditions: the parts of z, the equations, and the problem without conditions in it.

z = (unknowns of the solution, q_k .. q_1, p): the free parameters q stand before the one that varies.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.problem import Problem
from contin.continuation.sample import Frame, Sample
from contin.problems.scales import parameter_width

SMALL: Final = 1e-3  # part of its natural size below which a free parameter's value says nothing of its scale


@dataclass(frozen=True, eq=False)
class ConditionedEquations(Problem):
    """`inner`: the problem without conditions, whose base has values of the free parameters; `free`: their places.

    What its special points ask of it, from which the problem itself is made (`under_conditions.Conditioned`).
    """

    inner: Any
    free: tuple[int, ...]

    locus = None

    # -- the parts of z ------------------------------------------------------------------------------------------------

    @property
    def k(self) -> int:
        return len(self.free)

    def inner_vector(self, z: Array) -> Array:
        """z of the problem without conditions (also of a metric or tangent)."""
        return np.append(z[: -1 - self.k], z[-1])

    def joined(self, inner: Array, free: Array) -> Array:
        """z from both parts; free parameters in their order."""
        return np.concatenate([inner[:-1], free[::-1], inner[-1:]])

    def free_values(self, z: Array) -> Array:
        """The free parameters, in their order."""
        return z[-1 - self.k : -1][::-1]

    def at(self, q: Array) -> Any:
        """The problem without conditions for these values of the free parameters."""
        base = self.inner.base.copy()
        base[list(self.free)] = q
        return replace(self.inner, base=base)

    @property
    def free_names(self) -> tuple[str, ...]:
        return tuple(self.inner.system.parameter_names[k] for k in self.free)

    def free_sizes(self, z: Array, bounds: tuple[float, float]) -> Array:
        return self.free_values(self.initial_scale(z, bounds))

    @property
    def system(self) -> Any:
        return self.inner.system

    # -- what the kinds of solutions add -------------------------------------------------------------------------------

    @abstractmethod
    def linearisation(self, z: Array, tangent: Array, scale: Array) -> corrector.Linearisation | None:
        """Equations and conditions with the tangent as their last row."""

    @abstractmethod
    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on (named by TESTS), the number of unstable eigenvalues, and all of them."""

    @abstractmethod
    def condition_values(self, z: Array) -> Array:
        """(k,)"""

    @abstractmethod
    def near_inner(self, near: Sample, z: Array, frame: Frame, place: int) -> tuple[Sample, Frame]:
        """A sample at z of the problem without conditions, in which parameter `place` varies, and its metric."""

    def _unfolded(self, z: Array, scale: Array, place: int) -> tuple[Any, Array, Array]:
        """The problem without conditions in which parameter `place` varies (k: the own one), its z and metric."""
        free, bare, metric = self.free_values(z), self.inner_vector(z), self.inner_vector(scale)
        inner = self.at(free)
        if place == self.k:
            return inner, bare, metric
        inner = inner.with_active(self.free_names[place], bare)
        return inner, np.append(bare[:-1], free[place]), np.append(metric[:-1], self.free_values(scale)[place])

    def free_widths(self, z: Array, states: Array) -> Array:
        """Scales of the free parameters: declared ones or their values; of one that is as good as 0, the value that
        would change the equations as much as the states (rows) do."""
        bare, free = self.at(self.free_values(z)), self.free_values(z)
        p, n = bare.full_parameters(self.inner_vector(z)), states.shape[1]
        slopes = np.abs(np.array([self.system.jacobian(u, p)[1] for u in states]))
        size = np.abs(states).max(axis=0)
        effect = float((slopes[:, :, :n] * np.where(size > 0.0, size, size.max(initial=0.0) or 1.0)).max())
        widths = []
        for name, place, value in zip(self.free_names, self.free, free, strict=True):
            own = float(slopes[:, :, n + place].max())
            natural = effect / own if own > 0.0 and effect > 0.0 else abs(float(value)) or 1.0
            given = abs(float(value)) if abs(float(value)) > SMALL * natural else natural
            widths.append(parameter_width(self.system.model, name, given, (-np.inf, np.inf)))
        return np.array(widths)
