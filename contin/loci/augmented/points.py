"""Folds, Hopf points, ... of equilibria, fixed points and algebraic equations as a base of curves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import Outcome, Rejected, Verified
from contin.continuation.sample import Frame, Sample
from contin.loci.augmented import third
from contin.loci.augmented.base import Base
from contin.loci.augmented.dense import DenseBordered, dense_bordered
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.one_event import test_of
from contin.loci.codim2 import events
from contin.loci.codim2.functions import function_of
from contin.loci.codim2.matrices import eigenvalues
from contin.loci.codim2.monitors import tests_at
from contin.loci.codim2.solving import Solution
from contin.loci.curve_of_points import scalar_columns
from contin.loci.equilibria import timeless
from contin.problems.scales import parameter_width
from contin.problems.state_columns import state_columns
from contin.special.table import signs_of_points

if TYPE_CHECKING:
    from contin.loci.equilibria.equilibrium_locus import LocusProblem

SMALL = 1e-3  # part of its natural size below which a parameter's value says nothing of its scale


@dataclass(frozen=True, eq=False)
class PointBase(Base):
    """The minimally augmented equations of `problem`, whose curve is a `BorderedCurve` in any number of parameters."""

    problem: LocusProblem
    codimension: int = 1  # of the points on the curve: one of them is `problem`'s own

    @property
    def has_stability(self) -> bool:  # type: ignore[override]
        return bool(self.problem.has_stability)

    @property
    def angle_periods(self) -> Array:
        return self.problem.angle_periods

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return self.problem.identifying

    @property
    def growing(self) -> NDArray[np.bool_]:
        return self.problem.growing

    @property
    def names(self) -> tuple[str, ...]:
        """Of the varying parameters, the last unknown first."""
        return tuple(self.system.parameter_names[place] for place in self.problem.curve.places[::-1])

    @property
    def conditions(self) -> int:
        return 1

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        curve, n = self.problem.curve, self.problem.n
        values = z[: -1 - len(self.names) : -1]
        slopes = np.abs(np.asarray(self.system.jacobian(z[:n], curve.full_parameters(z))[1]))
        effect = float((slopes[:, :n] * curve.sizes).max())
        widths = []
        for name, value, ends, place in zip(self.names, values, ranges, curve.places[::-1], strict=True):
            own = float(slopes[:, n + place].max())
            widths.append(self._width(name, float(value), ends, effect / own if own > 0.0 else 0.0))
        return np.asarray(self.problem.curve.scales(z, widths))

    def _width(self, name: str, value: float, ends: tuple[float, float], natural: float) -> float:
        """A parameter's scale; of one without a range that is as good as 0, what matters as much as the states do."""
        size = natural if np.isinf(ends[0]) and abs(value) <= SMALL * natural else value
        return parameter_width(self.system.model, name, size, ends)

    @property
    def gauge(self) -> Any:
        return self.problem.curve.gauge

    @property
    def is_settled(self) -> bool:
        return self.gauge is not None

    def gauged(self, gauge: Any) -> Self:
        return replace(self, problem=replace(self.problem, curve=self.problem.curve.gauged(gauge)))

    def settled(self, z: Array, scale: Array) -> Self:
        return self.gauged(self.problem.curve.settled(z, scale).gauge)

    def linearise(self, z: Array, scale: Array, rows: Array) -> DenseBordered | None:
        f, jacobian = self.problem.curve.linearise(z)
        units = scale[: len(f)]
        return dense_bordered(f / units, jacobian * scale / units[:, None], rows)

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        tests, unstable, values = self._stability(type_, z)
        if self.has_stability:
            return tests, unstable, values
        tests[timeless.CONSIDERED - 2 :] = 1.0  # two tests of the curve come before these
        return tests, 0, timeless.NONE

    def _stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        if self.codimension == 1:
            return tests_at(self.problem, z)
        return third.tests_at(self.problem, type_, z)

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        if self.codimension == 1:
            return events.explain(self.problem.locus, a, b, self.system.kind == "map")
        return third.explain(type_, a, b)

    def test_of(self, curve: str, type_: str) -> int | None:
        return events.test_of(curve, type_) if self.codimension == 1 else test_of(third.types(curve), type_)

    def types(self, curve: str) -> Sequence[str]:
        if self.codimension > 1:
            return third.types(curve)
        return [type_ for type_, _ in signs_of_points(curve, self.system.kind == "map").values()]

    def sample(self, z: Array) -> Sample:
        """z with its eigenvalues."""
        return Sample(z, np.zeros(z.size), np.zeros(0), 0, eigenvalues(self.problem, z))

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        if self.codimension > 1:
            return third.function_of(self.problem, curve, type_, near.z)
        found = function_of(self.problem, type_, near)
        return found.reason if isinstance(found, Rejected) else lambda z: np.array([found(z)])

    def described(self, type_: str, point: Verified, scale: Array) -> Outcome:
        if self.codimension > 1:
            found = third.described(self.problem, type_, point)
        else:
            solution = Solution(point.z / scale, point.residual, point.error / float(scale[-1]))
            found = events._point(self.problem, point.type, solution, Frame(scale))
        return found if self.has_stability else timeless.point_without(found)

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return self.problem.finite(z, values)

    def columns(self, z: Array) -> dict[str, Array]:
        found = {name: z[:, -1 - k].copy() for k, name in enumerate(self.names)}
        curve = self.problem.curve
        u = z[:, : curve.n]
        found |= state_columns(self.system, u, lambda: np.array([curve.full_parameters(row) for row in z]))
        return found | scalar_columns(self.problem.locus, z[:, -1 - len(self.names)])

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.system.state_names, *self.system.observable_names)

    def describe_failure(self, z: Array) -> str:
        return str(self.system.why_not_finite(z[: self.problem.n], self.problem.curve.full_parameters(z)) or "")
