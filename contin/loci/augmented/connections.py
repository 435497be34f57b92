"""Folds of branches of connecting orbits between saddles, as a base of curves.

z = (u at the nodes, saddles, T, mesh, q, p), see `contin.homoclinic.equations`; T and the mesh are carried along. At
given parameters such orbits are isolated (symmetric ones of a reversible flow, those of saddles between whose manifolds
there is a direction more): F_x is square, and singular at folds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.sample import Sample
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.homoclinic.surfaces import surface_met, why_not
from contin.loci.augmented.base import Base
from contin.loci.augmented.block_bordered import BlockBordered
from contin.loci.augmented.elimination import Scalars
from contin.loci.augmented.on_connections import Chosen, Cusp, OnConnections, cusp_at, linearised
from contin.loci.augmented.singular import Assembled, Borders, null_vectors
from contin.problems.orbits.mesh.layout import trimmed
from contin.problems.two_parameters import OnAdaptiveMesh

CUSP: Final = "CP"
FIRST: Final = 2  # place of the first test among those of a sample


@dataclass(frozen=True, eq=False)
class FoldsOfConnections(OnAdaptiveMesh, Base):
    """problem : of the connections, both parameters among its unknowns."""

    problem: ConnectionProblem
    chosen: Chosen | None = None

    has_stability = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.problem.parameters

    @property
    def conditions(self) -> int:
        return 1

    @property
    def angle_periods(self) -> Array:
        return np.zeros(0)

    def scales(self, z: Array, ranges: Sequence[tuple[float, float]]) -> Array:
        return self.problem.within(ranges[0], ranges[1]).initial_scale(z, ranges[0])

    # -- what is chosen ------------------------------------------------------------------------------------------------

    @property
    def gauge(self) -> Any:
        return self.chosen

    @property
    def is_settled(self) -> bool:
        return self.chosen is not None

    def gauged(self, gauge: Any) -> Self:
        return self if gauge is None else replace(self, chosen=replace(gauge, normal=dict(gauge.normal)))

    def settled(self, z: Array, scale: Array) -> Self:
        """With phase reference, bases and borders at z."""
        problem = self.problem.settled(z, scale)
        here = linearised(problem, z, scale)
        if here is None:
            raise FloatingPointError("the equations are not finite where a curve is to be followed")
        found = null_vectors(Assembled(here[1][:, : here[1].shape[0]]), 1)
        known = {} if self.chosen is None else dict(self.chosen.normal)
        assert problem.curve.gauge is not None
        return replace(self, chosen=Chosen(problem.curve.gauge, found, scale, known))

    def _own(self, z: Array, scale: Array) -> tuple[ConnectionProblem, Borders]:
        """The connections with what is chosen, and the borders."""
        chosen = self.chosen if self.chosen is not None else self.settled(z, scale).chosen
        assert chosen is not None
        return self.problem.with_gauge(chosen.gauge), chosen.borders

    # -- equations -----------------------------------------------------------------------------------------------------

    def where(self, z: Array) -> NDArray[np.intp]:
        return self.problem.curve.unknowns(z)

    def linearise(self, z: Array, scale: Array, rows: Array) -> BlockBordered | None:
        problem, borders = self._own(z, scale)
        here = linearised(problem, z, scale)
        found = None if here is None else OnConnections(problem, z, scale).singular(here[1], borders)
        if here is None or found is None:
            return None
        (f, matrix), where = here, self.where(z)
        equations = np.concatenate([f, found.values, np.zeros(z.size - len(where))])
        return BlockBordered(equations, found, matrix[:, len(f) :].toarray(), rows[:, where], where, z.size)

    # -- tests ---------------------------------------------------------------------------------------------------------

    def _cusp(self, z: Array, scale: Array, extrapolated: bool = False) -> Cusp | None:
        problem, borders = self._own(z, scale)
        return cusp_at(OnConnections(problem, z, scale), borders, extrapolated)

    def stability(self, type_: str, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        assert self.chosen is not None
        found = self._cusp(z, self.chosen.scale)
        value = float("nan") if found is None else self.chosen.sense(found.normal) * found.value
        return np.array([value]), 0, np.zeros(0, complex)

    def types(self, curve: str) -> Sequence[str]:
        return (CUSP,)

    def test_of(self, curve: str, type_: str) -> int | None:
        return FIRST if type_ == CUSP else None

    def explain(self, type_: str, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return (CUSP,) if a.tests[FIRST] * b.tests[FIRST] < 0.0 else ()

    def degeneracy(self, curve: str, type_: str, near: Sample) -> Scalars | str:
        assert self.chosen is not None
        scale = self.chosen.scale
        own = self.settled(near.z, scale)  # with borders from here: those of a chunk's begin may be across by now
        here = own._cusp(near.z, scale)
        if here is None:
            return "the equations are singular there"

        def value(z: Array) -> Array:
            found = own._cusp(z, scale, extrapolated=True)
            return np.full(1, np.nan if found is None else found.value / here.terms)

        return value

    # -- rows ----------------------------------------------------------------------------------------------------------

    def left_reach(self, z: Array) -> tuple[int, str] | None:
        """Where the connections leave the reach of their own equations, or a saddle is none any more."""
        problem = self.problem
        left = problem.left_reach(z) if problem.has_reach else None
        for k, row in enumerate(z if left is None else z[: left[0]]):
            text = self._beyond(trimmed(row))
            if text is not None:
                return k, text
        return left

    def _beyond(self, z: Array) -> str | None:
        curve = self.problem.curve
        counts = [(0, curve.stable_count, -1.0)]
        if curve.reversor is None:
            counts.append((-1, curve.unstable_count, 1.0))
        for end, count, side in counts:
            rates = side * np.linalg.eigvals(curve.matrix(curve.equilibria(z)[end], z)).real
            if int(np.sum(rates > 0.0)) != count:
                return "an eigenvalue of the saddle passes the imaginary axis: its manifolds are others beyond"
        return None

    def columns(self, z: Array) -> dict[str, Array]:
        return self.problem.columns(z)

    def column_names(self) -> tuple[str, ...]:
        parts = ("min", "max", "saddle", "saddle2")[: 2 + self.problem.curve.saddles]
        return (*self.names, *(f"{name}.{part}" for name in self.system.state_names for part in parts))

    def describe_failure(self, z: Array) -> str:
        met = surface_met(self.problem.curve, z)
        return "" if met is None else why_not(met)
