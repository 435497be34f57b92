"""Curves of special orbits that are born at points of codimension two of equilibria: folds at GH, tori at HH, ZH."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.departure import Seed
from contin.continuation.settings import Settings
from contin.errors import InputError
from contin.machine import elementary
from contin.problems.loci.start import indices
from contin.problems.orbits.layout import Profile, make_scale
from contin.problems.orbits.loci.curve import OrbitCurve
from contin.problems.orbits.loci.problem import OrbitLocusProblem
from contin.problems.orbits.problem import PERIOD_SCALE, OrbitProblem
from contin.problems.orbits.start import HOPF_INTERVALS


@dataclass(frozen=True, eq=False)
class _Place:
    """A point of a Hopf curve: states, all parameters, their order, typical sizes and widths of both parameters."""

    u: Array
    p: Array
    first: int
    second: int
    sizes: Array
    widths: tuple[float, float]

    @classmethod
    def of(cls, problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> _Place:
        first, second = indices(problem.system, parameters)
        widths = dict(zip(problem.parameters, (float(x) for x in point.scale[[-1, -2]]), strict=True))
        chosen = [widths.get(name, 1.0) for name in parameters]
        p = problem.curve.full_parameters(point.z)
        return cls(point.z[: problem.n], p, first, second, problem.curve.sizes, (chosen[0], chosen[1]))

    def jet(self, system: Any) -> Any:
        from contin.normalforms.sources import compiled_jet

        return compiled_jet(system, self.u, self.p, (self.first, self.second), "flow", self.sizes)


def folds_at_generalised_hopf(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> Seed:
    """The curve of folds of cycles (LPC) that ends at a generalised Hopf (Bautin) point."""
    from contin.normalforms.hopf import lpc_predictor

    place = _Place.of(problem, point, parameters)
    try:
        cycles = lpc_predictor(place.jet(problem.system), float(point.normal_form["omega"]))
    except (KeyError, ZeroDivisionError, np.linalg.LinAlgError):
        raise InputError(
            f"{point.branch}.{point.label}: the curve of folds that ends here could not be predicted; the two "
            "parameters do not unfold the point"
        ) from None
    return _seed("LPC", problem.system, place, cycles, 0.0, Parent(point.branch, point.label))


def tori_at_double_hopf(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The two curves of tori (NS) at a double Hopf point: of the cycles of one pair, the other being critical."""
    from contin.normalforms.hopf_hopf import torus_predictors

    place = _Place.of(problem, point, parameters)
    try:
        omegas = float(point.normal_form["omega1"]), float(point.normal_form["omega2"])
        found = torus_predictors(place.jet(problem.system), omegas)
    except (KeyError, ZeroDivisionError, np.linalg.LinAlgError):
        return []
    parent = Parent(point.branch, point.label)
    return [_seed("NS", problem.system, place, cycles, float(elementary.cos(angle)), parent) for cycles, angle in found]


def tori_at_zero_hopf(problem: Any, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of tori (NS) at a zero-Hopf point; none where its cycles are neutral saddles, or it is degenerate."""
    from contin.normalforms.zero_hopf import torus_predictor

    if "s" not in point.normal_form:  # the coefficients that decide are zero to their errors
        return []
    place = _Place.of(problem, point, parameters)
    omegas = [float(v.imag) for v in np.asarray(point.vectors["critical"]) if v.imag > 0.0]
    try:
        cycles, rate = torus_predictor(place.jet(problem.system), omegas[0])
    except (IndexError, ZeroDivisionError, np.linalg.LinAlgError):
        return []
    if rate == 0.0:
        return []
    bend = -(elementary.square(2.0 * np.pi * rate / cycles.omega))  # cos(2 pi rate rho / omega)
    return [_seed("NS", problem.system, place, cycles, 1.0, Parent(point.branch, point.label), bend)]


def _seed(
    type_: str, system: Any, place: _Place, cycles: Any, further: float, parent: Parent, further2: float = 0.0
) -> Seed:
    """A curve of orbits that shrink to the point, from the second-order predictor of small cycles.

    further, further2 : the further unknown at the point, and its second derivative by rho.
    """
    n, m = len(place.u), Settings().points
    h = np.full(HOPF_INTERVALS, 1.0 / HOPF_INTERVALS)
    period = 2.0 * np.pi / cycles.omega
    rest = Profile(m, np.tile(place.u, (HOPF_INTERVALS * m + 1, 1)), period, h, float(place.p[place.first]))
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
    return Seed(OrbitLocusProblem(curve), z, d, k, scale, (1,), parent)
