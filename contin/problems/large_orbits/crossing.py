"""Which families cross at a branch point of large orbits: b20 x^2 + 2 b11 x y = 0 for tangents x q + y r.

q is the null vector along which the parameter does not move, r the tangent of the own family (so that a02 = 0), and

    b20 = <p, D^2F[q, q]>,  b11 = <p, D^2F[q, r]>,

F(u, T, p) = T f(u, p), p the left vector of the multiplier 1 with <p, f> = 0. See
`contin.problems.orbits.normal_forms.branch_point`, which decides and has the words.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contin.abi import Array, Vector
from contin.continuation.outcome import Verified
from contin.linalg.vectors import dot
from contin.machine import elementary
from contin.normalforms.coefficient import Coefficient
from contin.problems.large_orbits.cycle import LargeCycle
from contin.problems.large_orbits.normal_form import UnresolvedShearError, drifts, with_wider_stencils
from contin.problems.orbits.normal_forms.branch_point import Crossing, decided

if TYPE_CHECKING:
    from contin.problems.large_orbits.large_orbit_equations import LargeOrbitEquations

PLACE: Final = 30.0  # times what is left of the equations, and of the multiplier, at the place
STEADY: Final = 1e-4  # a shear that only matters for signs: as `SHEARLESS` of meshes
NO_KIND: Final = "BPC: the families that cross there were not told apart; no kind is stated"


@dataclass(frozen=True, eq=False)
class Place:
    """A branch point on one mesh: z, and the tangent of its family (raw)."""

    problem: LargeOrbitEquations
    z: Array
    own: Array


@dataclass(frozen=True, eq=False)
class Direction:
    """A change of an orbit: of its states (N, 3, n), its period and the parameter."""

    states: Vector
    period: float
    parameter: float


def _with_noise(found: Crossing, noise: float) -> Crossing:
    b20, b11, a02 = (replace(one, noise=one.noise + noise) for one in (found.b20, found.b11, found.a02))
    return replace(found, b20=b20, b11=b11, a02=a02)


def with_kind(point: Verified, coarse: Place, fine: Place | None) -> Verified:
    """The branch point with kind, slope and its error, or the remark that they are not known."""
    if fine is None:
        return replace(point, remark=f"{NO_KIND} (no orbit on a finer mesh)")
    try:
        first, second = (LargeCycle.of_type(place.problem, place.z, "BPC") for place in (coarse, fine))
        drift = drifts(first.shear, second.shear)
        first = replace(first, drifts=drift)
        found, wider = _crossing(coarse, first), with_wider_stencils(first)
        if wider is not None:
            other = _crossing(coarse, wider)
            pairs = ((found.b20, other.b20), (found.b11, other.b11), (found.a02, other.a02))
            b20, b11, a02 = (a.with_noise_from(b) for a, b in pairs)
            found = replace(found, b20=b20, b11=b11, a02=a02)
        found = _with_noise(found, _off(point))
        form = decided(found, _crossing(fine, replace(second, drifts=drift)))
    except (np.linalg.LinAlgError, ZeroDivisionError, UnresolvedShearError) as reason:
        return replace(point, remark=f"{NO_KIND} ({reason})")
    return replace(point, normal_form=form, remark="" if form else NO_KIND)


def _off(point: Verified) -> float:
    """What the error of the place makes of a coefficient, in units of the largest: that of null vectors, about, which
    other multipliers near 1 add to."""
    away = np.abs(point.eigenvalues - 1.0)
    apart = min(1.0, float(np.sort(away)[2])) if len(away) > 2 else 1.0  # two of them are 1
    return PLACE * point.residual / max(apart, point.residual)


def _crossing(place: Place, cycle: LargeCycle) -> Crossing:
    problem, z = place.problem, place.z
    q, left = _vertical(cycle)
    carried = problem.carried(z, place.own)
    if carried is None:
        raise np.linalg.LinAlgError("the equations are not finite on the orbit")
    r = Direction(carried, float(place.own[-2]), float(place.own[-1]))
    size = np.sqrt(cycle.mean(q.states, q.states))
    unit = cycle.equation(1.0)
    terms = [_second(cycle, one, other) for one, other in ((q, q), (q, r), (r, r))]
    values = np.array([unit.projection(g, left).real for g in terms])
    sizes = np.array([unit.modulus(g, left) for g in terms])
    largest = float(sizes.max())
    b20, b11, a02 = (
        Coefficient(float(v / largest), float(s / largest), False) for v, s in zip(values, sizes, strict=True)
    )
    return Crossing(b20, b11, a02, np.empty(0), abs(r.parameter) / float(size))


def _vertical(cycle: LargeCycle) -> tuple[Direction, Vector]:
    """q, and the functional <p, .>."""
    start, velocity = np.real(cycle.critical), cycle.velocity
    if not cycle.drifts:
        states, left = cycle.across_fold()
        assert left is not None
        return Direction(states, 0.0, 0.0), left
    c = dot(velocity, cycle.sweeps.monodromy(start) - start) / dot(velocity, velocity)
    states = cycle.sweeps.along(start, -c * cycle.problem.by_scalars(cycle.z, ())[0])
    along = cycle.sweeps.along(velocity)
    across = states - cycle.mean(along, states) / cycle.mean(along, along) * along
    return Direction(across, -c, 0.0), cycle.equation(1.0).functionals[0]


def vertical_term(cycle: LargeCycle, other: int) -> tuple[float, float]:
    """<p, B(q, q)> along a fold as part of its terms, and <p, f_p> of the active parameter beside that of the `other`.

    Their product has the sign of -p'' along the family, and changes it smoothly where the curve of folds runs along
    the active parameter, too, which moves no fold there.
    """
    cycle = replace(cycle, drifts=cycle.shear > STEADY)
    q, left = _vertical(cycle)
    unit = cycle.equation(1.0)
    g = _second(cycle, q, q)
    orbit = cycle.orbit
    states, p = orbit.U.reshape(-1, cycle.problem.n), cycle.problem.full_parameters(cycle.z)
    own, beside = (
        unit.projection(cycle.problem.points.parameter_slopes(states, p, k).reshape(orbit.U.shape), left).real
        for k in (cycle.problem.active, other)
    )
    return unit.projection(g, left).real / unit.modulus(g, left), own / float(elementary.hypot(own, beside))


def _second(cycle: LargeCycle, one: Direction, other: Direction) -> Vector:
    """D^2F / T at all points."""
    total = cycle.apply_with(one.states, one.parameter, other.states, other.parameter)
    for a, b in ((one, other), (other, one)):
        if a.period != 0.0:
            total = total + a.period / cycle.period * cycle.slope_along(b.states, b.parameter)
    return total
