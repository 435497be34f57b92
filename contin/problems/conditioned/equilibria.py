"""Equilibria of flows and fixed points of maps that meet conditions on states and parameters."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation import corrector
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.linalg.spectrum import count_and_tests, spectrum
from contin.model.model import Model
from contin.model.relations import Relation
from contin.problems.conditioned.under_conditions import Conditioned, product_of
from contin.problems.dense_march import dense_linearisation
from contin.problems.equilibria.equilibrium import EquilibriumProblem
from contin.problems.quantities import Quantities

PAIR: Final = 2  # of the tests of a spectrum: the sums (flows) or products (maps) of pairs
FLIP: Final = 3
ENDLESS: Final = 1e300  # the period of an unknown that is no angle


@dataclass(frozen=True, eq=False)
class ConditionedEquilibria(Conditioned):
    """f(u, q, p) = 0 and c(u, q, p) = 0."""

    inner: EquilibriumProblem
    relations: tuple[Relation, ...]
    offset: tuple[float, ...] = ()  # what the conditions are to be, on the way to 0
    rate: float = 1.0  # about the largest at the start: eigenvalues of a flow are measured in it

    TESTS = ("zero", "pair", "flip")
    maximum_chunk = 50

    @property
    def is_map(self) -> bool:
        return self.inner.is_map

    @cached_property
    def _formulas(self) -> Quantities:
        model = self.inner.system.model
        if not isinstance(model, Model):
            raise InputError("conditions need a model made of formulas")
        return Quantities(model, tuple(r.residual for r in self.relations))

    def _point(self, z: Array) -> tuple[Array, Array]:
        """States, and all parameters."""
        p = self.inner.base.copy()
        p[list(self.free)] = self.free_values(z)
        p[self.inner.active] = z[-1]
        return z[: self.inner.n], p

    @property
    def angle_periods(self) -> Array:
        return np.append(self.inner.angle_periods, np.full(self.k, ENDLESS))

    def condition_values(self, z: Array) -> Array:
        return self._formulas.at(*self._point(z))[0]

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> corrector.Linearisation | None:
        n, (u, p) = self.inner.n, self._point(z)
        f, jacobian = self.inner.system.jacobian(u, p)
        c, slopes = self._formulas.at(u, p)
        c = c - np.array(self.offset) if self.offset else c
        chosen = [*range(n), *(n + k for k in self.free[::-1]), n + self.inner.active]
        matrix, rows = jacobian[:, chosen].copy(), slopes[:, chosen] * scale
        if self.is_map:
            f = f - u
            matrix[:, :n] -= np.eye(n)
        lengths = np.linalg.norm(rows, axis=1)
        lengths = np.where(lengths > 0.0, lengths, 1.0)
        rates = np.concatenate([scale[:n], lengths, [1.0]])  # rows are divided by these, columns multiplied by scale
        full = np.vstack([matrix * scale / scale[:n, None], rows / lengths[:, None]])
        here = dense_linearisation(np.append(f, c) / rates[:-1], full, tangent, np.ones_like(scale))
        return here

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        inner = self.at(self.free_values(z))
        matrix = inner.linear_part(self.inner_vector(z))
        if not np.all(np.isfinite(matrix)):
            return np.full(3, np.nan), 0, np.full(inner.n, np.nan, complex)
        values, rates = spectrum(matrix)
        count, tests = count_and_tests(values, self.is_map, rates)
        distances = values - 1.0 if self.is_map else values / self.rate
        return np.array([product_of(distances), tests[PAIR], tests[FLIP]]), count, values

    def inner_type(self, test: str, near: Sample, also: Collection[str]) -> str | None:
        if test == "zero":
            return "LP" if not also else "BP"
        if test == "flip":
            return "PD" if self.is_map else None
        return "NS" if self.is_map else "HB"

    def near_inner(self, near: Sample, z: Array, frame: Frame, place: int) -> tuple[Sample, Frame]:
        inner, bare, metric = self._unfolded(z, frame.scale, place)
        _, jacobian = inner.linearise(bare)
        t = np.linalg.svd(jacobian * metric / metric[:-1, None])[2][-1]
        return Sample(bare, t, np.full(4, np.nan), near.unstable, near.eigenvalues), Frame(metric)

    def shifted(self, offset: Array, z: Array) -> ConditionedEquilibria:
        return replace(self, offset=tuple(offset.tolist()))

    def finer(self, near: Sample, frame: Frame) -> tuple[Conditioned, Sample, Frame] | None:
        return None

    # -- the engine's contract -----------------------------------------------------------------------------------------

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """On the conditions."""
        scale = self.initial_scale(seed.z, (-np.inf, np.inf))
        found = self.onto_conditions(seed.z, scale)
        if found is None:
            names, texts = ", ".join(self.free_names), ", ".join(r.text for r in self.relations)
            raise InputError(
                f"no solution near the start meets the conditions ({texts}) for any nearby {names}: they are off by "
                f"{', '.join(f'{v:.3g}' for v in self.condition_values(seed.z))} there; start nearer to them"
            )
        matrix = self.at(self.free_values(found)).linear_part(self.inner_vector(found))
        rate = float(np.abs(np.linalg.eigvals(matrix)).max()) if np.all(np.isfinite(matrix)) else 0.0
        return replace(seed, problem=replace(self, rate=rate or 1.0), z=found)

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        free = self.free_values(z)
        metric = self.at(free).initial_scale(self.inner_vector(z), bounds)
        return self.joined(metric, self.free_widths(z, z[None, : self.inner.n]))

    def columns(self, z: Array) -> dict[str, Array]:
        rows = []
        for row in z:
            inner = self.at(self.free_values(row))
            found = {name: float(c[0]) for name, c in inner.columns(self.inner_vector(row)[None]).items()}
            rows.append(found | dict(zip(self.free_names, self.free_values(row).tolist(), strict=True)))
        return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives."""
        system = self.inner.system
        return (self.inner.parameters[0], *self.free_names, *system.state_names, *system.observable_names)

    def describe_failure(self, z: Array) -> str:
        return str(self.at(self.free_values(z)).describe_failure(self.inner_vector(z)))
