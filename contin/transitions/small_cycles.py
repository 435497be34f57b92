"""Curves of special orbits that shrink to a point of codimension two of equilibria, from predictors of small cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from contin.abi import NO_FUNCTION, Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.continuation.settings import Settings
from contin.loci.orbits.orbit_locus import OrbitLocusProblem
from contin.lowering.system import CompiledSystem
from contin.machine import elementary
from contin.normalforms.sources import compiled_jet
from contin.problems.orbits.collocated_orbits import PERIOD_SCALE, OrbitProblem
from contin.problems.orbits.corotating import system_of_orbits
from contin.problems.orbits.linearised.multipliers import of_rest
from contin.problems.orbits.mesh.layout import HOPF_INTERVALS, Profile, make_scale
from contin.problems.orbits.special_orbits.curve import OrbitCurve
from contin.problems.two_parameters import indices

if TYPE_CHECKING:
    from contin.loci.equilibria.equilibrium_locus import LocusProblem
    from contin.normalforms.jet import Jet
    from contin.problems.two_parameters import TwoParameterProblem
    from contin.systems.protocol import System


TURN: Final = 0.6  # radians
MOST: Final = 200  # intervals
CRITICAL: Final = {"GH": 2, "ZH": 3, "HH": 4}  # eigenvalues on the imaginary axis


@dataclass(frozen=True, eq=False)
class Place:
    """A point of a Hopf curve: states, all parameters, their order, typical sizes and widths of both parameters."""

    u: Array
    p: Array
    first: int
    second: int
    sizes: Array
    widths: tuple[float, float]

    @classmethod
    def of(cls, problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> Place:
        first, second = indices(problem.system, parameters)
        widths = dict(zip(problem.parameters, (float(x) for x in point.scale[[-1, -2]]), strict=True))
        chosen = [widths.get(name, 1.0) for name in parameters]
        p = problem.curve.full_parameters(point.z)
        return cls(point.z[: problem.n], p, first, second, problem.curve.sizes, (chosen[0], chosen[1]))

    def jet(self, system: System) -> Jet:
        return compiled_jet(system, self.u, self.p, (self.first, self.second), "flow", self.sizes)


def seed_of_cycles(
    type_: str, system: CompiledSystem, place: Place, cycles: Any, further: float, point: SpecialPoint,
    further2: float = 0.0,
) -> Seed:  # fmt: skip
    """A curve of orbits that shrink to the point, from the second-order predictor of small cycles.

    further, further2 : the further unknown at the point, and its second derivative by rho.
    """
    n, m = len(place.u), Settings().points
    period = float(2.0 * np.pi / cycles.omega)
    h = mesh_at(point, period)
    rest = Profile(m, np.tile(place.u, (len(h) * m + 1, 1)), period, h, float(place.p[place.first]))
    phases = 2.0 * np.pi * rest.times
    first = 2.0 * (elementary.exp(1j * phases)[:, None] * cycles.q).real
    second = 2.0 * cycles.orbit(1.0, phases) - 2.0 * first
    orbits = OrbitProblem(system, place.p.copy(), place.first, np.zeros(n), m)
    curve = OrbitCurve(type_, orbits, place.second)
    metric = make_scale(h, m, place.sizes, PERIOD_SCALE * period, place.widths[0])
    scale = curve.join(metric, place.widths[1], 1.0)
    zeros = np.zeros(len(h))
    d = curve.join(np.concatenate([first.ravel(), [0.0], zeros, [0.0]]), 0.0, 0.0) / scale
    shift = -2.0 * period * cycles.omega2 / cycles.omega
    bend = np.concatenate([second.ravel(), [shift], zeros, [2.0 * cycles.p2[0]]])
    k = curve.join(bend, 2.0 * float(cycles.p2[1]), further2) / scale
    norm = float(np.linalg.norm(d))
    d, k = d / norm, k / elementary.square(norm)
    k = k - float(k @ d) * d
    z = curve.join(rest.vector(), float(place.p[place.second]), further)
    parent, beside = Parent.of(point), measured(point, float(cycles.omega), period)
    return Seed(OrbitLocusProblem(curve), z, d, k, scale, (1,), parent, measured=beside)


def mesh_at(point: SpecialPoint, period: float) -> Array:
    """Even intervals in which the fastest critical eigenvalue turns by no more than `TURN`.

    The error of the collocated angle, some (turn)^9 / 3e7 an interval, is one of the further unknown, and where it is
    more than the first steps' length the curve has no second point.
    """
    values = np.asarray(point.eigenvalues, dtype=complex)
    critical = values[np.argsort(np.abs(values.real))][: CRITICAL.get(point.type, 2)]
    turns = int(np.ceil(period * float(np.abs(critical.imag).max(initial=0.0)) / TURN))
    count = min(max(turns, HOPF_INTERVALS), MOST)
    return np.full(count, 1.0 / count)


def measured(point: SpecialPoint, omega: float, period: float) -> tuple[int, NDArray[np.complex128]]:
    """Of a point of codimension two of equilibria, as an orbit of the pair +-i omega: unstable ones beside the critical
    eigenvalues, and multipliers."""
    values = np.asarray(point.eigenvalues, dtype=complex)
    others = values[np.argsort(np.abs(values.real))][CRITICAL.get(point.type, 2) :]
    return int(np.sum(others.real > 0.0)), of_rest(values, omega, period)[1]


def compiled(problem: TwoParameterProblem) -> CompiledSystem:
    """The compiled model of the orbits beside such a curve."""
    assert isinstance(problem.system, CompiledSystem)
    return system_of_orbits(problem.system)


def follows_cycles(problem: TwoParameterProblem) -> bool:
    """True for curves of equilibria of compiled flows, whose periodic orbits can be followed."""
    return bool(problem.system.kind != "map" and problem.system.jacobian_address != NO_FUNCTION)
