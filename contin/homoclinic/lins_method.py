"""Lin's method: an orbit in arcs from section to section, with gaps along a fixed direction.

Arc 1 leaves the saddle x0 in its unstable eigenspace, arcs 2 .. N lead from the section back to it, the last one
ends in the stable eigenspace of x0. With c a point of the section, d its normal and Z the Lin direction,

    u_k' = T_k f(u_k),   u_k(1) - u_(k+1)(0) = gap_k Z,   <d, u_(k+1)(0) - c> = 0,   k = 1 .. N,

has for all times T_k and parameters near a homoclinic orbit one solution with small gaps (Lin 1990; Oldeman, Champneys
and Krauskopf, Int. J. Bifurcation and Chaos 13 (2003) 2977). Where all gaps vanish the arcs are one orbit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.homoclinic.subspaces import left_subspace
from contin.kernels.collocation_basis import basis
from contin.linalg.csc import with_columns, with_rows
from contin.linalg.newton import Rules, newton, solution
from contin.problems.orbits.linearised.pattern import block_places
from contin.problems.orbits.mesh.adaption import choose_mesh
from contin.problems.orbits.mesh.layout import Profile, in_intervals

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from contin.lowering.system import CompiledSystem

NEWTON: Final = Rules(settled=1e-10, stalled=1e-7, far=10.0)
AT_REST: Final = Rules(settled=1e-13)  # of the saddle, in sizes of states
NUDGE: Final = 1e-6  # relative, for derivatives of the ends by a parameter


@dataclass(frozen=True, eq=False)
class Section:
    """c, d and Z in states, (n,) each."""

    point: Array
    normal: Array
    direction: Array


@dataclass(frozen=True, eq=False)
class Arcs:
    """The arcs with their times, the gaps (N,), and the parameter `first` at its value in p."""

    system: CompiledSystem
    p: Array
    first: int
    saddle: Array
    section: Section
    sizes: Array
    stable: int  # dimensions of the eigenspaces of the saddle
    unstable: int
    arcs: tuple[Profile, ...]
    gaps: Array

    # -- solving -------------------------------------------------------------------------------------------------------

    def solved(self, unknown: Sequence[int], times: Sequence[int], by_parameter: bool) -> Arcs | None:
        """With some gaps, times of arcs and the parameter unknown, as many together as there are gaps.

        unknown : the gaps.  times : the arcs whose time is.  None where Newton's method fails.
        """
        from scipy.sparse.linalg import splu

        def correct(now: Arcs) -> tuple[float, Arcs] | None:
            found = now._system(unknown, times, by_parameter)
            if found is None:
                return None
            residual, matrix, scale = found
            try:
                step = splu(matrix).solve(-residual)
            except RuntimeError:  # singular: no step
                return None
            size = float(np.max(np.abs(step)))
            there = now._moved(step * scale, unknown, times, by_parameter) if size < NEWTON.far else None
            return None if there is None else (size, there)

        found = newton(correct, self, NEWTON)
        return None if found is None else found.at

    def _moved(self, step: Array, unknown: Sequence[int], times: Sequence[int], by_parameter: bool) -> Arcs | None:
        place, arcs = 0, []
        for arc in self.arcs:
            arcs.append(replace(arc, u=arc.u + step[place : place + arc.u.size].reshape(arc.u.shape)))
            place += arc.u.size
        gaps, p = self.gaps.copy(), self.p.copy()
        gaps[list(unknown)] += step[place : place + len(unknown)]
        place += len(unknown)
        for k in times:
            arcs[k] = replace(arcs[k], period=arcs[k].period + float(step[place]))
            place += 1
            if arcs[k].period <= 0.0:
                return None
        if by_parameter:
            p[self.first] += step[place]
        moved = replace(self, arcs=tuple(arcs), gaps=gaps, p=p)
        return moved.at_rest()

    def at_rest(self) -> Arcs | None:
        """With the saddle of its parameters."""

        def correct(u: Array) -> tuple[float, Array] | None:
            f, whole = self.system.jacobian(u, self.p)
            step = solution(np.asarray(whole)[:, : self.system.n], -np.asarray(f))
            return None if step is None else (float(np.max(np.abs(step) / self.sizes)), u + step)

        found = newton(correct, self.saddle, AT_REST)
        return None if found is None else replace(self, saddle=found.at)

    def ends(self) -> Array | None:
        """Projections that vanish at both ends, (n,)."""
        n, own = self.system.n, self.at_rest()
        if own is None:
            return None
        first, last = own._projections()
        offsets = [(self.arcs[0].u[0] - own.saddle) / self.sizes, (self.arcs[-1].u[-1] - own.saddle) / self.sizes]
        return np.concatenate([first.T @ offsets[0], last.T @ offsets[1]])[:n]

    def _projections(self) -> tuple[Array, Array]:
        matrix = np.asarray(self.system.jacobian(self.saddle, self.p)[1])[:, : self.system.n]
        scaled = matrix * self.sizes / self.sizes[:, None]
        return tuple(_gauged(left_subspace(scaled, k, s)) for k, s in ((self.stable, True), (self.unstable, False)))  # type: ignore[return-value]

    def _system(
        self, unknown: Sequence[int], times: Sequence[int], by_parameter: bool
    ) -> tuple[Array, csc_matrix, Array] | None:
        from scipy import sparse

        n, s = self.system.n, self.sizes
        own = self.at_rest()
        if own is None:
            return None
        starts = np.concatenate([[0], np.cumsum([arc.u.size for arc in self.arcs])])
        total, gaps = int(starts[-1]), len(self.gaps)
        width = total + gaps
        columns = {k: total + len(unknown) + j for j, k in enumerate(times)}
        equations = total - n * len(self.arcs)
        blocks, values, beside, first = [], [], np.zeros((equations, gaps)), 0
        for k, arc in enumerate(self.arcs):
            defect, own_blocks, by_time, by_p = self._collocation(arc)
            places = block_places(n, arc.m, arc.intervals)
            blocks.append((own_blocks.ravel()[places.order], places.indices + first, np.diff(places.starts)))
            values.append(defect)
            below = slice(first, first + len(defect))
            if k in columns:
                beside[below, columns[k] - total] = by_time
            if by_parameter:
                beside[below, -1] = by_p
            first += len(defect)
        closing = self._closing(own, starts, width, unknown, by_parameter)
        if closing is None:
            return None
        rest, dense = closing
        data, indices, counts = (np.concatenate(parts) for parts in zip(*blocks, strict=True))
        starts_of_columns = np.concatenate([[0], np.cumsum(counts)])
        top = sparse.csc_matrix((data, indices, starts_of_columns), shape=(equations, total))
        matrix = with_rows(with_columns(top, beside), dense)
        scale = np.concatenate([np.tile(s, total // n), np.ones(gaps)])
        return np.concatenate([*values, *rest]), matrix, scale

    def _closing(
        self, own: Arcs, starts: NDArray[np.intp], width: int, unknown: Sequence[int], by_parameter: bool
    ) -> tuple[list[Array], Array] | None:
        """Projections at both ends, gaps and sections, with their dense rows."""
        n, s, section, gaps, total = self.system.n, self.sizes, self.section, len(self.gaps), int(starts[-1])
        dense = np.zeros((n + gaps * (n + 1), width))
        ends = self.ends()
        if ends is None:
            return None
        first, last = own._projections()
        dense[: self.stable, :n] = first.T
        dense[self.stable : n, total - n : total] = last.T
        if by_parameter:
            h = NUDGE * max(abs(float(self.p[self.first])), 1e-3)
            p = self.p.copy()
            p[self.first] += h
            after = replace(self, p=p).ends()
            if after is None:
                return None
            dense[:n, width - 1] = (after - ends) / h
        rest = [ends]
        for k in range(gaps):
            row = n + k * (n + 1)
            end, start = int(starts[k + 1]) - n, int(starts[k + 1])
            jump = (self.arcs[k].u[-1] - self.arcs[k + 1].u[0] - self.gaps[k] * section.direction) / s
            dense[row : row + n, end : end + n] = np.eye(n)
            dense[row : row + n, start : start + n] = -np.eye(n)
            if k in unknown:
                dense[row : row + n, total + list(unknown).index(k)] = -section.direction / s
            dense[row + n, start : start + n] = section.normal * s
            rest += [jump, np.array([section.normal @ (self.arcs[k + 1].u[0] - section.point)])]
        return rest, dense

    def _collocation(self, arc: Profile) -> tuple[Array, Array, Array, Array]:
        """Defects, their blocks by nodes, and by the time and the parameter, in states relative to their sizes."""
        n, m, scheme, s = self.system.n, arc.m, basis(arc.m), self.sizes
        states = in_intervals(scheme.values, arc.u).reshape(-1, n)
        f, whole = self.system.jacobians(states, np.tile(self.p, (len(states), 1)))
        f, whole = np.asarray(f).reshape(-1, m, n), np.asarray(whole).reshape(arc.intervals, m, n, -1)
        long = arc.h * arc.period
        defect = in_intervals(scheme.slopes, arc.u) - long[:, None, None] * f
        blocks = -np.einsum("i,cj,ickq->ickjq", long, scheme.values, whole[..., :n])
        blocks += np.einsum("cj,kq->ckjq", scheme.slopes, np.eye(n))
        blocks *= (s / s[:, None])[None, None, :, None, :]
        by_time, by_p = -arc.h[:, None, None] * f / s, -long[:, None, None] * whole[..., n + self.first] / s
        return (defect / s).ravel(), blocks, by_time.ravel(), by_p.ravel()

    # -- changes -------------------------------------------------------------------------------------------------------

    def shorter(self, k: int, time: float) -> Arcs:
        """The arc k without some time where it is nearest to the saddle, on a mesh that fits it."""
        arc = self.arcs[k]
        t = arc.times * arc.period
        near = float(t[int(np.argmin(np.linalg.norm((arc.u - self.saddle) / self.sizes, axis=1)))])
        near = float(np.clip(near, 0.5 * time, arc.period - 0.5 * time))

        def kept(s: Array) -> Array:
            at = s * (arc.period - time)
            return arc.at(np.where(at < near - 0.5 * time, at, at + time) / arc.period)

        even = np.full(arc.intervals, 1.0 / arc.intervals)
        fresh = Profile(arc.m, np.empty_like(arc.u), arc.period - time, even, arc.parameter)
        fresh = replace(fresh, u=kept(fresh.times))
        h = choose_mesh(arc, self.sizes, MESH, arc.intervals).h
        fresh = replace(fresh, h=h)
        fresh = replace(fresh, u=kept(fresh.times))
        return replace(self, arcs=(*self.arcs[:k], fresh, *self.arcs[k + 1 :]))

    def whole(self) -> tuple[Array, Array]:
        """Times and states of the arcs in a row."""
        times, states, began = [], [], 0.0
        for k, arc in enumerate(self.arcs):
            t = arc.times * arc.period + began
            times.append(t[1:] if k else t)
            states.append(arc.u[1:] if k else arc.u)
            began = float(t[-1])
        return np.concatenate(times), np.concatenate(states)


MESH: Final = 1e-7


def _gauged(basis_: Array) -> Array:
    """The same space with a basis that varies smoothly with it: the rows where it is largest are the identity."""
    from scipy.linalg import qr

    if basis_.shape[1] == 0:
        return basis_
    pivots = qr(basis_.T, pivoting=True)[2][: basis_.shape[1]]
    return np.asarray(np.linalg.solve(basis_[pivots].T, basis_.T).T)
