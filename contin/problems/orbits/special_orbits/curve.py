"""Curves of special orbits in two parameters: unknowns, borders, and Newton by `contin.kernels.special_orbits`.

z = (u at the nodes, T, h_1 .. h_N, [further unknown], second parameter, first parameter). The further unknown of a
curve of tori is cos(theta), exp(+-i theta) the critical multipliers; it may leave [-1, 1] (neutral saddles, beyond R1
and R2). That of a curve of branch points is an unfolding: the orbit closes up to a multiple of a fixed jump, zero where
a symmetry forces the branch points.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from contin.abi import NO_FUNCTION, Array
from contin.continuation.outcome import Failure
from contin.continuation.sample import STOPS, Chunk, Sample
from contin.continuation.settings import Settings
from contin.kernels.collocation_basis import basis
from contin.kernels.special_orbits.march import CORRECT, MARCH, MEASURE, follow_special
from contin.kernels.special_orbits.memory import NOT_FINITE, TEST_COUNTS, Curve
from contin.machine import elementary
from contin.normalforms.cycles import coefficient
from contin.problems.orbits.linearised.linear import OrbitLinear
from contin.problems.orbits.march.rows import Rows
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.orbits.normal_forms.normal_form import Forms
from contin.problems.orbits.special_orbits import borders
from contin.problems.orbits.special_orbits.on_one_mesh import KINDS, Gauge, Normals, Work
from contin.problems.orbits.two_parameters import CurveOfPeriodicOrbits
from contin.records import Fields

if TYPE_CHECKING:
    from contin.problems.orbits.orbit_equations import OrbitEquations


_NO_WALLS = np.empty((0, 3))


@dataclass(frozen=True, eq=False)
class OrbitCurve(CurveOfPeriodicOrbits):
    """Equations of one type; `orbits` is the problem of the orbits themselves with the first parameter free."""

    type: str
    orbits: OrbitEquations
    second: int
    gauge: Gauge | None = None
    _works: dict[str, Work] = field(default_factory=dict)  # the kernel's memory for the last mesh
    critical: Fields = field(default_factory=dict)  # see `contin.loci.orbits.criticality`; borders

    @property
    def extra(self) -> int:
        """Scalar unknowns beside the orbit."""
        return int(self.type in ("NS", "BPC"))

    # -- layout -------------------------------------------------------------------------------------------------------

    def profile(self, z: Array) -> Profile:
        """Its states are among the unknowns, whatever the parameters."""
        return self.orbits.profile(self.orbit(z))

    def theta(self, z: Array) -> float:
        return float(elementary.acos(np.clip(z[-3], -1.0, 1.0))) if self.type == "NS" else 0.0

    def intervals(self, z: Array) -> int:
        return int((z.size - self._few) // self._many)

    @cached_property
    def _few(self) -> int:
        """Unknowns that do not belong to an interval."""
        return self.orbits.n + 3 + self.extra

    @cached_property
    def _many(self) -> int:
        """Unknowns of an interval, its length included."""
        return self.orbits.points * self.orbits.n + 1

    def nodes(self, z: Array) -> int:
        """Number of node values, the place of the period in z."""
        return self.intervals(z) * (self._many - 1) + self.orbits.n

    def critical_coefficient(self, z: Array, scale: Array) -> tuple[float, float]:
        """c of PD or Re d of NS, and the size of the terms that it is made of."""
        orbit = self.orbit(z)
        linear = OrbitLinear(self.at(z), orbit, self.orbit(scale), orbit)
        known = self.critical.setdefault("borders", {})
        found = coefficient(Forms(linear, known), self.type, self.theta(z))
        return found.value.real, found.size

    # -- the kernel ---------------------------------------------------------------------------------------------------

    def correct(
        self, z0: Array, tangent: Array, length: float, guess: Array, scale: Array, tolerance: float,
        exact: bool = True,
    ) -> Sample | Failure:  # fmt: skip
        """Newton on the plane <tangent, (z - z0) / scale> = length; or why it failed.

        `exact` : tangent and multipliers belong to the solution itself, else to the last iterate but one. An infinite
        tolerance only measures at `guess`.
        """
        return self._corrected(self._work(guess, scale), z0, tangent, length, guess, scale, tolerance, exact)

    def carried(self, sample: Sample, scale: Array) -> tuple[Self, Sample | Failure]:
        """The curve with its borders, and the sense of its normals, taken on to a point; and the point, measured."""
        work = self._work(sample.z, scale)
        for _ in range(2 if self.type == "BPC" else 1):  # the second time in the coordinates of the borders carried on
            found = self._corrected(work, sample.z, sample.tangent, 0.0, sample.z, scale, np.inf, mode=MEASURE)
        return replace(self, gauge=work.gauge()), found

    def _corrected(
        self, work: Work, z0: Array, tangent: Array, length: float, guess: Array, scale: Array, tolerance: float,
        exact: bool = True, mode: int = CORRECT,
    ) -> Sample | Failure:  # fmt: skip
        rows = self._rows(1, z0, tangent)
        rows.z[1] = guess
        rows.info[3] = np.inf
        controls = np.array([length, 0.0, 0.0, 0.0, tolerance, 0.0, 0.0, float(exact)])
        status = self._follow(mode, work, scale, controls, _NO_WALLS, 1, None, rows)
        if status < 0:
            return Failure.NOT_FINITE if status == NOT_FINITE else Failure.NO_CONVERGENCE
        return Sample(rows.z[1], rows.t[1], rows.tests[1], int(rows.unstable[1]), rows.re[1] + 1j * rows.im[1])

    def march(
        self, origin: Sample, before: Sample | None, length: float, scale: Array, step: float, limit: int,
        walls: Sequence[tuple[int, float, float]], settings: Settings, straight: bool = False,
    ) -> tuple[Chunk, tuple[int, float] | None]:  # fmt: skip
        """Follow the curve from `origin`, where borders and tests are known.

        straight : whether other curves beside it are not looked for. Else the second value is the row before which the
        curve has first turned off beside one, and the length of the step that had led to that one.
        """
        rows = self._rows(limit, origin.z, origin.tangent)
        rows.tests[0], rows.unstable[0] = origin.tests, origin.unstable
        rows.re[0], rows.im[0] = origin.eigenvalues.real, origin.eigenvalues.imag
        angle = np.radians(settings.max_angle)
        controls = np.array([
            step, settings.min_step, settings.max_step, elementary.cos(angle), settings.newton_tolerance,
            0.0 if before is None else length, angle / 2.5, 0.0,
        ])  # fmt: skip
        work, bounds = self._work(origin.z, scale), np.array(walls, dtype=float)
        work.side = 0.0 if straight else work.side
        stop = STOPS[self._follow(MARCH, work, scale, controls, bounds, limit, before, rows)]
        crossed = (int(rows.info[8]),) if rows.info[8] > 0.0 else ()
        turned = (int(rows.info[9]), float(rows.info[10])) if rows.info[9] > 0.0 else None
        return replace(rows.chunk(stop), gauge=work.gauge(), crossed=crossed), turned

    def _follow(
        self, mode: int, work: Work, scale: Array, controls: Array, walls: Array, limit: int, before: Sample | None,
        rows: Rows,
    ) -> int:  # fmt: skip
        rows.info[6], rows.info[7] = work.normals.count, work.side
        status = int(follow_special(
            mode, self.orbits.equations, self._constants, work.points, work.factors, work.scratch, work.borders,
            work.memory, scale, self._sizes(rows.z[0], scale), work.weights, controls, walls, limit,
            rows.z[0] if before is None else before.z, rows.t[0] if before is None else before.tangent,
            work.normals.room_for(limit + 1), rows.z, rows.t, rows.tests, rows.unstable, rows.re, rows.im, rows.lengths,
            rows.info,
        ))  # fmt: skip
        work.normals.count, work.side = int(rows.info[6]), float(rows.info[7])
        return status

    def _rows(self, limit: int, z: Array, tangent: Array) -> Rows:
        rows = Rows.of(limit + 1, z.size, TEST_COUNTS[KINDS[self.type]], self.orbits.n)
        rows.z[0], rows.t[0] = z, tangent
        return rows

    def _sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes."""
        n = self.orbits.n
        weight = z[self.nodes(z) + 1] * self._first_weight
        return np.asarray(scale[:n] * np.sqrt(weight / n))

    @cached_property
    def _first_weight(self) -> float:
        return float(basis(self.orbits.points).node_weights[0])

    @cached_property
    def _constants(self) -> Any:
        forcing = self.orbits.forcing
        of_period = NO_FUNCTION if forcing is None else forcing.gradient_address
        return Curve(KINDS[self.type], self.orbits.system.gradient_address, of_period, self.second)

    def _mesh(self, z: Array) -> Array:
        nodes = self.nodes(z)
        return z[nodes + 1 : nodes + 1 + self.intervals(z)]

    def _work(self, z: Array, scale: Array) -> Work:
        """The kernel's memory, with the borders chosen; where they are of another mesh, with some that fit at z."""
        own = self if self._fits(z) else self.settled(z, scale)
        assert own.gauge is not None
        work = self._memory(z)
        work.take(own.gauge)
        return work

    def _fits(self, z: Array) -> bool:
        return self.gauge is not None and np.array_equal(self.gauge.mesh, self._mesh(z))

    def _memory(self, z: Array) -> Work:
        mesh, known = self._mesh(z), self._works.get("last")
        if known is None or not np.array_equal(known.mesh, mesh):
            p = self.at(z).full_parameters(z)
            known = self._works["last"] = Work.of(self.type, self.orbits, p, mesh.copy())
        return known

    # -- the borders --------------------------------------------------------------------------------------------------

    def settled(self, z: Array, scale: Array) -> Self:
        """The curve with borders that fit at z: directions of the parameters, rows and jumps from singular vectors."""
        work, widths = self._begun(z, scale), scale[[-1, -2]]
        for _ in range(2):
            measured = self._corrected(work, z, np.ones_like(z), 0.0, z, scale, np.inf)
            with suppress(np.linalg.LinAlgError):  # of very long orbits: the borders before serve
                borders.set_borders(self.type, work, self._units(z, scale), self.further(z))
            if self.type != "LPC":
                break
            if not isinstance(measured, Failure):
                borders.turn(work.borders, widths, 1.0, -float(work.memory.y[1, work.nodes + 1]))
        return replace(self, gauge=work.gauge())

    def _begun(self, z: Array, scale: Array) -> Work:
        """The kernel's memory with the borders before, or some that are regular almost surely; normals as they were."""
        work = self._memory(z)
        work.normals = Normals()
        if self.gauge is not None:
            work.take(self.gauge)
        if not self._fits(z):
            borders.begin(work.borders, scale[[-1, -2]])
        return work

    def _units(self, z: Array, scale: Array) -> Array:
        """Scales of (u(0), T, s)."""
        return np.append(self._sizes(z, scale), [scale[self.nodes(z)], 1.0])
