"""Curves of folds of branches of connecting orbits between saddles, in two parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.problem import Renewal
from contin.continuation.sample import Frame, Sample
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.homoclinic.further_saddle import further_saddle
from contin.homoclinic.refitting import farther_and_finer, fit_for, on_interval, on_mesh
from contin.homoclinic.saddle_connections import ConnectionProblem
from contin.loci.augmented.connections import FoldsOfConnections
from contin.loci.augmented.on_meshes import CurveOnMeshes
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import indices

CHUNK = 5  # a step takes some 50 ms


@dataclass(frozen=True, eq=False)
class CurveOfFolds(CurveOnMeshes):
    """See `FoldsOfConnections`."""

    base: FoldsOfConnections

    maximum_chunk = CHUNK

    def orbit_at(self, z: Array) -> Profile:
        return self.base.problem.profile(z)

    def renew(
        self, origin: Sample, before: Sample | None, loop: Sample | None, frame: Frame, settings: Settings
    ) -> Renewal:
        """An interval and a mesh that fit; the end where the orbit is a chain of two."""
        problem, scale = self.base.problem, frame.scale
        sizes, same = problem.sizes(origin.z, scale), Renewal(scale, origin, before, None)
        met = None if before is None else further_saddle(problem, origin.z, before.z, scale, sizes)
        if met is not None:
            return replace(same, end=met)
        fit = fit_for(problem, origin.z, scale)
        if fit is None:
            return same
        if fit.another_interval:
            return on_interval(self, problem.curve, fit, origin, scale, settings) or same
        return on_mesh(self, problem.curve, fit, origin, before, scale, settings)

    def foretold(self, origin: Sample, before: Sample | None, frame: Frame) -> Renewal | None:
        """The chain of connections that the curve was near when its corrector failed."""
        if before is None:
            return None
        problem = self.base.problem
        sizes = problem.sizes(origin.z, frame.scale)
        end = further_saddle(problem, origin.z, before.z, frame.scale, sizes, failed=True)
        return None if end is None else Renewal(frame.scale, origin, before, None, end)

    def finer(self, near: Sample, frame: Frame) -> tuple[Sample, Frame] | None:
        """On a longer interval, with a mesh of half the lengths."""
        problem = self.base.problem
        fit = farther_and_finer(problem, near.z, frame.scale)
        there = on_interval(self, problem.curve, fit, near, frame.scale, Settings())
        return None if there is None else (there.origin, Frame(fit.scale))


def curve_of(problem: ConnectionProblem, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve through a fold of a branch of connections in one parameter."""
    curve = problem.curve
    first, second = indices(curve.system, parameters)
    values = curve.full_parameters(point.z)
    orbits = replace(curve.orbits, base=values, active=first)
    own = replace(curve, orbits=orbits, second=second, slots=(-2, -1), gauge=None)
    base = FoldsOfConnections(ConnectionProblem(own))
    z = np.append(point.z[:-2], values[[second, first]])
    return Seed(CurveOfFolds(base, (), "LP", tuple(parameters)), z, parent=Parent(point.branch, point.label))
