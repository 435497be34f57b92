"""Curves of special orbits in two parameters: unknowns, borders, and Newton by `contin.kernels.special_orbits`.

z = (u at the nodes, T, h_1 .. h_N, [further unknown], second parameter, first parameter). The further unknown of a
curve of tori is cos(theta), exp(+-i theta) the critical multipliers; it may leave [-1, 1] (neutral saddles, beyond R1
and R2). That of a curve of branch points is an unfolding: the orbit closes up to a multiple of a fixed jump, zero where
a symmetry forces the branch points.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.problems.orbits.layout import Profile
from contin.problems.orbits.problem import OrbitProblem

KINDS: Final = {"LPC": 0, "PD": 1, "NS": 2, "BPC": 3}
STILL = 1e-8  # a part of the unit tangent this small has no direction


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


@dataclass(eq=False)
class _Work:
    """Memory of the kernel for one mesh, and the frame that the curve's equations are written in."""

    mesh: Array
    points: Any
    factors: Any
    scratch: Any
    memory: Any
    frame: Any
    weights: Array  # of differences between the neighbours of the inner nodes, repeated for every state
    settled: bool = False
    normals: list[tuple[Array, Array]] = field(default_factory=list)  # (parameters, unit normal of the curve there)


@dataclass(frozen=True, eq=False)
class OrbitCurve:
    """Equations of one type; `orbits` is the problem of the orbits themselves with the first parameter free."""

    type: str
    orbits: OrbitProblem
    second: int
    _works: dict[str, _Work] = field(default_factory=dict)

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
        n = self.orbits.n
        nodes = (self._works["now"].mesh.size * self.orbits.points + 1) * n
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
        n, m = self.orbits.n, self.orbits.points
        count = (z.size - n - 3 - self.extra) // (m * n + 1)
        h = z[(count * m + 1) * n + 1]
        weight = h * self._first_weight
        return np.asarray(scale[:n] * np.sqrt(weight / n))

    @cached_property
    def _first_weight(self) -> float:
        from contin.kernels.collocation_basis import basis

        return float(basis(self.orbits.points).node_weights[0])

    @cached_property
    def _constants(self) -> Any:
        from contin.kernels.special_orbits.memory import Curve

        return Curve(KINDS[self.type], self.orbits.system.gradient_address, self.second)

    def _work(self, z: Array, scale: Array) -> _Work:
        profile_size = (z.size - self.orbits.n - 3 - self.extra) // (self.orbits.points * self.orbits.n + 1)
        nodes = (profile_size * self.orbits.points + 1) * self.orbits.n
        mesh = z[nodes + 1 : nodes + 1 + profile_size]
        known = self._works.get("now")
        if known is None or not np.array_equal(known.mesh, mesh):
            known = self._works["now"] = self._new_work(z, mesh.copy(), [] if known is None else known.normals)
        if not known.settled:
            known.settled = True
            self.settle(z, scale)
        return known

    def _new_work(self, z: Array, mesh: Array, normals: list[tuple[Array, Array]]) -> _Work:
        from contin.kernels.collocation_march import new_memory
        from contin.kernels.special_orbits.memory import Frame, new_curve_memory

        n, m, count = self.orbits.n, self.orbits.points, len(mesh)
        p = self.at(z).full_parameters(z)
        free = n - 1 if self.orbits.autonomous else n
        size = (count * m + 1) * n + count + 2
        points, factors, scratch = new_memory(n, m, free, count, size, p)  # type: ignore[no-untyped-call]
        memory = new_curve_memory(KINDS[self.type], n, m, count, p.size)  # type: ignore[no-untyped-call]
        frame = Frame(np.zeros(2), np.zeros(2), np.zeros((2, n + 2)), np.zeros((n, 2)), np.zeros((n, 2)))
        times = Profile(m, np.empty((count * m + 1, n)), 1.0, mesh, 0.0).times
        weights = np.repeat(1.0 / (times[2:] - times[:-2]), n)
        return _Work(mesh, points, factors, scratch, memory, frame, weights, normals=normals)

    # -- borders ------------------------------------------------------------------------------------------------------

    def settle(self, z: Array, scale: Array) -> None:
        """A frame that fits at z: directions of the parameters, rows and jumps from singular vectors."""
        work = self._work(z, scale)
        frame, n = work.frame, self.orbits.n
        widths = scale[[-1, -2]]
        if not frame.across.any():
            frame.across[:], frame.along[:] = (widths[0], 0.0), (0.0, widths[1])
            generator = np.random.default_rng(5)
            for border in (frame.rows, frame.jump, frame.start):
                border[:] = generator.normal(size=border.shape)
        sizes = self._sizes(z, scale)
        position = (len(work.mesh) * self.orbits.points + 1) * n
        units = np.concatenate([sizes, [scale[position], 1.0]])
        for _ in range(2):
            measured = self.correct(z, np.ones_like(z), 0.0, z, scale, np.inf)
            self._borders(work, units, self.further(z))
            if self.type != "LPC":
                break
            if not isinstance(measured, str):
                self._turn(work, widths, np.array([1.0, -float(work.memory.y[1, position + 1])]))

    def _borders(self, work: _Work, units: Array, further: float) -> None:
        """Rows, jumps and start vectors from the reduced matrices of the last linearisation."""
        n, frame, end = self.orbits.n, work.frame, work.factors.end
        left, right = end[:n, :n], end[:n, n : 2 * n]
        sizes = units[:n]
        whole = np.zeros((n + 1, n + 2))
        whole[:, :n] = end[: n + 1, :n] + end[: n + 1, n : 2 * n]
        whole[:, n:] = end[: n + 1, 2 * n :]
        whole[n, n:] += work.memory.corner[0]
        whole *= units
        whole[:n] = np.linalg.solve(right * sizes, whole[:n])  # rows: what the jump u(1) - u(0) would have to be
        whole[n] /= max(float(np.linalg.norm(whole[n])), 1e-300)
        matrix = whole[:, : n + 1] if self.type == "LPC" else whole
        vectors, _, null = np.linalg.svd(matrix)
        frame.rows[:] = 0.0
        for k in range(2 if self.type == "BPC" else 1):
            frame.rows[k, : matrix.shape[1]] = null[-1 - k] / units[: matrix.shape[1]]
        if self.type == "BPC":
            frame.jump[:, 0] = vectors[:n, -1] * sizes
        if self.type in ("PD", "NS"):
            monodromy = -np.linalg.solve(right * sizes, left * sizes)
            one = np.eye(n)
            critical = monodromy + one
            if self.type == "NS":
                critical = monodromy @ monodromy - 2.0 * further * monodromy + one
            vectors, _, null = np.linalg.svd(critical)
            for k in range(min(2, n)):
                frame.jump[:, k] = vectors[:, -1 - k] * sizes
                frame.start[:, k] = null[-1 - k] / sizes

    def _turn(self, work: _Work, widths: Array, direction: Array) -> None:
        """New directions of the parameters: `direction` in the basis (across, along), scaled."""
        frame = work.frame
        across = (direction[0] * frame.across + direction[1] * frame.along) / widths
        across /= float(np.linalg.norm(across))
        frame.across[:] = across * widths
        frame.along[:] = np.array([-across[1], across[0]]) * widths

    def follow(self, found: Corrected, scale: Array) -> None:
        """Carry the frame on to a new point, which was corrected last."""
        work = self._works["now"]
        if self.type == "LPC":
            work.normals.append((self._place(found.z, scale), self._normal(work, found, scale)))
        frame, n, widths = work.frame, self.orbits.n, scale[[-1, -2]]
        position = (len(work.mesh) * self.orbits.points + 1) * n
        y = work.memory.y
        if self.type == "LPC":
            self._turn(work, widths, np.array([1.0, -float(y[1, position + 1])]))
        else:
            part = found.tangent[[-1, -2]]
            if float(np.linalg.norm(part)) > STILL:
                now = np.array([frame.across @ (part / widths), frame.along @ (part / widths)])
                self._turn(work, widths, now if now[0] >= 0.0 else -now)
        if self.type == "BPC":
            return
        sizes = self._sizes(found.z, scale)
        units = np.concatenate([sizes, [scale[position], 1.0]])
        row = np.concatenate([y[2, :n], y[2, position : position + 2]]) / units
        if self.type == "LPC":
            row[-1] = 0.0
        frame.rows[0] = row / units / float(np.linalg.norm(row))
        if self.type == "PD":
            start = work.memory.v[0, :n] / sizes
            frame.start[:, 0] = start / sizes / float(np.linalg.norm(start))

    def _speed(self, work: _Work, found: Corrected, scale: Array) -> float:
        """Component of the tangent along the curve in the plane of the parameters, with a sense that never jumps.

        (p, q)' is normal to (w F_p, w F_q), w the left null vector, a direction that turns continuously along a curve
        of folds; the component vanishes at a cusp of cycles, where both parameters turn.
        """
        normal = self._normal(work, found, scale)
        if not work.normals:
            work.normals.append((self._place(found.z, scale), normal))
        part = found.tangent[[-1, -2]]
        return float(normal[0] * part[1] - normal[1] * part[0])

    def _normal(self, work: _Work, found: Corrected, scale: Array) -> Array:
        """Unit normal of the curve in the scaled plane of the parameters, in the sense of the nearest point known."""
        normal = (work.frame.across - found.slope * work.frame.along) / scale[[-1, -2]]
        normal = normal / float(np.linalg.norm(normal))
        if not work.normals:
            return np.asarray(normal)
        place = self._place(found.z, scale)
        near = min(work.normals, key=lambda known: float(np.abs(known[0] - place).sum()))
        return np.asarray(normal if float(near[1] @ normal) >= 0.0 else -normal)

    def _place(self, z: Array, scale: Array) -> Array:
        """Parameters and period, which tell points of a curve apart."""
        position = (self._works["now"].mesh.size * self.orbits.points + 1) * self.orbits.n
        return np.asarray(z[[-1, -2, position]] / scale[[-1, -2, position]])
