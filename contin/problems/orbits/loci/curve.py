"""Curves of special orbits in two parameters: unknowns, borders, and Newton by `contin.kernels.special_orbits`.

z = (u at the nodes, T, h_1 .. h_N, [further unknown], second parameter, first parameter). The further unknown of a
curve of tori is cos(theta), exp(+-i theta) the critical multipliers; it may leave [-1, 1] (neutral saddles, beyond R1
and R2). That of a curve of branch points is an unfolding: the orbit closes up to a multiple of a fixed jump, zero where
a symmetry forces the branch points.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.vectors import norm
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.loci import frames
from contin.problems.orbits.loci.work import KINDS, Normals, Work
from contin.problems.orbits.problem import OrbitProblem


@dataclass(frozen=True, eq=False)
class Corrected:
    """A point of the curve: z, unit tangent (scaled), multipliers, and how hard it was."""

    z: Array
    tangent: Array
    multipliers: NDArray[np.complex128]
    iterations: int
    first_correction: float
    slope: float  # s part of y[1], see `contin.kernels.special_orbits`
    speed: float  # signed length of the tangent's part in the parameters, see `OrbitCurve._speed`
    curvature: float  # of Newton's corrections, see `OrbitCurve.correct`


@dataclass(frozen=True, eq=False)
class OrbitCurve:
    """Equations of one type; `orbits` is the problem of the orbits themselves with the first parameter free."""

    type: str
    orbits: OrbitProblem
    second: int
    _works: dict[str, Work] = field(default_factory=dict)
    critical: dict[str, Any] = field(default_factory=dict)  # see `contin.problems.orbits.loci.criticality`

    @property
    def system(self) -> Any:
        return self.orbits.system

    @property
    def base(self) -> Array:
        return self.orbits.base

    @property
    def first(self) -> int:
        return self.orbits.active

    @property
    def extra(self) -> int:
        """Scalar unknowns beside the orbit."""
        return int(self.type in ("NS", "BPC"))

    # -- layout -------------------------------------------------------------------------------------------------------

    def join(self, orbit: Array, q: float, further: float = 0.0) -> Array:
        """z from an orbit's own vector (u, T, h, p)."""
        return np.concatenate([orbit[:-1], [further] * self.extra, [q, orbit[-1]]])

    def orbit(self, z: Array) -> Array:
        """(u, T, h, p), also of a metric or tangent."""
        return np.append(z[: -2 - self.extra], z[-1])

    def further(self, z: Array) -> float:
        """cos(theta) or the unfolding; 0 where there is neither."""
        return float(z[-3]) if self.extra else 0.0

    def theta(self, z: Array) -> float:
        return float(np.arccos(np.clip(z[-3], -1.0, 1.0))) if self.type == "NS" else 0.0

    def at(self, z: Array) -> OrbitProblem:
        """The orbits' problem at the second parameter's value in z."""
        base = self.orbits.base.copy()
        base[self.second] = z[-2]
        return replace(self.orbits, base=base)

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

    def profile(self, z: Array) -> Profile:
        return self.orbits.profile(self.orbit(z))

    # -- equations ----------------------------------------------------------------------------------------------------

    def correct(
        self, z0: Array, tangent: Array, length: float, guess: Array, scale: Array, tolerance: float,
        exact: bool = True, curvature: float = np.inf,
    ) -> Corrected | str:  # fmt: skip
        """Newton on the plane <tangent, (z - z0) / scale> = length; a string says why it failed.

        `exact` : tangent and multipliers belong to the solution itself, else to the last iterate but one. An infinite
        tolerance only measures at `guess`. `curvature` : what the second correction was beside the square of the first
        one nearby; with it a first correction is believed where the second would be nothing.
        """
        from contin.kernels.special_orbits.correct import correct_special
        from contin.kernels.special_orbits.memory import NOT_FINITE

        work = self._work(guess, scale)
        n = self.orbits.n
        guess = self._in_phase(z0, guess, scale)
        out_z, out_t = np.empty(z0.size), np.empty(z0.size)
        re, im, info = np.empty(n), np.empty(n), np.array([0.0, 0.0, 0.0, curvature])
        status = int(correct_special(
            self.orbits.equations, self._constants, work.points, work.factors, work.scratch, work.frame, work.memory,
            z0, tangent, scale, self._sizes(z0, scale), length, guess, tolerance, exact, out_z, out_t, re, im, info,
        ))  # fmt: skip
        if status < 0:
            return "not finite" if status == NOT_FINITE else "no convergence"
        found = Corrected(out_z, out_t, re + 1j * im, status, float(info[0]), float(info[2]), 1.0, float(info[3]))
        return replace(found, speed=self._speed(work, found, scale)) if self.type == "LPC" else found

    def _in_phase(self, z0: Array, guess: Array, scale: Array) -> Array:
        """The guess, to which the kernel's phase condition refers, shifted in time until it is in phase with z0."""
        n, nodes = self.orbits.n, self.nodes(z0)
        if not self.orbits.autonomous or guess is z0:
            return guess
        u, metric = z0[:nodes], scale[:nodes]
        drift = np.zeros(nodes)  # u'
        drift[n:-n] = (u[2 * n :] - u[: -2 * n]) * self._works["now"].weights
        drift /= metric
        size = float(drift @ drift)
        if size == 0.0:
            return guess
        shift = float(((guess[:nodes] - u) / metric) @ drift) / size
        aligned = guess.copy()
        aligned[:nodes] -= shift * drift * metric
        return aligned

    def _sizes(self, z: Array, scale: Array) -> Array:
        """The states' sizes."""
        n = self.orbits.n
        weight = z[self.nodes(z) + 1] * self._first_weight
        return np.asarray(scale[:n] * np.sqrt(weight / n))

    @cached_property
    def _first_weight(self) -> float:
        from contin.kernels.collocation_basis import basis

        return float(basis(self.orbits.points).node_weights[0])

    @cached_property
    def _constants(self) -> Any:
        from contin.kernels.special_orbits.memory import Curve

        return Curve(KINDS[self.type], self.orbits.system.gradient_address, self.second)

    def _work(self, z: Array, scale: Array) -> Work:
        nodes = self.nodes(z)
        mesh = z[nodes + 1 : nodes + 1 + self.intervals(z)]
        known = self._works.get("now")
        if known is None or not np.array_equal(known.mesh, mesh):
            normals = Normals() if known is None else known.normals
            p = self.at(z).full_parameters(z)
            known = self._works["now"] = Work.of(self.type, self.orbits, p, mesh.copy(), normals)
        if not known.settled:
            known.settled = True
            self.settle(z, scale)
        return known

    # -- the frame ----------------------------------------------------------------------------------------------------

    def settle(self, z: Array, scale: Array) -> None:
        """A frame that fits at z: directions of the parameters, rows and jumps from singular vectors."""
        work, widths = self._work(z, scale), scale[[-1, -2]]
        if not work.frame.across.any():
            frames.begin(work.frame, widths)
        for _ in range(2):
            measured = self.correct(z, np.ones_like(z), 0.0, z, scale, np.inf)
            frames.set_borders(self.type, work, self._units(z, scale), self.further(z))
            if self.type != "LPC":
                break
            if not isinstance(measured, str):
                frames.turn(work.frame, widths, 1.0, -measured.slope)

    def follow(self, found: Corrected, scale: Array) -> None:
        """Carry the frame on to a new point, which was corrected last."""
        work = self._works["now"]
        if self.type == "LPC":
            work.normals.add(self._place(found.z, scale), self._normal(work, found, scale))
        frames.carry(self.type, work, self._units(found.z, scale), scale[[-1, -2]], found.tangent)

    def _units(self, z: Array, scale: Array) -> Array:
        """Scales of (u(0), T, s)."""
        return np.append(self._sizes(z, scale), [scale[self.nodes(z)], 1.0])

    def _speed(self, work: Work, found: Corrected, scale: Array) -> float:
        """Component of the tangent along the curve in the plane of the parameters, with a sense that never jumps.

        (p, q)' is normal to (w F_p, w F_q), w the left null vector, a direction that turns continuously along a curve
        of folds; the component vanishes at a cusp of cycles, where both parameters turn.
        """
        normal = self._normal(work, found, scale)
        if not work.normals.count:
            work.normals.add(self._place(found.z, scale), normal)
        p, q = float(found.tangent[-1]), float(found.tangent[-2])
        return float(normal[0]) * q - float(normal[1]) * p

    def _normal(self, work: Work, found: Corrected, scale: Array) -> Array:
        """Unit normal of the curve in the scaled plane of the parameters, in the sense of the nearest point known."""
        normal = (work.frame.across - found.slope * work.frame.along) / scale[[-1, -2]]
        return work.normals.oriented(self._place(found.z, scale), normal / norm(normal))

    def _place(self, z: Array, scale: Array) -> Array:
        """Parameters and period, which tell points of a curve apart."""
        places = [-1, -2, self.nodes(z)]
        return np.asarray(z[places] / scale[places])
