"""Curves of homoclinic and heteroclinic orbits in two parameters, as a continuation problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from contin.abi import Array
from contin.continuation.branch import End
from contin.continuation.outcome import Outcome, Verified
from contin.continuation.problem import Problem, Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.settings import Settings
from contin.errors import InputError, NoSolutionError
from contin.homoclinic import events
from contin.homoclinic.connection_layout import Gauge
from contin.homoclinic.curve_of_connections import CurveOfConnections
from contin.homoclinic.further_saddle import further_saddle
from contin.homoclinic.refitting import farther_and_finer, fit_for, on_interval, on_mesh
from contin.homoclinic.surfaces import surface_met, why_not
from contin.kernels.collocation_basis import basis
from contin.problems.orbits.linearised.bordered import Bordered
from contin.problems.orbits.linearised.tangent_solver import Factorised, factorised
from contin.problems.orbits.measured.columns import of_one_size, orbit_columns
from contin.problems.orbits.mesh.layout import make_scale, sizes_of
from contin.problems.orbits.zero_of_test import zero_of_test
from contin.problems.two_parameters import UNBOUNDED
from contin.special.table import tests_of_connections

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

SMALL = 0.01  # extent of the orbit, relative to the states' sizes, below which it is the point that it shrinks to
BESIDE = 1e-3  # (arclength) from an orbit at which the corrector failed to others, which may cross a surface
ALIKE = 1e-6  # relative distance of parameters below which two points are one


@dataclass(frozen=True, eq=False)
class LinearisedConnection(Factorised):
    """With what the bounded solution of the adjoint variational equation, and with it the tests, are found from."""

    problem: ConnectionProblem
    jacobian: csc_matrix
    sizes: Array

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """See `contin.continuation.march.Telling`."""
        return self.problem.stability_with(z, self.sizes, self.problem.adjoint(self.jacobian, z))


@dataclass(frozen=True, eq=False)
class ConnectionProblem(CurveOfConnections):
    """See `contin.homoclinic.equations` for the unknowns and equations."""

    # -- metric -------------------------------------------------------------------------------------------------------

    def initial_scale(self, z: Array, bounds: tuple[float, float]) -> Array:
        first, second = self.widths(z, bounds)
        profile = self.curve.profile(z)
        return self.scale_for(profile.h, self.curve.orbits.state_sizes(profile), first, second)

    def scale_for(self, h: Array, sizes: Array, first: float, second: float) -> Array:
        own = make_scale(h, self.curve.orbits.points, sizes, 1.0, first)
        nodes = own.size - len(h) - 2
        ends = np.tile(np.sqrt(self.curve.n) * sizes, self.curve.saddles)
        return np.concatenate([own[:nodes], ends, own[nodes:-1], [second, first]])

    def sizes(self, z: Array, scale: Array) -> Array:
        return sizes_of(scale, self.curve.profile(z).h, self.curve.n, self.curve.orbits.points)

    # -- the engine's contract ----------------------------------------------------------------------------------------

    def settled(self, z: Array, scale: Array) -> Self:
        return replace(self, curve=self.curve.settled(z, self.sizes(z, scale)))

    def linearisation(self, z: Array, tangent: Array, scale: Array) -> LinearisedConnection | None:
        if surface_met(self.curve, z) is not None:
            return None
        sizes = self.sizes(z, scale)
        try:
            equations, jacobian = self.curve.linearise(z, scale, sizes)
        except (np.linalg.LinAlgError, ValueError):  # no step: the curve ends, in words
            return None
        found = factorised(equations, jacobian, self.curve.unknowns(z), tangent)
        if found is None:
            return None
        return LinearisedConnection(found.equations, found.factors, found.where, found.size, self, jacobian, sizes)

    def stability(self, z: Array) -> tuple[Array, int, NDArray[np.complex128]]:
        """Without the tests that need the adjoint solution, which a linearisation has."""
        return self.stability_with(z, self.sizes(z, self.initial_scale(z, self.first_bounds)), None)

    def stability_with(
        self, z: Array, sizes: Array, adjoint: Array | None
    ) -> tuple[Array, int, NDArray[np.complex128]]:
        """Tests from index 2 on, dimension of the saddle's unstable manifold, eigenvalues of the saddle."""
        try:
            tests, values = events.tests_at(self.curve, z, sizes, adjoint)
        except (np.linalg.LinAlgError, ValueError):  # which `remarks` tells
            return np.full(len(tests_of_connections()), np.nan), 0, np.full(self.curve.n, np.nan, complex)
        return tests, self._unstable(values), values

    def remarks(self, z: Array, eigenvalues: NDArray[np.complex128]) -> Sequence[str]:
        """Where the tests of this curve could not be computed."""
        untested = np.flatnonzero(np.isnan(eigenvalues).all(axis=1))
        if not untested.size:
            return ()
        return (
            f"the tests of this curve of connecting orbits could not be computed at {untested.size} of its points (the "
            f"first one at {self.place(z[untested[0]])}): special points there are not told",
        )

    def _unstable(self, values: NDArray[np.complex128]) -> int:
        """Without the zero eigenvalue of a saddle-node, whose rounding has a sign."""
        return self.curve.unstable_count if self.curve.node else int(np.sum(values.real > 0.0))

    def adjoint(self, jacobian: csc_matrix, z: Array) -> Array | None:
        """The bounded solution of the adjoint variational equation at the Gauss points, (N m, n), scaled."""
        if self.curve.node or self.isolated or self.curve.reversor is not None:
            return None
        n, m, nu = self.curve.n, self.curve.orbits.points, self.curve.nodes(z)
        inside = nu - n
        rows = np.append(np.arange(inside), inside + self.curve.saddles * n + np.arange(n))
        try:
            _, _, left = Bordered.of(jacobian[:, :nu][rows], 1, once=True).solve()
        except np.linalg.LinAlgError:  # the tests that need it are NaN, which `remarks` tells
            return None
        values = left[:inside, 0].reshape(-1, m, n) / basis(m).gauss_weights[:, None]
        return np.asarray(values.reshape(-1, n))

    def adjoint_at(self, z: Array, s: float, sizes: Array) -> Array:
        """The bounded solution of the adjoint variational equation at the scaled time s, (n,), in states' sizes."""
        profile = self.curve.profile(z)
        scale = self.scale_for(profile.h, sizes, *self.widths(z, UNBOUNDED))
        row = np.zeros(z.size)
        row[-1] = 1.0
        own = replace(self, curve=replace(self.curve, gauge=None)).settled(z, scale)  # whose reference is z
        here = own.linearisation(z, row, scale)
        found = None if here is None else own.adjoint(here.jacobian, z)
        if found is None:
            raise NoSolutionError("the adjoint solution of the homoclinic orbit is not determined")
        return np.array([np.interp(s, profile.gauss_times, column) for column in found.T])

    def explain(self, a: Sample, b: Sample) -> tuple[str, ...] | None:
        return events.explain(self, a, b)

    def test_of(self, type_: str) -> int | None:
        return events.test_of(type_)

    def verify(self, type_: str, near: Sample, frame: Frame) -> Outcome:
        return events.verify(self, type_, near, frame)

    def refined(self, sample: Sample, frame: Frame) -> tuple[Problem, Sample, Frame] | None:
        """On a longer interval, with a mesh of half the lengths."""
        return self._refined(sample, frame)

    def _refined(self, sample: Sample, frame: Frame) -> tuple[Self, Sample, Frame] | None:
        known = Gauge(vectors=self.curve.gauged(frame.gauge).chosen.vectors)  # what signs refer to
        finer = replace(self, curve=replace(self.curve, doubting=True).gauged(known))
        fit = farther_and_finer(finer, sample.z, frame.scale)
        start = on_interval(finer, finer.curve, fit, sample, frame.scale, Settings())
        if start is None:
            return None
        return finer, start.origin, Frame(fit.scale, gauge=finer.settled(start.origin.z, fit.scale).curve.gauge)

    def discretisation(self, found: Sample, frame: Frame, index: int) -> float | None:
        """How far the zero of a test (either parameter) moves on a longer interval with a mesh of half the lengths."""
        refined = self._refined(found, frame)
        again = None if refined is None else zero_of_test(*refined, index)
        return None if again is None else float(np.max(np.abs(again.sample.z[-2:] - found.z[-2:])))

    def verify_compound(self, a: Sample, b: Sample, frame: Frame) -> Sequence[Outcome]:
        return [self.verify(t, a, frame) for t in events.changes(self, a, b)]

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """A mesh that fits; the end where the saddle is none any more."""
        scale = frame.scale
        if origin.tests.size > 3 and origin.tests[3] < 0.0:
            where = self.place(origin.z)
            text = f"an eigenvalue of the saddle vanished before {where}: its projections mean nothing beyond"
            return Renewal(scale, origin, before, None, End("saddle-node", text))
        sizes = self.sizes(origin.z, scale)
        extent, last = (self._extent(sample, sizes) for sample in (origin, before or origin))
        if extent < min(SMALL, last):  # beside the point that they are born at they are as small, and grow
            text = f"the connecting orbits shrink to a point near {self.place(origin.z)}"
            return Renewal(scale, origin, before, None, End("bt", text))
        met = None if before is None else further_saddle(self, origin.z, before.z, scale, sizes)
        if met is not None:
            return Renewal(scale, origin, before, None, met)
        fit = fit_for(self, origin.z, scale)
        if fit is None:
            return Renewal(scale, origin, before, None)
        if fit.another_interval:
            there = on_interval(self, self.curve, fit, origin, scale, settings)
            return Renewal(scale, origin, before, None) if there is None else there
        return on_mesh(self, self.curve, fit, origin, before, scale, settings)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The chain of connections that the curve was near when its corrector failed."""
        if before is None:
            return None
        sizes = self.sizes(origin.z, frame.scale)
        end = further_saddle(self, origin.z, before.z, frame.scale, sizes, failed=True)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    def _extent(self, sample: Sample, sizes: Array) -> float:
        """Of the orbit, relative to the states' sizes."""
        return float(np.max(np.ptp(self.curve.profile(sample.z).u, axis=0) / sizes))

    def end_at(self, point: Verified) -> End | None:
        """NCH and SH, beyond which the equations describe no homoclinic orbits to this equilibrium."""
        where = self.place(point.z)
        if point.type == "NCH" and self.curve.node:
            text = f"the homoclinic orbits to a saddle-node end at a non-central one at {where}: to a saddle beyond"
            return End("saddle-node", text)
        if point.type == "NCH":
            return End("saddle-node", f"the saddle becomes a saddle-node at {where}: homoclinic orbits to it follow")
        if point.type == "SH":
            return End("hopf", f"the saddle has a Hopf bifurcation at {where}: orbits to a cycle follow")
        return None

    def same_point(self, a: Verified, b: Verified, scale: Array) -> bool:
        return bool(np.all(np.abs(a.z[[-1, -2]] - b.z[[-1, -2]]) <= ALIKE * scale[[-1, -2]]))

    def columns(self, z: Array) -> dict[str, Array]:
        """Both parameters, smallest and largest values of the states over the orbit, the saddle(s), and what it is."""
        names = self.system.state_names
        columns = self.parameter_columns(z)
        reversor = self.curve.reversor
        ranges = orbit_columns(z, names, self.curve.profile, lambda u, _: u)
        if reversor is not None:  # the other half
            image = orbit_columns(z, names, self.curve.profile, lambda u, _: reversor.image(u))
            for name in names:
                ranges[f"{name}.min"] = np.minimum(ranges[f"{name}.min"], image[f"{name}.min"])
                ranges[f"{name}.max"] = np.maximum(ranges[f"{name}.max"], image[f"{name}.max"])
        ends = np.empty((len(z), self.curve.saddles, self.curve.n))
        for chosen, rows in of_one_size(z):
            ends[chosen] = [self.curve.equilibria(row) for row in rows]
        for k, name in enumerate(names):
            columns |= {key: ranges[key] for key in (f"{name}.min", f"{name}.max")}
            columns[f"{name}.saddle"] = ends[:, 0, k]
            if self.curve.saddles == 2:
                columns[f"{name}.saddle2"] = ends[:, 1, k]
        if self.curve.node:
            columns["saddle_node"] = np.ones(len(z), bool)
        return columns

    def _surface_ahead(self, z: Array) -> str | None:
        """The surface that orbits just beside z on the curve cross; None where there is none."""
        met = surface_met(self.curve, z)
        if met is not None or not self.curve.system.n_switches:
            return met
        scale = self.initial_scale(z, self.first_bounds)
        try:
            (tangent,) = self.tangents(z, scale)
        except InputError:  # nothing is known of what is beside it
            return None
        either = (surface_met(self.curve, z + side * BESIDE * scale * tangent) for side in (1.0, -1.0))
        return next((text for text in either if text is not None), None)

    def describe_failure(self, z: Array) -> str:
        met = self._surface_ahead(z)
        if met is not None:
            return why_not(met)
        return (
            "The connecting orbit is not resolved any more (a saddle that loses its hyperbolicity, or an orbit that "
            "comes close to another saddle). Try settings.intervals, or a smaller settings.step."
        )
