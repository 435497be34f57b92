"""Solutions of a boundary-value problem by orthogonal collocation, as a continuation problem in one parameter.

z = (u at the nodes, 1, mesh, p) as of periodic orbits (`contin.problems.orbits.mesh.layout`), u the unknown functions
of `contin.bvp.two_point`: states, free parameters, integrals. No stability: labels are LP, BP, and user values.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.bvp import changing_formulas, defects, marched, special_points
from contin.bvp.boundary_equations import BoundaryEquations
from contin.bvp.condensed import Condensed, linearise, residual_at
from contin.bvp.continuum import NONE, free_function
from contin.bvp.defects import NO_PART, resolving
from contin.bvp.functionals import columns_of, functions_at, own_column
from contin.bvp.kernel_at_branch_point import smallest, undetermined
from contin.bvp.on_mesh import OnMesh
from contin.bvp.sizes import couplings, filled, largest, moved, noticed, without_remnants
from contin.bvp.solutions_at_parameter import at_parameter
from contin.continuation.branch import End
from contin.continuation.location.sameness import slack
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.problem import Problem, Renewal
from contin.continuation.sample import Chunk, Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.problems.orbits.mesh.adaption import SMALLEST, estimate, unresolved
from contin.problems.orbits.mesh.finer import on_half_lengths
from contin.problems.orbits.mesh.layout import Profile, make_scale, trimmed
from contin.problems.orbits.mesh.move import Move
from contin.problems.orbits.renewal import refitted
from contin.problems.scales import parameter_width

SENSITIVITY_CAP = 10.0  # near a fold du/dp says nothing: it may enlarge a size by this factor at most
STANDING = 1e-9  # part of the tangent below which the parameter does not change
TRIVIAL = 1e-6  # of the tolerance: a solution with a smaller error says nothing about its mesh
SAME = 1e-6  # difference of two solutions, relative to their sizes (and the metric's), up to which they are one


@dataclass(frozen=True, eq=False)
class BoundaryProblem(BoundaryEquations):
    """The equations of `BoundaryEquations`, followed by a compiled march."""

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def configured(self, seed: Seed, settings: Settings) -> Seed:
        """On the mesh that is asked for."""
        if seed.born or (settings.points == self.points and settings.intervals == self.intervals):
            return seed
        problem = replace(self, points=settings.points, intervals=settings.intervals, spaces={})
        old = self.profile(seed.z)
        count = settings.intervals or old.intervals
        h = problem.laid(old.h if count == old.intervals else np.full(count, 1.0 / count), old)
        target = Profile(settings.points, np.empty((len(h) * settings.points + 1, old.n)), 1.0, h, old.parameter)
        return replace(seed, problem=problem, z=replace(target, u=old.at(target.times)).vector())

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        width = parameter_width(self.two.model, self.parameters[0], float(z[-1]), bounds)
        profile = self.profile(z)
        return make_scale(profile.h, self.points, self.natural_sizes(z, profile, width), 1.0, width)

    def natural_sizes(self, z: Array, profile: Profile, width: float) -> Array:
        """Declared sizes; else those of the solution, or how far the parameter's range moves it to first order.

        A size that no equation would notice is rounding, and says nothing (`contin.bvp.sizes`).
        """
        z = without_remnants(self, z)
        size = largest(self, self.profile(z))
        fixed = np.zeros_like(z)
        fixed[-1] = 1.0
        here = linearise(self, z, fixed, np.ones_like(z))
        motion = np.zeros(self.n)
        if here is not None and here.sign != 0.0:
            response = here.solve(np.append(np.zeros(z.size - 1), 1.0))[: profile.u.size].reshape(-1, self.n)
            found = np.abs(response).max(axis=0) * width
            motion = np.where(np.isfinite(found), found, 0.0)
        declared = np.zeros(self.n)
        declared[: self.two.n_states] = self.two.model.scales(self.constants())
        coupling = couplings(self, z)
        seen = noticed(np.where(declared > 0.0, declared, size), coupling)
        grown = np.where(seen > 0.0, np.maximum(seen, np.minimum(motion, SENSITIVITY_CAP * seen)), 0.0)
        grown = moved(grown, motion, coupling)
        sizes = noticed(np.where(declared > 0.0, declared, grown), coupling)
        return filled(sizes, coupling)

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> Condensed | None:
        return linearise(self, z, tangent, scale)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """There is none."""
        return np.zeros(0), 0, np.zeros(0, complex)

    def tangents(self, z: Array, scale: Array) -> Sequence[Array]:
        return special_points.tangents(self, z, scale)

    def march(
        self, origin: Sample, before: Sample | None, length: float, frame: Frame, step: float, limit: int,
        bounds: tuple[float, float], settings: Settings, loop: Sample | None,
    ) -> Chunk:  # fmt: skip
        return marched.march(self, origin, before, length, frame, step, limit, bounds, settings, loop)

    def probe(self, base: Sample, length: float, guess: Array, frame: Frame, settings: Settings) -> Sample | None:
        return marched.probe(self, base, length, guess, frame, settings)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        mesh = defects.finer(self, self.profile(sample.z), self.sizes(sample.z, frame.scale))
        found = on_half_lengths(self, sample, frame, mesh)
        return None if found is None else (self, *found)

    def at_parameter(self, guess: Array, value: float, scale: Array) -> Array | None:
        return at_parameter(self, guess, value, scale)

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return special_points.explain(a, b)

    def test_of(self, type_: str) -> int | None:
        return {"LP": 0, "BP": 1}.get(type_)  # None for those with a test of their own

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return special_points.verify(self, type_, near, frame)

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return special_points.verify_compound(self, a, b, frame)

    def end_at(self, point: Verified) -> End | None:
        free = int(point.vectors.get("free", NONE))
        return None if free == NONE else self._at_continuum(free, float(point.z[-1]))

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        mesh = OnMesh(self, self.profile(origin.z).h)
        x = mesh.unknowns(origin.z)
        if mesh.linear(x) is None:
            return None
        free = free_function(mesh, x, smallest(mesh, x), mesh.unknowns(frame.scale)[:-1])
        if free == NONE:
            return None
        return Renewal(frame.scale, origin, before, None, self._at_continuum(free, float(x[-1])))

    def _at_continuum(self, place: int, at: float) -> End:
        name, free = self.parameters[0], self.two.names[place]
        text = (
            f"met a continuum of solutions at {name} = {at:.10g}, where {free} can be moved with {name} fixed (beyond, "
            "a branch may be its own image)"
        )
        return End("joined", text, {"at": at})

    def laid(self, h: Array, profile: Profile) -> Array:
        """See `contin.problems.orbits.mesh.adaptive_problem.Meshed`."""
        return changing_formulas.laid(h, changing_formulas.places(self, profile), self.intervals is not None)

    def mesh_error(self, z: Array, sizes: Array) -> float:
        return estimate(self.profile(z), sizes, self.closed)[0]

    def column(self, name: str, z: Array) -> Array:
        return own_column(self, name, z)

    def columns(self, z: Array) -> dict[str, Array]:
        return columns_of(self, z)

    def functions_at(self, z: Array) -> dict[str, Array]:
        """The independent variable as `t`, and the states, at the nodes."""
        return functions_at(self, z)

    def column_names(self) -> tuple[str, ...]:
        """Names that `columns` gives, for user values."""
        states = (f"{s}.{e}" for s in self.two.model.state_names for e in ("start", "end", "min", "max", "norm"))
        return (self.parameters[0], *self.two.free, *states, *self.two.model.observables)

    # -- the mesh ------------------------------------------------------------------------------------------------------

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """The mesh and the sizes for the next chunk."""
        end = _standing(self, origin, before)
        if end is not None:
            return Renewal(frame.scale, origin, before, loop, end)
        profile = self.profile(origin.z)
        sizes = self.sizes(origin.z, frame.scale)
        null = self._nearest_to_null(origin.z) if self._is_trivial(profile, sizes) else None
        fit = refitted(self, profile, sizes, 1.0, None if null is None else _of_size_one(null))
        h, sizes = (profile.h, sizes) if fit is None else (fit.h, fit.sizes)
        if self.intervals is None:
            h = resolving(self, profile, h, sizes, beside=null)
        if fit is None and len(h) == profile.intervals:
            return Renewal(frame.scale, origin, before, loop)
        scale = make_scale(h, self.points, sizes, 1.0, float(frame.scale[-1]))
        move = Move(self, frame.scale, scale, h)
        first, earlier, start = move.each(origin, before, loop)
        assert first is not None
        return Renewal(scale, first, earlier, start)

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        profile = self.profile(z[0])
        natural = self.natural_sizes(trimmed(z[0]), profile, abs(profile.parameter) or 1.0)
        rooms = (changing_formulas.remark, defects.remark, defects.remark_on_ends)
        return [remark for remark in (words(self, z, natural) for words in rooms) if remark]

    def _is_trivial(self, profile: Profile, sizes: Array) -> bool:
        """Whether no error of the mesh is seen on a solution: nor on the coarsest mesh, where that will do for it.

        On a fine mesh no error is seen of any solution. Where the coarsest will not do, a corner may lie at a node, for
        now; then a mesh that is finer than it need be is kept.
        """
        if self.intervals is not None or not estimate(profile, sizes, self.closed)[0] < TRIVIAL * self.tolerance:
            return False
        coarse = self.laid(np.full(SMALLEST, 1.0 / SMALLEST), profile)
        if len(coarse) >= profile.intervals:
            return True
        error = estimate(profile.on_mesh(coarse), sizes, self.closed)[0]
        return not TRIVIAL * self.tolerance <= error < self.tolerance

    def _nearest_to_null(self, z: Array) -> Profile | None:
        """The function by which another branch would leave this one.

        A trivial solution has no need of a mesh, but its branch points are as accurate as these are on it.
        """
        profile = self.profile(z)
        mesh = OnMesh(self, profile.h)
        x = mesh.unknowns(z)
        if mesh.linear(x) is None:
            return None
        return replace(profile, u=smallest(mesh, x, 1)[1].reshape(-1, self.n))

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        one, other = self.profile(a.z), self.profile(b.z)
        allowed = slack(a, b, scale)
        times = np.linspace(0.0, 1.0, 21)
        apart = np.abs(one.at(times) - other.at(times)).max(axis=0)
        sizes = np.maximum(np.abs(one.u).max(axis=0), np.abs(other.u).max(axis=0))
        noticed = next((SAME * self.sizes(c.z, scale) for c in (a, b) if c.z.size == scale.size), 0.0)
        near = bool(np.all(apart <= max(SAME, float(np.sqrt(allowed / scale[-1]))) * sizes + noticed))
        return abs(float(a.z[-1] - b.z[-1])) <= allowed and near

    def trouble(self, z: Array) -> str:
        """Where the equations have no value on the solution, and why; empty where they have one everywhere."""
        if residual_at(self, z) is not None:
            return ""
        profile = self.profile(z)
        times = profile.gauss_times
        p = self.full_parameters(z)
        for s, u in zip(times, profile.at(times), strict=True):
            p[-1] = s
            text = self.two.why_not_finite(u, p)
            if text:
                return text
        return ""

    def describe_failure(self, z: Array) -> str:
        trouble = self.trouble(z)
        if trouble:
            return trouble
        profile = self.profile(z)
        sizes = np.maximum(np.abs(profile.u).max(axis=0), 1e-300)
        layer = "it has a layer here. Try settings.intervals, or a smaller settings.max_step."
        coarse = unresolved(profile, sizes, self.tolerance, "solution", layer, closed=False)
        return coarse or undetermined(self, z) or (
            "Try a smaller settings.step or min_step; check that conditions and equations are smooth here."
        )


def _of_size_one(function: Profile) -> Array:
    """(nodes, k): those of its parts that are not rounding, each with the largest value 1."""
    largest = np.abs(function.u).max(axis=0)
    known = largest > NO_PART * largest.max()
    return np.asarray(function.u[:, known] / largest[known])


def _standing(problem: BoundaryProblem, origin: Sample, before: Sample | None) -> End | None:
    """The end of a branch along which the parameter no longer changes: vertical, or growing without bound."""
    if before is None or max(abs(float(s.tangent[-1])) for s in (origin, before)) > STANDING:
        return None
    size = float(np.abs(problem.profile(origin.z).u).max())
    return End(
        "bound",
        f"{problem.parameters[0]} stays at {origin.z[-1]:.6g} while the solution changes (largest value {size:.3g}): "
        "the branch is vertical there, or grows without bound",
    )
