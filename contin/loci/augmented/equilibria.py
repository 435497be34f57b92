"""Equilibria, fixed points and solutions of algebraic equations as a base of curves: F(u, p) = 0 alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.outcome import NOTHING, Outcome, Verified
from contin.continuation.sample import Sample
from contin.linalg.spectrum import count_and_tests, spectrum
from contin.loci.augmented.base import Base
from contin.loci.augmented.dense import DenseBordered, dense_bordered
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.one_event import one_event, test_of
from contin.loci.tolerances import REAL
from contin.machine import elementary
from contin.normalforms.point import normal_form
from contin.normalforms.result import NO_FORM
from contin.normalforms.sources import compiled_jet
from contin.problems.algebraic_states import finite_eigenvalues
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.scales import parameter_width
from contin.problems.state_columns import state_columns

FLOW, MAP = ("LP", "HB"), ("LP", "NS", "PD")
MOVED = {"LP": 1, "PD": 1, "HB": 2, "NS": 2}  # eigenvalues that change sides


@dataclass(frozen=True, eq=False)
class EquilibriumBase(Base):
    """places : of the varying parameters, the last unknown first.  sizes : of the states."""

    problem: EquilibriumProblem
    places: tuple[int, ...]
    sizes: Array

    @property
    def has_stability(self) -> bool:  # type: ignore[override]
        return self.problem.has_stability

    @property
    def angle_periods(self) -> Array:
        return np.append(self.problem.angle_periods, np.zeros(self.varying - 1))

    @property
    def identifying(self) -> NDArray[np.bool_]:
        return np.ones(self.problem.n + self.varying, bool)

    @property
    def growing(self) -> NDArray[np.bool_]:
        return np.arange(self.problem.n + self.varying) < self.problem.n

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.system.parameter_names[place] for place in self.places)

    @property
    def conditions(self) -> int:
        return 0

    def full_parameters(self, z: Array) -> Array:
        p = self.problem.base.copy()
        p[list(self.places)] = z[: -1 - self.varying : -1]
        return p

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        values = z[: -1 - self.varying : -1]
        triples = zip(self.names, values, ranges, strict=True)
        widths = [parameter_width(self.system.model, name, float(v), ends) for name, v, ends in triples]
        return np.concatenate([self.sizes, widths[::-1]])

    def linearise(self, z: Array, scale: Array, rows: Array) -> DenseBordered | None:
        n = self.problem.n
        f, full = self.system.jacobian(z[:n], self.full_parameters(z))
        matrix = full[:, [*range(n), *(n + place for place in self.places[::-1])]].copy()
        if self.problem.is_map:
            f = f - z[:n]
            matrix[:, :n] -= np.eye(n)
        units = scale[:n]
        return dense_bordered(f / units, matrix * scale / units[:, None], rows)

    # -- stability -----------------------------------------------------------------------------------------------------

    def _spectrum(self, z: Array) -> tuple[NDArray[np.complex128], Array]:
        n, d = self.problem.n, self.sizes
        matrix = self.system.jacobian(z[:n], self.full_parameters(z))[1][:, :n]
        return spectrum(np.asarray(matrix * d / d[:, None]))

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        if not self.has_stability:
            return np.zeros(0), 0, np.zeros(0, complex)
        values, rates = self._spectrum(z)
        count, tests = count_and_tests(values, self.problem.is_map, rates)
        critical = 1.0 if self.problem.is_map else 0.0
        zero = values - critical
        product = float(np.real(np.prod(zero / (1.0 + np.abs(zero)))))
        return np.array([product, tests[2], *([tests[3]] if self.problem.is_map else [])]), count, values

    def types(self, curve: str) -> Sequence[str]:
        if not self.has_stability:
            return ()
        return MAP if self.problem.is_map else FLOW

    def test_of(self, curve: str, type_: str) -> int | None:
        return test_of(self.types(curve), type_)

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        known = self.types(type_)
        return one_event(known, [MOVED[name] for name in known], a, b)

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        values, size = self._spectrum(near.z)[0], 1.0
        size = float(np.abs(values).max()) or 1.0
        real = np.abs(values.imag) <= REAL * size
        target = {"LP": 1.0 if self.problem.is_map else 0.0, "PD": -1.0}.get(type_, 0.0)
        chosen = values[real] if type_ in ("LP", "PD") else values[~real]
        if not chosen.size:
            return "the critical eigenvalues are not of its kind"
        off = np.abs(chosen - target) if type_ in ("LP", "PD") else np.abs(self._off(chosen))
        reference = complex(chosen[int(np.argmin(off))])

        def part(z: Array) -> Array:
            now = self._spectrum(z)[0]
            value = complex(now[int(np.argmin(np.abs(now - reference)))])
            return np.array([(value.real - target if type_ in ("LP", "PD") else self._off(value)) / size])

        return part

    def _off(self, value: Any) -> Any:
        """How far a pair is from the imaginary axis or the unit circle."""
        return np.abs(value) - 1.0 if self.problem.is_map else np.real(value)

    def described(self, type_: str, point: Verified, scale: Array) -> Outcome:
        values = self._spectrum(point.z)[0]
        if point.type in ("HB", "NS") and not np.any(np.abs(values.imag) > 0.0):
            return NOTHING
        n, kind = self.problem.n, "map" if self.problem.is_map else "flow"
        jet = compiled_jet(self.system, point.z[:n], self.full_parameters(point.z), (), kind, self.sizes)  # type: ignore[arg-type]
        off = np.abs(self._off(values)) if point.type in ("HB", "NS") else np.abs(values - (
            -1.0 if point.type == "PD" else 1.0 if self.problem.is_map else 0.0))  # fmt: skip
        order = np.argsort(off)
        others = values[order[MOVED[point.type] :]]
        unstable = int(np.sum(np.abs(others) > 1.0 if self.problem.is_map else others.real > 0.0))
        try:
            critical = values[order[0]]
            frequency = abs(critical.imag) if kind == "flow" else abs(elementary.angle(critical))
            form = normal_form(point.type, jet, frequency=frequency)
        except NO_FORM as reason:
            remark = f"{point.type}: its normal form could not be computed ({reason})"
            return replace(point, eigenvalues=values, unstable=unstable, remark=remark)
        errors = {"errors": dict(form.errors)} if form.errors else {}
        return replace(point, eigenvalues=values, unstable=unstable, normal_form=dict(form.coefficients) | errors)

    def finite(self, z: Array, values: NDArray[np.complex128]) -> NDArray[np.complex128]:
        return finite_eigenvalues(self.system, values)

    def columns(self, z: Array) -> dict[str, Array]:
        found = {name: z[:, -1 - k].copy() for k, name in enumerate(self.names)}
        return found | state_columns(
            self.system, z[:, : self.problem.n], lambda: np.array([self.full_parameters(row) for row in z])
        )

    def column_names(self) -> tuple[str, ...]:
        return (*self.names, *self.system.state_names, *self.system.observable_names)

    def describe_failure(self, z: Array) -> str:
        return str(self.system.why_not_finite(z[: self.problem.n], self.full_parameters(z)) or "")
