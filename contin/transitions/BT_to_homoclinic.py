"""The curve of homoclinic orbits that leaves a Bogdanov-Takens point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from contin.abi import Array
from contin.continuation.branch import Parent, SpecialPoint
from contin.continuation.seed import Seed
from contin.errors import InputError
from contin.homoclinic.equations import ConnectionCurve
from contin.homoclinic.solved_connection import solved_connection
from contin.loci.equilibria.equilibrium_locus import LocusProblem
from contin.normalforms.homoclinic import bogdanov_takens_unfolding
from contin.normalforms.homoclinic_series import homoclinic_series
from contin.normalforms.result import NO_FORM
from contin.normalforms.sources import compiled_jet
from contin.problems.orbits.collocated_orbits import OrbitProblem
from contin.problems.orbits.mesh.layout import Profile
from contin.problems.two_parameters import indices
from contin.transitions.registry import Explored, born
from contin.transitions.small_cycles import compiled, follows_cycles

if TYPE_CHECKING:
    from contin.lowering.system import CompiledSystem

INTERVALS = 60
EPS = (0.1, 0.3, 0.03, 0.01, 0.003, 0.001)  # tried extents of the predicted orbit, relative to the states' sizes
HALF_TIME = 6.0  # half of the time interval in units of the predicted orbit's own time
NEAR = 0.5  # of the widths of the parameters' ranges: the first orbit is that near the point
ALIKE = 0.5  # how far (relative to its extent) the orbit may lie from its prediction


@born(LocusProblem, "BT", "the curve of homoclinic orbits", parameters=2, order=1, explored=Explored(orbits=True))
def homoclinic_at_bogdanov_takens(problem: LocusProblem, point: SpecialPoint, parameters: Sequence[str]) -> list[Seed]:
    """The curve of homoclinic orbits that leaves a Bogdanov-Takens point; none where the prediction does not hold."""
    if not follows_cycles(problem):
        return []
    first, second = indices(problem.system, parameters)
    u, p = point.z[: problem.n], problem.curve.full_parameters(point.z)
    try:
        jet = compiled_jet(compiled(problem), u, p, (first, second), "flow", problem.curve.sizes)
        unfolding = bogdanov_takens_unfolding(jet)
    except NO_FORM:  # the point's own remark says why
        return []
    typical = float(np.max(np.abs(unfolding.chain.q0) / problem.curve.sizes))
    parent = Parent.of(point)
    predictors = _predictors(compiled(problem), jet, u, p, (first, second), unfolding)
    for relative, predict in product(EPS, predictors):
        eps = float(np.sqrt(relative * abs(unfolding.a) / (6.0 * max(typical, 1e-300))))
        try:
            predicted = predict(eps)
            if not _is_near(predicted.p - p, problem, point):
                continue
            seed = _seed(compiled(problem), (first, second), predicted, parent)
        except (InputError, ZeroDivisionError, np.linalg.LinAlgError):  # by zero: a nearly degenerate point
            continue
        return [_away(seed, np.array([p[second], p[first]]), problem, parameters, point)]
    return []


def _is_near(moved: Array, problem: LocusProblem, point: SpecialPoint) -> bool:
    """Whether parameters `moved` that far from the point are within `NEAR` of it, where their widths are known."""
    places = [problem.curve.first, problem.curve.second]
    return bool(np.all(np.abs(moved[places]) <= NEAR * np.asarray(point.scale[[-1, -2]])))


@dataclass(frozen=True, eq=False)
class _Prediction:
    """Parameters, saddle, and the orbit as a function of time."""

    p: Array
    saddle: Array
    orbit: Callable[[Array], Array]
    half: float  # of the time interval


def _predictors(
    system: CompiledSystem, jet: Any, u: Array, p: Array, active: tuple[int, int], unfolding: Any
) -> list[Callable[[float], _Prediction]]:
    """By the series to the fifth order in eps, where it is known, and to leading order about the exact fold."""
    leading = partial(_leading, system, u, p, active, unfolding)
    try:
        series = homoclinic_series(jet, unfolding)
    except (*NO_FORM, np.linalg.LinAlgError):  # the leading order is left
        return [leading]

    def by_series(eps: float) -> _Prediction:
        moved = p.copy()
        moved[list(active)] += series.at(eps)
        return _Prediction(moved, u + series.saddle(eps), lambda times: u + series.orbit(eps, times), HALF_TIME / eps)

    return [by_series, leading]


def _leading(
    system: CompiledSystem, u: Array, p: Array, active: tuple[int, int], unfolding: Any, eps: float
) -> _Prediction:
    """The predicted orbit, about the exact fold of equilibria nearby.

    The linear map of the parameters leaves an error of the order of b1 = -4 eps^4 / a itself; counted from the fold
    curve b1 = 0, it is of higher order.
    """
    b2 = float(unfolding.beta(eps)[1])
    along = p.copy()
    along[list(active)] += unfolding.K[:, 1] * b2
    centre, moved = _fold(system, u + unfolding.H[:, 1] * b2, along, active, unfolding)
    shift = unfolding.beta(eps) * np.array([1.0, 0.0])
    moved[list(active)] += unfolding.K @ shift
    centre = centre - unfolding.H[:, 1] * b2
    return _Prediction(
        moved, centre + unfolding.saddle(eps), lambda times: centre + unfolding.orbit(eps, times), HALF_TIME / eps
    )


def _seed(system: CompiledSystem, active: tuple[int, int], one: _Prediction, parent: Parent) -> Seed:
    """The predicted orbit, corrected."""
    n, half, moved, saddle = system.n, one.half, one.p, one.saddle
    h = np.full(INTERVALS, 1.0 / INTERVALS)
    rest = Profile(4, np.zeros((INTERVALS * 4 + 1, n)), 2.0 * half, h, float(moved[active[0]]))
    arc = replace(rest, u=one.orbit((2.0 * rest.times - 1.0) * half))
    orbits = OrbitProblem(system, moved, active[0], np.zeros(n), 4)
    values = np.linalg.eigvals(system.jacobian(saddle, moved)[1][:, :n])
    stable = int(np.sum(values.real < 0.0))
    curve = ConnectionCurve(orbits, active[1], 1, stable, n - stable)
    seed = solved_connection(curve, arc, saddle[None, :], float(moved[active[1]]), parent)
    found = seed.problem.curve.profile(seed.z)  # type: ignore[attr-defined]
    extent = np.ptp(arc.u, axis=0).max()
    if float(np.abs(found.at(rest.times) - arc.u).max()) > ALIKE * extent:
        raise InputError("another orbit was found")
    return seed


def _fold(system: CompiledSystem, u: Array, p: Array, active: tuple[int, int], unfolding: Any) -> tuple[Array, Array]:
    """The fold near u with the parameters moved along K[:, 0] from p: f = 0, f_u v = 0, <q0, v> = 1."""
    from scipy.optimize import root

    n, q0, direction = len(u), unfolding.chain.q0, unfolding.K[:, 0]

    def at(x: Array) -> Array:
        moved = p.copy()
        moved[list(active)] += x[-1] * direction
        f, jacobian = system.jacobian(x[:n], moved)
        return np.concatenate([f, jacobian[:, :n] @ x[n : 2 * n], [q0 @ x[n : 2 * n] - 1.0]])

    found = root(at, np.concatenate([u, q0, [0.0]]), tol=1e-13)
    if not float(np.max(np.abs(at(found.x)))) < 1e-8:
        raise InputError("no fold of equilibria beside the point")
    moved = p.copy()
    moved[list(active)] += found.x[-1] * direction
    return found.x[:n], moved


def _away(seed: Seed, origin: Array, problem: LocusProblem, parameters: Sequence[str], point: SpecialPoint) -> Seed:
    """The seed with one arm, away from the point (q, p) = origin that it was born at."""
    connection: Any = seed.problem
    widths = dict(zip(problem.parameters, (float(x) for x in point.scale[[-1, -2]]), strict=True))
    profile = connection.curve.profile(seed.z)
    sizes = connection.curve.orbits.state_sizes(profile)
    scale = connection.scale_for(profile.h, sizes, *(widths.get(name, 1.0) for name in parameters))
    tangent = connection.tangents(seed.z, scale)[0]
    if float((seed.z[-2:] - origin) / scale[-2:] @ tangent[-2:]) < 0.0:
        tangent = -tangent
    return replace(seed, direction=tangent, curvature=None, scale=scale, arms=(1,))
